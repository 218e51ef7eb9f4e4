//! Broken files: each has its own error, at its own place.

use abf_mesh::io::{MeshFormat, ReadError, parse};

use crate::common::{off, ply, pyramid, stl_binary};

/// Reads a file that must be refused with an error of this variant and exactly this message.
macro_rules! refuses {
    ($format:ident, $bytes:expr, $variant:pat, $message:expr) => {{
        let bytes = &$bytes;
        let e = parse(MeshFormat::$format, "f", bytes.as_ref()).expect_err($message);
        assert!(matches!(e, $variant), "{e:?}");
        assert_eq!(e.to_string(), $message);
    }};
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn files_without_content_are_refused() {
    for format in MeshFormat::ALL {
        let e = parse(format, "f", b"").unwrap_err();
        assert!(matches!(e, ReadError::Empty { .. }), "{format:?}: {e}");
        assert_eq!(e.to_string(), "f: the file is empty");
    }
    refuses!(Obj, "# nothing\n", ReadError::NoVertices { .. }, "f: no vertices");
    refuses!(Obj, "f 1 2 3\n", ReadError::NoVertices { .. }, "f: no vertices");
    refuses!(Obj, TRIANGLE, ReadError::NoFaces { vertices: 3, .. }, "f: no faces (vertices: 3)");
    refuses!(Off, "OFF 1 0 0\n0 0 0\n", ReadError::NoFaces { .. }, "f: no faces (vertices: 1)");
    refuses!(Ply, "ply\nformat ascii 1.0\nend_header\n", ReadError::NoVertices { .. }, "f: no vertices");
    refuses!(Stl, "solid\nendsolid\n", ReadError::NoVertices { .. }, "f: no vertices");
    refuses!(Stl, [0_u8; 84], ReadError::NoVertices { .. }, "f: no vertices");
}

#[test]
fn broken_obj_numbers_name_their_line() {
    refuses!(Obj, "v 0 0 0\nv 1 zero 0\n", ReadError::BadNumber { .. }, "f, line 2: `zero` is not a number");
    refuses!(Obj, "v 1,5 0 0\n", ReadError::BadNumber { .. }, "f, line 1: `1,5` is not a number");
    refuses!(Obj, "\n\nvt 0 \x01\n", ReadError::BadNumber { .. }, "f, line 3: `\\u{1}` is not a number");
    let missing = "f, line 2: 2 coordinates where 3 are needed";
    refuses!(Obj, "v 0 0 0\nv 1 0 # 0\n", ReadError::MissingCoordinate { found: 2, .. }, missing);
    let missing = "f, line 1: 0 coordinates where 1 are needed";
    refuses!(Obj, "vt\n", ReadError::MissingCoordinate { .. }, missing);
    let text = format!("{TRIANGLE}v nan 0 0\nv 0 -inf 0\nv 0 0 1e999\nf 1 2 3\n");
    let message = "f, line 4: the vertex has a coordinate that is not finite (3 in all)";
    refuses!(Obj, text, ReadError::NotFinite { count: 3, .. }, message);
    let text = format!("v 0 \\\n0 0\n{TRIANGLE}v x 0 0\n");
    refuses!(Obj, text, ReadError::BadNumber { .. }, "f, line 6: `x` is not a number");
}

#[test]
fn broken_obj_indices_name_their_line() {
    let after = |faces: &str| format!("{TRIANGLE}vt 0 0\n{faces}");
    for word in ["x", "1.5", "/1", "1/x", "1//x", "1/1/1/1", "99999999999999999999", "-", "1\\"] {
        let message = format!("f, line 5: `{word}` is not an index");
        refuses!(Obj, after(&format!("f 1 2 {word} 3")), ReadError::BadIndex { .. }, message.as_str());
    }
    let message = "f, line 6: `0/1` has index 0, but indices count from 1";
    refuses!(Obj, after("f 1 2 3\nf 0/1 1 2"), ReadError::IndexZero { .. }, message);
    let message = "f, line 5: `1/0` has index 0, but indices count from 1";
    refuses!(Obj, after("f 1/0 1 2"), ReadError::IndexZero { .. }, message);
    let message = "f, line 5: vertex index 4 is out of range: there are 3, counted from 1 (2 in all)";
    refuses!(
        Obj,
        after("f 1 2 4\nf 9 1 2\n"),
        ReadError::IndexOutOfRange { index: 4, available: 3, count: 2, .. },
        message
    );
    let message = "f, line 5: vertex index -4 is out of range: there are 3, counted from 1 (2 in all)";
    refuses!(Obj, after("f 1 2 -4\nf 9 1 2\nv 4 4 4\n"), ReadError::IndexOutOfRange { index: -4, .. }, message);
    let message = "f, line 5: vertex index 5 is out of range: there are 3, counted from 1 (2 in all)";
    refuses!(Obj, after("f 1 2 5\nf -9 1 2\n"), ReadError::IndexOutOfRange { index: 5, .. }, message);
    let message = "f, line 5: UV index 2 is out of range: there are 1, counted from 1 (1 in all)";
    refuses!(Obj, after("f 1/2 2/1 3/1\n"), ReadError::IndexOutOfRange { what: "UV", .. }, message);
    let message = "f, line 5: UV index -2 is out of range: there are 1, counted from 1 (1 in all)";
    refuses!(Obj, after("f 1/-2 2/1 3/1\nvt 1 1\n"), ReadError::IndexOutOfRange { what: "UV", .. }, message);
    let message = format!("f, line 5: vertex index {} is out of range", i64::MIN);
    let e = parse(MeshFormat::Obj, "f", after(&format!("f 1 2 {}", i64::MIN)).as_bytes()).unwrap_err();
    assert!(e.to_string().starts_with(&message), "{e}");
}

#[test]
fn faces_with_fewer_than_three_corners_are_counted() {
    let text = format!("{TRIANGLE}f 1 2 3\nf 1 2\nf 1\nf\n");
    let message = "f, line 5: a face with 2 corners (3 faces with fewer than 3 in all)";
    refuses!(Obj, text, ReadError::TooFewCorners { corners: 2, count: 3, .. }, message);
    let text = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n";
    let message = "f, line 7: a face with 2 corners (1 faces with fewer than 3 in all)";
    refuses!(Off, text, ReadError::TooFewCorners { .. }, message);
    let text = ply_with("2 0 1\n0\n").replace("face 1", "face 2");
    let message = "f, line 13: a face with 2 corners (2 faces with fewer than 3 in all)";
    refuses!(Ply, text, ReadError::TooFewCorners { count: 2, .. }, message);
    let text = "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid";
    let message = "f, line 6: a face with 2 corners (1 faces with fewer than 3 in all)";
    refuses!(Stl, text, ReadError::TooFewCorners { .. }, message);
}

#[test]
fn broken_off_files_name_their_line() {
    refuses!(Off, "PLY\n", ReadError::BadHeader { .. }, "f, line 1: bad header: expected OFF, found `PLY`");
    refuses!(Off, "# c\nnOFF\n", ReadError::Unsupported { .. }, "f, line 2: `nOFF` is not supported");
    refuses!(Off, "OFF BINARY\n", ReadError::Unsupported { .. }, "f, line 1: binary OFF is not supported");
    refuses!(Off, " # only a comment", ReadError::UnexpectedEnd { .. }, "f: the file ends before the keyword OFF");
    let message = "f: the file ends before the numbers of vertices and faces";
    refuses!(Off, "OFF\n", ReadError::UnexpectedEnd { .. }, message);
    let message = "f, line 2: bad header: the number of vertices is `-3`";
    refuses!(Off, "OFF\n-3 1 0\n", ReadError::BadHeader { .. }, message);
    refuses!(Off, "OFF\n3\n", ReadError::BadHeader { .. }, "f, line 2: bad header: the number of faces is ``");
    let claim = "f, line 2: 4000000000 of `vertices` are claimed, more than the 6 bytes that follow can hold";
    refuses!(Off, "OFF\n4000000000 1 0\n0 0 0\n", ReadError::ClaimTooLarge { claimed: 4_000_000_000, .. }, claim);
    let claim = "f, line 1: 18446744073709551615 of `faces` are claimed, more than the 5 bytes that follow can hold";
    refuses!(Off, "OFF 1 18446744073709551615\n0 0 0", ReadError::ClaimTooLarge { .. }, claim);
    let head = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0 # last\n";
    refuses!(Off, format!("{head}# no face"), ReadError::UnexpectedEnd { .. }, "f: the file ends before face 0 of 1");
    refuses!(
        Off,
        head.replace("1 0 0", "1 0"),
        ReadError::MissingCoordinate { .. },
        "f, line 4: 2 coordinates where 3 are needed"
    );
    refuses!(Off, format!("{head}x 0 1 2"), ReadError::BadNumber { .. }, "f, line 6: `x` is not a number");
    refuses!(Off, format!("{head}3 0 1 b"), ReadError::BadIndex { .. }, "f, line 6: `b` is not an index");
    refuses!(
        Off,
        format!("{head}4 0 1 2"),
        ReadError::MissingValue { .. },
        "f, line 6: the line ends before corner 3 of 4"
    );
    let message = "f, line 6: vertex index 3 is out of range: there are 3, counted from 0 (1 in all)";
    refuses!(Off, format!("{head}3 0 1 3"), ReadError::IndexOutOfRange { base: 0, .. }, message);
    let message = "f, line 6: vertex index -1 is out of range: there are 3, counted from 0 (1 in all)";
    refuses!(Off, format!("{head}3 0 1 -1"), ReadError::IndexOutOfRange { .. }, message);
    let message = "f, line 3: the vertex has a coordinate that is not finite (1 in all)";
    refuses!(Off, format!("{head}3 0 1 2").replacen("0 0 0", "0 0 inf", 1), ReadError::NotFinite { .. }, message);
    let message = "f, line 2: 4 coordinates where 5 are needed";
    refuses!(Off, "STOFF 1 1 0\n0 0 0 0\n3 0 0 0\n", ReadError::MissingCoordinate { .. }, message);
}

/// A text PLY with three vertices on lines 10 to 12 and then the rows of the face.
fn ply_with(face: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n{face}"
    )
}

#[test]
fn broken_ply_headers_name_their_line() {
    let good = ply_with("3 0 1 2\n");
    parse(MeshFormat::Ply, "f", good.as_bytes()).expect("the file that the cases below break");
    let cases = [
        ("ply\n", "plx\n", 1, "the first line is not `ply`"),
        ("format ascii 1.0", "format asci 1.0", 2, "there is no format `asci`"),
        ("format ascii 1.0\n", "comment no format\n", 9, "no format is named"),
        ("element vertex 3", "element vertex three", 3, "the number of `vertex` is `three`"),
        ("element vertex 3", "element vertex -3", 3, "the number of `vertex` is `-3`"),
        ("element vertex 3", "elephant vertex 3", 3, "`elephant vertex 3` is not understood"),
        ("element vertex 3\n", "", 3, "property `x` before the first element"),
        ("element face 1", "element vertex 1", 7, "a second element `vertex`"),
        ("float y", "quad y", 5, "there is no type `quad`"),
        ("property float y\n", "", 3, "`vertex` has no property `y`"),
        ("property float y\n", "property list uchar float y\n", 3, "`vertex` has no property `y`"),
        ("vertex_indices", "corners", 7, "`face` needs one list `vertex_indices` or `vertex_index`"),
        ("list uchar int", "int", 7, "`face` needs one list `vertex_indices` or `vertex_index`"),
    ];
    for (from, to, line, reason) in cases {
        let message = format!("f, line {line}: bad header: {reason}");
        refuses!(Ply, good.replacen(from, to, 1), ReadError::BadHeader { .. }, message.as_str());
    }
    let version = good.replace("1.0", "2.0");
    refuses!(Ply, version, ReadError::Unsupported { .. }, "f, line 2: version 2.0 of PLY is not supported");
    let strips = good.replace("face", "tristrips");
    refuses!(Ply, strips, ReadError::Unsupported { .. }, "f, line 7: a mesh of triangle strips is not supported");
    let cut = &good[..60];
    refuses!(Ply, cut, ReadError::UnexpectedEnd { .. }, "f: the file ends before end_header");
}

#[test]
fn broken_ply_rows_name_their_line() {
    let good = ply_with("3 0 1 2\n");
    let bad = |from: &str, to: &str| good.replacen(from, to, 1);
    refuses!(Ply, bad("1 0 0\n", "1 o 0\n"), ReadError::BadNumber { .. }, "f, line 11: `o` is not a number");
    let message = "f, line 11: the line ends before a value of `z`";
    refuses!(Ply, bad("1 0 0\n", "1 0\n"), ReadError::MissingValue { .. }, message);
    let message = "f, line 11: the vertex has a coordinate that is not finite (1 in all)";
    refuses!(Ply, bad("1 0 0\n", "1 0 NaN\n"), ReadError::NotFinite { .. }, message);
    refuses!(Ply, ply_with("\n\n"), ReadError::UnexpectedEnd { .. }, "f: the file ends before `face` 0 of 1");
    refuses!(Ply, ply_with("3 0 1 1.5"), ReadError::BadIndex { .. }, "f, line 13: `1.5` is not an index");
    let message = "f, line 13: the line ends before a value of `vertex_indices`";
    refuses!(Ply, ply_with("4 0 1 2"), ReadError::MissingValue { .. }, message);
    refuses!(Ply, ply_with("4e15 0 1 2"), ReadError::MissingValue { .. }, message);
    let message =
        "f, line 13: the list `vertex_indices` has length -3; it should be a whole number that is not negative";
    refuses!(Ply, ply_with("-3 0 1 2"), ReadError::BadListLength { .. }, message);
    let message = "f, line 13: vertex index -1 is out of range: there are 3, counted from 0 (2 in all)";
    refuses!(Ply, ply_with("3 -1 1 3"), ReadError::IndexOutOfRange { count: 2, .. }, message);
    let texcoord =
        ply_with("3 0 1 2 5 0 0 1 0 1").replace("_indices\n", "_indices\nproperty list uchar float texcoord\n");
    let message =
        "f, line 14: the list `texcoord` has length 5; it should be two values for each of 3 corners, or none";
    refuses!(Ply, texcoord, ReadError::BadListLength { .. }, message);
}

#[test]
fn claims_beyond_the_file_are_refused_before_memory_is_taken() {
    let text = ply_with("3 0 1 2\n").replace("vertex 3", "vertex 18446744073709551615");
    let message =
        "f, line 3: 18446744073709551615 of `vertex` are claimed, more than the 26 bytes that follow can hold";
    refuses!(Ply, text, ReadError::ClaimTooLarge { present: 26, .. }, message);
    let text = ply_with("3 0 1 2\n").replace("face 1", "face 5").replace("ascii", "binary_little_endian");
    let message = "f, line 3: 3 of `vertex` are claimed, more than the 26 bytes that follow can hold";
    refuses!(Ply, text, ReadError::ClaimTooLarge { .. }, message);
    let mut bytes = stl_binary(&pyramid());
    bytes[80..84].fill(0xff);
    let message = "f: truncated: 214748364834 bytes or more are expected, 284 are there";
    refuses!(Stl, bytes, ReadError::Truncated { expected: 214_748_364_834, present: 284, .. }, message);
}

#[test]
fn broken_binaries_name_the_byte() {
    let good = ply(&pyramid(), None);
    let body = good.len() - (5 * 24 + 4 * 13);
    let edited = |at: usize, bytes: &[u8]| {
        let mut file = good.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let message = format!("f, byte {}: the vertex has a coordinate that is not finite (1 in all)", body + 24);
    let bytes = edited(body + 24 + 8, &f64::INFINITY.to_le_bytes());
    refuses!(Ply, bytes, ReadError::NotFinite { .. }, message.as_str());
    let faces = body + 5 * 24;
    let message =
        format!("f, byte {}: vertex index 5 is out of range: there are 5, counted from 0 (1 in all)", faces + 13);
    let bytes = edited(faces + 13 + 1, &[5, 0, 0, 0]);
    refuses!(Ply, bytes, ReadError::IndexOutOfRange { .. }, message.as_str());
    let message = format!("f: truncated: {} bytes or more are expected, {} are there", good.len(), good.len() - 2);
    refuses!(Ply, good[..good.len() - 2], ReadError::Truncated { .. }, message.as_str());
    let mut bytes = stl_binary(&pyramid());
    let message = "f: truncated: 284 bytes or more are expected, 283 are there";
    bytes[10] = 0; // A text has no zero byte.
    refuses!(Stl, bytes[..283], ReadError::Truncated { .. }, message);
    refuses!(Stl, "short", ReadError::Truncated { .. }, "f: truncated: 84 bytes or more are expected, 5 are there");
    bytes[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = "f, byte 134: the vertex has a coordinate that is not finite (1 in all)";
    refuses!(Stl, bytes, ReadError::NotFinite { .. }, message);
}

#[test]
fn broken_text_stl_files_name_their_line() {
    let head = "solid a\nfacet normal 0 0 1\n";
    let cases = [
        ("vertex 0 0 0\n", 3, "outer loop", "vertex"),
        ("outer loop\nouter loop\n", 4, "vertex or endloop", "outer"),
        ("outer loop\nendfacet\n", 4, "vertex or endloop", "endfacet"),
        ("endloop\n", 3, "solid, facet, outer loop, endfacet or endsolid", "endloop"),
        ("color 1 2 3\n", 3, "solid, facet, outer loop, endfacet or endsolid", "color"),
        ("endsolid\nendsolid\n", 4, "solid, facet, outer loop, endfacet or endsolid", "endsolid"),
    ];
    for (tail, line, expected, found) in cases {
        let message = format!("f, line {line}: expected {expected}, found `{found}`");
        refuses!(Stl, format!("{head}{tail}"), ReadError::Syntax { .. }, message.as_str());
    }
    refuses!(Stl, head, ReadError::UnexpectedEnd { .. }, "f: the file ends before endsolid");
    let text = format!("{head}outer loop\nvertex 0 0 0\nvertex 0 0\n");
    let message = "f, line 5: 2 coordinates where 3 are needed";
    refuses!(Stl, text, ReadError::MissingCoordinate { .. }, message);
}

#[test]
fn utf_16_is_refused_by_name() {
    let utf_16: Vec<u8> = "\u{feff}OFF\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for format in [MeshFormat::Obj, MeshFormat::Off, MeshFormat::Ply] {
        let e = parse(format, "f", &utf_16).unwrap_err();
        assert!(matches!(e, ReadError::Unsupported { .. }), "{e}");
        assert_eq!(e.to_string(), "f, line 1: UTF-16 text is not supported");
    }
}

#[test]
fn a_header_of_nothing_but_counts_is_no_loop() {
    // Rows without properties take no bytes, however many there are.
    let text = ply_with("3 0 1 2\n").replace("end_header", "element ghost 18446744073709551615\nend_header");
    parse(MeshFormat::Ply, "f", text.as_bytes()).expect("a readable file");
    // An OFF of the right length but with more faces than lines.
    let bytes = off(&pyramid());
    let text = String::from_utf8(bytes).expect("text").replace("5 4 0", "5 9 0");
    refuses!(Off, text, ReadError::UnexpectedEnd { .. }, "f: the file ends before face 4 of 9");
}
