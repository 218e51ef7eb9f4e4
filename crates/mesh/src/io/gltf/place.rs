//! Places of meshes in a scene.

use crate::Point3;

/// Where a mesh stands in the scene: the largest of its instances.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GltfPlace {
    /// What lengths of the mesh are multiplied by: `√(A / A₀)`, with `A` the area in the scene and `A₀` that as stored.
    /// 1 where the mesh is in no node, where all its instances have no size, and where it is skinned.
    pub scale: f64,
    /// The first three rows of the matrix of that instance; the identity where there is none.
    pub matrix: [[f64; 4]; 3],
}

impl GltfPlace {
    /// A mesh as it is stored.
    pub(super) const AS_STORED: Self =
        Self { scale: 1.0, matrix: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// Where a point of the mesh is in the scene.
    #[must_use]
    pub fn point(&self, p: Point3<f64>) -> Point3<f64> {
        Point3::from(self.matrix.map(|[a, b, c, d]| a * p.x + b * p.y + c * p.z + d))
    }
}

/// The places of all primitives, and what there is to say about them.
pub(super) struct Places {
    pub(super) of_primitives: Vec<GltfPlace>,
    pub(super) said: Option<String>,
}
