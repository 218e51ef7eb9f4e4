//! Text on a sheet: the scale bar, and the numbers of seams and charts.

use super::Sheet;
use crate::drawing::labels::Label;
use crate::drawing::seams::Mark;
use crate::drawing::{LETTERS_MM, height_at_seam};
use abf_mesh::Point2;
use std::fmt::{Display, Write};

/// The height of the strip below the layout that holds the scale bar, millimetres.
pub(super) const STRIP_MM: f64 = 10.0;

impl Sheet<'_> {
    /// Writes a bar of a round length, at most half as wide as the layout or 50 mm, with its length in millimetres.
    pub(super) fn scale_bar(&self, out: &mut String) {
        let width_mm = (self.high.x - self.low.x) * self.style.mm_per_uv;
        let length = round_length(if width_mm > 100.0 { 0.5 * width_mm } else { width_mm.min(50.0) });
        let margin = self.style.margin_mm;
        let bottom = margin + (self.high.y - self.low.y) * self.style.mm_per_uv + STRIP_MM - 1.0;
        let [left, right, low, high, text] =
            [margin, margin + length, bottom, bottom - 2.0, bottom - 3.0].map(|mm| self.number(self.in_unit(mm)));
        let data = format!("M{left} {high}L{left} {low}L{right} {low}L{right} {high}");
        self.layer(out, "scale", r##"fill="none" stroke="#000000""##, &[("bar", data)]);
        let size = self.number(self.in_unit(LETTERS_MM));
        self.in_layer(out, |out| {
            let _ = writeln!(
                out,
                "<text x=\"{left}\" y=\"{text}\" font-family=\"sans-serif\" font-size=\"{size}\" fill=\"#000000\" \
                 stroke=\"none\">{length} mm</text>"
            );
        });
    }

    /// Writes the number of every seam at all its sides, inside, with a tick at the middle.
    pub(super) fn numbers(&self, out: &mut String, marks: &[Mark]) {
        if marks.is_empty() {
            return;
        }
        let height = |mark: &Mark| height_at_seam(mark, (self.high - self.low).max(), self.style.mm_per_uv);
        let tick = |mark: &Mark| {
            let end = mark.at + mark.inward * (0.5 * height(mark));
            format!("M{}L{}", self.place(mark.at), self.place(end))
        };
        self.layer(out, "numbers", r##"fill="none" stroke="#7a4bc2""##, &[("ticks", marks.iter().map(tick).collect())]);
        self.in_layer(out, |out| {
            for mark in marks {
                let at = mark.at + mark.inward * (1.2 * height(mark));
                self.centred(out, mark.number, (at, height(mark)), "#7a4bc2");
            }
        });
    }

    /// Writes the number of every chart where there is most room for it.
    pub(super) fn chart_numbers(&self, out: &mut String, labels: &[Label]) {
        if labels.is_empty() {
            return;
        }
        self.layer(out, "charts", r##"fill="none" stroke="none""##, &[]);
        self.in_layer(out, |out| {
            labels.iter().for_each(|label| self.centred(out, label.number, (label.at, label.height), "#000000"));
        });
    }

    /// Writes a number with its middle at a place, so high in units of the UVs.
    fn centred(&self, out: &mut String, number: impl Display, (at, height): (Point2<f64>, f64), colour: &str) {
        let at = self.place(at);
        let (x, y) = at.split_once(' ').unwrap_or_default();
        let size = self.number(self.scale * height);
        let _ = writeln!(
            out,
            "<text x=\"{x}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"{size}\" text-anchor=\"middle\" \
             dominant-baseline=\"central\" fill=\"{colour}\" stroke=\"none\">{number}</text>"
        );
    }

    /// Writes more into the layer that was written last.
    fn in_layer(&self, out: &mut String, write: impl FnOnce(&mut String)) {
        const END: &str = "</g>\n";
        out.truncate(out.len() - END.len());
        write(out);
        out.push_str(END);
    }
}

/// The largest 1, 2 or 5 times a power of ten that is not above a length.
fn round_length(length: f64) -> f64 {
    let power = 10.0_f64.powi(length.max(f64::MIN_POSITIVE).log10().floor() as i32);
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|&round| round <= length).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::round_length;

    #[test]
    fn a_round_length_is_the_largest_below() {
        for (length, round) in [(314.0, 200.0), (100.0, 100.0), (0.07, 0.05), (7.0, 5.0), (1.0, 1.0)] {
            assert!((round_length(length) / round - 1.0).abs() < 1e-12, "{length}");
        }
    }
}
