//! What a survey says at its end.

use super::table::of_survey;
use crate::record::Quality;
use crate::record::number;
use crate::record::surveyed::{Counts, Surveyed};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// How many of the worst are shown.
const WORST: usize = 10;

/// Counts what is done.
pub(super) fn count(rows: &[&Surveyed], meshes: usize) -> Counts {
    let count = |is: fn(&Surveyed) -> bool| rows.iter().filter(|row| is(row)).count();
    let count_of =
        |is: fn(&Quality) -> bool| rows.iter().filter(|row| row.record.quality.as_ref().is_some_and(is)).count();
    let mut refused = BTreeMap::new();
    for reason in rows.iter().filter_map(|row| row.refused) {
        *refused.entry(reason).or_default() += 1;
    }
    Counts {
        meshes,
        done: rows.len(),
        valid: count_of(|quality| quality.valid),
        injective: count_of(|quality| quality.injective),
        flipped: count_of(|quality| quality.flips > 0),
        collapsed: count_of(|quality| quality.collapsed > 0),
        wound: count_of(|quality| quality.wound > 0),
        overlapping: count_of(|quality| quality.overlaps > 0),
        not_converged: count(|row| row.refused.is_none() && !row.converged),
        refused,
    }
}

fn sentences(counts: &Counts) -> String {
    let refused: usize = counts.refused.values().sum();
    let not_valid = counts.done - counts.valid - refused;
    let done = if counts.done < counts.meshes {
        format!("{} of {}", counts.done, number::count(counts.meshes, "mesh", "meshes"))
    } else {
        number::count(counts.done, "mesh", "meshes")
    };
    let mut text = format!("{done}: {} valid, {not_valid} not valid, {refused} refused\n", counts.valid);
    text += &format!(
        "results: {} flipped, {} collapsed, {} wound, {} overlapping, {} not converged\n",
        counts.flipped, counts.collapsed, counts.wound, counts.overlapping, counts.not_converged
    );
    if refused > 0 {
        let reasons: Vec<String> = counts.refused.iter().map(|(reason, n)| format!("{n} {reason}")).collect();
        text += &format!("refused: {}\n", reasons.join(", "));
    }
    text
}

/// Every mesh in order, those without a result with the reason, the worst, and the counts.
pub(super) fn text(rows: &[&Surveyed], counts: &Counts) -> String {
    let mut parts = vec![of_survey(rows)];
    let failures: String = rows.iter().filter_map(|row| failure(row)).map(|text| format!("{text}\n")).collect();
    if !failures.is_empty() {
        parts.push(failures);
    }
    let worst = worst(rows);
    if worst.len() > 1 {
        parts.push(format!("the worst {}:\n{}", worst.len(), of_survey(&worst)));
    }
    parts.push(sentences(counts));
    parts.join("\n")
}

/// The worst results: by flips, then by what else makes them not valid, then by distortion.
fn worst<'a>(rows: &[&'a Surveyed]) -> Vec<&'a Surveyed> {
    let mut worst: Vec<&Surveyed> = rows.iter().copied().filter(|row| row.refused.is_none()).collect();
    worst.sort_by(|a, b| worse_first(a, b));
    worst.truncate(WORST);
    worst
}

fn worse_first(a: &Surveyed, b: &Surveyed) -> Ordering {
    let faults = |row: &Surveyed| row.record.quality.as_ref().map(|q| [q.flips, q.collapsed, q.wound]);
    // A figure that is missing is the worst there is.
    let figures = |row: &Surveyed| row.record.quality.as_ref().map_or([f64::INFINITY; 2], |q| [q.f, q.stretch_l2]);
    let ([fa, la], [fb, lb]) = (figures(a), figures(b));
    faults(b).cmp(&faults(a)).then(fb.total_cmp(&fa)).then(lb.total_cmp(&la))
}

/// What is wrong with it and what to try next, if there is no result.
fn failure(row: &Surveyed) -> Option<String> {
    row.record.error.as_ref().map(|error| format!("{}: {}", error.message, error.hint))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;
    use crate::record::kind::Refused;

    fn row(mesh: &str, flips: usize, f: f64) -> Surveyed {
        let square = abf_shapes::Shape::Hemisphere.mesh(100);
        let flat = abf::flatten(&square).expect("a disk");
        let quality = Quality::new(&abf_metrics::measure(&square, &flat.uv).expect("metrics"));
        let quality = Some(Quality { flips, f, valid: flips == 0, ..quality });
        let record = Record { mesh: mesh.to_owned(), quality, ..Record::default() };
        Surveyed { converged: true, ..Surveyed::new(record, None) }
    }

    fn refused(why: Refused) -> Surveyed {
        Surveyed { refused: Some(why), ..Surveyed::new(Record::default(), None) }
    }

    #[test]
    fn the_worst_come_first_by_flips_and_then_by_distortion() {
        let (a, b, c) = (row("a", 0, 0.5), row("b", 2, 0.1), row("c", 0, f64::INFINITY));
        let refused = refused(Refused::Unreadable);
        let names: Vec<&str> = worst(&[&a, &refused, &b, &c]).iter().map(|row| row.record.mesh.as_str()).collect();
        assert_eq!(names, ["b", "c", "a"]);
    }

    #[test]
    fn a_result_counts_for_everything_it_is() {
        let mut overlapping = Surveyed { converged: false, ..row("a", 1, 0.5) };
        overlapping.record.quality.as_mut().expect("judged").overlaps = 3;
        let refused = refused(Refused::NotADisk);
        let text = sentences(&count(&[&overlapping, &refused, &row("b", 0, 0.1)], 4));
        assert!(text.contains("3 of 4 meshes: 1 valid, 1 not valid, 1 refused"), "{text}");
        assert!(text.contains("1 flipped, 0 collapsed, 0 wound, 1 overlapping, 1 not converged"), "{text}");
        assert!(text.contains("refused: 1 not a disk"), "{text}");
    }
}
