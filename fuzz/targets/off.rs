//! Any bytes as OFF.

#![no_main]

use abf::mesh::io::MeshFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| abf_fuzz::read(MeshFormat::Off, bytes));
