//! What every chart is made of: a frame, two axes, and how a series looks.

use super::html::escape;
use super::number::{COARSE, power_of_ten, round, round_up};

/// Width and height of every chart, in its own units; text of 13 units stays readable on a phone.
pub(crate) const SIZE: [f64; 2] = [520.0, 320.0];
/// Left, right, top and bottom of the plot.
const LEFT: f64 = 52.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = SIZE[1] - 44.0;
/// The most marks on an axis, about.
const TICKS: f64 = 6.0;
/// How many colours the style sheet has for series.
const COLOURS: usize = 8;
/// Dashes of the lines; none of them means a solid line. Five, so that together with eight colours
/// and seven markers no two of the first 280 series look the same, with or without colour.
const DASHES: [&str; 5] = ["", "7 3", "2 3", "10 3 2 3", "14 4"];
/// Markers, as paths around the origin.
const MARKERS: [&str; 7] = [
    "M-3.5 0A3.5 3.5 0 1 0 3.5 0A3.5 3.5 0 1 0-3.5 0Z",
    "M-3.2-3.2H3.2V3.2H-3.2Z",
    "M0-4.2L4 3.2H-4Z",
    "M0-4.6L4.6 0L0 4.6L-4.6 0Z",
    "M0 4.2L4-3.2H-4Z",
    "M-1.3-4H1.3V-1.3H4V1.3H1.3V4H-1.3V1.3H-4V-1.3H-1.3Z",
    "M-4.2 1.6V-1.6H4.2V1.6Z",
];

/// A chart with what is said of it.
pub(crate) struct Figure {
    /// What it shows, as a part of a file's name.
    pub(crate) name: String,
    /// The chart.
    pub(crate) chart: String,
    /// What stands below it, as markup.
    pub(crate) caption: String,
}

impl Figure {
    /// As it is on a page.
    pub(crate) fn html(&self) -> String {
        format!("<figure>{}<figcaption>{}</figcaption></figure>\n", self.chart, self.caption)
    }
}

/// How a series looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Look(pub(crate) usize);

impl Look {
    /// The class that gives the colour.
    pub(crate) fn class(self) -> String {
        format!("s{}", self.0 % COLOURS)
    }

    /// A line through places of the chart.
    pub(crate) fn line(self, places: &[[f64; 2]]) -> String {
        let points: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let dash = DASHES[self.0 % DASHES.len()];
        let dash = if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") };
        format!("<polyline class=\"line\" points=\"{}\"{dash}/>", points.join(" "))
    }

    /// A marker at a place of the chart.
    pub(crate) fn marker(self, [x, y]: [f64; 2]) -> String {
        format!(
            "<path class=\"mark\" transform=\"translate({x:.1} {y:.1})\" d=\"{}\"/>",
            MARKERS[self.0 % MARKERS.len()]
        )
    }

    /// The sample in a legend.
    pub(crate) fn sample(self) -> String {
        let (line, marker) = (self.line(&[[1.0, 6.0], [35.0, 6.0]]), self.marker([18.0, 6.0]));
        format!(
            "<svg class=\"sample {}\" width=\"36\" height=\"12\" viewBox=\"0 0 36 12\" aria-hidden=\"true\">{line}{marker}</svg>",
            self.class()
        )
    }
}

/// One axis: from values to places.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis from `low` to `high` with round marks.
    pub(crate) fn linear(low: f64, high: f64, label: impl Fn(f64) -> String) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        let step = round_up((high - low) / TICKS, COARSE);
        let (first, last) = ((low / step).ceil() as i64, (high / step + 1e-9).floor() as i64);
        let ticks = (first..=last).map(|k| k as f64 * step).map(|x| (x, label(x))).collect();
        Self { low, high, from: 0.0, to: 1.0, ticks }
    }

    /// An axis of counts: no marks between whole numbers.
    pub(crate) fn counts(high: f64) -> Self {
        let mut axis = Self::linear(0.0, high.max(1.0), round);
        axis.ticks.retain(|(x, _)| (x - x.round()).abs() < 1e-9);
        axis
    }

    /// An axis of amounts from 0 up, however small they are.
    pub(crate) fn amounts(high: f64) -> Self {
        let high = if high > 0.0 { high } else { 1.0 };
        Self::linear(0.0, high, round)
    }

    /// An axis of exponents of ten.
    pub(crate) fn decades(low: i32, high: i32) -> Self {
        let high = high.max(low + 1);
        let step = (f64::from(high - low) / TICKS).ceil() as i32;
        let ticks = (low..=high).filter(|k| (high - k) % step == 0).map(|k| (f64::from(k), power_of_ten(k))).collect();
        Self { low: f64::from(low), high: f64::from(high), from: 0.0, to: 1.0, ticks }
    }

    /// The place of a value, kept within the plot.
    pub(crate) fn place(&self, value: f64) -> f64 {
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        self.from + share * (self.to - self.from)
    }
}

/// A plot with its axes.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    /// Values to the right.
    pub(crate) x: Axis,
    /// Values upwards.
    pub(crate) y: Axis,
    right: f64,
}

impl Frame {
    /// A frame that leaves so much room on its right for labels.
    pub(crate) fn new(mut x: Axis, mut y: Axis, room: f64) -> Self {
        let right = SIZE[0] - room;
        (x.from, x.to) = (LEFT, right);
        (y.from, y.to) = (BOTTOM, TOP);
        Self { x, y, right }
    }

    /// Where the plot ends on the right.
    pub(crate) fn right(&self) -> f64 {
        self.right
    }

    /// Top and bottom of the plot.
    pub(crate) fn vertical(&self) -> [f64; 2] {
        [TOP, BOTTOM]
    }

    /// The chart: `plot` is markup; `description` is read out in its place.
    pub(crate) fn chart(&self, plot: &str, [x_title, y_title]: [&str; 2], description: &str) -> String {
        let [width, height] = SIZE;
        let middle = [0.5 * (LEFT + self.right), 0.5 * (TOP + BOTTOM)];
        format!(
            concat!(
                "<svg class=\"chart\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n{}{}\n",
                "<text class=\"title\" x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                "<text class=\"title\" transform=\"translate(12 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n</svg>\n"
            ),
            width,
            height,
            escape(description),
            self.grid(),
            plot,
            middle[0],
            height - 6.0,
            escape(x_title),
            middle[1],
            escape(y_title)
        )
    }

    /// Lines and labels of the marks.
    fn grid(&self) -> String {
        let mut out = String::new();
        for (value, label) in &self.y.ticks {
            let y = self.y.place(*value);
            out.push_str(&format!("<path class=\"grid\" d=\"M{LEFT} {y:.1}H{:.1}\"/>", self.right));
            out.push_str(&format!(
                "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>\n",
                LEFT - 6.0,
                y + 4.0
            ));
        }
        for (value, label) in &self.x.ticks {
            let x = self.x.place(*value);
            out.push_str(&format!("<path class=\"tick\" d=\"M{x:.1} {BOTTOM}v5\"/>"));
            out.push_str(&format!(
                "<text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>\n",
                BOTTOM + 18.0
            ));
        }
        out.push_str(&format!("<path class=\"axis\" d=\"M{LEFT} {TOP}V{BOTTOM}H{:.1}\"/>\n", self.right));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn marks_are_round_and_few() {
        assert_eq!(labels(&Axis::linear(-5.0, 5.0, round)), ["−4", "−2", "0", "2", "4"]);
        assert_eq!(labels(&Axis::counts(3.0)), ["0", "1", "2", "3"]);
        assert_eq!(labels(&Axis::counts(0.0)), ["0", "1"]);
        assert_eq!(labels(&Axis::decades(-13, 2)), ["10⁻¹³", "10⁻¹⁰", "10⁻⁷", "10⁻⁴", "10⁻¹", "10²"]);
    }

    #[test]
    fn places_run_from_end_to_end_and_stay_within() {
        let frame = Frame::new(Axis::counts(10.0), Axis::decades(-4, 0), 100.0);
        assert_eq!([0.0, 10.0, 99.0].map(|x| frame.x.place(x)), [LEFT, frame.right(), frame.right()]);
        assert_eq!([-4.0, 0.0].map(|y| frame.y.place(y)), [BOTTOM, TOP]);
    }

    #[test]
    fn the_first_series_differ_in_dash_or_marker_without_colour() {
        let looks: std::collections::BTreeSet<String> =
            (0..35).map(|k| Look(k).line(&[[0.0; 2]]) + &Look(k).marker([0.0; 2])).collect();
        assert_eq!(looks.len(), 35);
    }
}
