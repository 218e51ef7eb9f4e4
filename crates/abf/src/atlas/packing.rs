//! Boxes into squares, all at one scale.

use super::AtlasError;
use super::boxes::TightBox;
use abf_mesh::Vector2;
use guillotiere::{AtlasAllocator, size2};

/// Halvings after which boxes that do not fit never will: they are points by then.
const HALVINGS: usize = 60;
/// Bisections between a scale that fits and one that does not, half of it apart: to a thousandth.
const BISECTIONS: usize = 9;

/// The largest scale, in texels per unit, that was found to fit all boxes into the squares of their pages, and where they
/// are. With every box comes a margin on its right and above; left and below it is the caller's.
pub(super) fn pack(
    boxes: &[TightBox],
    pages: &[Vec<usize>],
    resolution: u32,
    margin: u32,
) -> Result<(f64, Vec<[u32; 2]>), AtlasError> {
    // In units of the longest side, whose square is a number.
    let unit = boxes.iter().map(|b| b.size.amax()).fold(0.0, f64::max);
    let unit = if unit > 0.0 { unit } else { 1.0 };
    let sizes: Vec<Vector2<f64>> = boxes.iter().map(|b| b.size / unit).collect();
    let (scale, texels) = pack_sizes(&sizes, pages, resolution, margin)?;
    Ok((scale / unit, texels))
}

fn pack_sizes(
    sizes: &[Vector2<f64>],
    pages: &[Vec<usize>],
    resolution: u32,
    margin: u32,
) -> Result<(f64, Vec<[u32; 2]>), AtlasError> {
    let side = resolution - margin;
    // No page holds more than its area, or what is longer than its side.
    let bound = |page: &Vec<usize>| {
        let area: f64 = page.iter().map(|&i| sizes[i].x * sizes[i].y).sum();
        let longest = page.iter().map(|&i| sizes[i].amax()).fold(0.0, f64::max);
        (f64::from(side) / area.sqrt()).min(f64::from(side - margin) / longest)
    };
    let bound = pages.iter().map(bound).fold(f64::INFINITY, f64::min);
    let bound = if bound.is_finite() && bound > 0.0 { bound } else { 1.0 };
    let at = |scale: f64| place(sizes, pages, scale, side, margin);
    // At most the widest box fills its page alone.
    if let Some(texels) = at(bound) {
        return Ok((bound, texels));
    }
    let halved = (1..=HALVINGS).map(|k| bound * 0.5_f64.powi(k as i32));
    let found = halved.into_iter().find_map(|scale| at(scale).map(|texels| (scale, texels)));
    let Some(mut best) = found else {
        let charts = pages.iter().map(Vec::len).max().unwrap_or(0);
        return Err(AtlasError::TooManyCharts { charts, margin, resolution });
    };
    let mut too_large = 2.0 * best.0;
    for _ in 0..BISECTIONS {
        let scale = f64::midpoint(best.0, too_large);
        match at(scale) {
            Some(texels) => best = (scale, texels),
            None => too_large = scale,
        }
    }
    Ok(best)
}

/// Where the boxes are at this scale, if they fit.
fn place(boxes: &[Vector2<f64>], pages: &[Vec<usize>], scale: f64, side: u32, margin: u32) -> Option<Vec<[u32; 2]>> {
    /// A box that is a hair wider than its texels is not given another one.
    const HAIR: f64 = 1e-6;
    let texels =
        |length: f64| ((length * scale - HAIR).ceil().clamp(1.0, f64::from(i32::MAX / 2)) as i32) + margin as i32;
    let mut out = vec![[0; 2]; boxes.len()];
    for page in pages {
        let sizes = page.iter().map(|&i| (texels(boxes[i].y), texels(boxes[i].x), i));
        let mut sizes: Vec<(i32, i32, usize)> = sizes.collect();
        // High ones first, then wide ones; the allocator keeps the order of its input.
        sizes.sort_unstable_by_key(|&(height, width, i)| (-height, -width, i));
        let mut free = AtlasAllocator::new(size2(side as i32, side as i32));
        for (height, width, i) in sizes {
            let corner = free.allocate(size2(width, height))?.rectangle.min;
            out[i] = [corner.x as u32, corner.y as u32];
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Point2;

    fn boxes(sizes: &[[f64; 2]]) -> Vec<TightBox> {
        let one = |&[x, y]: &[f64; 2]| TightBox { turn: [1.0, 0.0], low: Point2::origin(), size: Vector2::new(x, y) };
        sizes.iter().map(one).collect()
    }

    #[test]
    fn boxes_keep_their_distance_and_fill_most_of_the_page() {
        let sizes: Vec<[f64; 2]> = (1..40)
            .map(|i| [1.0 + f64::from(i * 7 % 11), 0.5 + f64::from(i * 5 % 7)])
            .map(|[a, b]| [a.max(b), a.min(b)])
            .collect();
        let boxes = boxes(&sizes);
        let (scale, texels) = pack(&boxes, &[(0..boxes.len()).collect()], 1024, 4).expect("they fit");
        let rectangle = |i: usize| {
            let [x, y] = texels[i].map(f64::from);
            [x, y, x + sizes[i][0] * scale, y + sizes[i][1] * scale]
        };
        for i in 0..boxes.len() {
            let a = rectangle(i);
            assert!(a[2] <= 1016.0 + 1e-6 && a[3] <= 1016.0 + 1e-6, "{a:?}");
            for b in (0..i).map(rectangle) {
                let apart = [b[0] - a[2], a[0] - b[2], b[1] - a[3], a[1] - b[3]];
                assert!(apart.iter().any(|&gap| gap >= 4.0 - 1e-6), "{a:?} {b:?}");
            }
        }
        let filled: f64 = sizes.iter().map(|[x, y]| x * y).sum::<f64>() * scale * scale / (1024.0 * 1024.0);
        assert!(filled > 0.7, "{filled}");
    }

    #[test]
    fn pages_share_a_scale_and_too_many_charts_are_refused() {
        let boxes = boxes(&[[2.0, 1.0], [1.0, 1.0]]);
        let (scale, texels) = pack(&boxes, &[vec![0], vec![1]], 100, 0).expect("they fit");
        assert!((scale - 50.0).abs() < 1e-9, "{scale}");
        assert_eq!(texels, [[0, 0], [0, 0]]);
        let error = pack(&vec![boxes[0]; 100], &[(0..100).collect()], 16, 1).unwrap_err();
        assert_eq!(error, AtlasError::TooManyCharts { charts: 100, margin: 1, resolution: 16 });
    }
}
