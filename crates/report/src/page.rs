//! One HTML page about many runs on many meshes.
//!
//! The page needs nothing but itself: pictures are embedded, charts are inline SVG, and its
//! content security policy forbids every request. It is readable without its script, which only
//! makes tables sortable; it follows the reader's choice of a dark or light scheme and fits a phone.
//!
//! [`render`] makes the page at once. Where meshes are large or many, [`MeshFragment::render`]
//! turns one after the other into text, which is all that has to be kept, and [`assemble`] joins
//! what there is to a page, as often as wished.
//!
//! All text is escaped: the name of a mesh may hold anything. The same input gives the same text.

mod chart;
mod convergence;
mod embed;
mod fragment;
mod histogram;
mod html;
mod judge;
mod number;
mod pictures;
mod summary;
mod table;

use abf_mesh::{TriMesh, UvMap};

use crate::scale::ColourScale;
pub(crate) use chart::{Figure, SIZE as CHART_SIZE};
pub(crate) use fragment::figures;
use html::Html;
pub(crate) use html::escape;
pub(crate) use number::{FINE, quantile, round, round_up, significant};
use summary::{SummaryRow, summary};

/// The style of the page; it begins with the light colours, by their names.
pub(crate) const CSS: &str = include_str!("page/assets/page.css");
/// The style of what is in charts.
pub(crate) const PLOT_CSS: &str = include_str!("page/assets/plot.css");
const SCRIPT: &str = include_str!("page/assets/page.js");
/// Nothing may be loaded, whatever the page says.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      base-uri 'none'; form-action 'none'";
/// Stands for the number of a mesh until [`assemble`] knows it; [`escape`] lets no other one pass.
const MESH_NUMBER: &str = "\0";
/// Colours from which a browser blends the legend's bar.
const LEGEND_STOPS: usize = 13;

/// A whole page.
#[derive(Clone, Debug, Default)]
pub struct Page<'a> {
    /// Its title.
    pub title: &'a str,
    /// What the runs were made on: names and values.
    pub machine: Vec<(String, String)>,
    /// The meshes, in the order of the page.
    pub meshes: Vec<MeshSection<'a>>,
}

/// One mesh and everything that was run on it.
#[derive(Clone, Debug, Default)]
pub struct MeshSection<'a> {
    /// Its name.
    pub name: &'a str,
    /// The surface; without it there are no pictures, and layouts are not judged.
    pub mesh: Option<&'a TriMesh>,
    /// The runs, in the order of the table. The same order for every mesh keeps a solver's colour.
    pub runs: Vec<SolverRun<'a>>,
    /// Whether the lowest F is looked for among layouts that do not overlap themselves, and not among all that are valid.
    pub injective_only: bool,
}

/// One run of one solver.
#[derive(Clone, Debug, Default)]
pub struct SolverRun<'a> {
    /// The solver. A second run with the same name on one mesh is numbered.
    pub solver: &'a str,
    /// Its settings: names and values.
    pub settings: Vec<(String, String)>,
    /// Its layout.
    pub uv: Option<&'a UvMap>,
    /// What the table says of it: heads and cells. Runs need not have the same columns.
    pub columns: Vec<(String, Cell)>,
    /// Why there is no result, or none that counts.
    pub failure: Option<String>,
    /// How it converged: outer iteration and residual.
    pub outer: Vec<(f64, f64)>,
    /// The residual after every inner iteration, for iterative inner solvers.
    pub inner: Vec<f64>,
    /// How it converged in time: seconds and residual.
    pub timed: Vec<(f64, f64)>,
    /// How its energies fell in time, each with its name: seconds and energy. Those of one name are drawn together, and no
    /// others.
    pub energies: Vec<(String, Vec<(f64, f64)>)>,
}

/// A cell of the table of runs.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Cell {
    /// A text, sorted as such.
    Text(String),
    /// A number, sorted by its value; NaN as if it were missing.
    Number {
        /// Its value.
        value: f64,
        /// How it is shown, with its unit if the head does not name it.
        shown: String,
    },
    /// Nothing, sorted last.
    #[default]
    Missing,
}

/// The part of a page about one mesh, as text: neither the mesh nor a layout is needed any more.
#[derive(Clone, Debug)]
pub struct MeshFragment {
    html: String,
    summary: SummaryRow,
}

impl MeshFragment {
    /// Judges the layouts, draws the pictures and writes the part of the page.
    ///
    /// Never fails: where a layout cannot be drawn, its row says why.
    #[must_use]
    pub fn render(section: &MeshSection<'_>) -> Self {
        fragment::fragment(section)
    }

    /// How many bytes of a page it takes, but for its line in the summary.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.html.len()
    }
}

/// Renders a whole page at once; see [`assemble`] for doing so mesh by mesh.
///
/// ```
/// use abf_report::page::{MeshSection, Page, SolverRun, render};
///
/// let run = SolverRun { solver: "linabf", failure: Some("not a disk".to_owned()), ..SolverRun::default() };
/// let mesh = MeshSection { name: "<torus>", runs: vec![run], ..MeshSection::default() };
/// let html = render(&Page { title: "Runs", machine: Vec::new(), meshes: vec![mesh] });
/// assert!(html.starts_with("<!DOCTYPE html>") && html.contains("&lt;torus&gt;"));
/// ```
#[must_use]
pub fn render(page: &Page<'_>) -> String {
    let fragments: Vec<MeshFragment> = page.meshes.iter().map(MeshFragment::render).collect();
    assemble(page.title, &page.machine, &fragments)
}

/// Joins rendered parts to a page, in their order.
#[must_use]
pub fn assemble(title: &str, machine: &[(String, String)], meshes: &[MeshFragment]) -> String {
    let mut html = Html::default();
    html.raw(&head(title));
    html.raw("<body>\n<a class=\"skip\" href=\"#content\">Skip to the results</a>\n<header>\n");
    html.element("h1", "", title);
    html.raw(&machine_list(machine));
    html.raw("</header>\n<main id=\"content\">\n");
    html.raw(&summary(meshes.iter().map(|mesh| &mesh.summary)));
    for (number, mesh) in meshes.iter().enumerate() {
        html.raw(&mesh.html.replace(MESH_NUMBER, &(number + 1).to_string()));
    }
    html.raw("</main>\n<script>\n");
    html.raw(SCRIPT);
    html.raw("</script>\n</body>\n</html>\n");
    html.finish()
}

/// The page up to its body.
fn head(title: &str) -> String {
    let stops: Vec<String> =
        ColourScale::samples(LEGEND_STOPS).iter().map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}")).collect();
    format!(
        concat!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n",
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n",
            "<meta name=\"color-scheme\" content=\"light dark\">\n",
            "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n",
            "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n",
            "<style>\n{}{}.bar{{background:linear-gradient(90deg,{})}}\n</style>\n</head>\n",
        ),
        POLICY,
        escape(title),
        CSS,
        PLOT_CSS,
        stops.join(",")
    )
}

/// What the runs were made on.
fn machine_list(machine: &[(String, String)]) -> String {
    let mut html = Html::default();
    if !machine.is_empty() {
        html.raw("<dl class=\"machine\">\n");
        for (name, value) in machine {
            html.raw("<div>");
            html.element("dt", "", name);
            html.element("dd", "", value);
            html.raw("</div>\n");
        }
        html.raw("</dl>\n");
    }
    html.finish()
}

#[cfg(test)]
mod tests;
