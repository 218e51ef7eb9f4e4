//! The laws of ARCHITECTURE.md, as tests.

#[path = "architecture/source.rs"]
mod source;

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, Package};
use source::Source;
use std::collections::BTreeSet;

/// Every crate and its layer. A crate may use crates of lower layers only, so crates of one layer
/// never see each other.
const LAYERS: &[(&str, u32)] = &[
    ("abf-control", 0),
    ("abf-parallel", 0),
    ("abf-mesh", 1),
    ("abf-linalg", 1),
    ("abf-pack", 1),
    ("abf-shapes", 2),
    ("abf-constraints", 2),
    ("abf-multires", 2),
    ("abf-overlap", 2),
    ("abf-solve-core", 3),
    ("abf-reconstruct", 4),
    ("abf-metrics", 4),
    ("abf-embed", 4),
    ("abf-cut", 4),
    ("abf", 5),
    ("abf-report", 5),
    ("abf-python", 6),
    ("abf-capi", 6),
    ("bench-harness", 6),
];

/// What the names of solvers begin with, and their layer. `abf-solve-core`, below them, is listed.
const SOLVERS: (&str, u32) = ("abf-solve-", 4);

/// The crate that takes pointers. It repeats the lints of the workspace, but that it denies `unsafe_code` instead of forbidding it.
const WITH_POINTERS: &str = "abf-capi";

/// The crate of test meshes, which tests of its own layer may use, too.
const TEST_MESHES: &str = "abf-shapes";

/// The rooms of a crate, floor by floor. A file may use those of its own room and of lower floors only, so rooms of one
/// floor never see each other; files in no room are above them all.
const ROOMS: &[(&str, &[&[&str]])] = &[
    (
        "abf",
        &[
            &["settings"],
            &["error"],
            &["precision_limits"],
            &["flattening"],
            &["solve_report"],
            &["run"],
            &["unwrap"],
            &["atlas"],
            &["pattern"],
            &["arrays"],
        ],
    ),
    (
        "bench-harness",
        &[
            &["record"],
            &["cli"],
            &["show"],
            &["run"],
            &[
                "commands/compare",
                "commands/fixtures",
                "commands/flatten",
                "commands/metrics",
                "commands/pack",
                "commands/survey",
            ],
        ],
    ),
];

/// The most lines of a file, without its tests.
const MOST_LINES: usize = 400;

fn metadata() -> Metadata {
    MetadataCommand::new().no_deps().exec().expect("cargo metadata runs inside the workspace")
}

fn layer(name: &str) -> Option<u32> {
    let listed = LAYERS.iter().find(|(known, _)| *known == name).map(|(_, layer)| *layer);
    listed.or_else(|| name.starts_with(SOLVERS.0).then_some(SOLVERS.1))
}

fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    package.dependencies.iter().filter(|d| d.kind == DependencyKind::Normal).map(|d| d.name.as_str())
}

/// The source of a package, and its folder's name.
fn source(package: &Package) -> (String, Source) {
    let root = package.manifest_path.parent().expect("a manifest has a folder");
    (root.file_name().expect("crates/<folder>").to_owned(), Source::read(root.join("src").as_std_path()))
}

/// Files of library code, but for those below `allowed`, whose code holds one of `words`.
fn offenders(words: &[&str], allowed: &[&str]) -> Vec<String> {
    let mut found = Vec::new();
    for package in metadata().packages {
        let (folder, Source(files)) = source(&package);
        for file in files {
            let shown = format!("{folder}/src/{}", file.path);
            let lines = file.code.iter().filter(|line| !line.trim_start().starts_with("//"));
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
fn tests_use_no_crate_that_their_own_could_not_use() {
    for package in metadata().packages {
        let own = layer(&package.name).expect("a layer");
        for dependency in package.dependencies.iter().filter(|d| d.kind == DependencyKind::Development) {
            if let Some(other) = layer(&dependency.name) {
                let is_allowed = other < own || (other == own && dependency.name == TEST_MESHES);
                assert!(is_allowed, "tests of {} (layer {own}) use {} (layer {other})", package.name, dependency.name);
            }
        }
    }
}

#[test]
fn rooms_use_lower_floors_only() {
    let mut wrong = Vec::new();
    for package in metadata().packages {
        let Some((name, floors)) = ROOMS.iter().find(|(name, _)| *name == *package.name) else { continue };
        let (_, source) = source(&package);
        let rooms: Vec<(usize, &str)> =
            floors.iter().enumerate().flat_map(|(floor, rooms)| rooms.iter().map(move |&room| (floor, room))).collect();
        for &(_, room) in &rooms {
            assert!(source.0.iter().any(|file| is_in(&file.path, room)), "{name} has no room {room}");
        }
        let room = |file: usize| rooms.iter().find(|(_, room)| is_in(&source.0[file].path, room));
        for (from, used) in source.arrows().iter().enumerate() {
            for &to in used {
                let is_down = match (room(from), room(to)) {
                    (Some((from, a)), Some((to, b))) => to < from || a == b,
                    (Some(_), None) => false,
                    (None, _) => true,
                };
                if !is_down {
                    wrong.push(format!("{name}: {} uses {}", source.0[from].path, source.0[to].path));
                }
            }
        }
    }
    assert_eq!(wrong, [""; 0]);
}

/// Whether a file is in a room: a folder, or a single file.
fn is_in(path: &str, room: &str) -> bool {
    path.strip_prefix(room).is_some_and(|rest| rest.starts_with('/') || rest == ".rs")
}

#[test]
fn no_file_is_in_a_circle_of_imports() {
    let mut circles = Vec::new();
    for package in metadata().packages {
        let (folder, source) = source(&package);
        let arrows = source.arrows();
        let reached: Vec<BTreeSet<usize>> = (0..arrows.len()).map(|from| reach(&arrows, from)).collect();
        for (file, used) in arrows.iter().enumerate() {
            for &other in used.iter().filter(|&&other| reached[other].contains(&file)) {
                circles.push(format!("{folder}: {} uses {}", source.0[file].path, source.0[other].path));
            }
        }
    }
    assert_eq!(circles, [""; 0]);
}

/// The files that can be reached from one, itself only if it is in a circle.
fn reach(arrows: &[BTreeSet<usize>], from: usize) -> BTreeSet<usize> {
    let mut reached = BTreeSet::new();
    let mut next: Vec<usize> = arrows[from].iter().copied().collect();
    while let Some(file) = next.pop() {
        if reached.insert(file) {
            next.extend(&arrows[file]);
        }
    }
    reached
}

#[test]
fn files_are_short_enough_to_be_read() {
    let mut long = Vec::new();
    for package in metadata().packages {
        let (folder, Source(files)) = source(&package);
        for file in files {
            let (path, lines) = (format!("{folder}/src/{}", file.path), file.lines_without_tests());
            if lines > MOST_LINES {
                long.push(format!("{path}: {lines} lines"));
            }
        }
    }
    assert_eq!(long, [""; 0]);
}

#[test]
fn only_linalg_names_faer() {
    for package in metadata().packages {
        assert!(*package.name == "abf-linalg" || dependencies(&package).all(|d| d != "faer"), "{}", package.name);
    }
}

#[test]
fn only_parallel_and_the_program_name_rayon() {
    for package in metadata().packages {
        let names_it = package.dependencies.iter().any(|d| d.name == "rayon");
        assert_eq!(names_it, ["abf-parallel", "bench-harness"].contains(&package.name.as_str()), "{}", package.name);
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
    let allowed = ["bench-harness/", "control/src/"];
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
        if *package.name != WITH_POINTERS {
            assert!(manifest.contains("[lints]\nworkspace = true"), "{} sets its own lints", package.name);
        }
        let own: Vec<&str> = manifest.lines().filter(|line| line.contains("version = \"")).collect();
        assert!(own.is_empty(), "{} names versions of its own: {own:?}", package.name);
    }
}

#[test]
fn the_crate_with_pointers_has_the_lints_of_the_workspace_but_one() {
    let metadata = metadata();
    let root = std::fs::read_to_string(metadata.workspace_root.join("Cargo.toml")).expect("a manifest");
    let package = metadata.packages.iter().find(|package| *package.name == WITH_POINTERS).expect("the C interface");
    let own = std::fs::read_to_string(&package.manifest_path).expect("a manifest");
    for tool in ["rust", "clippy"] {
        let shared: Vec<String> = section(&root, &format!("[workspace.lints.{tool}]"))
            .map(|line| line.replace("unsafe_code = \"forbid\"", "unsafe_code = \"deny\""))
            .collect();
        assert!(!shared.is_empty());
        assert_eq!(section(&own, &format!("[lints.{tool}]")).collect::<Vec<_>>(), shared);
    }
}

/// The settings under a head of a manifest.
fn section<'a>(manifest: &'a str, head: &'a str) -> impl Iterator<Item = &'a str> {
    let lines =
        manifest.lines().skip_while(move |line| *line != head).skip(1).take_while(|line| !line.starts_with('['));
    lines.filter(|line| !line.is_empty() && !line.starts_with('#'))
}

#[test]
fn only_the_entry_points_of_the_c_interface_are_unsafe() {
    let allowed = ["allow(unsafe_code", "expect(unsafe_code"];
    assert_eq!(offenders(&allowed, &["capi/src/entry/"]), [""; 0]);
}
