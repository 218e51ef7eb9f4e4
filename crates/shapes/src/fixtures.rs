//! The meshes that are kept as files.

use crate::Shape;
use abf_mesh::TriMesh;

/// The fixture that the program flattens when no mesh is named.
pub const DEFAULT_FIXTURE: &str = "mask";

/// A mesh that is kept as a file, and how it is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Fixture {
    /// The file's name without its extension.
    pub name: &'static str,
    /// The shape.
    pub shape: Shape,
    /// The number of triangles asked for; the mesh has about as many.
    pub triangles: usize,
}

impl Fixture {
    /// Generates the mesh; a committed file holds exactly these coordinates.
    #[must_use]
    pub fn mesh(&self) -> TriMesh {
        self.shape.mesh(self.triangles)
    }
}

/// Every fixture, small ones first but for the default one, which leads.
///
/// Each shape occurs once under its own name; `bumpy-sheet` has the size of the Ear of the 2004
/// paper (1 796 triangles), and `mask-coarse` is the default model at a size that every solver
/// handles in a test.
#[must_use]
pub fn fixtures() -> Vec<Fixture> {
    let named = |shape: Shape, triangles| Fixture { name: shape.name(), shape, triangles };
    vec![
        named(Shape::Mask, 20_000),
        named(Shape::Obtuse, 3),
        named(Shape::Pyramid, 150),
        named(Shape::Spike, 150),
        named(Shape::Roll, 400),
        named(Shape::FoldedSheet, 512),
        named(Shape::Hemisphere, 600),
        named(Shape::LetterV, 1_000),
        named(Shape::LetterX, 1_200),
        Fixture { name: "mask-coarse", shape: Shape::Mask, triangles: 1_350 },
        named(Shape::Letter2, 1_500),
        named(Shape::TwistedBand, 1_600),
        named(Shape::BumpySheet, 1_800),
        named(Shape::WavySaddle, 2_400),
        named(Shape::SpikyField, 2_600),
        named(Shape::Caterpillar, 3_000),
        named(Shape::Cyclide, 3_200),
        named(Shape::FatDisk, 3_750),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Bytes of the mesh as a Wavefront OBJ file.
    fn obj_bytes(mesh: &TriMesh) -> usize {
        let vertices = mesh.positions().iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z).len());
        let faces = mesh.faces().iter().map(|f| format!("f {} {} {}\n", f[0], f[1], f[2]).len() - 3);
        vertices.chain(faces).sum()
    }

    #[test]
    fn every_shape_has_a_fixture_and_names_are_unique() {
        let fixtures = fixtures();
        let names: HashSet<_> = fixtures.iter().map(|f| f.name).collect();
        assert_eq!(names.len(), fixtures.len());
        assert!(Shape::ALL.iter().all(|s| names.contains(s.name())));
    }

    #[test]
    fn the_default_fixture_is_listed_and_has_twenty_thousand_triangles() {
        let all = fixtures();
        let default = all.iter().find(|f| f.name == DEFAULT_FIXTURE).expect("listed");
        assert!(default.mesh().face_count().abs_diff(20_000) < 400);
    }

    #[test]
    fn the_files_stay_small_and_the_others_below_four_thousand_triangles() {
        const LIMIT: usize = 2_500_000;
        let sizes: Vec<_> = fixtures().iter().map(|f| (f.name, f.mesh().face_count(), obj_bytes(&f.mesh()))).collect();
        assert!(sizes.iter().map(|s| s.2).sum::<usize>() < LIMIT, "{sizes:?}");
        assert!(sizes.iter().filter(|s| s.0 != DEFAULT_FIXTURE).all(|s| s.1 <= 4_000), "{sizes:?}");
    }
}
