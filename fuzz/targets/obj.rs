//! Any bytes as OBJ.

#![no_main]

use abf::mesh::io::MeshFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| abf_fuzz::read(MeshFormat::Obj, bytes));
