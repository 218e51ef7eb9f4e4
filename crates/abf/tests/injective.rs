//! Maps that lie over themselves, and what is done about it.

use abf::{
    Energy, Event, FlattenError, Flattening, Injective, Observer, Pipeline, Relax, Silent, Stage, StopCriteria,
    SurfaceHints, Termination, Unwrap, Verdict,
};
use abf_mesh::{Point3, TriMesh, VertexId};
use abf_shapes::Shape;
use std::f64::consts::TAU;
use std::time::Duration;

/// A strip around an axis, rising a little: unrolled it lies over itself.
fn helix(turns: f64, steps: usize) -> TriMesh {
    let points = (0..=steps).flat_map(|k| {
        let turn = TAU * turns * k as f64 / steps as f64;
        [1.0, 1.5, 2.0].map(|r| Point3::new(r * turn.cos(), r * turn.sin(), 0.05 * turn))
    });
    let faces: Vec<[usize; 3]> =
        (0..steps).flat_map(|k| [3 * k, 3 * k + 1]).flat_map(|k| [[k, k + 1, k + 3], [k + 1, k + 4, k + 3]]).collect();
    TriMesh::new(points.collect(), &faces).expect("indices in range")
}

fn flat(mesh: &TriMesh, pipeline: &Pipeline) -> Flattening {
    pipeline.run(mesh, &mut Silent).expect("a map")
}

fn with(injective: Injective) -> Pipeline {
    Pipeline { injective, ..Pipeline::default() }
}

#[test]
fn a_map_that_lies_over_itself_is_deformed_or_parted_until_it_does_not() {
    let mesh = helix(1.5, 60);
    let free = flat(&mesh, &with(Injective::Off));
    assert!(free.certificate.valid() && free.certificate.overlaps() > 0 && free.injective.is_none());
    let deformed = flat(&mesh, &with(Injective::Deform));
    assert!(deformed.certificate.injective() && deformed.certificate.charts == 1);
    let report = deformed.injective.as_ref().expect("a report");
    assert_eq!((report.rule, report.overlaps, report.parts), (Injective::Deform, free.certificate.overlaps(), 1));
    assert!(report.after > report.before && report.first_steps > 0 && report.steps > report.first_steps);
    assert!(report.gap.is_some_and(|gap| gap > 0.0));
    let parted = flat(&mesh, &with(Injective::Split));
    assert!(parted.certificate.injective() && parted.is_certified());
    let report = parted.injective.as_ref().expect("a report");
    assert_eq!(report.parts, parted.certificate.charts);
    assert!(report.parts > 1);
    let [of_free, of_parted] = [&free, &parted].map(|flat| flat.metrics(&mesh).expect("a measure").f);
    assert!((of_free - of_parted).abs() < 1e-6 * of_free.max(1e-9), "{of_free} {of_parted}");
}

#[test]
fn the_caterpillar_overlaps_itself_unless_it_is_deformed() {
    let mesh = Shape::Caterpillar.mesh(1500);
    for relax in [None, Some(Energy::Isometric)] {
        let relax = relax.map(|energy| Relax { energy, ..Relax::default() });
        let [free, deformed] =
            [Injective::Off, Injective::Deform].map(|rule| flat(&mesh, &Pipeline { relax, ..with(rule) }));
        assert!(free.certificate.valid() && free.certificate.overlaps() > 0, "{relax:?}");
        assert!(deformed.certificate.injective() && deformed.is_certified(), "{relax:?}");
    }
}

#[test]
fn a_map_is_parted_alike_at_any_scale() {
    let mesh = helix(1.5, 60);
    let scaled = |scale: f64| {
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(VertexId::index)).collect();
        TriMesh::new(mesh.positions().iter().map(|p| p * scale).collect(), &faces).expect("indices in range")
    };
    let charts: Vec<Vec<usize>> = [1.0, 2.0_f64.powi(-996), 2.0_f64.powi(500)]
        .map(|scale| {
            let parted = flat(&scaled(scale), &with(Injective::Split));
            assert!(parted.certificate.injective() && parted.is_certified(), "{scale}");
            let report = parted.injective.as_ref().expect("a report");
            assert_eq!(report.parts, parted.certificate.charts, "{scale}");
            parted.uv.corners().iter().map(|id| id.index()).collect()
        })
        .to_vec();
    assert!(charts[0] == charts[1] && charts[0] == charts[2]);
}

#[test]
fn a_map_without_overlaps_is_the_same_to_the_bit() {
    let mesh = Shape::BumpySheet.mesh(500);
    let free = flat(&mesh, &with(Injective::Off));
    for rule in [Injective::Split, Injective::Deform] {
        let same = flat(&mesh, &with(rule));
        assert!(same.uv == free.uv && same.injective.is_none());
    }
}

#[test]
fn the_gap_that_is_asked_for_is_in_units_of_the_mesh() {
    let mesh = helix(1.5, 60);
    // As tiny as it is, it is scaled to be worked on.
    let tiny = TriMesh::new(
        mesh.positions().iter().map(|p| p * 1e-200).collect(),
        &mesh.faces().iter().map(|face| face.map(VertexId::index)).collect::<Vec<_>>(),
    );
    for (mesh, scale) in [(&mesh, 1.0), (&tiny.expect("indices in range"), 1e-200)] {
        let pipeline = Pipeline { boundary_gap: 0.2 * scale, ..with(Injective::Deform) };
        let deformed = flat(mesh, &pipeline);
        let gap = deformed.injective.as_ref().and_then(|report| report.gap).expect("a gap");
        assert_eq!(deformed.termination, Termination::Converged);
        assert!(deformed.certificate.injective() && gap > 0.198 * scale && gap < 0.8 * scale, "{gap}");
    }
}

#[test]
fn the_energy_that_is_asked_for_is_least_at_the_end() {
    let mesh = helix(1.5, 60);
    let of = |energy| {
        let relax = Some(Relax { energy, ..Relax::default() });
        let made = flat(&mesh, &Pipeline { relax, ..with(Injective::Deform) });
        assert!(
            made.certificate.injective() && made.injective.as_ref().is_some_and(|report| report.energy == Some(energy))
        );
        made.metrics(&mesh).expect("a measure")
    };
    let (lengths, angles) = (of(Energy::Isometric), of(Energy::Abf));
    assert!(lengths.stretch_l2 < angles.stretch_l2 && angles.f < lengths.f);
}

#[test]
fn charts_are_deformed_one_by_one_when_asked_instead_of_parted() {
    let one = helix(1.5, 60);
    let count = one.vertex_count();
    let points = one.positions().iter().flat_map(|&p| [p, Point3::new(p.x, p.y, p.z + 5.0)]).collect::<Vec<_>>();
    let faces = one.faces().iter().map(|face| face.map(VertexId::index));
    let faces: Vec<[usize; 3]> =
        [0, 1].into_iter().flat_map(|k| faces.clone().map(move |face| face.map(|v| 2 * v + k))).collect();
    let two = TriMesh::new(points, &faces).expect("indices in range");
    assert_eq!(two.vertex_count(), 2 * count);
    let charts = |injective| {
        // Loose enough for what deforming costs.
        let unwrap = Unwrap { pipeline: with(injective), max_stretch: 2.0, cut_disks: true, ..Unwrap::default() };
        unwrap.run(&two, &SurfaceHints::default(), &mut Silent).expect("charts").charts
    };
    let (parted, deformed) = (charts(Injective::Off), charts(Injective::Deform));
    assert!(parted.len() >= 4 && parted.iter().all(|chart| chart.injective.is_none()));
    assert_eq!(deformed.len(), 2);
    assert!(
        deformed.iter().all(|chart| chart.is_certified() && chart.metrics.injective() && chart.injective.is_some())
    );
}

/// Stops once the map is deformed.
struct StopDeforming(bool);

impl Observer for StopDeforming {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.0 |= matches!(event, Event::StageStarted(Stage::Relax));
        if self.0 && matches!(event, Event::Iteration(_)) { Verdict::Stop } else { Verdict::Continue }
    }
}

#[test]
fn stopped_while_it_is_deformed_the_map_does_not_overlap() {
    let mesh = helix(1.5, 60);
    let stopped = with(Injective::Deform).run(&mesh, &mut StopDeforming(false)).expect("a map");
    assert_eq!(stopped.termination, Termination::Cancelled);
    assert!(stopped.certificate.injective() && stopped.injective.is_some_and(|report| report.steps == 1));
    let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
    let hurried = Pipeline { stop, ..with(Injective::Deform) }.run(&mesh, &mut Silent).expect("a map");
    assert_eq!(hurried.termination, Termination::TimeLimit);
}

#[test]
fn a_gap_that_is_too_large_is_refused_whether_or_not_the_map_lies_over_itself() {
    for mesh in [helix(1.5, 60), Shape::BumpySheet.mesh(60)] {
        let asked = Pipeline { boundary_gap: 1e3, ..with(Injective::Deform) };
        let refused = asked.run(&mesh, &mut Silent).expect_err("no room for it");
        assert!(matches!(refused, FlattenError::GapTooLarge { .. }), "{refused}");
    }
}
