//! Small meshes and maps for the tests of this crate.

#![allow(dead_code, reason = "every test file uses a part of it")]

use abf_mesh::{Point2, Point3, TriMesh, UvId, UvMap};

/// A mesh of these vertices and faces.
pub(crate) fn mesh(positions: &[[f64; 3]], faces: &[[usize; 3]]) -> TriMesh {
    TriMesh::new(positions.iter().map(|&p| Point3::from(p)).collect(), faces).expect("indices in range")
}

/// A map of these points, with the points of every face.
pub(crate) fn uv_map(points: &[[f64; 2]], faces: &[[usize; 3]]) -> UvMap {
    let corners = faces.iter().flatten().map(|&i| UvId::new(i)).collect();
    UvMap::new(points.iter().map(|&p| Point2::from(p)).collect(), corners)
}

/// One UV for every vertex.
pub(crate) fn per_vertex(mesh: &TriMesh, uv: impl Fn(Point3<f64>) -> [f64; 2]) -> UvMap {
    let points: Vec<Point2<f64>> = mesh.positions().iter().map(|&p| Point2::from(uv(p))).collect();
    UvMap::per_vertex(mesh, &points)
}

/// `n × n` unit squares of two triangles each, raised by `height`.
pub(crate) fn sheet(n: usize, height: impl Fn(f64, f64) -> f64) -> TriMesh {
    let at = |i: usize, j: usize| i * (n + 1) + j;
    let cells = || (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)));
    let faces: Vec<[usize; 3]> = cells()
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect();
    let positions: Vec<[f64; 3]> =
        (0..=n).flat_map(|i| (0..=n).map(move |j| (i as f64, j as f64))).map(|(x, y)| [x, y, height(x, y)]).collect();
    mesh(&positions, &faces)
}

/// Numbers in `[−1, 1)` that look random and are the same every time (`SplitMix64`).
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    /// The next number.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
