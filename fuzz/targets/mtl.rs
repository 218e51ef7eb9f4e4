//! Any bytes as a material library.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| abf_fuzz::read_materials(bytes));
