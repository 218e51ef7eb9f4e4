//! Whole models: closed, with handles and holes, broken. `docs/seams.md` cites what is printed here.
//!
//! `ABF_MODELS` as in `support`; the tests look into `raw/` and `paper/`.

#![allow(clippy::print_stdout, reason = "the numbers are the point")]

mod support;

use abf::mesh::TriMesh;
use abf::{Silent, SurfaceHints, Unwrap, Unwrapped};
use std::time::Instant;
use support::{models, read};

fn unwrap(settings: &Unwrap, mesh: &TriMesh) -> Unwrapped {
    settings.run(mesh, &SurfaceHints::default(), &mut Silent).expect("charts")
}

fn env(name: &str, or: f64) -> f64 {
    std::env::var(name).ok().map_or(or, |s| s.parse().expect("number"))
}

#[test]
fn explore() {
    let Some(folder) = models(1) else { return };
    let d = Unwrap::default();
    let settings = Unwrap {
        max_stretch: env("S", d.max_stretch),
        terminals: env("T", d.terminals as f64) as usize,
        spacing: env("A", d.spacing),
        costs: abf::cut::CostSettings { crease: env("C", d.costs.crease), hidden: env("H", d.costs.hidden) },
        ..d
    };
    let names = std::env::var("M").unwrap_or("foot,gargoyle,horse".into());
    for name in names.split(',') {
        let mesh = read(&folder, &format!("raw/{name}.obj"));
        let t = Instant::now();
        let u = unwrap(&settings, &mesh);
        println!(
            "{name}: {} charts, seam {:.3}, {:.1}s, repairs {:?}",
            u.charts.len(),
            u.seam_length / u.diagonal,
            t.elapsed().as_secs_f64(),
            u.repairs.sentences()
        );
        for c in &u.charts {
            if u.charts.len() > 6 && c.is_certified() && c.metrics.stretch_l2 < 1.2 && c.metrics.overlaps() == 0 {
                continue;
            }
            println!(
                "   {} faces, rounds {}, F {:.4e}, L2 {:.4}, valid {}, overlaps {}, {} {:?}, holes {} layout error {:.1e}",
                c.faces.len(),
                c.rounds,
                c.metrics.f,
                c.metrics.stretch_l2,
                c.metrics.valid(),
                c.metrics.overlaps(),
                c.solver,
                c.termination,
                c.holes_filled,
                c.layout_error.unwrap_or(f64::NAN)
            );
        }
    }
}
