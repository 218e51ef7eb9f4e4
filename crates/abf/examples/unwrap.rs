//! Any mesh file to charts side by side: `cargo run --release -p abf --example unwrap -- in.obj out.obj`.

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use abf::mesh::{Point2, Vector2, io};
use abf::{Silent, SurfaceHints, Unwrap};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (Some(input), Some(output)) = (args.next(), args.next()) else {
        return Err("usage: unwrap IN OUT".into());
    };
    let mesh = io::read(Path::new(&input))?.mesh;
    let unwrapped = Unwrap::default().run(&mesh, &SurfaceHints::default(), &mut Silent)?;
    unwrapped.repairs.sentences().iter().for_each(|done| println!("{done}"));
    for chart in &unwrapped.charts {
        let metrics = &chart.metrics;
        println!(
            "{} faces: F/3nt {:.3e}, L2 {:.3}, {}, {} overlaps, {} rounds, {} holes filled",
            chart.faces.len(),
            metrics.f,
            metrics.stretch_l2,
            if chart.is_certified() { "certified" } else { "not certified" },
            metrics.overlaps(),
            chart.rounds,
            chart.holes_filled
        );
    }
    println!("seams: {:.3} of the diagonal", unwrapped.seam_length / unwrapped.diagonal);

    // One chart beside the other, each from its lower left corner.
    let mut right = 0.0;
    let mut shifts = Vec::new();
    for (low, high) in unwrapped.charts.iter().filter_map(|chart| chart.uv.bounds()) {
        shifts.push(Vector2::new(right, 0.0) - low.coords);
        right += 1.05 * (high.x - low.x);
    }
    let uv = unwrapped.assemble(|chart, p: Point2<f64>| p + shifts[chart]);
    io::write(Path::new(&output), &mesh, Some(&uv))?;
    Ok(())
}
