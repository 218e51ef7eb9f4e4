//! The same figures from an independent program.
//!
//! `scripts/judge` prints one JSON object of metrics for every file it is given. It needs `python3` and nothing else.

#![allow(clippy::print_stderr, reason = "a test that is skipped says so")]

mod support;

use abf_mesh::{TriMesh, UvMap, VertexId};
use abf_metrics::{Metrics, measure};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use support::{Noise, mesh, sheet, uv_map};

/// How far two independent computations may be apart, relative.
const TOLERANCE: f64 = 1e-6;

#[test]
fn an_independent_program_finds_the_same_figures() {
    let Some(judge) = judge() else {
        eprintln!("skipped: there is no python3 to run scripts/judge");
        return;
    };
    let cases = cases();
    let dir = tempfile::tempdir().expect("a temporary directory");
    let files: Vec<PathBuf> = cases.iter().map(|(name, mesh, uv)| write_obj(dir.path(), name, mesh, uv)).collect();
    let output = Command::new("python3").arg(judge).args(&files).output().expect("python3 runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert_eq!(text.lines().count(), cases.len());
    for ((name, mesh, uv), line) in cases.iter().zip(text.lines()) {
        let theirs: Value = serde_json::from_str(line).expect("one JSON object a line");
        compare(name, &measure(mesh, uv).expect("a mesh with UVs"), &theirs);
    }
}

fn judge() -> Option<PathBuf> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/judge");
    assert!(script.is_file(), "{} is missing", script.display());
    let python = Command::new("python3").arg("--version").output();
    python.is_ok_and(|output| output.status.success()).then_some(script)
}

fn compare(name: &str, ours: &Metrics, theirs: &Value) {
    let count = |key: &str| usize::try_from(theirs[key].as_u64().expect("a count")).expect("a small count");
    assert_eq!(count("triangles"), ours.triangles, "{name}");
    assert_eq!(count("charts"), ours.certificate.charts, "{name}");
    assert_eq!(count("left_out"), ours.degenerate_3d, "{name}");
    assert_eq!(
        (count("flipped"), count("collapsed"), count("wound")),
        (ours.certificate.flips, ours.certificate.collapsed, ours.certificate.wound),
        "{name}"
    );
    // Overlaps mean something in valid maps only.
    assert_eq!(theirs["injective"].as_bool(), Some(ours.injective()), "{name}: {theirs}");
    // What is within rounding is infinite here, and as far as doubles carry there.
    let within_rounding = ours.certificate.collapsed + ours.certificate.near_collapsed;
    let figures = [
        ("stretch_l2", ours.stretch_l2),
        ("stretch_linf", ours.stretch_linf),
        ("f", ours.f),
        ("f_weighted", ours.f_weighted),
        ("max_angle_error_deg", ours.max_angle_error.to_degrees()),
        ("qc_mean", ours.qc_mean),
        ("qc_max", ours.qc_max),
    ];
    // The logarithm of an area that is all rounding is not comparable.
    let area = (within_rounding == 0).then_some(("area_l2", ours.area_l2));
    for (key, our) in figures.into_iter().chain(area) {
        match theirs[key].as_f64() {
            _ if within_rounding > 0 && !our.is_finite() => {}
            None => assert!(!our.is_finite(), "{name}: {key} is {our}, the other program finds it infinite"),
            Some(their) => {
                assert!((our - their).abs() <= TOLERANCE * their.abs(), "{name}: {key} is {our}, elsewhere {their}");
            }
        }
    }
}

/// Writes 18 significant digits, which name every f64.
fn write_obj(dir: &Path, name: &str, mesh: &TriMesh, uv: &UvMap) -> PathBuf {
    let mut text = String::new();
    for p in mesh.positions() {
        writeln!(text, "v {:.17e} {:.17e} {:.17e}", p.x, p.y, p.z).expect("a string");
    }
    for p in uv.points() {
        writeln!(text, "vt {:.17e} {:.17e}", p.x, p.y).expect("a string");
    }
    for (face, corners) in mesh.faces().iter().zip(uv.corners().chunks_exact(3)) {
        let pairs: Vec<String> =
            face.iter().zip(corners).map(|(v, uv)| format!("{}/{}", v.index() + 1, uv.index() + 1)).collect();
        writeln!(text, "f {}", pairs.join(" ")).expect("a string");
    }
    let path = dir.join(format!("{name}.obj"));
    std::fs::write(&path, text).expect("a temporary file");
    path
}

/// Meshes with UVs: smooth and shaken ones, at several scales, in one chart and many, with
/// triangles that are flipped, thin, collapsed, or without area in space.
fn cases() -> Vec<(String, TriMesh, UvMap)> {
    let mut cases = Vec::new();
    for (i, amplitude) in [0.0, 0.1, 0.3, 0.8, 2.0].into_iter().enumerate() {
        let (mesh, points) = bumpy(i as u64, amplitude);
        cases.push((format!("shaken-{amplitude}"), mesh.clone(), uv_map(&points, &faces(&mesh))));
        for scale in [1e-20, 1e20] {
            let scaled: Vec<[f64; 2]> = points.iter().map(|p| p.map(|x| x * scale)).collect();
            cases.push((format!("shaken-{amplitude}-scaled-{scale:e}"), mesh.clone(), uv_map(&scaled, &faces(&mesh))));
        }
        cases.push((format!("cut-{amplitude}"), mesh.clone(), cut_into_strips(&mesh, &points)));
    }
    cases.extend(damaged());
    cases
}

fn faces(mesh: &TriMesh) -> Vec<[usize; 3]> {
    mesh.faces().iter().map(|face| face.map(VertexId::index)).collect()
}

fn bumpy(seed: u64, amplitude: f64) -> (TriMesh, Vec<[f64; 2]>) {
    let mut noise = Noise(seed);
    let heights: Vec<f64> = (0..13 * 13).map(|_| 1.5 * noise.next()).collect();
    let mesh = sheet(12, |x, y| heights[(13.0 * x + y) as usize]);
    let mut shake = |x: f64| x + amplitude * noise.next();
    let points = mesh.positions().iter().map(|p| [shake(p.x), shake(1.1 * p.y)]).collect();
    (mesh, points)
}

/// A chart for every row of squares, every second one mirrored and each of another size.
fn cut_into_strips(mesh: &TriMesh, points: &[[f64; 2]]) -> UvMap {
    let all = faces(mesh);
    let mut strip_points = Vec::new();
    let mut strip_faces = Vec::new();
    for (s, strip) in all.chunks(24).enumerate() {
        let (scale, side) = (1.0 + s as f64, if s % 2 == 0 { 1.0 } else { -1.0 });
        strip_faces.extend(strip.iter().map(|face| face.map(|v| s * points.len() + v)));
        strip_points.extend(points.iter().map(|&[x, y]| [side * scale * x, scale * y]));
    }
    uv_map(&strip_points, &strip_faces)
}

fn damaged() -> Vec<(String, TriMesh, UvMap)> {
    let (whole, points) = bumpy(40, 0.1);
    let mut cases = Vec::new();

    // A row of vertices on one line, in numbers that have short binary expansions.
    let mut flat = points.clone();
    flat[..26].iter_mut().enumerate().for_each(|(i, p)| *p = [i as f64 / 16.0, i as f64 / 8.0]);
    cases.push(("collapsed".into(), whole.clone(), uv_map(&flat, &faces(&whole))));

    // The same line, each vertex off it by a little less than rounding or a little more.
    let mut noise = Noise(41);
    for (name, distance) in [("near-collapsed", 1e-15), ("thin", 1e-9)] {
        let mut thin = points.clone();
        thin[..26].iter_mut().enumerate().for_each(|(i, p)| {
            *p = [1.0 + i as f64 / 7.0, 1.0 + i as f64 / 7.0 + distance * noise.next()];
        });
        cases.push((name.into(), whole.clone(), uv_map(&thin, &faces(&whole))));
    }

    // Two vertices of the surface in one place.
    let mut positions: Vec<[f64; 3]> = whole.positions().iter().map(|p| [p.x, p.y, p.z]).collect();
    positions[40] = positions[41];
    let pinched = mesh(&positions, &faces(&whole));
    cases.push(("no-area-in-space".into(), pinched, uv_map(&points, &faces(&whole))));
    cases
}
