//! Any bytes as a glTF document: a `.glb`, or JSON.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| abf_fuzz::edit_gltf(bytes));
