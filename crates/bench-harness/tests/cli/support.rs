//! Running the program and reading what it says.

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder of one test, removed at its end.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file and returns its path.
    pub(crate) fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).expect("written");
        path
    }

    /// How many files there are.
    pub(crate) fn count(&self) -> usize {
        std::fs::read_dir(self.0.path()).expect("a folder").count()
    }
}

/// The program, not yet started, in the folder of the tests.
pub(crate) fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_bench-harness"))
}

/// What the program did.
pub(crate) struct Ran {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Ran {
    /// Whatever the program does, it must not panic and must end by itself.
    pub(crate) fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("text");
        let (stdout, stderr) = (text(output.stdout), text(output.stderr));
        assert!(!stderr.contains("panicked"), "{stderr}");
        Self { code: output.status.code().expect("an exit code"), stdout, stderr }
    }

    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}\n{}\n{}", self.stdout, self.stderr))
    }

    /// The result of one mesh from the JSON on stdout.
    pub(crate) fn result(&self) -> Value {
        let json = self.json();
        assert_eq!(json["schema"], "bench-harness/3");
        let results = json["results"].as_array().expect("a list");
        assert_eq!(results.len(), 1, "{json}");
        results[0].clone()
    }
}

/// Runs the program.
pub(crate) fn run<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> Ran {
    Ran::new(program().args(args).output().expect("the program starts"))
}

/// Runs the program with options as on a command line, then files.
pub(crate) fn run_on(options: &str, files: &[&Path]) -> Ran {
    Ran::new(program().args(options.split_whitespace()).args(files).output().expect("the program starts"))
}

/// A committed fixture.
pub(crate) fn fixture(name: &str) -> PathBuf {
    fixtures_folder().join(format!("{name}.obj"))
}

pub(crate) fn fixtures_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures")
}
