//! Maps that anybody made, relaxed.

use abf::mesh::{CornerId, Point2, Point3, TriMesh, UvId, UvMap};
use abf::{
    Energy, Event, FlattenError, Observer, Pin, PinWeight, Pins, Pipeline, Relax, RelaxedMap, Silent, Solver,
    Termination, Verdict,
};
use abf_shapes::Shape;
use std::f64::consts::PI;

fn relaxed(mesh: &TriMesh, uv: &UvMap, pipeline: &Pipeline) -> RelaxedMap {
    pipeline.relax_map(mesh, uv, &mut Silent).expect("a map")
}

/// A map of LSCM in the unit square.
fn lscm(mesh: &TriMesh) -> UvMap {
    let pipeline = Pipeline { solver: Solver::Lscm, normalize: true, ..Pipeline::default() };
    pipeline.run(mesh, &mut Silent).expect("a map").uv
}

fn centre(uv: &UvMap) -> Point2<f64> {
    let sum = uv.points().iter().fold(Point2::origin(), |sum: Point2<f64>, p| sum + p.coords);
    sum / uv.points().len() as f64
}

/// Two triangles that meet at a vertex only, far from everything, and their map.
fn bow() -> (TriMesh, UvMap) {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 2.0], [1.0, 2.0]].map(|[x, y]| [x + 100.0, y]);
    let positions = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let mesh = TriMesh::new(positions, &[[0, 1, 2], [2, 3, 4]]).expect("a mesh");
    let uv = UvMap::per_vertex(&mesh, &points.map(Point2::from));
    (mesh, uv)
}

/// All of these as one mesh with one map.
fn joined(parts: &[(TriMesh, UvMap)]) -> (TriMesh, UvMap) {
    let (mut positions, mut faces, mut points, mut corners) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (mesh, uv) in parts {
        faces.extend(mesh.faces().iter().map(|face| face.map(|v| v.index() + positions.len())));
        corners.extend(uv.corners().iter().map(|id| UvId::new(id.index() + points.len())));
        positions.extend_from_slice(mesh.positions());
        points.extend_from_slice(uv.points());
    }
    (TriMesh::new(positions, &faces).expect("a mesh"), UvMap::new(points, corners))
}

/// Answers so at every step.
struct AtSteps(Verdict);

impl Observer for AtSteps {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        if matches!(event, Event::Iteration(_)) { self.0 } else { Verdict::Continue }
    }
}

fn with_energy(energy: Energy) -> Pipeline {
    Pipeline { relax: Some(Relax { energy, ..Relax::default() }), ..Pipeline::default() }
}

#[test]
fn a_map_comes_to_the_energy_that_it_has_after_its_solver_and_stays_in_its_place() {
    let mesh = Shape::BumpySheet.mesh(1500);
    let start = lscm(&mesh);
    for energy in [Energy::Isometric, Energy::USABLE, Energy::Slider(0.3)] {
        let map = relaxed(&mesh, &start, &with_energy(energy));
        let solver = Pipeline { solver: Solver::Lscm, ..with_energy(energy) };
        let solved = solver.run(&mesh, &mut Silent).expect("a map").relaxed.expect("a report");
        let [Some(report)] = &map.charts[..] else { panic!("{:?}", map.charts) };
        assert!(map.is_certified() && report.after < report.before && !report.from_tutte, "{report:?}");
        assert!((report.after / solved.after - 1.0).abs() < 1e-5, "{energy}: {} {}", report.after, solved.after);
        assert!((map.uv.area() / start.area() - 1.0).abs() < 1e-9);
        assert!((centre(&map.uv) - centre(&start)).norm() < 1e-9);
        // It is not turned: on the whole points are where they were.
        let turn: f64 = mesh
            .faces()
            .as_flattened()
            .iter()
            .enumerate()
            .map(|(c, _)| {
                let at = |uv: &UvMap| uv.corner(CornerId::new(c)) - centre(uv);
                at(&map.uv).perp(&at(&start))
            })
            .sum();
        assert!(turn.abs() < 0.02 * start.area() * mesh.faces().len() as f64, "{turn}");
    }
}

#[test]
fn a_mirrored_map_stays_mirrored() {
    let mesh = Shape::BumpySheet.mesh(400);
    let mirrored = lscm(&mesh).mapped(|p| Point2::new(p.x, -p.y));
    let map = relaxed(&mesh, &mirrored, &Pipeline::default());
    assert!(map.is_certified() && map.uv.signed_area() < 0.0);
    assert!((map.uv.signed_area() / mirrored.signed_area() - 1.0).abs() < 1e-9);
}

#[test]
fn every_chart_is_relaxed_by_itself_and_keeps_its_centre_and_its_share() {
    let mesh = Shape::BumpySheet.mesh(1200);
    let start = lscm(&mesh);
    // The right half of it stands aside.
    let (low, high) = start.bounds().expect("points");
    let middle = 0.5 * (low.x + high.x);
    let is_right = |corners: &[UvId; 3]| corners.iter().all(|c| start.points()[c.index()].x > middle);
    let faces = start.corners().as_chunks::<3>().0;
    let points: Vec<Point2<f64>> = faces
        .iter()
        .flat_map(|face| {
            face.map(|c| start.points()[c.index()] + Point2::new(5.0 * f64::from(is_right(face)), 0.0).coords)
        })
        .collect();
    let parted = UvMap::new(points, (0..start.corners().len()).map(UvId::new).collect());
    let map = relaxed(&mesh, &parted, &Pipeline::default());
    assert!(map.is_certified() && map.certificate.charts == 2, "{:?}", map.certificate);
    assert_eq!((map.charts.len(), map.charts.iter().flatten().count()), (2, 2));
    assert!((map.uv.area() / parted.area() - 1.0).abs() < 1e-9);
    let metrics = abf::metrics::measure(&mesh, &map.uv).expect("a measure");
    let before = abf::metrics::measure(&mesh, &parted).expect("a measure");
    assert!(metrics.stretch_l2 < before.stretch_l2, "{} {}", metrics.stretch_l2, before.stretch_l2);
    for (chart, right) in
        [(map.chart_of_face[0], is_right(&faces[0])), (1 - map.chart_of_face[0], !is_right(&faces[0]))]
    {
        let of = |uv: &UvMap| {
            let own = (0..faces.len()).filter(|&f| map.chart_of_face[f] == chart);
            let mut used: Vec<(u64, u64)> = own
                .flat_map(|f| [0, 1, 2].map(|k| uv.corner(CornerId::new(3 * f + k))))
                .map(|p| (p.x.to_bits(), p.y.to_bits()))
                .collect();
            used.sort_unstable();
            used.dedup();
            used.iter().map(|p| f64::from_bits(p.0)).sum::<f64>() / used.len() as f64
        };
        assert!((of(&map.uv) - of(&parted)).abs() < 1e-9, "the centre of chart {chart}");
        assert_eq!(of(&map.uv) > 3.0, right);
    }
}

#[test]
fn a_map_with_flips_starts_from_tuttes_embedding() {
    let mesh = Shape::BumpySheet.mesh(400);
    let start = lscm(&mesh);
    let flipped = UvMap::new(
        start.points().iter().enumerate().map(|(i, &p)| if i == 30 { p * 3.0 } else { p }).collect(),
        start.corners().to_vec(),
    );
    let map = relaxed(&mesh, &flipped, &Pipeline::default());
    assert!(map.is_certified() && map.charts[0].as_ref().expect("a report").from_tutte);
}

#[test]
fn a_chart_without_any_valid_map_stays_and_says_so() {
    // A tube, seen along its axis.
    let ring = |z: f64| (0..12).map(move |k| f64::from(k) * PI / 6.0).map(move |a| Point3::new(a.cos(), a.sin(), z));
    let pair = |k: usize| [[k, (k + 1) % 12, 12 + k], [(k + 1) % 12, 12 + (k + 1) % 12, 12 + k]];
    let faces: Vec<[usize; 3]> = (0..12).flat_map(pair).collect();
    let mesh = TriMesh::new(ring(0.0).chain(ring(1.0)).collect(), &faces).expect("a mesh");
    let flat = UvMap::per_vertex(&mesh, &mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect::<Vec<_>>());
    let map = relaxed(&mesh, &flat, &Pipeline::default());
    assert_eq!((map.is_certified(), map.termination, &map.charts[..]), (false, Termination::Stalled, &[None][..]));
    assert_eq!(map.uv.corner(CornerId::new(7)), flat.corner(CornerId::new(7)));
}

#[test]
fn pins_say_where_the_map_is() {
    let mesh = Shape::BumpySheet.mesh(400);
    let start = lscm(&mesh);
    let places = [(0, [0.0, 0.0]), (5, [2.0, 0.5])];
    let pins = places.map(|(vertex, uv)| Pin { vertex, uv, weight: PinWeight::Hard }).to_vec();
    let pipeline = Pipeline { pins: Some(Pins { pins }), ..Pipeline::default() };
    let map = relaxed(&mesh, &start, &pipeline);
    assert!(map.is_certified() && map.charts[0].is_some());
    let residuals = map.pinned.expect("a report").residuals;
    assert!(residuals.iter().all(|pin| pin.distance == 0.0), "{residuals:?}");
    let apart = UvMap::new(
        start
            .corners()
            .iter()
            .enumerate()
            .map(|(c, id)| start.points()[id.index()] + Point2::new(c as f64, 0.0).coords)
            .collect(),
        (0..start.corners().len()).map(UvId::new).collect(),
    );
    let refused = pipeline.relax_map(&mesh, &apart, &mut Silent).unwrap_err();
    assert!(matches!(refused, FlattenError::PinsElsewhere(_)), "{refused}");
}

#[test]
fn what_cannot_be_relaxed_is_named() {
    let mesh = Shape::BumpySheet.mesh(60);
    let start = lscm(&mesh);
    let refused = |mesh: &TriMesh, uv: &UvMap, pipeline: &Pipeline| {
        pipeline.relax_map(mesh, uv, &mut Silent).expect_err("refused").to_string()
    };
    let energy = with_energy(Energy::Slider(-1.0));
    assert!(refused(&mesh, &start, &energy).contains("could not be relaxed"));
    let short = UvMap::new(start.points().to_vec(), start.corners()[3..].to_vec());
    assert!(refused(&mesh, &short, &Pipeline::default()).contains("judged"));
    let infinite = start.clone().mapped(|p| p / 0.0);
    assert!(refused(&mesh, &infinite, &Pipeline::default()).contains("judged"));
    // Two pairs of triangles, the second of which meets in one vertex only.
    let points =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [5.0, 0.0], [6.0, 0.0], [6.0, 1.0], [7.0, 2.0], [6.0, 2.0]];
    let faces = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [6, 7, 8]];
    let bow = TriMesh::new(points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec(), &faces).expect("a mesh");
    let uv = UvMap::per_vertex(&bow, &points.map(Point2::from));
    let map = relaxed(&bow, &uv, &Pipeline::default());
    assert_eq!(map.refused.len(), 1);
    assert_eq!(map.refused[0].to_string(), "the chart of face 2 could not be relaxed");
    let nothing = TriMesh::new(Vec::new(), &[]).expect("no mesh");
    assert!(Pipeline::default().relax_map(&nothing, &UvMap::new(Vec::new(), Vec::new()), &mut Silent).is_err());
}

#[test]
fn a_chart_that_is_no_manifold_stays_as_it_was_and_the_others_are_relaxed() {
    let sheet = Shape::BumpySheet.mesh(400);
    let start = lscm(&sheet);
    let (mesh, uv) = joined(&[(sheet.clone(), start.clone()), bow()]);
    let map = relaxed(&mesh, &uv, &Pipeline::default());
    assert_eq!(map.charts.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false]);
    let [FlattenError::RelaxChart { face, .. }] = map.refused.as_slice() else { panic!("{:?}", map.refused) };
    assert_eq!(face.index(), sheet.face_count());
    assert!(map.termination == Termination::Stalled && !map.is_certified());
    for c in 3 * sheet.face_count()..3 * mesh.face_count() {
        assert_eq!(map.uv.corner(CornerId::new(c)), uv.corner(CornerId::new(c)));
    }
    let alone = relaxed(&sheet, &start, &Pipeline::default());
    let [with, without] = [&map, &alone].map(|map| map.charts[0].as_ref().expect("relaxed").after);
    assert!((with - without).abs() < 1e-3 * without, "{with} {without}");
}

#[test]
fn charts_after_a_stop_stay_as_they_were_though_one_before_was_refused() {
    let sheet = Shape::BumpySheet.mesh(400);
    let start = lscm(&sheet);
    let beside = start.clone().mapped(|p| Point2::new(p.x + 3.0, p.y));
    let (mesh, uv) = joined(&[bow(), (sheet.clone(), start), (sheet.clone(), beside)]);
    let map = Pipeline::default().relax_map(&mesh, &uv, &mut AtSteps(Verdict::Stop)).expect("a map");
    assert_eq!(map.refused.len(), 1);
    assert_eq!(map.charts.iter().map(Option::is_some).collect::<Vec<_>>(), [false, true, false]);
    for c in 3 * (2 + sheet.face_count())..3 * mesh.face_count() {
        assert_eq!(map.uv.corner(CornerId::new(c)), uv.corner(CornerId::new(c)));
    }
}

#[test]
fn an_observer_aborts_it() {
    let mesh = Shape::BumpySheet.mesh(400);
    let ended = Pipeline::default().relax_map(&mesh, &lscm(&mesh), &mut AtSteps(Verdict::Abort)).unwrap_err();
    assert!(matches!(ended, FlattenError::Cancelled(_)), "{ended}");
}
