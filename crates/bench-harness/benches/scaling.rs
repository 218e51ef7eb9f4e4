//! How LinABF grows: seconds and bytes from 100K to 4M triangles, with the fitted exponents.

mod support;

use abf::Silent;
use abf_shapes::{Shape, loop_subdivide};
use peak_alloc::PeakAlloc;
use support::{Model, Table, Timed, fixture, models, once, seconds};

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// How often each is timed.
const RUNS: usize = 7;
/// The sizes of the round bumpy disk.
const DISKS: [usize; 5] = [100_000, 250_000, 600_000, 1_500_000, 4_000_000];
/// A model is subdivided up to this many triangles.
const LARGEST: usize = 4_200_000;

fn main() {
    let mut table = Table::new(
        "scaling",
        "LinABF, passes until 1e-8, mesh in memory to UVs: median of 7 runs and its standard deviation",
        &[
            "mesh",
            "triangles",
            "seconds",
            "± s",
            "passes",
            "inner iterations",
            "µs per triangle",
            "bytes per triangle",
            "exponent of time",
            "exponent of memory",
        ],
    );
    // The factorisations reserve scratch memory once per process, on whichever mesh comes first.
    let _ = support::linabf().run(&Shape::FatDisk.mesh(DISKS[0]), &mut Silent);
    let disks = DISKS.map(|n| Model { name: "fat-disk".to_owned(), mesh: Shape::FatDisk.mesh(n) });
    measure(&mut table, disks.into_iter());
    let model = models(&["brain-conte69_32k_lh"]).pop().unwrap_or_else(|| fixture("mask"));
    measure(
        &mut table,
        std::iter::successors(Some(model), |model| {
            let mesh = (4 * model.mesh.face_count() <= LARGEST).then(|| loop_subdivide(&model.mesh))?;
            Some(Model { name: format!("{}, subdivided", model.name.trim_end_matches(", subdivided")), mesh })
        }),
    );
    table.finish();
}

/// One row per mesh; the last one has the exponents fitted over all of them.
fn measure(table: &mut Table, meshes: impl Iterator<Item = Model>) {
    let (mut times, mut bytes) = (Vec::new(), Vec::new());
    for Model { name, mesh } in meshes {
        let before = ALLOCATOR.current_usage();
        ALLOCATOR.reset_peak_usage();
        let run = || once(|| support::linabf().run(&mesh, &mut Silent).expect("a flattening"));
        let (first, flat) = run();
        let peak = ALLOCATOR.peak_usage() - before;
        let runs = Timed::of(std::iter::once(first).chain((1..RUNS).map(|_| run().0)).collect());
        let time = runs.median;
        let (size, solution) = (mesh.face_count() as f64, flat.solution.expect("angles"));
        times.push((size.ln(), time.ln()));
        bytes.push((size.ln(), (peak as f64).ln()));
        table.push(vec![
            name,
            mesh.face_count().to_string(),
            seconds(time),
            seconds(runs.deviation),
            format!("{} ({})", solution.iterations(), solution.termination()),
            solution.inner_iterations().to_string(),
            format!("{:.1}", time / size * 1e6),
            format!("{:.0}", peak as f64 / size),
            exponent(&times),
            exponent(&bytes),
        ]);
    }
}

/// The slope of the least squares line through points of a log-log plot, from three points on.
fn exponent(points: &[(f64, f64)]) -> String {
    if points.len() < 3 {
        return "–".to_owned();
    }
    let n = points.len() as f64;
    let (mean_x, mean_y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    format!("{:.2}", covariance / variance)
}
