//! Maps whose distortion is known in closed form, and maps with something wrong with them.

mod support;

use abf_mesh::{FaceId, Point2, Point3, TriMesh, UvMap};
use abf_metrics::{FaceDistortion, Metrics, MetricsError, Orientation, measure, per_face};
use std::f64::consts::FRAC_PI_4;
use support::{mesh, per_vertex, sheet, uv_map};

fn measured(mesh: &TriMesh, uv: &UvMap) -> Metrics {
    measure(mesh, uv).expect("a mesh with UVs")
}

#[track_caller]
fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} instead of {expected}");
}

#[track_caller]
fn assert_no_distortion(m: &Metrics) {
    assert!(m.valid() && m.certificate.near_collapsed == 0 && m.degenerate_3d == 0, "{m:?}");
    for zero in [m.f, m.f_weighted, m.max_angle_error, m.area_l2] {
        assert!(zero.abs() < 1e-12, "{m:?}");
    }
    for one in [m.stretch_l2, m.stretch_linf, m.qc_mean, m.qc_max] {
        assert_near(one, 1.0);
    }
}

/// The unit square of two triangles.
fn square() -> TriMesh {
    sheet(1, |_, _| 0.0)
}

#[test]
fn an_isometry_has_no_distortion() {
    // A sheet bent along x only, unrolled: every square keeps its side along y and its slanted one.
    let bent = sheet(5, |x, _| if x % 2.0 == 0.0 { 0.0 } else { 0.75 });
    let m = measured(&bent, &per_vertex(&bent, |p| [1.25 * p.x, p.y]));
    assert_no_distortion(&m);
    assert_eq!((m.triangles, m.certificate.charts), (50, 1));
    assert_near(m.surface_area, 5.0 * 6.25);
    assert_near(m.uv_area, 5.0 * 6.25);
}

#[test]
fn a_similarity_has_no_distortion() {
    let flat = sheet(4, |_, _| 3.0);
    let m = measured(&flat, &per_vertex(&flat, |p| [4.0 - 3.0 * p.y, 3.0 * p.x + 7.0]));
    assert_no_distortion(&m);
    assert_near(m.uv_area, 9.0 * m.surface_area);
}

#[test]
fn an_affine_stretch_has_the_values_of_its_singular_values() {
    let flat = sheet(3, |_, _| 0.0);
    let m = measured(&flat, &per_vertex(&flat, |p| [2.0 * p.x, 0.5 * p.y]));
    assert_near(m.stretch_l2, ((4.0 + 0.25) / 2.0_f64).sqrt());
    assert_near(m.stretch_linf, 2.0);
    assert_near(m.qc_mean, 4.0);
    assert_near(m.qc_max, 4.0);
    assert_near(m.area_l2, 0.0);
    // The right angle stays, one angle of 45° becomes atan ¼, the other as much larger.
    let error = FRAC_PI_4 - 0.25_f64.atan();
    assert_near(m.f, 2.0 * error.powi(2) / 3.0);
    assert_near(m.f_weighted, 2.0 * (error / FRAC_PI_4).powi(2) / 3.0);
    assert_near(m.max_angle_error, error);
}

#[test]
fn charts_of_different_scale_have_area_distortion_and_no_angle_error() {
    let m = measured(
        &square(),
        &uv_map(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [5.0, 0.0], [7.0, 2.0], [5.0, 2.0]], &[[0, 1, 2], [3, 4, 5]]),
    );
    // Areas ½ and ½ become ½ and 2: the mean scale is 5/2.
    assert_eq!(m.certificate.charts, 2);
    assert_near(m.area_l2, ((0.4_f64.ln().powi(2) + 1.6_f64.ln().powi(2)) / 2.0).sqrt());
    assert_near(m.stretch_l2, ((1.0 + 0.25) / 2.0 * 2.5_f64).sqrt());
    assert_near(m.stretch_linf, 2.5_f64.sqrt());
    assert_near(m.qc_max, 1.0);
    assert_near(m.f, 0.0);
}

#[test]
fn a_seam_does_not_change_the_figures() {
    let flat = square();
    let whole = per_vertex(&flat, |p| [2.0 * p.x + p.y, p.y]);
    // The second triangle stands elsewhere: where it stood, equal UVs would join it to the first.
    let shift = |corner: usize| if corner < 3 { 0.0 } else { 4.0 };
    let every_corner: Vec<[f64; 2]> =
        whole.triangles().flatten().enumerate().map(|(c, p)| [p.x + shift(c), p.y]).collect();
    let cut_open = uv_map(&every_corner, &[[0, 1, 2], [3, 4, 5]]);
    let (whole, mut cut_open) = (measured(&flat, &whole), measured(&flat, &cut_open));
    assert_eq!(cut_open.certificate.charts, 2);
    cut_open.certificate.charts = 1;
    assert_eq!(cut_open, whole);
}

#[test]
fn a_vertex_pulled_over_an_edge_flips_the_triangle_at_that_edge() {
    // A square fanned around its centre; the centre of the map lies beyond the right side.
    let fan = mesh(
        &[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.0]],
        &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    );
    let m = measured(&fan, &per_vertex(&fan, |p| if p.x == 1.0 { [3.0, 1.0] } else { [p.x, p.y] }));
    assert_eq!((m.certificate.flips, m.certificate.collapsed, m.certificate.near_collapsed), (1, 0, 0));
    assert_eq!(m.certificate.flipped_faces, [FaceId::new(1)]);
    assert!(!m.valid());
    assert_near(m.uv_area, 1.0 + 3.0 + 1.0 + 1.0);
    assert!(m.stretch_l2.is_finite() && m.stretch_linf.is_finite());
    let signs: Vec<i8> = faces_of(&fan, [3.0, 1.0]).iter().map(|o| o.sign()).collect();
    assert_eq!(signs, [1, -1, 1, 1]);
}

/// How the faces of a fan lie when its centre goes to `centre`.
fn faces_of(fan: &TriMesh, centre: [f64; 2]) -> Vec<Orientation> {
    let map = per_vertex(fan, |p| if p.x == 1.0 { centre } else { [p.x, p.y] });
    per_face(fan, &map).expect("a mesh with UVs").iter().map(|face| face.orientation).collect()
}

#[test]
fn a_collapsed_triangle_is_invalid_and_its_stretch_infinite() {
    let m = measured(&square(), &uv_map(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.3, 0.3]], &[[0, 1, 2], [0, 2, 3]]));
    assert_eq!((m.certificate.flips, m.certificate.collapsed, m.certificate.near_collapsed), (0, 1, 0));
    assert_eq!(m.certificate.collapsed_faces, [FaceId::new(1)]);
    assert!(!m.valid());
    for infinite in [m.stretch_l2, m.stretch_linf, m.qc_mean, m.qc_max, m.area_l2] {
        assert_eq!(infinite, f64::INFINITY);
    }
    assert!(m.f.is_finite() && m.f_weighted.is_finite());
}

#[test]
fn a_triangle_within_rounding_of_a_line_is_valid_but_counted() {
    let map = |y: f64| uv_map(&[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.5, y]], &[[0, 1, 2], [0, 2, 3]]);
    let above = measured(&square(), &map(1.5_f64.next_up()));
    assert_eq!((above.certificate.flips, above.certificate.collapsed, above.certificate.near_collapsed), (0, 0, 1));
    assert!(above.valid());
    assert_eq!(above.stretch_l2, f64::INFINITY);
    let on = measured(&square(), &map(1.5));
    assert_eq!((on.certificate.flips, on.certificate.collapsed, on.certificate.near_collapsed), (0, 1, 0));
    let below = measured(&square(), &map(1.5_f64.next_down()));
    assert_eq!((below.certificate.flips, below.certificate.collapsed, below.certificate.near_collapsed), (1, 0, 0));
}

#[test]
fn a_map_to_one_point_is_measured_not_refused() {
    let m = measured(&square(), &per_vertex(&square(), |_| [0.25, -1.0]));
    assert_eq!((m.certificate.flips, m.certificate.collapsed, m.certificate.near_collapsed), (0, 2, 0));
    assert_eq!((m.stretch_l2, m.area_l2, m.uv_area), (f64::INFINITY, f64::INFINITY, 0.0));
    assert_eq!(m, measured(&square(), &per_vertex(&square(), |_| [0.0, 0.0])));
}

#[test]
fn a_chart_mirrored_as_a_whole_is_not_flipped() {
    let m = measured(
        &square(),
        &uv_map(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [5.0, 0.0], [4.0, 1.0], [5.0, 1.0]], &[[0, 1, 2], [3, 4, 5]]),
    );
    assert_eq!((m.certificate.charts, m.certificate.flips), (2, 0));
    assert_no_distortion(&m);
}

/// Two strips of `count` squares each, one over the other; the upper one has its lower side at these heights.
fn two_strips(count: usize, heights: impl Fn(usize) -> f64) -> Metrics {
    let lower = (0..=count).flat_map(|i| [[i as f64, 0.0], [i as f64, 1.0]]);
    let upper = (0..=count).flat_map(|i| [[i as f64, heights(i)], [i as f64, 2.0]]);
    let flat: Vec<[f64; 2]> = lower.chain(upper).collect();
    let square = |a: usize| [[a, a + 2, a + 3], [a, a + 3, a + 1]];
    let faces: Vec<[usize; 3]> =
        (0..2).flat_map(|strip| (0..count).flat_map(move |i| square(2 * (strip * (count + 1) + i)))).collect();
    let positions: Vec<[f64; 3]> = flat.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    measured(&mesh(&positions, &faces), &uv_map(&flat, &faces))
}

#[test]
fn sides_that_cross_within_rounding_are_touches_and_deeper_ones_are_overlaps() {
    // The largest coordinate is 8: one unit in the last place is 8 ε.
    let unit = 8.0 * f64::EPSILON;
    let zigzag = |depth: f64| two_strips(8, move |i| if i % 2 == 0 { 1.0 + depth } else { 1.0 - depth });
    let touching = zigzag(unit);
    assert_eq!((touching.certificate.crossings, touching.injective()), (0, true), "{touching:?}");
    assert!(
        touching.certificate.touches >= 8
            && touching.certificate.touch_depth > 0.0
            && touching.certificate.touch_depth <= 4.0 * unit
    );
    assert!(!zigzag(64.0 * unit).injective());
    assert!(!zigzag(0.1).injective());
    assert_eq!(two_strips(8, |_| 1.0).certificate.touch_depth, 0.0);
}

/// Two triangles with a corner at the origin: one up to the x-axis, the other from these points on.
fn two_corners(from: [f64; 2], to: [f64; 2]) -> Metrics {
    let flat = [[0.0, 0.0], [0.0, 8.0], [8.0, 0.0], [0.0, 0.0], from, to];
    let positions: Vec<[f64; 3]> = (0..6).map(|i| [flat[i][0], flat[i][1], (i / 3) as f64]).collect();
    let faces = [[0, 2, 1], [3, 4, 5]];
    measured(&mesh(&positions, &faces), &uv_map(&flat, &faces))
}

#[test]
fn sectors_over_each_other_within_rounding_are_touches_and_deeper_ones_are_overlaps() {
    let unit = 8.0 * f64::EPSILON;
    let beside = two_corners([0.0, -8.0], [8.0, 0.0]).certificate;
    assert_eq!((beside.meetings, beside.touches, beside.touch_depth), (0, 2, 0.0));
    // Its last side has sunk into the other triangle by one unit.
    let touching = two_corners([0.0, -8.0], [7.0, unit]).certificate;
    assert_eq!((touching.meetings, touching.injective()), (0, true), "{touching:?}");
    assert!(touching.touch_depth > 0.0 && touching.touch_depth <= 4.0 * unit);
    assert!(!two_corners([0.0, -8.0], [7.0, 64.0 * unit]).injective());
    assert!(!two_corners([0.0, -8.0], [7.0, 1.0]).injective());
    // Two of the sides are on one line, and the sectors lie over each other by a right angle.
    assert!(!two_corners([7.0, 0.0], [0.0, 7.0]).injective());
    // A needle inside of the other.
    assert!(!two_corners([4.0, 4.0], [4.0 - unit, 4.0]).injective());
}

/// Four triangles around the origin, from the x-axis on to this point.
fn once_around(to: [f64; 2]) -> Metrics {
    let flat = [[0.0, 0.0], [8.0, 0.0], [0.0, 8.0], [-8.0, 0.0], [0.0, -8.0], to];
    let positions = flat.map(|[x, y]| [x, y, 0.0]);
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
    measured(&mesh(&positions, &faces), &uv_map(&flat, &faces))
}

#[test]
fn a_slit_whose_sides_cross_within_rounding_is_a_touch_and_one_that_closes_further_is_an_overlap() {
    let unit = 8.0 * f64::EPSILON;
    assert!(once_around([7.0, 0.0]).injective());
    let touching = once_around([7.0, unit]).certificate;
    assert_eq!((touching.meetings, touching.crossings, touching.injective()), (0, 0, true), "{touching:?}");
    assert!(touching.touches > 0 && touching.touch_depth > 0.0 && touching.touch_depth <= 4.0 * unit);
    for height in [64.0 * unit, 1.0, 20.0] {
        assert!(!once_around([7.0, height]).injective(), "{height}");
    }
}

#[test]
fn a_deep_overlap_that_begins_within_rounding_is_none_of_the_touches() {
    // The side sinks slowly into the other strip: both ends of the lens are shallow, its middle is not.
    let unit = 8.0 * f64::EPSILON;
    let lens = two_strips(8, move |i| match i {
        0 | 8 => 1.0 + unit,
        1 | 7 => 1.0 - unit,
        _ => 0.75,
    });
    assert!(lens.certificate.crossings > 0 && !lens.injective(), "{lens:?}");
    // Two squares on each other, moved by one unit.
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let moved = square.map(|[x, y]| [x + f64::EPSILON, y + f64::EPSILON]);
    let faces = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let flat: Vec<[f64; 2]> = square.into_iter().chain(moved).collect();
    let positions: Vec<[f64; 3]> = (0..8).map(|i| [flat[i][0], flat[i][1], (i / 4) as f64]).collect();
    assert!(!measured(&mesh(&positions, &faces), &uv_map(&flat, &faces)).injective());
}

#[test]
fn a_face_without_area_in_space_is_left_out_of_the_distortion() {
    let mut positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0]];
    let faces = [[0, 1, 2], [0, 2, 3], [0, 4, 1]];
    let uv = uv_map(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, -0.5]], &faces);
    let m = measured(&mesh(&positions, &faces), &uv);
    assert_eq!((m.degenerate_3d, m.certificate.flips, m.certificate.collapsed), (1, 0, 0));
    assert!(m.f < 1e-30 && (m.qc_max - 1.0).abs() < 1e-12, "{m:?}");
    // Its UV area still belongs to the map: 5/4 against 1.
    assert_near(m.stretch_linf, 1.25_f64.sqrt());
    // A face of three equal points is no different.
    positions[4] = [0.0; 3];
    let mut pinched = measured(&mesh(&positions, &[[0, 1, 2], [0, 2, 3], [0, 4, 0]]), &uv);
    // But it is joined to its neighbour no more.
    assert_eq!((pinched.certificate.touches, pinched.injective()), (2, true));
    pinched.certificate = m.certificate.clone();
    assert_eq!(pinched, m);
}

#[test]
fn a_small_component_beside_a_large_one_is_judged_by_its_own_area() {
    // A tenth of a millimetre beside a kilometre: a share of 1e-14 of the whole, and no less a triangle.
    let tiny = [[500.0, 500.0, 50.0], [500.0001, 500.0, 50.0], [500.0, 500.0001, 50.0]];
    let positions = [&[[0.0; 3], [1000.0, 0.0, 0.0], [1000.0, 1000.0, 0.0], [0.0, 1000.0, 0.0]][..], &tiny].concat();
    let faces = [[0, 1, 2], [0, 2, 3], [4, 5, 6]];
    let flat: Vec<[f64; 2]> = positions.iter().map(|p| [p[0], p[1]]).collect();
    let m = measured(&mesh(&positions, &faces), &uv_map(&flat, &faces));
    assert_eq!(m.degenerate_3d, 0);
    // One of three points on a line has no shape, whichever component it is.
    let line = [[0.1, 0.2, 50.0], [0.2, 0.4, 50.0], [0.3, 0.6, 50.0]];
    let positions = [&positions[..4], &line].concat();
    assert_eq!(measured(&mesh(&positions, &faces), &uv_map(&flat, &faces)).degenerate_3d, 1);
}

#[test]
fn only_the_first_offenders_are_listed_but_all_are_counted() {
    // Every second face is turned over, and those are the smaller ones.
    let flat = sheet(5, |_, _| 0.0);
    let mut points = vec![[0.0, 0.0], [1.0, 0.0]];
    let mut faces = Vec::new();
    for f in 0..flat.face_count() {
        points.push(if f % 2 == 0 { [0.5, 2.0] } else { [0.5, -1.0] });
        faces.push([0, 1, f + 2]);
    }
    let m = measured(&flat, &uv_map(&points, &faces));
    assert_eq!(m.certificate.flips, 25);
    let listed: Vec<usize> = m.certificate.flipped_faces.iter().map(|f| f.index()).collect();
    assert_eq!(listed, (0..Metrics::LISTED).map(|i| 2 * i + 1).collect::<Vec<_>>());
}

#[test]
fn a_closed_surface_and_an_edge_of_three_faces_are_measured_too() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let tetrahedron = mesh(&points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    let m = measured(&tetrahedron, &per_vertex(&tetrahedron, |p| [p.x - 0.2 * p.z, p.y - 0.3 * p.z]));
    assert_eq!((m.certificate.charts, m.certificate.flips), (1, 1), "three faces cover the fourth from the other side");
    let book = mesh(&points, &[[0, 1, 2], [0, 1, 3], [1, 0, 2]]);
    assert_eq!(measured(&book, &per_vertex(&book, |p| [p.x, p.y + 2.0 * p.z])).triangles, 3);
}

#[cfg(feature = "serde")]
#[test]
fn json_holds_indices_and_null_for_infinity() {
    let m = measured(&square(), &uv_map(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5]], &[[0, 1, 2], [0, 2, 3]]));
    let json = serde_json::to_value(&m).expect("plain data");
    assert_eq!(json["collapsed_faces"], serde_json::json!([1]));
    assert_eq!(json["flipped_faces"], serde_json::json!([]));
    assert!(json["stretch_l2"].is_null());
    assert_eq!(json["collapsed"], 1);
}

#[test]
fn the_sums_are_those_of_the_faces() {
    let bumpy = sheet(6, |x, y| (1.3 * x).sin() * (0.7 * y).cos());
    let uv = per_vertex(&bumpy, |p| [p.x + 0.2 * p.y * p.y, p.y - 0.1 * p.x * p.y]);
    let (m, faces) = (measured(&bumpy, &uv), per_face(&bumpy, &uv).expect("a mesh with UVs"));
    assert_near(faces.iter().map(|f| f.surface_share).sum(), 1.0);
    assert_near(faces.iter().map(|f| f.surface_share * f.area_ratio).sum(), 1.0);
    assert_near(faces.iter().map(|f| f.surface_share * f.stretch_l2.powi(2)).sum::<f64>().sqrt(), m.stretch_l2);
    assert_eq!(faces.iter().map(|f| f.stretch_linf).fold(0.0, f64::max), m.stretch_linf);
    let squares = faces.iter().flat_map(FaceDistortion::angle_errors).map(|e| e * e).sum::<f64>();
    assert_near(squares / (3 * faces.len()) as f64, m.f);
    let angles: Vec<f64> = faces.iter().flat_map(|f| f.mesh_angles).collect();
    for (found, expected) in angles.iter().zip(bumpy.corner_angles()) {
        assert_near(*found, expected);
    }
}

#[test]
fn what_cannot_be_measured_is_said() {
    let flat = square();
    let uv = per_vertex(&flat, |p| [p.x, p.y]);
    let refused = |mesh: &TriMesh, uv: &UvMap| measure(mesh, uv).expect_err("nothing to measure");

    assert_eq!(refused(&mesh(&[], &[]), &UvMap::new(vec![], vec![])), MetricsError::NoFaces);
    assert_eq!(refused(&sheet(2, |_, _| 0.0), &uv), MetricsError::CornerCount { corners: 6, faces: 8 });
    let line = sheet(1, |_, _| 0.0).positions().iter().map(|p| Point3::new(p.x, p.x, p.x)).collect();
    let line = TriMesh::new(line, &[[0, 1, 2], [1, 2, 3]]).expect("indices in range");
    assert_eq!(refused(&line, &uv), MetricsError::NoArea { faces: 2 });

    let not_finite = uv.clone().mapped(|p| if p.y == 0.0 && p.x == 1.0 { Point2::new(f64::NAN, 0.0) } else { p });
    let e = refused(&flat, &not_finite);
    assert_eq!(e, MetricsError::UvNotFinite { first: FaceId::new(0), count: 1 });
    assert_eq!(e.to_string(), "face 0 has a UV that is not finite (1 in all)");
    let not_finite = sheet(1, |x, _| if x == 0.0 { f64::INFINITY } else { 0.0 });
    assert_eq!(refused(&not_finite, &uv), MetricsError::PositionNotFinite { first: FaceId::new(0), count: 2 });
}
