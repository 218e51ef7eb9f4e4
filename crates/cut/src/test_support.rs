//! Small meshes of every topology.

use crate::Seams;
use abf_mesh::{Point3, Topology, TriMesh, VertexId};
use std::f64::consts::TAU;

pub(crate) fn mesh(points: &[[f64; 3]], faces: &[[usize; 3]]) -> TriMesh {
    TriMesh::new(points.iter().map(|&p| Point3::from(p)).collect(), faces).expect("indices in range")
}

pub(crate) fn topology(mesh: &TriMesh) -> Topology {
    Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
}

/// Two triangles for every square of a grid, wrapped around where asked for.
fn grid_faces(m: usize, n: usize, wrap: bool) -> Vec<[usize; 3]> {
    let (vm, vn) = if wrap { (m, n) } else { (m + 1, n + 1) };
    let at = |i: usize, j: usize| (i % vm) * vn + j % vn;
    (0..m)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect()
}

/// `m × n` unit squares in the plane, diagonals from (i, j) to (i + 1, j + 1).
pub(crate) fn sheet(m: usize, n: usize) -> TriMesh {
    let points: Vec<_> = (0..=m).flat_map(|i| (0..=n).map(move |j| [i as f64, j as f64, 0.0])).collect();
    mesh(&points, &grid_faces(m, n, false))
}

/// `2n × 2n` unit squares folded along `x = 0` by a right angle: into a valley or to a ridge.
pub(crate) fn folded(n: usize, is_valley: bool) -> TriMesh {
    let rise = if is_valley { 1.0 } else { -1.0 };
    let flat = sheet(2 * n, 2 * n);
    let fold = |p: &Point3<f64>| [p.x - n as f64, p.y, rise * (p.x - n as f64).abs()];
    let points: Vec<_> = flat.positions().iter().map(fold).collect();
    mesh(&points, &flat.faces().iter().map(|f| f.map(VertexId::index)).collect::<Vec<_>>())
}

/// `m` steps around the hole, `n` around the tube.
pub(crate) fn torus(m: usize, n: usize) -> TriMesh {
    let point = |i: usize, j: usize| {
        let (u, v) = (TAU * i as f64 / m as f64, TAU * j as f64 / n as f64);
        let r = 3.0 + v.cos();
        [r * u.cos(), r * u.sin(), v.sin()]
    };
    let points: Vec<_> = (0..m).flat_map(|i| (0..n).map(move |j| point(i, j))).collect();
    mesh(&points, &grid_faces(m, n, true))
}

/// Two tori that share the rim of a face that neither has any more.
pub(crate) fn double_torus() -> TriMesh {
    let one = torus(9, 6);
    let n = one.vertex_count();
    let shared = one.faces()[0].map(VertexId::index);
    // Mirrored, so that the rims run against each other.
    let of_two = |v: usize| if shared.contains(&v) { v } else { n + v };
    let mirrored = one.positions().iter().map(|p| [p.x, p.y, 8.0 - p.z]);
    let points: Vec<_> = one.positions().iter().map(|p| [p.x, p.y, p.z]).chain(mirrored).collect();
    let faces = one.faces()[1..].iter().map(|f| f.map(VertexId::index));
    let two = faces.clone().map(|[a, b, c]| [a, c, b].map(of_two));
    let all: Vec<_> = faces.chain(two).collect();
    mesh(&points, &all)
}

pub(crate) fn tetrahedron() -> TriMesh {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    mesh(&points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

pub(crate) fn octahedron() -> TriMesh {
    let points =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let top = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    mesh(&points, &[top, top.map(|[a, b, _]| [b, a, 5])].concat())
}

/// A band of `n` squares with half a turn, two squares wide.
pub(crate) fn moebius(n: usize) -> TriMesh {
    let point = |i: usize, j: usize| {
        let (u, s) = (TAU * i as f64 / n as f64, j as f64 - 1.0);
        let r = 4.0 + s * (u / 2.0).cos();
        [r * u.cos(), r * u.sin(), s * (u / 2.0).sin()]
    };
    let points: Vec<_> = (0..n).flat_map(|i| (0..3).map(move |j| point(i, j))).collect();
    let at = |i: usize, j: usize| if i < n { 3 * i + j } else { 2 - j };
    let square = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let faces: Vec<_> = (0..n).flat_map(|i| [(i, 0), (i, 1)]).flat_map(square).collect();
    mesh(&points, &faces)
}

pub(crate) fn without_faces(whole: &TriMesh, gone: &[usize]) -> TriMesh {
    let kept = whole.faces().iter().enumerate().filter(|(f, _)| !gone.contains(f));
    let faces: Vec<_> = kept.map(|(_, face)| face.map(VertexId::index)).collect();
    TriMesh::new(whole.positions().to_vec(), &faces).expect("indices in range")
}

/// The edges between vertices below `row`.
pub(crate) fn cut_row(mesh: &TriMesh, topology: &Topology, row: usize) -> Seams {
    assert!(row <= mesh.vertex_count());
    Seams::where_edges(topology, |c, _| [c.next(), c.prev()].iter().all(|&e| topology.vertex(e).index() < row))
}

/// Numbers that look random, the same everywhere (splitmix64).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `end`.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.unit() * end as f64) as usize
    }
}
