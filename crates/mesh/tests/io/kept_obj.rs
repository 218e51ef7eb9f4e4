//! OBJ files that keep everything but their UVs.

use abf_mesh::io::{MeshFormat, ObjDocument, parse};
use abf_mesh::{FaceId, Point2, UvId, UvMap, VertexId};
use proptest::prelude::*;

use crate::common::{position_bits, uv_bits};

const SQUARES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 .5\n";

/// Texts with whatever people write, by what is odd about them.
fn corpus() -> Vec<(&'static str, String)> {
    let with = |text: &str| format!("{SQUARES}{text}");
    vec![
        ("plain", with("f 1 2 3\nf 1 3 4\n")),
        ("quads", with("f 1 2 3 4\nf 2 5 6 3\n")),
        ("no last line end", with("f 1 2 3 4\nf 2 5 6 3")),
        ("windows", with("vt 0 0\nf 1/1 2/1 3/1 4/1 # a quad\nf 2/1 5/1 6/1 3/1\n").replace('\n', "\r\n")),
        ("macintosh", with("f 1 2 3 4\nf 2 5 6 3\n").replace('\n', "\r")),
        ("mark", format!("\u{feff}# bom\n{}", with("f 1 2 3\n"))),
        ("normals", with("vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//2 4//-1\nf 2//2 5//1 6//1\n")),
        ("all three", with("vt 0 0\nvt 1 1 0.5\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1 4/2/1\nf 2/1/1 5/-1/-1 6/2/1 3/1/1\n")),
        ("mixed corners", with("vt 0 0\nvn 0 0 1\nf 1 2/1 3//1 4/1/1\nf 2/ 5// 6\n")),
        ("negative", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nv 5 5 5\nf -5//-1 -3 -2\nvn 0 0 1\n".to_owned()),
        ("ahead", format!("f 1 2 3 4\nvt 1 1\n{SQUARES}f 2 5 6 3\n")),
        ("continued", with("f 1 2 \\\n  3 4 # tail\nf \\\r\n2 5 \\\n 6 3\n# C:\\\n")),
        (
            "materials",
            with("mtllib a b.mtl\no box\nusemtl red\ng left side\ns 1\nf 1 2 3 4\nusemtl blue\ng\ns off\nf 2 5 6 3\n"),
        ),
        ("colours", "v 0 0 0 1 .5 0\nv 1 0 0 0 0 0\nv 1 1 0 .1 .2 .3\nf 1 2 3\n".to_owned()),
        ("lines", with("vt 0 0\nl 1/1 2/1 3\np 1\nf 1 2 3\nsurf 0 1 0 1 1/1/1 2/1/1\n")),
        ("blanks", with("\n \t\n  f\t1   2  3\t4   \n\x0bf 2 5 6 3\nfo 1 2 3\n\n")),
        ("pentagon", with("f 1 2 5 6 3 4\n")),
        ("many vt", with("vt 0 0\nf 1/1 2/1 3/1\n# between\nvt 1 1\nf 1/2 3/2 4/2\nvt 2 2\n")),
        ("bytes", with("# \u{fc}\u{2211}\ng \u{e4}\nf 1 2 3\n")),
    ]
}

/// A map with as few seams as polygons allow, or with every triangle by itself.
fn map(document: &ObjDocument, torn: bool) -> UvMap {
    let mesh = &document.file().mesh;
    if !torn {
        let uv: Vec<_> = mesh.positions().iter().map(|p| Point2::new(p.x / 3.0, p.y / 7.0 - p.z)).collect();
        return UvMap::per_vertex(mesh, &uv);
    }
    let points = (0..3 * mesh.face_count()).map(|c| Point2::new(c as f64 / 3.0, -1e-9 * c as f64)).collect();
    UvMap::new(points, (0..3 * mesh.face_count()).map(UvId::new).collect())
}

fn written(document: &ObjDocument, uv: &UvMap) -> (Vec<u8>, usize) {
    let mut out = Vec::new();
    let written = document.write_to(&mut out, uv).expect("written");
    (out, written.polygons_split)
}

/// A text without its `vt` lines and without the UVs in the middle of corners.
fn without_uvs(text: &str) -> String {
    let mut out = String::new();
    let text = text.replace("\r\n", "\n").replace('\r', "\n");
    for line in text.split_inclusive('\n') {
        if line.trim_start().starts_with("vt") {
            continue;
        }
        for word in line.split_inclusive(char::is_whitespace) {
            let (word, blank) = word.split_at(word.trim_end().len());
            let parts: Vec<&str> = word.split('/').collect();
            match parts[..] {
                [v, _, n] if !n.is_empty() => out += &format!("{v}//{n}"),
                [v, ..] => out += v,
                [] => {}
            }
            out += blank;
        }
    }
    out
}

#[test]
fn everything_but_the_uvs_is_kept() {
    for (name, text) in corpus() {
        let document = ObjDocument::parse(name, text.clone().into_bytes()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let uv = map(&document, false);
        let (bytes, split) = written(&document, &uv);
        let after = parse(MeshFormat::Obj, name, &bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        let before = document.file();
        assert_eq!(split, 0, "{name}");
        assert_eq!(position_bits(&after.mesh), position_bits(&before.mesh), "{name}");
        assert_eq!(after.mesh.faces(), before.mesh.faces(), "{name}");
        assert_eq!(uv_bits(after.uv.as_ref().expect("a map")), uv_bits(&uv), "{name}");
        assert_eq!(after.uv.expect("a map").points().len(), uv.points().len(), "{name}");
        assert_eq!(after.notes.ignored, before.notes.ignored, "{name}");
        assert_eq!(after.notes.polygons_fanned, before.notes.polygons_fanned, "{name}");
        assert_eq!(after.notes.material_libraries, before.notes.material_libraries, "{name}");
        let now = String::from_utf8(bytes).expect("text");
        assert_eq!(without_uvs(&now), without_uvs(&text), "{name}");
        // Once more: the same text again.
        let again = ObjDocument::parse(name, now.clone().into_bytes()).expect("readable");
        assert_eq!(String::from_utf8(written(&again, &uv).0).expect("text"), now, "{name}");
    }
}

#[test]
fn torn_polygons_become_triangles_and_the_rest_is_kept() {
    for (name, text) in corpus() {
        let document = ObjDocument::parse(name, text.clone().into_bytes()).expect("readable");
        let uv = map(&document, true);
        let (bytes, split) = written(&document, &uv);
        let after = parse(MeshFormat::Obj, name, &bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(split, document.file().notes.polygons_fanned, "{name}");
        assert_eq!(after.notes.polygons_fanned, 0, "{name}");
        assert_eq!(after.mesh, document.file().mesh, "{name}");
        assert_eq!(uv_bits(&after.uv.expect("a map")), uv_bits(&uv), "{name}");
        let statements = |text: &str| {
            let kept = |line: &&str| {
                !["f", "fo", "vt", "2", "3", "6"].contains(&line.split_whitespace().next().unwrap_or("f"))
            };
            text.lines().filter(kept).map(without_uvs).collect::<Vec<_>>()
        };
        if name != "macintosh" {
            assert_eq!(statements(&String::from_utf8(bytes).expect("text")), statements(&text), "{name}");
        }
    }
}

#[test]
fn a_file_looks_as_it_did() {
    let text = "# made by hand\r\nmtllib a.mtl\r\nv 0 0 0 1 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nv 2 .5 1\r\nvt 9 9 \\\r\n 9\r\n\
                vn 0 0 1\r\nvt 8 8\r\nusemtl red\r\nf  1/1/1 2//-1\t-3/1 4 # one\r\nf 2/2 5 \\\r\n 3 # two\r\n f 1//1 2 3 4/1/1 # three\r\n";
    let document = ObjDocument::parse("f", text.as_bytes().to_vec()).expect("readable");
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [2.0, 0.5], [-1.0, 0.25]].map(Point2::from).to_vec();
    let corners = [0, 1, 2, 0, 2, 3, 1, 4, 2, 0, 1, 2, 5, 2, 3].map(UvId::new).to_vec();
    let (out, split) = written(&document, &UvMap::new(points, corners));
    let expected = "# made by hand\r\nmtllib a.mtl\r\nv 0 0 0 1 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nv 2 .5 1\r\n\
                    vt 0.0 0.0\r\nvt 1.0 0.0\r\nvt 1.0 1.0\r\nvt 0.0 1.0\r\nvt 2.0 0.5\r\nvt -1.0 0.25\r\n\
                    vn 0 0 1\r\nusemtl red\r\nf  1/1/1 2/2/-1\t-3/3 4/4 # one\r\nf 2/2 5/5 \\\r\n 3/3 # two\r\n\
                    f 1/1/1 2/2 3/3\r\nf 1/6/1 3/3 4/4/1 # three\r\n";
    assert_eq!(String::from_utf8(out).expect("text"), expected);
    assert_eq!(split, 1);
}

#[test]
fn what_is_no_corner_stays_in_lines() {
    // Found by fuzzing: cut after `\`, the line went on in the next, which was the first `vt`.
    let text = format!("{SQUARES}l 1/1 2/1/1 a/b \\/1\nf 1 2 3\n");
    let document = ObjDocument::parse("f", text.into_bytes()).expect("readable");
    let (out, _) = written(&document, &map(&document, false));
    let out = String::from_utf8(out).expect("text");
    assert!(out.contains("\nl 1 2//1 a/b \\/1\nvt "), "{out}");
}

#[test]
fn groups_materials_and_diagonals_are_told() {
    let (_, text) = corpus().into_iter().find(|(name, _)| *name == "materials").expect("the text");
    let document = ObjDocument::parse("f", text.into_bytes()).expect("readable");
    assert_eq!(document.groups().names, ["box / left side", "box"]);
    assert_eq!(document.groups().of_faces, [0, 0, 1, 1]);
    assert_eq!(document.materials().names, ["red", "blue"]);
    assert_eq!(document.materials().of_faces, [0, 0, 1, 1]);
    assert_eq!(document.diagonals(), [[0, 2], [1, 5]].map(|d| d.map(VertexId::new)));
    let (_, text) = corpus().into_iter().find(|(name, _)| *name == "pentagon").expect("the text");
    let document = ObjDocument::parse("f", text.into_bytes()).expect("readable");
    assert_eq!(document.diagonals(), [[0, 4], [0, 5], [0, 2]].map(|d| d.map(VertexId::new)));
    assert_eq!(document.file().mesh.faces()[FaceId::new(3).index()], [0, 2, 3].map(VertexId::new));
}

#[test]
fn a_concave_polygon_is_kept_and_its_diagonals_are_told() {
    // As a fan, its first triangle would be outside, and turned over.
    let text = "v 3 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 3 0 0\nf 1 2 3 4 5 6\n";
    let document = ObjDocument::parse("f", text.as_bytes().to_vec()).expect("readable");
    assert_eq!(document.file().notes.polygons_not_fanned, 1);
    assert_eq!(document.file().mesh.area(), 4.0);
    let sides: Vec<[usize; 2]> = (0..6).map(|i| [i, (i + 1) % 6]).collect();
    let diagonals: Vec<[usize; 2]> = document.diagonals().iter().map(|d| d.map(VertexId::index)).collect();
    assert_eq!(diagonals.len(), 3);
    assert!(diagonals.iter().all(|&[a, b]| !sides.contains(&[a, b]) && !sides.contains(&[b, a])));
    let (whole, split) = written(&document, &map(&document, false));
    assert_eq!(split, 0);
    assert!(String::from_utf8(whole).expect("text").ends_with("f 1/1 2/2 3/3 4/4 5/5 6/6\n"));
    let (torn, split) = written(&document, &map(&document, true));
    assert_eq!(split, 1);
    let after = parse(MeshFormat::Obj, "f", &torn).expect("readable");
    assert_eq!(after.mesh, document.file().mesh);
}

#[test]
fn a_file_is_replaced_when_it_is_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.obj");
    std::fs::write(&path, format!("{SQUARES}f 1 2 3 4\n")).expect("written");
    let document = ObjDocument::read(&path).expect("readable");
    let uv = map(&document, false);
    document.write(&path, &uv).expect("written");
    assert_eq!(uv_bits(&abf_mesh::io::read(&path).expect("read").uv.expect("a map")), uv_bits(&uv));
    assert!(document.write(&path, &UvMap::new(Vec::new(), Vec::new())).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_texts_are_kept_or_refused(
        which in 0..19_usize,
        damages in prop::collection::vec((any::<usize>(), prop::sample::select(b" \n\r\\#/-.0129efvtlgo\xff".to_vec())), 0..6),
        torn in any::<bool>(),
    ) {
        let mut bytes = corpus().swap_remove(which).1.into_bytes();
        for (at, byte) in damages {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        if let Ok(document) = ObjDocument::parse("damaged", bytes) {
            let uv = map(&document, torn);
            let (out, _) = written(&document, &uv);
            let after = parse(MeshFormat::Obj, "again", &out).expect("readable");
            prop_assert_eq!(&after.mesh, &document.file().mesh);
            prop_assert_eq!(uv_bits(&after.uv.expect("a map")), uv_bits(&uv));
        }
    }
}
