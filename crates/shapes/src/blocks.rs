//! Outlines that are no rectangle: quadrilateral blocks joined along whole sides.

use crate::lattice::MeshBuilder;
use abf_mesh::{Point2, Point3, TriMesh};
use std::collections::HashMap;

/// One four-sided piece of an outline, filled by a grid of its own.
pub(crate) struct Block {
    /// The corners at (0, 0), (1, 0), (1, 1), (0, 1), by number. Blocks that share two corner
    /// numbers are joined along the side between them.
    pub(crate) corners: [usize; 4],
    /// How long the block is from (0, 0) to (1, 0), in units of the stroke's width; `None` for a
    /// joint, which has as many cells that way as the strokes have across.
    pub(crate) length: Option<f64>,
    /// The unit square to the plane, counter-clockwise.
    pub(crate) chart: Box<dyn Fn(f64, f64) -> Point2<f64>>,
}

impl Block {
    /// A block with straight sides: the bilinear map to four of the points.
    pub(crate) fn straight(points: &[[f64; 2]], corners: [usize; 4], length: Option<f64>) -> Self {
        let [a, b, c, d] = corners.map(|k| Point2::from(points[k]).coords);
        let chart =
            move |u: f64, v: f64| Point2::from((a * (1.0 - u) + b * u) * (1.0 - v) + (d * (1.0 - u) + c * u) * v);
        Self { corners, length, chart: Box::new(chart) }
    }

    /// Cells along (u) and across (v), when strokes are `across` cells wide.
    fn cells(&self, across: usize, cells_per_length: f64) -> [usize; 2] {
        let along = self.length.map_or(across, |l| ((l * cells_per_length).round() as usize).max(1));
        [along, across]
    }

    /// Where the grid vertex `(i, j)` lies on the rim of the block, in numbers that a neighbour
    /// computes alike: the lower corner, the upper one, and the steps from the lower.
    fn side_key(&self, i: usize, j: usize, [m, n]: [usize; 2]) -> Option<(usize, usize, usize)> {
        let [a, b, c, d] = self.corners;
        let (from, to, step, steps) = match (i, j) {
            (i, 0) => (a, b, i, m),
            (i, j) if i == m => (b, c, j, n),
            (i, j) if j == n => (d, c, i, m),
            (0, j) => (a, d, j, n),
            _ => return None,
        };
        Some(match step {
            0 => (from, from, 0),
            s if s == steps => (to, to, 0),
            s if from < to => (from, to, s),
            s => (to, from, steps - s),
        })
    }
}

/// Meshes blocks with about `triangles` triangles and lifts them into space.
///
/// Every block is as many cells across as every other (two at least), and the cells along the
/// strokes make up the number asked for.
pub(crate) fn mesh_blocks(triangles: usize, blocks: &[Block], surface: impl Fn(Point2<f64>) -> Point3<f64>) -> TriMesh {
    const FEWEST_ACROSS: usize = 2;
    let cells = triangles as f64 / 2.0;
    let joints = blocks.iter().filter(|b| b.length.is_none()).count() as f64;
    let length: f64 = blocks.iter().filter_map(|b| b.length).sum();
    let across = ((cells / (length + joints)).sqrt().round() as usize).max(FEWEST_ACROSS);
    let cells_per_length = (cells / across as f64 - joints * across as f64) / length;

    let mut mesh = MeshBuilder::with_capacity(triangles, triangles);
    let mut on_sides = HashMap::new();
    for block in blocks {
        let size @ [m, n] = block.cells(across, cells_per_length);
        let mut at = Vec::with_capacity((m + 1) * (n + 1));
        for (j, i) in (0..=n).flat_map(|j| (0..=m).map(move |i| (j, i))) {
            let mut add = || mesh.vertex(surface((block.chart)(i as f64 / m as f64, j as f64 / n as f64)));
            at.push(match block.side_key(i, j, size) {
                Some(key) => *on_sides.entry(key).or_insert_with(add),
                None => add(),
            });
        }
        for (j, i) in (0..n).flat_map(|j| (0..m).map(move |i| (j, i))) {
            let k = j * (m + 1) + i;
            mesh.quad([at[k], at[k + 1], at[k + m + 2], at[k + m + 1]], (i + j) % 2 == 1);
        }
    }
    mesh.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Topology;

    #[test]
    fn blocks_are_joined_along_shared_sides_whichever_way_they_run() {
        // A square and two neighbours, above and to the right, that number the shared side otherwise.
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let blocks = [[0, 1, 2, 3], [4, 5, 2, 1], [2, 6, 7, 3]].map(|c| Block::straight(&points, c, None));
        let mesh = mesh_blocks(54, &blocks, |p| Point3::new(p.x, p.y, 0.0));
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        topology.require_disk().expect("a disk");
        assert_eq!((mesh.face_count(), mesh.vertex_count()), (54, 40));
        assert!((mesh.area() - 3.0).abs() < 1e-8);
    }
}
