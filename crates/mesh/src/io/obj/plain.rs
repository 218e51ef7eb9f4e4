//! The fast reader of plain OBJ files.
//!
//! It reads pieces of the file side by side, cut at line ends, and succeeds or says nothing: whatever
//! it does not understand at a glance (a continued line, a comment behind values, a number that is
//! not finite, an index of nothing, faces of which only some have UVs, any fault at all) is left to
//! the careful reader, which alone knows what is an error and where. A file that both read is the
//! same mesh with the same notes, to the bit, however many pieces there were.

mod polygons;

use abf_parallel::prelude::*;

use super::super::polygon::Inside;
use super::super::text::{Words, without_mark};
use super::super::{MeshFile, ReadNotes};
use crate::{Point2, Point3, TriMesh, UvId, UvMap, VertexId};
use polygons::{Polygon, cut};

/// The least number of bytes that is worth a piece of its own.
const PIECE: usize = 1 << 18;

/// How many pieces a thread gets. Vertices and faces take different times, so that few large pieces
/// would leave threads idle.
const PIECES_PER_THREAD: usize = 4;

/// Positive indices are less than this.
const LARGEST_INDEX: u32 = 1 << 30;

/// An index counted back from a face is kept as this plus the index counted from the first element of
/// its piece (which is negative for elements of earlier pieces), until it is known how many came before.
const RELATIVE: u32 = 3 << 30;

/// Reads a file if it is plain.
pub(super) fn parse(bytes: &[u8]) -> Option<(MeshFile, Inside)> {
    let threads = abf_parallel::current_num_threads();
    let most = if threads > 1 { PIECES_PER_THREAD * threads } else { 1 };
    parse_in(bytes, (bytes.len() / PIECE).clamp(1, most))
}

/// Reads a file in about this many pieces.
fn parse_in(bytes: &[u8], pieces: usize) -> Option<(MeshFile, Inside)> {
    let pieces = split(without_mark(bytes), pieces);
    let parts: Vec<Part> = match pieces[..] {
        [whole] => vec![Part::read(whole)?],
        _ => pieces.into_par_iter().map(Part::read).collect::<Option<_>>()?,
    };
    join(parts)
}

/// Cuts after the line ends that come next to equal parts.
fn split(bytes: &[u8], pieces: usize) -> Vec<&[u8]> {
    let mut rest = bytes;
    let mut out = Vec::with_capacity(pieces);
    for left in (2..=pieces).rev() {
        let Some(end) = memchr::memchr(b'\n', &rest[rest.len() / left..]) else { break };
        let (piece, after) = rest.split_at(rest.len() / left + end + 1);
        out.push(piece);
        rest = after;
    }
    out.push(rest);
    out
}

/// What one piece of a file holds.
#[derive(Default)]
struct Part {
    positions: Vec<Point3<f64>>,
    uv_points: Vec<Point2<f64>>,
    /// The vertices of the triangles, see [`RELATIVE`].
    faces: Vec<[u32; 3]>,
    /// Their UVs: as many, or none.
    uv_faces: Vec<[u32; 3]>,
    /// The faces of more than three corners: their number, their first triangle, how many they have.
    polygons: Vec<Polygon>,
    /// How many faces there are, of however many corners.
    face_lines: usize,
    notes: ReadNotes,
    /// Lines of normals; there may be too many to look up their count each time.
    normals: usize,
}

/// A corner of a face: its vertex, and its UV if it names one.
type Corner = (u32, Option<u32>);

impl Part {
    /// Reads all lines of a piece.
    fn read(mut rest: &[u8]) -> Option<Self> {
        let mut part = Self::default();
        while !rest.is_empty() {
            rest = part.line(rest)?;
        }
        part.notes.ignore_many("vn", part.normals);
        Some(part)
    }

    /// Reads one line, or takes a blank or an empty line away, and returns what follows.
    fn line<'a>(&mut self, line: &'a [u8]) -> Option<&'a [u8]> {
        match line {
            [b'v', b' ' | b'\t', rest @ ..] => self.vertex(rest),
            [b'f', b' ' | b'\t', rest @ ..] => self.face(rest),
            [b'v', b't', b' ' | b'\t', rest @ ..] => self.uv(rest),
            [b'\r' | b'\n', rest @ ..] => Some(rest),
            [blank, rest @ ..] if is_blank(*blank) => Some(rest),
            [b'#', ..] => Some(cut_line(line).1),
            _ => self.other(line),
        }
    }

    fn vertex<'a>(&mut self, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (x, rest) = number(rest)?;
        let (y, rest) = number(rest)?;
        let (z, rest) = number(rest)?;
        self.positions.push(Point3::new(x, y, z));
        after_line(rest).or_else(|| self.beyond_vertex(rest))
    }

    /// A weight or a colour.
    #[cold]
    fn beyond_vertex<'a>(&mut self, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (text, after) = cut_whole_line(rest)?;
        super::note_beyond_vertex(&mut self.notes, Words::of(text));
        Some(after)
    }

    fn uv<'a>(&mut self, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (u, rest) = number(rest)?;
        if let Some(after) = after_line(rest) {
            self.uv_points.push(Point2::new(u, 0.0));
            return Some(after);
        }
        let (v, rest) = number(rest)?;
        self.uv_points.push(Point2::new(u, v));
        // A third coordinate is not read.
        after_line(rest).or_else(|| cut_whole_line(rest).map(|(_, after)| after))
    }

    /// Cuts a polygon into a fan around its first corner.
    fn face<'a>(&mut self, rest: &'a [u8]) -> Option<&'a [u8]> {
        let (first, rest) = self.corner(rest)?;
        let (second, rest) = self.corner(rest)?;
        let (mut last, mut rest) = self.corner(rest)?;
        self.triangle([first, second, last])?;
        let mut triangles = 1;
        loop {
            if let Some(after) = after_line(rest) {
                if triangles > 1 {
                    let (number, first) = (self.face_lines, self.faces.len() - triangles);
                    self.polygons.push(Polygon { number, first, triangles });
                }
                self.face_lines += 1;
                return Some(after);
            }
            let (next, beyond) = self.corner(rest)?;
            self.triangle([first, last, next])?;
            triangles += 1;
            (last, rest) = (next, beyond);
        }
    }

    /// `None` where only some corners have a UV.
    fn triangle(&mut self, [a, b, c]: [Corner; 3]) -> Option<()> {
        self.faces.push([a.0, b.0, c.0]);
        match [a.1, b.1, c.1] {
            [Some(a), Some(b), Some(c)] => self.uv_faces.push([a, b, c]),
            [None, None, None] => {}
            _ => return None,
        }
        Some(())
    }

    /// `v`, `v/t`, `v//n` or `v/t/n`. Normals are not followed.
    #[inline]
    fn corner<'a>(&self, rest: &'a [u8]) -> Option<(Corner, &'a [u8])> {
        let (vertex, rest) = index(skip_blanks(rest), self.positions.len())?;
        let (uv, rest) = match rest {
            [b'/', b'/', rest @ ..] => (None, normal(rest)?),
            [b'/', rest @ ..] => {
                let (uv, rest) = index(rest, self.uv_points.len())?;
                let rest = if let [b'/', rest @ ..] = rest { normal(rest)? } else { rest };
                (Some(uv), rest)
            }
            _ => (None, rest),
        };
        ends_word(rest).then_some(((vertex, uv), rest))
    }

    /// A line that is not read, but counted.
    fn other<'a>(&mut self, line: &'a [u8]) -> Option<&'a [u8]> {
        let (text, after) = cut_whole_line(line)?;
        let mut words = Words::of(text);
        match words.next()? {
            b"vn" => self.normals += 1,
            b"v" | b"vt" | b"f" | b"fo" => return None,
            keyword => super::note_other(&mut self.notes, keyword, &words),
        }
        Some(after)
    }
}

/// The next number of a line; it must be finite.
#[inline]
fn number(rest: &[u8]) -> Option<(f64, &[u8])> {
    let rest = skip_blanks(rest);
    let (number, length) = fast_float2::parse_partial::<f64, _>(rest).ok()?;
    let rest = &rest[length..];
    (number.is_finite() && ends_word(rest)).then_some((number, rest))
}

/// An index: counted from zero, or from the first element of this piece plus [`RELATIVE`].
#[inline]
fn index(rest: &[u8], so_far: usize) -> Option<(u32, &[u8])> {
    if let [b'-', rest @ ..] = rest {
        let (back, rest) = digits(rest)?;
        let so_far = u32::try_from(so_far).ok().filter(|&n| n < LARGEST_INDEX)?;
        return (back > 0).then(|| (RELATIVE.wrapping_add(so_far).wrapping_sub(back), rest));
    }
    let (index, rest) = digits(rest)?;
    Some((index.checked_sub(1)?, rest))
}

/// Steps over the index of a normal.
fn normal(rest: &[u8]) -> Option<&[u8]> {
    let rest = if let [b'-', rest @ ..] = rest { rest } else { rest };
    digits(rest).map(|(_, rest)| rest)
}

/// A number of one to nine digits, which is below [`LARGEST_INDEX`].
#[inline]
fn digits(rest: &[u8]) -> Option<(u32, &[u8])> {
    const MOST: usize = 9;
    let mut number = 0;
    for (i, byte) in rest.iter().enumerate() {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            return (i > 0).then(|| (number, &rest[i..]));
        }
        if i == MOST {
            return None;
        }
        number = 10 * number + u32::from(digit);
    }
    (!rest.is_empty()).then_some((number, &[]))
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c)
}

#[inline]
fn skip_blanks(mut rest: &[u8]) -> &[u8] {
    while let [blank, after @ ..] = rest {
        if !is_blank(*blank) {
            break;
        }
        rest = after;
    }
    rest
}

/// Whether no byte of a word comes next.
#[inline]
fn ends_word(rest: &[u8]) -> bool {
    rest.first().is_none_or(|&byte| is_blank(byte) || matches!(byte, b'\n' | b'\r'))
}

/// What follows a line of which no word is left. The second half of `\r\n` passes for an empty line.
#[inline]
fn after_line(rest: &[u8]) -> Option<&[u8]> {
    match skip_blanks(rest) {
        [] => Some(&[]),
        [b'\n' | b'\r', after @ ..] => Some(after),
        _ => None,
    }
}

/// The rest of a line, and what follows its end.
fn cut_line(rest: &[u8]) -> (&[u8], &[u8]) {
    memchr::memchr2(b'\n', b'\r', rest).map_or((rest, &[]), |end| (&rest[..end], &rest[end + 1..]))
}

/// The same, if the line is not continued.
fn cut_whole_line(rest: &[u8]) -> Option<(&[u8], &[u8])> {
    Some(cut_line(rest)).filter(|(text, _)| !text.ends_with(b"\\"))
}

/// The mesh of all parts.
fn join(parts: Vec<Part>) -> Option<(MeshFile, Inside)> {
    let total = |count: fn(&Part) -> usize| parts.iter().map(count).sum::<usize>();
    let (vertices, uv_points) = (total(|p| p.positions.len()), total(|p| p.uv_points.len()));
    let (faces, uv_faces) = (total(|p| p.faces.len()), total(|p| p.uv_faces.len()));
    // A polygon has two corners more than triangles, and ids have to name three times as many.
    let names_enough = vertices.max(uv_points) < LARGEST_INDEX as usize && 9 * faces < u32::MAX as usize;
    if vertices == 0 || faces == 0 || !names_enough || (uv_faces != 0 && uv_faces != faces) {
        return None;
    }
    let mut positions = Joined::new(vertices, parts.len());
    let mut points = Joined::new(uv_points, parts.len());
    let mut triangles = Vec::with_capacity(faces);
    let mut uv_corners = Vec::with_capacity(3 * uv_faces);
    let mut notes = ReadNotes::default();
    let (mut polygons, mut face_lines) = (Vec::new(), 0);
    for part in parts {
        let vertex = |v| resolve(v, positions.len(), vertices).map(VertexId::new);
        let first = triangles.len();
        polygons.extend(part.polygons.iter().map(|p| Polygon {
            number: p.number + face_lines,
            first: p.first + first,
            ..*p
        }));
        face_lines += part.face_lines;
        for &[a, b, c] in &part.faces {
            triangles.push([vertex(a)?, vertex(b)?, vertex(c)?]);
        }
        for &uv in part.uv_faces.iter().flatten() {
            uv_corners.push(UvId::new(resolve(uv, points.len(), uv_points)?));
        }
        positions.extend(part.positions);
        points.extend(part.uv_points);
        add(&mut notes, part.notes);
    }
    let positions = positions.finish();
    let inside = cut(&positions, &polygons, &mut triangles, &mut uv_corners, &mut notes);
    let mesh = TriMesh::of_ids(positions, triangles);
    notes.unreferenced_vertices = mesh.unreferenced_vertices();
    let uv = if uv_corners.is_empty() {
        notes.unreferenced_uvs = uv_points;
        None
    } else {
        let map = UvMap::of_used_points(points.finish(), uv_corners);
        notes.unreferenced_uvs = uv_points - map.points().len();
        Some(map)
    };
    Some((MeshFile { mesh, uv, colours: None, notes }, inside))
}

/// The index counted from zero, if it names one of `available` elements; `before` came in earlier pieces.
#[inline]
fn resolve(index: u32, before: usize, available: usize) -> Option<usize> {
    let from_start = if index < LARGEST_INDEX {
        index as usize
    } else {
        (before + index as usize).checked_sub(RELATIVE as usize)?
    };
    (from_start < available).then_some(from_start)
}

/// Lists made one; a single list is not copied.
struct Joined<T> {
    all: Vec<T>,
    total: usize,
    lists: usize,
}

impl<T: Copy> Joined<T> {
    fn new(total: usize, lists: usize) -> Self {
        Self { all: Vec::new(), total, lists }
    }

    fn len(&self) -> usize {
        self.all.len()
    }

    fn extend(&mut self, list: Vec<T>) {
        if self.lists == 1 {
            self.all = list;
        } else {
            self.all.reserve_exact(self.total - self.all.len());
            self.all.extend_from_slice(&list);
        }
    }

    fn finish(mut self) -> Vec<T> {
        self.all.shrink_to_fit();
        self.all
    }
}

/// Adds what was noted of a later piece.
fn add(notes: &mut ReadNotes, later: ReadNotes) {
    later.ignored.iter().for_each(|(what, &count)| notes.ignore_many(what, count));
    notes.material_libraries.extend(later.material_libraries);
}

#[cfg(test)]
mod tests;
