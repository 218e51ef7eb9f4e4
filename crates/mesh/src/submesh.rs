//! Some faces of a mesh as a mesh of their own.

use crate::{CornerId, TriMesh, UvId, UvMap, VertexId};

/// Some faces of a mesh with the vertices that they use.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Submesh {
    /// The faces as a mesh.
    pub mesh: TriMesh,
    /// For each of its vertices the vertex of the whole mesh, ascending.
    pub vertices: Vec<VertexId>,
}

impl TriMesh {
    /// A mesh of some faces and the vertices that they use, in the order of this mesh.
    ///
    /// Each face is given by three corners of this mesh, in the order in which it is to have them:
    /// `faces.iter().map(|f| f.corners())`.
    ///
    /// # Panics
    /// If a corner does not exist.
    #[must_use]
    pub fn submesh(&self, faces: impl IntoIterator<Item = [CornerId; 3]>) -> Submesh {
        let of_corner = |c: CornerId| self.faces()[c.face().index()][c.place()];
        let mut faces: Vec<[VertexId; 3]> = faces.into_iter().map(|corners| corners.map(of_corner)).collect();
        let vertices = number_anew(faces.as_flattened_mut(), self.vertex_count(), VertexId::new, VertexId::index);
        let positions = vertices.iter().map(|v| self.positions()[v.index()]).collect();
        Submesh { mesh: Self::of_ids(positions, faces), vertices }
    }
}

impl UvMap {
    /// The map of some faces, with the points that they use in the order of this map. The faces are those of
    /// [`TriMesh::submesh`].
    ///
    /// # Panics
    /// If a corner does not exist.
    #[must_use]
    pub fn submap(&self, faces: impl IntoIterator<Item = [CornerId; 3]>) -> Self {
        let mut corners: Vec<UvId> = faces.into_iter().flatten().map(|c| self.corners()[c.index()]).collect();
        let points = number_anew(&mut corners, self.points().len(), UvId::new, UvId::index);
        Self::new(points.into_iter().map(|p| self.points()[p.index()]).collect(), corners)
    }
}

/// Puts in place of every id its number among those that are used, and gives these, ascending. There are `count` ids.
fn number_anew<I: Copy + Ord>(ids: &mut [I], count: usize, new: fn(usize) -> I, index: fn(I) -> usize) -> Vec<I> {
    /// A few of many ids are sorted; more are looked up in a table of all.
    const FEW: usize = 16;
    if ids.len() < count / FEW {
        let mut used = ids.to_vec();
        used.sort_unstable();
        used.dedup();
        ids.iter_mut().for_each(|id| *id = new(used.partition_point(|u| u < id)));
        return used;
    }
    let mut is_used = vec![false; count];
    ids.iter().for_each(|id| is_used[index(*id)] = true);
    let mut number = vec![0_u32; count];
    let mut used = Vec::new();
    for i in (0..count).filter(|&i| is_used[i]) {
        number[i] = used.len() as u32;
        used.push(new(i));
    }
    ids.iter_mut().for_each(|id| *id = new(number[index(*id)] as usize));
    used
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FaceId, Point2, Point3};

    /// Squares side by side in a row, two faces each.
    fn row(squares: usize) -> TriMesh {
        let points = (0..2 * squares + 2).map(|i| Point3::new((i / 2) as f64, (i % 2) as f64, 0.0)).collect();
        let faces: Vec<[usize; 3]> =
            (0..squares).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]).collect();
        TriMesh::new(points, &faces).expect("indices in range")
    }

    #[test]
    fn a_submesh_has_its_faces_and_their_vertices_in_order() {
        // Few faces of many, and many of few, are numbered in two ways.
        for squares in [3, 300] {
            let mesh = row(squares);
            let faces = [4, 1].map(FaceId::new);
            let Submesh { mesh: part, vertices } = mesh.submesh(faces.map(FaceId::corners));
            assert_eq!(vertices, [0, 1, 3, 4, 6, 7].map(VertexId::new));
            for (face, whole) in part.faces().iter().zip(faces) {
                assert_eq!(face.map(|v| vertices[v.index()]), mesh.faces()[whole.index()]);
            }
            for (v, whole) in vertices.iter().enumerate() {
                assert_eq!(part.positions()[v], mesh.positions()[whole.index()]);
            }
        }
    }

    #[test]
    fn corners_are_in_the_order_they_are_given_in() {
        let mesh = row(2);
        let [a, b, c] = FaceId::new(2).corners();
        let part = mesh.submesh([[a, c, b]]);
        assert_eq!(part.mesh.faces()[0].map(|v| part.vertices[v.index()]), [2, 5, 4].map(VertexId::new));
    }

    #[test]
    fn a_submap_has_the_points_of_its_faces_in_order() {
        for squares in [3, 300] {
            let mesh = row(squares);
            let flat: Vec<Point2<f64>> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
            let uv = UvMap::per_vertex(&mesh, &flat);
            let faces = [4, 1].map(FaceId::new);
            let part = uv.submap(faces.map(FaceId::corners));
            assert_eq!(part.points(), [0, 1, 3, 4, 6, 7].map(|v: usize| flat[v]));
            assert_eq!(part.triangles().collect::<Vec<_>>(), faces.map(|f| uv.triangle(f)));
        }
    }
}
