use super::*;
use crate::{SurfaceHints, Unwrap};
use abf_control::Silent;
use abf_mesh::Point3;
use std::f64::consts::PI;

/// A flat strip along a half circle with radii 4 and 5, or one that is less wide; `turn` is how far it goes.
fn arch(turn: f64, inner: f64) -> TriMesh {
    let (steps, rows) = (96_usize, 4_usize);
    let mut points = Vec::new();
    for i in 0..=steps {
        let angle = turn * i as f64 / steps as f64;
        let radii = (0..=rows).map(|k| inner + (5.0 - inner) * k as f64 / rows as f64);
        points.extend(radii.map(|r| Point3::new(r * angle.cos(), r * angle.sin(), 0.0)));
    }
    let at = |i: usize, k: usize| i * (rows + 1) + k;
    let squares = (0..steps).flat_map(|i| (0..rows).map(move |k| (i, k)));
    let faces: Vec<[usize; 3]> = squares
        .flat_map(|(i, k)| [[at(i, k), at(i, k + 1), at(i + 1, k + 1)], [at(i, k), at(i + 1, k + 1), at(i + 1, k)]])
        .collect();
    TriMesh::new(points, &faces).expect("indices in range")
}

fn charts_of(mesh: &TriMesh) -> Unwrapped {
    let unwrap = Unwrap { cut_disks: true, ..Unwrap::default() };
    unwrap.run(mesh, &SurfaceHints::default(), &mut Silent).expect("charts")
}

fn run(mesh: &TriMesh, forbidden: Option<&[bool]>, parting: &Parting) -> Parted {
    let atlas = Atlas { page: [256; 2], ..Atlas::default() };
    atlas.pack_parting(mesh, charts_of(mesh), (None, forbidden), Stored::default(), parting).expect("an atlas")
}

/// Every face is in one chart, charts have the edges of the mesh, and seams are where UVs differ.
fn check(mesh: &TriMesh, parted: &Parted) {
    let charts = &parted.unwrapped.charts;
    let mut faces: Vec<usize> = charts.iter().flat_map(|chart| &chart.faces).map(|f| f.index()).collect();
    faces.sort_unstable();
    assert!(faces.into_iter().eq(0..mesh.face_count()));
    assert!(parted.packed.metrics.injective());
    let lengths: f64 = parted.unwrapped.seams.iter().map(|&edge| corners::length(mesh, edge)).sum();
    assert!((lengths - parted.unwrapped.seam_length).abs() < 1e-9 * lengths.max(1.0));
    // Every seam has a part on both sides here.
    let of_charts: f64 = charts.iter().map(|chart| chart.seam_length).sum();
    assert!((of_charts - 2.0 * lengths).abs() < 1e-9 * lengths.max(1.0), "{of_charts} {lengths}");
}

#[test]
fn an_arch_in_parts_covers_more_within_its_budget() {
    let mesh = arch(PI, 4.0);
    let whole = run(&mesh, None, &Parting::default());
    assert_eq!((whole.for_coverage, whole.for_margin, whole.unwrapped.charts.len()), (0, 0, 1));
    let parting = Parting { coverage: Some(0.6), seam_budget: 0.5, ..Parting::default() };
    let parted = run(&mesh, None, &parting);
    assert!(parted.packed.coverage > 1.2 * whole.packed.coverage, "{}", parted.packed.coverage);
    assert_eq!(parted.unwrapped.charts.len(), 1 + parted.for_coverage);
    // Without a seam the half of the boundary counts as one.
    let boundary = 0.5 * (9.0 * PI + 2.0);
    assert!(parted.unwrapped.seam_length > 0.0 && parted.unwrapped.seam_length <= 0.5 * boundary);
    check(&mesh, &parted);
    let none = run(&mesh, None, &Parting { seam_budget: 0.0, ..parting });
    assert_eq!((none.for_coverage, none.packed.coverage), (0, whole.packed.coverage));
}

#[test]
fn edges_that_may_not_be_seams_are_not_cut() {
    let mesh = arch(PI, 4.0);
    // Every diagonal: in the first triangle of a square it faces corner 1, in the second one corner 2.
    let forbidden: Vec<bool> = (0..mesh.face_count()).flat_map(|f| [false, f % 2 == 0, f % 2 == 1]).collect();
    let parting = Parting { coverage: Some(0.9), seam_budget: 1.0, ..Parting::default() };
    let parted = run(&mesh, Some(&forbidden), &parting);
    assert!(parted.for_coverage > 0);
    let is_diagonal = |[a, b]: [abf_mesh::VertexId; 2]| b.index() - a.index() == 6;
    assert!(!parted.unwrapped.seams.iter().any(|&edge| is_diagonal(edge)));
    check(&mesh, &parted);
    let all = vec![true; 3 * mesh.face_count()];
    assert_eq!(run(&mesh, Some(&all), &parting).for_coverage, 0);
}

#[test]
fn a_ring_that_nearly_closes_is_parted_to_keep_the_margin() {
    let mesh = arch(2.0 * PI - 0.01, 2.0);
    let before = run(&mesh, None, &Parting::default());
    assert_eq!(before.packed.narrow.len(), 1);
    let parted = run(&mesh, None, &Parting { keeps_inner_margin: true, ..Parting::default() });
    assert_eq!((parted.packed.narrow.len(), parted.for_margin, parted.unwrapped.charts.len()), (0, 1, 2));
    // One cut across, no longer than that takes.
    assert!((parted.unwrapped.seam_length - 3.0).abs() < 1e-9, "{}", parted.unwrapped.seam_length);
    check(&mesh, &parted);
}

#[test]
fn numbers_out_of_their_range_are_refused_by_name() {
    let good = Parting::default();
    for (parting, name) in [
        (Parting { coverage: Some(0.0), ..good }, "coverage"),
        (Parting { coverage: Some(f64::NAN), ..good }, "coverage"),
        (Parting { seam_budget: -1.0, ..good }, "seam budget"),
        (Parting { max_stretch: 0.5, ..good }, "max stretch"),
    ] {
        let error = parting.check().unwrap_err();
        assert!(error.to_string().starts_with(name), "{error}");
    }
}

#[test]
fn parts_that_would_not_fit_the_pages_are_no_reason_to_fail() {
    let mesh = arch(PI, 4.0);
    // One page takes the whole chart at this scale, and no two parts of it with their margins.
    let whole = run(&mesh, None, &Parting::default());
    let atlas = Atlas {
        page: [256; 2],
        texels_per_unit: Some(0.999 * whole.packed.texels_per_unit),
        max_pages: 1,
        ..Atlas::default()
    };
    for parting in [
        Parting { coverage: Some(1.0), seam_budget: 9.0, ..Parting::default() },
        Parting { keeps_inner_margin: true, ..Parting::default() },
    ] {
        let parted = atlas.pack_parting(&mesh, charts_of(&mesh), (None, None), Stored::default(), &parting);
        assert_eq!(parted.expect("an atlas").packed.pages, 1);
    }
}

#[test]
fn the_seams_of_parts_are_as_long_where_faces_share_no_vertices() {
    let mesh = arch(PI, 4.0);
    let corners: Vec<[usize; 3]> = (0..mesh.face_count()).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    let soup = TriMesh::new(mesh.triangles().flatten().collect(), &corners).expect("indices in range");
    let parting = Parting { coverage: Some(0.6), seam_budget: 0.5, ..Parting::default() };
    let parted = run(&soup, None, &parting);
    assert!(parted.for_coverage > 0);
    check(&soup, &parted);
}

#[test]
fn nothing_more_is_cut_when_it_may_not_go_on() {
    let atlas = Atlas { page: [256; 2], ..Atlas::default() };
    for (mesh, parting) in [
        (arch(PI, 4.0), Parting { coverage: Some(0.6), seam_budget: 0.5, ..Parting::default() }),
        (arch(2.0 * PI - 0.01, 2.0), Parting { keeps_inner_margin: true, ..Parting::default() }),
    ] {
        for may_go_on in [false, true] {
            let how: (&Parting, &mut dyn FnMut() -> bool) = (&parting, &mut || may_go_on);
            let parted = atlas.pack_parting_while(&mesh, charts_of(&mesh), (None, None), Stored::default(), how);
            let parted = parted.expect("an atlas");
            assert_eq!(parted.for_coverage + parted.for_margin > 0, may_go_on);
            assert_eq!(parted.is_unfinished, !may_go_on);
        }
    }
}

/// A square of 20 by 20 with a strip of 16 by 1 that goes on along its lower side.
fn square_with_a_tail() -> TriMesh {
    let cells: Vec<[usize; 2]> =
        (0..20).flat_map(|x| (0..20).map(move |y| [x, y])).chain((20..36).map(|x| [x, 0])).collect();
    let corners = |&[x, y]: &[usize; 2]| [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
    let mut points: Vec<[usize; 2]> = cells.iter().flat_map(corners).collect();
    points.sort_unstable();
    points.dedup();
    let at = |p: [usize; 2]| points.binary_search(&p).expect("a corner of a cell");
    let faces: Vec<[usize; 3]> =
        cells.iter().map(|cell| corners(cell).map(at)).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let places = points.iter().map(|&[x, y]| Point3::new(x as f64, y as f64, 0.0)).collect();
    TriMesh::new(places, &faces).expect("indices in range")
}

#[test]
fn a_small_part_that_sticks_out_is_cut_off() {
    let mesh = square_with_a_tail();
    let whole = run(&mesh, None, &Parting::default());
    // The tail is a 26th of the chart, and a cut through the square is beyond the budget.
    let parted = run(&mesh, None, &Parting { coverage: Some(0.6), seam_budget: 0.1, ..Parting::default() });
    assert!(parted.for_coverage > 0);
    assert!(parted.packed.coverage > 1.5 * whole.packed.coverage, "{}", parted.packed.coverage);
    check(&mesh, &parted);
}
