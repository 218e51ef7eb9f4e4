//! The fast reader against the careful one: the same meshes and notes, to the bit, or nothing.

use proptest::prelude::*;

use super::*;
use crate::io::ReadError;
use crate::io::obj::{parse as parse_either, parse_with_care};

const SQUARE: &str = "v 0 0 0\nv 1 0 .5\nv 1. 1 -1e-3\nv 0 1 2E2\n";
const UVS: &str = "vt 0 0\nvt 1 0 0\nvt 1 1\nvt 0.1 -0.9\n";

/// Everything in a file, with floats as bits so that −0 and 0 differ.
fn contents(file: &MeshFile) -> String {
    let positions: Vec<[u64; 3]> = file.mesh.positions().iter().map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect();
    let uv = file.uv.as_ref().map(|map| {
        let points: Vec<[u64; 2]> = map.points().iter().map(|p| [p.x, p.y].map(f64::to_bits)).collect();
        (points, map.corners().to_vec())
    });
    format!("{positions:?} {:?} {uv:?} {:?}", file.mesh.faces(), file.notes)
}

/// Compares both readers on the same bytes, in one to five pieces. Whether the file was plain.
fn agree(bytes: &[u8]) -> bool {
    let said = |result: Result<MeshFile, ReadError>| result.map(|file| contents(&file)).map_err(|e| format!("{e:?}"));
    let text = String::from_utf8_lossy(bytes);
    let careful = said(parse_with_care("test", bytes).map(|(file, _)| file));
    assert_eq!(said(parse_either("test", bytes)), careful, "{text:?}");
    let found = [1, 2, 3, 5].map(|pieces| parse_in(bytes, pieces));
    for (file, inside) in found.iter().flatten() {
        assert_eq!(Ok(contents(file)), careful, "{text:?}");
        assert_eq!(Some(inside), parse_with_care("test", bytes).ok().map(|(_, inside)| inside).as_ref(), "{text:?}");
    }
    assert!(found.iter().all(|file| file.is_some() == found[0].is_some()), "it depends on the pieces: {text:?}");
    found[0].is_some()
}

#[test]
fn plain_files_are_read_fast_and_mean_the_same() {
    let plain = [
        format!("{SQUARE}f 1 2 3\nf 1 3 4\n"),
        format!("{SQUARE}f 1 2 3\nf 1 3 4"),
        format!("f 1 2 3\n{SQUARE}f 1 3 4\n"),
        format!("{SQUARE}f 1 2 3 4\n"),
        format!("{SQUARE}v 5 5 5\nf 5 1 2 3 4\nf 1 2 3\nf 4 3 2 1\n"),
        format!("{SQUARE}{UVS}f 1/1 2/2 3/3\nf 1/1 3/4 4/2\n"),
        format!("{SQUARE}{UVS}f 1/4 2/3 3/3 4/4\n"),
        format!("{SQUARE}{UVS}f 1 2 3\n"),
        format!("{SQUARE}vt 7\nvt 7 8 9 10 eleven\nf 1/1 2/1 3/2\n"),
        format!("{SQUARE}{UVS}vn 0 0 1\nf 1//1 2//9 3//-2\n"),
        format!("{SQUARE}{UVS}vn 0 0 1\nf 1/1/1 2/2/0 3/3/1\n"),
        format!("{SQUARE}f -4 -3 -2\nv 7 8 9\nf -1 -2 -3\nf -5 5 -4\n"),
        format!("{SQUARE}{UVS}f 1/-1 2/-2 3/-4\nvt 3 3\nf -1/-1 -2/1 -3/4\n"),
        format!("{SQUARE}f 1 2 3\nf 1 3 4\n").replace('\n', "\r\n"),
        format!("{SQUARE}f 1 2 3\nf 1 3 4\n").replace('\n', "\r"),
        format!("\u{feff}{SQUARE}f 1 2 3\n"),
        format!("  \t\n{SQUARE}\n\n \tf  1\t2 \u{b} 3  \t\r\n\n   \n"),
        format!("# made by hand \\\n{SQUARE}#f 9 9 9\n  # f 9 9 9\nf 1 2 3\n#"),
        format!("mtllib a b.mtl \no café\n{SQUARE}g p q\nusemtl m\ns off\nl 1 2 3\np 1\nf 1 2 3\nmtllib\nfoo\n"),
        format!("v 0 0 0 1\nv 1 0 0 .5 .5 .5\nv 0 0 1 1 # comment\nv 1 1 0 x\n{SQUARE}f 1 2 3\n"),
        format!("v -0 -0. -.0\nv 1e308 5e-324 1e-400\nv 123456789012345678901234567890 +1 +.5e+2\n{SQUARE}f 1 2 3\n"),
        "v 9007199254740993 0.1 2.2250738585072011e-308\nv 1 2 3\nf 1 1 2\n".to_owned(),
        format!("{SQUARE}f 001 0002 3\ng C:\\x\\y\nf 1 2 2\n"),
    ];
    for text in plain {
        assert!(agree(text.as_bytes()), "not read fast: {text:?}");
    }
}

#[test]
fn odd_and_broken_files_are_left_to_the_careful_reader() {
    let odd = [
        String::new(),
        "\n\n".to_owned(),
        "# nothing\n".to_owned(),
        SQUARE.to_owned(),
        "f 1 2 3\n".to_owned(),
        format!("{SQUARE}f 1 \\\n 2\\\r\n 3 4"),
        format!("{SQUARE}f 1 2 3 \\"),
        format!("{SQUARE}g a \\\nf 1 2 3\nf 1 3 4\n"),
        format!("{SQUARE}f 1 2 3 # comment\n"),
        format!("v 0 0 # comment\n{SQUARE}f 1 2 3\n"),
        format!("{SQUARE}fo 1 2 3\n"),
        format!("{SQUARE}f 1 2\n"),
        format!("{SQUARE}f\nf 1 2 3\n"),
        format!("{SQUARE}v\nf 1 2 3\n"),
        format!("v 1 2\n{SQUARE}f 1 2 3\n"),
        format!("v 1 2 x\n{SQUARE}f 1 2 3\n"),
        format!("v 1 2 3,5\n{SQUARE}f 1 2 3\n"),
        format!("v 1 2 0x10\n{SQUARE}f 1 2 3\n"),
        format!("v 1 2 1e\n{SQUARE}f 1 2 3\n"),
        format!("v 1 2 1_000\n{SQUARE}f 1 2 3\n"),
        format!("v nan 0 0\n{SQUARE}f 1 2 3\n"),
        format!("v 0 -inf 0\nv 0 1e999 0\n{SQUARE}f 1 2 3\n"),
        format!("{SQUARE}f 0 1 2\n"),
        format!("{SQUARE}f 1 2 5\nf 6 7 8\n"),
        format!("{SQUARE}f -5 1 2\nf -1 2 1000000000\n"),
        format!("{SQUARE}f 1 2 4294967297\n"),
        format!("{SQUARE}f 1 2 99999999999999999999\n"),
        format!("{SQUARE}f 1 2 +3\n"),
        format!("{SQUARE}f 1 2 --3\n"),
        format!("{SQUARE}f 1 2 3.0\n"),
        format!("{SQUARE}f 1 2 3\u{a0}\n"),
        format!("{SQUARE}{UVS}f 1/1 2/2 3\n"),
        format!("{SQUARE}{UVS}f 1/1 2/2 3/3\nf 1 2 3\n"),
        format!("{SQUARE}{UVS}f 1/1 2/2 3/5\n"),
        format!("{SQUARE}{UVS}f 1/1 2/2 3/0\n"),
        format!("{SQUARE}{UVS}f 1/ 2/ 3/\n"),
        format!("{SQUARE}{UVS}f 1// 2// 3//\n"),
        format!("{SQUARE}{UVS}f 1/1/1/1 2/2 3/3\n"),
        format!("{SQUARE}{UVS}f 1//n 2//1 3//1\n"),
        format!("{SQUARE}vt nan 0\n{UVS}f 1/2 2/3 3/4\n"),
        format!("{SQUARE}vt\nf 1 2 3\n"),
    ];
    for text in odd {
        assert!(!agree(text.as_bytes()), "read fast: {text:?}");
    }
    assert!(!agree(b"v 0 0 0\nv 1 0 0\nv 0 1 \xe9\nf 1 2 3\n"));
    assert!(agree(b"v 0 0 0\nv 1 0 0\nv 0 1 0\ng caf\xe9\xff\x00\nf 1 2 3\n"));
}

#[test]
fn a_large_file_is_cut_at_any_line() {
    let rows = 100;
    let vertices = (0..rows * rows).map(|i| format!("v {} {} {}\n", i % rows, i / rows, 0.1 * f64::from(i)));
    let faces = (0..rows * (rows - 1) - 1).map(|i| match i % 3 {
        0 => format!("f {} {} {}\n", i + 1, i + 2, i + 1 + rows),
        1 => format!("f {} {} {} {}\n", i + 1, i + 2, i + 2 + rows, i + 1 + rows),
        _ => format!("vn 0 0 1\nusemtl m{i}\nf -1 -2 -{rows}\n"),
    });
    let text: String = vertices.chain(faces).collect();
    assert!(agree(text.as_bytes()));
    let one = contents(&parse_in(text.as_bytes(), 1).expect("plain").0);
    for pieces in [2, 7, 64, 1000] {
        assert!(contents(&parse_in(text.as_bytes(), pieces).expect("plain").0) == one, "{pieces} pieces");
    }
}

#[test]
fn a_concave_polygon_is_cut_alike_by_both_readers_and_takes_its_uvs_along() {
    let letter = "v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
    let uvs = "vt 0 0\nvt 3 0\nvt 3 1\nvt 1 1\nvt 1 2\nvt 0 2\n";
    let text = format!("{letter}{uvs}f 1/1 2/2 3/3\nf 3/3 4/4 5/5 6/6 1/1 2/2\nf 1/1 2/2 4/4 6/6\n");
    assert!(agree(text.as_bytes()));
    let (file, inside) = parse_in(text.as_bytes(), 2).expect("plain");
    assert_eq!((file.notes.polygons_fanned, file.notes.polygons_not_fanned), (2, 1));
    assert!(inside.contains_key(&1));
    // The UVs are x and y of the vertices: every corner has its own still.
    let uv = file.uv.expect("a map");
    for (corner, vertex) in uv.corners().iter().zip(file.mesh.faces().iter().flatten()) {
        let (p, q) = (uv.points()[corner.index()], file.mesh.positions()[vertex.index()]);
        assert_eq!([p.x, p.y], [q.x, q.y]);
    }
    assert_eq!(file.mesh.area(), 1.5 + 4.0 + 2.5);
}

/// A number as somebody may write it.
fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => any::<f32>().prop_filter("finite", |x| x.is_finite()).prop_map(|x| format!("{x:?}")),
        4 => prop::num::f64::NORMAL.prop_map(|x| format!("{x:?}")),
        2 => prop::num::f64::NORMAL.prop_map(|x| format!("{x:.25e}")),
        4 => (-1000..1000).prop_map(|i: i32| i.to_string()),
        3 => "[+-]?[0-9]{1,25}(\\.[0-9]{0,25})?([eE][+-]?[0-9]{1,3})?",
        1 => "[+-]?[0-9]{0,3}\\.?[0-9]{0,3}[eE]?[+-]?[0-9]{0,3}",
        1 => prop::sample::select(vec!["nan", "inf", "1e999", "x", "1,5", ".", "-"]).prop_map(str::to_owned),
    ]
}

/// A corner of a face. The first index is mostly in range, others are mostly absent.
fn corner() -> impl Strategy<Value = String> {
    let index = || prop_oneof![12 => (1..7).prop_map(|i: i32| i), 3 => -4..0, 1 => -9..12];
    prop_oneof![
        8 => index().prop_map(|v| v.to_string()),
        3 => (index(), index()).prop_map(|(v, t)| format!("{v}/{t}")),
        1 => (index(), index()).prop_map(|(v, n)| format!("{v}//{n}")),
        1 => (index(), index(), index()).prop_map(|(v, t, n)| format!("{v}/{t}/{n}")),
        1 => "[0-9/+-]{1,6}",
    ]
}

fn line() -> impl Strategy<Value = String> {
    let blank = || prop::sample::select(vec![" ", " ", " ", "  ", "\t", " \\\n "]);
    let words =
        |keyword: &'static str, words: Vec<String>, blank: &str| format!("{keyword}{blank}{}", words.join(blank));
    let of = move |keyword, count: std::ops::Range<usize>| {
        (prop::collection::vec(number(), count), blank()).prop_map(move |(all, blank)| words(keyword, all, blank))
    };
    prop_oneof![
        6 => of("v", 3..4),
        1 => of("v", 0..8),
        4 => of("vt", 1..4),
        1 => of("vn", 0..4),
        8 => (prop::collection::vec(corner(), 3..6), blank()).prop_map(move |(all, blank)| words("f", all, blank)),
        1 => prop::collection::vec(corner(), 0..4).prop_map(move |all| words("f", all, " ")),
        1 => "(#|g|o|s|usemtl|mtllib|l|fo|curv|é)? ?[a-z0-9\\\\#]{0,5}",
    ]
}

fn file() -> impl Strategy<Value = String> {
    let end = prop::sample::select(vec!["\n", "\n", "\n", "\r\n", "\r", " # c\n", "\n\n \n"]);
    // Mostly one end throughout, and often enough vertices for the faces.
    (prop::collection::vec(line(), 0..24), end, any::<bool>(), any::<bool>()).prop_map(|(lines, end, head, last)| {
        let head = if head { format!("{SQUARE}v 3 3 3\nv 4 4 4\n{UVS}vt 5 5\nvt 6 6\n") } else { String::new() };
        head + &lines.join(end) + if last { end } else { "" }
    })
}

/// A plain file: finite numbers, indices in range, and UVs at all corners or at none.
fn plain_file() -> impl Strategy<Value = String> {
    let finite = || {
        prop_oneof![
            prop::num::f64::NORMAL.prop_map(|x| format!("{x:?}")),
            prop::num::f64::NORMAL.prop_map(|x| format!("{x:.30e}")),
            "[+-]?[0-9]{1,25}(\\.[0-9]{0,25})?([eE][+-]?[0-9]{1,2})?",
        ]
    };
    let of = move |keyword, count: std::ops::Range<usize>| {
        prop::collection::vec(finite(), count).prop_map(move |all| format!("{keyword} {}", all.join(" ")))
    };
    let index = || prop_oneof![1..7, -6..0];
    let triple = (index(), index(), index());
    let face = prop::collection::vec(triple, 3..6).prop_map(Line::Face);
    let other = prop::sample::select(vec!["", " ", "# f 1", "g a b", "usemtl é", "mtllib x", "l 1 2", "\tvp 0"]);
    let other = prop_oneof![6 => of("v", 3..4), 1 => of("v", 4..8), 4 => of("vt", 1..4), 1 => of("vn", 3..4), 1 => other.prop_map(str::to_owned)];
    let line = prop_oneof![1 => other.prop_map(Line::Other), 1 => face];
    let end = prop::sample::select(vec!["\n", "\n", "\r\n", "\r", "\t \n\n"]);
    (prop::collection::vec(line, 0..24), 0..4, end).prop_map(|(lines, form, end)| {
        let head = format!("{SQUARE}v 3 3 3\nv 4 4 4\n{UVS}vt 5 5\nvt 6 6\n");
        let lines: Vec<String> = lines.iter().map(|line| line.text(form)).collect();
        format!("{head}{}{end}{}", Line::Face(vec![(1, 2, 3); 3]).text(form), lines.join(end))
    })
}

/// A line whose form depends on the file.
#[derive(Clone, Debug)]
enum Line {
    Face(Vec<(i32, i32, i32)>),
    Other(String),
}

impl Line {
    fn text(&self, form: i32) -> String {
        let corner = |&(v, t, n): &(i32, i32, i32)| match form {
            0 => format!(" {v}"),
            1 => format!(" {v}/{t}"),
            2 => format!(" {v}//{n}"),
            _ => format!(" {v}/{t}/{n}"),
        };
        match self {
            Self::Face(corners) => format!("f{}", corners.iter().map(corner).collect::<String>()),
            Self::Other(text) => text.clone(),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_files_mean_the_same_to_both_readers(text in file()) {
        agree(text.as_bytes());
    }

    #[test]
    fn random_plain_files_are_read_fast_and_mean_the_same(text in plain_file()) {
        prop_assert!(agree(text.as_bytes()), "not read fast: {text:?}");
    }

    #[test]
    fn damaged_files_mean_the_same_to_both_readers(
        text in plain_file(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        const LIKELY: &[u8] = b" \t\n\r\\#/-+.e019vftn\x00\xff";
        let mut bytes = text.into_bytes();
        for (place, byte) in damage {
            let at = place.index(bytes.len());
            bytes[at] = LIKELY[usize::from(byte) % LIKELY.len()];
        }
        agree(&bytes);
    }
}
