//! Where a mesh comes from.

use crate::errors::Failure;
use abf_mesh::io::{MeshFile, ReadNotes, read};
use abf_shapes::{DEFAULT_FIXTURE, Fixture, fixtures};
use std::fs;
use std::path::PathBuf;

/// One mesh to flatten.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// A file.
    File(PathBuf),
    /// The default fixture, made in memory so that an installed program has it too; the committed
    /// file holds the same bits.
    Builtin,
}

impl Source {
    /// What it is called in the output.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Builtin => format!("fixtures/{DEFAULT_FIXTURE}.obj (builtin)"),
        }
    }

    /// About how many bytes reading it takes at most, the mesh included; 0 where that cannot be told.
    pub(crate) fn memory_to_read(&self) -> u64 {
        /// Bytes in memory per byte of a file: a binary STL, whose corners are compared, has the most.
        const BYTES_PER_BYTE: u64 = 5;
        match self {
            Self::File(path) => fs::metadata(path).map_or(0, |about| BYTES_PER_BYTE.saturating_mul(about.len())),
            Self::Builtin => 0,
        }
    }

    /// Reads it.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub(crate) fn read(&self) -> Result<MeshFile, Failure> {
        match self {
            Self::File(path) => read(path).map_err(|error| Failure::read(&error)),
            Self::Builtin => Ok(MeshFile { mesh: default_fixture().mesh(), uv: None, notes: ReadNotes::default() }),
        }
    }
}

fn default_fixture() -> Fixture {
    let mut all = fixtures().into_iter();
    all.find(|fixture| fixture.name == DEFAULT_FIXTURE).expect("the default fixture is a fixture")
}
