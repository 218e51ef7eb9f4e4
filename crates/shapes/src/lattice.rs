//! The two patterns most shapes are drawn on: a grid of squares and a disk of rings.

use crate::portable::sin_cos;
use abf_mesh::{Point3, TriMesh};
use std::f64::consts::TAU;

/// Rounds to nine decimals: a text file then holds every coordinate exactly and in few digits.
pub(crate) fn rounded(p: Point3<f64>) -> Point3<f64> {
    const UNITS: f64 = 1e9;
    // Adding zero turns −0 into 0.
    p.map(|x| (x * UNITS).round() / UNITS + 0.0)
}

/// Collects positions and faces; the generators in this crate only name vertices they have added.
#[derive(Default)]
pub(crate) struct MeshBuilder {
    positions: Vec<Point3<f64>>,
    faces: Vec<[usize; 3]>,
}

impl MeshBuilder {
    /// A builder with room for this many vertices and faces.
    pub(crate) fn with_capacity(vertices: usize, faces: usize) -> Self {
        Self { positions: Vec::with_capacity(vertices), faces: Vec::with_capacity(faces) }
    }

    /// Adds a vertex, rounded, and returns its index.
    pub(crate) fn vertex(&mut self, p: Point3<f64>) -> usize {
        self.positions.push(rounded(p));
        self.positions.len() - 1
    }

    /// Adds a face.
    pub(crate) fn face(&mut self, face: [usize; 3]) {
        self.faces.push(face);
    }

    /// Adds two faces for a quadrilateral, split along its shorter diagonal. Where the two are
    /// equal `odd` decides, so that a flat grid gets alternating diagonals.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [usize; 4], odd: bool) {
        const TIE: f64 = 1e-6;
        let p = &self.positions;
        let (ac, bd) = ((p[c] - p[a]).norm_squared(), (p[d] - p[b]).norm_squared());
        let split_bd = if (ac - bd).abs() <= TIE * (ac + bd) { odd } else { bd < ac };
        let pair = if split_bd { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] };
        self.faces.extend(pair);
    }

    /// The finished mesh.
    pub(crate) fn finish(self) -> TriMesh {
        TriMesh::new(self.positions, &self.faces).expect("generators only use vertices they have added")
    }
}

/// A grid of `columns × rows` cells, two triangles each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl Grid {
    /// About `triangles` triangles; `aspect ≥ 1` is the length of the sheet over its width, so
    /// that the cells come out nearly square. There are `fewest_rows` rows at least (two give an
    /// interior vertex) and as many columns as fit them.
    pub(crate) fn sized(triangles: usize, aspect: f64, fewest_rows: usize) -> Self {
        let cells = triangles as f64 / 2.0;
        let rows = ((cells / aspect).sqrt().round() as usize).max(fewest_rows);
        let fewest_columns = (aspect * fewest_rows as f64).ceil() as usize;
        let columns = ((cells / rows as f64).round() as usize).max(fewest_columns);
        Self { columns, rows }
    }

    /// The mesh whose vertex in column `i`, row `j` is `surface(i, j)`.
    pub(crate) fn lift(self, surface: impl Fn(usize, usize) -> Point3<f64>) -> TriMesh {
        let Self { columns, rows } = self;
        let mut mesh = MeshBuilder::with_capacity((columns + 1) * (rows + 1), 2 * columns * rows);
        for j in 0..=rows {
            for i in 0..=columns {
                mesh.vertex(surface(i, j));
            }
        }
        let at = |i: usize, j: usize| j * (columns + 1) + i;
        for j in 0..rows {
            for i in 0..columns {
                mesh.quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], (i + j) % 2 == 1);
            }
        }
        mesh.finish()
    }

    /// The mesh over the unit square: vertex `(i, j)` is `surface(i / columns, j / rows)`.
    pub(crate) fn lift_unit(self, surface: impl Fn(f64, f64) -> Point3<f64>) -> TriMesh {
        self.lift(|i, j| surface(i as f64 / self.columns as f64, j as f64 / self.rows as f64))
    }
}

/// A disk of concentric rings around a centre: ring `k` has `sectors · k` vertices, and the whole
/// has `sectors · rings²` triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rings {
    sectors: usize,
    rings: usize,
}

/// A vertex of [`Rings`]: where it is in its sector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingVertex {
    /// 0 at the centre, 1 on the rim.
    pub(crate) radius: f64,
    /// Which sector, from 0.
    pub(crate) sector: usize,
    /// How far through the sector, in `[0, 1)`.
    pub(crate) through: f64,
    /// How many sectors there are.
    pub(crate) sectors: usize,
}

impl RingVertex {
    /// `(cos φ, sin φ)` with the angle spread evenly over the ring.
    pub(crate) fn direction(self) -> (f64, f64) {
        let (sin, cos) = sin_cos(TAU * (self.sector as f64 + self.through) / self.sectors as f64);
        (cos, sin)
    }

    /// The point of the unit disk under this vertex.
    pub(crate) fn in_unit_disk(self) -> (f64, f64) {
        let (cos, sin) = self.direction();
        (self.radius * cos, self.radius * sin)
    }
}

impl Rings {
    /// Six sectors make nearly equilateral triangles on a flat disk.
    pub(crate) const SECTORS: usize = 6;

    /// About `triangles` triangles in [`Rings::SECTORS`] sectors; one ring at least.
    pub(crate) fn sized(triangles: usize) -> Self {
        let rings = (triangles as f64 / Self::SECTORS as f64).sqrt().round() as usize;
        Self { sectors: Self::SECTORS, rings: rings.max(1) }
    }

    /// The mesh with every vertex placed by `surface`; counter-clockwise seen from above.
    pub(crate) fn lift(self, surface: impl Fn(RingVertex) -> Point3<f64>) -> TriMesh {
        let Self { sectors, rings } = self;
        let mut mesh = MeshBuilder::with_capacity(1 + sectors * rings * (rings + 1) / 2, sectors * rings * rings);
        mesh.vertex(surface(RingVertex { radius: 0.0, sector: 0, through: 0.0, sectors }));
        for k in 1..=rings {
            for i in 0..sectors * k {
                let (sector, through) = (i / k, (i % k) as f64 / k as f64);
                mesh.vertex(surface(RingVertex { radius: k as f64 / rings as f64, sector, through, sectors }));
            }
        }
        for k in 1..=rings {
            for sector in 0..sectors {
                self.fill(&mut mesh, k, sector);
            }
        }
        mesh.finish()
    }

    /// The vertex that is `j` steps into a sector of ring `k`; the centre is ring 0.
    fn vertex(self, k: usize, sector: usize, j: usize) -> usize {
        if k == 0 {
            return 0;
        }
        1 + self.sectors * k * (k - 1) / 2 + (sector * k + j) % (self.sectors * k)
    }

    /// The faces of one sector between rings `k − 1` and `k`.
    fn fill(self, mesh: &mut MeshBuilder, k: usize, sector: usize) {
        let inner = |j| self.vertex(k - 1, sector, j);
        let outer = |j| self.vertex(k, sector, j);
        for j in 0..k {
            mesh.face([inner(j), outer(j), outer(j + 1)]);
            if j + 1 < k {
                mesh.face([inner(j), outer(j + 1), inner(j + 1)]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_come_close_to_the_number_asked_for() {
        for (triangles, aspect) in [(8, 1.0), (200, 1.0), (200, 10.0), (1800, 1.0), (20_000, 2.8)] {
            let g = Grid::sized(triangles, aspect, 2);
            let off = (2 * g.columns * g.rows) as f64 / triangles as f64 - 1.0;
            assert!(off.abs() < 0.05, "{g:?} for {triangles}");
        }
        assert_eq!(Grid::sized(0, 2.5, 2), Grid { columns: 5, rows: 2 });
    }

    #[test]
    fn rounding_leaves_nine_decimals_and_no_negative_zero() {
        let p = rounded(Point3::new(1.0 / 3.0, -1e-12, 2.0));
        assert_eq!(format!("{} {} {}", p.x, p.y, p.z), "0.333333333 0 2");
    }
}
