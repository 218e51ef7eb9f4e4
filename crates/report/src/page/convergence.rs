//! How the runs converged: residuals and energies on a logarithmic scale, one line for each run.

use std::collections::BTreeSet;

use super::chart::{Axis, Figure, Frame, Look};
use super::html::{Html, escape};
use super::judge::Judgement;
use super::number::significant;

/// Room for the names at the ends of the lines.
const LABELS: f64 = 128.0;
/// The least distance between two names.
const LINE_HEIGHT: f64 = 14.0;
/// The longest name at a line, characters; the legend has it in full.
const LONGEST_LABEL: usize = 15;
/// The most points of a line: more than are seen.
const POINTS: usize = 240;
/// About how many markers a line has.
const MARKERS: usize = 8;
/// The decades shown below the largest residual, at most.
const DECADES: i32 = 20;

/// What a chart says of itself.
struct Titles<'a> {
    /// As a part of a file's name.
    name: &'a str,
    /// Of both axes.
    x: &'a str,
    y: &'a str,
    heading: &'a str,
    /// What is drawn.
    what: &'a str,
    /// Whether there is nothing between whole numbers along x.
    is_counted: bool,
}

const OUTER: Titles<'static> = Titles {
    name: "outer",
    x: "outer iteration",
    y: "residual",
    heading: "Outer iterations",
    what: "residual",
    is_counted: true,
};
const INNER: Titles<'static> = Titles {
    name: "inner",
    x: "inner iteration",
    y: "residual",
    heading: "Inner iterations",
    what: "residual",
    is_counted: true,
};
const TIMED: Titles<'static> =
    Titles { name: "time", x: "seconds", y: "residual", heading: "Against time", what: "residual", is_counted: false };

/// The residual after every outer iteration; nothing if no run has any.
pub(crate) fn outer(judgement: &Judgement<'_>) -> Option<Figure> {
    let series = collect(judgement, |k| judgement.section.runs[k].outer.clone());
    figure(&series, judgement.section.name, &OUTER)
}

/// The residual against time; nothing if no run has any.
pub(crate) fn timed(judgement: &Judgement<'_>) -> Option<Figure> {
    let series = collect(judgement, |k| judgement.section.runs[k].timed.clone());
    figure(&series, judgement.section.name, &TIMED)
}

/// Every energy against time, those of one name together; nothing if no run has any.
pub(crate) fn energies(judgement: &Judgement<'_>) -> Vec<Figure> {
    let runs = &judgement.section.runs;
    let names: BTreeSet<&str> = runs.iter().flat_map(|run| &run.energies).map(|(name, _)| name.as_str()).collect();
    let chart = |name: &str| {
        let of_run = |k: usize| runs[k].energies.iter().find(|(other, _)| other == name);
        let series = collect(judgement, |k| of_run(k).map(|(_, curve)| curve.clone()).unwrap_or_default());
        let heading = format!("The energy {name}");
        let file = format!("energy-{}", file_part(name));
        let (x, y) = ("seconds", "energy");
        let titles = Titles { name: &file, x, y, heading: &heading, what: "energy", is_counted: false };
        figure(&series, judgement.section.name, &titles)
    };
    names.into_iter().filter_map(chart).collect()
}

/// The residual after every inner iteration; nothing if no run has any.
pub(crate) fn inner(judgement: &Judgement<'_>) -> Option<Figure> {
    let counted = |residuals: &[f64]| residuals.iter().enumerate().map(|(k, &r)| ((k + 1) as f64, r)).collect();
    let series = collect(judgement, |k| counted(&judgement.section.runs[k].inner));
    figure(&series, judgement.section.name, &INNER)
}

/// A name with nothing in it but letters, digits, points and single dashes.
fn file_part(name: &str) -> String {
    let kept = |c: char| c.is_ascii_alphanumeric() || c == '.';
    name.split(|c| !kept(c)).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("-")
}

/// The line of one run.
struct Series<'a> {
    label: &'a str,
    look: Look,
    /// Iterations and residuals, all of them finite and none negative.
    points: Vec<(f64, f64)>,
}

impl Series<'_> {
    fn last(&self) -> (f64, f64) {
        self.points[self.points.len() - 1]
    }

    /// The last value and its iteration or second, in words.
    fn in_words(&self, titles: &Titles<'_>) -> String {
        let (x, value) = self.last();
        let after = if titles.is_counted { x.to_string() } else { format!("{} s", significant(x, 3)) };
        format!("{} after {after}", significant(value, 2))
    }
}

/// The lines of all runs that have one.
fn collect<'a>(judgement: &'a Judgement<'_>, points: impl Fn(usize) -> Vec<(f64, f64)>) -> Vec<Series<'a>> {
    let usable = |k: usize| {
        let mut points = points(k);
        points.retain(|(iteration, residual)| iteration.is_finite() && residual.is_finite() && *residual >= 0.0);
        points
    };
    let all = judgement.labels.iter().enumerate();
    all.map(|(k, label)| Series { label, look: Look(k), points: usable(k) }).filter(|s| !s.points.is_empty()).collect()
}

/// The chart with its legend.
fn figure(series: &[Series<'_>], mesh: &str, titles: &Titles<'_>) -> Option<Figure> {
    if series.is_empty() {
        return None;
    }
    let along = Along::of(series, titles.is_counted);
    let frame = frame(series, along);
    let mut plot = String::new();
    let mut ends = Vec::new();
    for one in series {
        let places = thinned(one.points.iter().map(|p| place(&frame, along, p)).collect());
        ends.push(places[places.len() - 1]);
        plot.push_str(&drawn(one, &places));
    }
    plot.push_str(&names(series, &ends, &frame));
    let all: Vec<String> = series.iter().map(|s| format!("{} {}", s.label, s.in_words(titles))).collect();
    let Titles { x, y, heading, what, .. } = *titles;
    let title = if matches!(along, Along::Decades(_)) { format!("{x}, logarithmic") } else { x.to_owned() };
    let description = format!("{heading} on {mesh}, last {what} and {x}: {}.", all.join("; "));
    let about = format!("<p>{}: {what} on a logarithmic scale.</p>\n", escape(heading));
    Some(Figure {
        name: titles.name.to_owned(),
        chart: frame.chart(&plot, [&title, y], &description),
        caption: about + &legend(series, titles),
    })
}

/// What lies along x.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Along {
    Counts,
    /// Amounts from 0 on.
    Amounts,
    /// Exponents of amounts that are decades apart; smaller ones than this lie at its place.
    Decades(f64),
}

impl Along {
    fn of(series: &[Series<'_>], is_counted: bool) -> Self {
        /// The ends of the shortest and the longest line are this far apart where a linear axis would hide the short ones.
        const FAR: f64 = 20.0;
        let ends = || series.iter().map(|s| s.last().0).filter(|&end| end > 0.0);
        let (least, most) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
        let smallest = series.iter().flat_map(|s| &s.points).map(|p| p.0).filter(|&x| x > 0.0).fold(least, f64::min);
        match is_counted {
            true => Self::Counts,
            false if most > FAR * least => Self::Decades(smallest),
            false => Self::Amounts,
        }
    }

    fn value(self, x: f64) -> f64 {
        match self {
            Self::Counts | Self::Amounts => x,
            Self::Decades(smallest) => x.max(smallest).log10(),
        }
    }
}

/// Axes around all points. A residual of zero, which has no logarithm, lies on the lower end.
fn frame(series: &[Series<'_>], along: Along) -> Frame {
    let all = || series.iter().flat_map(|s| &s.points);
    let last = all().map(|p| p.0).fold(0.0, f64::max);
    let exponents = || all().filter(|p| p.1 > 0.0).map(|p| p.1.log10());
    let high = exponents().fold(f64::NEG_INFINITY, f64::max).ceil();
    let high = if high.is_finite() { high as i32 } else { 0 };
    let low = exponents().fold(f64::INFINITY, f64::min).floor();
    let low = if low.is_finite() { (low as i32).max(high - DECADES) } else { high - 1 };
    let x = match along {
        Along::Counts => Axis::counts(last),
        Along::Amounts => Axis::amounts(last),
        Along::Decades(smallest) => Axis::decades(smallest.log10().floor() as i32, last.log10().ceil() as i32),
    };
    Frame::new(x, Axis::decades(low, high), LABELS)
}

fn place(frame: &Frame, along: Along, &(x, residual): &(f64, f64)) -> [f64; 2] {
    // The logarithm of zero is −∞, which the axis keeps at its lower end.
    [frame.x.place(along.value(x)), frame.y.place(residual.log10())]
}

/// Fewer places, if there are too many: of every run of neighbours the highest and the lowest.
fn thinned(places: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    if places.len() <= POINTS {
        return places;
    }
    let chunk = places.len().div_ceil(POINTS / 2);
    let extremes = |chunk: &[[f64; 2]]| {
        let by_height = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        let (Some(high), Some(low)) = (chunk.iter().min_by(by_height), chunk.iter().max_by(by_height)) else {
            return Vec::new();
        };
        let mut two = vec![*high, *low];
        two.sort_by(|a, b| a[0].total_cmp(&b[0]));
        two
    };
    let last = places[places.len() - 1];
    places.chunks(chunk).flat_map(extremes).chain([last]).collect()
}

/// A line with its markers.
fn drawn(series: &Series<'_>, places: &[[f64; 2]]) -> String {
    let every = places.len().div_ceil(MARKERS).max(1);
    // The last place has a marker always: it may be the only one.
    let markers = places.iter().rev().step_by(every).map(|&place| series.look.marker(place));
    format!("<g class=\"{}\">{}{}</g>\n", series.look.class(), series.look.line(places), markers.collect::<String>())
}

/// The names on the right, each as near to the end of its line as the others allow.
fn names(series: &[Series<'_>], ends: &[[f64; 2]], frame: &Frame) -> String {
    let heights = spread(&ends.iter().map(|end| end[1]).collect::<Vec<_>>(), frame.vertical());
    let mut out = String::new();
    for ((one, end), y) in series.iter().zip(ends).zip(heights) {
        let x = frame.right() + 14.0;
        out.push_str(&format!(
            "<g class=\"{}\"><path class=\"leader\" d=\"M{:.1} {:.1}L{:.1} {y:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\">{}</text></g>\n",
            one.look.class(), end[0] + 5.0, end[1], x - 3.0, x, y + 4.0, escape(&shortened(one.label))
        ));
    }
    out
}

/// Heights near the wanted ones, in the same order, at least a line apart, from top to bottom if possible.
fn spread(wanted: &[f64], [top, bottom]: [f64; 2]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let mut heights = wanted.to_vec();
    let mut free = top;
    for &k in &order {
        heights[k] = heights[k].max(free);
        free = heights[k] + LINE_HEIGHT;
    }
    // What was pushed beyond the bottom pushes the others up again.
    let mut limit = bottom;
    for &k in order.iter().rev() {
        heights[k] = heights[k].min(limit);
        limit = heights[k] - LINE_HEIGHT;
    }
    heights
}

fn shortened(label: &str) -> String {
    if label.chars().count() <= LONGEST_LABEL {
        return label.to_owned();
    }
    label.chars().take(LONGEST_LABEL - 1).chain(['…']).collect()
}

/// Every line with its name and where it ended.
fn legend(series: &[Series<'_>], titles: &Titles<'_>) -> String {
    let mut html = Html::default();
    html.raw("<ul class=\"lines\">\n");
    for one in series {
        html.raw(&format!("<li>{}<span>", one.look.sample()));
        html.text(&format!("{}: {}", one.label, one.in_words(titles)));
        html.raw("</span></li>\n");
    }
    html.raw("</ul>\n");
    html.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_order_and_a_line_between_them() {
        let heights = spread(&[100.0, 98.0, 299.0, 300.0], [0.0, 300.0]);
        assert_eq!(heights, [112.0, 98.0, 286.0, 300.0]);
    }

    #[test]
    fn a_long_line_keeps_its_ends_and_its_extremes() {
        let mut places: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k), 0.0]).collect();
        places[5_001][1] = 7.0;
        let fewer = thinned(places);
        assert!(fewer.len() <= POINTS + 1);
        assert_eq!((fewer[0], fewer[fewer.len() - 1]), ([0.0, 0.0], [9_999.0, 0.0]));
        assert!(fewer.contains(&[5_001.0, 7.0]));
    }

    #[test]
    fn a_residual_of_zero_lies_on_the_lower_end() {
        let series = [Series { label: "x", look: Look(0), points: vec![(0.0, 1.0), (1.0, 1e-3), (2.0, 0.0)] }];
        let frame = frame(&series, Along::Counts);
        let [_, y] = place(&frame, Along::Counts, &(2.0, 0.0));
        assert_eq!(y, frame.vertical()[1]);
    }

    #[test]
    fn times_that_are_decades_apart_have_a_logarithmic_axis() {
        let line = |end: f64| Series { label: "x", look: Look(0), points: vec![(0.0, 1.0), (0.001, 0.5), (end, 0.1)] };
        assert_eq!(Along::of(&[line(0.01), line(0.1)], false), Along::Amounts);
        let series = [line(0.01), line(1.0)];
        let along = Along::of(&series, false);
        assert_eq!(along, Along::Decades(0.001));
        let frame = frame(&series, along);
        let x = |seconds: f64| place(&frame, along, &(seconds, 1.0))[0];
        assert!((x(0.1) - x(0.01) - (x(1.0) - x(0.1))).abs() < 1e-9 && x(0.0) == x(0.001) && x(1.0) == frame.right());
    }

    #[test]
    fn long_names_are_cut_at_characters() {
        assert_eq!(shortened("äöü"), "äöü");
        assert_eq!(shortened(&"ä".repeat(40)).chars().count(), LONGEST_LABEL);
    }
}
