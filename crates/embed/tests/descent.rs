//! The descent as a user sees it.

use abf_constraints::{AngleProblem, GuessSettings};
use abf_control::{Event, Observer, Silent, StopCriteria, Termination, Verdict};
use abf_embed::{Descent, DescentSolution, EmbedError, tutte, vertex_points};
use abf_mesh::{FaceId, Point2, Point3, Topology, TriMesh, UvId, UvMap, VertexId};
use abf_shapes::Shape;
use robust::{Coord, orient2d};
use std::time::Duration;

fn topology(mesh: &TriMesh) -> Topology {
    Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
}

fn problem<'t>(mesh: &TriMesh, topology: &'t Topology) -> AngleProblem<'t> {
    AngleProblem::new(topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk")
}

fn descend(mesh: &TriMesh, settings: Descent) -> DescentSolution {
    let topology = topology(mesh);
    let problem = problem(mesh, &topology);
    settings.solve(mesh, &problem, None, &StopCriteria::default(), &mut Silent).expect("a drawing")
}

/// Faces that do not turn left, by a predicate called here and not by the crate.
fn flips(mesh: &TriMesh, uv: &[Point2<f64>]) -> usize {
    let coord = |v: VertexId| Coord { x: uv[v.index()].x, y: uv[v.index()].y };
    mesh.faces().iter().filter(|f| !(orient2d(coord(f[0]), coord(f[1]), coord(f[2])) > 0.0)).count()
}

/// The shape pressed into the plane z = 0.
fn pressed(shape: Shape, triangles: usize) -> TriMesh {
    let mesh = shape.mesh(triangles);
    let flat: Vec<Point3<f64>> = mesh.positions().iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|f| f.map(VertexId::index)).collect();
    TriMesh::new(flat, &faces).expect("indices in range")
}

#[test]
fn every_shape_converges_without_a_flip() {
    for shape in Shape::ALL {
        let mesh = shape.mesh(1500);
        let solution = descend(&mesh, Descent::default());
        assert_eq!(solution.termination, Termination::Converged, "{}", shape.name());
        assert_eq!(flips(&mesh, &solution.uv), 0, "{}", shape.name());
        assert!(solution.area_matched);
    }
}

#[test]
fn the_objective_falls_in_every_step_of_one_barrier() {
    for shape in [Shape::SpikyField, Shape::Obtuse, Shape::Spike, Shape::Mask] {
        let history = descend(&shape.mesh(1000), Descent::default()).history;
        for pair in history.windows(2).filter(|pair| pair[0].barrier == pair[1].barrier) {
            assert!(pair[1].objective < pair[0].objective || pair[1].step_length == 0.0, "{}: {pair:?}", shape.name());
        }
        assert!(history.iter().all(|step| step.slope < 0.0 && step.smallest_angle > 0.0));
        assert!(history.iter().enumerate().all(|(i, step)| step.iteration == i + 1));
    }
}

#[test]
fn a_flat_mesh_comes_back_as_the_barrier_vanishes() {
    for mesh in [pressed(Shape::FatDisk, 600), pressed(Shape::BumpySheet, 600), Shape::FoldedSheet.mesh(600)] {
        let settings = Descent { barrier_floor: 1e-12, energy_tolerance: 1e-14, ..Descent::default() };
        let solution = descend(&mesh, settings);
        let error = solution.angles.iter().zip(mesh.corner_angles()).fold(0.0, |m, (x, a)| f64::max(m, (x - a).abs()));
        assert!(error < 1e-8, "{error} {:?}", solution.termination);
    }
}

#[test]
fn the_area_is_that_of_the_surface() {
    let mesh = Shape::Hemisphere.mesh(400);
    let solution = descend(&mesh, Descent::default());
    let uv = UvMap::per_vertex(&mesh, &solution.uv);
    assert!((uv.signed_area() / mesh.area() - 1.0).abs() < 1e-12);
}

#[test]
fn any_valid_drawing_is_a_start_and_leads_to_the_same_angles() {
    let mesh = Shape::Hemisphere.mesh(600);
    let topology = topology(&mesh);
    let problem = problem(&mesh, &topology);
    let solve = |start: Option<&[Point2<f64>]>| {
        let settings = Descent { energy_tolerance: 1e-12, ..Descent::default() };
        settings.solve(&mesh, &problem, start, &StopCriteria::default(), &mut Silent).expect("a drawing")
    };
    let embedded = solve(None);
    let squeezed: Vec<Point2<f64>> = embedded.uv.iter().map(|p| Point2::new(7.0 - p.y, 0.2 * p.x)).collect();
    let restarted = solve(Some(&squeezed));
    assert!(embedded.tutte.is_some() && restarted.tutte.is_none());
    let apart = embedded.angles.iter().zip(&restarted.angles).fold(0.0, |m, (x, y)| f64::max(m, (x - y).abs()));
    assert!(apart < 1e-5, "{apart}");
}

#[test]
fn a_map_without_a_seam_is_a_start() {
    let mesh = Shape::Pyramid.mesh(6);
    let topology = topology(&mesh);
    let embedding = tutte(&mesh, &topology).expect("a drawing");
    let map = UvMap::per_vertex(&mesh, &embedding.uv);
    assert_eq!(vertex_points(&topology, &map), Ok(embedding.uv));
    // Every corner a point of its own, the triangles apart.
    let apart = topology.corners().map(|c| Point2::new(c.index() as f64, c.place() as f64)).collect();
    let apart = UvMap::new(apart, (0..topology.corner_count()).map(UvId::new).collect());
    assert!(vertex_points(&topology, &apart).is_err());
}

#[test]
fn a_flipped_start_is_named() {
    let mesh = Shape::BumpySheet.mesh(200);
    let topology = topology(&mesh);
    let problem = problem(&mesh, &topology);
    let solve = |start: &[Point2<f64>]| {
        Descent::default().solve(&mesh, &problem, Some(start), &StopCriteria::default(), &mut Silent).unwrap_err()
    };
    let mut uv = tutte(&mesh, &topology).expect("a drawing").uv;
    assert_eq!(solve(&uv[1..]), EmbedError::PointCount { given: uv.len() - 1, vertices: uv.len() });
    let [a, b, _] = topology.face_vertices(FaceId::new(5));
    uv.swap(a.index(), b.index());
    assert!(matches!(solve(&uv), EmbedError::StartFlipped { count, .. } if count >= 1));
    uv[a.index()].x = f64::NAN;
    assert!(matches!(solve(&uv), EmbedError::StartFlipped { .. }));
}

#[test]
fn settings_out_of_range_are_named() {
    let mesh = Shape::Pyramid.mesh(6);
    let topology = topology(&mesh);
    let problem = problem(&mesh, &topology);
    let refused = |settings: Descent| {
        let stop = StopCriteria::default();
        settings.solve(&mesh, &problem, None, &stop, &mut Silent).expect_err("out of range").to_string()
    };
    let with = Descent::default();
    assert_eq!(refused(Descent { barrier_floor: 0.0, ..with }), "barrier_floor must be positive and finite, got 0");
    assert_eq!(refused(Descent { barrier_floor: 2.0, ..with }), "barrier_floor must be at most barrier_start, got 2");
    assert_eq!(refused(Descent { barrier_reduction: 1.0, ..with }), "barrier_reduction must be in (0, 1), got 1");
}

struct CancelAfter(usize);

impl Observer for CancelAfter {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        match event {
            Event::Iteration(record) if record.iteration >= self.0 => Verdict::Stop,
            _ => Verdict::Continue,
        }
    }
}

#[test]
fn a_cancelled_or_timed_out_descent_returns_a_valid_drawing() {
    let mesh = Shape::SpikyField.mesh(1000);
    let topology = topology(&mesh);
    let problem = problem(&mesh, &topology);
    let cancelled = Descent::default()
        .solve(&mesh, &problem, None, &StopCriteria::default(), &mut CancelAfter(2))
        .expect("a drawing");
    assert_eq!((cancelled.termination, cancelled.history.len()), (Termination::Cancelled, 2));
    assert_eq!(flips(&mesh, &cancelled.uv), 0);
    let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
    let late = Descent::default().solve(&mesh, &problem, None, &stop, &mut Silent).expect("a drawing");
    // Tutte's embedding as it is: it takes no step, and nothing is set up for one.
    assert_eq!((late.termination, late.history.len()), (Termination::TimeLimit, 0));
    assert!(late.tutte.is_some() && late.angles.iter().all(|&x| x > 0.0));
    assert_eq!(flips(&mesh, &late.uv), 0);
    let stop = StopCriteria { max_iterations: 3, ..StopCriteria::default() };
    let short = Descent::default().solve(&mesh, &problem, None, &stop, &mut Silent).expect("a drawing");
    assert_eq!((short.termination, short.history.len()), (Termination::MaxIterations, 3));
}

#[test]
fn the_bits_do_not_depend_on_the_threads() {
    let mesh = Shape::SpikyField.mesh(1500);
    let with = |threads| abf_parallel::with_threads(threads, || descend(&mesh, Descent::default())).expect("threads");
    let one = with(1);
    assert_eq!(one, with(1));
    assert_eq!(one, with(3));
}

#[test]
fn a_single_triangle_keeps_its_shape() {
    let points = [[0.0; 3], [2.0, 0.0, 1.0], [0.5, 1.0, 0.0]].map(Point3::from).to_vec();
    let mesh = TriMesh::new(points, &[[0, 1, 2]]).expect("indices in range");
    let solution = descend(&mesh, Descent { barrier_floor: 1e-12, energy_tolerance: 1e-14, ..Descent::default() });
    assert!(solution.angles.iter().zip(mesh.corner_angles()).all(|(x, a)| (x - a).abs() < 1e-9));
}

#[test]
fn vertices_without_faces_are_left_at_the_origin() {
    let sheet = Shape::BumpySheet.mesh(200);
    let mut points = sheet.positions().to_vec();
    points.insert(0, Point3::new(9.0, 9.0, 9.0));
    let faces: Vec<[usize; 3]> = sheet.faces().iter().map(|f| f.map(|v| v.index() + 1)).collect();
    let mesh = TriMesh::new(points, &faces).expect("indices in range");
    let solution = descend(&mesh, Descent::default());
    assert_eq!(flips(&mesh, &solution.uv), 0);
    assert_eq!(solution.uv[0], Point2::origin());
}
