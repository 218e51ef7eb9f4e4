use super::*;
use crate::AtlasPages;
use abf_mesh::{Point3, UvId};
use abf_metrics::MetricsError;
use abf_pack::PackError;

type Outline = Vec<[f64; 2]>;

/// Convex islands that share no vertex: each a fan in the plane, and the same fan as UVs.
fn fans(islands: &[Outline]) -> (TriMesh, UvMap) {
    let (mut positions, mut faces, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for ring in islands {
        let first = positions.len();
        positions.extend(ring.iter().map(|p| Point3::new(p[0], p[1], 0.0)));
        for k in 1..ring.len() - 1 {
            faces.push([first, first + k, first + k + 1]);
            corners.extend([first, first + k, first + k + 1].map(UvId::new));
        }
    }
    let points = islands.iter().flatten().map(|&p| Point2::from(p)).collect();
    (TriMesh::new(positions, &faces).expect("indices in range"), UvMap::new(points, corners))
}

fn quad(x: f64, y: f64, w: f64, h: f64) -> Outline {
    vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
}

fn turned(ring: &Outline, degrees: f64, by: [f64; 2]) -> Outline {
    let (sin, cos) = degrees.to_radians().sin_cos();
    ring.iter().map(|[x, y]| [cos * x - sin * y + by[0], sin * x + cos * y + by[1]]).collect()
}

fn run(repack: Repack, islands: &[Outline]) -> Repacked {
    let (mesh, uv) = fans(islands);
    repack.run(&mesh, &uv, None, Stored::default()).expect("packed")
}

/// A right triangle with three different sides.
fn flag() -> Outline {
    vec![[0.0, 0.0], [3.0, 0.0], [0.0, 1.0]]
}

#[test]
fn islands_keep_their_shape_and_their_scale_beside_each_other() {
    let islands = [quad(0.0, 0.0, 1.0, 0.5), turned(&flag(), 20.0, [5.0, 5.0]), quad(-7.0, 1.0, 0.1, 3.0)];
    let (mesh, uv) = fans(&islands);
    let packed = run(Repack::default(), &islands);
    assert_eq!((packed.islands, packed.pieces, packed.pages), (3, 3, 1));
    assert!(packed.metrics.injective());
    for face in 0..mesh.face_count() {
        let [before, after] = [&uv, &packed.uv].map(|map| map.triangle(FaceId::new(face)));
        for (i, k) in [(0, 1), (1, 2), (2, 0)] {
            let scale = (after[i] - after[k]).norm() / (before[i] - before[k]).norm();
            assert!((scale * 1024.0 / packed.texels_per_unit - 1.0).abs() < 1e-9, "face {face}: {scale}");
        }
    }
    let area: f64 = packed.uv.area();
    assert!((packed.coverage - area).abs() < 1e-9, "{} {area}", packed.coverage);
}

#[test]
fn islands_that_lie_over_each_other_stay_together_and_those_that_touch_do_not() {
    let lower = quad(0.0, 0.0, 1.0, 1.0);
    let islands =
        [lower, quad(0.5, 0.5, 1.0, 1.0), quad(1.5, 0.5, 1.0, 1.0), quad(9.0, 9.0, 0.2, 0.2), quad(9.0, 9.0, 0.1, 0.1)];
    let packed = run(Repack::default(), &islands);
    assert_eq!((packed.islands, packed.pieces), (5, 3));
    let at = |i: usize| packed.placements[i];
    assert!(at(0) == at(1) && at(3) == at(4) && at(1) != at(2));
    assert!(packed.metrics.certificate.overlaps() > 0, "they did before");
    // What two cover counts once.
    let scale = packed.texels_per_unit / 1024.0;
    let expected = (1.75 + 1.0 + 0.04) * scale * scale;
    assert!((packed.coverage / expected - 1.0).abs() < 2e-3, "{} {expected}", packed.coverage);
}

#[test]
fn islands_of_one_shape_are_laid_upon_each_other_if_asked() {
    let mirrored: Outline = flag().into_iter().map(|[x, y]| [-x, y]).collect();
    let islands = [
        flag(),
        turned(&flag(), 77.0, [20.0, 3.0]),
        turned(&mirrored, 10.0, [40.0, 0.0]),
        turned(&flag(), 200.0, [60.0, 0.0]),
        vec![[80.0, 0.0], [83.0, 0.0], [80.0, 1.1]],
    ];
    let packed = run(Repack { stack: true, ..Repack::default() }, &islands);
    assert_eq!(packed.stacked_on, [None, Some(0), None, Some(0), None]);
    assert_eq!(packed.pieces, 3);
    for i in 0..3 {
        assert_eq!(packed.uv.points()[i], packed.uv.points()[3 + i], "to the bit");
    }
    assert!(packed.metrics.injective(), "each shape is judged once");
    let apart = run(Repack::default(), &islands);
    assert!(apart.pieces == 5 && apart.texels_per_unit < packed.texels_per_unit);
}

#[test]
fn a_square_is_stacked_however_it_is_cut_and_turned() {
    let square = quad(0.0, 0.0, 1.0, 1.0);
    let shifted: Outline = square.iter().copied().cycle().skip(1).take(4).collect();
    let packed = run(Repack { stack: true, ..Repack::default() }, &[square, turned(&shifted, 33.0, [7.0, 7.0])]);
    assert_eq!(packed.stacked_on, [None, Some(0)]);
}

#[test]
fn islands_in_one_place_are_one_piece_and_thousands_take_no_time() {
    let islands = |count: u32| (0..count).map(|i| quad(1e-9 * f64::from(i), 0.0, 1.0, 1.0)).collect::<Vec<_>>();
    let packed = run(Repack::default(), &islands(200));
    assert_eq!((packed.islands, packed.pieces), (200, 1));
    assert!(packed.coverage > 0.98, "{}", packed.coverage);
    // Pair by pair this would be a billion comparisons.
    let (mesh, uv) = fans(&islands(30_000));
    let mut sets = abf_mesh::DisjointSets::new(30_000);
    overlapping::overlapping(&uv, &abf_metrics::charts(&mesh, &uv).expect("charts"), &mut sets);
    assert!((0..30_000).all(|i| sets.find(i) == 0));
}

#[test]
fn overlapping_islands_of_very_different_sizes_are_found() {
    let small = |i: u32| quad(0.37 + 1e-3 * f64::from(i), 0.41, 5e-4, 5e-4);
    let mut islands = vec![quad(0.0, 0.0, 1.0, 1.0), quad(3.0, 0.0, 1.0, 1.0)];
    islands.extend((0..300).map(small));
    let packed = run(Repack::default(), &islands);
    assert_eq!(packed.pieces, 2);
}

#[test]
fn islands_share_pages_as_they_are_asked_to() {
    let islands = [quad(0.0, 0.0, 1.0, 1.0), quad(5.0, 0.0, 1.0, 1.0), quad(9.0, 0.0, 1.0, 1.0)];
    let (mesh, uv) = fans(&islands);
    let on = |pages| {
        let atlas = Atlas { pages, ..Atlas::default() };
        let repack = Repack { atlas, stack: true };
        repack.run(&mesh, &uv, Some(&[7, 7, 2, 2, 7, 7]), Stored::default()).expect("packed")
    };
    let by_material = on(AtlasPages::PerMaterial);
    assert_eq!((by_material.pages, &by_material.stacked_on[..]), (2, &[None, None, Some(0)][..]));
    assert_eq!(by_material.placements.iter().map(|placed| placed.page).collect::<Vec<_>>(), [0, 1, 0]);
    assert_eq!(on(AtlasPages::PerComponent).pages, 3);
}

#[test]
fn what_cannot_be_packed_anew_is_refused_by_name() {
    let (mesh, uv) = fans(&[quad(0.0, 0.0, 1.0, 1.0), quad(0.0, 0.0, 1.0, 1.0), quad(5.0, 5.0, 1.0, 1.0)]);
    let with =
        |atlas: Atlas, uv: &UvMap| Repack { atlas, stack: false }.run(&mesh, uv, None, Stored::default()).unwrap_err();
    let error = with(Atlas::default(), &uv.clone().mapped(|p| if p.x > 5.5 { Point2::new(f64::NAN, p.y) } else { p }));
    assert!(matches!(error, AtlasError::Metrics(MetricsError::UvNotFinite { count: 2, .. })), "{error}");
    let fixed = |texels: f64, max_pages| Atlas { texels_per_unit: Some(texels), max_pages, ..Atlas::default() };
    let error = with(fixed(2000.0, 1), &uv);
    assert!(matches!(error, AtlasError::Pack(PackError::PieceTooLarge { .. })), "{error}");
    let error = with(fixed(1000.0, 1), &uv);
    assert!(matches!(error, AtlasError::Pack(PackError::TooManyPages { pages: 1, .. })), "{error}");
    let (mesh_of_one, _) = fans(&[quad(0.0, 0.0, 1.0, 1.0)]);
    let error = Repack::default().run(&mesh_of_one, &uv, None, Stored::default()).unwrap_err();
    assert!(matches!(error, AtlasError::Metrics(MetricsError::CornerCount { .. })), "{error}");
}

#[test]
fn both_sides_of_a_leaf_on_the_same_texels_are_no_overlap() {
    // Two leaves of one shape; the back of the second has UV points of its own.
    let points =
        [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 0.0, 0.0], [12.0, 0.0, 0.0], [9.0, 1.0, 0.0]];
    let faces = [[0, 1, 2], [0, 2, 1], [3, 4, 5], [3, 5, 4]];
    let mesh = TriMesh::new(points.map(Point3::from).to_vec(), &faces).expect("indices in range");
    let places = [0, 1, 2, 3, 4, 5, 3, 5, 4].map(|v| Point2::new(points[v][0], points[v][1]));
    let corners = [0, 1, 2, 0, 2, 1, 3, 4, 5, 6, 7, 8].map(UvId::new);
    let uv = UvMap::new(places.to_vec(), corners.to_vec());
    for stack in [false, true] {
        let packed = Repack { stack, ..Repack::default() }.run(&mesh, &uv, None, Stored::default()).expect("packed");
        assert_eq!((packed.islands, packed.overlapping, packed.shared), (2, 0, 2));
        assert!(packed.metrics.injective() && packed.metrics.triangles == 2, "{:?}", packed.metrics);
        assert_eq!(packed.pieces, if stack { 1 } else { 2 });
        for (own, upon) in [(6, 3), (7, 5), (8, 4)] {
            assert_eq!(packed.uv.points()[own], packed.uv.points()[upon], "the back lies on the front");
        }
        let judged = crate::judge(&mesh, &packed.uv, &crate::JudgeSettings::default()).expect("a judgement");
        assert_eq!(judged.shared, 2);
        assert_eq!(judged.metrics.certificate.overlaps() > 0, stack);
    }
}

#[test]
fn islands_by_the_thousand_that_reach_into_each_other_are_packed_without_counting_all_overlaps() {
    let islands: Vec<Outline> = (0..4000).map(|i| quad(1e-5 * f64::from(i), 2e-5 * f64::from(i), 1.0, 1.0)).collect();
    let packed = run(Repack::default(), &islands);
    assert_eq!((packed.islands, packed.pieces, packed.overlapping), (4000, 1, 4000));
    assert!(packed.metrics.certificate.overlaps_are_least && packed.metrics.certificate.overlaps() > 4_000_000);
}
