//! Charts that are smaller or larger than the others.

use abf_mesh::{Point2, bounds};
use abf_pack::Piece;
use abf_parallel::prelude::*;

pub(super) fn resize(piece: &mut Piece, factor: f64) {
    if factor != 1.0 {
        piece.polygons.iter_mut().flatten().flatten().flatten().for_each(|x| *x *= factor);
    }
}

/// How often a chart is made larger: to an eighth of a texel, then to a whole one.
const ENLARGED: u8 = 2;

/// Does something about a chart that packing has spoilt: it is not turned, and if it was not, made larger, but for one that
/// would no longer fit a page with sides of `side` texels: the others would become smaller for it. `false` where nothing is left
/// to do. The chart has this scale, and was made larger so many times.
pub(super) fn mend(piece: &mut Piece, (scale, times): (&mut f64, &mut u8), texels_per_unit: f64, side: f64) -> bool {
    if !std::mem::replace(&mut piece.keeps_its_angle, true) {
        return true;
    }
    let Some(factor) = enlarged(piece.width() * texels_per_unit).filter(|_| *times < ENLARGED) else { return false };
    if longest_side(piece) * texels_per_unit * factor > side {
        return false;
    }
    *times += 1;
    *scale *= factor;
    resize(piece, factor);
    true
}

/// The longer side of the box of a chart.
fn longest_side(piece: &Piece) -> f64 {
    let points = piece.polygons.iter().flatten().flatten().map(|&p| Point2::from(p));
    bounds(points).map_or(0.0, |(low, high)| (high - low).max())
}

/// By what a chart of this width, texels, is made larger so that its triangles do not collapse by rounding: to an eighth of a
/// texel, then to a whole one, which is never less than 256 steps of a number in 32 bits.
fn enlarged(width: f64) -> Option<f64> {
    const FIRST: f64 = 0.125;
    let factor = if width < FIRST { FIRST / width } else { 1.0 / width };
    (factor > 1.0 && factor.is_finite()).then_some(factor)
}

/// The charts that are less than a texel wide, ascending.
pub(super) fn under_a_texel(pieces: &[Piece], texels_per_unit: f64) -> Vec<usize> {
    let widths: Vec<f64> = pieces.par_iter().map(|piece| piece.width() * texels_per_unit).collect();
    (0..widths.len()).filter(|&i| widths[i] < 1.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_is_made_an_eighth_of_a_texel_wide_then_a_whole_one_and_no_wider() {
        assert_eq!(enlarged(0.001), Some(125.0));
        assert_eq!(enlarged(0.125), Some(8.0));
        assert_eq!((enlarged(1.0), enlarged(3.0), enlarged(0.0)), (None, None, None));
    }

    #[test]
    fn a_chart_as_long_as_the_page_is_not_made_larger_and_others_are_twice_at_most() {
        let strip = |length: f64| Piece::new(vec![vec![[0.0, 0.0], [length, 0.0], [length, 1e-4], [0.0, 1e-4]]]);
        let (mut scale, mut times) = (1.0, 0);
        let mut long = strip(100.0);
        assert!(mend(&mut long, (&mut scale, &mut times), 1.0, 128.0) && long.keeps_its_angle);
        assert!(!mend(&mut long, (&mut scale, &mut times), 1.0, 128.0));
        assert_eq!((scale, times), (1.0, 0));
        let mut short = Piece { keeps_its_angle: true, ..strip(1e-3) };
        let results = [(); 3].map(|()| mend(&mut short, (&mut scale, &mut times), 1.0, 128.0));
        assert_eq!((results, times), ([true, true, false], 2));
        assert!((short.width() - 1.0).abs() < 1e-12 && (scale - 1e4).abs() < 1e-8, "{} {scale}", short.width());
    }

    #[test]
    fn the_width_is_that_of_the_narrowest_strip_whatever_the_angle() {
        // A needle of 5 × 0.1 along the diagonal of 3 and 4.
        let needle = vec![[0.0, 0.0], [3.0, 4.0], [2.92, 4.06], [-0.08, 0.06]];
        let mut piece = Piece::new(vec![needle]);
        assert!((piece.width() - 0.1).abs() < 1e-12, "{}", piece.width());
        assert_eq!((under_a_texel(&[piece.clone()], 9.0), under_a_texel(&[piece.clone()], 11.0)), (vec![0], vec![]));
        resize(&mut piece, 0.5);
        assert!((piece.width() - 0.05).abs() < 1e-12);
    }
}
