//! Components, boundary loops, Euler characteristic, and what makes a disk.

use crate::{CornerId, FaceId, Topology, VertexId};

/// One closed walk along the boundary, the surface on its left.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BoundaryLoop {
    /// The vertices in order; the last is joined to the first.
    pub vertices: Vec<VertexId>,
}

/// Why a manifold is not a disk.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DiskError {
    /// More than one connected piece.
    #[error("the mesh has {count} separate components; the second starts at face {first_of_second}")]
    SeveralComponents {
        /// How many.
        count: usize,
        /// A face of the second one.
        first_of_second: FaceId,
    },
    /// A closed surface.
    #[error("the surface is closed: it has no boundary (genus {genus})")]
    NoBoundary {
        /// Its genus.
        genus: usize,
    },
    /// Holes.
    #[error("the surface has {count} boundary loops; the shortest, of {shortest} edges, passes vertex {vertex}")]
    SeveralBoundaries {
        /// How many.
        count: usize,
        /// The number of edges of the shortest.
        shortest: usize,
        /// A vertex on the shortest.
        vertex: VertexId,
    },
    /// One boundary loop, but handles.
    #[error("the surface has {genus} {}", if *genus == 1 { "handle" } else { "handles" })]
    Handles {
        /// Its genus.
        genus: usize,
    },
}

impl Topology {
    /// Every boundary loop, ordered by the lowest vertex index on it, starting there.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<BoundaryLoop> {
        let mut seen = vec![false; self.vertex_count()];
        let mut loops = Vec::new();
        for v in self.vertices().filter(|&v| self.is_boundary(v)) {
            if seen[v.index()] {
                continue;
            }
            let vertices: Vec<VertexId> =
                std::iter::successors(Some(v), |&u| self.next_on_boundary(u).filter(|&w| w != v)).collect();
            vertices.iter().for_each(|u| seen[u.index()] = true);
            loops.push(BoundaryLoop { vertices });
        }
        loops
    }

    /// The vertex after a boundary vertex, walking with the surface on the left.
    /// `None` for interior vertices and vertices without faces.
    #[must_use]
    pub fn next_on_boundary(&self, vertex: VertexId) -> Option<VertexId> {
        if self.is_interior(vertex) {
            return None;
        }
        self.fan_start(vertex).map(|first| self.vertex(first.next()))
    }

    /// The connected component of every face, numbered by first appearance, and how many there are.
    #[must_use]
    pub fn components(&self) -> (Vec<usize>, usize) {
        const UNSEEN: usize = usize::MAX;
        let mut component = vec![UNSEEN; self.face_count()];
        let mut count = 0;
        let mut stack = Vec::new();
        for seed in self.faces() {
            if component[seed.index()] != UNSEEN {
                continue;
            }
            component[seed.index()] = count;
            stack.push(seed);
            while let Some(face) = stack.pop() {
                for neighbour in face.corners().into_iter().filter_map(|c| self.opposite(c)).map(CornerId::face) {
                    if component[neighbour.index()] == UNSEEN {
                        component[neighbour.index()] = count;
                        stack.push(neighbour);
                    }
                }
            }
            count += 1;
        }
        (component, count)
    }

    /// Euler characteristic `V − E + F`, over the vertices that have faces.
    #[must_use]
    pub fn euler_characteristic(&self) -> isize {
        self.used_vertex_count() as isize - self.edge_count() as isize + self.face_count() as isize
    }

    /// Checks that the surface is one component with one boundary loop and no handle.
    ///
    /// # Errors
    /// A [`DiskError`] saying what it is instead.
    pub fn require_disk(&self) -> Result<(), DiskError> {
        let (component, count) = self.components();
        if count > 1 {
            let second = component.iter().position(|&c| c == 1).expect("there are two components");
            return Err(DiskError::SeveralComponents { count, first_of_second: FaceId::new(second) });
        }
        let loops = self.boundary_loops();
        // χ = 2 − 2g − b for one orientable component.
        let genus = ((2 - self.euler_characteristic() - loops.len() as isize) / 2) as usize;
        match loops.iter().min_by_key(|l| l.vertices.len()) {
            None => Err(DiskError::NoBoundary { genus }),
            Some(shortest) if loops.len() > 1 => Err(DiskError::SeveralBoundaries {
                count: loops.len(),
                shortest: shortest.vertices.len(),
                vertex: shortest.vertices[0],
            }),
            Some(_) if genus > 0 => Err(DiskError::Handles { genus }),
            Some(_) => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(n: usize, faces: &[[usize; 3]]) -> Topology {
        let faces: Vec<_> = faces.iter().map(|f| f.map(VertexId::new)).collect();
        Topology::build(n, &faces).expect("a manifold")
    }

    /// An `m × n` grid of squares, each two triangles, wrapped around in the directions asked for.
    fn grid(m: usize, n: usize, wrap_m: bool, wrap_n: bool) -> Topology {
        let (vm, vn) = (if wrap_m { m } else { m + 1 }, if wrap_n { n } else { n + 1 });
        let at = |i: usize, j: usize| (i % vm) * vn + j % vn;
        let faces: Vec<[usize; 3]> = (0..m)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
            .collect();
        build(vm * vn, &faces)
    }

    #[test]
    fn accepts_a_square_sheet() {
        let sheet = grid(3, 4, false, false);
        sheet.require_disk().expect("a disk");
        assert_eq!(sheet.euler_characteristic(), 1);
        assert_eq!(sheet.boundary_loops()[0].vertices.len(), 14);
    }

    #[test]
    fn walks_the_boundary_with_the_surface_on_the_left() {
        let one = build(3, &[[0, 1, 2]]);
        let order: Vec<usize> = one.boundary_loops()[0].vertices.iter().map(|v| v.index()).collect();
        assert_eq!(order, [0, 1, 2]);
    }

    #[test]
    fn rejects_a_closed_surface() {
        assert_eq!(grid(4, 5, true, true).require_disk().unwrap_err(), DiskError::NoBoundary { genus: 1 });
        let tetrahedron = build(4, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert_eq!(tetrahedron.require_disk().unwrap_err(), DiskError::NoBoundary { genus: 0 });
    }

    #[test]
    fn rejects_a_tube() {
        let e = grid(5, 2, true, false).require_disk().unwrap_err();
        assert_eq!(e, DiskError::SeveralBoundaries { count: 2, shortest: 5, vertex: VertexId::new(0) });
    }

    #[test]
    fn rejects_two_components() {
        let two = build(6, &[[0, 1, 2], [3, 4, 5]]);
        let e = two.require_disk().unwrap_err();
        assert_eq!(e, DiskError::SeveralComponents { count: 2, first_of_second: FaceId::new(1) });
    }

    #[test]
    fn rejects_a_torus_with_one_hole() {
        let torus = grid(4, 5, true, true);
        let faces: Vec<[VertexId; 3]> = torus.faces().skip(1).map(|f| torus.face_vertices(f)).collect();
        let open = Topology::build(torus.vertex_count(), &faces).expect("a manifold");
        assert_eq!(open.require_disk().unwrap_err(), DiskError::Handles { genus: 1 });
    }
}
