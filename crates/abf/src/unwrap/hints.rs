//! What is known of a mesh beyond its faces.

use super::UnwrapError;
use abf_mesh::{CornerId, TriMesh, UvMap};
use std::collections::{HashMap, HashSet};

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
    /// For every corner of these triangles whether it faces one of `edges`, each given by its two vertices: what
    /// [`seams`](Self::seams) takes.
    #[must_use]
    pub fn corners_facing(triangles: &[[u32; 3]], edges: &[[u32; 2]]) -> Vec<bool> {
        let marked: HashSet<[u32; 2]> = edges.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
        triangles.iter().flat_map(faced).map(|edge| marked.contains(&edge)).collect()
    }

    /// For every corner of these triangles whether it faces an edge between two triangles of one polygon: what
    /// [`forbidden`](Self::forbidden) takes. `polygons` has the polygon of every triangle.
    #[must_use]
    pub fn corners_inside(triangles: &[[u32; 3]], polygons: &[u32]) -> Vec<bool> {
        let edges = || triangles.iter().zip(polygons).flat_map(|(t, &polygon)| faced(t).map(|edge| (polygon, edge)));
        let mut sides: HashMap<(u32, [u32; 2]), usize> = HashMap::new();
        edges().for_each(|edge| *sides.entry(edge).or_default() += 1);
        edges().map(|edge| sides[&edge] > 1).collect()
    }

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

/// The edges that the corners of a triangle face, the lower vertex first.
fn faced(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[b, c], [c, a], [a, b]].map(|[from, to]| [from.min(to), from.max(to)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_found_from_both_sides_and_inside_of_polygons() {
        let halves = [[0, 1, 2], [2, 3, 0]];
        let diagonal = [false, true, false, false, true, false];
        assert_eq!(SurfaceHints::corners_facing(&halves, &[[2, 0]]), diagonal);
        assert_eq!(SurfaceHints::corners_facing(&halves, &[[0, 2], [9, 1]]), diagonal);
        assert_eq!(SurfaceHints::corners_inside(&halves, &[7, 7]), diagonal);
        assert_eq!(SurfaceHints::corners_inside(&halves, &[7, 8]), [false; 6]);
    }
}
