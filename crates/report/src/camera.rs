//! From where the surface is seen: an orthographic camera and how its direction is chosen.

use abf_mesh::{Point3, TriMesh, Vector3};

use crate::PictureError;

/// The mean normal must be at least this part of a flat surface's to tell a front side.
const FACING: f64 = 0.2;
/// A front side this close to straight up or down (sine of its elevation) is a floor, not a wall.
const STEEP: f64 = 0.85;
/// How far the camera leaves the normal of a floor towards the front (a tangent).
const LEAN: f64 = 0.9;
/// How far the camera rises above the normal of a wall (a tangent).
const RISE: f64 = 0.4;
/// How far the camera steps aside (a tangent).
const ASIDE: f64 = 0.5;

/// From where the surface is seen.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum View {
    /// A three-quarter view with the y axis up. A surface that faces one way on the whole (a disk,
    /// a mask, a terrain) is seen from that side; any other across its longest horizontal extent.
    #[default]
    Auto,
    /// Seen from a given direction. Neither vector needs unit length.
    Direction {
        /// From the surface towards the viewer.
        towards_viewer: Vector3<f64>,
        /// What points up in the picture, as far as the direction allows.
        up: Vector3<f64>,
    },
}

/// An orthographic camera: an orthonormal frame in which the viewer looks against the third axis.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    right: Vector3<f64>,
    up: Vector3<f64>,
    towards_viewer: Vector3<f64>,
}

impl Camera {
    /// The camera of a view of this mesh.
    pub(crate) fn new(view: &View, mesh: &TriMesh) -> Result<Self, PictureError> {
        let (towards_viewer, up) = match view {
            View::Auto => (automatic_direction(mesh), Vector3::y()),
            View::Direction { towards_viewer, up } => (*towards_viewer, *up),
        };
        Self::looking_from(towards_viewer, up)
            .ok_or(PictureError::BadView { towards_viewer: towards_viewer.into(), up: up.into() })
    }

    /// A point in the camera's frame: right, up, towards the viewer.
    pub(crate) fn project(&self, point: &Point3<f64>) -> Point3<f64> {
        let p = &point.coords;
        Point3::new(self.right.dot(p), self.up.dot(p), self.towards_viewer.dot(p))
    }

    /// The frame for a direction; `None` if it and `up` span no plane.
    fn looking_from(towards_viewer: Vector3<f64>, up: Vector3<f64>) -> Option<Self> {
        const PARALLEL: f64 = 1e-9;
        let towards_viewer = unit(towards_viewer)?;
        let right = unit(up)?.cross(&towards_viewer).try_normalize(PARALLEL)?;
        Some(Self { right, up: towards_viewer.cross(&right), towards_viewer })
    }
}

/// The direction of a vector of any length; `None` if it has none.
fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    // Divided by the largest coordinate first, so that squares neither overflow nor vanish.
    (v / v.amax()).try_normalize(0.0).filter(|v| v.iter().all(|x| x.is_finite()))
}

/// Towards the viewer, for a surface of which nothing else is known.
fn automatic_direction(mesh: &TriMesh) -> Vector3<f64> {
    let front = front_side(mesh).unwrap_or_else(|| broad_side(mesh));
    let raised = if front.y.abs() > STEEP { front + LEAN * Vector3::z() } else { front + RISE * Vector3::y() };
    let right = Vector3::y().cross(&raised).normalize();
    raised + ASIDE * right
}

/// The direction of the mean normal, if the surface faces one way on the whole.
fn front_side(mesh: &TriMesh) -> Option<Vector3<f64>> {
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for [a, b, c] in mesh.triangles() {
        let normal = (b - a).cross(&(c - a));
        sum += normal;
        total += normal.norm();
    }
    (sum.norm() >= FACING * total).then_some(sum).and_then(unit)
}

/// The horizontal direction in which the vertices spread least, on the side of positive z.
fn broad_side(mesh: &TriMesh) -> Vector3<f64> {
    let corners = || mesh.triangles().flatten();
    let count = (3 * mesh.face_count()) as f64;
    let mean = corners().map(|p| p.coords / count).sum::<Vector3<f64>>();
    let (mut xx, mut xz, mut zz) = (0.0, 0.0, 0.0);
    for p in corners() {
        let d = p.coords - mean;
        xx += d.x * d.x;
        xz += d.x * d.z;
        zz += d.z * d.z;
    }
    // The principal axes of a symmetric 2 × 2 matrix; at ±90° the long one is turned away from x.
    let long_axis = 0.5 * (2.0 * xz).atan2(xx - zz);
    Vector3::new(-long_axis.sin(), 0.0, long_axis.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with the given half extents around the origin, its first `faces` triangles.
    fn block(half: [f64; 3], faces: usize) -> TriMesh {
        let corner =
            |k: usize| Point3::from([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { half[axis] } else { -half[axis] }));
        // Two triangles for each of +z, −z, +x, −x, +y, −y.
        let quads = [[4, 5, 7, 6], [0, 2, 3, 1], [1, 3, 7, 5], [0, 4, 6, 2], [2, 6, 7, 3], [0, 1, 5, 4]];
        let all: Vec<[usize; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh::new((0..8).map(corner).collect(), &all[..faces]).expect("indices in range")
    }

    fn automatic(mesh: &TriMesh) -> Camera {
        Camera::new(&View::Auto, mesh).expect("a view")
    }

    #[test]
    fn the_frame_is_orthonormal_and_right_handed() {
        let camera = Camera::looking_from(Vector3::new(1e-200, 3e-200, -2e-200), Vector3::new(0.0, 5e100, 1e100))
            .expect("they span a plane");
        assert!((camera.right.cross(&camera.up) - camera.towards_viewer).norm() < 1e-15);
        assert!((camera.right.norm() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_surface_with_a_front_side_is_seen_from_there_slightly_from_above() {
        let camera = automatic(&block([1.0; 3], 2));
        assert!(camera.towards_viewer.z > 0.7);
        assert!(camera.towards_viewer.y > 0.1 && camera.up.y > 0.7);
        assert!(camera.towards_viewer.x > 0.1);
    }

    #[test]
    fn a_surface_that_faces_up_is_seen_from_above_and_from_the_front() {
        let points = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]].map(Point3::from).to_vec();
        let camera = automatic(&TriMesh::new(points, &[[0, 1, 2]]).expect("indices in range"));
        assert!(camera.towards_viewer.y > 0.5 && camera.towards_viewer.z > 0.3);
    }

    #[test]
    fn a_closed_surface_is_seen_across_its_longest_horizontal_extent() {
        let along_x = automatic(&block([5.0, 1.0, 1.0], 12));
        assert!(along_x.right.x.abs() > 0.8);
        let along_z = automatic(&block([1.0, 1.0, 5.0], 12));
        assert!(along_z.right.z.abs() > 0.8);
    }

    #[test]
    fn a_direction_parallel_to_up_is_refused() {
        let mesh = block([1.0; 3], 12);
        for (towards_viewer, up) in
            [([0.0, 2.0, 0.0], [0.0, -1.0, 0.0]), ([0.0; 3], [0.0, 1.0, 0.0]), ([1.0, f64::NAN, 0.0], [0.0, 1.0, 0.0])]
        {
            let view = View::Direction { towards_viewer: towards_viewer.into(), up: up.into() };
            assert!(matches!(Camera::new(&view, &mesh), Err(PictureError::BadView { .. })));
        }
    }
}
