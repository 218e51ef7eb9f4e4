//! Prints every UV of some results, bit by bit, so that two builds can be compared.
//!
//! `cargo run -p abf --no-default-features --example bits` has to print what a build with all features prints.

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use abf::{ArrayUnwrapper, Pipeline, Silent};
use abf_shapes::Shape;
use std::error::Error;
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn Error>> {
    let mask = Shape::Mask.mesh(3000);
    for name in ["linabf", "abf++", "barrier", "descent"] {
        let pipeline = Pipeline { solver: name.parse()?, ..Pipeline::default() };
        let flat = pipeline.run(&mask, &mut Silent)?;
        for point in flat.uv.points() {
            println!("{name} {:016x} {:016x}", point.x.to_bits(), point.y.to_bits());
        }
    }
    let (positions, indices) = torus(48, 24);
    let unwrapped = ArrayUnwrapper::new().run(&positions, &indices)?;
    for ([u, v], vertex) in unwrapped.uvs.iter().zip(&unwrapped.remap) {
        println!("torus {vertex} {:08x} {:08x}", u.to_bits(), v.to_bits());
    }
    Ok(())
}

/// A torus of `around` by `across` quads, two triangles each.
fn torus(around: u32, across: u32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (a, b) = (TAU * f64::from(i) / f64::from(around), TAU * f64::from(j) / f64::from(across));
            let r = 2.0 + b.cos();
            positions.push([r * a.cos(), r * a.sin(), b.sin()].map(|x| x as f32));
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            faces.extend([[p, q, r], [p, r, s]]);
        }
    }
    (positions, faces.into_flattened())
}
