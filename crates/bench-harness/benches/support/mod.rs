//! What the benches share: where meshes come from, what Criterion measured, tables.

#![allow(dead_code, reason = "every bench uses its own part of this")]
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

use abf::mesh::{TriMesh, io};
use abf::{LayoutKind, LayoutSettings, LinAbf, Metrics, Passes, Pipeline, Silent, Solver};
use criterion::Criterion;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The root of the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// A mesh to measure.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) mesh: TriMesh,
}

/// The models of these names that `$ABF_MODELS`, or else `models/`, has in `paper/` or `disks/`; what is missing is
/// said. Without any, the fixtures.
pub(crate) fn models(names: &[&str]) -> Vec<Model> {
    let folder = std::env::var_os("ABF_MODELS").map_or_else(|| root().join("models"), PathBuf::from);
    let mut found = Vec::new();
    for name in names {
        let file = |kind: &str| folder.join(kind).join(format!("{name}.obj"));
        let file = Some(file("disks")).filter(|file| file.exists()).unwrap_or_else(|| file("paper"));
        match read_disk(&file) {
            Ok(mesh) => found.push(Model { name: (*name).to_owned(), mesh }),
            Err(error) => println!("not measured: {name}: {error}"),
        }
    }
    if found.is_empty() {
        println!("no models at all (docs/models.md says how to get them): measuring the fixtures instead");
        found.extend(["obtuse", "letter-x", "mask-coarse", "mask"].map(fixture));
    }
    found
}

/// A mesh that can be flattened.
fn read_disk(file: &Path) -> Result<TriMesh, Box<dyn std::error::Error>> {
    let mesh = io::read(file)?.mesh;
    let topology = abf::mesh::Topology::build(mesh.vertex_count(), mesh.faces())?;
    topology.require_disk()?;
    mesh.check_geometry()?;
    Ok(mesh)
}

/// A committed fixture, made anew.
pub(crate) fn fixture(name: &str) -> Model {
    let fixture = abf_shapes::fixtures().into_iter().find(|f| f.name == name).expect("a fixture");
    Model { name: name.to_owned(), mesh: fixture.mesh() }
}

/// LinABF, passes until 1e-8.
pub(crate) fn linabf() -> Pipeline {
    Pipeline { solver: LinAbf::default().into(), ..Pipeline::default() }
}

/// Criterion with its results below `target/`, few samples and no long waits.
pub(crate) fn criterion() -> Criterion {
    Criterion::default()
        .output_directory(&target().join("criterion"))
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2))
        .configure_from_args()
}

/// Forgets what an earlier run measured, so that a filtered bench reports nothing stale.
pub(crate) fn forget(group: &str) {
    // Nothing there is nothing to forget.
    let _ = std::fs::remove_dir_all(target().join("criterion").join(group));
}

/// Seconds of several runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Timed {
    /// Of all runs the one in the middle.
    pub(crate) median: f64,
    /// The standard deviation; 0 of a single run.
    pub(crate) deviation: f64,
}

impl Timed {
    /// Of these runs; at least one.
    pub(crate) fn of(mut times: Vec<f64>) -> Self {
        times.sort_unstable_by(f64::total_cmp);
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        let squares: f64 = times.iter().map(|t| (t - mean).powi(2)).sum();
        let deviation = (squares / (times.len().max(2) - 1) as f64).sqrt();
        Self { median: times[times.len() / 2], deviation }
    }

    /// Both, in a cell.
    pub(crate) fn shown(self) -> String {
        format!("{} ± {}", seconds(self.median), seconds(self.deviation))
    }
}

/// What Criterion measured in this run; `None` for what the filter left out.
pub(crate) fn measured(group: &str, id: &str) -> Option<Timed> {
    let file = target().join("criterion").join(group).join(id).join("new/estimates.json");
    let estimates: Value = serde_json::from_slice(&std::fs::read(file).ok()?).ok()?;
    let seconds = |what: &str| estimates[what]["point_estimate"].as_f64().map(|nanoseconds| nanoseconds * 1e-9);
    Some(Timed { median: seconds("median")?, deviation: seconds("std_dev")? })
}

/// One pass with unweighted least squares: LinABF as its paper ran it.
pub(crate) fn one_pass() -> Pipeline {
    least_squares(LinAbf { passes: Passes::Exactly(1.try_into().expect("not zero")), ..LinAbf::default() })
}

/// A solver with the papers' layout.
pub(crate) fn least_squares(solver: impl Into<Solver>) -> Pipeline {
    let layout = LayoutSettings { kind: LayoutKind::LeastSquares, ..LayoutSettings::default() };
    Pipeline { solver: solver.into(), layout, ..Pipeline::default() }
}

pub(crate) fn judge(pipeline: &Pipeline, mesh: &TriMesh) -> (abf::Flattening, Metrics) {
    let flat = pipeline.run(mesh, &mut Silent).expect("a flattening");
    let metrics = flat.metrics(mesh).expect("metrics");
    (flat, metrics)
}

/// Seconds of one run, and its result.
pub(crate) fn once<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let started = Instant::now();
    let result = run();
    (started.elapsed().as_secs_f64(), result)
}

/// A published number; `None` where the paper has none.
pub(crate) fn published(paper: &str, table: &str, row: &str, column: &str) -> Option<f64> {
    let text =
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("data/published.json")).expect("published.json");
    let all: Vec<Value> = serde_json::from_slice(&text).expect("published.json is a list");
    let is_it = |v: &&Value| v["paper"] == paper && v["table"] == table && v["row"] == row && v["column"] == column;
    all.iter().find(is_it).and_then(|v| v["value"].as_f64())
}

/// A table that is printed and written as Markdown, JSON and HTML.
pub(crate) struct Table {
    name: &'static str,
    title: &'static str,
    head: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(name: &'static str, title: &'static str, head: &[&'static str]) -> Self {
        Self { name, title, head: head.to_vec(), rows: Vec::new() }
    }

    pub(crate) fn push(&mut self, row: Vec<String>) {
        assert_eq!(row.len(), self.head.len(), "one cell per column");
        self.rows.push(row);
    }

    /// Prints the table and writes `target/tables/NAME.{md,json,html}`.
    pub(crate) fn finish(&self) {
        let folder = target().join("tables");
        std::fs::create_dir_all(&folder).expect("a writable target folder");
        let markdown = self.markdown();
        let write = |ending: &str, text: &str| {
            let file = folder.join(format!("{}.{ending}", self.name));
            std::fs::write(&file, text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        };
        write("md", &markdown);
        write("json", &serde_json::to_string_pretty(&self.json()).expect("strings are JSON"));
        write("html", &self.html());
        println!("\nmeasured at {}", commit());
        println!("\n{markdown}\nwritten to {}/{}.{{md,json,html}}", folder.display(), self.name);
    }

    fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let head: Vec<String> = self.head.iter().map(|h| (*h).to_owned()).collect();
        let rule: Vec<String> = self.head.iter().map(|_| "---".to_owned()).collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!("{}\n\n{}{}{rows}", self.title, line(&head), line(&rule))
    }

    fn json(&self) -> Value {
        let row = |cells: &Vec<String>| -> Value {
            self.head.iter().zip(cells).map(|(h, c)| ((*h).to_owned(), cell(c))).collect()
        };
        json!({ "title": self.title, "rows": self.rows.iter().map(row).collect::<Vec<Value>>() })
    }

    fn html(&self) -> String {
        let escape = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;");
        let cells = |tag: &str, row: &[String]| -> String {
            row.iter().map(|c| format!("<{tag}>{}</{tag}>", escape(c))).collect()
        };
        let head: Vec<String> = self.head.iter().map(|h| (*h).to_owned()).collect();
        let rows: String = self.rows.iter().map(|row| format!("<tr>{}</tr>\n", cells("td", row))).collect();
        let title = escape(self.title);
        format!(
            "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\n\
             <style>:root{{color-scheme:light dark}}body{{font:16px sans-serif;margin:2em}}\
             td,th{{padding:.3em .8em;text-align:right}}td:first-child,th:first-child{{text-align:left}}</style>\n\
             <table><caption>{title}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n{rows}</tbody></table></html>\n",
            cells("th scope=\"col\"", &head).replace("</th scope=\"col\">", "</th>")
        )
    }
}

/// The commit of the working copy, and whether it has changes; unknown where there is no git.
fn commit() -> String {
    let asked =
        std::process::Command::new("git").args(["describe", "--always", "--dirty"]).current_dir(root()).output();
    let said = asked.ok().filter(|asked| asked.status.success()).map(|asked| asked.stdout);
    said.and_then(|said| String::from_utf8(said).ok())
        .map_or_else(|| "a commit that git does not tell".to_owned(), |said| format!("commit {}", said.trim()))
}

/// A number where the cell shows one, else its text.
fn cell(shown: &str) -> Value {
    shown.parse::<f64>().map_or_else(|_| json!(shown), |number| json!(number))
}

/// Four digits of a small number.
pub(crate) fn scientific(x: f64) -> String {
    format!("{x:.3e}")
}

pub(crate) fn seconds(x: f64) -> String {
    if x < 1.0 { format!("{x:.3}") } else { format!("{x:.2}") }
}

/// A number of a paper, or a dash.
pub(crate) fn or_dash<T>(value: Option<T>, show: impl Fn(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), show)
}
