//! `tobj` as the judge of the OBJ reader: the same triangles at the same positions, to the bit.
//!
//! `tobj` splits a file into models with vertices of their own, so indices cannot be compared; the
//! sequence of corner positions over all models can, and so can the UVs of the corners.

use std::path::{Path, PathBuf};

use abf_mesh::io::{MeshFormat, UvDropped, parse};

use crate::common::uv_bits;

/// The folder of models to compare on; see the test below.
const MODELS: &str = "ABF_MODELS";

/// Bits of the position of every corner, and of its UV if all corners have one.
type Corners = (Vec<[u64; 3]>, Option<Vec<[u64; 2]>>);

fn by_tobj(bytes: &[u8]) -> Result<Corners, tobj::LoadError> {
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut &bytes[..], &options, no_materials)?;
    let (mut positions, mut uvs) = (Vec::new(), Vec::new());
    // Where corners have no UV, `tobj` gives them that of the corner before.
    let made_up = String::from_utf8_lossy(bytes).lines().any(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some("f") && words.any(|word| word.split('/').nth(1).is_none_or(str::is_empty))
    });
    for mesh in models.iter().map(|model| &model.mesh) {
        let position = |&i: &u32| [0, 1, 2].map(|k| mesh.positions[3 * i as usize + k].to_bits());
        let uv = |&i: &u32| [0, 1].map(|k| mesh.texcoords[2 * i as usize + k].to_bits());
        positions.extend(mesh.indices.iter().map(position));
        uvs.extend(mesh.texcoord_indices.iter().map(uv));
    }
    let uvs = (uvs.len() == positions.len() && !made_up).then_some(uvs);
    Ok((positions, uvs))
}

fn by_us(name: &str, bytes: &[u8]) -> Corners {
    let file = parse(MeshFormat::Obj, name, bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
    let positions = file.mesh.triangles().flatten().map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect();
    (positions, file.uv.as_ref().map(uv_bits))
}

/// Compares what we make of `odd` with what `tobj` makes of `plain`.
fn assert_agree(name: &str, odd: &[u8], plain: &[u8]) {
    let theirs = by_tobj(plain).unwrap_or_else(|e| panic!("{name}: tobj: {e}"));
    assert!(!theirs.0.is_empty(), "{name}: nothing to compare");
    // Not `assert_eq!`: a difference would print the whole mesh.
    let ours = by_us(name, odd);
    assert!(ours.0 == theirs.0, "{name}: positions differ ({} against {} corners)", ours.0.len(), theirs.0.len());
    assert!(ours.1 == theirs.1, "{name}: UVs differ");
}

const SQUARE: &str = "v 0 0 0\nv 1 0 .5\nv 1. 1 -1e-3\nv 0 1 +2E2\n";

#[test]
fn odd_files_mean_the_same_to_both_readers() {
    let uvs = "vt 0 0\nvt 1 0 0\nvt 1 1\nvt 0.1 0.9\n";
    let cases = [
        ("a quad", format!("{SQUARE}f 1 2 3 4\n")),
        ("a pentagon", format!("{SQUARE}v 5 5 5\nf 5 1 2 3 4")),
        ("negative indices", format!("{SQUARE}f -4 -3 -2\nv 7 8 9\nf -1 -2 -3\n")),
        ("positions and UVs", format!("{SQUARE}{uvs}f 1/4 2/3 3/2\nf 1/1 3/3 4/4\n")),
        ("negative UV indices", format!("{SQUARE}{uvs}f 1/-1 2/-2 3/-4\n")),
        ("normals only", format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1 4//1\n")),
        ("all three", format!("{SQUARE}{uvs}vn 0 0 1\nf 1/1/1 2/2/1 3/3/-1 4/4/1\n")),
        ("carriage returns, tabs and leading blanks", format!("{SQUARE}\tf  1\t2   3 \r\n  f 1 3 4\r\n").replace("v ", " v\t")),
        ("comments and blank lines", format!("# made\n\n{SQUARE}#f 1 2 3\n   \nf 1 2 3\n# end")),
        ("colours", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n".to_owned()),
        ("groups and materials", format!("mtllib x.mtl\no a\n{SQUARE}g p q\nusemtl m\ns 1\nf 1 2 3\no b\nusemtl n\ns off\nf 1 3 4\n")),
        // Of two points only: `tobj` makes triangles of longer lines.
        ("points and lines", format!("{SQUARE}p 1 2\nl 1 2\nf 1 2 4\n")),
        ("faces before their vertices", format!("f 1 2 3\n{SQUARE}f 4 2 1\n")),
        ("vertices without faces", format!("v 9 9 9\n{SQUARE}f 2 3 4\n")),
        ("unknown keywords", format!("{SQUARE}curv 0 1 1 2\nxyz\nf 1 2 3\n")),
        ("a face that repeats a vertex", format!("{SQUARE}f 1 2 2\nf 1 2 3\nf 1 2 3\n")),
        ("numbers at the edges", "v 1e308 5e-324 0.1\nv -0 1e-400 123456789012345678901234567890\nv .1 1. 4.9406564584124654e-324\nf 1 2 3\n".to_owned()),
    ];
    for (name, text) in cases {
        assert_agree(name, text.as_bytes(), text.as_bytes());
    }
}

#[test]
fn no_uv_is_made_up_for_a_corner_without_one() {
    // A part without UVs among parts that have them: `tobj` repeats the UV of the corner before.
    let text = format!("{SQUARE}vt 0 0\nvt 1 0\nvt 1 1\no with\nf 1/1 2/2 3/3\no without\nf 1 3 4\n");
    let file = parse(MeshFormat::Obj, "two parts", text.as_bytes()).expect("a readable file");
    assert_eq!(file.uv, None);
    assert_eq!(file.notes.uv_dropped, Some(UvDropped::CornersWithout { corners: 3 }));
    assert_agree("two parts", text.as_bytes(), text.as_bytes());
}

#[test]
fn what_tobj_does_not_know_means_the_same_as_its_plain_form() {
    let plain = format!("{SQUARE}f 1 2 3 4\n");
    let cases = [
        ("a byte-order mark", format!("\u{feff}{plain}")),
        ("carriage returns alone", plain.replace('\n', "\r")),
        ("continued lines", format!("{SQUARE}f 1 \\\n 2\\\r\n 3 4")),
        ("comments after values", plain.replace('\n', " # comment\n")),
    ];
    for (name, odd) in cases {
        assert_agree(name, odd.as_bytes(), plain.as_bytes());
    }
    let mut latin = plain.clone().into_bytes();
    latin.extend(b"g caf\xe9\n");
    assert_agree("a name that is not UTF-8", &latin, plain.as_bytes());
}

#[test]
#[expect(clippy::print_stderr, reason = "a skipped check must be seen")]
fn models_mean_the_same_to_both_readers() {
    let Some(folder) = std::env::var_os(MODELS).map(PathBuf::from) else {
        eprintln!("{MODELS} is not set: 1 check skipped");
        return;
    };
    assert!(folder.is_dir(), "{MODELS} names {}, which is no folder", folder.display());
    let mut files = Vec::new();
    collect(&folder, &mut files);
    assert!(!files.is_empty(), "{MODELS} names {}, which has no OBJ file", folder.display());
    for path in files {
        let bytes = std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_agree(&path.display().to_string(), &bytes, &bytes);
    }
}

/// All OBJ files below a folder, in the order of their names.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.sort();
    for path in paths {
        if path.is_dir() {
            collect(&path, files);
        } else if MeshFormat::from_path(&path) == Some(MeshFormat::Obj) {
            files.push(path);
        }
    }
}
