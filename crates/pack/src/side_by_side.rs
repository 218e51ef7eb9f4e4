//! Pieces side by side at their own scale, on one page that is as large as they need.

use crate::boxes::{Rectangle, Spot, place};
use crate::geometry::{Hull, Turn, UNTURNED, compose, extent};
use crate::search::check;
use crate::{PackError, Piece, Placement};
use abf_control::SettingError;

/// A turn by a quarter of a circle.
const QUARTER: Turn = [0.0, 1.0];
/// How many widths of the page are tried: from that of a square as large as all boxes to twice that.
const WIDTHS: usize = 11;

/// Pieces side by side.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SideBySide {
    /// One for every piece, in their order, all on page 0. `corner` is in units of the input: the scale is 1.
    pub placements: Vec<Placement>,
    /// Width and height of the box around all of them, whose lower left corner is the origin.
    pub size: [f64; 2],
}

/// Puts pieces side by side without scaling them. Each is turned into its tightest box, unless it keeps its angle. The boxes
/// are at least `gap` apart. A single piece lies on the longer side of its box. Groups do not matter.
///
/// # Errors
/// [`PackError`] for a piece without points or with a coordinate that is not finite, and for a gap that is no length.
///
/// ```
/// use abf_pack::{Piece, side_by_side};
///
/// // A bar that stands upright, and a square.
/// let bar = Piece::new(vec![vec![[0.0, 0.0], [1.0, 0.0], [1.0, 8.0], [0.0, 8.0]]]);
/// let square = Piece::new(vec![vec![[5.0, 5.0], [7.0, 5.0], [7.0, 7.0], [5.0, 7.0]]]);
/// let row = side_by_side(&[bar, square], 0.5)?;
/// // The bar lies below, the square above it, half a unit apart.
/// assert_eq!(row.size, [8.0, 3.5]);
/// assert_eq!(row.placements[1].texel([5.0, 5.0], 1.0), [0.0, 1.5]);
/// # Ok::<(), abf_pack::PackError>(())
/// ```
pub fn side_by_side(pieces: &[Piece], gap: f64) -> Result<SideBySide, PackError> {
    if !(gap >= 0.0 && gap.is_finite()) {
        return Err(SettingError::new("gap", "a length, at least 0", gap).into());
    }
    check(pieces)?;
    let boxed: Vec<Boxed> = pieces.iter().map(Boxed::new).collect();
    let boxes: Vec<Rectangle> = boxed
        .iter()
        .zip(pieces)
        .map(|(Boxed { size, .. }, piece)| Rectangle { size: size.map(|x| x + gap), turns: !piece.keeps_its_angle })
        .collect();
    let spots = least_page(&boxes);
    let mut size = [0.0_f64; 2];
    let placed = |((spot, boxed), piece): ((Spot, Boxed), &Piece)| {
        let Boxed { turn, low, size: own } =
            if spot.on_its_side { Boxed::turned(piece, compose(boxed.turn, QUARTER)) } else { boxed };
        size = [0, 1].map(|k| size[k].max(spot.corner[k] + own[k]));
        Placement { page: 0, turn, low, corner: spot.corner }
    };
    let placements = spots.into_iter().zip(boxed).zip(pieces).map(placed).collect();
    Ok(SideBySide { placements, size })
}

/// The box around a piece at an angle.
#[derive(Clone, Copy, Debug)]
struct Boxed {
    turn: Turn,
    low: [f64; 2],
    size: [f64; 2],
}

impl Boxed {
    fn new(piece: &Piece) -> Self {
        let points: Vec<[f64; 2]> = piece.points().collect();
        Self::turned(piece, if piece.keeps_its_angle { UNTURNED } else { Hull::of(&points).tightest_box() })
    }

    fn turned(piece: &Piece, turn: Turn) -> Self {
        let points: Vec<[f64; 2]> = piece.points().collect();
        let (low, size) = extent(&points, turn);
        Self { turn, low, size }
    }
}

/// Boxes on the page that has the least area of all that are tried; of equal ones the narrowest.
fn least_page(boxes: &[Rectangle]) -> Vec<Spot> {
    let widest = boxes.iter().map(|b| b.size[0]).fold(0.0, f64::max);
    let area: f64 = boxes.iter().map(|b| b.size[0] * b.size[1]).sum();
    let mut best: Option<(f64, Vec<Spot>)> = None;
    for k in 0..WIDTHS {
        let width = widest.max(area.sqrt() * (1.0 + k as f64 / (WIDTHS - 1) as f64));
        let Some(spots) = place(boxes, [width, f64::INFINITY], 1) else { continue };
        let end = |(spot, b): (&Spot, &Rectangle)| {
            let [w, h] = if spot.on_its_side { [b.size[1], b.size[0]] } else { b.size };
            [spot.corner[0] + w, spot.corner[1] + h]
        };
        let ends = spots.iter().zip(boxes).map(end);
        let [w, h] = ends.fold([0.0_f64; 2], |[w, h], [x, y]| [w.max(x), h.max(y)]);
        if best.as_ref().is_none_or(|(least, _)| w * h < *least) {
            best = Some((w * h, spots));
        }
    }
    best.map(|(_, spots)| spots).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2]) -> Piece {
        Piece::new(vec![vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]])
    }

    fn placed(piece: &Piece, at: &Placement) -> [f64; 4] {
        let points: Vec<[f64; 2]> = piece.points().map(|p| at.texel(p, 1.0)).collect();
        let ([x, y], [w, h]) = extent(&points, UNTURNED);
        [x, y, x + w, y + h]
    }

    #[test]
    fn boxes_are_the_gap_apart_and_inside_the_page() {
        let pieces: Vec<Piece> = (0..60_i32)
            .map(|i| rectangle([f64::from(i), 0.0], [1.0 + f64::from(i * 7 % 11), 0.5 + f64::from(i * 5 % 7)]))
            .collect();
        let SideBySide { placements, size } = side_by_side(&pieces, 0.25).expect("pieces");
        let boxes: Vec<[f64; 4]> = pieces.iter().zip(&placements).map(|(piece, at)| placed(piece, at)).collect();
        for (i, a) in boxes.iter().enumerate() {
            assert!(a[0] >= 0.0 && a[1] >= 0.0 && a[2] <= size[0] + 1e-12 && a[3] <= size[1] + 1e-12, "{a:?}");
            for b in &boxes[..i] {
                let apart = [a[0] - b[2], b[0] - a[2], a[1] - b[3], b[1] - a[3]].into_iter().fold(f64::MIN, f64::max);
                assert!(apart >= 0.25 - 1e-12, "{a:?} {b:?}");
            }
        }
        let area: f64 = boxes.iter().map(|b| (b[2] - b[0]) * (b[3] - b[1])).sum();
        assert!(area > 0.7 * size[0] * size[1], "{size:?}");
    }

    #[test]
    fn one_piece_lies_in_its_tightest_box_or_keeps_its_angle() {
        let points = [[0.0, 0.0], [3.0, 4.0], [-5.0, 10.0], [-8.0, 6.0]];
        let turned = Piece::new(vec![points.to_vec()]);
        let alone = side_by_side(std::slice::from_ref(&turned), 1.0).expect("a piece");
        assert!((alone.size[0] - 10.0).abs() < 1e-12 && (alone.size[1] - 5.0).abs() < 1e-12, "{:?}", alone.size);
        let kept = Piece { keeps_its_angle: true, ..turned };
        let kept = side_by_side(&[kept], 1.0).expect("a piece");
        assert_eq!((kept.size, kept.placements[0].turn), ([11.0, 10.0], UNTURNED));
        assert_eq!(kept.placements[0].texel([0.0, 0.0], 1.0), [8.0, 0.0]);
    }

    #[test]
    fn what_is_no_piece_and_no_gap_is_refused() {
        let square = rectangle([0.0; 2], [1.0; 2]);
        for gap in [-1.0, f64::NAN, f64::INFINITY] {
            let error = side_by_side(std::slice::from_ref(&square), gap).expect_err("no gap");
            assert!(error.to_string().starts_with("gap must be a length, at least 0"), "{error}");
        }
        assert_eq!(side_by_side(&[square, Piece::default()], 0.0), Err(PackError::NoPoints { piece: 1 }));
        assert_eq!(side_by_side(&[], 1.0).map(|page| page.size), Ok([0.0; 2]));
    }
}
