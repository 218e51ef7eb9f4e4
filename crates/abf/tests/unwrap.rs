//! Any mesh in: what comes out, and how it maps back.

use abf::cut::HoleFilling;
use abf::mesh::{CornerId, FaceId, Point3, Topology, TriMesh, UvId, UvMap, VertexId};
use abf::{DoubleSided, Weld};
use abf::{
    Event, FlattenError, HoleRule, Observer, Pipeline, SeamRule, Silent, SurfaceHints, Unwrap, UnwrapError, Unwrapped,
    Verdict,
};
use abf_shapes::{Shape, loop_subdivide};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn mesh(points: &[[f64; 3]], faces: &[[usize; 3]]) -> TriMesh {
    TriMesh::new(points.iter().map(|&p| Point3::from(p)).collect(), faces).expect("indices in range")
}

/// `m` steps around the hole, `n` around the tube.
fn torus(m: usize, n: usize) -> TriMesh {
    let point = |i: usize, j: usize| {
        let (u, v) = (TAU * i as f64 / m as f64, TAU * j as f64 / n as f64);
        let r = 3.0 + v.cos();
        [r * u.cos(), r * u.sin(), v.sin()]
    };
    let points: Vec<_> = (0..m).flat_map(|i| (0..n).map(move |j| point(i, j))).collect();
    let at = |i: usize, j: usize| (i % m) * n + j % n;
    let square = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let faces: Vec<_> = (0..m).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(square).collect();
    mesh(&points, &faces)
}

/// An octahedron subdivided to 512 faces.
fn ball() -> TriMesh {
    let points =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let top = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let octahedron = mesh(&points, &[top, top.map(|[a, b, _]| [b, a, 5])].concat());
    (0..3).fold(octahedron, |mesh, _| loop_subdivide(&mesh))
}

fn indices(mesh: &TriMesh) -> Vec<[usize; 3]> {
    mesh.faces().iter().map(|face| face.map(VertexId::index)).collect()
}

fn with_faces(mesh: &TriMesh, faces: &[[usize; 3]]) -> TriMesh {
    TriMesh::new(mesh.positions().to_vec(), faces).expect("indices in range")
}

fn unwrap(mesh: &TriMesh) -> Unwrapped {
    with(&Unwrap::default(), mesh)
}

/// Unwraps, and checks what holds of every result.
fn with(settings: &Unwrap, mesh: &TriMesh) -> Unwrapped {
    let unwrapped = settings.run(mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
    check(&unwrapped, mesh);
    unwrapped
}

fn check(unwrapped: &Unwrapped, mesh: &TriMesh) {
    assert!(unwrapped.is_certified());
    let mut seen = vec![0; mesh.face_count()];
    let uv = unwrapped.uv();
    for chart in &unwrapped.charts {
        assert!(chart.faces.is_sorted());
        for (i, face) in chart.faces.iter().enumerate() {
            seen[face.index()] += 1;
            assert_eq!(chart.uv.triangle(FaceId::new(i)), uv.triangle(*face));
        }
        let area: f64 = chart
            .faces
            .iter()
            .map(|&f| {
                let [a, b, c] = mesh.triangle(f);
                0.5 * (b - a).cross(&(c - a)).norm()
            })
            .sum();
        assert!((chart.metrics.uv_area / area - 1.0).abs() < 1e-9, "{} against {area}", chart.metrics.uv_area);
    }
    unwrapped.followers.iter().for_each(|(c, _)| seen[c.face().index()] += usize::from(c.place() == 0));
    assert!(seen.iter().all(|&times| times == 1), "every face is in one chart, or follows one");
}

#[test]
fn a_clean_disk_comes_out_as_the_pipeline_flattens_it() {
    let disk = Shape::Mask.mesh(400);
    let unwrapped = unwrap(&disk);
    let flat = Pipeline::default().run(&disk, &mut Silent).expect("a flattening");
    assert_eq!(unwrapped.uv(), flat.uv);
    assert_eq!(unwrapped.charts.len(), 1);
    assert_eq!(unwrapped.charts[0].metrics, flat.metrics(&disk).expect("metrics"));
    assert!(unwrapped.seams.is_empty() && unwrapped.repairs.is_clean());
}

#[test]
fn a_disk_is_cut_further_when_that_is_asked_for() {
    let disk = with_faces(&ball(), &indices(&ball())[1..]);
    assert!(unwrap(&disk).seams.is_empty());
    let cut = with(&Unwrap { cut_disks: true, ..Unwrap::default() }, &disk);
    assert!(!cut.seams.is_empty());
    assert!(cut.charts.iter().all(|chart| chart.metrics.stretch_l2 < 1.15));
    let short = with(&Unwrap { cut_disks: true, max_seam: Some(0.5), ..Unwrap::default() }, &disk);
    assert!(short.seam_length < cut.seam_length);
}

#[test]
fn a_ball_and_a_torus_come_out_with_little_stretch() {
    for (mesh, stretch) in [(ball(), 1.15), (torus(24, 16), 1.15)] {
        let unwrapped = unwrap(&mesh);
        assert!(unwrapped.charts.iter().all(|c| c.metrics.stretch_l2 < stretch && c.metrics.injective()));
        assert!(unwrapped.seam_length > 0.0 && unwrapped.diagonal > 0.0);
        assert!(unwrapped.charts.iter().map(|c| c.seam_length).sum::<f64>() >= unwrapped.seam_length * (1.0 - 1e-12));
    }
}

#[test]
fn the_same_bits_come_out_whatever_the_number_of_threads() {
    let mesh = two_balls();
    let with = |threads| abf_parallel::with_threads(threads, || unwrap(&mesh).uv()).expect("threads");
    assert_eq!(with(1), with(4));
}

/// A ball and a torus, apart.
fn two_balls() -> TriMesh {
    let (ball, torus) = (ball(), torus(12, 8));
    let n = ball.vertex_count();
    let points = ball.positions().iter().chain(torus.positions()).copied().collect();
    let faces: Vec<_> = indices(&ball).into_iter().chain(indices(&torus).iter().map(|f| f.map(|v| n + v))).collect();
    TriMesh::new(points, &faces).expect("indices in range")
}

#[test]
fn components_are_charts_of_their_own_and_are_put_where_asked() {
    let mesh = two_balls();
    let unwrapped = unwrap(&mesh);
    let components: Vec<usize> = unwrapped.charts.iter().map(|c| c.component).collect();
    assert_eq!((components[0], components[components.len() - 1]), (0, 1));
    let placed = unwrapped.assemble(|chart, p| p + abf::mesh::Vector2::new(1000.0 * chart as f64, 0.0));
    let (first, last) = (unwrapped.charts[0].faces[0], unwrapped.charts[components.len() - 1].faces[0]);
    assert_eq!(placed.triangle(first), unwrapped.uv().triangle(first));
    assert!(placed.triangle(last)[0].x > 900.0);
}

#[test]
fn dropped_faces_go_with_their_twins_and_turned_ones_keep_their_corners() {
    let disk = Shape::Mask.mesh(200);
    let clean = unwrap(&disk).uv();
    let mut faces = indices(&disk);
    let [a, b, c] = faces[7];
    faces.push([c, b, a]);
    faces.push([a, a, b]);
    let mesh = with_faces(&disk, &faces);
    let settings = Unwrap { double_sided: DoubleSided::Shared, ..Unwrap::default() };
    let uv = settings.run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts").uv();
    let (twin, point) = (FaceId::new(faces.len() - 2), FaceId::new(faces.len() - 1));
    let [p, q, r] = clean.triangle(FaceId::new(7));
    assert_eq!(uv.triangle(twin), [r, q, p]);
    assert_eq!(uv.triangle(FaceId::new(7)), [p, q, r]);
    let at = uv.triangle(point);
    assert!(at[0] == at[1] && at[1] == at[2]);

    let mut faces = indices(&disk);
    faces[3].swap(0, 2);
    let uv = unwrap(&with_faces(&disk, &faces)).uv();
    let corner_of = |map: &UvMap, face: usize, vertex: usize, faces: &[[usize; 3]]| {
        let place = faces[face].iter().position(|&v| v == vertex).expect("a corner");
        map.corner(FaceId::new(face).corner(place))
    };
    for v in faces[3] {
        let distance = (corner_of(&uv, 3, v, &faces) - corner_of(&clean, 3, v, &indices(&disk))).norm();
        assert!(distance < 1e-6, "{distance}");
    }
}

#[test]
fn a_strict_run_refuses_what_it_would_have_to_repair() {
    let mut faces = indices(&ball());
    faces[5].swap(0, 1);
    let strict = Unwrap { strict: true, ..Unwrap::default() };
    let error = strict.run(&with_faces(&ball(), &faces), &SurfaceHints::default(), &mut Silent).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the mesh is not clean, and a strict run repairs nothing: 1 face turned around (the first at 5)"
    );
    with(&strict, &ball());
}

#[test]
fn holes_are_filled_cut_or_left() {
    let disk = Shape::Mask.mesh(800);
    let topology = Topology::build(disk.vertex_count(), disk.faces()).expect("a manifold");
    // A hole around an interior vertex whose ring is inside, too.
    let is_inner = |v: VertexId| topology.fan(v).all(|c| topology.is_interior(topology.vertex(c.next())));
    let middle = topology.vertices().find(|&v| topology.is_interior(v) && is_inner(v)).expect("a vertex");
    let kept: Vec<_> = indices(&disk).into_iter().filter(|face| !face.contains(&middle.index())).collect();
    let holed = with_faces(&disk, &kept);
    for filling in [HoleFilling::Fan, HoleFilling::Ears] {
        let filled = with(&Unwrap { holes: HoleRule::Fill(filling), ..Unwrap::default() }, &holed);
        assert_eq!((filled.charts[0].holes_filled, filled.charts.len()), (1, 1));
        assert!(filled.charts[0].virtual_faces > 0);
        assert!(filled.charts[0].layout_error.expect("angles") < 1e-6);
    }
    let cut = with(&Unwrap { holes: HoleRule::Cut, ..Unwrap::default() }, &holed);
    assert!(!cut.seams.is_empty() && cut.charts[0].holes_filled == 0);
    let free = with(&Unwrap { holes: HoleRule::Free, max_stretch: 2.0, ..Unwrap::default() }, &holed);
    assert!(free.seams.is_empty());
}

#[test]
fn kept_seams_are_those_that_were_there() {
    let mesh = torus(16, 12);
    let first = unwrap(&mesh);
    let uv = first.uv();
    let keep = Unwrap { seams: SeamRule::Keep, ..Unwrap::default() };
    let again =
        keep.run(&mesh, &SurfaceHints { uv: Some(&uv), ..SurfaceHints::default() }, &mut Silent).expect("charts");
    check(&again, &mesh);
    assert_eq!(again.seams, first.seams);

    // Two halves, each a tube, which is cut once more.
    let labels: Vec<u32> = (0..mesh.face_count()).map(|f| u32::from(f >= mesh.face_count() / 2)).collect();
    let hints = SurfaceHints { face_labels: Some(&labels), ..SurfaceHints::default() };
    let halves = Unwrap { holes: HoleRule::Cut, ..keep }.run(&mesh, &hints, &mut Silent).expect("charts");
    check(&halves, &mesh);
    assert_eq!(halves.charts.iter().map(|c| c.component).max(), Some(1));
    assert!(halves.charts.iter().all(|chart| chart.faces.iter().all(|f| labels[f.index()] == chart.component as u32)));
}

#[test]
fn forbidden_edges_are_no_seams() {
    let mesh = torus(16, 12);
    let forbidden: Vec<bool> = (0..3 * mesh.face_count())
        .map(CornerId::new)
        .map(|c| if c.face().index().is_multiple_of(2) { c.place() == 1 } else { c.place() == 2 })
        .collect();
    let settings = Unwrap { part_overlaps: false, ..Unwrap::default() };
    let hints = SurfaceHints { forbidden: Some(&forbidden), ..SurfaceHints::default() };
    let unwrapped = settings.run(&mesh, &hints, &mut Silent).expect("charts");
    check(&unwrapped, &mesh);
    let is_diagonal = |edge: &[VertexId; 2]| {
        let [a, b] = edge.map(VertexId::index);
        a / 12 != b / 12 && a % 12 != b % 12
    };
    assert!(!unwrapped.seams.iter().any(is_diagonal));
}

/// A ball of 2048 faces, with limbs so many radii long along three axes.
fn with_limbs(lengths: [f64; 3]) -> TriMesh {
    let ball = loop_subdivide(&ball());
    let moved = |p: &Point3<f64>| {
        let n = p.coords.normalize();
        let limb = |(axis, length): (usize, f64)| length * (-(n[axis].clamp(-1.0, 1.0).acos() / 0.45).powi(2)).exp();
        let r = 1.0 + lengths.into_iter().enumerate().map(limb).sum::<f64>();
        [r * n.x, r * n.y, r * n.z]
    };
    mesh(&ball.positions().iter().map(moved).collect::<Vec<_>>(), &indices(&ball))
}

#[test]
fn a_seam_that_meets_the_aim_grows_by_one_cut_that_takes_most_of_the_stretch_away() {
    for lengths in [[3.0, 2.0, 1.0], [3.2, 2.1, 1.0], [3.0, 2.0, 0.8]] {
        let unwrapped = unwrap(&with_limbs(lengths));
        assert_eq!(unwrapped.charts.len(), 1);
        // Before that cut it is 1.13, and the seam 1.7 diagonals long.
        let l2 = unwrapped.charts[0].metrics.stretch_l2;
        assert!(l2 < 1.06, "{lengths:?}: {l2}");
        assert!(unwrapped.seam_length < 2.4 * unwrapped.diagonal, "{}", unwrapped.seam_length / unwrapped.diagonal);
    }
}

/// A flat ramp, `turns` times around in `steps` quads each, four wide: a map of it lies over itself.
fn ramp(turns: usize, steps: usize) -> TriMesh {
    let point = |i: usize, j: usize| {
        let (s, c) = (TAU * i as f64 / steps as f64).sin_cos();
        let r = 1.0 + j as f64;
        [r * c, r * s, 0.1 * i as f64 / steps as f64]
    };
    let rows = turns * steps;
    let points: Vec<_> = (0..=rows).flat_map(|i| (0..5).map(move |j| point(i, j))).collect();
    let at = |i: usize, j: usize| 5 * i + j;
    let square = |(i, j)| [[at(i, j), at(i, j + 1), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i + 1, j)]];
    mesh(&points, &(0..rows).flat_map(|i| (0..4).map(move |j| (i, j))).flat_map(square).collect::<Vec<_>>())
}

#[test]
fn polygons_stay_whole_where_a_chart_that_lies_over_itself_is_taken_apart() {
    for (turns, steps) in [(2, 24), (3, 16), (2, 9)] {
        let mesh = ramp(turns, steps);
        let triangles: Vec<_> = mesh.faces().iter().map(|face| face.map(|v| v.index() as u32)).collect();
        // Quads; then every row is one polygon.
        for of_polygon in [2, 8] {
            let polygons: Vec<u32> = (0..triangles.len() as u32).map(|f| f / of_polygon).collect();
            let inside = SurfaceHints::corners_inside(&triangles, &polygons);
            let hints = SurfaceHints { forbidden: Some(&inside), ..SurfaceHints::default() };
            let settings = Unwrap { cut_disks: true, ..Unwrap::default() };
            let unwrapped = settings.run(&mesh, &hints, &mut Silent).expect("charts");
            check(&unwrapped, &mesh);
            assert!(unwrapped.charts.len() > 1 && unwrapped.charts.iter().all(|chart| chart.metrics.injective()));
            for (polygon, chart) in
                unwrapped.charts.iter().flat_map(|chart| chart.faces.iter().map(move |f| (f, chart)))
            {
                let first = polygon.index() / of_polygon as usize * of_polygon as usize;
                let is_in = |f: usize| chart.faces.binary_search(&FaceId::new(f)).is_ok();
                assert!((first..first + of_polygon as usize).all(is_in), "{turns} turns, a polygon of {of_polygon}");
            }
        }
    }
}

#[test]
fn what_does_not_fit_is_named() {
    let mesh = ball();
    let run = |settings: Unwrap, hints: &SurfaceHints<'_>| settings.run(&mesh, hints, &mut Silent).unwrap_err();
    let none = SurfaceHints::default();
    let said = run(Unwrap { max_stretch: 0.5, ..Unwrap::default() }, &none).to_string();
    assert_eq!(said, "max_stretch must be at least 1, got 0.5");
    let labels = [0; 3];
    let said = run(Unwrap::default(), &SurfaceHints { face_labels: Some(&labels), ..none }).to_string();
    assert_eq!(said, "3 face labels, but the mesh has 512");
    let uv = UvMap::new(vec![abf::mesh::Point2::origin()], vec![UvId::new(0); 3]);
    assert!(matches!(run(Unwrap::default(), &SurfaceHints { uv: Some(&uv), ..none }), UnwrapError::Hint { .. }));
    for rule in ["auto", "fill", "fill-fan", "fill-ears", "cut", "free"] {
        let read: HoleRule = rule.parse().expect("a rule");
        assert_eq!(read.to_string().parse(), Ok(read));
    }
    assert!("cork".parse::<HoleRule>().is_err() && "none".parse::<SeamRule>().is_err());
    assert_eq!("keep".parse(), Ok(SeamRule::Keep));
}

#[test]
fn an_observer_can_cancel() {
    struct Never;
    impl Observer for Never {
        fn observe(&mut self, _: Event<'_>) -> Verdict {
            Verdict::Stop
        }
    }
    let unwrapped = Unwrap::default().run(&ball(), &SurfaceHints::default(), &mut Never).expect("charts");
    assert!(unwrapped.charts.iter().all(|chart| chart.unfinished && chart.metrics.valid()));
    let disk = Shape::Mask.mesh(400);
    let error = Unwrap::default().run(&disk, &SurfaceHints::default(), &mut Never).unwrap_err();
    assert!(matches!(error, UnwrapError::Chart { source: FlattenError::Cancelled(_), .. }), "a lone disk");
}

proptest! {
    #[test]
    fn any_faces_at_all_come_to_charts_or_to_a_reason(
        faces in prop::collection::vec([0..9_usize, 0..9, 0..9], 1..40),
        places in prop::collection::vec([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], 9),
    ) {
        let mesh = mesh(&places, &faces);
        if let Ok(unwrapped) = Unwrap::default().run(&mesh, &SurfaceHints::default(), &mut Silent) {
            prop_assert_eq!(unwrapped.uv().corners().len(), 3 * mesh.face_count());
            let in_charts: usize = unwrapped.charts.iter().map(|c| c.faces.len()).sum();
            prop_assert_eq!(in_charts + unwrapped.followers.len() / 3, mesh.face_count());
        }
    }
}

#[test]
fn coordinates_at_the_ends_of_the_range_are_no_hindrance() {
    let mesh = ball();
    for scale in [1e-200, 1e200] {
        let points = mesh.positions().iter().map(|p| p * scale).collect();
        let far = TriMesh::new(points, &indices(&mesh)).expect("indices in range");
        let unwrapped = Unwrap::default().run(&far, &SurfaceHints::default(), &mut Silent).expect("charts");
        assert!(unwrapped.is_certified());
    }
}

/// The same triangles with vertices of their own.
fn soup(mesh: &TriMesh) -> TriMesh {
    let faces: Vec<[usize; 3]> = (0..mesh.face_count()).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    TriMesh::new(mesh.triangles().flatten().collect(), &faces).expect("indices in range")
}

#[test]
fn a_soup_is_unwrapped_as_its_welded_twin_and_keeps_its_vertices() {
    let ball = ball();
    let soup = soup(&ball);
    // The soup with shared vertices, in its order: seams choose among equal ways by the order of vertices.
    let first = |v: VertexId| soup.positions().iter().position(|p| *p == soup.positions()[v.index()]).expect("itself");
    let shared: Vec<[usize; 3]> = soup.faces().iter().map(|face| face.map(first)).collect();
    let twin = with_faces(&soup, &shared);
    let run = |mesh: &TriMesh, weld| {
        let settings = Unwrap { weld, ..Unwrap::default() };
        settings.run(mesh, &SurfaceHints::default(), &mut Silent).expect("charts")
    };
    let (whole, joined) = (run(&twin, Weld::Off), run(&soup, Weld::Auto));
    assert_eq!(joined.uv(), whole.uv());
    assert_eq!((joined.charts.len(), joined.seam_length), (whole.charts.len(), whole.seam_length));
    assert_eq!(joined.repairs.joined_vertices.count, soup.vertex_count() - ball.vertex_count());
    assert_eq!(whole.repairs.joined_vertices.count, 0);
    assert_eq!(run(&soup, Weld::Off).charts.len(), soup.face_count());
}

#[test]
fn kept_seams_include_those_that_doubled_vertices_make() {
    let twin = ball();
    let soup = soup(&twin);
    let keep = Unwrap { seams: SeamRule::Keep, ..Unwrap::default() };
    let kept = keep.run(&soup, &SurfaceHints::default(), &mut Silent).expect("charts");
    assert_eq!(kept.charts.len(), soup.face_count());
    assert_eq!(kept.repairs.joined_vertices.count, soup.vertex_count() - twin.vertex_count());
}

/// The same with a unit square, a component of its own.
fn with_square_beside(strip: &TriMesh) -> TriMesh {
    let first = strip.vertex_count();
    let mut points: Vec<[f64; 3]> = strip.positions().iter().map(|p| [p.x, p.y, p.z]).collect();
    points.extend([[0.0, 5.0, 0.0], [1.0, 5.0, 0.0], [1.0, 6.0, 0.0], [0.0, 6.0, 0.0]]);
    let mut faces = indices(strip);
    faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    mesh(&points, &faces)
}

#[test]
fn a_long_chart_is_parted_where_it_would_set_the_density_of_all_and_only_in_an_atlas() {
    // A strip of 400 × 1 squares.
    let points: Vec<[f64; 3]> = (0..802).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
    let square = |i: usize| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
    let strip = mesh(&points, &(0..400).flat_map(square).collect::<Vec<_>>());
    let whole = unwrap(&strip);
    assert_eq!((whole.charts.len(), whole.parted), (1, 0), "a disk that asks for no atlas");
    let in_atlas = Unwrap { cut_disks: true, ..Unwrap::default() };
    let alone = with(&in_atlas, &strip);
    assert_eq!((alone.charts.len(), alone.parted), (1, 0), "a disk that is all there is");
    let strip = with_square_beside(&strip);
    let parted = with(&in_atlas, &strip);
    // A page is √(401 / 0.5) wide.
    assert_eq!((parted.charts.len(), parted.parted), (16, 1));
    assert_eq!(parted.charts.iter().map(|chart| chart.faces.len()).sum::<usize>(), 802);
    assert!(parted.charts.iter().all(|chart| chart.metrics.injective() && chart.metrics.stretch_l2 < 1.0 + 1e-9));
    let unlimited = Unwrap { max_chart_length: None, ..in_atlas.clone() };
    assert_eq!(with(&unlimited, &strip).charts.len(), 2);
    // Diagonals of squares are no seams.
    let diagonal = |f: usize| if f.is_multiple_of(2) { [false, true, false] } else { [false, false, true] };
    let diagonals: Vec<bool> = (0..802).flat_map(diagonal).collect();
    let hints = SurfaceHints { forbidden: Some(&diagonals), ..SurfaceHints::default() };
    let kept = in_atlas.run(&strip, &hints, &mut Silent).expect("charts");
    assert!(kept.charts.len() > 2 && kept.charts.iter().all(|chart| chart.faces.len() % 2 == 0));
}

#[test]
fn a_long_chart_of_large_polygons_is_parted_between_them_whatever_the_order_of_their_triangles() {
    let points: Vec<[f64; 3]> = (0..802).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
    // Triangle t of the strip is the face 7 t mod 800. Ten squares in a row are a polygon.
    let triangle = |t: usize| {
        let a = t / 2 * 2;
        if t.is_multiple_of(2) { [a, a + 2, a + 3] } else { [a, a + 3, a + 1] }
    };
    let mut faces = vec![[0; 3]; 800];
    (0..800).for_each(|t| faces[7 * t % 800] = triangle(t));
    let strip = with_square_beside(&mesh(&points, &faces));
    // The corners that face the diagonal, and the next or the last square.
    let is_inside =
        |t: usize| if t.is_multiple_of(2) { [t % 20 != 18, true, false] } else { [false, t % 20 != 1, true] };
    let mut inside = vec![false; 2406];
    (0..800).for_each(|t| inside[3 * (7 * t % 800)..][..3].copy_from_slice(&is_inside(t)));
    let hints = SurfaceHints { forbidden: Some(&inside), ..SurfaceHints::default() };
    let in_atlas = Unwrap { cut_disks: true, max_chart_length: Some(2.0), ..Unwrap::default() };
    let parted = in_atlas.run(&strip, &hints, &mut Silent).expect("charts");
    assert!(parted.parted == 1 && parted.charts.len() > 2, "{} charts", parted.charts.len());
    let is_whole = |faces: usize| faces == 2 || faces.is_multiple_of(20);
    assert!(parted.charts.iter().all(|chart| is_whole(chart.faces.len()) && chart.metrics.injective()));
}

#[test]
fn a_flat_disk_keeps_angles_that_no_solver_starts_from() {
    for width in [1e4, 1e6] {
        let points = [[0.0, 0.0, 3.0], [width, 0.0, 3.0], [width, 1.0, 3.0], [0.0, 1.0, 3.0]];
        let rectangle = mesh(&points, &[[0, 1, 2], [0, 2, 3]]);
        let flat = with(&Unwrap { cut_disks: true, ..Unwrap::default() }, &rectangle);
        assert_eq!(flat.charts.len(), 1);
        let metrics = &flat.charts[0].metrics;
        assert!(metrics.injective() && metrics.stretch_linf < 1.0 + 1e-12, "{width}: L∞ {}", metrics.stretch_linf);
    }
}
