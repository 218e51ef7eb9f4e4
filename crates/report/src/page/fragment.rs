//! The part of the page about one mesh.

use super::chart::Figure;
use super::html::{Html, escape};
use super::judge::{DIGITS, Judgement, Outcome, in_words};
use super::number::grouped;
use super::summary::SummaryRow;
use super::table::{runs_table, settings};
use super::{MESH_NUMBER, MeshFragment, MeshSection, convergence, histogram, pictures};

/// Renders everything there is about one mesh.
pub(crate) fn fragment(section: &MeshSection<'_>) -> MeshFragment {
    let judgement = Judgement::new(section);
    let mut html = Html::default();
    html.raw(&format!("<section id=\"mesh-{MESH_NUMBER}\" aria-labelledby=\"mesh-{MESH_NUMBER}-name\">\n"));
    html.element("h2", &format!("id=\"mesh-{MESH_NUMBER}-name\""), section.name);
    html.raw(&lead(&judgement));
    html.raw(&pictures::pictures(&judgement));
    html.raw("<h3>Runs</h3>\n");
    html.raw(&runs_table(&judgement));
    html.raw(&charts(&judgement));
    html.raw(&settings(&judgement));
    html.raw("<p class=\"back\"><a href=\"#summary\">Back to the summary</a></p>\n</section>\n");
    MeshFragment { html: html.finish(), summary: SummaryRow::new(&judgement) }
}

/// The mesh and its best run in a sentence or two.
fn lead(judgement: &Judgement<'_>) -> String {
    let mut parts = Vec::new();
    if let Some(mesh) = judgement.section.mesh {
        parts.push(format!("{} triangles, {} vertices.", grouped(mesh.face_count()), grouped(mesh.vertex_count())));
    }
    parts.push(match judgement.best.and_then(|k| Some((k, judgement.metrics(k)?))) {
        Some((k, metrics)) => {
            let names = |runs: &[usize]| {
                let names = runs.iter().map(|&k| format!("<strong>{}</strong>", escape(&judgement.labels[k])));
                names.collect::<Vec<_>>().join(", ")
            };
            let kind = if judgement.section.injective_only { "injective" } else { "valid" };
            let figures = escape(&in_words(metrics));
            match judgement.lowest() {
                [] => format!("No layout is {kind}; shown is the one nearest to it: {} ({figures}).", names(&[k])),
                [one] => format!("Lowest F of the {kind} layouts: {} ({figures}).", names(&[*one])),
                several => format!(
                    "Lowest F of the {kind} layouts, the same to {DIGITS} digits: {}. Shown is {} ({figures}).",
                    names(several),
                    names(&[k])
                ),
            }
        }
        None if judgement.outcomes.iter().any(|o| matches!(o, Outcome::Unseen)) => "No layout is at hand.".to_owned(),
        None => "No run gave a layout.".to_owned(),
    });
    format!("<p class=\"lead\">{}</p>\n", parts.join(" "))
}

/// The charts of a section, in their order.
pub(crate) fn figures(section: &MeshSection<'_>) -> Vec<Figure> {
    of(&Judgement::new(section))
}

fn of(judgement: &Judgement<'_>) -> Vec<Figure> {
    let first = [convergence::outer(judgement), convergence::timed(judgement), convergence::inner(judgement)];
    let energies = convergence::energies(judgement);
    first.into_iter().flatten().chain(energies).chain(histogram::histogram(judgement)).collect()
}

/// Convergence and the histogram, side by side where there is room.
fn charts(judgement: &Judgement<'_>) -> String {
    let all: String = of(judgement).iter().map(Figure::html).collect();
    if all.is_empty() {
        return all;
    }
    format!("<h3>Convergence and angle errors</h3>\n<div class=\"figures\">\n{all}</div>\n")
}
