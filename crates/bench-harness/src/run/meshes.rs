//! Which meshes are meant.

use crate::record::failure::Failure;
use abf_mesh::io::MeshFormat;
use std::fs;
use std::path::{Path, PathBuf};

/// How far into a folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// The files that lie in it.
    Inside,
    /// All below it.
    Below,
}

/// The meshes that are named, in order, and in the place of a folder those in it, sorted. What is
/// hidden is left out, and so are links to folders, which could go round in circles.
///
/// # Errors
/// A name that leads nowhere, a folder that cannot be read, or one that has no mesh.
pub(crate) fn find(named: &[PathBuf], depth: Depth) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for path in named {
        if path.is_dir() {
            let mut below = Vec::new();
            add_files(path, depth, &mut below)?;
            if below.is_empty() {
                return Err(Failure::no_meshes(path));
            }
            below.sort();
            found.append(&mut below);
        } else {
            // A name that leads nowhere is a slip of whoever typed it, not a mesh that has failed.
            fs::metadata(path).map_err(|error| Failure::unreadable(path, &error))?;
            found.push(path.clone());
        }
    }
    Ok(found)
}

fn add_files(folder: &Path, depth: Depth, found: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let unreadable = |error| Failure::unreadable(folder, &error);
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(unreadable)?);
        if entry.file_name().as_encoded_bytes().starts_with(b".") {
            continue;
        }
        if kind.is_dir() {
            if depth == Depth::Below {
                add_files(&path, depth, found)?;
            }
        } else if MeshFormat::of_input(&path).is_some() && path.is_file() {
            found.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::kind::FailureKind;

    #[test]
    fn a_folder_stands_for_every_mesh_in_it_or_below_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for name in ["b/inner", ".hidden", "empty"] {
            fs::create_dir_all(at(name)).expect("a folder");
        }
        for name in ["c.obj", "a.PLY", "b/inner/z.stl", "b/notes.txt", ".hidden/x.obj"] {
            fs::write(at(name), "").expect("written");
        }
        let found = find(&[at("b/notes.txt"), folder.path().to_owned()], Depth::Below).expect("meshes");
        assert_eq!(found, [at("b/notes.txt"), at("a.PLY"), at("b/inner/z.stl"), at("c.obj")]);
        let inside = find(&[folder.path().to_owned()], Depth::Inside).expect("meshes");
        assert_eq!(inside, [at("a.PLY"), at("c.obj")]);
        assert_eq!(find(&[at("empty")], Depth::Below).unwrap_err().kind, FailureKind::NoMeshes);
        assert_eq!(find(&[at("c.obj"), at("missing")], Depth::Below).unwrap_err().kind, FailureKind::NotFound);
    }
}
