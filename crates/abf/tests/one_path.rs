//! Every public type has one path.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The libraries, by their folders.
fn crates() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the folder of the crates");
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut crates: Vec<PathBuf> = entries.filter(|path| path.join("src/lib.rs").is_file()).collect();
    crates.sort();
    crates
}

/// The source of a module without tests, comments and preludes: those repeat traits, so that one line brings them all.
fn source(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut kept = String::new();
    let mut is_prelude = false;
    for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
        is_prelude |= line.starts_with("pub mod prelude {");
        if !is_prelude {
            kept.extend([line, "\n"]);
        }
        is_prelude &= line != "}";
    }
    kept
}

/// What the files of one folder make public, with the path of each name.
#[derive(Default)]
struct Paths(BTreeMap<String, Vec<String>>);

impl Paths {
    /// What a module makes public; its own modules are in `folder`.
    fn of_module(&mut self, text: &str, folder: &Path, path: &str) {
        for line in text.lines() {
            let words: Vec<&str> = line.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
            if let ["pub", "struct" | "enum" | "trait" | "type" | "union", name, ..] = words[..] {
                self.add(path, name);
            }
        }
        for (at, _) in text.match_indices("pub use ") {
            let used = text[at + 8..].split(';').next().unwrap_or_default();
            self.of_use(&used.split_whitespace().collect::<String>(), folder, path);
        }
        for (at, _) in text.match_indices("pub mod ") {
            let name: String = text[at + 8..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if text[at + 8 + name.len()..].starts_with(';') {
                self.of_file(&name, folder, &format!("{path}::{name}"));
            }
        }
    }

    fn of_file(&mut self, module: &str, folder: &Path, path: &str) {
        let inner = folder.join(module);
        let file = folder.join(format!("{module}.rs"));
        let file = if file.is_file() { file } else { inner.join("mod.rs") };
        self.of_module(&source(&file), &inner, path);
    }

    /// The names in `a::{B, C as D}`, `a::B` and `a::*`.
    fn of_use(&mut self, used: &str, folder: &Path, path: &str) {
        let (from, names) = used.split_once('{').unwrap_or_else(|| used.rsplit_once("::").unwrap_or(("", used)));
        for name in names.trim_end_matches('}').split(',').filter(|name| !name.is_empty()) {
            match name.split_once("as") {
                // Globs of other crates are of traits.
                _ if name == "*" && !from.trim_end_matches("::").contains("::") => {
                    self.of_file(from.trim_end_matches("::"), folder, path);
                }
                // A whole crate, as a module.
                Some((whole, module)) if from.is_empty() && whole.starts_with("abf_") => {
                    let whole = whole.replace('_', "-");
                    let of_crate =
                        |c: &PathBuf| format!("abf-{}", c.file_name().unwrap_or_default().display()) == whole;
                    let found = crates().into_iter().find(of_crate).unwrap_or_else(|| panic!("no crate {whole}"));
                    self.of_module(
                        &source(&found.join("src/lib.rs")),
                        &found.join("src"),
                        &format!("{path}::{module}"),
                    );
                }
                _ => self.add(path, name),
            }
        }
    }

    /// Functions and modules are no types.
    fn add(&mut self, path: &str, name: &str) {
        if name.starts_with(char::is_uppercase) && name.contains(char::is_lowercase) {
            self.0.entry(name.to_owned()).or_default().push(format!("{path}::{name}"));
        }
    }

    fn of_crate(folder: &Path) -> Self {
        let mut paths = Self::default();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let text = source(&folder.join("src/lib.rs"));
        // Modules in braces are read as what they re-export.
        let inline = text.split("\npub mod ").skip(1).filter(|rest| rest.split_whitespace().nth(1) == Some("{"));
        for module in inline {
            let inner = module.split("\n}").next().unwrap_or_default();
            let label = module.split_whitespace().next().unwrap_or_default();
            paths.of_module(inner, &folder.join("src").join(label), &format!("{name}::{label}"));
        }
        let mut outside = String::new();
        for (i, part) in text.split("\npub mod ").enumerate() {
            let is_inline = i > 0 && part.split_whitespace().nth(1) == Some("{");
            let kept = if is_inline { part.split_once("\n}").map_or("", |(_, rest)| rest) } else { part };
            outside.push_str(if i > 0 && !is_inline { "\npub mod " } else { "\n" });
            outside.push_str(kept);
        }
        paths.of_module(&outside, &folder.join("src"), &name);
        paths
    }
}

#[test]
fn every_public_type_has_one_path() {
    let mut twice = Vec::new();
    let mut all = 0;
    for folder in crates().iter().filter(|folder| !folder.ends_with("bench-harness")) {
        let Paths(found) = Paths::of_crate(folder);
        all += found.len();
        twice.extend(found.into_values().filter(|paths| paths.len() > 1).map(|paths| paths.join(" and ")));
    }
    assert!(all > 200, "only {all} types were found");
    assert!(twice.is_empty(), "types with two paths: {twice:#?}");
}

#[test]
fn the_facade_offers_the_types_that_its_documents_name() {
    let Paths(found) = Paths::of_crate(Path::new(env!("CARGO_MANIFEST_DIR")));
    let path = |name: &str| found.get(name).map(|paths| paths.join(" and "));
    for (name, expected) in [
        ("Solver", "abf::Solver"),
        ("LinAbf", "abf::LinAbf"),
        ("AngleProblem", "abf::constraints::AngleProblem"),
        ("TriMesh", "abf::mesh::TriMesh"),
        ("MeshFormat", "abf::mesh::io::MeshFormat"),
        ("EmbedError", "abf::embed::EmbedError"),
        ("Metrics", "abf::Metrics"),
    ] {
        assert_eq!(path(name).as_deref(), Some(expected));
    }
}
