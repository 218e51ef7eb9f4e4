//! What researchers ask for: errors of every triangle, charts as drawings, the KKT matrix, the papers' figures.

use crate::support::{Folder, fixture, run_on};
use std::fs;
use std::path::Path;

#[test]
fn errors_are_written_as_rows_as_a_mesh_and_as_a_drawing() {
    let folder = Folder::new();
    let mesh = fixture("letter-v");
    let [csv, ply, svg] = ["e.csv", "e.ply", "e.svg"].map(|name| folder.path(name));
    let mut f = 0.0;
    for file in [&csv, &ply, &svg] {
        let ran = run_on(&format!("--json - --errors {}", file.display()), &[&mesh]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.result()["written"].to_string().contains("e."), "{}", ran.stdout);
        f = ran.result()["f"].as_f64().expect("F");
    }
    let text = fs::read_to_string(&csv).expect("written");
    let heads: Vec<&str> = text.lines().next().expect("a head").split(',').collect();
    let errors: Vec<usize> = (0..heads.len()).filter(|&k| heads[k].starts_with("angle_error_")).collect();
    let squares = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        errors.iter().map(|&k| cells[k].parse::<f64>().expect("an error").powi(2)).sum::<f64>()
    };
    let rows = text.lines().count() - 1;
    let mean = text.lines().skip(1).map(squares).sum::<f64>() / (3 * rows) as f64;
    assert!((mean - f).abs() < 1e-9 * f, "the rows add up to F: {mean} {f}");
    let read = run_on("--disks-only --json -", &[&ply]);
    assert_eq!((read.code, &read.result()["triangles"]), (0, &rows.into()), "{}", read.stderr);
    let drawing = fs::read_to_string(&svg).expect("written");
    roxmltree::Document::parse(&drawing).expect("SVG");
    let bad = run_on(&format!("--errors {}", folder.path("e.txt").display()), &[&mesh]);
    assert!(bad.code == 2 && bad.stderr.contains("must end in .csv or .ply or .svg"), "{}", bad.stderr);
}

#[test]
fn every_chart_of_a_comparison_is_a_drawing_of_its_own() {
    let folder = Folder::new();
    let plots = folder.path("plots");
    let ran = run_on(
        &format!("compare --repeats 1 --solver minres,descent --plots {}", plots.display()),
        &[&fixture("letter-v"), &fixture("pyramid")],
    );
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for name in ["outer", "time", "inner", "energy-abf", "histogram"] {
        let file = plots.join(format!("letter-v-{name}.svg"));
        let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        roxmltree::Document::parse(&text).expect("SVG");
    }
    assert!(plots.join("pyramid-time.svg").exists());
}

#[test]
fn the_matrix_is_counted_and_drawn_with_both_wheels() {
    let folder = Folder::new();
    let [png, svg] = ["kkt.png", "kkt.svg"].map(|name| folder.path(name));
    let options = format!("sparsity --png {} --svg {}", png.display(), svg.display());
    let ran = run_on(&options, &[&fixture("bumpy-sheet")]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stdout.contains("97164") && ran.stdout.contains("46464"), "{}", ran.stdout);
    assert!(fs::read(&png).expect("written").starts_with(b"\x89PNG"));
    assert!(fs::read_to_string(&svg).expect("written").contains("8882 rows, 97164 entries"));
    let closed = folder.file("torus.obj", crate::surfaces::torus());
    let refused = run_on("sparsity", &[&closed]);
    assert!(refused.code == 2 && refused.stderr.contains("torus.obj"), "{}", refused.stderr);
}

#[test]
fn one_pass_turns_a_triangle_over_and_a_second_mends_it() {
    let mesh = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/two-passes.obj");
    let flips = |passes: usize| {
        let options = format!("--disks-only --solver linabf --passes {passes} --layout least-squares --json -");
        let result = run_on(&options, &[&mesh]).result();
        (result["flips"].as_u64(), result["valid"].as_bool())
    };
    assert_eq!([1, 2].map(flips), [(Some(1), Some(false)), (Some(0), Some(true))]);
}
