//! VMV04 table 1: MINRES against Uzawa, as published and in our best settings.
//!
//! One run each: as published they take thousands of inner iterations.

mod support;

use abf::{IterativeSettings, Minres, Pipeline, PreconditionerKind, Reduction, Solver, StopCriteria, Uzawa};
use abf_shapes::Shape;
use support::{Model, Table, models, once, or_dash, published, seconds};

/// More inner iterations than this are not waited for.
const MAX_INNER: usize = 20_000;

/// The paper's rows, and what stands in for them: the papers' own surfaces are not public, so shapes of
/// the same families and sizes; foot is the scanned model where there is one.
fn rows() -> Vec<(&'static str, Model)> {
    let shape =
        |shape: Shape, triangles: usize| Model { name: format!("{shape} {triangles}"), mesh: shape.mesh(triangles) };
    let mut rows = vec![
        ("ear", shape(Shape::BumpySheet, 1796)),
        ("man head", shape(Shape::Mask, 5420)),
        ("twists", shape(Shape::TwistedBand, 6000)),
        ("goldfeather 10K", shape(Shape::WavySaddle, 10_000)),
        ("goldfeather 24K", shape(Shape::WavySaddle, 24_000)),
    ];
    rows.extend(models(&["foot"]).into_iter().filter(|model| model.name == "foot").map(|model| ("foot", model)));
    rows
}

fn main() {
    let mut table = Table::new(
        "vmv_table",
        "Table 1 of Efficient Iterative Solvers for Angle Based Flattening: seconds from mesh to UVs (inner \
         iterations) on stand-ins",
        &[
            "paper's model",
            "paper MINRES s",
            "paper Uzawa s",
            "measured on",
            "MINRES as published",
            "Uzawa as published",
            "MINRES, S and blocks",
            "Uzawa, S and blocks",
        ],
    );
    for (row, Model { name, mesh }) in rows() {
        let paper = |column: &str| or_dash(published("VMV 2004", "Table 1", row, column), |s| format!("{s}"));
        let published_form = IterativeSettings {
            reduction: Reduction::None,
            preconditioner: PreconditionerKind::None,
            max_inner_iterations: MAX_INNER,
        };
        let cell = |solver: Solver| {
            let stop = StopCriteria { max_iterations: 20, ..StopCriteria::default() };
            let pipeline = Pipeline { solver, stop, ..Pipeline::default() };
            let (time, flat) = once(|| pipeline.run(&mesh, &mut abf::Silent).expect("a flattening"));
            let inner = flat.solution.as_ref().map_or(0, abf::AngleSolution::inner_iterations);
            let end = if flat.termination.is_as_asked() { String::new() } else { format!(", {}", flat.termination) };
            format!("{} ({inner}{end})", seconds(time))
        };
        table.push(vec![
            row.to_owned(),
            paper("time MINRES"),
            paper("time Uzawa"),
            name,
            cell(Minres { iterative: published_form, ..Minres::default() }.into()),
            cell(Uzawa { iterative: published_form, ..Uzawa::default() }.into()),
            cell(Minres::default().into()),
            cell(Uzawa::default().into()),
        ]);
    }
    table.finish();
}
