use super::*;
use abf_mesh::{Point3, UvId};
use abf_metrics::MetricsError;

/// Faces over points of the plane, which are their own layout.
fn flat(points: &[[f64; 2]], faces: &[[usize; 3]]) -> (TriMesh, UvMap) {
    let uv: Vec<Point2<f64>> = points.iter().map(|&p| Point2::from(p)).collect();
    let positions = uv.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    let mesh = TriMesh::new(positions, faces).expect("indices in range");
    let uv = UvMap::per_vertex(&mesh, &uv);
    (mesh, uv)
}

fn square() -> (TriMesh, UvMap) {
    flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]], &[[0, 1, 2], [0, 2, 3]])
}

fn bare() -> SvgStyle {
    SvgStyle { margin_mm: 0.0, ..SvgStyle::default() }
}

fn drawn(mesh: &TriMesh, uv: &UvMap, style: &SvgStyle) -> String {
    layout_svg(mesh, uv, None, style).expect("a layout")
}

#[test]
fn a_boundary_is_one_closed_loop_with_y_up() {
    let (mesh, uv) = square();
    let svg = drawn(&mesh, &uv, &bare());
    assert!(svg.contains(r#"<path id="outline" d="M0 1L2 1L2 0L0 0Z"/>"#), "{svg}");
    assert!(svg.contains(r#"<path id="edges" d="M2 0L0 1"/>"#), "{svg}");
    assert!(!svg.contains("marks"), "{svg}");
}

#[test]
fn layers_come_in_the_order_in_which_they_are_drawn() {
    let (mesh, uv) = square();
    let svg = drawn(&mesh, &uv, &bare());
    let at = |name: &str| svg.find(&format!("<g id=\"{name}\"")).expect("a layer");
    assert!(at("mesh") < at("cut"));
    let without = drawn(&mesh, &uv, &SvgStyle { mesh_edges: false, ..bare() });
    assert!(!without.contains("\"mesh\"") && without.contains("\"cut\""));
}

#[test]
fn the_page_has_the_size_of_the_model_in_every_unit() {
    let (mesh, uv) = square();
    for (unit, page) in [
        (SvgUnit::Millimetre, r#"width="254mm" height="127mm" viewBox="0 0 254 127""#),
        (SvgUnit::Centimetre, r#"width="25.4cm" height="12.7cm" viewBox="0 0 25.4 12.7""#),
        (SvgUnit::Inch, r#"width="10in" height="5in" viewBox="0 0 10 5""#),
    ] {
        let svg = drawn(&mesh, &uv, &SvgStyle { unit, mm_per_uv: 127.0, ..bare() });
        assert!(svg.contains(page), "{svg}");
        assert_eq!(unit.suffix().parse(), Ok(unit));
    }
    let error = "furlong".parse::<SvgUnit>().expect_err("no unit");
    assert_eq!(error.to_string(), "\"furlong\" is no unit of length: use mm, cm or in");
}

#[test]
fn a_seam_is_cut_on_both_sides_and_marked() {
    let (mesh, uv) = square();
    let apart = uv.triangles().enumerate().flat_map(|(f, t)| t.map(|p| Point2::new(p.x, p.y + 3.0 * f as f64)));
    let uv = UvMap::new(apart.collect(), (0..6).map(UvId::new).collect());
    let svg = drawn(&mesh, &uv, &bare());
    assert!(svg.contains(r#"id="outline" d="M0 4L2 4L2 3ZM0 1L2 0L0 0Z""#), "{svg}");
    assert!(svg.contains(r#"id="seams" d="M2 3L0 4M0 1L2 0""#), "{svg}");
    assert!(!svg.contains("\"mesh\""));
    assert!(!drawn(&mesh, &uv, &SvgStyle { marks: false, ..bare() }).contains("seams"));
}

#[test]
fn a_flipped_triangle_is_marked() {
    let (mesh, _) =
        flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [-1.0, 1.0]], &[[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let folded = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [0.5, 1.0]].map(Point2::from);
    let svg = drawn(&mesh, &UvMap::per_vertex(&mesh, &folded), &bare());
    assert!(svg.contains(r#"<path id="flipped" d="M0 2L0 0L0.5 1Z"/>"#), "{svg}");
}

#[test]
fn a_chain_that_does_not_close_stays_open() {
    let (_, uv) = square();
    let open = chains(&uv, &[CornerId::new(0), CornerId::new(1)]);
    assert_eq!(
        open,
        [Chain { points: [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]].map(Point2::from).to_vec(), closed: false }]
    );
}

#[test]
fn numbers_have_no_trailing_zeros_and_no_negative_zero() {
    for (x, text) in [(1.0, "1"), (100.0, "100"), (0.1 + 0.2, "0.3"), (-1e-9, "0"), (-2.50001, "-2.5")] {
        assert_eq!(decimal(x, 4), text);
    }
    assert_eq!(decimal(120.4, 0), "120");
}

#[test]
fn the_same_input_gives_the_same_text() {
    let mesh = abf_shapes::Shape::BumpySheet.mesh(500);
    let uv: Vec<_> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
    let uv = UvMap::per_vertex(&mesh, &uv);
    let once = drawn(&mesh, &uv, &SvgStyle::default());
    assert_eq!(once, drawn(&mesh, &uv, &SvgStyle::default()));
    // One boundary, one loop.
    let outline = once.split("id=\"outline\" d=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("an outline");
    assert_eq!((outline.matches('M').count(), outline.matches('Z').count()), (1, 1));
}

#[test]
fn rejects_lengths_out_of_range_and_the_map_of_another_mesh() {
    let (mesh, uv) = square();
    for (style, expected) in [
        (SvgStyle { mm_per_uv: 0.0, ..bare() }, "mm_per_uv must be positive and at most 1e7 mm, got 0"),
        (SvgStyle { margin_mm: f64::NAN, ..bare() }, "margin_mm must be not negative and at most 1e7 mm, got NaN"),
        (
            SvgStyle { mm_per_uv: 9e6, ..bare() },
            "the longer side of the layout must be finite and at most 1e7 mm, got 18000000",
        ),
    ] {
        assert_eq!(layout_svg(&mesh, &uv, None, &style).expect_err("out of range").to_string(), expected);
    }
    let other = UvMap::new(vec![Point2::origin()], vec![UvId::new(0); 3]);
    let error = PictureError::Input(MetricsError::CornerCount { corners: 3, faces: 2 });
    assert_eq!(layout_svg(&mesh, &other, None, &bare()), Err(error));
}

/// Two squares that meet at an edge on the y axis, the right one bent down by 45 degrees.
fn roof() -> (TriMesh, UvMap) {
    let flat = [[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 1.0]].map(Point2::from);
    let half = 0.5_f64.sqrt();
    let positions = flat.map(|p| if p.x > 0.0 { Point3::new(half, p.y, -half) } else { Point3::new(p.x, p.y, 0.0) });
    let faces = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let mesh = TriMesh::new(positions.to_vec(), &faces).expect("indices in range");
    let uv = UvMap::per_vertex(&mesh, &flat);
    (mesh, uv)
}

#[test]
fn a_convex_edge_is_a_mountain_and_the_same_edge_bent_up_a_valley() {
    let (mesh, uv) = roof();
    let style = |deg: f64| SvgStyle { folds: Some(deg.to_radians()), ..bare() };
    let svg = drawn(&mesh, &uv, &style(44.0));
    assert!(svg.contains(r#"<path id="mountain-folds" d="M1 1L1 0"/>"#) && !svg.contains("valley"), "{svg}");
    assert!(!drawn(&mesh, &uv, &style(46.0)).contains("folds"));
    let up = mesh.positions().iter().map(|p| Point3::new(p.x, p.y, -p.z)).collect();
    let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|f| f.map(abf_mesh::VertexId::index)).collect();
    let bent_up = TriMesh::new(up, &faces).expect("indices in range");
    let svg = drawn(&bent_up, &uv, &style(44.0));
    assert!(svg.contains(r#"id="valley-folds""#) && !svg.contains("mountain"), "{svg}");
}

#[test]
fn a_seam_has_one_number_at_one_point_of_the_surface_on_both_sides() {
    let (mesh, uv) = square();
    let apart = uv.triangles().enumerate().flat_map(|(f, t)| t.map(|p| Point2::new(p.x, p.y + 3.0 * f as f64)));
    let uv = UvMap::new(apart.collect(), (0..6).map(UvId::new).collect());
    let marks = seams::marks(&mesh, &uv, &Edges::of(&mesh, &uv));
    let found: Vec<(usize, [f64; 2])> = marks.iter().map(|mark| (mark.number, [mark.at.x, mark.at.y])).collect();
    assert_eq!(found, [(1, [1.0, 0.5]), (1, [1.0, 3.5])]);
    // Into the lower right triangle, and into the upper left one.
    assert!(marks[0].inward.x > 0.0 && marks[0].inward.y < 0.0 && marks[1].inward.x < 0.0);
    assert!((marks[0].length - 5.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_bar_of_a_round_length_stands_below_the_layout() {
    let (mesh, uv) = square();
    let svg = drawn(&mesh, &uv, &SvgStyle { scale_bar: true, mm_per_uv: 157.0, ..SvgStyle::default() });
    assert!(svg.contains(r#"width="324mm" height="177mm""#), "{svg}");
    assert!(svg.contains(r#"<path id="bar" d="M5 169L5 171L105 171L105 169"/>"#) && svg.contains(">100 mm<"), "{svg}");
}

#[test]
fn of_several_faces_at_an_edge_two_that_agree_are_joined() {
    let (square, flat) = square();
    // A third face stands on the diagonal, somewhere else in the plane.
    let mut positions = square.positions().to_vec();
    positions.push(Point3::new(1.0, 0.5, 1.0));
    let mesh = TriMesh::new(positions, &[[0, 1, 2], [0, 2, 3], [0, 2, 4]]).expect("indices in range");
    let mut points = flat.points().to_vec();
    points.extend([[9.0, 0.0], [11.0, 1.0], [9.0, 1.0]].map(Point2::from));
    let corners = [0, 1, 2, 0, 2, 3, 4, 5, 6].map(UvId::new);
    let edges = Edges::of(&mesh, &UvMap::new(points, corners.to_vec()));
    assert_eq!((edges.joined.len(), edges.seams.len(), edges.open.len()), (1, 1, 7));
}
