//! Surfaces along a curve: the ring cyclide cut open, the twisted band and the caterpillar.

use crate::lattice::Grid;
use crate::portable::sin_cos;
use abf_mesh::{Point3, TriMesh};
use std::f64::consts::TAU;

/// A ring cyclide of Dupin, cut along one meridian and one parallel into a disk. The two sides of
/// a cut lie at the same place but are different vertices.
///
/// With a² = b² + c² and c < d < a,
///
/// ```text
/// x = (d (c − a cos u cos v) + b² cos u) / w      w = a − c cos u cos v
/// y = b sin u (a − d cos v) / w
/// z = b sin v (c cos u − d) / w
/// ```
///
/// The lengths of the two tangents stand in the ratio (a − d cos v) : (d − c cos u), a function of
/// `v` over one of `u`. Hence there are parameters s(u), t(v) in which the grid is one of small
/// squares (see [`kepler`]), and the cut cyclide is conformally a rectangle.
pub(crate) fn cyclide(triangles: usize) -> TriMesh {
    const A: f64 = 1.0;
    const B: f64 = 0.96;
    const C: f64 = 0.28;
    const D: f64 = 0.5;
    /// Fewer would not go around the tube.
    const FEWEST_ROWS: usize = 6;
    // The periods of s and t are 2π/√(d² − c²) and 2π/√(a² − d²).
    let aspect = ((A * A - D * D) / (D * D - C * C)).sqrt();
    let grid = Grid::sized(triangles, aspect, FEWEST_ROWS);
    grid.lift(|i, j| {
        // Modulo, so that the two sides of a cut agree to the bit.
        let (sin_u, cos_u) = kepler(C, D, TAU * (i % grid.columns) as f64 / grid.columns as f64);
        let (sin_v, cos_v) = kepler(D, A, TAU * (j % grid.rows) as f64 / grid.rows as f64);
        let w = A - C * cos_u * cos_v;
        let x = D * (C - A * cos_u * cos_v) + B * B * cos_u;
        let (y, z) = (B * sin_u * (A - D * cos_v), B * sin_v * (C * cos_u - D));
        Point3::new(x / w, y / w, z / w)
    })
}

/// `(sin u, cos u)` where `s` is `√(q² − p²) ∫ du / (q − p cos u)`: the step from true to eccentric
/// anomaly on an orbit of eccentricity p/q,
/// `cos u = (p + q cos s)/(q + p cos s)`, `sin u = √(q² − p²) sin s/(q + p cos s)`.
fn kepler(p: f64, q: f64, s: f64) -> (f64, f64) {
    let (sin, cos) = sin_cos(s);
    ((q * q - p * p).sqrt() * sin / (q + p * cos), (p + q * cos) / (q + p * cos))
}

/// A long band along an open arc of a circle that turns about its centre line three times.
///
/// `((1 + r cos φ) cos τ, (1 + r cos φ) sin τ, r sin φ)` with `r` across, `τ` along, `φ = 3.6 τ`.
pub(crate) fn twisted_band(triangles: usize) -> TriMesh {
    const ARC: f64 = 300.0 * TAU / 360.0;
    const TURNS: f64 = 3.0;
    const WIDTH: f64 = 0.5;
    /// Two rows, so that there is an interior vertex.
    const FEWEST_ROWS: usize = 2;
    Grid::sized(triangles, ARC / WIDTH, FEWEST_ROWS).lift_unit(|u, v| {
        let r = WIDTH * (v - 0.5);
        let (sin_phi, cos_phi) = sin_cos(TAU * TURNS * u);
        let (sin_tau, cos_tau) = sin_cos(ARC * u);
        let out = 1.0 + r * cos_phi;
        Point3::new(out * cos_tau, out * sin_tau, r * sin_phi)
    })
}

/// The back of a caterpillar: a half-pipe, open below, that swells and narrows nine times along a
/// spiral of one turn and three quarters. As flat as it can be it still turns a little more than once, so
/// a map that keeps angles or lengths lies over itself.
///
/// `((R + r sin φ) cos τ, (R + r sin φ) sin τ, h τ/2π + r cos φ)` with `τ` along, `φ` across from −π/2
/// to π/2, `r` the radius of the body there.
pub(crate) fn caterpillar(triangles: usize) -> TriMesh {
    const TURNS: f64 = 1.75;
    const SEGMENTS: f64 = 9.0;
    /// R: how far the middle of the body is from the axis.
    const SPIRAL: f64 = 1.1;
    /// h: what it rises in a turn.
    const RISE: f64 = 1.2;
    const BODY: f64 = 0.34;
    /// By which part of it the body swells and narrows.
    const SWELL: f64 = 0.6;
    /// Two rows, so that there is an interior vertex.
    const FEWEST_ROWS: usize = 2;
    let aspect = TURNS * SPIRAL * 2.0 / BODY;
    Grid::sized(triangles, aspect, FEWEST_ROWS).lift_unit(|u, v| {
        let r = BODY * (1.0 - SWELL * sin_cos(TAU * SEGMENTS * u).1);
        let (sin_phi, cos_phi) = sin_cos(TAU * 0.5 * (v - 0.5));
        let (sin_tau, cos_tau) = sin_cos(TAU * TURNS * u);
        let out = SPIRAL + r * sin_phi;
        Point3::new(out * cos_tau, out * sin_tau, RISE * TURNS * u + r * cos_phi)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cyclide_closes_along_both_cuts() {
        let mesh = cyclide(3200);
        let mut places: Vec<[u64; 3]> =
            mesh.positions().iter().map(|p| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()]).collect();
        places.sort_unstable();
        places.dedup();
        // A torus of triangles has half as many vertices as faces.
        assert_eq!(2 * places.len(), mesh.face_count());
    }

    #[test]
    fn the_grid_on_the_cyclide_is_one_of_squares() {
        let mesh = cyclide(80_000);
        let angles = mesh.corner_angles();
        let right = angles.iter().filter(|a| (**a - TAU / 4.0).abs() < 0.05).count();
        assert_eq!(right, mesh.face_count());
    }
}
