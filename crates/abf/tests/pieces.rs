//! What every chart of an atlas is: valid, not over itself and within the aim, whatever the model; and what becomes of those
//! for which there is no time.

use abf::mesh::{Point3, TriMesh, VertexId};
use abf::{
    Boundary, Cancelled, Event, FlattenError, HoleRule, LinAbf, Observer, Pipeline, Silent, Stage, StopCriteria,
    SurfaceHints, Termination, Unwrap, Unwrapped, Verdict, flatten,
};
use abf_shapes::Shape;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::time::Duration;

fn mesh(points: &[[f64; 3]], faces: &[[usize; 3]]) -> TriMesh {
    TriMesh::new(points.iter().map(|&p| Point3::from(p)).collect(), faces).expect("indices in range")
}

/// The settings of an atlas.
fn atlas() -> Unwrap {
    Unwrap { cut_disks: true, ..Unwrap::default() }
}

/// Unwraps, and checks that nothing is lost and every chart is as it should be.
fn unwrap(settings: &Unwrap, mesh: &TriMesh) -> Unwrapped {
    let unwrapped = settings.run(mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
    assert_eq!(unwrapped.charts.iter().map(|c| c.faces.len()).sum::<usize>(), mesh.face_count());
    for chart in &unwrapped.charts {
        let l2 = chart.metrics.stretch_l2;
        assert!(chart.metrics.injective() && !chart.unfinished, "{:?}", chart.metrics);
        assert!(l2 <= settings.max_stretch, "L2 {l2}");
    }
    unwrapped
}

/// So many charts, and not an angle changed.
fn assert_exact(mesh: &TriMesh, most_charts: usize) -> Unwrapped {
    let unwrapped = unwrap(&atlas(), mesh);
    assert!(unwrapped.charts.len() <= most_charts, "{} charts", unwrapped.charts.len());
    for chart in &unwrapped.charts {
        assert!(chart.metrics.max_angle_error < 1e-8, "{} rad", chart.metrics.max_angle_error);
        assert!((chart.metrics.stretch_l2 - 1.0).abs() < 1e-10);
    }
    unwrapped
}

/// The surface of unit cubes, vertices shared.
fn cubes(cells: &[[i32; 3]]) -> TriMesh {
    let sides: [([i32; 3], [[i32; 3]; 4]); 6] = [
        ([1, 0, 0], [[1, 0, 0], [1, 1, 0], [1, 1, 1], [1, 0, 1]]),
        ([-1, 0, 0], [[0, 0, 0], [0, 0, 1], [0, 1, 1], [0, 1, 0]]),
        ([0, 1, 0], [[0, 1, 0], [0, 1, 1], [1, 1, 1], [1, 1, 0]]),
        ([0, -1, 0], [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]),
        ([0, 0, 1], [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]),
        ([0, 0, -1], [[0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]),
    ];
    let add = |a: [i32; 3], b: [i32; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let mut number: HashMap<[i32; 3], usize> = HashMap::new();
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for &cell in cells {
        for (beside, corners) in &sides {
            if cells.contains(&add(cell, *beside)) {
                continue;
            }
            let ids = corners.map(|corner| {
                let at = add(cell, corner);
                *number.entry(at).or_insert_with(|| {
                    points.push(at.map(f64::from));
                    points.len() - 1
                })
            });
            faces.extend([[ids[0], ids[1], ids[2]], [ids[0], ids[2], ids[3]]]);
        }
    }
    mesh(&points, &faces)
}

/// A tube of radius 1 with `n` sides and rings at these heights, open at both ends.
fn tube(n: usize, heights: &[f64], turn: f64) -> TriMesh {
    let is_closed = turn >= TAU;
    let columns = if is_closed { n } else { n + 1 };
    let point = |(&z, i): (&f64, usize)| {
        let angle = turn * i as f64 / n as f64;
        [angle.cos(), angle.sin(), z]
    };
    let points: Vec<_> = heights.iter().flat_map(|z| (0..columns).map(move |i| (z, i))).map(point).collect();
    let at = |row: usize, i: usize| row * columns + i % columns;
    let square = |(r, i)| [[at(r, i), at(r, i + 1), at(r + 1, i + 1)], [at(r, i), at(r + 1, i + 1), at(r + 1, i)]];
    let faces: Vec<_> = (1..heights.len()).flat_map(|r| (0..n).map(move |i| (r - 1, i))).flat_map(square).collect();
    mesh(&points, &faces)
}

/// A square plate with a round hole of `n` sides.
fn plate(n: usize) -> TriMesh {
    let ring = |r: f64| (0..n).map(move |i| (r, TAU * i as f64 / n as f64));
    let square = |(r, a): (f64, f64)| {
        let far = if r > 1.0 { r / a.cos().abs().max(a.sin().abs()) } else { r };
        [far * a.cos(), far * a.sin(), 0.0]
    };
    let points: Vec<_> = ring(0.5).chain(ring(2.0)).map(square).collect();
    let quad = |i: usize| {
        let j = (i + 1) % n;
        [[i, n + i, n + j], [i, n + j, j]]
    };
    mesh(&points, &(0..n).flat_map(quad).collect::<Vec<_>>())
}

/// A strip that winds around the z-axis, each turn above the one before.
fn ramp(turns: usize, per_turn: usize) -> TriMesh {
    let steps = turns * per_turn;
    let point = |i: usize, r: f64| {
        let angle = TAU * i as f64 / per_turn as f64;
        [r * angle.cos(), r * angle.sin(), 0.05 * angle]
    };
    let points: Vec<_> = (0..=steps).flat_map(|i| [point(i, 1.0), point(i, 2.0)]).collect();
    let quad = |i: usize| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
    mesh(&points, &(0..steps).flat_map(quad).collect::<Vec<_>>())
}

/// Two meshes in one file, apart.
fn beside(one: &TriMesh, other: &TriMesh) -> TriMesh {
    let n = one.vertex_count();
    let moved = other.positions().iter().map(|p| Point3::new(p.x + 100.0, p.y, p.z));
    let points = one.positions().iter().copied().chain(moved).collect();
    let ids = |mesh: &TriMesh, n: usize| mesh.faces().iter().map(|f| f.map(|v| n + v.index())).collect::<Vec<_>>();
    TriMesh::new(points, &[ids(one, 0), ids(other, n)].concat()).expect("indices in range")
}

/// Vertices and faces in another order, corners turned.
fn shuffled(mesh: &TriMesh, seed: usize) -> TriMesh {
    let order = |n: usize| {
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by_key(|&i| (i * 7919 + seed * 104_729) % 1_000_003 % 997);
        order
    };
    let vertices = order(mesh.vertex_count());
    let mut number = vec![0; vertices.len()];
    vertices.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    let points = vertices.iter().map(|&v| mesh.positions()[v]).collect();
    let turned = |f: usize| {
        let mut face = mesh.faces()[f].map(|v: VertexId| number[v.index()]);
        face.rotate_left((f + seed) % 3);
        face
    };
    let faces: Vec<_> = order(mesh.face_count()).into_iter().map(turned).collect();
    TriMesh::new(points, &faces).expect("indices in range")
}

/// Unit squares in the shape of an E, one thick.
fn letter_e() -> TriMesh {
    let rows = ["####", "#...", "###.", "#...", "####"];
    let cells: Vec<[i32; 3]> = (0..)
        .zip(rows)
        .flat_map(|(y, row)| (0..).zip(row.chars()).filter(|&(_, c)| c == '#').map(move |(x, _)| [x, y, 0]))
        .collect();
    cubes(&cells)
}

#[test]
fn thin_triangles_of_flat_sheets_keep_their_angles() {
    let n = 2000;
    let rim = (0..=n).map(|i| PI * f64::from(i) / f64::from(n)).map(|a| [a.cos(), a.sin(), 0.0]);
    let fan = mesh(
        &std::iter::once([0.0; 3]).chain(rim).collect::<Vec<_>>(),
        &(1..=n as usize).map(|i| [0, i, i + 1]).collect::<Vec<_>>(),
    );
    let strip = mesh(&[[0.0; 3], [1e4, 0.0, 0.0], [1e4, 1.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2], [0, 2, 3]]);
    // Triangles without a shape that a solver could keep.
    let zigzag: Vec<[f64; 3]> = (0..200).map(|i| [f64::from(i) / 2.0, f64::from(i % 2) * 1e-8, 0.0]).collect();
    let ends = |i: usize| if i.is_multiple_of(2) { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] };
    let shapeless = mesh(&zigzag, &(0..198).map(ends).collect::<Vec<_>>());
    let meshes =
        [("fan", fan), ("strip", strip), ("half tube", tube(180, &[0.0, 1000.0], PI)), ("shapeless", shapeless)];
    for (name, mesh) in meshes {
        let metrics = flatten(&mesh).expect("a flattening").metrics(&mesh).expect("metrics");
        assert!(metrics.injective() && metrics.stretch_l2 - 1.0 < 1e-10, "{name}: {}", metrics.stretch_l2);
    }
}

#[test]
fn thin_triangles_on_curved_sheets_are_bounded_where_that_is_better() {
    // A vertex of a bumpy sheet almost on another: not worse than with bounded angles.
    let sheet = Shape::BumpySheet.mesh(400);
    let [a, b, _] = sheet.faces()[sheet.face_count() / 2];
    let mut points = sheet.positions().to_vec();
    points[a.index()] = points[b.index()] + (points[a.index()] - points[b.index()]) * 1e-4;
    let faces: Vec<_> = sheet.faces().iter().map(|f| f.map(VertexId::index)).collect();
    let mesh = TriMesh::new(points, &faces).expect("indices in range");
    let bounded = abf::GuessSettings { keep_thin: false, ..abf::GuessSettings::default() };
    let l2 = |pipeline: Pipeline| {
        let flat = pipeline.run(&mesh, &mut Silent).expect("a flattening");
        flat.metrics(&mesh).expect("metrics").stretch_l2
    };
    let kept = l2(Pipeline::default());
    assert!(kept <= l2(Pipeline { initial_guess: bounded, ..Pipeline::default() }) * (1.0 + 1e-6), "{kept}");
}

/// A bumpy sheet of eight faces with a vertex almost on an edge of each. With their own angles the needles come out enlarged, and
/// everything else shrinks.
fn crowded() -> TriMesh {
    let points = [
        [0.0, 0.0, 0.0],
        [0.5, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.5, 0.0],
        [0.5, 0.5, -1.1700491],
        [1.0, 0.5, 0.49328287],
        [0.0, 1.0, 0.0],
        [0.5, 1.0, 1.8747547],
        [1.0, 1.0, -0.79038084],
        [0.12567078, 2.6299883e-6, 0.0],
        [0.49999737, 0.26621977, -0.62297424],
        [0.68417552, 2.6299883e-6, 2.5946563e-6],
        [0.68110853, 0.18111116, 0.17866932],
        [0.098978575, 0.50000263, -0.23160357],
        [0.16044137, 0.660444, 0.60157643],
        [0.88449436, 0.50000263, 0.10905044],
        [0.99999737, 0.90698782, -0.5515741],
    ];
    let faces = [
        [0, 1, 9],
        [1, 3, 9],
        [3, 0, 9],
        [1, 4, 10],
        [4, 3, 10],
        [3, 1, 10],
        [1, 2, 11],
        [2, 5, 11],
        [5, 1, 11],
        [1, 5, 12],
        [5, 4, 12],
        [4, 1, 12],
        [3, 4, 13],
        [4, 7, 13],
        [7, 3, 13],
        [3, 7, 14],
        [7, 6, 14],
        [6, 3, 14],
        [4, 5, 15],
        [5, 7, 15],
        [7, 4, 15],
        [5, 8, 16],
        [8, 7, 16],
        [7, 5, 16],
    ];
    mesh(&points, &faces)
}

#[test]
fn thin_triangles_that_crowd_out_the_rest_are_bounded() {
    let mesh = crowded();
    let flat = flatten(&mesh).expect("a flattening");
    let metrics = flat.metrics(&mesh).expect("metrics");
    assert!(metrics.valid() && metrics.stretch_l2 < 3.0, "{}", metrics.stretch_l2);
    assert_eq!(flat.rungs.len(), 2, "one with its own angles, one with bounded ones: {:?}", flat.rungs);
}

/// Gives one answer from the second solve on.
struct FromTheSecondSolve {
    answer: Verdict,
    solves: usize,
}

impl Observer for FromTheSecondSolve {
    fn observe(&mut self, event: Event<'_>) -> Verdict {
        self.solves += usize::from(matches!(event, Event::StageStarted(Stage::Solve)));
        if self.solves > 1 { self.answer } else { Verdict::Continue }
    }
}

#[test]
fn what_is_stopped_in_its_second_solve_keeps_the_first_map_and_what_is_aborted_has_none() {
    let circle = Pipeline { boundary: Boundary::Circle, ..Pipeline::default() };
    let linabf = Pipeline { solver: LinAbf::default().into(), ..Pipeline::default() };
    for (pipeline, mesh) in
        [(Pipeline::default(), crowded()), (linabf, crowded()), (circle, Shape::BumpySheet.mesh(200))]
    {
        let answered = |answer| pipeline.run(&mesh, &mut FromTheSecondSolve { answer, solves: 0 });
        let stopped = answered(Verdict::Stop).expect("the first map");
        assert_eq!(stopped.termination, Termination::Cancelled);
        assert!(stopped.certificate.valid());
        assert_eq!(answered(Verdict::Abort).expect_err("aborted"), FlattenError::Cancelled(Cancelled));
    }
}

#[test]
fn boxes_and_letters_unfold_without_changing_an_angle() {
    assert_exact(&cubes(&[[0, 0, 0]]), 1);
    assert_exact(&letter_e(), 2);
    let open: Vec<[usize; 3]> = cubes(&[[0, 0, 0]]).faces()[2..].iter().map(|f| f.map(VertexId::index)).collect();
    let room = TriMesh::new(cubes(&[[0, 0, 0]]).positions().to_vec(), &open).expect("indices in range");
    assert_exact(&room, 1);
}

#[test]
fn seams_of_hard_surfaces_run_along_creases() {
    let mesh = letter_e();
    let unwrapped = assert_exact(&mesh, 2);
    for [a, b] in &unwrapped.seams {
        let [p, q] = [a, b].map(|v| mesh.positions()[v.index()]);
        assert!((q - p).norm() < 1.1, "a diagonal of a face is a seam");
    }
}

#[test]
fn many_cubes_and_rough_cells_are_exact_however_many_charts_that_takes() {
    let scattered: Vec<[i32; 3]> = (0..60).map(|i| [3 * (i % 5), 3 * (i / 5 % 4), 3 * (i / 20)]).collect();
    assert_exact(&cubes(&scattered), 60);
    // Every second cell of two layers on a full one: no two meet at an edge alone.
    let floor = (0..8).flat_map(|x| (0..8).map(move |y| [x, y, 0]));
    let towers = (0..4).flat_map(|x| (0..4).flat_map(move |y| [[2 * x, 2 * y, 1], [2 * x, 2 * y, 2]]));
    let mesh = cubes(&floor.chain(towers).collect::<Vec<_>>());
    assert!(assert_exact(&mesh, 40).charts.len() > 1);
}

#[test]
fn open_tubes_are_cut_and_unroll_exactly() {
    for mesh in [tube(6, &[0.0, 2.0], TAU), tube(32, &[0.0, 2.0], TAU), tube(32, &[0.0, 0.5, 1.0, 1.5, 2.0], TAU)] {
        assert_exact(&mesh, 1);
    }
}

#[test]
fn a_hole_in_a_plate_stays_a_hole() {
    let unwrapped = assert_exact(&plate(48), 1);
    assert!(unwrapped.seams.is_empty() && unwrapped.charts[0].holes_filled == 0);
}

#[test]
fn disks_inside_a_model_are_cut_like_everything_else() {
    let dome = Shape::Hemisphere.mesh(600);
    let alone = Unwrap::default().run(&dome, &SurfaceHints::default(), &mut Silent).expect("charts");
    assert!(alone.seams.is_empty(), "a file that is one disk stays whole");
    let tight = Unwrap { max_stretch: 1.02, ..Unwrap::default() };
    assert!(alone.charts[0].metrics.stretch_l2 > tight.max_stretch);
    let unwrapped = unwrap(&tight, &beside(&dome, &cubes(&[[0, 0, 0]])));
    assert!(!unwrapped.seams.is_empty());
}

#[test]
fn a_ramp_of_many_turns_ends_in_parts_that_do_not_lie_over_themselves() {
    // More parts than any cap there was.
    let unwrapped = unwrap(&atlas(), &ramp(80, 12));
    assert!(unwrapped.charts.len() >= 64, "{}", unwrapped.charts.len());
}

#[test]
fn the_order_of_vertices_and_faces_does_not_decide_the_seams_of_hard_surfaces() {
    let floor = (0..5).flat_map(|x| (0..4).map(move |y| [x, y, 0]));
    let mesh = cubes(&floor.chain([[1, 1, 1], [3, 2, 1], [3, 2, 2]]).collect::<Vec<_>>());
    let first = assert_exact(&mesh, 20);
    for seed in 1..20 {
        let again = assert_exact(&shuffled(&mesh, seed), 20);
        assert_eq!(again.charts.len(), first.charts.len(), "seed {seed}");
        assert!((again.seam_length / first.seam_length - 1.0).abs() < 0.01, "seed {seed}");
    }
}

/// Cancels after so many events.
struct After(usize);

impl Observer for After {
    fn observe(&mut self, _: Event<'_>) -> Verdict {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { Verdict::Stop } else { Verdict::Continue }
    }
}

fn assert_all_there(unwrapped: &Unwrapped, mesh: &TriMesh, end: Termination) {
    assert_eq!(unwrapped.charts.iter().map(|c| c.faces.len()).sum::<usize>(), mesh.face_count());
    assert!(unwrapped.charts.iter().all(|chart| chart.metrics.valid()));
    let unfinished: Vec<_> = unwrapped.charts.iter().filter(|chart| chart.unfinished).collect();
    assert!(!unfinished.is_empty() && unfinished.iter().all(|chart| chart.termination == end));
    assert!(!unwrapped.is_certified());
}

#[test]
fn who_cancels_gets_a_valid_map_of_everything() {
    let mesh = beside(&Shape::Hemisphere.mesh(900), &cubes(&[[0, 0, 0]]));
    let tight = Unwrap { max_stretch: 1.005, ..Unwrap::default() };
    for events in [1, 5, 20] {
        let unwrapped = tight.run(&mesh, &SurfaceHints::default(), &mut After(events)).expect("charts");
        assert_all_there(&unwrapped, &mesh, Termination::Cancelled);
    }
}

#[test]
fn without_time_there_is_a_valid_map_of_everything() {
    let mesh = beside(&Shape::Hemisphere.mesh(900), &cubes(&[[0, 0, 0]]));
    let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
    let settings = Unwrap { pipeline: Pipeline { stop, ..Pipeline::default() }, ..Unwrap::default() };
    let unwrapped = settings.run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
    assert_all_there(&unwrapped, &mesh, Termination::TimeLimit);
}

#[test]
fn one_chart_that_a_solver_cannot_do_is_parted_and_no_file_is_lost() {
    // One iteration of Newton's method converges nowhere but on what is flat.
    let stop = StopCriteria { max_iterations: 1, ..StopCriteria::default() };
    let solver = "abf-newton".parse().expect("a solver");
    let pipeline = Pipeline { solver, stop, ..Pipeline::default() };
    let mesh = beside(&Shape::Hemisphere.mesh(900), &cubes(&[[0, 0, 0]]));
    let unwrapped = unwrap(&Unwrap { pipeline, ..Unwrap::default() }, &mesh);
    assert!(unwrapped.charts.len() > 2);
}

#[test]
fn every_rule_for_holes_keeps_the_aim() {
    let mesh = beside(&plate(24), &tube(12, &[0.0, 1.0, 2.0], TAU));
    for holes in ["auto", "fill", "fill-fan", "cut", "free"] {
        let holes: HoleRule = holes.parse().expect("a rule");
        unwrap(&Unwrap { holes, ..Unwrap::default() }, &mesh);
    }
}

/// A face that no map brings within the aim cannot be parted either: it stays as it is, and nothing goes around in circles.
#[test]
fn a_sliver_of_one_face_ends_as_a_chart_of_its_own() {
    for height in [4e-7, 1e-9] {
        let sliver = mesh(&[[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.4, height, 0.0]], &[[0, 1, 2]]);
        let two =
            mesh(&[[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.4, height, 0.0], [5.6, -height, 0.0]], &[[0, 1, 2], [1, 0, 3]]);
        for (thin, faces) in [(&sliver, 13), (&two, 14)] {
            let unwrapped =
                unwrap(&Unwrap { cut_disks: true, ..Unwrap::default() }, &beside(&cubes(&[[0, 0, 0]]), thin));
            let charts = unwrapped.charts.iter().map(|chart| chart.faces.len()).sum::<usize>();
            assert_eq!(charts, faces, "height {height}");
        }
    }
}
