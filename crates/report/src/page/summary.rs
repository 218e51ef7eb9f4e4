//! The table at the top: every mesh against every solver.

use std::borrow::Cow;

use super::html::{Html, NOTHING, escape, sort_attribute};
use super::judge::{DIGITS, Judgement, Outcome, validity};
use super::number::{grouped, significant};

/// What the summary says of one mesh.
#[derive(Clone, Debug)]
pub(crate) struct SummaryRow {
    name: String,
    triangles: Option<usize>,
    entries: Vec<Entry>,
}

/// What the summary says of one run.
#[derive(Clone, Debug)]
struct Entry {
    label: String,
    /// F, NaN where there is none.
    f: f64,
    shown: String,
    /// What is wrong, if anything is.
    remark: String,
    is_best: bool,
}

impl SummaryRow {
    /// The line of a section.
    pub(crate) fn new(judgement: &Judgement<'_>) -> Self {
        let entries = (0..judgement.outcomes.len()).map(|k| Entry::new(judgement, k)).collect();
        let triangles = judgement.section.mesh.map(abf_mesh::TriMesh::face_count);
        Self { name: judgement.section.name.to_owned(), triangles, entries }
    }
}

impl Entry {
    fn new(judgement: &Judgement<'_>, run: usize) -> Self {
        let (f, shown, remark) = match &judgement.outcomes[run] {
            Outcome::Judged(m) if m.valid() => (m.f, significant(m.f, DIGITS), String::new()),
            Outcome::Judged(m) => (m.f, significant(m.f, DIGITS), validity(m)),
            Outcome::Failed(_) => (f64::NAN, "failed".to_owned(), String::new()),
            Outcome::Unseen => (f64::NAN, "no layout".to_owned(), String::new()),
        };
        Self { label: judgement.labels[run].clone(), f, shown, remark, is_best: judgement.is_lowest(run) }
    }

    /// The cell, with a link to the row of the run.
    fn cell(&self, mesh: usize, run: usize) -> String {
        let class = if self.f.is_nan() {
            "failed number"
        } else if self.remark.is_empty() {
            "number"
        } else {
            "invalid number"
        };
        let shown = escape(&self.shown);
        let shown =
            if self.is_best { format!("<strong>{shown}</strong> <span class=\"badge\">lowest</span>") } else { shown };
        let remark =
            if self.remark.is_empty() { String::new() } else { format!(" <small>{}</small>", escape(&self.remark)) };
        let sort = sort_attribute(self.f);
        format!("<td class=\"{class}\" {sort}><a href=\"#mesh-{mesh}-run-{run}\">{shown}</a>{remark}</td>")
    }
}

/// The summary over all meshes; meshes are numbered from 1 in their order.
pub(crate) fn summary<'a>(meshes: impl Iterator<Item = &'a SummaryRow>) -> String {
    let meshes: Vec<&SummaryRow> = meshes.collect();
    let mut labels: Vec<&str> = Vec::new();
    for entry in meshes.iter().flat_map(|mesh| &mesh.entries) {
        if !labels.contains(&entry.label.as_str()) {
            labels.push(&entry.label);
        }
    }
    let mut columns = vec![(Cow::Borrowed("Mesh"), false), (Cow::Borrowed("Triangles"), true)];
    columns.extend(labels.iter().map(|label| (Cow::Borrowed(*label), true)));
    let rows: String = meshes.iter().enumerate().map(|(k, mesh)| row(mesh, k + 1, &labels)).collect();
    let mut html = Html::default();
    html.raw("<section id=\"summary\" aria-labelledby=\"summary-name\">\n<h2 id=\"summary-name\">Summary</h2>\n");
    html.raw("<p class=\"lead\">F/3nt, the mean squared angle error in rad², of every solver on every mesh: lower is better. Each figure leads to its run.</p>\n");
    html.table("F/3nt by mesh and solver", &columns, &rows);
    html.raw("</section>\n");
    html.finish()
}

fn row(mesh: &SummaryRow, number: usize, labels: &[&str]) -> String {
    let missing = format!("<td class=\"number\" data-missing>{NOTHING}</td>");
    let mut html = Html::default();
    html.raw(&format!("<tr><th scope=\"row\"><a href=\"#mesh-{number}\">{}</a></th>", escape(&mesh.name)));
    match mesh.triangles {
        Some(count) => {
            html.element("td", &format!("class=\"number\" {}", sort_attribute(count as f64)), &grouped(count));
        }
        None => html.raw(&missing),
    }
    for label in labels {
        match mesh.entries.iter().enumerate().find(|(_, entry)| entry.label == *label) {
            Some((run, entry)) => html.raw(&entry.cell(number, run + 1)),
            None => html.raw(&missing),
        }
    }
    html.raw("</tr>\n");
    html.finish()
}
