//! Charts: the connected pieces of a UV map.

use crate::MetricsError;
use abf_mesh::{DisjointSets, FaceId, TriMesh, UvId, UvMap, VertexId};

/// The chart of every face, numbered by first appearance: faces are in one chart where they share UV points, or have points
/// of one vertex in one place.
///
/// # Errors
/// [`MetricsError::CornerCount`] for the map of another mesh.
pub fn charts(mesh: &TriMesh, uv: &UvMap) -> Result<Vec<usize>, MetricsError> {
    let (corners, faces) = (uv.corners().len(), mesh.face_count());
    if corners != 3 * faces {
        return Err(MetricsError::CornerCount { corners, faces });
    }
    let found = Charts::find(mesh, uv);
    Ok((0..faces).map(|f| found.of(FaceId::new(f))).collect())
}

/// Which chart every face is in.
pub(crate) struct Charts {
    /// The chart of every face, numbered by first appearance; none where all are in one.
    of_face: Option<Vec<usize>>,
    /// How many there are.
    pub(crate) count: usize,
}

impl Charts {
    /// All faces in one.
    pub(crate) const ONE: Self = Self { of_face: None, count: 1 };

    /// The chart of a face.
    pub(crate) fn of(&self, face: FaceId) -> usize {
        self.of_face.as_ref().map_or(0, |charts| charts[face.index()])
    }

    /// The connected components of the UV points, where the three points of a face are connected, and
    /// so are points of one vertex that have the same coordinates: files that repeat a UV for every
    /// corner draw the same map as files that share it.
    pub(crate) fn find(mesh: &TriMesh, uv: &UvMap) -> Self {
        const UNNUMBERED: usize = usize::MAX;
        let mut sets = DisjointSets::new(uv.points().len());
        for face in uv.corners().chunks_exact(3) {
            sets.unite(face[0].index(), face[1].index());
            sets.unite(face[1].index(), face[2].index());
        }
        for (i, j) in repeated_points(mesh, uv) {
            sets.unite(i.index(), j.index());
        }
        let mut number = vec![UNNUMBERED; uv.points().len()];
        let mut count = 0;
        let chart_of = |face: &[UvId]| {
            let root = sets.find(face[0].index());
            if number[root] == UNNUMBERED {
                number[root] = count;
                count += 1;
            }
            number[root]
        };
        let of_face = Some(uv.corners().chunks_exact(3).map(chart_of).collect());
        Self { of_face, count }
    }
}

/// Pairs of UV points that stand at one vertex and have equal coordinates; chains of them connect all
/// that are equal.
fn repeated_points(mesh: &TriMesh, uv: &UvMap) -> Vec<(UvId, UvId)> {
    let mut first: Vec<Option<UvId>> = vec![None; mesh.vertex_count()];
    // Vertices with several UV points: seams, or every vertex of a file that shares none.
    let mut several: Vec<(VertexId, UvId)> = Vec::new();
    for (&vertex, &point) in mesh.faces().iter().flatten().zip(uv.corners()) {
        let known = first[vertex.index()].get_or_insert(point);
        if *known != point {
            several.extend([(vertex, *known), (vertex, point)]);
        }
    }
    let place = |point: UvId| uv.points()[point.index()];
    let key = |&(vertex, point): &(VertexId, UvId)| (vertex, place(point).x.to_bits(), place(point).y.to_bits(), point);
    several.sort_unstable_by_key(key);
    let is_same = |a: &(VertexId, UvId), b: &(VertexId, UvId)| a.0 == b.0 && place(a.1) == place(b.1);
    several.windows(2).filter(|w| w[0].1 != w[1].1 && is_same(&w[0], &w[1])).map(|w| (w[0].1, w[1].1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Point2;

    #[test]
    fn charts_are_numbered_by_first_appearance_and_unused_points_are_none() {
        let corners = [5, 6, 7, 0, 1, 2, 7, 8, 5, 2, 1, 3].map(UvId::new).to_vec();
        let places = (0..10).map(|i| Point2::new(f64::from(i), 0.0)).collect();
        let charts = Charts::find(&mesh(&[[0, 1, 2], [3, 4, 5], [2, 6, 0], [5, 4, 7]]), &UvMap::new(places, corners));
        assert_eq!([0, 1, 2, 3].map(|f| charts.of(FaceId::new(f))), [0, 1, 0, 1]);
        assert_eq!(charts.count, 2);
    }

    #[test]
    fn a_uv_repeated_for_every_corner_joins_its_faces_as_if_it_were_shared() {
        let places = [
            [0.0, 0.0],
            [1.0, 0.0],
            [0.0, 1.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [5.0, 0.0],
            [6.0, 0.0],
            [5.0, 1.0],
        ];
        let uv = UvMap::new(places.map(Point2::from).to_vec(), (0..9).map(UvId::new).collect());
        let charts = Charts::find(&mesh(&[[0, 1, 2], [1, 3, 2], [0, 1, 2]]), &uv);
        assert_eq!([0, 1, 2].map(|f| charts.of(FaceId::new(f))), [0, 0, 1], "the third face stands elsewhere");
    }

    fn mesh(faces: &[[usize; 3]]) -> TriMesh {
        TriMesh::new(vec![abf_mesh::Point3::origin(); 8], faces).expect("indices in range")
    }
}
