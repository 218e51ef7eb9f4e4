//! Broken documents: each has its own error, at its own place; damaged ones never panic.

use abf_mesh::io::{GltfDocument, GltfTexcoords, MeshFormat, ReadError, WriteError, parse};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::builder::{Builder, U16, sheet};
use super::kinds::{skinned, strip};
use super::{document, kinds, layout};

/// One triangle, changed.
fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut builder = Builder::new();
    let sheet = sheet(1, 1);
    let position = builder.positions(&sheet.positions);
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    builder.mesh(&json!([{"attributes": {"POSITION": position}, "indices": indices}]));
    change(&mut builder.json);
    builder.glb()
}

fn refused(change: impl FnOnce(&mut Value)) -> String {
    parse(MeshFormat::Glb, "f", &changed(change)).expect_err("a broken document").to_string()
}

#[test]
fn the_plain_document_is_good() {
    parse(MeshFormat::Glb, "f", &changed(|_| ())).expect("readable");
}

#[test]
fn compressed_geometry_is_refused_by_name() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let expected = |at: &str| format!("f, {at}: geometry compressed with {name} is not read");
        assert_eq!(refused(|json| json["extensionsRequired"] = json!([name])), expected("extensions"));
        let at = "meshes[0].primitives[0].extensions";
        assert_eq!(refused(|j| j["meshes"][0]["primitives"][0]["extensions"] = json!({name: {}})), expected(at));
        let at = "bufferViews[1].extensions";
        assert_eq!(refused(|json| json["bufferViews"][1]["extensions"] = json!({name: {}})), expected(at));
    }
    // What does not concern geometry is no reason.
    let bytes = changed(|json| json["extensionsRequired"] = json!(["KHR_texture_basisu", "VENDOR_unknown"]));
    document(&bytes).surface().expect("a surface");
}

#[test]
fn other_versions_are_refused() {
    assert_eq!(
        refused(|json| json["asset"]["version"] = "1.0".into()),
        "f, asset.version: version `1.0` of glTF is not read, only 2"
    );
    let missing = refused(|json| json["asset"] = Value::Null);
    assert_eq!(missing, "f, asset: is not an object");
    let mut bytes = changed(|_| ());
    bytes[4] = 1;
    let e = parse(MeshFormat::Glb, "f", &bytes).unwrap_err();
    assert!(matches!(e, ReadError::Unsupported { .. }), "{e}");
    assert!(e.to_string().starts_with("f, byte 4: version 1 of glTF is not supported"), "{e}");
}

#[test]
fn numbers_that_claim_too_much_are_refused_where_they_stand() {
    let big = 4_000_000_000_u64;
    assert_eq!(
        refused(|json| json["accessors"][0]["count"] = big.into()),
        "f, accessors[0]: 4000000000 elements, 12 bytes apart, from byte 0 on reach beyond the 48 bytes of the buffer view"
    );
    assert_eq!(
        refused(|json| json["accessors"][0]["byteOffset"] = u64::MAX.into()),
        "f, accessors[0]: 4 elements, 12 bytes apart, from byte 18446744073709551615 on reach beyond the 48 bytes of the buffer view"
    );
    assert_eq!(
        refused(|json| json["bufferViews"][0]["byteLength"] = big.into()),
        "f, bufferViews[0]: 4000000000 bytes from 0 on reach beyond the 60 of the buffer"
    );
    assert_eq!(
        refused(|json| {
            json["accessors"][0].as_object_mut().expect("it").remove("bufferView");
            json["accessors"][0]["count"] = big.into();
        }),
        "f, accessors[0].count: 4000000000 elements without data are claimed, in a document with 60 bytes of data"
    );
    assert_eq!(
        refused(|json| drop(json["accessors"][1].as_object_mut().expect("it").remove("bufferView"))),
        "f, accessors[1]: indices without a buffer view"
    );
    assert_eq!(
        refused(|json| json["bufferViews"][0]["byteStride"] = 4.into()),
        "f, bufferViews[0].byteStride: 4 is less than an element of 12 bytes"
    );
    let mut bytes = changed(|_| ());
    bytes.truncate(bytes.len() - 1);
    let e = parse(MeshFormat::Glb, "f", &bytes).unwrap_err();
    assert!(matches!(e, ReadError::Truncated { .. }), "{e}");
}

#[test]
fn names_of_nothing_are_refused_where_they_stand() {
    let primitive = |key: &str, value: Value| refused(|json| json["meshes"][0]["primitives"][0][key] = value);
    assert_eq!(
        primitive("indices", 9.into()),
        "f, meshes[0].primitives[0].indices: names accessors[9], but there are only 2 (counted from 0)"
    );
    assert_eq!(
        primitive("indices", (-1).into()),
        "f, meshes[0].primitives[0].indices: `-1` is not a whole number from 0"
    );
    assert_eq!(primitive("mode", 7.into()), "f, meshes[0].primitives[0].mode: 7 is none of 0 to 6");
    assert_eq!(primitive("attributes", json!([])), "f, meshes[0].primitives[0].attributes: is not an object");
    assert_eq!(
        refused(|json| json["accessors"][0]["count"] = 2.into()),
        "f, meshes[0].primitives[0].indices: index 2 names vertex 3, but there are only 2 (counted from 0)"
    );
    assert_eq!(
        refused(|json| json["accessors"][0]["type"] = "VEC2".into()),
        "f, accessors[0].type: `VEC2` where vectors of 3 numbers are needed"
    );
    assert_eq!(
        refused(|json| json["accessors"][1]["componentType"] = 5122.into()),
        "f, accessors[1].componentType: is no type of indices"
    );
    assert_eq!(refused(|json| json["meshes"] = json!([])), "f: no faces (vertices: 0)");
    assert_eq!(
        refused(|json| json["buffers"][0]["uri"] = "https://a/b".into()),
        "f, buffers[0]: the buffer `https://a/b` \
        cannot be read: only names relative to the document are followed"
    );
    let e = parse(MeshFormat::Gltf, "f", b"{\n\"asset\": }").unwrap_err();
    assert!(e.to_string().starts_with("f: not JSON: ") && e.to_string().contains("line 2"), "{e}");
    let e = parse(MeshFormat::Gltf, "f", b"solid").unwrap_err();
    assert_eq!(e.to_string(), "f, byte 0: bad header: neither `glTF`, with which a .glb begins, nor JSON");
}

#[test]
fn whole_numbers_may_be_written_with_a_fraction_of_zero() {
    let bytes = changed(|json| json["accessors"][0]["count"] = 4.0.into());
    document(&bytes).surface().expect("a surface");
}

#[test]
fn what_is_left_out_is_noted() {
    let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == "primitives").expect("the kind");
    let notes = document(&bytes).surface().expect("a surface").notes;
    assert_eq!(notes.ignored["primitive of lines"], 1);
    assert_eq!(notes.ignored["primitive of points"], 1);
    assert_eq!(notes.vertices_welded, 5);
    let notes = document(&strip(5).glb()).surface().expect("a surface").notes;
    assert_eq!(notes.ignored["turn of a triangle strip"], 4);
}

#[test]
fn a_set_that_is_there_or_would_leave_a_gap_is_refused() {
    let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == "textured").expect("the kind");
    let mut document = document(&bytes);
    let before = document.json().clone();
    let uv = layout(&document.surface().expect("a surface"), true);
    let mut set = |set, overwrite| document.set_uvs(&uv, GltfTexcoords { set: Some(set), overwrite }).unwrap_err();
    let e = set(0, false);
    assert_eq!(
        e.to_string(),
        "test, meshes[0].primitives[0]: there is a TEXCOORD_0 already; the next free set is TEXCOORD_1"
    );
    let e = set(2, true);
    assert!(matches!(e, WriteError::TexcoordGap { set: 2, next: 1, .. }), "{e}");
    let short = abf_mesh::UvMap::new(Vec::new(), Vec::new());
    let e = document.set_uvs(&short, GltfTexcoords::default()).unwrap_err();
    assert!(matches!(e, WriteError::UvMismatch { map: 0, mesh: 72 }), "{e}");
    let large = uv.mapped(|p| p * 1e300);
    let e = document.set_uvs(&large, GltfTexcoords::default()).unwrap_err();
    assert!(matches!(e, WriteError::NotFinite { .. }), "{e}");
    assert_eq!(document.json(), &before);
}

#[test]
fn a_set_of_a_large_number_is_one_set() {
    let bytes = changed(|json| json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_4000000000"] = 0.into());
    let mut document = document(&bytes);
    let uv = layout(&document.surface().expect("a surface"), false);
    assert_eq!(document.set_uvs(&uv, GltfTexcoords::default()).expect("set").set, 0);
}

#[test]
fn an_attribute_that_cannot_be_copied_is_named_and_nothing_is_changed() {
    let mut builder = skinned();
    builder.json["accessors"][2]["count"] = 3.into();
    let mut document = document(&builder.glb());
    let before = document.json().clone();
    let surface = document.surface().expect("the joints are of no interest");
    let e = document.set_uvs(&layout(&surface, true), GltfTexcoords::default()).unwrap_err();
    assert_eq!(e.to_string(), "test, accessors[2].count: 3 elements where POSITION has 20");
    assert_eq!(document.json(), &before);
    document.set_uvs(&layout(&surface, false), GltfTexcoords::default()).expect("nothing is copied");
}

/// Reads, edits and packs what may be anything.
fn use_anything(bytes: &[u8]) {
    let mut no_files = |_: &str, _: usize| Err(std::io::ErrorKind::NotFound.into());
    let Ok(mut document) = GltfDocument::parse("damaged", bytes, &mut no_files) else { return };
    let Ok(surface) = document.surface() else { return };
    let uv = layout(&surface, true);
    if uv.points().iter().all(|p| p.iter().all(|x| x.abs() < 1e30))
        && document.set_uvs(&uv, GltfTexcoords::default()).is_ok()
    {
        let again = self::document(&document.to_glb().expect("packed"));
        assert_eq!(again.surface().expect("still a surface").mesh, surface.mesh);
    }
}

#[test]
fn truncated_documents_are_errors() {
    for (name, bytes) in kinds() {
        for length in 1..bytes.len() {
            assert!(parse(MeshFormat::Glb, "f", &bytes[..length]).is_err(), "{name}, {length} bytes");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_documents_never_panic(
        kind in 0..16_usize,
        damages in prop::collection::vec((any::<usize>(), prop_oneof![
            prop::sample::select(b"0123456789-.,:\"{}[]eNx\x00\xff".to_vec()), any::<u8>()]), 1..8),
    ) {
        let (_, mut bytes) = kinds().swap_remove(kind);
        // Mostly the text: numbers in the data cannot do much.
        let text = bytes.len().min(3000);
        for (at, byte) in damages {
            bytes[at % text] = byte;
        }
        use_anything(&bytes);
    }
}
