//! STL, text and binary.
//!
//! STL stores three positions per facet and no vertices. Vertices are made from positions that are
//! equal as numbers, in the order of their first appearance; how many were welded is noted.
//!
//! A binary file may begin with `solid` like a text: it is binary if its length is exactly what
//! its facet count says, or if it does not begin with `solid`, or if it has a zero byte.

use std::collections::HashMap;

use super::MeshFile;
use super::error::{FilePlace, ReadError};
use super::gather::{Gather, NO_UV};
use super::text::{Line, Lines, quote};

/// A free comment and the number of facets.
const HEADER: usize = 84;
/// A normal, three positions and two bytes of attributes.
const FACET: usize = 50;
/// Where the positions begin in a facet.
const POSITIONS: usize = 12;
/// Three numbers of 32 bits.
const POSITION: usize = 12;

/// Reads an STL file.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let mut welder = Welder { gather: Gather::new(file, 0), vertices: HashMap::new() };
    if is_text(bytes) {
        text(file, bytes, &mut welder)?;
    } else {
        binary(file, bytes, &mut welder)?;
    }
    welder.gather.finish()
}

/// Finds the vertex at a position, or makes it.
struct Welder<'a> {
    gather: Gather<'a>,
    vertices: HashMap<[u64; 3], usize>,
}

impl Welder<'_> {
    fn corner(&mut self, position: [f64; 3], place: FilePlace) {
        // Adding +0 turns −0 into +0 and leaves all other numbers as they are.
        let key = position.map(|x| (x + 0.0).to_bits());
        let next = self.gather.positions.len();
        let vertex = *self.vertices.entry(key).or_insert(next);
        if vertex == next {
            self.gather.vertex(position, place);
        } else {
            self.gather.notes.vertices_welded += 1;
        }
        self.gather.corner(vertex, NO_UV);
    }
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let solid = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    solid && claimed_length(bytes) != Some(bytes.len()) && !bytes.contains(&0)
}

/// How long a binary file must be, if it is long enough to say.
fn claimed_length(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER - 4..)?.first_chunk().copied().map(u32::from_le_bytes)?;
    usize::try_from(count).ok()?.checked_mul(FACET)?.checked_add(HEADER)
}

fn binary(file: &str, bytes: &[u8], welder: &mut Welder<'_>) -> Result<(), ReadError> {
    let expected = claimed_length(bytes).unwrap_or(HEADER);
    let Some(facets) = bytes.get(HEADER..expected) else {
        return Err(ReadError::Truncated { file: file.to_owned(), expected, present: bytes.len() });
    };
    for (f, facet) in facets.chunks_exact(FACET).enumerate() {
        let place = FilePlace::Byte(HEADER + f * FACET);
        let (positions, attributes) = facet[POSITIONS..].split_at(3 * POSITION);
        for position in positions.chunks_exact(POSITION) {
            welder.corner([0, 4, 8].map(|i| single(position, i)), place);
        }
        if attributes.iter().any(|&byte| byte != 0) {
            welder.gather.notes.ignore("attributes of a facet");
        }
        welder.gather.end_polygon(place);
    }
    welder.gather.notes.ignore_many("byte after the last facet", bytes.len() - expected);
    Ok(())
}

/// The little-endian number of 32 bits at `i`.
fn single(bytes: &[u8], i: usize) -> f64 {
    f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]).into()
}

fn text(file: &str, bytes: &[u8], welder: &mut Welder<'_>) -> Result<(), ReadError> {
    let syntax =
        |line: &Line<'_>, expected, found: &[u8]| ReadError::Syntax { at: line.at(), expected, found: quote(found) };
    let mut in_loop = false;
    let mut in_facet = false;
    let mut in_solid = false;
    for line in Lines::new(file, bytes) {
        let mut words = line.words();
        let Some(word) = words.next() else { continue };
        match word.to_ascii_lowercase().as_slice() {
            b"vertex" if in_loop => welder.corner(line.numbers(&mut words)?, line.place()),
            b"outer" if !in_loop => in_loop = true,
            b"endloop" if in_loop => {
                welder.gather.end_polygon(line.place());
                in_loop = false;
            }
            b"solid" if !in_solid && !in_loop => in_solid = true,
            b"endsolid" if in_solid && !in_loop => in_solid = false,
            b"vertex" => return Err(syntax(&line, "outer loop", word)),
            b"facet" if !in_loop => in_facet = true,
            b"endfacet" if !in_loop => in_facet = false,
            _ if in_loop => return Err(syntax(&line, "vertex or endloop", word)),
            _ => return Err(syntax(&line, "solid, facet, outer loop, endfacet or endsolid", word)),
        }
    }
    // A file that ends between two facets holds everything that was written to it.
    if in_solid && !in_loop && !in_facet && !welder.gather.positions.is_empty() {
        welder.gather.notes.end_missing = true;
    } else if in_solid {
        return Err(ReadError::UnexpectedEnd { file: file.to_owned(), missing: "endsolid".to_owned() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid two triangles
 facet normal 0 0 1
  outer loop
   vertex 0 0 0
   VERTEX 1 0 0
   vertex 1 1 -0
  endloop
 endfacet
 facet normal 0 0 1
  outer loop
   vertex 0 -0.0 0
   vertex 1 1 0
   vertex 0 1 1e-3
  endloop
 endfacet
endsolid two triangles
";

    #[test]
    fn corners_at_equal_positions_are_welded_whatever_the_sign_of_zero() {
        let file = parse("test.stl", TEXT.as_bytes()).expect("a readable file");
        assert_eq!((file.mesh.vertex_count(), file.mesh.face_count()), (4, 2));
        assert_eq!(file.notes.vertices_welded, 2);
        assert_eq!(file.mesh.positions()[3].z, 1e-3);
    }

    #[test]
    fn a_text_without_endsolid_is_read_and_said() {
        let file =
            parse("test.stl", TEXT.trim_end().trim_end_matches("endsolid two triangles").as_bytes()).expect("readable");
        assert_eq!(file.mesh.face_count(), 2);
        assert!(file.notes.end_missing);
        assert!(file.notes.sentences().contains(&"the last line, `endsolid`, is missing".to_owned()));
        // In the middle of a facet it is damaged.
        let cut = TEXT.find(" endfacet").expect("a facet");
        assert!(parse("test.stl", &TEXT.as_bytes()[..cut]).is_err());
    }

    #[test]
    fn a_binary_file_that_begins_with_solid_is_binary() {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1_u32.to_le_bytes());
        for x in [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0_f32] {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([7, 0]);
        let file = parse("test.stl", &bytes).expect("a readable file");
        assert_eq!(file.mesh.face_count(), 1);
        assert_eq!(file.notes.ignored["attributes of a facet"], 1);
        bytes.extend([0, 0, 0]);
        let file = parse("test.stl", &bytes).expect("a readable file");
        assert_eq!(file.notes.ignored["byte after the last facet"], 3);
    }
}
