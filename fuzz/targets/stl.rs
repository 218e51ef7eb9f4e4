//! Any bytes as STL.

#![no_main]

use abf::mesh::io::MeshFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| abf_fuzz::read(MeshFormat::Stl, bytes));
