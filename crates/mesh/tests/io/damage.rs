//! Damaged files: an error or a mesh, never a panic.

use abf_mesh::io::{MeshFile, MeshFormat, ReadError, parse};
use proptest::prelude::*;

use crate::common::all_kinds;

/// Reads what may be anything; what is accepted must be sound.
fn read_anything(format: MeshFormat, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let file = parse(format, "damaged", bytes)?;
    assert!(file.mesh.face_count() > 0);
    assert!(file.mesh.positions().iter().all(|p| p.iter().all(|x| x.is_finite())));
    assert!(file.mesh.faces().iter().flatten().all(|v| v.index() < file.mesh.vertex_count()));
    if let Some(map) = &file.uv {
        assert_eq!(map.corners().len(), 3 * file.mesh.face_count());
        assert!(map.points().iter().all(|p| p.x.is_finite() && p.y.is_finite()));
    }
    let _: Vec<String> = file.notes.sentences();
    Ok(file)
}

/// Whether every proper beginning of such a file must be refused: its length is known from itself.
fn knows_its_length(kind: &str) -> bool {
    kind.contains("PLY with") || kind.contains("big-endian") || kind.contains("binary")
}

#[test]
fn a_truncated_file_is_no_panic_and_a_truncated_binary_an_error() {
    let mut refused = 0;
    for (kind, format, bytes) in all_kinds() {
        for length in 0..bytes.len() {
            let result = read_anything(format, &bytes[..length]);
            if knows_its_length(kind) {
                let e = result.expect_err("a truncated binary file");
                assert!(e.to_string().starts_with("damaged"), "{kind}, {length} bytes: {e}");
                refused += 1;
            }
        }
        read_anything(format, &bytes).unwrap_or_else(|e| panic!("{kind}: {e}"));
    }
    assert!(refused > 1000, "{refused} binary beginnings were tried");
}

#[test]
fn a_text_stl_or_ply_cut_at_a_line_is_an_error() {
    for (kind, format, bytes) in all_kinds().into_iter().filter(|(kind, ..)| kind.starts_with("text")) {
        for length in (0..bytes.len() - 1).filter(|&i| bytes[i] == b'\n') {
            let result = read_anything(format, &bytes[..length]);
            // Between two facets only `endsolid` is missing.
            let between = bytes[..length].ends_with(b"endfacet");
            match result {
                Ok(file) => assert!(between && file.notes.end_missing, "{kind}, {length} bytes"),
                Err(e) => assert!(!between, "{kind}, {length} bytes: {e}"),
            }
        }
    }
}

/// One change to a file.
#[derive(Clone, Debug)]
enum Damage {
    Set(usize, u8),
    Remove(usize, usize),
    Repeat(usize, usize),
}

fn damage() -> impl Strategy<Value = Damage> {
    // Mostly bytes that mean something to one of the formats.
    let telling = prop::sample::select(b" \n\r\\#/-.0129eEnvft\x00\xff".to_vec());
    let byte = prop_oneof![3 => telling, 1 => any::<u8>()];
    prop_oneof![
        4 => (any::<usize>(), byte).prop_map(|(i, b)| Damage::Set(i, b)),
        1 => (any::<usize>(), 1..20_usize).prop_map(|(i, n)| Damage::Remove(i, n)),
        1 => (any::<usize>(), 1..40_usize).prop_map(|(i, n)| Damage::Repeat(i, n)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    let range = |i: usize, n: usize| {
        let start = i % bytes.len();
        start..(start + n).min(bytes.len())
    };
    match *damage {
        _ if bytes.is_empty() => {}
        Damage::Set(i, byte) => {
            let i = i % bytes.len();
            bytes[i] = byte;
        }
        Damage::Remove(i, n) => drop(bytes.drain(range(i, n))),
        Damage::Repeat(i, n) => {
            let piece = bytes[range(i, n)].to_vec();
            bytes.extend(piece);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn damaged_files_never_panic(kind in 0..9_usize, damages in prop::collection::vec(damage(), 1..12)) {
        let (_, format, mut bytes) = all_kinds().swap_remove(kind);
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        let _ = read_anything(format, &bytes);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for (_, format, head) in all_kinds() {
            let _ = read_anything(format, &bytes);
            // Behind a good header.
            let head = &head[..head.len().min(200)];
            let _ = read_anything(format, &[head, &bytes].concat());
        }
    }
}
