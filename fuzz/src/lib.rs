//! What must hold for any bytes. The targets only hand theirs over, so that a finding is replayed and tested
//! without a fuzzer.

#[path = "../../crates/abf/tests/support/exact.rs"]
mod exact;
mod mesh;

use abf::mesh::TriMesh;
use abf::mesh::io::{MeshFile, MeshFormat, parse, parse_materials, write_obj, write_ply};
use abf::{FlattenError, Pipeline, Precision, Silent, StopCriteria};
use exact::{Sign, turns};
use std::path::Path;

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

/// Reads a material library.
///
/// # Panics
/// If the reader does.
pub fn read_materials(bytes: &[u8]) {
    let _ = parse_materials(Path::new("fuzz.mtl"), bytes);
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
