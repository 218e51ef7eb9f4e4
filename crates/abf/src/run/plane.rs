//! Meshes that are flat as they are.

use abf_mesh::{Point2, TriMesh, Vector3};

/// Points nearer to a plane than this part of the extent lie in it.
const IN_PLANE: f64 = 1e-12;

/// The vertices in the plane that all of them lie in, if there is one, counter-clockwise as its largest face runs.
pub(crate) fn in_plane(mesh: &TriMesh) -> Option<Vec<Point2<f64>>> {
    let normals = mesh.triangles().map(|[a, b, c]| (a, (b - a).cross(&(c - a))));
    let (origin, normal) = normals.max_by(|m, n| m.1.norm_squared().total_cmp(&n.1.norm_squared()))?;
    let normal = normal.try_normalize(0.0)?;
    let arms = || mesh.positions().iter().map(|p| p - origin);
    let extent = arms().map(|arm| arm.amax()).fold(0.0, f64::max);
    if arms().any(|arm| arm.dot(&normal).abs() > IN_PLANE * extent) {
        return None;
    }
    let along = normal.iamax();
    let axes = [(along + 1) % 3, (along + 2) % 3];
    if axes.iter().all(|&axis| normal[axis] == 0.0) {
        // Beside an axis nothing is rounded.
        let [u, v] = if normal[along] > 0.0 { axes } else { [axes[1], axes[0]] };
        return Some(mesh.positions().iter().map(|p| Point2::new(p[u], p[v])).collect());
    }
    let mut beside = Vector3::zeros();
    beside[axes[0]] = 1.0;
    let u = (beside - normal * normal[axes[0]]).try_normalize(0.0)?;
    let v = normal.cross(&u);
    Some(arms().map(|arm| Point2::new(arm.dot(&u), arm.dot(&v))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Point3;

    fn square(corners: [[f64; 3]; 4]) -> TriMesh {
        TriMesh::new(corners.map(Point3::from).to_vec(), &[[0, 1, 2], [0, 2, 3]]).expect("indices in range")
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
