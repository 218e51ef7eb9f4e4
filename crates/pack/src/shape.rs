//! A piece in the numbers of the packer.

use crate::geometry::{Hull, Point, signed_area};

/// A piece around its own middle, in units of the longest piece.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    points: Vec<Point>,
    /// The end of every loop in `points`.
    loops: Vec<usize>,
    /// The end of every outline in `loops`.
    outlines: Vec<usize>,
    /// Of all outlines together.
    pub(crate) area: f64,
    pub(crate) hull: Hull,
}

impl Shape {
    pub(crate) fn new(outlines: &[Vec<Vec<Point>>], middle: Point, unit: f64) -> Self {
        let mut points = Vec::new();
        let (mut loops, mut ends) = (Vec::new(), Vec::new());
        let mut area = 0.0;
        for outline in outlines {
            let mut areas = Vec::with_capacity(outline.len());
            for ring in outline {
                let start = points.len();
                points.extend(ring.iter().map(|p| [(p[0] - middle[0]) / unit, (p[1] - middle[1]) / unit]));
                loops.push(points.len());
                areas.push(signed_area(&points[start..]).abs());
            }
            // The outer loop has the largest area, whichever comes first.
            let outer = areas.iter().copied().fold(0.0, f64::max);
            area += (2.0 * outer - areas.iter().sum::<f64>()).max(0.0);
            ends.push(loops.len());
        }
        let hull = Hull::of(&points);
        Self { points, loops, outlines: ends, area, hull }
    }

    pub(crate) fn points(&self) -> &[Point] {
        &self.points
    }

    /// The loops of every outline.
    pub(crate) fn outlines(&self) -> impl Iterator<Item = impl Iterator<Item = &[Point]>> {
        let start_of = |ends: &[usize], i: usize| if i == 0 { 0 } else { ends[i - 1] };
        (0..self.outlines.len()).map(move |i| {
            let loops = start_of(&self.outlines, i)..self.outlines[i];
            loops.map(move |j| &self.points[start_of(&self.loops, j)..self.loops[j]])
        })
    }
}
