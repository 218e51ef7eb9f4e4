//! What must hold for any bytes. The targets only hand theirs over, so that a finding is replayed and tested
//! without a fuzzer.

#[path = "../../crates/abf/tests/support/exact.rs"]
mod exact;
mod mesh;

use abf::mesh::io::{
    GltfDocument, GltfTexcoords, MeshFile, MeshFormat, ObjDocument, parse, stored_uv, write_obj,
    write_ply,
};
use abf::mesh::{Point2, TriMesh, UvId, UvMap};
use abf::{FlattenError, Pipeline, Precision, Silent, StopCriteria};
use exact::{Sign, turns};

/// Reads a mesh. What can be read is written and read again as the same mesh.
///
/// # Panics
/// If the reader does, or reads something else the second time.
pub fn read(format: MeshFormat, bytes: &[u8]) {
    let Ok(MeshFile { mesh, uv, .. }) = parse(format, "fuzz", bytes) else { return };
    for face in mesh.faces() {
        assert!(face.iter().all(|vertex| vertex.index() < mesh.vertex_count()), "an index out of range");
    }
    let again = |format: MeshFormat, text: &[u8]| {
        let again = parse(format, "again", text).expect("what is written can be read");
        assert_eq!(again.mesh, mesh, "{format:?}");
        assert_eq!(again.uv.is_some(), uv.is_some(), "{format:?}");
    };
    let mut text = Vec::new();
    if write_obj(&mut text, &mesh, uv.as_ref()).is_ok() {
        again(MeshFormat::Obj, &text);
        // A continued line is for the careful reader: both must say the same.
        text.extend(b"# \\\n\n");
        again(MeshFormat::Obj, &text);
    }
    text.clear();
    if write_ply(&mut text, &mesh, uv.as_ref()).is_ok() {
        again(MeshFormat::Ply, &text);
    }
}

/// A map in which neighbouring triangles are joined or not, as the first bytes of the file have it.
fn some_map(mesh: &TriMesh, bytes: &[u8]) -> UvMap {
    let chart = |face: usize| usize::from(bytes[face % bytes.len()] & 1);
    let corners = mesh.faces().iter().enumerate();
    let corners = corners.flat_map(|(face, vertices)| vertices.map(|v| UvId::new(2 * v.index() + chart(face))));
    let points = (0..2 * mesh.vertex_count()).map(|i| Point2::new(i as f64 / 7.0, 1.0 / (1.0 + i as f64)));
    UvMap::new(points.collect(), corners.collect())
}

/// Reads a glTF document. What can be read gets UVs, is packed and read again as the same surface with those UVs.
///
/// # Panics
/// If anything does, or if something else is read the second time.
pub fn edit_gltf(bytes: &[u8]) {
    let no_files = |_: &str, _: usize| Err(std::io::ErrorKind::NotFound.into());
    let Ok(mut document) = GltfDocument::parse("fuzz", bytes, &mut { no_files }) else { return };
    let Ok(surface) = document.surface() else { return };
    let uv = some_map(&surface.mesh, bytes);
    let overwrite = bytes.len() % 2 == 0;
    let Ok(remap) = document.set_uvs(&uv, GltfTexcoords { set: None, overwrite }) else { return };
    let packed = document.to_glb().expect("less than 4 GiB");
    let again = GltfDocument::parse("again", &packed, &mut { no_files }).expect("what is written can be read");
    let again = again.surface_with_set(remap.set).expect("what is written can be read");
    assert_eq!(again.mesh, surface.mesh);
    let read = again.uv.expect("the map that was written");
    assert!(read.triangles().eq(uv.mapped(stored_uv).triangles()), "the UVs");
}

/// Reads an OBJ. What can be read is written with other UVs and read again as the same mesh with those.
///
/// # Panics
/// If anything does, or if something else is read the second time.
pub fn keep_obj(bytes: &[u8]) {
    let Ok(document) = ObjDocument::parse("fuzz", bytes.to_vec()) else { return };
    let MeshFile { mesh, notes, .. } = document.file();
    let uv = some_map(mesh, bytes);
    let mut text = Vec::new();
    let written = document.write_to(&mut text, &uv).expect("memory is writable");
    let again = parse(MeshFormat::Obj, "again", &text).expect("what is written can be read");
    assert_eq!(&again.mesh, mesh);
    assert_eq!(again.notes.polygons_fanned + written.polygons_split, notes.polygons_fanned);
    assert_eq!(again.notes.ignored, notes.ignored);
    assert!(again.uv.expect("the map that was written").triangles().eq(uv.triangles()), "the UVs");
}

/// Flattens a small mesh. Whatever the result is, it is said truthfully.
///
/// # Panics
/// If anything does, or if the certificate says `valid` of a map that another exact test finds turned over.
pub fn flatten(bytes: &[u8]) {
    let Some((mesh, solver, precision)) = mesh::decode(bytes) else { return };
    let stop = StopCriteria { max_iterations: 20, ..StopCriteria::default() };
    let pipeline = Pipeline { solver, precision, stop, ..Pipeline::default() };
    match pipeline.run(&mesh, &mut Silent) {
        Ok(flat) => {
            let signs = orientations(&mesh, &flat.uv, precision);
            let against = |sign: i8| signs.iter().filter(|&&s| s == sign).count();
            let certificate = &flat.certificate;
            assert_eq!(certificate.collapsed, against(0), "collapsed");
            if certificate.valid() {
                assert!(against(0) == 0 && (against(1) == 0 || against(-1) == 0), "valid, but not: {signs:?}");
            } else if certificate.wound == 0 {
                assert!(against(0) > 0 || (against(1) > 0 && against(-1) > 0), "not valid, but it is: {signs:?}");
            }
            assert!(!certificate.injective() || (certificate.valid() && certificate.overlaps() == 0));
            let _ = flat.metrics(&mesh).map(|metrics| {
                assert_eq!((metrics.flips, metrics.valid()), (certificate.flips, certificate.valid()), "the metrics");
            });
        }
        Err(error) => assert!(!matches!(error, FlattenError::Cancelled | FlattenError::LscmLayout(_)), "{error}"),
    }
}

/// The sign of every triangle's area in the map, in whole numbers: not by the predicate that made the certificate.
fn orientations(mesh: &TriMesh, uv: &abf::mesh::UvMap, precision: Precision) -> Vec<i8> {
    assert_eq!(uv.triangles().len(), mesh.face_count());
    let sign = |triangle: [abf::mesh::Point2<f64>; 3]| {
        for p in &triangle {
            assert!(p.x.is_finite() && p.y.is_finite(), "a UV that is no number");
            assert_eq!([precision.round(p.x), precision.round(p.y)], [p.x, p.y], "not as stored");
        }
        match turns(&triangle) {
            Sign::Plus => 1,
            Sign::NoSign => 0,
            Sign::Minus => -1,
        }
    };
    uv.triangles().map(sign).collect()
}
