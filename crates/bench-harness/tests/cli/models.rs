//! Real files from elsewhere: whatever is in them, the program ends in a result or a named error.

use crate::support::run;
use std::path::PathBuf;

/// Where the models are, if they are anywhere.
fn models() -> Option<PathBuf> {
    let folder = PathBuf::from(std::env::var_os("ABF_MODELS")?);
    assert!(folder.is_dir(), "ABF_MODELS names {}, which is no folder", folder.display());
    Some(folder)
}

#[test]
#[allow(clippy::print_stdout, reason = "what is skipped is said")]
fn every_raw_model_ends_in_a_result_or_a_named_error() {
    let Some(folder) = models() else {
        println!("ABF_MODELS is not set: 1 check on its raw models skipped");
        return;
    };
    let raw = folder.join("raw");
    let entries = std::fs::read_dir(&raw).unwrap_or_else(|e| panic!("{}: {e}", raw.display()));
    let mut checked = 0;
    for path in entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_file()) {
        let ran = run([path.as_os_str(), "--json".as_ref(), "-".as_ref()]);
        let error = &ran.result()["error"];
        match ran.code {
            0 | 1 => assert!(error.is_null(), "{}: {error}", path.display()),
            2 => assert!(error["kind"].is_string() && error["hint"].is_string(), "{}: {error}", path.display()),
            code => panic!("{}: exit code {code}", path.display()),
        }
        checked += 1;
    }
    assert!(checked > 0, "{} is empty", raw.display());
}
