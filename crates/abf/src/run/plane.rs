//! Meshes that are flat as they are.

use abf_mesh::{Point2, Point3, TriMesh, VertexId};

/// Points nearer to a plane than this part of the extent lie in it.
const IN_PLANE: f64 = 1e-12;

/// The vertices in the plane that all of them lie in, if there is one, counter-clockwise as its largest face runs.
///
/// The plane is that of three points far apart: of a thin strip the rounding of a single face would tilt it.
pub(crate) fn in_plane(mesh: &TriMesh) -> Option<Vec<Point2<f64>>> {
    let points = mesh.positions();
    let farthest = |from: Point3<f64>| {
        points.iter().copied().max_by(|p, q| (p - from).norm_squared().total_cmp(&(q - from).norm_squared()))
    };
    let one = farthest(*points.first()?)?;
    let u = (farthest(one)? - one).try_normalize(0.0)?;
    let across = |p: &Point3<f64>| {
        let arm = p - one;
        let side = arm - u * arm.dot(&u);
        // Twice is enough: what is left along u is rounded.
        side - u * side.dot(&u)
    };
    let v =
        points.iter().map(across).max_by(|p, q| p.norm_squared().total_cmp(&q.norm_squared()))?.try_normalize(0.0)?;
    let normal = u.cross(&v);
    let extent = points.iter().map(|p| (p - one).amax()).fold(0.0, f64::max);
    if points.iter().any(|p| (p - one).dot(&normal).abs() > IN_PLANE * extent) {
        return None;
    }
    let along = normal.iamax();
    let axes = [(along + 1) % 3, (along + 2) % 3];
    // Beside an axis nothing is rounded.
    let is_beside_axis = axes.iter().all(|&axis| normal[axis] == 0.0);
    let place = |p: &Point3<f64>| match is_beside_axis {
        true => Point2::new(p[axes[0]], p[axes[1]]),
        false => Point2::new((p - one).dot(&u), (p - one).dot(&v)),
    };
    let flat: Vec<Point2<f64>> = points.iter().map(place).collect();
    let area = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| flat[v.index()]);
        (b - a).perp(&(c - a))
    };
    let largest = mesh.faces().iter().map(area).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    Some(if largest < 0.0 { flat.into_iter().map(|p| Point2::new(p.y, p.x)).collect() } else { flat })
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Vector3;
    use nalgebra::Rotation3;

    fn square(corners: [[f64; 3]; 4]) -> TriMesh {
        TriMesh::new(corners.map(Point3::from).to_vec(), &[[0, 1, 2], [0, 2, 3]]).expect("indices in range")
    }

    /// A strip of triangles 1e-9 high, turned in space.
    #[test]
    fn a_thin_strip_lies_in_its_plane_however_it_is_turned() {
        for axis in [[1.0, 2.0, 3.0], [-3.0, 1.0, 0.5], [0.1, -0.2, 1.0]] {
            let turn = Rotation3::from_scaled_axis(Vector3::from(axis));
            let points: Vec<Point3<f64>> =
                (0..200).map(|i| turn * Point3::new(f64::from(i) / 2.0, f64::from(i % 2) * 1e-9, 0.0)).collect();
            let ends = |i: usize| if i.is_multiple_of(2) { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] };
            let mesh = TriMesh::new(points, &(0..198).map(ends).collect::<Vec<_>>()).expect("indices in range");
            let flat = in_plane(&mesh).expect("a plane");
            assert!(mesh.faces().iter().all(|f| {
                let [a, b, c] = f.map(|v| flat[v.index()]);
                let area = (b - a).perp(&(c - a));
                (area - 1e-9).abs() < 1e-4 * 1e-9
            }));
        }
    }

    #[test]
    fn a_flat_mesh_keeps_its_coordinates_and_lengths_counter_clockwise() {
        let upright = square([[0.1, 0.0, 0.0], [0.1, 0.0, 0.7], [0.1, 0.3, 0.7], [0.1, 0.3, 0.0]]);
        let flat = in_plane(&upright).expect("a plane");
        assert_eq!(flat[1], Point2::new(0.7, 0.0), "its normal is −x, so z comes before y");
        let slanted = square([[0.0, 0.0, 0.0], [3.0, 0.0, 4.0], [3.0, 2.0, 4.0], [0.0, 2.0, 0.0]]);
        let flat = in_plane(&slanted).expect("a plane");
        let side = |i: usize, j: usize| flat[j] - flat[i];
        assert!((side(0, 1).norm() - 5.0).abs() < 1e-14 && (side(1, 2).norm() - 2.0).abs() < 1e-14);
        assert!(side(0, 1).perp(&side(0, 2)) > 0.0);
        assert!(in_plane(&square([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 1e-9], [0.0, 1.0, 0.0]])).is_none());
    }
}
