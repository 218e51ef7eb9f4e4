//! UVs per corner.

use abf_parallel::prelude::*;

use crate::tri_mesh::{power_into_range, sum_by_block};
use crate::{CornerId, FaceId, Point2, TriMesh, UvId};

/// Fewer points are not worth a thread.
const POINTS_PER_TASK: usize = 1 << 13;

/// A UV for every corner of a mesh: corners that share a [`UvId`] are joined in the plane.
///
/// A vertex on a seam has several UV points; nothing else distinguishes a seam.
#[derive(Clone, Debug, PartialEq)]
pub struct UvMap {
    points: Vec<Point2<f64>>,
    corners: Vec<UvId>,
}

impl UvMap {
    /// A map from its points and, for every corner, the index of its point.
    ///
    /// # Panics
    /// If a corner names a point that does not exist; readers check this before.
    #[must_use]
    pub fn new(points: Vec<Point2<f64>>, corners: Vec<UvId>) -> Self {
        assert!(corners.iter().all(|c| c.index() < points.len()), "every corner names an existing UV point");
        Self { points, corners }
    }

    /// A map of those points that corners use, in their order.
    ///
    /// # Panics
    /// If a corner names a point that does not exist.
    #[cfg(feature = "io")]
    pub(crate) fn of_used_points(mut points: Vec<Point2<f64>>, mut corners: Vec<UvId>) -> Self {
        let mut used = vec![false; points.len()];
        corners.iter().for_each(|c| used[c.index()] = true);
        if used.iter().all(|&used| used) {
            return Self { points, corners };
        }
        let mut count = 0;
        let ids: Vec<UvId> = used
            .iter()
            .map(|&used| {
                let id = UvId::new(count);
                count += usize::from(used);
                id
            })
            .collect();
        let mut used = used.into_iter();
        points.retain(|_| used.next() == Some(true));
        corners.iter_mut().for_each(|c| *c = ids[c.index()]);
        Self { points, corners }
    }

    /// One UV for every vertex of the mesh. Vertices that no face uses get no UV point.
    ///
    /// # Panics
    /// If there are not as many UVs as vertices.
    #[must_use]
    pub fn per_vertex(mesh: &TriMesh, uv: &[Point2<f64>]) -> Self {
        assert_eq!(uv.len(), mesh.vertex_count(), "one UV per vertex");
        let mut used = vec![false; uv.len()];
        mesh.faces().iter().flatten().for_each(|v| used[v.index()] = true);
        let vertices = mesh.faces().as_flattened().par_iter().with_min_len(POINTS_PER_TASK);
        if used.iter().all(|&used| used) {
            return Self { points: uv.to_vec(), corners: vertices.map(|v| UvId::new(v.index())).collect() };
        }
        let mut points = Vec::with_capacity(uv.len());
        let ids: Vec<UvId> = uv
            .iter()
            .zip(&used)
            .map(|(&p, &used)| {
                let id = UvId::new(points.len());
                if used {
                    points.push(p);
                }
                id
            })
            .collect();
        Self { points, corners: vertices.map(|v| ids[v.index()]).collect() }
    }

    /// The UV of every vertex of the mesh, where none has several; the origin for those of no face. UVs are told apart by their bits,
    /// so that −0 survives. `None` where a vertex has several: such a map needs a row for every point, and the row of each corner.
    #[must_use]
    pub fn one_per_vertex(&self, mesh: &TriMesh) -> Option<Vec<Point2<f64>>> {
        let bits = |p: Point2<f64>| [p.x.to_bits(), p.y.to_bits()];
        let mut found: Vec<Option<Point2<f64>>> = vec![None; mesh.vertex_count()];
        for (v, id) in mesh.faces().as_flattened().iter().zip(&self.corners) {
            let uv = self.points[id.index()];
            if bits(*found[v.index()].get_or_insert(uv)) != bits(uv) {
                return None;
            }
        }
        Some(found.into_iter().map(|uv| uv.unwrap_or_else(Point2::origin)).collect())
    }

    /// The UV points.
    #[must_use]
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The UV point of every corner, `3 nt` of them.
    #[must_use]
    pub fn corners(&self) -> &[UvId] {
        &self.corners
    }

    /// The UV of one corner.
    #[inline]
    #[must_use]
    pub fn corner(&self, corner: CornerId) -> Point2<f64> {
        self.points[self.corners[corner.index()].index()]
    }

    /// The UV triangle of a face.
    #[inline]
    #[must_use]
    pub fn triangle(&self, face: FaceId) -> [Point2<f64>; 3] {
        face.corners().map(|c| self.corner(c))
    }

    /// Every UV triangle, in the order of the faces.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [Point2<f64>; 3]> + '_ {
        self.corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|id| self.points[id.index()]))
    }

    /// The sum of the signed areas of all UV triangles: positive when most of the map is
    /// counter-clockwise.
    #[must_use]
    pub fn signed_area(&self) -> f64 {
        self.sum_of_areas(|signed| signed)
    }

    /// The sum of the areas of all UV triangles, without sign.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.sum_of_areas(f64::abs)
    }

    fn sum_of_areas(&self, term: impl Fn(f64) -> f64 + Sync) -> f64 {
        let at = |c: UvId| self.points[c.index()];
        let area = |c: &[UvId; 3]| 0.5 * (at(c[1]) - at(c[0])).perp(&(at(c[2]) - at(c[0])));
        sum_by_block(self.corners.as_chunks::<3>().0, |corners| term(area(corners)))
    }

    /// The same map with every point moved by `transform`.
    #[must_use]
    pub fn mapped(mut self, transform: impl Fn(Point2<f64>) -> Point2<f64> + Sync) -> Self {
        self.points.par_iter_mut().with_min_len(POINTS_PER_TASK).for_each(|p| *p = transform(*p));
        self
    }

    /// The smallest axis-aligned box around all points: lower left, upper right.
    /// `None` when there is no point.
    #[must_use]
    pub fn bounds(&self) -> Option<(Point2<f64>, Point2<f64>)> {
        crate::bounds(self.points.iter().copied())
    }

    /// The same map with every coordinate multiplied by a power of two, for coordinates so large or small that their
    /// products leave the range of doubles; `None` where they are not. As [`TriMesh::in_range`].
    #[must_use]
    pub fn in_range(&self) -> Option<Self> {
        let largest = self.points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
        power_into_range(largest).map(|scale| self.clone().mapped(|p| p * scale))
    }

    /// Moved and scaled uniformly so that its box touches the origin and fits the unit square.
    #[must_use]
    pub fn normalized(self) -> Self {
        let Some((lo, hi)) = self.bounds() else { return self };
        let side = (hi - lo).max();
        if side <= 0.0 {
            return self;
        }
        self.mapped(|p| Point2::from((p - lo) / side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point3;

    fn square() -> (TriMesh, Vec<Point2<f64>>) {
        let p = [[0.0, 0.0], [9.0, 9.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let positions = p.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect();
        let mesh = TriMesh::new(positions, &[[0, 2, 3], [0, 3, 4]]).expect("indices in range");
        (mesh, p.iter().map(|&xy| Point2::from(xy)).collect())
    }

    #[test]
    fn unreferenced_vertices_get_no_uv_point() {
        let (mesh, uv) = square();
        let map = UvMap::per_vertex(&mesh, &uv);
        assert_eq!(map.points().len(), 4);
        assert_eq!(map.signed_area(), 4.0);
        assert_eq!(map.triangle(FaceId::new(1)), [uv[0], uv[3], uv[4]]);
    }

    #[test]
    fn normalizing_fits_the_unit_square_and_keeps_proportions() {
        let (mesh, uv) = square();
        let map = UvMap::per_vertex(&mesh, &uv).mapped(|p| Point2::new(3.0 * p.x - 1.0, p.y)).normalized();
        let (lo, hi) = map.bounds().expect("points");
        assert_eq!((lo.x, lo.y, hi.x), (0.0, 0.0, 1.0));
        assert!((hi.y - 1.0 / 3.0).abs() < 1e-15);
    }
}
