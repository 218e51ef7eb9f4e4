//! The committed fixtures are what the generator makes.

use crate::support::{Folder, fixtures_folder, run};
use std::collections::BTreeSet;
use std::path::Path;

const README: &str = "README.md";

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("text")).collect()
}

#[test]
fn the_fixtures_are_rewritten_bit_for_bit_and_there_are_no_others() {
    let folder = Folder::new();
    let made = folder.path("made");
    let ran = run(["fixtures".as_ref(), made.as_os_str()]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let mut committed = names(&fixtures_folder());
    committed.remove(README);
    assert_eq!(names(&made), committed);
    assert_eq!(ran.stdout.lines().count(), committed.len());
    for name in committed {
        let read = |folder: &Path| std::fs::read(folder.join(&name)).expect("read");
        assert!(read(&made) == read(&fixtures_folder()), "{name}: run `bench-harness fixtures fixtures` to rewrite it");
    }
}

#[test]
fn the_readme_names_every_fixture() {
    let readme = std::fs::read_to_string(fixtures_folder().join(README)).expect("read");
    let missing: Vec<String> = names(&fixtures_folder())
        .into_iter()
        .filter(|name| !readme.contains(&format!("`{name}`")) && name != README)
        .collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn one_shape_is_made_at_any_size() {
    let folder = Folder::new();
    let out = folder.path("band.obj");
    let ran = run(["fixtures", "--shape", "twisted-band", "--triangles", "5000", "-o", out.to_str().expect("text")]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let faces = std::fs::read_to_string(&out).expect("written").lines().filter(|line| line.starts_with("f ")).count();
    assert!(faces.abs_diff(5000) < 1000, "{faces}");
}

#[test]
fn fixtures_asks_for_a_folder_or_for_a_shape_and_a_file() {
    for arguments in
        [&["fixtures"][..], &["fixtures", "--shape", "roll"], &["fixtures", "--shape", "cube", "-o", "a.obj"]]
    {
        assert_eq!(run(arguments).code, 2, "{arguments:?}");
    }
    assert!(run(["fixtures", "--shape", "cube", "-o", "a.obj"]).stderr.contains("twisted-band"));
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = Folder::new();
    let file = folder.file("file", "");
    let ran = run(["fixtures".as_ref(), file.join("below").as_os_str()]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("below: cannot be written"), "{}", ran.stderr);
}
