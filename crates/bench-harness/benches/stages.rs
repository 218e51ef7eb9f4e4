//! Each stage of a flattening alone, on the default fixture.

mod support;

use abf::constraints::AngleProblem;
use abf::mesh::{Topology, io};
use abf::reconstruct::layout;
use abf::{GuessSettings, LayoutKind, LayoutSettings, Silent};
use std::hint::black_box;
use support::{fixture, forget};

const GROUP: &str = "stages";

fn main() {
    forget(GROUP);
    let mut criterion = support::criterion();
    let mesh = fixture(abf_shapes::DEFAULT_FIXTURE).mesh;
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
    let pipeline = support::linabf();
    let flat = pipeline.run(&mesh, &mut Silent).expect("a flattening");
    let angles = flat.solution.expect("angles");
    let mut obj = Vec::new();
    io::write_obj(&mut obj, &mesh, Some(&flat.uv)).expect("memory is writable");

    let mut group = criterion.benchmark_group(GROUP);
    group.bench_function("read OBJ", |b| b.iter(|| io::parse(io::MeshFormat::Obj, "mask.obj", black_box(&obj))));
    group.bench_function("topology", |b| b.iter(|| Topology::build(mesh.vertex_count(), black_box(mesh.faces()))));
    group.bench_function("angles and targets", |b| {
        b.iter(|| AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()));
    });
    group.bench_function("solve, passes until 1e-8", |b| {
        let solver = pipeline.solver.angle_solver().expect("solves for angles");
        b.iter(|| solver.solve(&problem, &pipeline.stop, &mut Silent));
    });
    group.bench_function("solve, one pass", |b| {
        let one_pass = support::one_pass();
        let solver = one_pass.solver.angle_solver().expect("solves for angles");
        b.iter(|| solver.solve(&problem, &pipeline.stop, &mut Silent));
    });
    for kind in [LayoutKind::Tree, LayoutKind::LeastSquares, LayoutKind::Poisson] {
        let settings = LayoutSettings { kind, ..LayoutSettings::default() };
        let lay_out = || layout(&mesh, &topology, angles.angles(), &settings);
        group.bench_function(format!("layout, {kind}"), |b| b.iter(lay_out));
    }
    group.bench_function("metrics", |b| b.iter(|| abf::metrics::measure(&mesh, &flat.uv)));
    group.bench_function("write OBJ", |b| {
        b.iter(|| io::write_obj(&mut Vec::with_capacity(obj.len()), &mesh, Some(&flat.uv)));
    });
    group.finish();
}
