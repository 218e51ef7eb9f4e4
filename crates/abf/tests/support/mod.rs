//! Where the tests on real meshes find them.
//!
//! `ABF_MODELS` names the folder that holds `paper/` and `disks/`; the meshes belong to others and
//! are not in the repository. Not named: the number of skipped checks is printed. Named but missing:
//! an error.

use abf::mesh::{TriMesh, io};
use std::path::{Path, PathBuf};

/// The folder of models, or `None` after saying what is skipped.
pub(crate) fn models(checks: usize) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("ABF_MODELS").map(PathBuf::from) else {
        println!("ABF_MODELS is not set: {checks} checks skipped");
        return None;
    };
    assert!(folder.is_dir(), "ABF_MODELS names {}, which is not a folder", folder.display());
    Some(folder)
}

/// One of the models.
pub(crate) fn read(folder: &Path, name: &str) -> TriMesh {
    io::read(&folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}")).mesh
}
