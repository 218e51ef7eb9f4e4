//! What every pass of LinABF `auto` asks of its linear solve, what that takes, and what exact solves of the
//! same passes would take.

mod support;

use abf::{Event, IterationRecord, LinAbf, Observer, Passes, Pipeline, Stage, Verdict};
use cpu_time::ProcessTime;
use std::num::NonZeroUsize;
use support::{Model, Table, models, or_dash, scientific, seconds};

/// The models measured.
const MODELS: [&str; 6] = ["bull", "face-libigl", "camelhead", "brain-conte69_32k_lh", "horse", "gargoyle"];
/// How often each is run: the least CPU time of every pass counts.
const RUNS: usize = 7;

fn main() {
    let mut table = Table::new(
        "passes",
        "LinABF auto to 1e-8, CPU seconds on one thread: what each pass may leave of the linearised constraints, \
         what that took, and the same passes with an exact factorisation each",
        &[
            "mesh",
            "triangles",
            "pass",
            "may leave",
            "conjugate gradients",
            "seconds",
            "residual after",
            "exact: seconds",
            "exact: residual after",
            "exact : ours",
        ],
    );
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    for model in models(&MODELS) {
        one_thread.install(|| measure(&mut table, &model));
    }
    table.finish();
}

fn measure(table: &mut Table, Model { name, mesh }: &Model) {
    let run = |passes| {
        let pipeline = Pipeline { solver: LinAbf { passes, ..LinAbf::default() }.into(), ..Pipeline::default() };
        let mut best: Vec<(IterationRecord, f64)> = Vec::new();
        for _ in 0..RUNS {
            let mut clock = Clock::default();
            pipeline.run(mesh, &mut clock).expect("a flattening");
            if best.is_empty() {
                best = clock.passes;
            } else {
                best.iter_mut().zip(clock.passes).for_each(|(best, (_, s))| best.1 = best.1.min(s));
            }
        }
        best
    };
    let ours = run(Passes::Auto);
    let exact = run(NonZeroUsize::new(ours.len()).map_or(Passes::Auto, Passes::Exactly));
    for (k, (record, s)) in ours.iter().enumerate() {
        let other = exact.get(k);
        table.push(vec![
            name.clone(),
            mesh.face_count().to_string(),
            record.iteration.to_string(),
            or_dash(record.inner_tolerance, scientific),
            record.inner_iterations.to_string(),
            seconds(*s),
            scientific(record.constraint_residual),
            or_dash(other, |(_, s)| seconds(*s)),
            or_dash(other, |(record, _)| scientific(record.constraint_residual)),
            or_dash(other, |(_, exact)| format!("{:.1}", exact / s)),
        ]);
    }
}

/// The CPU time between one pass and the next; the first begins with the solve, so it has the ordering.
#[derive(Default)]
struct Clock {
    last: Option<ProcessTime>,
    passes: Vec<(IterationRecord, f64)>,
}

impl Observer for Clock {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        match event {
            Event::StageStarted(Stage::Solve) => self.last = Some(ProcessTime::now()),
            Event::Iteration(record) => {
                let elapsed = self.last.replace(ProcessTime::now()).map_or(0.0, |t| t.elapsed().as_secs_f64());
                self.passes.push((*record, elapsed));
            }
            _ => {}
        }
        Verdict::Continue
    }
}
