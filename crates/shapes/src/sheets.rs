//! Square sheets: bumpy, folded, rolled up, and spiked.

use crate::lattice::Grid;
use crate::portable::{hash_unit, sin, sin_cos};
use abf_mesh::{Point3, TriMesh};

/// Two rows of cells, so that there is an interior vertex.
const FEWEST_ROWS: usize = 2;

/// Smooth hills and valleys over the unit square: a sum of three fixed sines.
pub(crate) fn bumpy(triangles: usize) -> TriMesh {
    Grid::sized(triangles, 1.0, FEWEST_ROWS).lift_unit(|x, y| {
        let z = 0.14 * sin(5.0 * x + 0.7) * sin(6.0 * y + 0.2)
            + 0.05 * sin(11.0 * x + 4.0 * y)
            + 0.03 * sin(3.0 * x - 13.0 * y + 1.0);
        Point3::new(x, y, z)
    })
}

/// A Miura fold: a sheet creased in both directions, and yet every interior vertex has the angle
/// sum 2π, so that it unfolds into the plane without any distortion.
///
/// A step along a row is `(4, ±3, 0)`, a step along a column `(0, 4, ±3)`, the sign changing at
/// every crease. The four angles at a vertex are γ, π − γ, γ, π − γ with cos γ = 12/25, whatever
/// creases cross there. All coordinates are small integers times a power of two, hence exact;
/// [`crate::lattice::rounded`] must leave them so, which the tests check.
pub(crate) fn folded(triangles: usize) -> TriMesh {
    /// Creases either way, where there are cells enough.
    const PANELS: usize = 6;
    let grid = Grid::sized(triangles, 1.0, FEWEST_ROWS);
    let panel = (grid.columns.max(grid.rows) / PANELS).max(1);
    // Nine decimals hold a multiple of 2⁻⁹ exactly and nothing finer, so from 128 cells a side on
    // (32 768 triangles) the sheet grows instead of its cells shrinking.
    let scale = 1.0 / (4 * grid.columns.max(grid.rows)).next_power_of_two().min(512) as f64;
    grid.lift(|i, j| {
        let (x, y, z) = (4 * i, 4 * j + 3 * zigzag(i, panel), 3 * zigzag(j, panel));
        Point3::new(x as f64, y as f64, z as f64) * scale
    })
}

/// `0, 1, …, half, half − 1, …, 0, 1, …`: up and down with period `2 half`.
fn zigzag(i: usize, half: usize) -> usize {
    let phase = i % (2 * half);
    phase.min(2 * half - phase)
}

/// A sheet rolled up along the involute of a circle: curved, but in one direction only.
///
/// The involute `a (cos t + t sin t, sin t − t cos t)` has arc length `a t²/2` and keeps the
/// distance `2πa` between its turns; equal steps of length are `t = √(2s/a)`.
pub(crate) fn roll(triangles: usize) -> TriMesh {
    const CIRCLE: f64 = 0.05;
    const START: f64 = 3.0;
    const END: f64 = 12.0;
    const WIDTH: f64 = 1.2;
    let length = |t: f64| 0.5 * CIRCLE * t * t;
    Grid::sized(triangles, (length(END) - length(START)) / WIDTH, FEWEST_ROWS).lift_unit(|u, v| {
        let t = (START * START + u * (END * END - START * START)).sqrt();
        let (sin, cos) = sin_cos(t);
        Point3::new(CIRCLE * (cos + t * sin), WIDTH * v, CIRCLE * (sin - t * cos))
    })
}

/// A flat sheet with a field of cones, one to each square of a coarse board, off centre and of
/// slopes 0.35 to 1.25: angle deficits of 0.3 to 2.5 at the tips. A stress test: rings with a
/// deficit above 1 are the ones for which one linear step changes its initial guess.
pub(crate) fn spiky_field(triangles: usize) -> TriMesh {
    let grid = Grid::sized(triangles, 1.0, FEWEST_ROWS);
    let field = SpikeField::new(grid);
    grid.lift_unit(|x, y| Point3::new(x, y, field.height(x, y)))
}

/// Where the cones of [`spiky_field`] stand.
struct SpikeField {
    grid: Grid,
    per_side: usize,
}

impl SpikeField {
    /// A cone needs this many cells either way to look like one.
    const CELLS_PER_SPIKE: usize = 8;
    const MOST_PER_SIDE: usize = 6;
    /// Radius of a cone, and how far off centre it may stand, in squares of the board.
    const RADIUS: f64 = 0.36;
    const OFF_CENTRE: f64 = 0.05;
    const SLOPES: (f64, f64) = (0.35, 1.25);

    fn new(grid: Grid) -> Self {
        let per_side = (grid.columns.min(grid.rows) / Self::CELLS_PER_SPIKE).clamp(1, Self::MOST_PER_SIDE);
        Self { grid, per_side }
    }

    /// `slope · max(0, radius − distance)` to the one cone in the square of the board at (x, y).
    fn height(&self, x: f64, y: f64) -> f64 {
        let side = self.per_side as f64;
        let square = |x: f64| ((x * side) as usize).min(self.per_side - 1);
        let (i, j) = (square(x), square(y));
        let random = |which: usize| hash_unit((3 * (i * Self::MOST_PER_SIDE + j) + which) as u64);
        // The tip is a vertex of the grid, else it would be cut off.
        let tip = |square: usize, random: f64, cells: usize| {
            let centre = (square as f64 + 0.5 + Self::OFF_CENTRE * (2.0 * random - 1.0)) / side;
            (centre * cells as f64).round() / cells as f64
        };
        let (dx, dy) = (x - tip(i, random(0), self.grid.columns), y - tip(j, random(1), self.grid.rows));
        let slope = Self::SLOPES.0 + (Self::SLOPES.1 - Self::SLOPES.0) * random(2);
        slope * (Self::RADIUS / side - (dx * dx + dy * dy).sqrt()).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Topology;
    use std::f64::consts::TAU;

    /// `2π − Σα°` at every interior vertex, and how many angles went into it.
    fn deficits(mesh: &TriMesh) -> Vec<(f64, usize)> {
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let angles = mesh.corner_angles();
        let deficit = |v| (TAU - topology.fan(v).map(|c| angles[c.index()]).sum::<f64>(), topology.fan(v).count());
        topology.vertices().filter(|&v| topology.is_interior(v)).map(deficit).collect()
    }

    #[test]
    fn the_folded_sheet_is_developable_to_rounding() {
        for triangles in [8, 100, 512, 2000, 20_000, 300_000] {
            let mesh = folded(triangles);
            assert!(mesh.positions().iter().flat_map(|p| [p.x, p.y, p.z]).all(|x| (x * 512.0).fract() == 0.0));
            for (deficit, valence) in deficits(&mesh) {
                assert!(deficit.abs() < 1e-15 * valence as f64 + 2e-15, "deficit {deficit:e} of {triangles}");
            }
        }
    }

    #[test]
    fn the_folded_sheet_is_not_flat() {
        let mesh = folded(512);
        let highest = mesh.positions().iter().map(|p| p.z).fold(0.0, f64::max);
        assert!(highest > 0.05);
    }

    #[test]
    fn the_roll_is_developable() {
        assert!(deficits(&roll(2000)).iter().all(|(deficit, _)| deficit.abs() < 1e-6));
    }

    #[test]
    fn the_spiky_field_switches_rings_but_stays_within_reason() {
        for triangles in [600, 2450, 20_000] {
            let deficits = deficits(&spiky_field(triangles));
            let largest = deficits.iter().map(|d| d.0).fold(0.0, f64::max);
            assert!(largest > 1.0 && largest < 3.0, "deficit {largest} of {triangles}");
        }
        assert!(deficits(&spiky_field(2450)).iter().filter(|d| d.0 > 1.0).count() >= 8);
    }
}
