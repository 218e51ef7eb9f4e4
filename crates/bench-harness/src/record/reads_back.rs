//! Everything that is written reads back as it was.

use super::atlas::{Atlas, Charted};
use super::change::Change;
use super::failure::Failure;
use super::head::Head;
use super::history::{Curves, Histories, History};
use super::json::{Document, SCHEMA, pretty};
use super::kind::{FailureKind, NotRunKind, Refused};
use super::location::Location;
use super::not_run::NotRun;
use super::quality::Quality;
use super::result::Record;
use super::run::{Limits, Run, Rung};
use super::settings::Asked;
use super::size::{Kkt, Size};
use super::surveyed::{About, Counts, FileState, LogHead, MadeWith, SurveyDocument, Surveyed};
use super::times::{Repeats, Stages, Timings};
use abf::{IterationRecord, LayoutKind, Pipeline, Precision, Solver, SolverKind, Termination, flatten};
use proptest::prelude::*;
use proptest::test_runner::TestRng;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;

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

    fn asked(&mut self) -> Asked {
        let solver = self.one_of(&Solver::all());
        let asked = Asked::new(&Pipeline { solver, ..Pipeline::default() });
        Asked {
            passes: self.maybe(|dice| dice.one_of(&["auto", "3"]).parse().expect("passes")),
            inner_tolerance: self.maybe(|dice| match dice.yes() {
                true => "auto".parse().expect("a tolerance"),
                false => dice.number().to_string().parse().expect("a tolerance"),
            }),
            max_inner_iterations: self.maybe(Self::count),
            barrier_floor: self.maybe(Self::number),
            layout: self.one_of(&LayoutKind::ALL),
            ring_switch: self.maybe(Self::number),
            angle_bound: self.number(),
            tolerance: self.number(),
            max_iterations: self.count(),
            time_limit_s: self.maybe(Self::number),
            normalize: self.yes(),
            threads: self.count(),
            ..asked
        }
    }

    fn rung(&mut self) -> Rung {
        Rung {
            solver: self.solver(),
            termination: self.maybe(Self::termination),
            iterations: self.count(),
            valid: self.yes(),
            flips: self.count(),
            collapsed: self.count(),
            wound: self.count(),
            f: self.maybe(Self::number),
            time_s: self.number(),
            error: self.maybe(Self::text),
        }
    }

    fn run(&mut self) -> Run {
        Run {
            settings: self.asked(),
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
            moved_angles: self.count(),
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
        }
    }

    fn chart(&mut self) -> Charted {
        Charted {
            component: self.count(),
            page: self.count(),
            triangles: self.count(),
            solved_by: self.solver(),
            termination: self.termination(),
            valid: self.yes(),
            injective: self.yes(),
            f: self.figure(),
            stretch_l2: self.figure(),
            unfinished: self.yes(),
            seam_length: self.figure(),
            rounds: self.count(),
            holes_filled: self.count(),
            layout_error: self.maybe(Self::number),
        }
    }

    fn atlas(&mut self) -> Atlas {
        Atlas {
            charts: self.some(Self::chart),
            pages: self.count(),
            resolution: 1024,
            margin: 2,
            texels_per_unit: self.figure(),
            coverage: self.figure(),
            seam_edges: self.count(),
            seam_length: self.figure(),
            diagonal: self.figure(),
            max_stretch: self.number(),
            is_bound: self.yes(),
            repairs: self.some(Self::text),
        }
    }

    fn quality(&mut self) -> Quality {
        let [f, f_weighted, max_angle_error, stretch_l2, stretch_linf, qc_mean] = [(); 6].map(|()| self.figure());
        let [qc_max, area_l2, uv_area, surface_area, touch_depth, uv_angle_min, uv_angle_max] =
            [(); 7].map(|()| self.figure());
        Quality {
            valid: self.yes(),
            injective: self.yes(),
            flips: self.count(),
            collapsed: self.count(),
            near_collapsed: self.count(),
            wound: self.count(),
            overlaps: self.count(),
            crossings: self.count(),
            meetings: self.count(),
            nested: self.count(),
            touches: self.count(),
            degenerate_3d: self.count(),
            charts: self.count(),
            f,
            f_weighted,
            max_angle_error,
            stretch_l2,
            stretch_linf,
            qc_mean,
            qc_max,
            area_l2,
            uv_area,
            surface_area,
            touch_depth,
            uv_angle_min,
            uv_angle_max,
            flipped_faces: self.some(Self::count),
            collapsed_faces: self.some(Self::count),
            wound_vertices: self.some(Self::count),
            overlapping_faces: self.some(|dice| [dice.count(), dice.count()]),
            uv_precision: self.one_of(&[Precision::Single, Precision::Double]),
        }
    }

    fn stages(&mut self) -> Stages {
        Stages {
            topology: self.number(),
            solve: self.number(),
            layout: self.number(),
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
        let mut curves = Curves::default();
        let iteration = |&(x, y, n, yes): &(f64, Option<f64>, usize, bool)| {
            curves.inner(x);
            curves.outer();
            IterationRecord {
                iteration: n,
                constraint_residual: x,
                step: x,
                energy: y,
                inner_estimate: y,
                inner_converged: yes,
                ..IterationRecord::default()
            }
        };
        let records: Vec<IterationRecord> = numbers.iter().map(iteration).collect();
        let history = History::new("a \"mesh\"", "uzawa".to_owned(), &records, curves.into_done());
        reads_back(&Histories { head: Head::new("history"), runs: vec![history] });
    }
}

#[test]
fn the_record_of_a_flattening_reads_back_equal_and_a_figure_without_a_value_is_infinite() {
    let mesh = abf_shapes::Shape::Hemisphere.mesh(100);
    let flat = flatten(&mesh).expect("a disk");
    let metrics = flat.metrics(&mesh).expect("metrics");
    let quality = Quality { stretch_linf: f64::INFINITY, ..Quality::new(&metrics) };
    let run = Some(Run::new(&Pipeline::default(), &flat, &[0.5]));
    let record = Record { mesh: "a".to_owned(), run, quality: Some(quality), ..Record::default() };
    reads_back(&record);
    assert!(pretty(&record).contains("\"stretch_linf\": null"));
}
