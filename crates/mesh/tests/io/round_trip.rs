//! What is written is read back to the bit, and all formats of one mesh say the same.

use abf_mesh::io::{MeshFormat, ReadError, ReadNotes, WriteError, read, write};
use abf_mesh::{Point2, Point3, TriMesh, UvId, UvMap};
use proptest::prelude::*;

use crate::common::{all_kinds, flat_map, obj, ply, position_bits, pyramid, read_bytes, seam_map, uv_bits};

/// Writes and reads in both formats, and compares everything.
fn assert_round_trip(mesh: &TriMesh, map: Option<&UvMap>) {
    for (format, bytes) in [(MeshFormat::Obj, obj(mesh, map)), (MeshFormat::Ply, ply(mesh, map))] {
        let file = read_bytes(format, &bytes);
        assert_eq!(position_bits(&file.mesh), position_bits(mesh), "{format:?}");
        assert_eq!(file.mesh.faces(), mesh.faces(), "{format:?}");
        assert_eq!(file.uv.as_ref().map(uv_bits), map.map(uv_bits), "{format:?}");
        if let (Some(read), Some(map)) = (&file.uv, map) {
            assert_eq!(joined(mesh, read), joined(mesh, map), "{format:?}");
        }
        let mut notes = ReadNotes::default();
        notes.unreferenced_vertices = mesh.unreferenced_vertices();
        // A PLY with one UV per vertex has one for these too.
        let padded = format == MeshFormat::Ply && map.is_some();
        notes.unreferenced_uvs = if padded { mesh.unreferenced_vertices() } else { 0 };
        assert_eq!(file.notes, notes, "{format:?}");
    }
}

/// For every corner the first corner of the same vertex with the same UV point.
fn joined(mesh: &TriMesh, map: &UvMap) -> Vec<usize> {
    let names: Vec<_> = mesh.faces().iter().flatten().zip(map.corners()).collect();
    names.iter().map(|name| names.iter().position(|other| other == name).expect("itself")).collect()
}

#[test]
fn a_mesh_without_uvs_comes_back() {
    assert_round_trip(&pyramid(), None);
}

#[test]
fn one_uv_per_vertex_comes_back() {
    assert_round_trip(&pyramid(), Some(&flat_map(&pyramid())));
}

#[test]
fn uvs_with_seams_come_back() {
    assert_round_trip(&pyramid(), Some(&seam_map()));
}

#[test]
fn uvs_that_differ_in_the_sign_of_zero_come_back() {
    let mesh = TriMesh::new(vec![Point3::origin(); 4], &[[0, 1, 2], [0, 2, 3]]).expect("indices in range");
    let points = [[0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [-0.0, 1.0], [0.5, 0.5]].map(Point2::from).to_vec();
    assert_round_trip(&mesh, Some(&UvMap::new(points, [0, 1, 2, 3, 2, 4].map(UvId::new).to_vec())));
}

#[test]
fn vertices_without_faces_come_back() {
    let mesh = TriMesh::new(vec![Point3::new(0.5, -0.0, 9.0); 5], &[[3, 1, 4]]).expect("indices in range");
    assert_round_trip(&mesh, None);
    assert_round_trip(&mesh, Some(&flat_map(&mesh)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_finite_number_comes_back(bits in proptest::array::uniform9(any::<u64>())) {
        let numbers = bits.map(f64::from_bits).map(|x| if x.is_finite() { x } else { f64::MIN_POSITIVE / 3.0 });
        let positions = numbers.chunks_exact(3).map(|p| Point3::new(p[0], p[1], p[2])).collect();
        let mesh = TriMesh::new(positions, &[[2, 0, 1]]).expect("indices in range");
        assert_round_trip(&mesh, None);
    }
}

#[test]
fn all_formats_of_one_mesh_agree() {
    let mesh = pyramid();
    for (kind, format, bytes) in all_kinds() {
        let file = read_bytes(format, &bytes);
        assert_eq!(position_bits(&file.mesh), position_bits(&mesh), "{kind}");
        assert_eq!(file.mesh.faces(), mesh.faces(), "{kind}");
        // 12 corners, 5 vertices.
        assert_eq!(file.notes.vertices_welded, if format == MeshFormat::Stl { 7 } else { 0 }, "{kind}");
    }
}

#[test]
fn files_are_written_and_read_by_their_extension() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mesh, map) = (pyramid(), seam_map());
    for name in ["a.obj", "b.PLY"] {
        let path = folder.path().join(name);
        std::fs::write(&path, "what stood there before").expect("written");
        write(&path, &mesh, Some(&map)).expect("written");
        let file = read(&path).expect("read");
        assert_eq!(file.mesh, mesh);
        assert_eq!(uv_bits(&file.uv.expect("a map")), uv_bits(&map));
    }
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 2, "no temporary file stays");
}

#[cfg(unix)]
#[test]
fn a_written_file_has_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder");
    let (ours, plain) = (folder.path().join("a.obj"), folder.path().join("plain"));
    write(&ours, &pyramid(), None).expect("written");
    std::fs::write(&plain, "").expect("written");
    let mode = |path| std::fs::metadata(path).expect("a file").permissions().mode();
    assert_eq!(mode(ours), mode(plain));
}

#[cfg(unix)]
#[test]
fn whoever_reads_the_old_file_goes_on_reading_the_old_file() {
    use std::io::Read;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.obj");
    std::fs::write(&path, "old").expect("written");
    let mut reader = std::fs::File::open(&path).expect("opened");
    write(&path, &pyramid(), None).expect("written");
    let mut seen = String::new();
    reader.read_to_string(&mut seen).expect("read");
    assert_eq!(seen, "old", "the file was replaced, not written over");
}

#[test]
fn paths_that_cannot_be_read_or_written_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("missing.obj");
    let e = read(&missing).unwrap_err();
    assert!(matches!(&e, ReadError::Open { file, .. } if file.ends_with("missing.obj")), "{e}");
    // Whatever its extension: what is not there has no wrong one.
    let e = read(&folder.path().join("missing")).unwrap_err();
    assert!(matches!(&e, ReadError::Open { .. }), "{e}");
    for name in ["mesh.fbx", "mesh"] {
        std::fs::write(folder.path().join(name), "v 0 0 0").expect("written");
    }
    let e = read(&folder.path().join("mesh.fbx")).unwrap_err();
    let every = MeshFormat::ALL.map(MeshFormat::extension).join(", ");
    assert!(matches!(&e, ReadError::UnknownExtension { known, .. } if *known == every), "{e}");
    let e = read(&folder.path().join("mesh")).unwrap_err();
    assert!(matches!(&e, ReadError::UnknownExtension { .. }), "{e}");
    let e = write(&folder.path().join("mesh.stl"), &pyramid(), None).unwrap_err();
    assert!(matches!(&e, WriteError::UnknownExtension { file } if file.ends_with("mesh.stl")), "{e}");
    let e = write(&folder.path().join("no/such/folder.obj"), &pyramid(), None).unwrap_err();
    assert!(matches!(&e, WriteError::Io { target, .. } if target.ends_with("folder.obj")), "{e}");
}
