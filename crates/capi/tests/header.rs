//! The header that is checked in belongs to this library, also where there is no cbindgen to write it anew.
#![allow(unsafe_code, reason = "it calls the library as C does")]

use abf_capi::entry::{abf_status_name, abf_version};
use abf_capi::options::AbfOptions;
use abf_capi::status::AbfStatus;
use abf_capi::view::AbfView;
use std::ffi::CStr;

const HEADER: &str = include_str!("../include/abf.h");

/// The fields of a struct of the header, in their order.
fn fields(name: &str) -> Vec<&'static str> {
    let start = HEADER.find(&format!("typedef struct {name} {{")).expect("the struct");
    let body = HEADER[start..].split('}').next().expect("a body");
    let field = |line: &'static str| line.trim().strip_suffix(';').and_then(|line| line.rsplit([' ', '*']).next());
    body.lines().skip(1).filter(|line| !line.trim().starts_with("//")).filter_map(field).collect()
}

#[test]
fn every_status_of_the_header_has_the_name_that_the_library_gives_it() {
    let codes =
        HEADER.lines().filter_map(|line| line.trim().strip_prefix("ABF_STATUS_")?.strip_suffix(',')?.split_once(" = "));
    let codes: Vec<(String, i32)> =
        codes.map(|(name, code)| (name.to_lowercase().replace('_', "-"), code.parse().expect("a code"))).collect();
    assert_eq!(codes.len(), AbfStatus::Internal as usize + 1);
    for (name, code) in codes {
        // SAFETY: names end with a zero.
        let said = unsafe { CStr::from_ptr(abf_status_name(code)) };
        assert_eq!(said.to_str(), Ok(name.as_str()));
    }
}

#[test]
fn structs_begin_with_their_size_and_have_the_fields_of_the_library() {
    let (options, view) = (fields("AbfOptions"), fields("AbfView"));
    assert_eq!((options[0], view[0]), ("size", "size"));
    assert!(options.contains(&"max_memory") && view.contains(&"triangle_charts"));
    // On 64 bits: pointers, sizes and doubles have 8 bytes, the fourteen small numbers of the options 4.
    if size_of::<usize>() == 8 {
        assert_eq!(size_of::<AbfOptions>(), 8 * (options.len() - 14) + 4 * 14);
        assert_eq!(size_of::<AbfView>() % 8, 0);
    }
}

#[test]
fn the_header_declares_every_entry_point_and_the_version_is_that_of_the_package() {
    for name in [
        "flatten",
        "unwrap",
        "relax",
        "result_view",
        "result_free",
        "last_error",
        "status_name",
        "predict_memory",
        "version",
    ] {
        assert!(HEADER.contains(&format!(" abf_{name}(")) || HEADER.contains(&format!("*abf_{name}(")), "{name}");
    }
    assert_eq!(abf_version() % 100, env!("CARGO_PKG_VERSION_PATCH").parse::<u32>().expect("a number"));
}
