//! Any mesh file to charts in an atlas: `cargo run --release -p abf --example unwrap -- in.obj out.obj`.

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use abf::mesh::io;
use abf::{Atlas, Silent, Stored, SurfaceHints, Unwrap};
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
            metrics.certificate.overlaps(),
            chart.rounds,
            chart.holes_filled
        );
    }
    println!("seams: {:.3} of the diagonal", unwrapped.seam_length / unwrapped.diagonal);

    // OBJ and PLY store doubles; `mesh::io::stored_uv` is what glTF makes of a UV.
    let packed = Atlas::default().pack(&mesh, &unwrapped, None, Stored::default())?;
    println!("{:.0}% of the page covered, without overlap {}", 100.0 * packed.coverage, packed.metrics.injective());
    let uv = packed.uv;
    io::write(Path::new(&output), &mesh, Some(&uv))?;
    Ok(())
}
