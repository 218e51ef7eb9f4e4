//! Sweeps over a whole level: every vertex makes a step of its own.

use crate::coarsen::{BLOCK, PER_TASK};
use crate::star::{Spoke, improved};
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{Point2, VertexId};
use abf_parallel::prelude::*;

/// A mesh by what is around its vertices, to be swept over.
pub(crate) struct Sweep<'l> {
    faces: &'l [[VertexId; 3]],
    /// One per corner, rad.
    target: &'l [f64],
    /// Where the corners at each vertex begin in `corners`, and where they end.
    starts: Vec<u32>,
    corners: Vec<u32>,
    /// The vertices by colour; two of one colour are no neighbours.
    colours: Vec<Vec<u32>>,
}

impl<'l> Sweep<'l> {
    pub(crate) fn new(faces: &'l [[VertexId; 3]], target: &'l [f64], vertices: usize) -> Self {
        let mut starts = vec![0; vertices + 1];
        faces.iter().flatten().for_each(|v| starts[v.index() + 1] += 1);
        for v in 0..vertices {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut corners = vec![0; 3 * faces.len()];
        for (corner, v) in faces.iter().flatten().enumerate() {
            corners[next[v.index()] as usize] = corner as u32;
            next[v.index()] += 1;
        }
        let mut sweep = Self { faces, target, starts, corners, colours: Vec::new() };
        sweep.colours = sweep.coloured();
        sweep
    }

    /// One step of every vertex, Gauss–Seidel by colours: the same bits on any number of threads.
    pub(crate) fn run(&self, uv: &mut [Point2<f64>], checkpoint: &mut Checkpoint<'_>) -> Result<(), Cancelled> {
        for block in self.colours.iter().flat_map(|colour| colour.chunks(BLOCK)) {
            checkpoint()?;
            let at: &[Point2<f64>] = uv;
            let moved = |&v: &u32| improved(at[v as usize], &self.spokes(v, at));
            let moved: Vec<Point2<f64>> = block.par_iter().with_min_len(PER_TASK).map(moved).collect();
            for (&v, p) in block.iter().zip(moved) {
                uv[v as usize] = p;
            }
        }
        Ok(())
    }

    fn at(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.corners[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    fn spokes<'s>(&'s self, vertex: u32, uv: &'s [Point2<f64>]) -> impl Iterator<Item = Spoke> + Clone + 's {
        self.at(vertex).iter().map(move |&corner| {
            let around = around(corner);
            let [_, a, b] = around.map(|c| self.faces[c / 3][c % 3].index());
            Spoke { ends: [uv[a], uv[b]], target: around.map(|c| self.target[c]) }
        })
    }

    /// The first colour that no neighbour has, vertex by vertex. One that finds the first 64 taken has none, and is not
    /// swept over.
    fn coloured(&self) -> Vec<Vec<u32>> {
        const NONE: u8 = u8::MAX;
        let vertices = self.starts.len() - 1;
        let mut colour = vec![NONE; vertices];
        let mut colours: Vec<Vec<u32>> = Vec::new();
        for v in (0..vertices as u32).filter(|&v| !self.at(v).is_empty()) {
            let neighbours = self.at(v).iter().flat_map(|&corner| {
                let [_, a, b] = around(corner).map(|c| self.faces[c / 3][c % 3].index());
                [colour[a], colour[b]]
            });
            let taken = neighbours.filter(|&c| c != NONE).fold(0_u64, |taken, c| taken | 1 << c);
            let first = taken.trailing_ones() as usize;
            if first < u64::BITS as usize {
                colour[v as usize] = first as u8;
                colours.resize_with(colours.len().max(first + 1), Vec::new);
                colours[first].push(v);
            }
        }
        colours
    }
}

/// A corner, and the next two of its face.
fn around(corner: u32) -> [usize; 3] {
    let (face, k) = (corner as usize / 3, corner as usize % 3);
    [0, 1, 2].map(|step| 3 * face + (k + step) % 3)
}
