//! How long an abort takes: runs solvers on a generated mesh, and aborts them at many questions.
//!
//! `cargo run --release -p abf --example abort -- 500000` prints, in seconds of processor time, what the calls of the matrix
//! library take that cannot be interrupted; then for every solver the longest waits between two questions, with the events
//! around them, and the longest way from an abort to the return.

#![allow(clippy::print_stdout, reason = "an example shows what it measured")]

use abf::mesh::{Topology, TriMesh, VertexId};
use abf::{Event, Observer, Pipeline, Solver, SurfaceHints, Unwrap, Verdict};
use abf_linalg::{
    Graph, Parts, Refinement, SparseMatrix, SymbolicCholesky, SymbolicLu, SymmetricMatrix, SymmetricPattern,
};
use abf_shapes::Shape;
use cpu_time::ProcessTime;
use std::error::Error;
use std::sync::Arc;

/// At how many questions each run is aborted.
const POINTS: usize = 6;

/// How many of the longest waits are shown.
const SHOWN: usize = 12;

/// Aborts at the question of this number, and measures the way there.
struct Clock {
    abort_at: usize,
    asked: usize,
    last: (ProcessTime, String),
    /// The longest waits, from the longest, and the events before and after each.
    longest: Vec<(f64, String, String)>,
}

impl Clock {
    fn new(abort_at: usize) -> Self {
        Self { abort_at, asked: 0, last: (ProcessTime::now(), "start".into()), longest: Vec::new() }
    }

    /// Takes the time since the last question.
    fn take(&mut self, now: String) {
        let waited = self.last.0.elapsed().as_secs_f64();
        let before = std::mem::replace(&mut self.last.1, now);
        let place = self.longest.partition_point(|(longer, ..)| *longer >= waited);
        self.longest.insert(place, (waited, before, self.last.1.clone()));
        self.longest.truncate(SHOWN);
        self.last.0 = ProcessTime::now();
    }
}

/// An event in a few words; questions without a name of their own are numbered.
fn named(event: &Event<'_>, number: usize) -> String {
    match event {
        Event::StageStarted(stage) => format!("{stage:?}"),
        Event::RungStarted(name) => format!("rung {name}"),
        Event::Iteration(record) => format!("iteration {}", record.iteration),
        Event::Inner { iteration, inner, .. } => format!("iteration {iteration}, inner {inner}"),
        _ => format!("question {number}"),
    }
}

impl Observer for Clock {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.asked += 1;
        self.take(named(&event, self.asked));
        if self.asked == self.abort_at { Verdict::Abort } else { Verdict::Continue }
    }
}

/// Runs once to the end, then aborts at some of the questions.
fn measure(name: &str, run: impl Fn(&mut Clock) -> bool) {
    let mut whole = Clock::new(usize::MAX);
    let finished = run(&mut whole);
    whole.take("end".into());
    println!("{name}: {} questions, finished {finished}; longest waits, s:", whole.asked);
    whole.longest.iter().for_each(|(waited, before, after)| println!("  {waited:.3}, {before} to {after}"));
    let mut slowest = 0.0_f64;
    for point in 1..=POINTS {
        let mut clock = Clock::new((whole.asked * point / POINTS).max(1));
        assert!(!run(&mut clock), "an aborted run has no result");
        slowest = slowest.max(clock.last.0.elapsed().as_secs_f64());
    }
    println!("{name}: {POINTS} aborts, longest way back {slowest:.3} s");
}

fn main() -> Result<(), Box<dyn Error>> {
    let triangles = std::env::args().nth(1).map_or(Ok(500_000), |size| size.parse())?;
    let mesh = Shape::BumpySheet.mesh(triangles);
    single_calls(&mesh)?;
    for name in ["linabf", "abf++", "descent"] {
        let solver: Solver = name.parse()?;
        let pipeline = Pipeline { solver, ..Pipeline::default() };
        measure(name, |clock| pipeline.run(&mesh, clock).is_ok());
    }
    let unwrap = Unwrap { cut_disks: true, ..Unwrap::default() };
    measure("unwrap", |clock| unwrap.run(&mesh, &SurfaceHints::default(), clock).is_ok());
    // Less stretch than the sheet has uncut: seams are looked for.
    let cut = Unwrap { max_stretch: 1.002, ..unwrap };
    measure("unwrap, cut", |clock| cut.run(&mesh, &SurfaceHints::default(), clock).is_ok());
    Ok(())
}

/// The calls of the matrix library, one by one: none of them can be interrupted. The systems have the patterns of those that
/// are solved; their values are those of a grid, which take the same time.
fn single_calls(mesh: &TriMesh) -> Result<(), Box<dyn Error>> {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces())?;
    let interior: Vec<VertexId> = topology.vertices().filter(|&v| topology.is_interior(v)).collect();
    let mut number = vec![u32::MAX; mesh.vertex_count()];
    interior.iter().zip(0..).for_each(|(v, i)| number[v.index()] = i);
    let edges = topology.corners().map(|c| [c.next(), c.prev()].map(|c| number[topology.vertex(c).index()]));
    let edges: Vec<(u32, u32)> = edges.filter(|ends| !ends.contains(&u32::MAX)).map(|[a, b]| (a, b)).collect();
    let graph = Graph::from_edges(interior.len(), edges.iter().copied());
    println!("calls that cannot be interrupted, s of processor time:");
    let order = timed("ordering", || graph.amd())?;
    for unknowns in [1, 2] {
        let name = |what: &str| format!("{what}, {unknowns} unknowns per vertex");
        let pattern = Arc::new(SymmetricPattern::of_blocks(&graph, &order, unknowns));
        let symbolic = timed(&name("analysis"), || SymbolicCholesky::analyse(Arc::clone(&pattern)))?;
        let mut matrix = SymmetricMatrix::<f64>::zeros(Arc::clone(&pattern));
        matrix.values.fill(-1.0);
        (0..matrix.size()).for_each(|column| matrix.values[pattern.column(column).start] = 100.0);
        if unknowns == 1 {
            let parts = Parts::default();
            timed(&name("factors in single precision"), || symbolic.factorise_single(&matrix, &parts))?;
        }
        let factors = timed(&name("factors"), || symbolic.factorise(&matrix))?;
        let mut x = vec![1.0; matrix.size()];
        timed(&name("one solve"), || factors.apply_inverse(&mut x))?;
    }
    let mut triplets: Vec<(u32, u32, f64)> = edges.iter().flat_map(|&(a, b)| [(a, b, -0.1), (b, a, -0.1)]).collect();
    triplets.extend((0..interior.len() as u32).map(|i| (i, i, 2.0)));
    let matrix = SparseMatrix::from_triplets(interior.len(), &triplets);
    let symbolic = timed("analysis for LU", || SymbolicLu::analyse(&matrix))?;
    let factors = timed("factors by LU", || symbolic.factorise(&matrix))?;
    let mut x = vec![1.0; matrix.size()];
    let once = Refinement { max_steps: 0, ..Refinement::default() };
    timed("one solve by LU", || factors.solve(&matrix, &mut x, once))?;
    Ok(())
}

/// Runs something once and prints how long it took.
fn timed<T, E>(what: &str, run: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    let start = ProcessTime::now();
    let result = run()?;
    println!("  {what}: {:.3}", start.elapsed().as_secs_f64());
    Ok(result)
}
