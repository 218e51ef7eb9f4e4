//! Any small mesh, flattened and judged.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| abf_fuzz::flatten(bytes));
