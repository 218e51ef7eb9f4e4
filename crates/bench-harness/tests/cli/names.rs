//! The program under both its names, and what it says of itself.

use crate::support::{Folder, Ran, fixture, program, run, run_on};
use crate::surfaces;
use std::process::Command;

#[test]
fn the_program_is_the_same_under_both_names_and_says_the_one_it_was_called_by() {
    for (name, path) in [("abf", env!("CARGO_BIN_EXE_abf")), ("bench-harness", env!("CARGO_BIN_EXE_bench-harness"))] {
        let run = |args: &[&str]| Ran::new(Command::new(path).args(args).output().expect("the program starts"));
        let (short, long) = (run(&["-h"]), run(&["--help"]));
        assert!(short.stdout.contains(&format!("Usage: {name} [OPTIONS]")), "{}", short.stdout);
        assert!(long.stdout.contains("--ring-switch") && !short.stdout.contains("--ring-switch"), "{}", short.stdout);
        assert!(run(&["--version"]).stdout.starts_with(&format!("{name} ")));
        let wrong = run(&["--solver", "slim"]);
        assert_eq!(wrong.code, 2);
        let wrong = run(&["a.obj", "--disks-only", "--seams", "auto"]);
        assert!(wrong.stderr.contains(&format!("Usage: {name}")), "{}", wrong.stderr);
        let json = run(&[fixture("pyramid").to_str().expect("text"), "--json", "-"]).json();
        assert_eq!((&json["program"]["name"], &json["machine"]["os"]), (&"abf".into(), &std::env::consts::OS.into()));
        assert!(json["date"].as_str().expect("a date").ends_with('Z'), "{json}");
    }
}

#[test]
fn completions_and_the_manual_are_printed() {
    for what in ["complete-bash", "complete-zsh", "complete-fish", "man"] {
        let ran = run(["--generate", what]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stdout.contains("bench-harness") && ran.stdout.contains("seam"), "{what}: {}", ran.stdout);
    }
    assert_eq!(run(["--generate", "man", "a.obj"]).code, 2, "it goes with nothing else");
}

/// The options that a text names.
fn options(text: &str) -> Vec<&str> {
    let is_part = |c: char| c.is_ascii_lowercase() || c == '-';
    let words = text.split(|c| !is_part(c)).filter(|word| word.starts_with("--") && word.len() > 2);
    words.map(|word| word.trim_end_matches('-')).collect()
}

#[test]
fn compare_names_no_option_that_it_does_not_take() {
    let folder = Folder::new();
    let files = [
        folder.file("two.obj", surfaces::two_components()),
        folder.file("edge.obj", surfaces::non_manifold_edge()),
        folder.file("empty.obj", ""),
        folder.file("torus.obj", surfaces::torus()),
        fixture("obtuse"),
    ];
    let files: Vec<&std::path::Path> = files.iter().map(AsRef::as_ref).collect();
    let taken = run(["compare", "--help"]).stdout;
    let mut said =
        vec![run_on("compare --repeats 1 --warmup 0 --solver linabf,lscm,descent --max-iterations 1", &files)];
    for wrong in
        ["--tolerance -1", "--solver uzawa --wheel product", "--passes 3 --solver lscm", "--report -", "--slim"]
    {
        said.push(run_on(&format!("compare {wrong}"), &files));
    }
    for ran in said {
        assert_ne!(ran.code, 0, "{}", ran.stdout);
        for option in options(&ran.stdout).into_iter().chain(options(&ran.stderr)) {
            assert!(taken.contains(option) || option == "--slim", "{option}: {}{}", ran.stdout, ran.stderr);
        }
    }
    let usage = run_on("compare --tolerance -1", &files);
    assert!(usage.stderr.contains("Usage: bench-harness compare"), "{}", usage.stderr);
}

#[test]
fn a_failure_says_where_as_data() {
    let folder = Folder::new();
    let file = folder.file("two.obj", surfaces::two_components());
    let json = run_on("--disks-only --json -", &[&file]).result();
    assert_eq!(json["error"]["at"], serde_json::json!({"faces": [1]}));
    let file = folder.file("bad.obj", "v 0 0 0\nv 1 x 0\n");
    let json = Ran::new(program().arg(&file).args(["--json", "-"]).output().expect("the program starts")).result();
    assert_eq!(json["error"]["at"], serde_json::json!({"line": 2}));
}
