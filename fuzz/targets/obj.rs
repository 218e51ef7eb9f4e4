//! Any bytes as OBJ: as a mesh, and as a text that is kept.

#![no_main]

use abf::mesh::io::MeshFormat;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    abf_fuzz::read(MeshFormat::Obj, bytes);
    abf_fuzz::keep_obj(bytes);
});
