//! The source of a package, module by module: what each file defines, re-exports and names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, ItemMod, UseTree, Visibility};

/// One file of a package.
#[derive(Debug)]
pub(crate) struct File {
    /// Where it is, from the package's `src`: `run/load.rs`.
    pub(crate) path: String,
    /// Its lines, those of tests blank.
    pub(crate) code: Vec<String>,
    /// How many of its lines only tests see.
    test_lines: usize,
    /// The path of its module, from the root of the crate.
    module: Vec<String>,
    /// The modules inside it that are files of their own.
    children: BTreeSet<String>,
    /// Names that it re-exports, or imports for its own use, with their paths.
    imported: BTreeMap<String, Vec<String>>,
    /// Modules of which everything is imported.
    globs: Vec<Vec<String>>,
    /// Names that it defines.
    defined: BTreeSet<String>,
    /// Every path that its code names, but for those that it re-exports only.
    named: Vec<Vec<String>>,
}

impl File {
    /// Whether the other declares it as its own module.
    fn is_inside(&self, other: &Self) -> bool {
        self.module.split_last().is_some_and(|(name, parent)| parent == other.module && other.children.contains(name))
    }

    /// How many lines it has besides its tests.
    pub(crate) fn lines_without_tests(&self) -> usize {
        self.code.len() - self.test_lines
    }
}

/// All files of a crate that `src/lib.rs` leads to.
#[derive(Debug)]
pub(crate) struct Source(pub(crate) Vec<File>);

impl Source {
    /// Reads a crate from the folder of its sources.
    pub(crate) fn read(folder: &Path) -> Self {
        let mut files = Vec::new();
        read_module(folder, &folder.join("lib.rs"), Vec::new(), &mut files);
        Self(files)
    }

    /// For every file the files that its code uses, by number. A module leads to the modules inside it, and may use them
    /// without an arrow: they may use what it defines. What a file re-exports is not used by it, and whoever imports that
    /// uses the file that defines it.
    pub(crate) fn arrows(&self) -> Vec<BTreeSet<usize>> {
        let of = |(k, file): (usize, &File)| {
            let used = file.named.iter().filter_map(|path| self.defining(k, path, &mut Vec::new()));
            used.filter(|&other| other != k && !self.0[other].is_inside(file)).collect()
        };
        self.0.iter().enumerate().map(of).collect()
    }

    /// The file that defines what `path` means in a file; `None` for other crates.
    fn defining(&self, from: usize, path: &[String], seen: &mut Vec<(usize, Vec<String>)>) -> Option<usize> {
        /// More detours than any real import makes: names that stand for each other.
        const DETOURS: usize = 64;
        if seen.len() > DETOURS || seen.contains(&(from, path.to_vec())) {
            return None;
        }
        seen.push((from, path.to_vec()));
        let file = &self.0[from];
        let (first, rest) = path.split_first()?;
        match first.as_str() {
            "crate" => self.within(0, rest, seen),
            "self" => self.within(from, rest, seen),
            "super" => self.within(self.module(&file.module[..file.module.len().checked_sub(1)?])?, rest, seen),
            _ => self.known_in(from, path, seen),
        }
    }

    /// The file that defines `path` below a module; the module's own where nothing else is known.
    fn within(&self, at: usize, path: &[String], seen: &mut Vec<(usize, Vec<String>)>) -> Option<usize> {
        match path.first().map(String::as_str) {
            None => Some(at),
            Some("super" | "self") => self.defining(at, path, seen),
            Some(_) => self.known_in(at, path, seen),
        }
    }

    fn known_in(&self, at: usize, path: &[String], seen: &mut Vec<(usize, Vec<String>)>) -> Option<usize> {
        let file = &self.0[at];
        let (first, rest) = path.split_first()?;
        if file.defined.contains(first) {
            return Some(at);
        }
        if file.children.contains(first) {
            let child: Vec<String> = file.module.iter().chain([first]).cloned().collect();
            return self.within(self.module(&child)?, rest, seen);
        }
        // A name imported from something of its own name, which is no module of ours: from another crate.
        if let Some(target) = file.imported.get(first).filter(|target| target[0] != *first) {
            let target: Vec<String> = target.iter().chain(rest).cloned().collect();
            return self.defining(at, &target, seen);
        }
        file.globs.iter().find_map(|glob| {
            let target: Vec<String> = glob.iter().chain(path).cloned().collect();
            self.defining(at, &target, seen)
        })
    }

    fn module(&self, path: &[String]) -> Option<usize> {
        self.0.iter().position(|file| file.module == path)
    }
}

/// Reads a file and the modules that it declares.
fn read_module(root: &Path, path: &Path, module: Vec<String>, files: &mut Vec<File>) {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut reader = Reader { tests: Vec::new(), file: empty(root, path, module) };
    reader.visit_file(&parsed);
    let Reader { tests, mut file } = reader;
    let is_test = |line: usize| tests.iter().any(|&(first, last)| (first..=last).contains(&line));
    let code = text.lines().enumerate().map(|(k, line)| if is_test(k + 1) { "" } else { line }.to_owned());
    file.code = code.collect();
    file.test_lines = (1..=file.code.len()).filter(|&line| is_test(line)).count();
    let is_root = ["lib.rs", "mod.rs"].iter().any(|name| path.ends_with(name));
    let folder = if is_root { path.with_file_name("") } else { path.with_extension("") };
    let (children, module) = (file.children.clone(), file.module.clone());
    files.push(file);
    for child in children {
        let beside = folder.join(format!("{child}.rs"));
        let path = if beside.is_file() { beside } else { folder.join(&child).join("mod.rs") };
        read_module(root, &path, module.iter().cloned().chain([child]).collect(), files);
    }
}

fn empty(root: &Path, path: &Path, module: Vec<String>) -> File {
    File {
        path: path.strip_prefix(root).expect("below src").to_string_lossy().replace('\\', "/"),
        code: Vec::new(),
        test_lines: 0,
        module,
        children: BTreeSet::new(),
        imported: BTreeMap::new(),
        globs: Vec::new(),
        defined: BTreeSet::new(),
        named: Vec::new(),
    }
}

/// Collects what a file says; what only tests see is left out.
struct Reader {
    /// First and last lines of what only tests see.
    tests: Vec<(usize, usize)>,
    file: File,
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item(&mut self, item: &'ast Item) {
        if attributes(item).iter().any(is_for_tests) {
            let first = attributes(item).iter().map(|a| a.span().start().line).min();
            let own = item.span();
            self.tests.push((first.unwrap_or(own.start().line), own.end().line));
            return;
        }
        match item {
            Item::Use(item) => {
                let is_exported = !matches!(item.vis, Visibility::Inherited);
                self.import(&item.tree, Vec::new(), is_exported);
            }
            Item::Mod(ItemMod { ident, content: None, .. }) => {
                self.file.children.insert(ident.to_string());
            }
            _ => {
                self.file.defined.extend(name(item));
                visit::visit_item(self, item);
            }
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        // What is one word long was imported, and is counted there.
        if names.len() > 1 && path.leading_colon.is_none() {
            self.file.named.push(names);
        }
        visit::visit_path(self, path);
    }
}

impl Reader {
    fn import(&mut self, tree: &UseTree, before: Vec<String>, is_exported: bool) {
        let with = |name: &syn::Ident| before.iter().cloned().chain([name.to_string()]).collect::<Vec<_>>();
        match tree {
            UseTree::Path(path) => self.import(&path.tree, with(&path.ident), is_exported),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, before.clone(), is_exported)),
            UseTree::Glob(_) => {
                if !is_exported {
                    self.file.named.push(before.clone());
                }
                self.file.globs.push(before);
            }
            UseTree::Name(name) if name.ident == "self" => {
                self.bind(before.last().cloned().unwrap_or_default(), before.clone(), is_exported);
            }
            UseTree::Name(name) => self.bind(name.ident.to_string(), with(&name.ident), is_exported),
            UseTree::Rename(rename) => self.bind(rename.rename.to_string(), with(&rename.ident), is_exported),
        }
    }
}

impl Reader {
    /// Notes that a name stands for a path.
    fn bind(&mut self, name: String, path: Vec<String>, is_exported: bool) {
        if !is_exported {
            self.file.named.push(path.clone());
        }
        self.file.imported.insert(name, path);
    }
}

/// Whether only tests see an item.
fn is_for_tests(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Ident>().is_ok_and(|condition| condition == "test")
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn name(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Mod(item) => &item.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}
