//! Bounding boxes.

use crate::TriMesh;
use nalgebra::Point;

/// The smallest axis-aligned box around all points: its corner of the least coordinates, and that of the greatest.
/// `None` when there is no point.
#[must_use]
pub fn bounds<const D: usize>(
    points: impl IntoIterator<Item = Point<f64, D>>,
) -> Option<(Point<f64, D>, Point<f64, D>)> {
    let mut points = points.into_iter();
    let first = points.next()?;
    Some(points.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p))))
}

impl TriMesh {
    /// The length of the diagonal of the smallest axis-aligned box around all faces, in units of the mesh; 0 without faces.
    /// Vertices that no face uses do not count.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        bounds(self.triangles().flatten()).map_or(0.0, |(low, high)| (high - low).norm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Point2, Point3};

    #[test]
    fn the_box_of_points_has_their_least_and_greatest_coordinates() {
        let points = [[1.0, 5.0], [-2.0, 3.0], [0.0, 7.0]].map(Point2::from);
        assert_eq!(bounds(points), Some((Point2::new(-2.0, 3.0), Point2::new(1.0, 7.0))));
        assert_eq!(
            bounds([Point3::new(1.0, 2.0, 3.0)]),
            Some((Point3::new(1.0, 2.0, 3.0), Point3::new(1.0, 2.0, 3.0)))
        );
        assert_eq!(bounds::<2>([]), None);
    }

    #[test]
    fn the_diagonal_of_a_mesh_is_that_of_its_faces() {
        let points = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 6.0], [99.0; 3]].map(Point3::from);
        let mesh = TriMesh::new(points.to_vec(), &[[0, 1, 2]]).expect("indices in range");
        assert_eq!(mesh.diagonal(), 7.0);
        assert_eq!(TriMesh::new(points.to_vec(), &[]).expect("no indices").diagonal(), 0.0);
    }
}
