//! Writing the fixture meshes.

use crate::cli::args::FixturesArgs;
use crate::record::Outcome;
use crate::record::failure::Failure;
use crate::show::console;
use abf_mesh::{TriMesh, io};
use abf_shapes::fixtures;
use std::path::Path;

/// Writes what is asked for and lists it.
pub(crate) fn write(args: FixturesArgs) -> Outcome {
    let written = match (args.dir, args.shape, args.output) {
        (Some(dir), ..) => write_all(&dir),
        (None, Some(shape), Some(path)) => write_one(&path, &shape.mesh(args.triangles)),
        _ => unreachable!("the command line asks for a folder, or for a shape and a file"),
    };
    match written {
        Ok(()) => Outcome::AsAsked,
        Err(failure) => {
            console::failure(&failure);
            Outcome::Failed
        }
    }
}

fn write_all(dir: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(dir).map_err(|error| Failure::unwritable(&dir.display().to_string(), &error))?;
    fixtures().iter().try_for_each(|fixture| write_one(&dir.join(format!("{}.obj", fixture.name)), &fixture.mesh()))
}

fn write_one(path: &Path, mesh: &TriMesh) -> Result<(), Failure> {
    io::write(path, mesh, None).map_err(|error| Failure::write(path, &error))?;
    let (triangles, vertices) = (mesh.face_count(), mesh.vertex_count());
    console::data(&format!("{}: {triangles} triangles, {vertices} vertices\n", path.display()))
}
