//! A mesh as an engine keeps it (bevy, wgpu): attributes in arrays, vertices split where normals differ. It gets UVs for a
//! lightmap; every other attribute is copied along the remap.
//!
//! ```text
//! cargo run --release -p abf --example arrays
//! ```

#![allow(clippy::print_stdout, reason = "an example shows what it did")]

use abf::{ArrayUnwrapper, SurfaceHints};
use abf::{Event, Observer, Verdict};

/// What is sent to the GPU.
struct EngineMesh {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    lightmap_uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

/// A cube with hard edges: four vertices to a side.
fn cube() -> EngineMesh {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let first = positions.len() as u32;
            for [u, v] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
                let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
                position[axis] = sign;
                position[(axis + 1) % 3] = u * sign;
                position[(axis + 2) % 3] = v;
                normal[axis] = sign;
                positions.push(position);
                normals.push(normal);
            }
            indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
        }
    }
    EngineMesh { positions, normals, lightmap_uvs: Vec::new(), indices }
}

/// Counts what happens; `Verdict::Stop` would stop it.
#[derive(Default)]
struct Watcher {
    events: usize,
}

impl Observer for Watcher {
    fn observe(&mut self, _: Event<'_>) -> Verdict {
        self.events += 1;
        Verdict::Continue
    }
}

fn main() -> Result<(), abf::ArrayError> {
    let mut mesh = cube();
    let mut watcher = Watcher::default();
    let unwrapper = ArrayUnwrapper::new().resolution(256).margin(2).max_stretch(1.05);
    let flat = unwrapper.run_with(&mesh.positions, &mesh.indices, &SurfaceHints::default(), &mut watcher)?;

    let copied = |attribute: &[[f32; 3]]| flat.remap.iter().map(|&old| attribute[old as usize]).collect();
    (mesh.positions, mesh.normals) = (copied(&mesh.positions), copied(&mesh.normals));
    (mesh.lightmap_uvs, mesh.indices) = (flat.uvs, flat.indices);

    let metrics = &flat.packed.metrics;
    println!(
        "{} vertices with {} normals and {} UVs, {} triangles in {} charts, {:.0}% of the page covered",
        mesh.positions.len(),
        mesh.normals.len(),
        mesh.lightmap_uvs.len(),
        mesh.indices.len() / 3,
        flat.unwrapped.charts.len(),
        100.0 * flat.packed.coverage
    );
    println!("valid {}, without overlap {}, L2 {:.3}", metrics.valid(), metrics.injective(), metrics.stretch_l2);
    println!("{} events were observed", watcher.events);
    Ok(())
}
