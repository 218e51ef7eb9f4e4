//! Text on a sheet: the scale bar, and the numbers of seams.

use super::Sheet;
use super::seams::Mark;
use std::fmt::Write;

/// The height of the strip below the layout that holds the scale bar, millimetres.
pub(super) const STRIP_MM: f64 = 10.0;
/// The height of letters, millimetres, at most.
const LETTERS_MM: f64 = 3.0;
/// Letters are no higher than this part of the longer side of the layout.
const LETTERS: f64 = 0.02;
/// And those of a seam no higher than this part of its length.
const OF_SEAM: f64 = 0.4;

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
        let longer = (self.high - self.low).max() * self.style.mm_per_uv;
        let height = |mark: &Mark| {
            LETTERS_MM.min(LETTERS * longer).min(OF_SEAM * mark.length * self.style.mm_per_uv) / self.style.mm_per_uv
        };
        let tick = |mark: &Mark| {
            let end = mark.at + mark.inward * (0.5 * height(mark));
            format!("M{}L{}", self.place(mark.at), self.place(end))
        };
        self.layer(out, "numbers", r##"fill="none" stroke="#7a4bc2""##, &[("ticks", marks.iter().map(tick).collect())]);
        self.in_layer(out, |out| {
            for mark in marks {
                let at = self.place(mark.at + mark.inward * (1.2 * height(mark)));
                let (x, y) = at.split_once(' ').unwrap_or_default();
                let size = self.number(self.scale * height(mark));
                let _ = writeln!(
                    out,
                    "<text x=\"{x}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"{size}\" text-anchor=\"middle\" \
                     dominant-baseline=\"central\" fill=\"#7a4bc2\" stroke=\"none\">{}</text>",
                    mark.number
                );
            }
        });
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
