//! Charts in real units: what is written, and what is drawn of it.

use crate::support::{Folder, run_on};
use crate::surfaces;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Where vertices are, and the faces.
type Surface = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// Half a tube of the radius 50 mm and the length 1000 mm in 180 facets.
fn half_tube() -> Surface {
    let ring = |i: usize| {
        let angle = i as f64 * PI / 180.0;
        [0.0, 1000.0].map(|z| [50.0 * angle.cos(), 50.0 * angle.sin(), z])
    };
    let points = (0..=180).flat_map(ring).collect();
    let faces = (0..180).map(|i| 2 * i).flat_map(|a| [[a, a + 2, a + 3], [a, a + 3, a + 1]]).collect();
    (points, faces)
}

/// A square plate with the side 200 mm and a round hole in the middle, in the plane z = 0.
fn plate() -> Surface {
    const SIDES: usize = 48;
    let angle = |i: usize| i as f64 * TAU / SIDES as f64;
    let inner = |i: usize| [40.0 * angle(i).cos(), 40.0 * angle(i).sin(), 0.0];
    let outer = |i: usize| {
        let (x, y) = (angle(i).cos(), angle(i).sin());
        let r = 100.0 / x.abs().max(y.abs());
        [r * x, r * y, 0.0]
    };
    let points = (0..SIDES).map(inner).chain((0..SIDES).map(outer)).collect();
    let faces = (0..SIDES).flat_map(|i| {
        let k = (i + 1) % SIDES;
        [[i, i + SIDES, k + SIDES], [i, k + SIDES, k]]
    });
    (points, faces.collect())
}

/// The half tube, and the plate beside it.
fn two_pieces() -> Surface {
    let ((mut points, mut faces), (others, more)) = (half_tube(), plate());
    let first = points.len();
    points.extend(others.into_iter().map(|[x, y, z]| [x + 500.0, y, z]));
    faces.extend(more.into_iter().map(|f| f.map(|v| v + first)));
    (points, faces)
}

/// The lengths of the edges on the boundary of a surface, ascending, in its units.
fn boundary(surface: &Surface) -> Vec<f64> {
    let (points, faces) = surface;
    let mut edges: Vec<[usize; 2]> =
        faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    let once = edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]);
    let length = |[a, b]: [usize; 2]| (0..3).map(|k| (points[a][k] - points[b][k]).powi(2)).sum::<f64>().sqrt();
    let mut lengths: Vec<f64> = once.map(length).collect();
    lengths.sort_by(f64::total_cmp);
    lengths
}

/// What is read of an SVG: its width and height in millimetres, and the loops of its layer `cut`.
struct Drawing {
    size: [f64; 2],
    loops: Vec<Vec<[f64; 2]>>,
}

impl Drawing {
    fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("written");
        let document = roxmltree::Document::parse(&text).expect("XML");
        let root = document.root_element();
        let millimetres = |name| {
            let value: &str = root.attribute(name).expect("a size");
            value.strip_suffix("mm").expect("millimetres").parse::<f64>().expect("a number")
        };
        let size = [millimetres("width"), millimetres("height")];
        assert_eq!(root.attribute("viewBox"), Some(format!("0 0 {} {}", size[0], size[1]).as_str()));
        let cut = document.descendants().find(|node| node.attribute("id") == Some("cut")).expect("a layer");
        let data: String = cut.children().filter_map(|path| path.attribute("d")).collect();
        let points = |one: &str| {
            let pairs = one.trim_end_matches('Z').split('L');
            let numbers = |pair: &str| pair.split(' ').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>();
            pairs.map(numbers).map(|pair| [pair[0], pair[1]]).collect()
        };
        Self { size, loops: data.split('M').skip(1).map(points).collect() }
    }

    /// The lengths of all cuts between two points, ascending, millimetres.
    fn lengths(&self) -> Vec<f64> {
        let of_loop = |points: &Vec<[f64; 2]>| {
            let next = points.iter().cycle().skip(1);
            points.iter().zip(next).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).collect::<Vec<f64>>()
        };
        let mut lengths: Vec<f64> = self.loops.iter().flat_map(of_loop).collect();
        lengths.sort_by(f64::total_cmp);
        lengths
    }
}

fn drawn(surface: &Surface, options: &str) -> Drawing {
    let folder = Folder::new();
    let (mesh, svg) = (folder.file("a.obj", surfaces::obj(&surface.0, &surface.1)), folder.path("a.svg"));
    let ran = run_on(&format!("--svg {} {options}", svg.display()), &[&mesh]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    Drawing::read(&svg)
}

fn assert_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
    }
}

/// The closed polylines of the layer `CUT` of a DXF, which has to be in millimetres.
fn cuts_of_dxf(path: &Path) -> Vec<Vec<[f64; 2]>> {
    let text = std::fs::read_to_string(path).expect("written");
    assert!(text.contains("$INSUNITS\n70\n4\n"), "millimetres");
    let mut loops = Vec::new();
    for entity in text.split("\n0\nLWPOLYLINE\n").skip(1) {
        let lines: Vec<&str> = entity.split("\n0\n").next().unwrap_or_default().lines().collect();
        let groups: Vec<(&str, &str)> = lines.chunks(2).map(|pair| (pair[0], pair[1])).collect();
        assert!(groups.contains(&("8", "CUT")) && groups.contains(&("70", "1")), "{groups:?}");
        let all = |code: &str| {
            groups
                .iter()
                .filter(|group| group.0 == code)
                .map(|group| group.1.parse::<f64>().expect("a number"))
                .collect::<Vec<_>>()
        };
        loops.push(all("10").into_iter().zip(all("20")).map(|(x, y)| [x, y]).collect());
    }
    loops
}

#[test]
fn a_dxf_has_the_lengths_of_the_surface_and_the_same_bytes_every_time() {
    for (surface, pieces, unit, mm) in
        [(half_tube(), 1, "mm", 1.0), (plate(), 2, "cm", 10.0), (two_pieces(), 3, "m", 1000.0)]
    {
        let folder = Folder::new();
        let mesh = folder.file("a.obj", surfaces::obj(&surface.0, &surface.1));
        let texts = ["a.dxf", "b.dxf"].map(|name| {
            let dxf = folder.path(name);
            let ran = run_on(&format!("--dxf {} --unit {unit}", dxf.display()), &[&mesh]);
            assert_eq!(ran.code, 0, "{}", ran.stderr);
            std::fs::read_to_string(dxf).expect("written")
        });
        assert_eq!(texts[0], texts[1]);
        let loops = cuts_of_dxf(&folder.path("a.dxf"));
        assert_eq!(loops.len(), pieces);
        let expected: Vec<f64> = boundary(&surface).iter().map(|length| mm * length).collect();
        let found = Drawing { size: [0.0; 2], loops }.lengths();
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6 * mm), "{found:?}");
    }
}

#[test]
fn every_chart_has_its_number_in_both_drawings() {
    let folder = Folder::new();
    let (points, faces) = two_pieces();
    let mesh = folder.file("a.obj", surfaces::obj(&points, &faces));
    let (svg, dxf) = (folder.path("a.svg"), folder.path("a.dxf"));
    let ran = run_on(&format!("--svg {} --dxf {}", svg.display(), dxf.display()), &[&mesh]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let text = std::fs::read_to_string(&svg).expect("written");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let layer = document.descendants().find(|node| node.attribute("id") == Some("charts")).expect("a layer");
    let numbers: Vec<&str> =
        layer.children().filter_map(|node| node.text()).map(str::trim).filter(|t| !t.is_empty()).collect();
    assert_eq!(numbers, ["1", "2"]);
    let text = std::fs::read_to_string(&dxf).expect("written");
    let labels = text.split("\n0\nTEXT\n").skip(1).map(|entity| entity.lines().skip_while(|line| *line != "40").nth(3));
    assert_eq!(labels.collect::<Vec<_>>(), [Some("1"), Some("2")]);
}

#[test]
fn half_a_tube_is_drawn_as_long_and_as_wide_as_it_is() {
    let tube = half_tube();
    let drawing = drawn(&tube, "");
    // A chord of 1 degree, 180 times; 5 mm of border around, and 10 mm below for the scale.
    assert_near(&drawing.size, &[1010.0, 180.0 * 100.0 * (PI / 360.0).sin() + 20.0]);
    assert_near(&drawing.lengths(), &boundary(&tube));
}

#[test]
fn a_plate_with_a_hole_is_drawn_in_its_lengths() {
    let plate = plate();
    let drawing = drawn(&plate, "");
    assert_eq!(drawing.loops.len(), 2);
    assert_near(&drawing.size, &[210.0, 220.0]);
    assert_near(&drawing.lengths(), &boundary(&plate));
}

#[test]
fn two_pieces_are_drawn_at_one_scale_in_the_unit_that_is_said() {
    let pieces = two_pieces();
    assert_near(&drawn(&pieces, "").lengths(), &boundary(&pieces));
    let inches: Vec<f64> = boundary(&pieces).iter().map(|length| 25.4 * length).collect();
    let found = drawn(&pieces, "--unit in").lengths();
    assert!(found.iter().zip(&inches).all(|(a, b)| (a - b).abs() < 25.4e-6), "{found:?}");
}

#[test]
fn real_units_are_written_and_stated() {
    let folder = Folder::new();
    let (points, faces) = two_pieces();
    let (mesh, out) = (folder.file("a.obj", surfaces::obj(&points, &faces)), folder.path("out.obj"));
    let ran = run_on(&format!("--units real --gap 7 -o {} --json -", out.display()), &[&mesh]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let atlas = ran.result()["atlas"].clone();
    // The tube and the plate above it; no texels.
    let sheet: Vec<f64> =
        atlas["sheet"].as_array().expect("a size").iter().filter_map(serde_json::Value::as_f64).collect();
    assert_near(&sheet, &[1000.0, 180.0 * 100.0 * (PI / 360.0).sin() + 7.0 + 200.0]);
    assert!(
        atlas.get("page").is_none() && atlas.get("margin").is_none() && atlas.get("texels_per_unit").is_none(),
        "{atlas}"
    );
    let judged = run_on("metrics --json -", &[&out]).result();
    let area = judged["uv_area"].as_f64().expect("an area") / judged["surface_area"].as_f64().expect("an area");
    assert!((area - 1.0).abs() < 1e-9 && judged["injective"] == true, "{judged}");
}

#[test]
fn options_of_sheets_that_do_not_fit_are_refused() {
    let missing = Path::new("missing.obj");
    for (options, expected) in [
        ("--unit cm", "--unit says how large a drawing is: add --svg FILE or --dxf FILE, or leave it out"),
        ("--folds", "--folds concerns a drawing: add --svg FILE or --dxf FILE, or leave it out"),
        ("--units real --folds=190 --svg a.svg", "--folds must be in 0..=180 degrees, got 190"),
        ("--orient keep", "--orient concerns a sheet: add --units real, --svg FILE or --dxf FILE"),
        ("--units real --normalize", "--units real and --normalize are two scales: leave out one of them"),
        ("--units real --coverage 0.5", "--coverage concerns the unit square: leave it out, or --units real"),
        ("--dxf a.svg", "dxf"),
        ("--units real --margin 4", "--margin concerns the unit square: leave it out, or --units real"),
        ("--units real --gap nan", "--gap must be a length of at least 0, got NaN"),
    ] {
        let ran = run_on(options, &[missing]);
        assert!(ran.code == 2 && ran.stderr.contains(expected), "{options}: {}", ran.stderr);
    }
}

#[test]
fn a_box_has_folds_at_its_edges_and_every_seam_has_its_number_twice() {
    let folder = Folder::new();
    let corner = |i: usize| [i & 1, i >> 1 & 1, i >> 2].map(|x| 30.0 * x as f64);
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[usize; 3]> = squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let points: Vec<[f64; 3]> = (0..8).map(corner).collect();
    let (mesh, svg) = (folder.file("a.obj", surfaces::obj(&points, &faces)), folder.path("a.svg"));
    let ran = run_on(&format!("--svg {} --folds", svg.display()), &[&mesh]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let text = std::fs::read_to_string(&svg).expect("written");
    let document = roxmltree::Document::parse(&text).expect("XML");
    let layer = |id| document.descendants().find(|node| node.attribute("id") == Some(id));
    let folds = layer("mountain-folds").and_then(|path| path.attribute("d")).expect("folds");
    assert_eq!((folds.matches('M').count(), layer("valley")), (5, None), "{folds}");
    let numbers = layer("numbers").expect("a layer");
    let mut numbers: Vec<&str> =
        numbers.children().filter_map(|node| node.text()).map(str::trim).filter(|t| !t.is_empty()).collect();
    numbers.sort_unstable();
    assert_eq!(numbers, ["1", "1", "2", "2", "3", "3", "4", "4", "5", "5", "6", "6", "7", "7"]);
    let scale = layer("scale").expect("a layer");
    assert_eq!(scale.children().find_map(|node| node.text().filter(|t| t.ends_with("mm"))), Some("50 mm"));
}

#[test]
fn a_gap_that_leaves_charts_no_digits_is_to_be_smaller() {
    let folder = Folder::new();
    let two = folder.file("two.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 5 5 0\nv 6 5 0\nv 5 6 1\nf 1 2 3\nf 4 5 6\n");
    let ran = run_on("--units real --gap 1e300", &[&two]);
    assert!(ran.code == 1 && ran.stderr.contains("try a smaller --gap"), "{}", ran.stderr);
}

#[test]
fn the_part_of_a_sheet_that_is_covered_is_a_number_whatever_the_size() {
    let folder = Folder::new();
    let covered = |size: &str| {
        let faces = "f 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
        let mesh = folder.file("a.obj", format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\n{faces}"));
        let result = run_on("--units real --json -", &[&mesh]).result();
        result["atlas"]["coverage"].as_f64().expect("a number")
    };
    for size in ["1", "1e307", "1e160", "1e-160"] {
        assert!((0.5..0.9).contains(&covered(size)), "{size}: {}", covered(size));
    }
}
