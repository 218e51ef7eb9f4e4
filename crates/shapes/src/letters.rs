//! The glyphs 2, V and X as curved sheets, after Figure 1 of Zayer, Rössl, Seidel 2004: long
//! narrow strokes, a concave outline, a branching.

use crate::blocks::{Block, mesh_blocks};
use crate::portable::{sin, sin_cos};
use abf_mesh::{Point2, Point3, TriMesh};
use std::f64::consts::TAU;

/// Bends the plane of a glyph into hills a stroke or two wide, so that it has Gaussian curvature.
fn bent(p: Point2<f64>) -> Point3<f64> {
    let z = 0.2 * sin(3.0 * p.x + 0.4) * sin(2.6 * p.y + 0.9) + 0.045 * sin(9.0 * p.x + 1.0) * sin(8.0 * p.y + 0.5);
    Point3::new(p.x, p.y, z)
}

/// The digit 2: a hook and a diagonal in one stroke, ending on the left block of the base.
pub(crate) fn two(triangles: usize) -> TriMesh {
    const STROKE_LENGTH: f64 = 6.6;
    const BASE_LENGTH: f64 = 1.6;
    let points =
        [[0.17, 0.95], [0.0, 0.26], [0.4, 0.26], [0.03, 0.85], [0.0, 0.0], [0.4, 0.0], [0.92, 0.0], [0.92, 0.26]];
    let stroke = Block { corners: [0, 1, 2, 3], length: Some(STROKE_LENGTH), chart: Box::new(hook_and_diagonal) };
    let corner = Block::straight(&points, [4, 5, 2, 1], None);
    let base = Block::straight(&points, [5, 6, 7, 2], Some(BASE_LENGTH));
    mesh_blocks(triangles, &[stroke, corner, base], bent)
}

/// The upper stroke of the 2, `along` from the free end, `across` from the inside of the hook: an
/// arc of 240° clockwise, then straight to the top of the base's left block.
fn hook_and_diagonal(along: f64, across: f64) -> Point2<f64> {
    const CENTRE: Point2<f64> = Point2::new(0.45, 1.0);
    const INNER_RADIUS: f64 = 0.15;
    const WIDTH: f64 = 0.3;
    /// The arc starts at 200° and turns to −40°, where its tangent is the diagonal.
    const ARC: (f64, f64) = (200.0 * TAU / 360.0, -40.0 * TAU / 360.0);
    /// The arc's part of the whole length.
    const ARC_SHARE: f64 = 0.63;
    const FOOT: (f64, f64, f64) = (0.0, 0.4, 0.26);
    let turned = (along / ARC_SHARE).min(1.0);
    let (sin, cos) = sin_cos(ARC.0 + (ARC.1 - ARC.0) * turned);
    let radius = INNER_RADIUS + WIDTH * across;
    let on_arc = Point2::new(CENTRE.x + radius * cos, CENTRE.y + radius * sin);
    let foot = Point2::new(FOOT.0 + (FOOT.1 - FOOT.0) * across, FOOT.2);
    let down = (along - ARC_SHARE).max(0.0) / (1.0 - ARC_SHARE);
    on_arc + (foot - on_arc) * down
}

/// The letter V: two slanted arms with level ends, joined below the notch.
pub(crate) fn v(triangles: usize) -> TriMesh {
    const ARM_LENGTH: f64 = 3.4;
    const JOINT_LENGTH: f64 = 1.5;
    /// Height at which the arms' inner edges meet: `1.4 (1 − 0.3/0.43)`.
    const NOTCH: f64 = 0.423;
    let points = [
        [0.0, 1.4],
        [0.3, NOTCH],
        [0.6, NOTCH],
        [0.3, 1.4],
        [0.43, 0.0],
        [0.6, 0.0],
        [0.77, 0.0],
        [0.9, NOTCH],
        [0.9, 1.4],
        [1.2, 1.4],
    ];
    let block = |corners, length| Block::straight(&points, corners, Some(length));
    let blocks = [
        block([0, 1, 2, 3], ARM_LENGTH),
        block([1, 4, 5, 2], JOINT_LENGTH),
        block([2, 5, 6, 7], JOINT_LENGTH),
        block([8, 2, 7, 9], ARM_LENGTH),
    ];
    mesh_blocks(triangles, &blocks, bent)
}

/// The letter X: a rhombus where the two bars cross, and four arms with level ends.
pub(crate) fn x(triangles: usize) -> TriMesh {
    const ARM_LENGTH: f64 = 2.1;
    /// The bars are `|x ∓ y · 0.375/0.7| ≤ 0.16`; they cross in a rhombus of these half-diagonals.
    const HALF_WIDTH: f64 = 0.16;
    const HALF_HEIGHT: f64 = 0.299;
    let points = [
        [HALF_WIDTH, 0.0],
        [0.0, HALF_HEIGHT],
        [-HALF_WIDTH, 0.0],
        [0.0, -HALF_HEIGHT],
        [0.535, 0.7],
        [0.215, 0.7],
        [-0.215, 0.7],
        [-0.535, 0.7],
        [-0.535, -0.7],
        [-0.215, -0.7],
        [0.215, -0.7],
        [0.535, -0.7],
    ];
    let arm = |corners| Block::straight(&points, corners, Some(ARM_LENGTH));
    let blocks = [
        Block::straight(&points, [0, 1, 2, 3], None),
        arm([0, 4, 5, 1]),
        arm([1, 6, 7, 2]),
        arm([2, 8, 9, 3]),
        arm([3, 10, 11, 0]),
    ];
    mesh_blocks(triangles, &blocks, bent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stroke_of_the_two_ends_on_its_base() {
        assert!((hook_and_diagonal(1.0, 0.0) - Point2::new(0.0, 0.26)).norm() < 1e-12);
        assert!((hook_and_diagonal(1.0, 1.0) - Point2::new(0.4, 0.26)).norm() < 1e-12);
    }

    #[test]
    fn the_notch_of_the_v_and_the_x_lies_where_the_edges_meet() {
        assert!((1.4_f64 * (1.0 - 0.3 / 0.43) - 0.423).abs() < 1e-3);
        assert!((0.16_f64 / (0.375 / 0.7) - 0.299).abs() < 1e-3);
    }
}
