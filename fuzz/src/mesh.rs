//! From bytes to a small mesh, mostly a disk: a fuzzer that only met refusals would find nothing behind them.

use abf::mesh::{Point3, TriMesh};
use abf::{Precision, Solver};

/// More vertices tell nothing that fewer do not.
const MOST: usize = 40;

/// The first byte: which solver, which precision, which way to faces. Then triples of bytes: a vertex each,
/// the first four bits of every coordinate an exponent. What is left over are faces, or where they are glued.
pub(crate) fn decode(bytes: &[u8]) -> Option<(TriMesh, Solver, Precision)> {
    let (&head, rest) = bytes.split_first()?;
    let (&count, rest) = rest.split_first()?;
    let count = 3 + usize::from(count) % (MOST - 2);
    let solvers = Solver::all();
    let solver = solvers[usize::from(head) % solvers.len()].clone();
    let precision = if head & 0x10 == 0 { Precision::Double } else { Precision::Single };
    let mut bytes = rest.iter().copied().chain(std::iter::repeat(0));
    let mut byte = move || bytes.next().expect("without end");
    let points: Vec<Point3<f64>> = (0..count).map(|k| Point3::from([0; 3].map(|_| coordinate(byte(), k)))).collect();
    let faces = if head & 0x20 == 0 { grown(count, &mut byte) } else { any(count, rest.len(), &mut byte) };
    TriMesh::new(points, &faces).ok().map(|mesh| (mesh, solver, precision))
}

/// Small numbers and some that are large, tiny, or nearly equal.
fn coordinate(byte: u8, k: usize) -> f64 {
    let mantissa = f64::from(byte & 0x0f) + k as f64 * 0.37;
    match byte >> 4 {
        0xf => mantissa * 1e12,
        0xe => mantissa * 1e-12,
        0xd => 1.0 + mantissa * f64::EPSILON,
        0xc => mantissa * 1e150,
        0xb => mantissa * 1e-150,
        high => mantissa * (1.0 - f64::from(high) / 6.0),
    }
}

/// A disk: every vertex after the third is glued to an edge of the boundary, or closes two of them.
fn grown(vertices: usize, byte: &mut impl FnMut() -> u8) -> Vec<[usize; 3]> {
    let mut faces = vec![[0, 1, 2]];
    let mut boundary = vec![0, 1, 2];
    let mut next = 3;
    while next < vertices || byte() & 1 == 1 {
        let choice = byte();
        let at = usize::from(choice >> 1) % boundary.len();
        let after = |k: usize| (at + k) % boundary.len();
        if choice & 1 == 0 && next < vertices {
            faces.push([boundary[after(1)], boundary[at], next]);
            boundary.insert(at + 1, next);
            next += 1;
        } else if boundary.len() > 3 {
            // The vertex between the two edges comes inside.
            let [a, b, c] = [boundary[at], boundary[after(1)], boundary[after(2)]];
            faces.push([c, b, a]);
            boundary.remove(after(1));
        } else if next == vertices {
            break;
        }
    }
    faces
}

/// Any faces at all.
fn any(vertices: usize, bytes: usize, byte: &mut impl FnMut() -> u8) -> Vec<[usize; 3]> {
    let faces = (bytes.saturating_sub(3 * vertices) / 3).clamp(1, 2 * MOST);
    (0..faces).map(|_| [0; 3].map(|_| usize::from(byte()) % vertices)).collect()
}
