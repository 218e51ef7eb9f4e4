//! Where a mesh comes from.

use crate::record::failure::Failure;
use abf_mesh::io::{GltfDocument, MeshFile, MeshFormat, ReadNotes, read};
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

    /// Its file, if that is an OBJ.
    pub(crate) fn obj(&self) -> Option<&PathBuf> {
        match self {
            Self::File(path) if MeshFormat::of_input(path) == Some(MeshFormat::Obj) => Some(path),
            _ => None,
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

    /// Reads it; of a glTF the document, too.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub(crate) fn read(&self) -> Result<(MeshFile, Option<Box<Gltf>>), Failure> {
        let failed = |error| Failure::read(&error);
        match self {
            Self::File(path) => match MeshFormat::of_input(path) {
                Some(format) if format.is_gltf() && !path.is_dir() => {
                    let document = GltfDocument::read(path).map_err(failed)?;
                    let surface = document.surface().map_err(failed)?;
                    let materials = surface.material_of_faces();
                    let file = MeshFile { mesh: surface.mesh, uv: surface.uv, notes: surface.notes };
                    Ok((file, Some(Box::new(Gltf { document, materials }))))
                }
                _ => Ok((read(path).map_err(failed)?, None)),
            },
            Self::Builtin => {
                let file = MeshFile { mesh: default_fixture().mesh(), uv: None, notes: ReadNotes::default() };
                Ok((file, None))
            }
        }
    }
}

/// A glTF document, to be written with other UVs.
#[derive(Debug)]
pub(crate) struct Gltf {
    /// Everything in it.
    pub(crate) document: GltfDocument,
    /// The material of every face of its surface.
    pub(crate) materials: Vec<u32>,
}

fn default_fixture() -> Fixture {
    let mut all = fixtures().into_iter();
    all.find(|fixture| fixture.name == DEFAULT_FIXTURE).expect("the default fixture is a fixture")
}
