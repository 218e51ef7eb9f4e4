//! Seams as lines.

use abf_mesh::TriMesh;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The seams as an OBJ of lines.
pub(crate) fn seam_lines(mesh: &TriMesh, seams: &[[abf_mesh::VertexId; 2]]) -> String {
    let mut number: BTreeMap<_, usize> = seams.iter().flatten().map(|&v| (v, 0)).collect();
    let mut out = String::new();
    // Writing to a string cannot fail.
    for (i, (v, n)) in number.iter_mut().enumerate() {
        *n = i + 1;
        let p = mesh.positions()[v.index()];
        let _ = writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b] in seams {
        let _ = writeln!(out, "l {} {}", number[a], number[b]);
    }
    out
}
