//! Maps that are relaxed after the solver.

use abf::mesh::TriMesh;
use abf::{
    Boundary, Energy, Event, FlattenError, Flattening, Observer, Pipeline, Relax, Silent, Stage, SurfaceHints,
    Termination, Unwrap, UnwrappedChart, Verdict,
};
use abf_shapes::Shape;

fn flat(mesh: &TriMesh, energy: Option<Energy>) -> Flattening {
    let relax = energy.map(|energy| Relax { energy, ..Relax::default() });
    Pipeline { relax, ..Pipeline::default() }.run(mesh, &mut Silent).expect("a map")
}

#[test]
fn every_energy_makes_a_valid_map_with_less_of_it() {
    let mesh = Shape::SpikyField.mesh(2000);
    let free = flat(&mesh, None).metrics(&mesh).expect("a measure");
    for energy in [Energy::Abf, Energy::Isometric, Energy::USABLE, Energy::Slider(1.0)] {
        let relaxed = flat(&mesh, Some(energy));
        assert!(relaxed.certificate.valid(), "{energy}");
        assert_eq!(relaxed.termination, Termination::Converged, "{energy}");
        let report = relaxed.relaxed.as_ref().expect("a report");
        assert_eq!(report.energy, energy);
        assert!(report.after <= report.before * (1.0 + 1e-12) && !report.from_tutte, "{report:?}");
        let metrics = relaxed.metrics(&mesh).expect("a measure");
        if energy != Energy::Abf {
            assert!(metrics.stretch_l2 < free.stretch_l2, "{energy}: {} {}", metrics.stretch_l2, free.stretch_l2);
        }
        assert!((metrics.uv_area / metrics.surface_area - 1.0).abs() < 1e-9, "{energy}");
    }
}

#[test]
fn more_weight_of_areas_is_less_stretch_and_more_error_of_angles() {
    let mesh = Shape::SpikyField.mesh(2000);
    let of = |theta| flat(&mesh, Some(Energy::Slider(theta))).metrics(&mesh).expect("a measure");
    let all = [0.01, 0.1, 1.0].map(of);
    for (little, much) in all.iter().zip(&all[1..]) {
        assert!(little.stretch_l2 > much.stretch_l2 && little.f < much.f);
    }
}

#[test]
fn a_relaxed_map_has_the_same_bits_for_any_number_of_threads() {
    let mesh = Shape::BumpySheet.mesh(5000);
    let with = |threads| {
        abf::parallel::with_threads(threads, || flat(&mesh, Some(Energy::Isometric)).uv).expect("that many threads")
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn charts_are_relaxed_when_asked_and_need_no_more_cuts_for_it() {
    let mesh = Shape::SpikyField.mesh(1500);
    let charts = |relax: Option<Relax>| {
        let pipeline = Pipeline { relax, ..Pipeline::default() };
        Unwrap { pipeline, cut_disks: true, ..Unwrap::default() }
            .run(&mesh, &SurfaceHints::default(), &mut Silent)
            .expect("charts")
            .charts
    };
    let (free, relaxed) = (charts(None), charts(Some(Relax::default())));
    assert!(free.iter().all(|chart| chart.relaxed.is_none()));
    assert!(relaxed.iter().any(|chart| chart.relaxed.is_some()) && relaxed.iter().all(UnwrappedChart::is_certified));
    assert!(relaxed.len() <= free.len(), "{} {}", relaxed.len(), free.len());
}

#[test]
fn an_observer_can_stop_relaxing_with_a_map_and_abort_it_without_one() {
    struct EndAt(Verdict, bool);
    impl Observer for EndAt {
        fn observe(&mut self, event: Event<'_>) -> Verdict {
            self.1 |= matches!(event, Event::StageStarted(Stage::Relax));
            if self.1 { self.0 } else { Verdict::Continue }
        }
    }
    let mesh = Shape::SpikyField.mesh(500);
    let pipeline = Pipeline { relax: Some(Relax::default()), ..Pipeline::default() };
    let stopped = pipeline.run(&mesh, &mut EndAt(Verdict::Stop, false)).expect("a map");
    assert!(stopped.termination == Termination::Cancelled && stopped.certificate.valid());
    let aborted = pipeline.run(&mesh, &mut EndAt(Verdict::Abort, false));
    assert!(matches!(aborted, Err(FlattenError::Cancelled(_))), "{aborted:?}");
}

#[test]
fn settings_out_of_range_and_a_boundary_rule_are_refused() {
    let refused = |relax: Relax, boundary: Boundary| {
        Pipeline { relax: Some(relax), boundary, ..Pipeline::default() }.check().expect_err("refused")
    };
    for relax in [
        Relax { energy: Energy::Slider(-1.0), ..Relax::default() },
        Relax { energy_tolerance: f64::NAN, ..Relax::default() },
        Relax { max_steps: 0, ..Relax::default() },
        Relax { barrier: 0.0, ..Relax::default() },
    ] {
        assert!(matches!(refused(relax, Boundary::Free), FlattenError::Relax(_)), "{relax:?}");
    }
    assert_eq!(refused(Relax::default(), Boundary::Convex), FlattenError::RelaxBoundary("isometric".to_owned()));
}

#[test]
fn energies_read_back_and_words_that_are_none_are_refused() {
    for text in ["abf", "isometric", "usable", "0.3", "2"] {
        assert_eq!(text.parse::<Energy>().expect("an energy").to_string(), text);
    }
    assert_eq!("0.01".parse(), Ok(Energy::USABLE));
    for text in ["", "slim", "-1", "0", "nan", "inf"] {
        let error = text.parse::<Energy>().expect_err("no energy").to_string();
        assert!(error.contains("isometric") && error.contains(&format!("'{text}'")), "{error}");
    }
}
