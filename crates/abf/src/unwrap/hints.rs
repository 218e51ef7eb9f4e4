//! What is known of a mesh beyond its faces.

use super::UnwrapError;
use abf_mesh::{CornerId, TriMesh, UvMap};

/// What is known of a mesh beyond its vertices and faces. All of it is optional.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceHints<'a> {
    /// The UVs it has, whose seams [`SeamRule::Keep`](super::SeamRule::Keep) keeps.
    pub uv: Option<&'a UvMap>,
    /// A label for every face, group or material, at whose borders the same rule puts seams.
    pub face_labels: Option<&'a [u32]>,
    /// A label for every face: vertices in one place are joined within one object only, as within one mesh of a scene.
    pub objects: Option<&'a [u32]>,
    /// For every corner whether the edge that it faces may not be a seam, as the diagonals of polygons.
    pub forbidden: Option<&'a [bool]>,
    /// For every corner whether the edge that it faces is a seam to be kept by the same rule; one of its two sides is enough.
    pub seams: Option<&'a [bool]>,
}

impl SurfaceHints<'_> {
    pub(super) fn check(&self, mesh: &TriMesh) -> Result<(), UnwrapError> {
        let (faces, corners) = (mesh.face_count(), 3 * mesh.face_count());
        let lengths = [
            ("corners with UVs", self.uv.map(|uv| uv.corners().len()), corners),
            ("objects", self.objects.map(<[u32]>::len), faces),
            ("face labels", self.face_labels.map(<[u32]>::len), faces),
            ("corners that face forbidden edges", self.forbidden.map(<[bool]>::len), corners),
            ("corners that face seams", self.seams.map(<[bool]>::len), corners),
        ];
        for (what, given, expected) in lengths {
            if let Some(given) = given.filter(|&given| given != expected) {
                return Err(UnwrapError::Hint { what, given, expected });
            }
        }
        Ok(())
    }

    /// Whether the edge that a corner of the input faces may not be a seam.
    pub(super) fn is_forbidden(&self, corner: CornerId) -> bool {
        self.forbidden.is_some_and(|forbidden| forbidden[corner.index()])
    }
}
