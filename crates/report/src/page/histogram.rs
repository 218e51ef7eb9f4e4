//! How often which angle error occurs in the best layout.

use abf_metrics::{FaceDistortion, per_face};

use super::chart::{Axis, Figure, Frame};
use super::html::escape;
use super::judge::Judgement;
use super::number::{FINE, quantile, round, round_up, significant};

/// Bars from end to end: odd, so that one of them is around zero.
const BARS: usize = 41;
/// The axis ends above this share of the errors; the rest is counted in the last bar of its side.
const SHARE_ON_AXIS: f64 = 0.99;
/// The shortest axis, degrees: errors below are rounding.
const SHORTEST_DEG: f64 = 1e-6;
/// Room right of the plot.
const ROOM: f64 = 16.0;

/// The histogram of the errors at all corners; nothing if there is no layout.
pub(crate) fn histogram(judgement: &Judgement<'_>) -> Option<Figure> {
    let best = judgement.best?;
    let faces = per_face(judgement.section.mesh?, judgement.section.runs[best].uv?).ok()?;
    let errors: Vec<f64> = faces
        .iter()
        .filter(|face| !face.degenerate_3d)
        .flat_map(FaceDistortion::angle_errors)
        .map(f64::to_degrees)
        .collect();
    if errors.is_empty() {
        return None;
    }
    let counts = Counts::of(&errors);
    let (name, label) = (judgement.section.name, &judgement.labels[best]);
    let description = format!("Histogram of the angle errors of {label} on {name}: {}.", counts.in_words());
    let caption = format!("Angle errors of {label} at all corners: {}.", counts.in_words());
    Some(Figure {
        name: "histogram".to_owned(),
        chart: counts.chart(&description),
        caption: format!("<p>{}</p>", escape(&caption)),
    })
}

/// Errors counted into bars.
struct Counts {
    /// The axis runs from minus to plus this, degrees.
    limit: f64,
    /// The share of the corners in every bar.
    bars: Vec<f64>,
    median: f64,
    most: f64,
    largest: f64,
}

impl Counts {
    fn of(errors: &[f64]) -> Self {
        let mut sizes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
        let [median, most, largest] = [0.5, SHARE_ON_AXIS, 1.0].map(|share| quantile(&mut sizes, share));
        let limit = round_up(most.max(SHORTEST_DEG), FINE);
        let mut bars = vec![0.0; BARS];
        let one = 1.0 / errors.len() as f64;
        for error in errors {
            let place = 0.5 * (1.0 + (error / limit).clamp(-1.0, 1.0)) * BARS as f64;
            bars[(place as usize).min(BARS - 1)] += one;
        }
        Self { limit, bars, median, most, largest }
    }

    fn in_words(&self) -> String {
        let [median, most, largest] = [self.median, self.most, self.largest].map(|x| significant(x, 3));
        format!("half are below {median}°, 99 % below {most}°, the largest is {largest}°")
    }

    fn chart(&self, description: &str) -> String {
        const PERCENT: f64 = 100.0;
        let highest = self.bars.iter().copied().fold(0.0, f64::max) * PERCENT;
        let x = Axis::linear(-self.limit, self.limit, round);
        let frame = Frame::new(x, Axis::linear(0.0, highest, round), ROOM);
        let width = 2.0 * self.limit / BARS as f64;
        let [_, bottom] = frame.vertical();
        let mut plot = String::new();
        for (k, share) in self.bars.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let left = frame.x.place(-self.limit + k as f64 * width);
            let right = frame.x.place(-self.limit + (k + 1) as f64 * width);
            let top = frame.y.place(share * PERCENT);
            plot.push_str(&format!("<path class=\"bin\" d=\"M{left:.1} {bottom}V{top:.1}H{right:.1}V{bottom}Z\"/>"));
        }
        frame.chart(&plot, ["x − α°, degrees; the ends hold all beyond", "corners, %"], description)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_is_counted_once_the_large_ones_at_the_ends() {
        let mut errors = vec![0.0; 996];
        errors.extend([-50.0, 50.0, 1e9, f64::MIN_POSITIVE]);
        let counts = Counts::of(&errors);
        assert!((counts.bars.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!((counts.bars[BARS / 2] - 0.997).abs() < 1e-12);
        assert!((counts.bars[BARS - 1] - 0.002).abs() < 1e-12);
        assert_eq!(counts.largest, 1e9);
    }

    #[test]
    fn a_layout_without_error_has_one_bar() {
        let counts = Counts::of(&[0.0; 30]);
        assert_eq!(counts.bars.iter().filter(|b| **b > 0.0).count(), 1);
        assert_eq!(counts.limit, SHORTEST_DEG);
    }
}
