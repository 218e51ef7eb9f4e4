//! Writes a page about made-up runs on generated meshes, to look at: `cargo run -p abf-report --example sample_page`.
//!
//! The layouts are projections and the figures beside them are invented; only the pictures, the
//! histogram and the columns that the page measures itself are true.

#![allow(clippy::print_stdout)]

use abf_mesh::{Point2, TriMesh, UvMap};
use abf_report::page::{Cell, MeshFragment, MeshSection, SolverRun, assemble};
use abf_report::svg::{SvgStyle, layout_svg};
use abf_shapes::Shape;

const SOLVERS: [&str; 8] =
    ["linabf", "abf", "abf++", "newton", "uzawa", "uzawa-published", "minres", "least-squares-conformal"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let meshes = [
        ("mask", Shape::Mask, 20_000),
        ("hemisphere", Shape::Hemisphere, 6_000),
        ("letter-x", Shape::LetterX, 4_800),
        ("bumpy <sheet>", Shape::BumpySheet, 1_800),
        ("spiky-field", Shape::SpikyField, 10_000),
        ("wavy-saddle", Shape::WavySaddle, 20_000),
        ("folded-sheet", Shape::FoldedSheet, 2_000),
    ];
    let folder = std::env::temp_dir();
    let mut fragments = Vec::new();
    for (name, shape, triangles) in meshes {
        let mesh = shape.mesh(triangles);
        let fragment = MeshFragment::render(&MeshSection {
            name,
            mesh: Some(&mesh),
            runs: runs(&mesh, &layouts(&mesh)),
            ..MeshSection::default()
        });
        println!("{name}: {} triangles, {} bytes", mesh.face_count(), fragment.bytes());
        fragments.push(fragment);
    }
    let machine =
        [("processor", "2 cores of a test machine"), ("program", "sample_page 0.1.0"), ("repeats", "5 after 1")];
    let machine: Vec<(String, String)> = machine.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec();
    let page = assemble("Angle based flattening: a sample page", &machine, &fragments);
    let path = folder.join("sample-page.html");
    std::fs::write(&path, &page)?;
    println!("{}: {} bytes", path.display(), page.len());

    let mesh = Shape::BumpySheet.mesh(1_800);
    let path = folder.join("sample-layout.svg");
    std::fs::write(
        &path,
        layout_svg(&mesh, &layouts(&mesh)[0], None, &SvgStyle { mm_per_uv: 100.0, ..SvgStyle::default() })?,
    )?;
    println!("{}", path.display());
    Ok(())
}

/// A layout for each solver but for the last two: the projection along z, bent more and more.
fn layouts(mesh: &TriMesh) -> Vec<UvMap> {
    let size = mesh.positions().iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let bent = |k: usize| {
        let strength = 0.08 * k as f64 / size;
        let bend = |x: f64, y: f64| Point2::new(x + strength * y * y, y - strength * x * y);
        let uv: Vec<Point2<f64>> = mesh.positions().iter().map(|p| bend(p.x, p.y)).collect();
        UvMap::per_vertex(mesh, &uv)
    };
    (0..SOLVERS.len() - 1).map(bent).collect()
}

fn runs<'a>(mesh: &'a TriMesh, layouts: &'a [UvMap]) -> Vec<SolverRun<'a>> {
    let run = |(k, solver): (usize, &'a &'static str)| SolverRun {
        solver,
        settings: [
            ("tolerance", "1e-9"),
            ("passes", "50"),
            ("wheel", if k % 2 == 0 { "logarithmic" } else { "product" }),
        ]
        .map(|(name, value)| (name.to_owned(), value.to_owned()))
        .to_vec(),
        uv: layouts.get(k),
        columns: if k < layouts.len() { columns(mesh, &layouts[k], k) } else { Vec::new() },
        failure: (k == layouts.len())
            .then(|| "stopped after 50 passes: the constraint residual is 0.031, more than 1e-9".to_owned()),
        outer: outer(k),
        inner: if [4, 6].contains(&k) { inner(k) } else { Vec::new() },
        timed: outer(k).into_iter().map(|(i, r)| (0.01 * i * (1.0 + k as f64), r)).collect(),
        energies: vec![(if k < 6 { "abf" } else { "isometric" }.to_owned(), outer(k))],
    };
    SOLVERS.iter().enumerate().map(run).collect()
}

fn columns(mesh: &TriMesh, uv: &UvMap, k: usize) -> Vec<(String, Cell)> {
    let number = |value: f64, shown: String| Cell::Number { value, shown };
    let Ok(m) = abf_metrics::measure(mesh, uv) else { return Vec::new() };
    let seconds = 0.01 * mesh.face_count() as f64 / 1e3 * (1.0 + 3.0 * k as f64);
    let count = |head: &str, n: usize| (head.to_owned(), number(n as f64, n.to_string()));
    let time = |head: &str, s: f64| (head.to_owned(), number(s, format!("{s:.3} s")));
    // As many columns as a comparison by the program has.
    vec![
        ("by".to_owned(), Cell::Text("abf-fixed-target".to_owned())),
        ("result".to_owned(), Cell::Text("max-iterations".to_owned())),
        count("outer", 3 + k),
        count("inner", 700 * k),
        ("residual".to_owned(), number(1e-9, "1.0e-9".to_owned())),
        ("worst inner".to_owned(), number(1e-9, "9.9e-9".to_owned())),
        count("negative", 20 * k),
        count("fallbacks", k),
        ("F/3nt".to_owned(), number(m.f, format!("{:.3e}", m.f))),
        ("L2 stretch".to_owned(), number(m.stretch_l2, format!("{:.4}", m.stretch_l2))),
        ("L∞ stretch".to_owned(), number(m.stretch_linf, format!("{:.3}", m.stretch_linf))),
        time("time", seconds),
        time("least", 0.9 * seconds),
        time("greatest", 1.2 * seconds),
        ("MB".to_owned(), if k == 0 { Cell::Missing } else { number(12.0 * k as f64, (12 * k).to_string()) }),
        ("remark".to_owned(), Cell::Text("not converged after 50 iterations: try --solver auto".to_owned())),
    ]
}

fn outer(k: usize) -> Vec<(f64, f64)> {
    let rate: f64 = if k < 4 { 2.0 } else { 1.15 };
    let residual = |i: i32| 10_f64.powf(-0.6 * rate.powi(i) * (1.0 - 0.07 * k as f64) + 0.6);
    (0..30).map(|i| (f64::from(i), residual(i))).take_while(|(_, r)| *r > 1e-14).collect()
}

fn inner(k: usize) -> Vec<f64> {
    (0..600)
        .map(|i| 10_f64.powf(-f64::from(i) / (40.0 + 9.0 * k as f64)) * (1.2 + (f64::from(i) * 0.7).sin()))
        .collect()
}
