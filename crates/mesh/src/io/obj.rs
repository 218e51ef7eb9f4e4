//! Wavefront OBJ: one pass over the bytes.
//!
//! There are two readers. The careful one here reads line by line, knows every form and alone reports
//! errors; the fast one in [`plain`] takes the files that need no care, which are most, and gives up on
//! all others.
//!
//! Read are `v`, `vt` and `f`. Everything else is counted and left alone: normals, groups,
//! materials, points and lines, curves and surfaces, weights and colours of vertices.
//!
//! Positive indices count from the beginning of the file and may point ahead; negative ones count
//! backwards from the face. Normal indices must be whole numbers and are not followed.

mod document;
mod plain;
mod write;

pub use document::{Labels, ObjDocument, ObjWritten};
pub(super) use write::write;
pub use write::write_obj;

use super::error::ReadError;
use super::gather::{Gather, NO_UV};
use super::polygon::Inside;
use super::text::{Line, Lines, Words, quote};
use super::{MeshFile, ReadNotes};
use crate::Point2;

/// OBJ counts from 1.
const BASE: u8 = 1;

/// Reads an OBJ file.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    parse_with_polygons(file, bytes).map(|(file, _)| file)
}

/// Reads an OBJ file, and tells which polygons are no fans.
fn parse_with_polygons(file: &str, bytes: &[u8]) -> Result<(MeshFile, Inside), ReadError> {
    plain::parse(bytes).map_or_else(|| parse_with_care(file, bytes), Ok)
}

/// Reads an OBJ file of whatever form.
fn parse_with_care(file: &str, bytes: &[u8]) -> Result<(MeshFile, Inside), ReadError> {
    let mut gather = Gather::new(file, BASE);
    let mut lines = Lines::new(file, bytes);
    while let Some(line) = lines.next_joined() {
        statement(&mut gather, &line)?;
    }
    gather.finish_with_polygons()
}

fn statement(gather: &mut Gather<'_>, line: &Line<'_>) -> Result<(), ReadError> {
    let mut words = line.words();
    match words.next() {
        None => {}
        Some(b"v") => vertex(gather, line, words)?,
        Some(b"vt") => uv(gather, line, words)?,
        // `fo` is how old files write `f`.
        Some(b"f" | b"fo") => face(gather, line, words)?,
        Some(other) => note_other(&mut gather.notes, other, &words),
    }
    Ok(())
}

/// Takes note of a statement that is not read.
fn note_other(notes: &mut ReadNotes, keyword: &[u8], words: &Words<'_>) {
    match keyword {
        b"mtllib" => notes.material_libraries.push(words.remainder()),
        other => notes.ignore(&quote(other)),
    }
}

/// `v x y z [w]` or `v x y z r g b`. The weight matters to curves only.
fn vertex(gather: &mut Gather<'_>, line: &Line<'_>, mut words: Words<'_>) -> Result<(), ReadError> {
    gather.vertex(line.numbers(&mut words)?, line.place());
    note_beyond_vertex(&mut gather.notes, words);
    Ok(())
}

/// Takes note of what follows the coordinates of a vertex.
fn note_beyond_vertex(notes: &mut ReadNotes, words: Words<'_>) {
    match words.count() {
        0 => {}
        1 => notes.ignore("weight of v"),
        _ => notes.ignore("colour of v"),
    }
}

/// `vt u [v [w]]`.
fn uv(gather: &mut Gather<'_>, line: &Line<'_>, mut words: Words<'_>) -> Result<(), ReadError> {
    let [u] = line.numbers(&mut words)?;
    let v = words.next().map_or(Ok(0.0), |word| line.number(word))?;
    gather.uv_points.push(Point2::new(u, v));
    Ok(())
}

/// `f` with corners `v`, `v/t`, `v//n` or `v/t/n`.
fn face(gather: &mut Gather<'_>, line: &Line<'_>, words: Words<'_>) -> Result<(), ReadError> {
    for word in words {
        corner(gather, line, word)?;
    }
    gather.end_polygon(line.place());
    Ok(())
}

fn corner(gather: &mut Gather<'_>, line: &Line<'_>, word: &[u8]) -> Result<(), ReadError> {
    let bad_index = || ReadError::BadIndex { at: line.at(), text: quote(word) };
    let index = |part: &[u8]| match line.index(part) {
        Ok(0) => Err(ReadError::IndexZero { at: line.at(), text: quote(word) }),
        Ok(index) => Ok(index),
        // The whole corner says more than the part.
        Err(_) => Err(bad_index()),
    };
    let mut parts = word.split(|&b| b == b'/');
    let vertex = index(parts.next().unwrap_or_default())?;
    let uv = parts.next().filter(|part| !part.is_empty()).map(index).transpose()?;
    if let Some(normal) = parts.next().filter(|part| !part.is_empty()) {
        line.index(normal).map_err(|_| bad_index())?;
    }
    if parts.next().is_some() {
        return Err(bad_index());
    }
    let vertex = from_zero(vertex, gather.positions.len()).unwrap_or_else(|| {
        gather.bad_vertex(line.place(), vertex);
        0
    });
    let uv = uv.map_or(NO_UV, |uv| {
        from_zero(uv, gather.uv_points.len()).unwrap_or_else(|| {
            gather.bad_uv(line.place(), uv);
            NO_UV
        })
    });
    gather.corner(vertex, uv);
    Ok(())
}

/// The index counted from zero; `None` for one that counts backwards past the beginning.
fn from_zero(index: i64, so_far: usize) -> Option<usize> {
    let magnitude = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX - 1);
    if index > 0 { Some(magnitude - 1) } else { so_far.checked_sub(magnitude) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceId;
    use crate::io::UvDropped;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn read(text: &str) -> MeshFile {
        parse("test.obj", text.as_bytes()).expect("a readable file")
    }

    fn faces(file: &MeshFile) -> Vec<[usize; 3]> {
        file.mesh.faces().iter().map(|f| f.map(crate::VertexId::index)).collect()
    }

    #[test]
    fn negative_indices_count_back_from_the_face() {
        let file = read("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -5 -4 -1\n");
        assert_eq!(faces(&file), [[1, 2, 3], [0, 1, 4]]);
    }

    #[test]
    fn positive_indices_may_point_ahead() {
        let file = read(&format!("f 1 2 3\n{SQUARE}"));
        assert_eq!(faces(&file), [[0, 1, 2]]);
        assert_eq!(file.notes.unreferenced_vertices, 1);
        assert_eq!(file.mesh.vertex_count(), 4);
    }

    #[test]
    fn polygons_become_fans_around_their_first_corner() {
        let file = read(&format!(
            "{SQUARE}v 2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 2 2\nf 2/2 3/3 4/4 5/5 1/1\nf 1/1 2/2 3/3"
        ));
        assert_eq!(faces(&file), [[1, 2, 3], [1, 3, 4], [1, 4, 0], [0, 1, 2]]);
        assert_eq!((file.notes.polygons_fanned, file.notes.triangles_from_polygons), (1, 3));
        let uv = file.uv.expect("a map");
        assert_eq!(uv.triangle(FaceId::new(2)), [[1.0, 0.0], [2.0, 2.0], [0.0, 0.0]].map(Point2::from));
    }

    #[test]
    fn what_is_not_read_is_counted() {
        let extra = "mtllib a b.mtl \nusemtl red\no x\ns off\ng\nvn 0 0 1\nvn 0 0 1\nl 1 2\np 1\nfoo bar\n";
        let file = read(&format!("{SQUARE}v 0 0 1 1\nv 0 0 2 .5 .5 .5\n{extra}f 1//1 2//2 3//9\n"));
        let ignored: Vec<(&str, usize)> = file.notes.ignored.iter().map(|(k, &n)| (k.as_str(), n)).collect();
        let one = ["colour of v", "foo", "g", "l", "o", "p", "s", "usemtl"].map(|k| (k, 1));
        assert_eq!(ignored[..8], one);
        assert_eq!(ignored[8..], [("vn", 2), ("weight of v", 1)]);
        assert_eq!(file.notes.material_libraries, ["a b.mtl"]);
        assert_eq!(file.notes.unreferenced_vertices, 3);
    }

    #[test]
    fn a_seam_gives_one_vertex_several_uvs() {
        let file = read(&format!("{SQUARE}vt 7\nvt 0 0\nvt 1 0 5\nvt 1 1\nf 1/2 2/3 3/4\nf 1/3 3/2/1 4/-1\n"));
        let uv = file.uv.expect("a map");
        assert_eq!(uv.points(), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(Point2::from));
        assert_eq!(uv.corners().iter().map(|c| c.index()).collect::<Vec<_>>(), [0, 1, 2, 1, 0, 2]);
        assert_eq!(file.notes.unreferenced_uvs, 1);
    }

    #[test]
    fn a_map_with_gaps_is_left_out_and_said() {
        let file = read(&format!("{SQUARE}vt 0 0\nf 1/1 2/1 3/1\nf 1/1 3 4//\n"));
        assert_eq!(file.uv, None);
        assert_eq!(file.notes.uv_dropped, Some(UvDropped::CornersWithout { corners: 2 }));
        let file = read(&format!("{SQUARE}vt 0 0\nvt nan 0\nf 1/1 2/1 3/2\n"));
        assert_eq!(file.uv, None);
        assert_eq!(file.notes.uv_dropped, Some(UvDropped::NotFinite { points: 1 }));
    }
}
