//! What the writers of all formats share: the checks before, and blocks of elements that threads fill.

use std::io::{self, BufWriter, Write};

use abf_parallel::prelude::*;

use super::WriteError;
use crate::{TriMesh, UvMap};

/// A function that writes one format.
pub(super) type Format = fn(&mut dyn Write, &TriMesh, Option<&UvMap>) -> io::Result<()>;

/// Checks a mesh and writes it to a stream.
pub(super) fn to_stream(out: impl Write, mesh: &TriMesh, uv: Option<&UvMap>, format: Format) -> Result<(), WriteError> {
    check(mesh, uv)?;
    let mut out = BufWriter::new(out);
    let written = format(&mut out, mesh, uv).and_then(|()| out.flush());
    written.map_err(|cause| WriteError::Io { target: "output".to_owned(), cause })
}

/// The map must belong to the mesh, and all numbers must be finite.
pub(super) fn check(mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    check_finite("vertex", mesh.positions().iter().map(|p| p.iter().all(|x| x.is_finite())))?;
    let Some(map) = uv else { return Ok(()) };
    let (map_corners, mesh_corners) = (map.corners().len(), 3 * mesh.face_count());
    if map_corners != mesh_corners {
        return Err(WriteError::UvMismatch { map: map_corners, mesh: mesh_corners });
    }
    check_finite("UV point", map.points().iter().map(|p| p.iter().all(|x| x.is_finite())))
}

/// Everything of a kind has to be finite.
pub(super) fn check_finite(what: &'static str, finite: impl Iterator<Item = bool>) -> Result<(), WriteError> {
    let mut bad = finite.enumerate().filter(|&(_, finite)| !finite).map(|(i, _)| i);
    match bad.next() {
        None => Ok(()),
        Some(first) => Err(WriteError::NotFinite { what, first, count: 1 + bad.count() }),
    }
}

/// A function that appends one element, by its number, to a block.
pub(super) trait Append: Fn(&mut Vec<u8>, usize) + Sync {}
impl<F: Fn(&mut Vec<u8>, usize) + Sync> Append for F {}

/// Writes `count` elements in their order. Blocks of them are made side by side, as many as there are
/// threads, so that memory does not grow with the mesh.
pub(super) fn in_blocks(out: &mut dyn Write, count: usize, append: impl Append) -> io::Result<()> {
    /// Elements of one block: some hundred kilobytes.
    const BLOCK: usize = 1 << 13;
    let mut blocks = vec![Vec::new(); abf_parallel::current_num_threads().clamp(1, count.div_ceil(BLOCK).max(1))];
    for wave in (0..count).step_by(BLOCK * blocks.len()) {
        let fill = |(i, slot): (usize, &mut Vec<u8>)| {
            // On the stack, because lengths that stand side by side in memory slow down the threads that count them up.
            let mut block = std::mem::take(slot);
            block.clear();
            let start = (wave + i * BLOCK).min(count);
            (start..(start + BLOCK).min(count)).for_each(|element| append(&mut block, element));
            *slot = block;
        };
        match &mut blocks[..] {
            [only] => fill((0, only)),
            several => several.par_iter_mut().enumerate().for_each(fill),
        }
        blocks.iter().try_for_each(|block| out.write_all(block))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_written_in_their_order_whatever_the_number_of_threads() {
        let count = 100_000;
        let texts = [1, 2, 3].map(|threads| {
            let mut out = Vec::new();
            abf_parallel::with_threads(threads, || {
                in_blocks(&mut out, count, |block, i| block.extend_from_slice((i + 1).to_string().as_bytes()))
            })
            .expect("threads")
            .expect("written");
            out
        });
        let expected: String = (1..=count).map(|i| i.to_string()).collect();
        texts.iter().for_each(|text| assert!(text == expected.as_bytes()));
    }
}
