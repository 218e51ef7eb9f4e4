//! Boxes onto pages along a skyline: the quick layout, and the one that no better layout may fall below.

use std::cmp::Reverse;

/// A box, its margin included.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    pub(crate) size: [f64; 2],
    /// Whether it may lie on its side.
    pub(crate) turns: bool,
}

/// Where a box is: its page, its lower left corner, and whether it lies on its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    pub(crate) page: usize,
    pub(crate) corner: [f64; 2],
    pub(crate) on_its_side: bool,
}

/// A level piece of the outline above which all is free.
#[derive(Clone, Copy, Debug)]
struct Step {
    x: f64,
    y: f64,
}

/// Puts boxes onto at most `pages` pages of the size `page`, or says that they do not fit.
pub(crate) fn place(boxes: &[Rectangle], page: [f64; 2], pages: usize) -> Option<Vec<Spot>> {
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    let longest = |i: &usize| boxes[*i].size[0].max(boxes[*i].size[1]);
    // Lengths are no NaN and not negative, so that their bits are in their order.
    order.sort_by_key(|i| Reverse((longest(i).to_bits(), boxes[*i].size[1].to_bits())));
    let mut skylines: Vec<Vec<Step>> = Vec::new();
    let mut out = vec![Spot { page: 0, corner: [0.0; 2], on_its_side: false }; boxes.len()];
    for i in order {
        let Rectangle { size, turns } = boxes[i];
        let spot = (0..pages).find_map(|number| {
            if number == skylines.len() {
                skylines.push(vec![Step { x: 0.0, y: 0.0 }]);
            }
            let steps = &mut skylines[number];
            let upright = lowest(steps, size, page).map(|(cost, at)| (cost, at, false));
            let aside = || lowest(steps, [size[1], size[0]], page).map(|(cost, at)| (cost, at, true));
            let both = [upright, if turns { aside() } else { None }];
            let (_, at, on_its_side) = both.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0))?;
            let size = if on_its_side { [size[1], size[0]] } else { size };
            Some(Spot { page: number, corner: put(steps, at, size), on_its_side })
        })?;
        out[i] = spot;
    }
    Some(out)
}

/// Where the top of a box is lowest, as the number of the step at its left; and that height.
fn lowest(steps: &[Step], [w, h]: [f64; 2], [width, height]: [f64; 2]) -> Option<(f64, usize)> {
    let mut best: Option<(f64, usize)> = None;
    for (i, step) in steps.iter().enumerate() {
        let end = step.x + w;
        if end > width {
            break;
        }
        let top = under(&steps[i..], end) + h;
        if top <= height && best.is_none_or(|(least, _)| top < least) {
            best = Some((top, i));
        }
    }
    best
}

/// The height of the highest of the first steps, those that begin left of `end`.
fn under(steps: &[Step], end: f64) -> f64 {
    steps.iter().take_while(|step| step.x < end).map(|step| step.y).fold(0.0, f64::max)
}

fn put(steps: &mut Vec<Step>, at: usize, [w, h]: [f64; 2]) -> [f64; 2] {
    let corner = [steps[at].x, under(&steps[at..], steps[at].x + w.max(f64::MIN_POSITIVE))];
    let end = corner[0] + w;
    let covered = steps[at..].iter().take_while(|step| step.x < end).count();
    let last = steps[at + covered.max(1) - 1].y;
    let rest = Step { x: end, y: last };
    let goes_on = steps.get(at + covered).is_none_or(|next| next.x > end);
    let new = [Step { x: corner[0], y: corner[1] + h }, rest];
    steps.splice(at..at + covered, new.into_iter().take(if goes_on { 2 } else { 1 }));
    corner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_lie_beside_each_other_and_fill_most_of_the_page() {
        let boxes: Vec<Rectangle> = (1..200)
            .map(|i| [1.0 + f64::from(i * 7 % 11), 0.5 + f64::from(i * 5 % 7)])
            .map(|size| Rectangle { size, turns: true })
            .collect();
        let area: f64 = boxes.iter().map(|b| b.size[0] * b.size[1]).sum();
        let side = (area / 0.85).sqrt();
        let spots = place(&boxes, [side, side], 1).expect("they fit");
        let rectangle = |i: usize| {
            let ([x, y], [w, h]) = (spots[i].corner, boxes[i].size);
            let [w, h] = if spots[i].on_its_side { [h, w] } else { [w, h] };
            [x, y, x + w, y + h]
        };
        for i in 0..boxes.len() {
            let a = rectangle(i);
            assert!(a[2] <= side && a[3] <= side, "{a:?}");
            for b in (0..i).map(rectangle) {
                let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
                assert!(apart, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn boxes_that_fill_one_page_go_on_on_the_next() {
        let boxes = vec![Rectangle { size: [1.0, 1.0], turns: false }; 9];
        let spots = place(&boxes, [2.0, 2.0], 3).expect("they fit");
        assert_eq!(spots.iter().map(|spot| spot.page).collect::<Vec<_>>(), [0, 0, 0, 0, 1, 1, 1, 1, 2]);
        assert_eq!(place(&boxes, [2.0, 2.0], 2), None);
    }
}
