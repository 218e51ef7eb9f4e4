//! Models on which an atlas was of no use once, kind by kind: what came out then, and what is right.
//!
//! The files are found beside the folder that `ABF_MODELS` names; what is not there is skipped, and said. Small ones are made here.

use crate::support::{Folder, Ran, run_on};
use crate::surfaces;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// How a file is run.
#[derive(Clone, Copy, PartialEq)]
enum As {
    /// As an atlas on one page.
    Atlas,
    /// With no option: a disk stays whole.
    Whole,
}

/// What is right beside what holds for every row: exit code 0, valid, injective, finished, every chart within the aim.
struct Right {
    charts: usize,
    /// The largest L² stretch of a chart, what it is above 1.
    above_one: f64,
    /// The largest angle error, degrees.
    degrees: f64,
    coverage: f64,
}

const WITHIN: f64 = 0.15 + 1e-9;
const ANY: Right = Right { charts: usize::MAX, above_one: WITHIN, degrees: f64::INFINITY, coverage: 0.0 };
const EXACT: Right = Right { charts: 1, above_one: 1e-10, ..ANY };
const ONE: Right = Right { charts: 1, ..ANY };

const fn exact(charts: usize, degrees: f64) -> Right {
    Right { charts, degrees, ..EXACT }
}

/// Row, file, how it is run, what came out once, what is right.
const ROWS: &[(u32, &str, As, &str, Right)] = &[
    (1, "assets/alphablend.glb", As::Atlas, "L2 628", ANY),
    (1, "assets/pirate.obj", As::Atlas, "L2 1.8e9", ANY),
    (1, "models/hard/xa-gazebo.obj", As::Atlas, "L2 8737", ANY),
    (1, "assets/truck.glb", As::Atlas, "invalid", ANY),
    (1, "assets/office.obj", As::Atlas, "invalid", ANY),
    (1, "assets/helmet.glb", As::Atlas, "overlaps", ANY),
    (2, "cases/voxels_16_rounds.obj", As::Atlas, "L2 2.7", ANY),
    (2, "cases/voxels_24_rounds.obj", As::Atlas, "L2 260", ANY),
    (2, "assets/adis.STL", As::Atlas, "L2 212", ANY),
    (2, "assets/trayfm.STL", As::Atlas, "L2 64", ANY),
    (2, "assets/cycloidal.ply", As::Atlas, "L2 196", ANY),
    (2, "cases/menger2.obj", As::Atlas, "L2 69", ANY),
    (2, "cases/ramp_100_turns.obj", As::Atlas, "20 976 overlaps", ANY),
    (3, "assets/engine2.glb", As::Atlas, "exit 2, nothing written", ANY),
    (4, "cases/cad-halftube-1000-180.obj", As::Whole, "168 × 934 for 157.08 × 1000", EXACT),
    (4, "cases/cad-halftube-6000-360.obj", As::Whole, "L2 2.63", EXACT),
    (4, "cases/cad-halftube-6000-360.obj", As::Atlas, "720 charts", EXACT),
    (4, "cases/flat_fan_2000.obj", As::Whole, "L2 1.24", EXACT),
    (4, "cases/flat_fan_10000.obj", As::Whole, "L2 29.6, overlaps", EXACT),
    (4, "cases/flat_rect_10000x1.obj", As::Atlas, "two charts, none shorter", EXACT),
    (4, "cases/flat-aniso1000.obj", As::Whole, "L2 2.25", EXACT),
    (4, "cases/flat-aniso1000.obj", As::Atlas, "51 charts, L2 6.26", Right { above_one: 1e-7, ..EXACT }),
    (5, "cases/plate-round-0.obj", As::Atlas, "L∞ 3.0", EXACT),
    (5, "cases/scroll-small-r12-n0.obj", As::Atlas, "34 charts", Right { above_one: 5e-4, ..ONE }),
    (6, "cases/open_tube_6.obj", As::Atlas, "38°", exact(1, 1e-6)),
    (6, "cases/open_tube_32.obj", As::Atlas, "46.7°", exact(1, 1e-6)),
    (6, "cases/open_tube_32x8.obj", As::Atlas, "L∞ 2.5", exact(1, 1e-6)),
    (7, "cases/cube.obj", As::Atlas, "23.6°", exact(1, 1e-6)),
    (7, "cases/letter_e.obj", As::Atlas, "31°", exact(2, 1e-6)),
    (7, "cases/text_model.obj", As::Atlas, "36 charts", exact(24, 1e-6)),
    (7, "cases/room_without_a_wall.obj", As::Atlas, "skewed", exact(1, 1e-6)),
    // Vertices on their creases are off the line by the rounding of 32 bits: their angles sum to 360° but for 5e-6° and 7e-4°.
    (7, "assets/storey.glb", As::Atlas, "skewed", exact(6, 5e-6)),
    (7, "assets/pins.glb", As::Atlas, "skewed", exact(16, 5e-4)),
    (8, "cases/beyond_repair_17tri.obj", As::Atlas, "exit 2, refused", ANY),
    (9, "cases/soup_icosphere.obj", As::Atlas, "a chart per triangle", ONE),
    (9, "cases/threejs_sphere.glb", As::Atlas, "its seam stays open", ONE),
    (9, "cases/cone_pole_copies.obj", As::Atlas, "its seam stays open", ONE),
    (9, "cases/io-soup.obj", As::Atlas, "a chart per triangle", ONE),
    (10, "assets/many-cubes.gltf", As::Atlas, "all cubes of one size", exact(501, 1e-6)),
    (12, "cases/slit-and-hole-z0.obj", As::Atlas, "injective no", EXACT),
    (12, "cases/heli_touch.obj", As::Atlas, "cut in two", EXACT),
    (14, "cases/coil_20_turns.obj", As::Atlas, "0.5 % covered", Right { coverage: 0.3, ..ANY }),
    (14, "cases/fence_and_box.obj", As::Atlas, "0.1 % covered", Right { coverage: 0.3, ..exact(2, 1e-6) }),
    (20, "cases/zero_count_indices.glb", As::Atlas, "exit 2, refused", ANY),
    (20, "cases/km_and_tenth_mm.obj", As::Atlas, "80 faces without area", ANY),
];

/// A file beside the models, or nothing, which is said.
#[allow(clippy::print_stdout, reason = "what is skipped is said")]
fn beside_the_models(name: &str) -> Option<PathBuf> {
    let Some(models) = std::env::var_os("ABF_MODELS").map(PathBuf::from) else {
        println!("ABF_MODELS is not set: {name} skipped");
        return None;
    };
    assert!(models.is_dir(), "ABF_MODELS names {}, which is no folder", models.display());
    let file = models.join("..").join(name);
    if !file.exists() {
        println!("{} is not there: skipped", file.display());
    }
    Some(file).filter(|file| file.exists())
}

fn figure(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::INFINITY)
}

/// Every chart as it is written, or of the only disk what is said of it.
fn stretches(result: &Value) -> Vec<f64> {
    match result["atlas"]["charts"].as_array() {
        Some(charts) => charts.iter().map(|chart| figure(&chart["stretch_l2"])).collect(),
        None => vec![figure(&result["stretch_l2"])],
    }
}

/// What is wrong with a run.
fn faults(ran: &Ran, right: &Right) -> Vec<String> {
    let result = ran.result();
    let mut faults = Vec::new();
    let mut expect = |is_so: bool, what: String| {
        if !is_so {
            faults.push(what);
        }
    };
    expect(ran.code == 0, format!("exit code {}: {}", ran.code, ran.stderr.trim()));
    expect(
        result["valid"] == true && result["injective"] == true,
        format!("valid {}, injective {}", result["valid"], result["injective"]),
    );
    let charts = result["atlas"]["charts"].as_array().cloned().unwrap_or_default();
    let is_whole = |chart: &Value| chart["valid"] == true && chart["injective"] == true && chart["unfinished"] == false;
    expect(charts.iter().all(is_whole), "a chart is not as it should be".to_owned());
    let stretches = stretches(&result);
    let worst = stretches.iter().copied().fold(0.0, f64::max);
    expect(stretches.len() <= right.charts, format!("{} charts", stretches.len()));
    expect(worst - 1.0 <= right.above_one, format!("L2 1 + {:.3e}", worst - 1.0));
    let degrees = figure(&result["max_angle_error"]).to_degrees();
    expect(right.degrees == f64::INFINITY || degrees <= right.degrees, format!("{degrees:.2e}°"));
    let coverage = result["atlas"]["coverage"].as_f64().unwrap_or(0.0);
    expect(right.coverage == 0.0 || coverage >= right.coverage, format!("{coverage:.3} covered"));
    faults
}

#[test]
fn every_kind_of_model_comes_out_right() {
    let mut wrong = Vec::new();
    for (row, name, how, once, right) in ROWS {
        let Some(file) = beside_the_models(name) else { continue };
        let options = if *how == As::Atlas { "--atlas one --json -" } else { "--json -" };
        for fault in faults(&run_on(options, &[&file]), right) {
            wrong.push(format!("row {row}, {name} (once {once}): {fault}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_row_is_named() {
    // Rows with figures, and those below. Row 13 is that of real units: `sheet.rs`.
    let by_figures: std::collections::BTreeSet<u32> = ROWS.iter().map(|row| row.0).collect();
    let others = [10, 11, 13, 15, 16, 17, 18, 19, 20];
    assert!((1..=20).all(|row| by_figures.contains(&row) || others.contains(&row)));
}

/// Row 9: what has its vertices twice comes out as its twin with joined vertices.
#[test]
fn a_soup_has_the_charts_of_its_welded_twin() {
    let folder = Folder::new();
    let twin = surfaces::torus();
    let points: Vec<&str> = twin.lines().filter(|line| line.starts_with("v ")).collect();
    let mut soup = String::new();
    let mut faces = String::new();
    for (i, face) in twin.lines().filter(|line| line.starts_with("f ")).enumerate() {
        for corner in face.split_whitespace().skip(1) {
            soup += points[corner.parse::<usize>().expect("a number") - 1];
            soup.push('\n');
        }
        faces += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    let of = |name: &str, text: String| run_on("--json -", &[&folder.file(name, text)]).result();
    let (of_soup, of_twin) = (of("soup.obj", soup + &faces), of("twin.obj", twin));
    assert_eq!(stretches(&of_soup), stretches(&of_twin));
    assert_eq!(of_soup["atlas"]["seam_length"], of_twin["atlas"]["seam_length"]);
    let Some(sphere) = beside_the_models("cases/soup_icosphere.obj") else { return };
    let off = run_on("--weld off --atlas one --json -", &[&sphere]).result();
    assert!(stretches(&off).len() > 1, "every triangle is a component");
}

/// Row 10: texels are in the ratio of the areas in the scene.
#[test]
fn instances_of_other_sizes_have_texels_in_the_ratio_of_their_areas() {
    let Some(file) = beside_the_models("cases/node_scales.glb") else { return };
    let folder = Folder::new();
    let out = folder.path("out.obj");
    let options = format!("--atlas one --json - -o {}", folder.path("out.glb").display());
    let ran = run_on(&options, &[&file]);
    assert!(faults(&ran, &ANY).is_empty(), "{}", ran.stderr);
    assert!(run_on(&format!("--atlas one -o {}", out.display()), &[&file]).code == 0);
    // All charts at one scale of the scene: no area is stretched.
    assert!(figure(&ran.result()["area_l2"]) < 1e-6, "{}", ran.result()["area_l2"]);
    assert!(figure(&ran.result()["stretch_l2"]) < 1.0 + 1e-6);
}

/// Row 11: `metrics` says of a file what the run said (`metrics.rs` has more of it).
#[test]
fn double_sided_models_are_judged_as_they_were_written() {
    for name in ["cases/doublesided.obj", "assets/chair.obj"] {
        let Some(file) = beside_the_models(name) else { continue };
        for sides in ["own", "shared"] {
            let folder = Folder::new();
            let out = folder.path("out.obj");
            let ran = run_on(&format!("--atlas one --double-sided {sides} --json - -o {}", out.display()), &[&file]);
            let of_file = run_on("metrics --json -", &[&out]).result();
            for field in ["flips", "overlaps", "shared", "turned", "injective", "stretch_l2"] {
                assert_eq!(ran.result()[field], of_file[field], "{name} {sides}: {field}");
            }
            assert!(faults(&ran, &ANY).is_empty(), "{name} {sides}: {}", ran.stderr);
        }
    }
}

/// Row 15: charts under a texel wide, and places narrower than the margin, are counted.
#[test]
fn charts_under_a_texel_are_counted_in_the_json_and_in_the_table() {
    let folder = Folder::new();
    // A square, and a strip of a thousandth of its height.
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 2.0], [1.0, 2.0], [1.0, 2.001], [0.0, 2.001]];
    let points = points.map(|[x, y]| [x, y, 0.0]);
    let mesh = folder.file("two.obj", surfaces::obj(&points, &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]));
    for (resolution, thin) in [(64, 1), (4096, 0)] {
        let options = format!("--max-chart-length inf --resolution {resolution}");
        let result = run_on(&format!("{options} --json -"), &[&mesh]).result();
        assert_eq!(result["atlas"]["under_a_texel"], thin, "{resolution}");
        let table = run_on(&options, &[&mesh]).stdout;
        assert_eq!(table.contains("1 chart less than a texel wide"), thin == 1, "{table}");
    }
}

/// Row 14: beside others, what is long and cannot be parted is made smaller, and that is said.
#[test]
fn a_long_face_is_made_smaller_beside_others_and_left_as_it_is_alone() {
    let folder = Folder::new();
    let fence = [[0.0, 0.0], [900.0, 0.0], [900.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0]);
    let panel = [[0.0, 5.0], [3.0, 5.0], [3.0, 8.0], [0.0, 8.0]].map(|[x, y]| [x, y, 0.0]);
    let both = surfaces::obj(&[fence, panel].concat(), &[[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]]);
    let alone = surfaces::obj(&fence, &[[0, 1, 2], [0, 2, 3]]);
    let (both, alone) = (folder.file("both.obj", both), folder.file("alone.obj", alone));
    let ran = run_on("--json -", &[&both]);
    assert!(faults(&ran, &Right { coverage: 0.3, ..exact(2, 1e-6) }).is_empty(), "{:?}", ran.result()["atlas"]);
    let scales = |ran: &Ran| -> Vec<f64> {
        let charts = ran.result()["atlas"]["charts"].as_array().cloned().unwrap_or_default();
        charts.iter().map(|chart| figure(&chart["scale"])).collect()
    };
    let [long, other] = scales(&ran)[..] else { panic!("two charts") };
    assert!(long < 0.01 && other == 1.0, "{long} {other}");
    assert!(ran.stderr.contains("made smaller than the others (--max-chart-length)"), "{}", ran.stderr);
    assert_eq!(scales(&run_on("--json - --max-chart-length inf", &[&both])), [1.0, 1.0]);
    assert_eq!(scales(&run_on("--json - --atlas one", &[&alone])), [1.0]);
    // A sheet has no pages: everything at its size.
    assert_eq!(scales(&run_on("--json - --units real", &[&both])), [1.0, 1.0]);
}

/// Row 16: without time, all is written with a valid map, and what is not finished is marked.
#[test]
fn without_time_everything_has_a_valid_map_and_is_marked() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let out = folder.path("out.obj");
    let ran = run_on(&format!("--time-limit 0 --json - -o {}", out.display()), &[&torus]);
    let result = ran.result();
    assert_eq!((ran.code, &result["valid"], &result["injective"]), (1, &true.into(), &true.into()), "{}", ran.stderr);
    let charts = result["atlas"]["charts"].as_array().expect("charts");
    assert!(charts.iter().all(|chart| chart["unfinished"] == true), "{result}");
    assert_eq!(charts.iter().filter_map(|chart| chart["triangles"].as_u64()).sum::<u64>(), 128);
    assert_eq!(run_on("metrics --json -", &[&out]).result()["valid"], true);
}

/// Row 17: a picture of many parts in one place is drawn.
#[test]
fn a_scene_of_many_parts_is_drawn() {
    let Some(file) = beside_the_models("assets/many-cubes.gltf") else { return };
    let folder = Folder::new();
    let picture = folder.path("out.png");
    let ran = run_on(&format!("--atlas one --json - --png {}", picture.display()), &[&file]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(std::fs::read(picture).expect("written").starts_with(b"\x89PNG"));
}

/// Row 18: what cannot be done names the next thing to try, which is not what was just given.
#[test]
fn a_page_that_is_too_small_names_what_to_try() {
    let folder = Folder::new();
    let many: Vec<[f64; 3]> =
        (0..300).flat_map(|i| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| [x, y, f64::from(i)])).collect();
    let faces: Vec<[usize; 3]> = (0..300).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = folder.file("many.obj", surfaces::obj(&many, &faces));
    let ran = run_on("--resolution 32 --margin 8 --json -", &[&mesh]);
    let error = &ran.result()["error"];
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    let hint = error["hint"].as_str().expect("a hint");
    assert!(hint.contains("--resolution") || hint.contains("--margin") || hint.contains("--max-pages"), "{hint}");
}

/// The same OBJ with its vertices and faces in another order, faces beginning at other corners.
fn shuffled(text: &str, step: usize) -> String {
    let points: Vec<&str> = text.lines().filter(|line| line.starts_with("v ")).collect();
    let faces: Vec<Vec<usize>> = text
        .lines()
        .filter(|line| line.starts_with("f "))
        .map(|line| {
            line.split_whitespace()
                .skip(1)
                .map(|word| word.split('/').next().unwrap_or(word).parse().expect("a number"))
                .collect()
        })
        .collect();
    // A step without a common divisor goes through all.
    let order = |count: usize| {
        let gcd = |mut a: usize, mut b: usize| {
            while b > 0 {
                (a, b) = (b, a % b);
            }
            a
        };
        let step = (step..).find(|&step| gcd(step, count) == 1).unwrap_or(1);
        (0..count).map(move |i| (i * step + 7) % count)
    };
    let mut place = vec![0; points.len()];
    let mut out = String::new();
    for (i, v) in order(points.len()).enumerate() {
        place[v] = i + 1;
        out += points[v];
        out.push('\n');
    }
    for f in order(faces.len()) {
        let mut face: Vec<String> = faces[f].iter().map(|v| place[v - 1].to_string()).collect();
        let count = face.len();
        face.rotate_left((step + f) % count);
        out += &format!("f {}\n", face.join(" "));
    }
    out
}

/// Row 19: the order of vertices and faces decides nothing.
#[test]
fn the_order_of_a_file_decides_neither_charts_nor_seams() {
    let folder = Folder::new();
    let mut meshes = vec![("torus", surfaces::torus_with_a_hole())];
    if let Some(homer) = beside_the_models("assets/homer.obj") {
        meshes.push(("homer", std::fs::read_to_string(homer).expect("read")));
    }
    for (name, text) in meshes {
        let of = |text: &str| {
            let result = run_on("--atlas one --pack fast --json -", &[&folder.file("mesh.obj", text)]).result();
            (stretches(&result).len(), figure(&result["atlas"]["seam_length"]))
        };
        let (charts, seams) = of(&text);
        for step in [1009, 4001, 7919] {
            let (other, length) = of(&shuffled(&text, step));
            assert_eq!(other, charts, "{name}, step {step}");
            assert!((length / seams - 1.0).abs() < 1e-9, "{name}, step {step}: {length} is not {seams}");
        }
    }
}

/// Row 20: what small oddities of files are kept or passed over.
#[test]
fn colours_are_kept_and_parts_of_other_sizes_have_their_areas() {
    if let Some(file) = beside_the_models("cases/io-colours.ply") {
        let folder = Folder::new();
        let out = folder.path("out.ply");
        run_on(&format!("--atlas one -o {}", out.display()), &[&file]);
        let written = std::fs::read(&out).expect("written");
        let head = String::from_utf8_lossy(&written[..written.len().min(1000)]).into_owned();
        assert!(head.contains("red") && head.contains("blue"), "{head}");
    }
    if let Some(file) = beside_the_models("cases/km_and_tenth_mm.obj") {
        let folder = Folder::new();
        for format in ["obj", "glb"] {
            let out = folder.path(&format!("out.{format}"));
            let ran = run_on(&format!("--atlas one --json - -o {}", out.display()), &[&file]);
            assert!(faults(&ran, &ANY).is_empty(), "{format}: {}", ran.stderr);
            assert!(!ran.stderr.contains("without area"), "{}", ran.stderr);
            assert_eq!(file_is_valid(&out), true, "{format}");
        }
    }
}

fn file_is_valid(file: &Path) -> Value {
    run_on("metrics --json -", &[file]).result()["injective"].clone()
}
