//! No figure depends on where the UVs are, how they are turned, or how large they are.

mod support;

use abf_mesh::{Point2, TriMesh, UvMap, VertexId};
use abf_metrics::{Metrics, measure};
use proptest::prelude::*;
use support::{Noise, sheet, uv_map};

/// A bumpy sheet whose map is shaken so much that some triangles flip.
fn shaken(seed: u64, amplitude: f64) -> (TriMesh, UvMap) {
    let mut noise = Noise(seed);
    let heights: Vec<f64> = (0..100).map(|_| noise.next()).collect();
    let mesh = sheet(7, |x, y| heights[(8.0 * x + y) as usize]);
    let points: Vec<Point2<f64>> = mesh
        .positions()
        .iter()
        .map(|p| Point2::new(p.x + amplitude * noise.next(), p.y + amplitude * noise.next()))
        .collect();
    let map = UvMap::per_vertex(&mesh, &points);
    (mesh, map)
}

fn measured(mesh: &TriMesh, uv: &UvMap) -> Metrics {
    measure(mesh, uv).expect("a mesh with UVs")
}

/// Compares everything but the area of the map.
fn assert_same(found: &Metrics, expected: &Metrics, tolerance: f64) {
    let counts = |m: &Metrics| {
        (
            m.triangles,
            m.certificate.charts,
            m.certificate.flips,
            m.certificate.collapsed,
            m.certificate.near_collapsed,
            m.degenerate_3d,
        )
    };
    assert_eq!(counts(found), counts(expected));
    assert_eq!(found.certificate.flipped_faces, expected.certificate.flipped_faces);
    let figures = |m: &Metrics| {
        [m.f, m.f_weighted, m.max_angle_error, m.stretch_l2, m.stretch_linf, m.qc_mean, m.qc_max, m.area_l2]
    };
    for (a, b) in figures(found).into_iter().zip(figures(expected)) {
        assert!((a - b).abs() <= tolerance * b.abs(), "{a} instead of {b} in {found:?}");
    }
}

#[test]
fn no_figure_depends_on_the_scale_of_the_uvs() {
    let (mesh, uv) = shaken(5, 0.6);
    let expected = measured(&mesh, &uv);
    assert!(expected.certificate.flips > 0, "the test is of flips too");
    for scale in [1e-100, 1e-30, 1e-3, 7.0, 1e30, 1e100] {
        let found = measured(&mesh, &uv.clone().mapped(|p| p * scale));
        assert_same(&found, &expected, 1e-9);
        let area = expected.uv_area * scale * scale;
        assert!((found.uv_area - area).abs() <= 1e-9 * area, "{} instead of {area}", found.uv_area);
    }
}

#[test]
fn no_figure_depends_on_the_scale_of_the_mesh() {
    let (mesh, uv) = shaken(6, 0.3);
    let expected = measured(&mesh, &uv);
    for scale in [1e-150, 1e-30, 1e30, 1e150] {
        let positions = mesh.positions().iter().map(|p| p * scale).collect();
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|f| f.map(VertexId::index)).collect();
        let scaled = TriMesh::new(positions, &faces).expect("indices in range");
        assert_same(&measured(&scaled, &uv), &expected, 1e-9);
    }
}

#[test]
fn powers_of_two_do_not_change_a_bit() {
    let (mesh, uv) = shaken(7, 0.6);
    let expected = measured(&mesh, &uv);
    for scale in [2.0_f64.powi(-400), 0.25, 2.0_f64.powi(400)] {
        let mut found = measured(&mesh, &uv.clone().mapped(|p| p * scale));
        found.uv_area = expected.uv_area;
        assert_eq!(found, expected);
    }
}

#[test]
fn a_tiny_triangle_in_a_large_map_is_measured_like_any_other() {
    for size in [1e-30, 1e-60] {
        let mesh = sheet(1, |_, _| 0.0);
        // The second triangle, in a chart of its own, is shrunk and stretched by two.
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [2.0 * size, size], [0.0, size]];
        let m = measured(&mesh, &uv_map(&points, &[[0, 1, 2], [3, 4, 5]]));
        assert!(m.valid() && m.certificate.near_collapsed == 0, "{m:?}");
        assert!((m.qc_max - 2.0).abs() < 1e-12, "{m:?}");
        let one_half = 0.5_f64;
        assert!((m.stretch_linf * size / one_half.sqrt() - 1.0).abs() < 1e-12, "{m:?}");
    }
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let (mesh, uv) = shaken(8, 0.6);
    assert_eq!(measured(&mesh, &uv), measured(&mesh, &uv));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_figure_depends_on_a_similarity_of_the_uvs(
        seed in any::<u64>(),
        angle in 0.0..std::f64::consts::TAU,
        shift in (-20.0..20.0, -20.0..20.0),
        log_scale in -60.0..60.0,
        mirrored: bool,
    ) {
        // Shaken little enough that no triangle comes within rounding of a line.
        let (mesh, uv) = shaken(seed, 0.15);
        let (sin, cos) = f64::sin_cos(angle);
        let (scale, side) = (10.0_f64.powf(log_scale), if mirrored { -1.0 } else { 1.0 });
        let moved = uv.clone().mapped(|p| {
            let q = Point2::new(side * (cos * p.x - sin * p.y) + shift.0, sin * p.x + cos * p.y + shift.1);
            q * scale
        });
        assert_same(&measured(&mesh, &moved), &measured(&mesh, &uv), 1e-9);
    }

    #[test]
    fn distortion_is_never_less_than_that_of_an_isometry(seed in any::<u64>(), amplitude in 0.0..0.9) {
        let (mesh, uv) = shaken(seed, amplitude);
        let m = measured(&mesh, &uv);
        for one in [m.stretch_l2, m.stretch_linf, m.qc_mean, m.qc_max] {
            prop_assert!(one >= 1.0 - 1e-12, "{:?}", m);
        }
        prop_assert!(m.stretch_linf >= m.stretch_l2 * (1.0 - 1e-12) && m.qc_max >= m.qc_mean * (1.0 - 1e-12));
        prop_assert!(m.f >= 0.0 && m.f.sqrt() <= m.max_angle_error * (1.0 + 1e-12));
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    // Enough faces for several threads.
    let mesh = sheet(80, |x, y| (30.0 * x).sin() * (20.0 * y).cos());
    let uv: Vec<Point2<f64>> = mesh.positions().iter().map(|p| Point2::new(p.x + p.y * p.y, p.y)).collect();
    let map = UvMap::per_vertex(&mesh, &uv);
    let with = |threads| abf_parallel::with_threads(threads, || measured(&mesh, &map)).expect("threads");
    assert_eq!(with(1), with(2));
    assert_eq!(with(1), with(5));
}
