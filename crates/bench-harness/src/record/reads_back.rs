//! Everything that is written reads back as it was.

use super::atlas::{Atlas, ChartSettings, Charted, Narrow};
use super::change::Change;
use super::failure::Failure;
use super::head::Head;
use super::history::{Ended, Histories, History, Trace};
use super::json::{Document, SCHEMA, pretty};
use super::kind::{FailureKind, NotRunKind, Refused};
use super::location::Location;
use super::made_injective::MadeInjective;
use super::not_run::NotRun;
use super::pins::{PinDistance, Pinned};
use super::quality::Quality;
use super::repacked::Repacked;
use super::result::Record;
use super::run::{BoundaryMet, Hierarchy, Limits, Relaxed, RunRecord, RungRecord, Solved};
use super::settings::Asked;
use super::size::{Kkt, Size};
use super::surveyed::{About, Counts, FileState, LogHead, MadeWith, SurveyDocument, Surveyed};
use super::times::{Repeats, Stages, Timings};
use abf::constraints::AngleProblem;
use abf::hierarchy::LevelReport;
use abf::solve_core::SolveError;
use abf::{
    AngleSolution, AngleSolver, Energy, Injective, IterationRecord, LayoutKind, Observer, Pipeline, Precision, Silent,
    Solver, SolverKind, StopCriteria, SurfaceHints, Termination, Unwrap, flatten,
};
use proptest::prelude::*;
use proptest::test_runner::TestRng;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fmt::Debug;
use std::time::Duration;

/// A solver of someone's own: it takes the target angles as they are.
struct Own;

impl AngleSolver for Own {
    fn name(&self) -> &'static str {
        "someone's own"
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        _: &StopCriteria,
        _: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        Ok(AngleSolution::measure(problem, problem.target().to_vec(), Termination::OnePass, Vec::new()))
    }
}

/// What a record may be made of.
struct Dice(TestRng);

impl Dice {
    fn count(&mut self) -> usize {
        let bits = self.0.next_u32() % 33;
        (self.0.next_u64() >> (63 - bits)) as usize
    }

    fn yes(&mut self) -> bool {
        self.0.next_u32().is_multiple_of(2)
    }

    /// Any finite number.
    fn number(&mut self) -> f64 {
        let any = f64::from_bits(self.0.next_u64());
        if any.is_finite() { any } else { 0.1 }
    }

    /// Any number, infinity included.
    fn figure(&mut self) -> f64 {
        if self.0.next_u32().is_multiple_of(8) { f64::INFINITY } else { self.number() }
    }

    fn text(&mut self) -> String {
        const LETTERS: [char; 10] = ['a', 'Z', '"', '\\', '/', '\n', ' ', 'π', '\u{1F600}', '\u{7}'];
        (0..self.0.next_u32() % 6).map(|_| self.one_of(&LETTERS)).collect()
    }

    fn one_of<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.0.next_u32() as usize % all.len()].clone()
    }

    fn maybe<T>(&mut self, one: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.yes().then(|| one(self))
    }

    fn some<T>(&mut self, mut one: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..self.0.next_u32() % 4).map(|_| one(self)).collect()
    }

    fn termination(&mut self) -> Termination {
        use Termination::{Cancelled, Converged, MaxIterations, OnePass, Stalled, TimeLimit};
        self.one_of(&[Converged, OnePass, MaxIterations, TimeLimit, Stalled, Cancelled])
    }

    /// The name of a solver of ours, or of someone's own.
    fn solver(&mut self) -> String {
        if self.0.next_u32().is_multiple_of(4) { self.text() } else { self.one_of(&SolverKind::ALL).to_string() }
    }

    fn size(&mut self) -> Size {
        Size {
            triangles: self.count(),
            vertices: self.count(),
            interior_vertices: self.maybe(Self::count),
            boundary_loops: self.maybe(Self::count),
        }
    }

    /// The settings of a solver of ours, or of someone's own.
    fn asked(&mut self) -> Asked {
        let ours = Solver::all();
        let solver = if self.yes() { Solver::custom(Own) } else { self.one_of(&ours) };
        let mut pipeline = Pipeline { solver, normalize: self.yes(), ..Pipeline::default() };
        pipeline.layout.kind = self.one_of(&LayoutKind::ALL);
        pipeline.initial_guess.ring_switch = self.maybe(Self::number);
        pipeline.stop.tolerance = self.number();
        pipeline.stop.time_limit = self.maybe(|dice| Duration::from_nanos(dice.0.next_u64()));
        pipeline.max_memory = self.maybe(|dice| dice.0.next_u64());
        let mut asked = Asked::new(&pipeline);
        asked.threads = self.count();
        asked
    }

    fn rung(&mut self) -> RungRecord {
        RungRecord {
            solver: self.solver(),
            termination: self.maybe(Self::termination),
            iterations: self.count(),
            valid: self.yes(),
            flips: self.count(),
            collapsed: self.count(),
            wound: self.count(),
            f: self.maybe(Self::number),
            time_s: self.maybe(Self::number),
            error: self.maybe(Self::text),
        }
    }

    fn level(&mut self) -> LevelReport {
        let mut level = LevelReport::default();
        (level.triangles, level.inserted, level.moved) = (self.count(), self.count(), self.count());
        level
    }

    fn run(&mut self) -> RunRecord {
        RunRecord { settings: self.asked(), solved: self.solved() }
    }

    fn solved(&mut self) -> Solved {
        Solved {
            solved_by: self.solver(),
            rungs: self.some(Self::rung),
            termination: self.termination(),
            constraint_residual: self.maybe(Self::number),
            angles_out_of_range: self.maybe(Self::count),
            energy: self.maybe(Self::number),
            iterations: self.count(),
            inner_iterations: self.count(),
            inner_residual: self.maybe(Self::number),
            inner_residual_worst: self.maybe(Self::number),
            inner_estimate: self.maybe(Self::number),
            inner_unconverged: self.count(),
            negative_curvature: self.maybe(Self::count),
            fallbacks: self.maybe(Self::count),
            clamped_angles: self.count(),
            switched_rings: self.count(),
            shapeless_faces: self.count(),
            layout: self.maybe(|dice| dice.one_of(&LayoutKind::ALL)),
            closing_error: self.maybe(Self::number),
            pinned: self.yes(),
            scaled: self.yes(),
            precision_limits: self.maybe(|dice| Limits {
                near_collapsed: dice.count(),
                near_collapsed_faces: dice.some(Self::count),
                held_faces: dice.count(),
                first_held_faces: dice.some(Self::count),
                spread: dice.figure(),
            }),
            boundary: self.maybe(|dice| BoundaryMet {
                rounds: dice.count(),
                corners: dice.maybe(|dice| [0; 4].map(|_: u32| dice.count() as u32)),
                sides: dice.maybe(|dice| [0; 4].map(|_: u32| dice.number())),
                violation: dice.figure(),
                largest_angle: dice.figure(),
                radius_spread: dice.maybe(Self::number),
                injective_by_convexity: dice.yes(),
            }),
            hierarchy: self
                .maybe(|dice| Hierarchy { levels: dice.some(Self::level), fallback: dice.maybe(Self::text) }),
            made_injective: self.maybe(|dice| MadeInjective {
                rule: dice.one_of(&[Injective::Split, Injective::Deform]),
                overlaps: dice.count(),
                energy: dice.maybe(|dice| dice.one_of(&[Energy::Abf, Energy::USABLE])),
                before: dice.maybe(Self::number),
                after: dice.maybe(Self::number),
                steps: dice.count(),
                first_steps: dice.count(),
                gap: dice.maybe(Self::number),
                parts: dice.count(),
                error: dice.maybe(Self::text),
            }),
            pins: self.maybe(|dice| Pinned {
                energy: dice.one_of(&[Energy::Isometric, Energy::USABLE]),
                after: dice.figure(),
                steps: dice.count(),
                missed: dice.count(),
                residuals: dice.some(|dice| PinDistance {
                    vertex: dice.count() as u32,
                    hard: dice.yes(),
                    distance: dice.figure(),
                }),
            }),
            relaxed: self.maybe(|dice| Relaxed {
                energy: dice.one_of(&[Energy::Abf, Energy::Isometric, Energy::USABLE, Energy::Slider(0.3)]),
                before: dice.figure(),
                after: dice.figure(),
                steps: dice.count(),
                progressive_steps: dice.count(),
                from_tutte: dice.yes(),
            }),
        }
    }

    fn chart(&mut self) -> Charted {
        Charted {
            component: self.count(),
            page: self.count(),
            triangles: self.count(),
            solved: self.solved(),
            valid: self.yes(),
            injective: self.yes(),
            f: self.figure(),
            stretch_l2: self.figure(),
            scale: self.number(),
            unfinished: self.yes(),
            seam_length: self.figure(),
            rounds: self.count(),
            holes_filled: self.count(),
            layout_error: self.maybe(Self::number),
            timings_s: self.maybe(Self::stages),
        }
    }

    fn atlas(&mut self) -> Atlas {
        let unwrap = Unwrap { max_seam: self.maybe(Self::number), ..Unwrap::default() };
        let packing = abf::Atlas { texels_per_unit: self.maybe(Self::number), ..abf::Atlas::default() };
        Atlas {
            settings: ChartSettings::new(&unwrap, &packing),
            charts: self.some(Self::chart),
            pages: self.count(),
            page: self.maybe(|_| [1024, 512]),
            narrow: self.narrow(),
            under_a_texel: self.count(),
            margin: self.maybe(|_| 2),
            texels_per_unit: self.maybe(Self::number),
            sheet: self.maybe(|values| [values.number(), values.number()]),
            coverage: self.figure(),
            seam_edges: self.count(),
            seam_length: self.figure(),
            diagonal: self.figure(),
            max_stretch: self.number(),
            is_bound: self.yes(),
            may_overlap: self.yes(),
            repairs: self.some(Self::text),
        }
    }

    fn narrow(&mut self) -> Narrow {
        Narrow { places: self.count(), charts: self.count(), least: self.maybe(Self::number) }
    }

    fn repacked(&mut self) -> Repacked {
        Repacked {
            islands: self.count(),
            overlapping: self.count(),
            stacked: self.count(),
            pieces: self.count(),
            pages: self.count(),
            page: [64, 2048],
            margin: 3,
            texels_per_unit: self.figure(),
            coverage: self.figure(),
            narrow: self.narrow(),
            page_of_island: self.some(Self::count),
        }
    }

    /// Every count and figure by the kind of its value, so that a new one is rolled, too.
    fn quality(&mut self) -> Quality {
        let Ok(Value::Object(mut fields)) = serde_json::to_value(Quality::default()) else { panic!("no object") };
        for value in fields.values_mut() {
            match value {
                Value::Bool(yes) => *yes = self.yes(),
                Value::Number(count) if count.is_u64() => *value = self.count().into(),
                // A figure that is infinite is `null`.
                Value::Number(_) => *value = self.figure().into(),
                _ => {}
            }
        }
        Quality {
            flipped_faces: self.some(Self::count),
            collapsed_faces: self.some(Self::count),
            wound_vertices: self.some(Self::count),
            overlapping_faces: self.some(|dice| [dice.count(), dice.count()]),
            uv_precision: self.one_of(&[Precision::Single, Precision::Double]),
            ..serde_json::from_value(Value::Object(fields)).expect("the same fields")
        }
    }

    fn stages(&mut self) -> Stages {
        Stages {
            topology: self.number(),
            solve: self.number(),
            layout: self.number(),
            relax: self.maybe(Self::number),
            flatten: self.number(),
            flatten_cpu: self.maybe(Self::number),
        }
    }

    fn timings(&mut self) -> Timings {
        Timings {
            read: self.number(),
            stages: self.stages(),
            charts: self.number(),
            atlas: self.number(),
            certificate: self.number(),
            metrics: self.number(),
            write: self.number(),
            total: self.number(),
        }
    }

    fn failure(&mut self) -> Failure {
        use FailureKind::{BadNumber, Cancelled, Closed, Internal, NonManifoldEdge, UvNotFinite};
        Failure {
            kind: self.one_of(&[BadNumber, Cancelled, Closed, Internal, NonManifoldEdge, UvNotFinite]),
            message: self.text(),
            hint: self.text(),
            at: self.maybe(|dice| {
                Box::new(Location {
                    line: dice.maybe(Self::count),
                    byte: dice.maybe(Self::count),
                    path: dice.maybe(Self::text),
                    faces: dice.some(Self::count),
                    vertices: dice.some(Self::count),
                    corner: dice.maybe(Self::count),
                    count: dice.maybe(Self::count),
                })
            }),
        }
    }

    fn record(&mut self) -> Record {
        Record {
            mesh: self.text(),
            size: self.maybe(Self::size),
            solver: self.maybe(Self::solver),
            run: self.maybe(Self::run),
            atlas: self.maybe(Self::atlas),
            repacked: self.maybe(Self::repacked),
            quality: self.maybe(Self::quality),
            kkt: self.maybe(|dice| Kkt {
                unknowns: dice.count(),
                nonzeros_log: dice.count(),
                nonzeros_product: dice.count(),
            }),
            notes: self.some(Self::text),
            hint: self.maybe(Self::text),
            timings_s: self.maybe(Self::timings),
            repeats: self.maybe(|dice| Repeats {
                count: dice.count(),
                warmup: dice.count(),
                identical: dice.yes(),
                deviation_s: dice.stages(),
                min_s: dice.stages(),
                max_s: dice.stages(),
            }),
            peak_memory_bytes: self.maybe(Self::count),
            predicted_memory_bytes: self.maybe(|dice| dice.count() as u64),
            baseline: self.maybe(|dice| Change {
                result: dice.text(),
                f_ratio: dice.maybe(Self::number),
                stretch_l2_ratio: dice.maybe(Self::number),
                flips_change: dice.maybe(|dice| -(dice.count() as i64)),
                time_ratio: dice.maybe(Self::number),
            }),
            written: self.some(Self::text),
            not_run: self.maybe(|dice| NotRun {
                kind: dice.one_of(&[NotRunKind::Settings, NotRunKind::TooLarge]),
                message: dice.text(),
            }),
            error: self.maybe(Self::failure),
        }
    }

    fn made_with(&mut self) -> MadeWith {
        MadeWith {
            program: super::Program::this(),
            solver: self.solver(),
            settings: self.asked(),
            disks_only: self.yes(),
        }
    }

    fn surveyed(&mut self) -> Surveyed {
        let file = self.maybe(|dice| FileState { bytes: dice.count() as u64, modified_ns: dice.0.next_u64() });
        Surveyed::new(self.record(), file)
    }

    fn survey(&mut self) -> SurveyDocument {
        let reasons = [Refused::Memory, Refused::NotADisk, Refused::Internal, Refused::TooLarge, Refused::NoResult];
        let refused = self.some(|dice| (dice.one_of(&reasons), dice.count())).into_iter().collect();
        let counts = Counts { meshes: self.count(), done: self.count(), refused, ..Counts::default() };
        SurveyDocument {
            head: Head::new(SCHEMA),
            survey: About { solver: self.solver(), made_with: self.made_with(), counts },
            results: self.some(Self::surveyed),
        }
    }
}

fn rolled<T: Debug>(of: fn(&mut Dice) -> T) -> impl Strategy<Value = T> {
    Just(()).prop_perturb(move |(), rng| of(&mut Dice(rng)))
}

/// As a document and as a line of a log.
fn reads_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    for text in [pretty(value), serde_json::to_string(value).expect("text keys")] {
        let read: T = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
        assert_eq!(&read, value, "{text}");
    }
}

proptest! {
    #[test]
    fn every_record_reads_back_equal(record in rolled(Dice::record)) {
        reads_back(&record);
        reads_back(&Document { head: Head::new(SCHEMA), results: vec![record] });
    }

    #[test]
    fn every_survey_and_its_log_read_back_equal(survey in rolled(Dice::survey), made_with in rolled(Dice::made_with)) {
        survey.results.iter().for_each(reads_back);
        reads_back(&survey);
        reads_back(&LogHead { schema: SCHEMA.to_owned(), made_with });
    }

    #[test]
    fn every_history_reads_back_equal(
        numbers in prop::collection::vec((any::<f64>(), any::<Option<f64>>(), any::<usize>(), any::<bool>()), 0..4),
    ) {
        let mut trace = Trace::of("uzawa");
        for &(x, y, n, yes) in &numbers {
            trace.inner(x);
            trace.drawing(x, n);
            let record = IterationRecord {
                iteration: n,
                constraint_residual: x,
                step: x,
                energy: y,
                inner_estimate: y,
                inner_converged: yes,
                ..IterationRecord::default()
            };
            trace.start(&record, n, 0.25);
            trace.iteration(&record, 0.5);
        }
        let (mesh, solved_by) = ("a \"mesh\"".to_owned(), "uzawa".to_owned());
        let figures = numbers.first().map(|&(x, _, n, _)| (x, n));
        let history = History::new(&abf::Pipeline::default(), Ended { mesh, solved_by, corners: 3, figures }, trace);
        reads_back(&Histories { head: Head::new("history"), runs: vec![history] });
    }
}

#[test]
fn the_record_of_a_flattening_reads_back_equal_and_a_figure_without_a_value_is_infinite() {
    let mesh = abf_shapes::Shape::Hemisphere.mesh(100);
    let flat = flatten(&mesh).expect("a disk");
    let metrics = flat.metrics(&mesh).expect("metrics");
    let quality = Quality { stretch_linf: f64::INFINITY, ..Quality::new(&metrics) };
    let run = Some(RunRecord::new(&Pipeline::default(), &flat, &[0.5]));
    let record = Record { mesh: "a".to_owned(), run, quality: Some(quality), ..Record::default() };
    reads_back(&record);
    assert!(pretty(&record).contains("\"stretch_linf\": null"));
}

#[test]
fn a_solver_of_someones_own_is_shown_by_name_and_its_record_reads_back_equal() {
    let pipeline = Pipeline { solver: Solver::custom(Own), ..Pipeline::default() };
    let mesh = abf_shapes::Shape::Hemisphere.mesh(100);
    let flat = pipeline.run(&mesh, &mut Silent).expect("a disk");
    let run = RunRecord::new(&pipeline, &flat, &[]);
    let record = Record {
        mesh: "a".to_owned(),
        solver: Some(pipeline.solver.name().to_owned()),
        quality: Some(Quality::new(&flat.metrics(&mesh).expect("metrics"))),
        run: Some(run),
        ..Record::default()
    };
    reads_back(&record);
    let json = serde_json::to_value(&record).expect("text keys");
    assert_eq!((&json["solver"], &json["solved_by"]), (&"someone's own".into(), &"someone's own".into()), "{json}");
    assert_eq!(json["settings"]["solver"], serde_json::json!({"custom": "someone's own"}));
    let settings = &record.run.as_ref().expect("a run").settings;
    assert_eq!((settings.solver(), settings.pipeline()), (None, Some(Pipeline::default())));
}

#[test]
fn charts_say_what_a_disk_says_and_all_of_them_together() {
    let pipeline = Pipeline { solver: "abf++".parse().expect("ours"), ..Pipeline::default() };
    let unwrap = Unwrap { pipeline, ..Unwrap::default() };
    let mesh = abf_shapes::Shape::Hemisphere.mesh(400);
    // Twice, side by side.
    let n = mesh.vertex_count();
    let far = mesh.positions().iter().map(|p| p + abf_mesh::Vector3::new(9.0, 0.0, 0.0));
    let faces = mesh.faces().iter().map(|face| face.map(abf_mesh::VertexId::index));
    let twice: Vec<[usize; 3]> = faces.clone().chain(faces.map(|face| face.map(|v| v + n))).collect();
    let positions = mesh.positions().iter().copied().chain(far).collect();
    let two = abf_mesh::TriMesh::new(positions, &twice).expect("indices in range");
    let unwrapped = unwrap.run(&two, &SurfaceHints::default(), &mut Silent).expect("charts");
    let charts: Vec<Solved> = unwrapped.charts.iter().map(|chart| Solved::of_chart(&unwrap.pipeline, chart)).collect();
    assert!(charts.len() >= 2, "{}", charts.len());
    let all = RunRecord::of_charts(&unwrap.pipeline, charts.iter()).expect("charts");
    assert!(all.iterations > 0 && all.iterations == charts.iter().map(|chart| chart.iterations).sum::<usize>());
    let residuals = charts.iter().filter_map(|chart| chart.constraint_residual);
    assert_eq!(all.constraint_residual, residuals.reduce(f64::max), "{all:?}");
    assert_eq!((all.termination, all.solved_by.as_str()), (Termination::Converged, "abf++"), "{all:?}");
    reads_back(&all);
    let disk = RunRecord::new(&unwrap.pipeline, &unwrap.pipeline.run(&mesh, &mut Silent).expect("a disk"), &[]);
    let fields =
        |run: &dyn Fn() -> serde_json::Value| run().as_object().map(|all| all.keys().cloned().collect::<Vec<_>>());
    let of_disk = fields(&|| serde_json::to_value(&disk).expect("text keys"));
    assert_eq!(fields(&|| serde_json::to_value(&all).expect("text keys")), of_disk);
    for chart in &charts {
        let own = fields(&|| serde_json::to_value(chart).expect("text keys"));
        assert_eq!(own.map(|own| own.len() + 1), of_disk.as_ref().map(Vec::len), "all but the settings");
    }
}
