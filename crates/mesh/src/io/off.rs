//! OFF: a keyword, three counts, one line per vertex, one line per face.
//!
//! The letters before the keyword say what follows the coordinates of a vertex: `N` normals, `C`
//! colours, `ST` UVs, in this order. The UVs are read; normals, colours and whatever follows the
//! corners of a face are not. `4` says that a vertex has four homogeneous coordinates, `x/w y/w z/w`. The keyword may be
//! missing. `nOFF` and binary files are refused by name.

use super::MeshFile;
use super::error::ReadError;
use super::gather::{Gather, NO_UV};
use super::text::{Line, Lines, Words, integer, quote};
use crate::Point2;

/// OFF counts from 0.
const BASE: u8 = 0;

/// The shortest line of a vertex is `0 0 0` and its end.
const SHORTEST_VERTEX: usize = 6;

/// The shortest line of a face (which would be refused later) is `0` and its end.
const SHORTEST_FACE: usize = 2;

/// Reads an OFF file.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let mut off =
        Off { file, lines: Lines::new(file, bytes), gather: Gather::new(file, BASE), has_uv: false, has_weight: false };
    let (vertices, faces) = off.header()?;
    for i in 0..vertices {
        let line = off.line(|| format!("vertex {i} of {vertices}"))?;
        off.vertex(&line)?;
    }
    for i in 0..faces {
        let line = off.line(|| format!("face {i} of {faces}"))?;
        off.face(&line)?;
    }
    let rest = std::iter::from_fn(|| off.lines.next_with_words()).count();
    off.gather.notes.ignore_many("line after the last face", rest);
    off.gather.finish()
}

struct Off<'a> {
    file: &'a str,
    lines: Lines<'a>,
    gather: Gather<'a>,
    /// Whether the keyword promises UVs.
    has_uv: bool,
    /// Whether it promises homogeneous coordinates.
    has_weight: bool,
}

impl<'a> Off<'a> {
    /// The next line with words on it; there must be one.
    fn line(&mut self, missing: impl Fn() -> String) -> Result<Line<'a>, ReadError> {
        let end = || ReadError::UnexpectedEnd { file: self.file.to_owned(), missing: missing() };
        self.lines.next_with_words().ok_or_else(end)
    }

    /// The keyword and the numbers of vertices and faces, on one line or two.
    fn header(&mut self) -> Result<(usize, usize), ReadError> {
        let mut line = self.line(|| "the keyword OFF".to_owned())?;
        let mut words = line.words();
        // A file may begin with its counts.
        if words.clone().next().and_then(integer::<usize>).is_none() {
            (self.has_uv, self.has_weight) = keyword(&line, words.next().unwrap_or_default())?;
        }
        if words.clone().next() == Some(b"BINARY") {
            return Err(ReadError::Unsupported { at: line.at(), feature: "binary OFF".to_owned() });
        }
        if words.clone().next().is_none() {
            line = self.line(|| "the numbers of vertices and faces".to_owned())?;
            words = line.words();
        }
        // The number of edges may be missing, and is often wrong: nobody reads it.
        let vertices = count(&line, &mut words, "vertices")?;
        let faces = count(&line, &mut words, "faces")?;
        let present = self.lines.bytes_left();
        for (what, claimed, shortest) in [("vertices", vertices, SHORTEST_VERTEX), ("faces", faces, SHORTEST_FACE)] {
            // The last line need not have an end.
            if claimed.saturating_mul(shortest) > present + 1 {
                return Err(ReadError::ClaimTooLarge { at: line.at(), what: what.to_owned(), claimed, present });
            }
        }
        Ok((vertices, faces))
    }

    /// `x y z …`, with the UV at the end if there is one.
    fn vertex(&mut self, line: &Line<'_>) -> Result<(), ReadError> {
        let mut words = line.words();
        let mut position = line.numbers(&mut words)?;
        if self.has_weight {
            let [weight] = line.numbers(&mut words)?;
            position = position.map(|x: f64| x / weight);
        }
        self.gather.vertex(position, line.place());
        let mut extra = words.clone().count();
        if self.has_uv {
            let Some(before) = extra.checked_sub(2) else {
                return Err(ReadError::MissingCoordinate { at: line.at(), found: 3 + extra, expected: 5 });
            };
            words.by_ref().take(before).for_each(drop);
            let [u, v] = line.numbers(&mut words)?;
            self.gather.uv_points.push(Point2::new(u, v));
            extra = before;
        }
        if extra > 0 {
            self.gather.notes.ignore("values after the coordinates of a vertex");
        }
        Ok(())
    }

    /// `n v₁ … vₙ …`.
    fn face(&mut self, line: &Line<'_>) -> Result<(), ReadError> {
        let mut words = line.words();
        let word = words.next().unwrap_or_default();
        let Some(corners) = integer::<usize>(word) else {
            return Err(ReadError::BadNumber { at: line.at(), text: quote(word) });
        };
        for i in 0..corners {
            let what = || format!("corner {i} of {corners}");
            let word = words.next().ok_or_else(|| ReadError::MissingValue { at: line.at(), what: what() })?;
            let index = line.index(word)?;
            let vertex = usize::try_from(index).unwrap_or_else(|_| {
                self.gather.bad_vertex(line.place(), index);
                0
            });
            self.gather.corner(vertex, if self.has_uv { vertex } else { NO_UV });
        }
        self.gather.end_polygon(line.place());
        if words.next().is_some() {
            self.gather.notes.ignore("values after the corners of a face");
        }
        Ok(())
    }
}

/// One count of the header.
fn count(line: &Line<'_>, words: &mut Words<'_>, what: &str) -> Result<usize, ReadError> {
    let word = words.next().unwrap_or_default();
    let reason = || format!("the number of {what} is `{}`", quote(word));
    integer(word).ok_or_else(|| ReadError::BadHeader { at: line.at(), reason: reason() })
}

/// Whether the keyword (`OFF` with letters before it) promises UVs, and whether homogeneous coordinates.
fn keyword(line: &Line<'_>, word: &[u8]) -> Result<(bool, bool), ReadError> {
    let Some(letters) = word.strip_suffix(b"OFF") else {
        return Err(ReadError::BadHeader { at: line.at(), reason: format!("expected OFF, found `{}`", quote(word)) });
    };
    let has_weight = letters.ends_with(b"4");
    match letters.strip_suffix(b"4").unwrap_or(letters) {
        b"" | b"N" | b"C" | b"CN" | b"NC" => Ok((false, has_weight)),
        b"ST" | b"STC" | b"STN" | b"STCN" | b"STNC" => Ok((true, has_weight)),
        _ => Err(ReadError::Unsupported { at: line.at(), feature: format!("`{}`", quote(word)) }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> MeshFile {
        parse("test.off", text.as_bytes()).expect("a readable file")
    }

    #[test]
    fn comments_colours_and_polygons_are_understood() {
        let text = "# a square\nCOFF\n# counts\n4 1 0\n\n0 0 0 255 0 0 255\n1 0 0 0 0 0 1 # x\n1 1 0\n0 1 0\n4 0 1 2 3 9 9 9\nmore\n";
        let file = read(text);
        assert_eq!((file.mesh.vertex_count(), file.mesh.face_count()), (4, 2));
        assert_eq!(file.notes.polygons_fanned, 1);
        let ignored: Vec<(&str, usize)> = file.notes.ignored.iter().map(|(k, &n)| (k.as_str(), n)).collect();
        assert_eq!(
            ignored,
            [
                ("line after the last face", 1),
                ("values after the coordinates of a vertex", 2),
                ("values after the corners of a face", 1)
            ]
        );
    }

    #[test]
    fn a_file_may_begin_with_its_counts() {
        let file = read("3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        assert_eq!((file.mesh.vertex_count(), file.mesh.face_count()), (3, 1));
    }

    #[test]
    fn four_coordinates_are_homogeneous() {
        let file = read("4OFF\n3 1 3\n0 0 0 1\n1 0 0 0.5\n0 4 2 2\n3 0 1 2\n");
        let positions = file.mesh.positions();
        assert_eq!((positions[1].x, positions[2].y, positions[2].z), (2.0, 2.0, 1.0));
        let text = "4OFF\n3 1 3\n0 0 0 1\n1 0 0 0\n0 4 2 2\n3 0 1 2\n";
        assert!(matches!(parse("test.off", text.as_bytes()), Err(ReadError::NotFinite { .. })));
    }

    #[test]
    fn uvs_are_the_last_two_values() {
        let file = read("STCNOFF 3 1 3\n0 0 0 0 0 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 0.5\n0 1 0 0 1\n3 0 1 2");
        let uv = file.uv.expect("a map");
        assert_eq!(uv.points(), [[0.0, 0.0], [1.0, 0.5], [0.0, 1.0]].map(Point2::from));
    }
}
