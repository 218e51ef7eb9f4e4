//! The laws of ARCHITECTURE.md, as tests.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Every crate and its layer. A crate may use crates of lower layers only, so crates of one layer
/// never see each other.
const LAYERS: &[(&str, u32)] = &[
    ("abf-mesh", 0),
    ("abf-linalg", 0),
    ("abf-shapes", 1),
    ("abf-constraints", 1),
    ("abf-solve-core", 2),
    ("abf-solve-linabf", 3),
    ("abf-solve-abf-newton", 3),
    ("abf-solve-uzawa", 3),
    ("abf-solve-minres", 3),
    ("abf-solve-barrier", 3),
    ("abf-reconstruct", 3),
    ("abf-metrics", 3),
    ("abf-embed", 3),
    ("abf-cut", 3),
    ("abf", 4),
    ("abf-report", 4),
    ("bench-harness", 5),
];

fn metadata() -> Metadata {
    MetadataCommand::new().no_deps().exec().expect("cargo metadata runs inside the workspace")
}

fn layer(name: &str) -> Option<u32> {
    LAYERS.iter().find(|(known, _)| *known == name).map(|(_, layer)| *layer)
}

fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal).map(|d| d.name.as_str())
}

/// Every Rust source file below `folder`, with its text up to the first test module.
fn sources(folder: &Path) -> BTreeMap<PathBuf, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a readable folder") {
            let path = entry.expect("a readable entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).expect("UTF-8");
                let code = text.split("#[cfg(test)]").next().unwrap_or_default().to_owned();
                found.insert(path, code);
            }
        }
    }
    found
}

/// Files of library code, but for those below `allowed`, whose code holds one of `words`.
fn offenders(words: &[&str], allowed: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for package in metadata().packages {
        let root = package.manifest_path.parent().expect("a manifest has a folder").to_path_buf();
        for (path, code) in sources(root.join("src").as_std_path()) {
            let shown =
                path.strip_prefix(root.parent().expect("crates/")).expect("below crates/").display().to_string();
            let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            let hit = lines.into_iter().any(|line| words.iter().any(|word| line.contains(word)));
            if hit && !allowed.iter().any(|prefix| shown.starts_with(prefix)) {
                found.push(shown);
            }
        }
    }
    found
}

#[test]
fn every_crate_has_a_layer_and_its_name_says_its_folder() {
    for package in metadata().packages {
        assert!(layer(&package.name).is_some(), "give {} a layer in ARCHITECTURE.md and here", package.name);
        let folder = package.manifest_path.parent().and_then(|p| p.file_name()).expect("crates/<folder>");
        let expected =
            if ["abf", "bench-harness"].contains(&folder) { folder.to_owned() } else { format!("abf-{folder}") };
        assert_eq!(*package.name, expected);
    }
}

#[test]
fn dependencies_go_down_only() {
    for package in metadata().packages {
        let own = layer(&package.name).expect("a layer");
        for dependency in dependencies(&package) {
            if let Some(other) = layer(dependency) {
                assert!(other < own, "{} (layer {own}) uses {dependency} (layer {other})", package.name);
            }
        }
    }
}

#[test]
fn only_linalg_names_faer() {
    for package in metadata().packages {
        assert!(*package.name == "abf-linalg" || dependencies(&package).all(|d| d != "faer"), "{}", package.name);
    }
}

#[test]
fn only_the_program_prints() {
    let prints = ["println!", "eprintln!", "print!(", "eprint!(", "dbg!("];
    assert_eq!(offenders(&prints, &["bench-harness/"]), [""; 0]);
}

#[test]
fn clocks_are_read_in_the_program_and_behind_the_time_limit_only() {
    let clocks = ["Instant::now", "SystemTime::now", ".elapsed()"];
    let allowed = ["bench-harness/", "solve-core/src/stop.rs", "solve-core/src/observe.rs"];
    assert_eq!(offenders(&clocks, &allowed), [""; 0]);
}

#[test]
fn only_mesh_io_and_the_program_touch_files() {
    let files = ["std::fs", "File::open", "File::create", "fs::read", "fs::write"];
    assert_eq!(offenders(&files, &["bench-harness/", "mesh/src/io/"]), [""; 0]);
}

#[test]
fn every_crate_takes_its_lints_and_versions_from_the_workspace() {
    for package in metadata().packages {
        let manifest = std::fs::read_to_string(&package.manifest_path).expect("a manifest");
        assert!(manifest.contains("[lints]\nworkspace = true"), "{} sets its own lints", package.name);
        let own: Vec<&str> = manifest.lines().filter(|line| line.contains("version = \"")).collect();
        assert!(own.is_empty(), "{} names versions of its own: {own:?}", package.name);
    }
}
