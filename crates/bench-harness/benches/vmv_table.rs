//! VMV04 table 1: MINRES against Uzawa, as published and in our best settings, to equal true residuals.

mod support;

use abf::{
    AngleSolution, Flattening, InnerTolerance, IterativeSettings, Minres, NewtonSettings, Pipeline, PreconditionerKind,
    Reduction, Solver, StopCriteria, Uzawa,
};
use abf_shapes::Shape;
use support::{Model, Table, Timed, models, once, or_dash, published};

/// More inner iterations than this are not waited for.
const MAX_INNER: usize = 60_000;
/// Every linear system is solved to this relative residual `‖b − Ax‖/‖b‖`, computed and not estimated.
const RESIDUAL: f64 = 1e-8;
/// How often each is timed.
const RUNS: usize = 7;

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
        "Table 1 of Efficient Iterative Solvers for Angle Based Flattening, on stand-ins of the same families and sizes: \
         seconds from mesh to UVs, the median of 7 runs and its standard deviation, and inner iterations / Newton \
         iterations, every linear system to a true relative residual of 1e-8. As published: on the whole of M, \
         without a preconditioner. S: triangles eliminated, with block factors as preconditioner",
        &[
            "paper's model",
            "paper's triangles",
            "paper MINRES s",
            "paper Uzawa s",
            "measured on",
            "triangles",
            "MINRES as published, s",
            "iterations",
            "Uzawa as published, s",
            "iterations",
            "MINRES on S, s",
            "iterations",
            "Uzawa on S, s",
            "iterations",
            "largest true residual",
        ],
    );
    for (row, Model { name, mesh }) in rows() {
        let paper = |column: &str| or_dash(published("VMV 2004", "Table 1", row, column), |s| format!("{s}"));
        let mut cells = vec![
            row.to_owned(),
            paper("triangles"),
            paper("time MINRES"),
            paper("time Uzawa"),
            name,
            mesh.face_count().to_string(),
        ];
        let mut largest = 0.0_f64;
        for solver in solvers() {
            let stop = StopCriteria { max_iterations: 20, ..StopCriteria::default() };
            let pipeline = Pipeline { solver, stop, ..Pipeline::default() };
            let runs: Vec<(f64, Flattening)> =
                (0..RUNS).map(|_| once(|| pipeline.run(&mesh, &mut abf::Silent).expect("a flattening"))).collect();
            cells.push(Timed::of(runs.iter().map(|(time, _)| *time).collect()).shown());
            let flat = &runs[0].1;
            let steps = flat.solution.as_ref().map_or(&[][..], AngleSolution::history);
            largest = steps.iter().map(|step| step.inner_residual).fold(largest, f64::max);
            let end = if flat.termination.is_as_asked() { String::new() } else { format!(", {}", flat.termination) };
            let inner: usize = steps.iter().map(|step| step.inner_iterations).sum();
            cells.push(format!("{inner} / {}{end}", steps.len()));
        }
        cells.push(format!("{largest:.1e}"));
        table.push(cells);
    }
    table.finish();
}

/// Both methods as published, then both on the reduced system.
fn solvers() -> [Solver; 4] {
    let as_published = IterativeSettings {
        reduction: Reduction::None,
        preconditioner: PreconditionerKind::None,
        max_inner_iterations: MAX_INNER,
    };
    let exactly =
        |newton: NewtonSettings| NewtonSettings { inner_tolerance: InnerTolerance::Fixed(RESIDUAL), ..newton };
    let minres = Minres { newton: exactly(Minres::default().newton), ..Minres::default() };
    let uzawa = Uzawa { newton: exactly(Uzawa::default().newton), ..Uzawa::default() };
    [
        Minres { iterative: as_published, ..minres }.into(),
        Uzawa { iterative: as_published, ..uzawa }.into(),
        minres.into(),
        uzawa.into(),
    ]
}
