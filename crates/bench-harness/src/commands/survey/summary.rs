//! What a survey says at its end.

use super::row::Row;
use super::table::of_survey;
use crate::record::number::count;
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// How many of the worst are shown.
const WORST: usize = 10;

/// How many meshes are what. A result may be several things at once: flipped, overlapping, not converged.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Counts {
    /// Meshes there are.
    meshes: usize,
    /// Meshes that are done; the others were not begun when the survey was stopped.
    done: usize,
    /// No triangle flipped or collapsed, no vertex wound around.
    pub(super) valid: usize,
    /// Valid, and without overlap.
    injective: usize,
    /// With flipped triangles.
    flipped: usize,
    /// With collapsed triangles.
    collapsed: usize,
    /// With vertices wound around twice.
    wound: usize,
    /// That overlap themselves, valid or not.
    overlapping: usize,
    /// Results, valid or not, of a solver that did not end as asked.
    not_converged: usize,
    /// Without a result, by reason.
    refused: BTreeMap<String, usize>,
}

impl Counts {
    /// Counts what is done.
    pub(super) fn of(rows: &[&Row], meshes: usize) -> Self {
        let count = |is: fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
        let mut refused = BTreeMap::new();
        for reason in rows.iter().filter_map(|row| row.refused.clone()) {
            *refused.entry(reason).or_default() += 1;
        }
        Self {
            meshes,
            done: rows.len(),
            valid: count(|row| row.valid),
            injective: count(|row| row.injective),
            flipped: count(|row| row.flips > 0),
            collapsed: count(|row| row.collapsed > 0),
            wound: count(|row| row.wound > 0),
            overlapping: count(|row| row.overlaps > 0),
            not_converged: count(|row| row.refused.is_none() && !row.converged),
            refused,
        }
    }

    fn sentences(&self) -> String {
        let refused: usize = self.refused.values().sum();
        let not_valid = self.done - self.valid - refused;
        let done = if self.done < self.meshes {
            format!("{} of {}", self.done, count(self.meshes, "mesh", "meshes"))
        } else {
            count(self.done, "mesh", "meshes")
        };
        let mut text = format!("{done}: {} valid, {not_valid} not valid, {refused} refused\n", self.valid);
        text += &format!(
            "results: {} flipped, {} collapsed, {} wound, {} overlapping, {} not converged\n",
            self.flipped, self.collapsed, self.wound, self.overlapping, self.not_converged
        );
        if refused > 0 {
            let reasons: Vec<String> = self.refused.iter().map(|(reason, n)| format!("{n} {reason}")).collect();
            text += &format!("refused: {}\n", reasons.join(", "));
        }
        text
    }
}

/// Every mesh in order, those without a result with the reason, the worst, and the counts.
pub(super) fn text(rows: &[&Row], counts: &Counts) -> String {
    let mut parts = vec![of_survey(rows)];
    let failures: String = rows.iter().filter_map(|row| row.failure()).map(|text| format!("{text}\n")).collect();
    if !failures.is_empty() {
        parts.push(failures);
    }
    let worst = worst(rows);
    if worst.len() > 1 {
        parts.push(format!("the worst {}:\n{}", worst.len(), of_survey(&worst)));
    }
    parts.push(counts.sentences());
    parts.join("\n")
}

/// The worst results: by flips, then by what else makes them not valid, then by distortion.
fn worst<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let mut worst: Vec<&Row> = rows.iter().copied().filter(|row| row.refused.is_none()).collect();
    worst.sort_by(|a, b| worse_first(a, b));
    worst.truncate(WORST);
    worst
}

fn worse_first(a: &Row, b: &Row) -> Ordering {
    let faults = |row: &Row| [row.flips, row.collapsed, row.wound];
    // JSON has no infinity: a figure that is missing is the worst there is.
    let figures = |row: &Row| [row.f, row.stretch_l2].map(|figure| figure.unwrap_or(f64::INFINITY));
    let ([fa, la], [fb, lb]) = (figures(a), figures(b));
    faults(b).cmp(&faults(a)).then(fb.total_cmp(&fa)).then(lb.total_cmp(&la))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(mesh: &str, flips: usize, f: f64) -> Row {
        Row { mesh: mesh.to_owned(), flips, f: Some(f), valid: flips == 0, converged: true, ..Row::default() }
    }

    #[test]
    fn the_worst_come_first_by_flips_and_then_by_distortion() {
        let (a, b, c) = (row("a", 0, 0.5), row("b", 2, 0.1), row("c", 0, f64::INFINITY));
        let refused = Row { refused: Some("unreadable".to_owned()), ..Row::default() };
        let names: Vec<&str> = worst(&[&a, &refused, &b, &c]).iter().map(|row| row.mesh.as_str()).collect();
        assert_eq!(names, ["b", "c", "a"]);
    }

    #[test]
    fn a_result_counts_for_everything_it_is() {
        let overlapping = Row { overlaps: 3, converged: false, ..row("a", 1, 0.5) };
        let refused = Row { refused: Some("not a disk".to_owned()), ..Row::default() };
        let text = Counts::of(&[&overlapping, &refused, &row("b", 0, 0.1)], 4).sentences();
        assert!(text.contains("3 of 4 meshes: 1 valid, 1 not valid, 1 refused"), "{text}");
        assert!(text.contains("1 flipped, 0 collapsed, 0 wound, 1 overlapping, 1 not converged"), "{text}");
        assert!(text.contains("refused: 1 not a disk"), "{text}");
    }
}
