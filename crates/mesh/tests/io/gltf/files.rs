//! Documents in files: what is beside them, where they are written to, and other formats written as glTF.

use std::path::Path;

use abf_mesh::io::{GltfDocument, GltfTexcoords, MeshFormat, ReadError, WriteError, read, stored_uv, write};
use abf_mesh::{Point3, TriMesh};
use serde_json::{Value, json};

use super::kinds::{extended, skinned};
use super::{document, kinds, layout};
use crate::common::{pyramid, seam_map, uv_bits};

fn json_of(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
}

/// A document with a buffer and an image beside it.
fn with_file(folder: &Path) -> std::path::PathBuf {
    let mut builder = skinned();
    builder.json["images"] = json!([{"uri": "textures/a%20b.png"}, {"uri": "data:image/png;base64,AAAA"}]);
    let (text, bin) = builder.with_file("the%20model.bin");
    std::fs::write(folder.join("the model.bin"), bin).expect("written");
    let path = folder.join("model.gltf");
    std::fs::write(&path, text).expect("written");
    path
}

#[test]
fn a_gltf_in_the_same_folder_keeps_its_names_and_gets_one_buffer_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = with_file(folder.path());
    let old = json_of(&path);
    let old_bin = std::fs::read(folder.path().join("the model.bin")).expect("read");
    let mut document = GltfDocument::read(&path).expect("readable");
    let surface = document.surface().expect("a surface");
    document.set_uvs(&layout(&surface, true), GltfTexcoords::default()).expect("set");
    document.write(&path).expect("written");
    let new = json_of(&path);
    assert_eq!(new["images"], old["images"]);
    assert_eq!(new["buffers"][0], old["buffers"][0]);
    assert_eq!(new["buffers"][1]["uri"], "model.bin");
    assert_eq!(std::fs::read(folder.path().join("the model.bin")).expect("read"), old_bin);
    let again = GltfDocument::read(&path).expect("readable").surface().expect("a surface");
    assert_eq!(again.mesh, surface.mesh);
    // A second edit reads and keeps the first: `model.bin` is a name that is taken now.
    let mut document = GltfDocument::read(&path).expect("readable");
    document.set_uvs(&layout(&surface, false), GltfTexcoords::default()).expect("set");
    document.write(&path).expect("written");
    assert_eq!(json_of(&path)["buffers"][2]["uri"], "model-uv.bin");
    let both = GltfDocument::read(&path).expect("readable");
    assert_eq!(both.surface_with_set(0).expect("a surface").uv, again.uv);
    assert!(both.surface_with_set(1).expect("a surface").uv.is_some());
}

#[test]
fn names_are_changed_for_another_folder_and_buffers_go_into_a_glb() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = with_file(folder.path());
    let out = folder.path().join("out put/deep");
    std::fs::create_dir_all(&out).expect("a folder");
    let document = GltfDocument::read(&path).expect("readable");
    let surface = document.surface().expect("a surface");
    document.write(&out.join("a.gltf")).expect("written");
    let json = json_of(&out.join("a.gltf"));
    assert_eq!(json["images"][0]["uri"], "../../textures/a%20b.png");
    assert_eq!(json["images"][1]["uri"], "data:image/png;base64,AAAA");
    assert_eq!(json["buffers"][0]["uri"], "../../the%20model.bin");
    assert_eq!(GltfDocument::read(&out.join("a.gltf")).expect("readable").surface().expect("it"), surface);
    let mut document = document;
    document.set_uvs(&layout(&surface, true), GltfTexcoords::default()).expect("set");
    document.write(&out.join("b.glb")).expect("written");
    std::fs::remove_file(folder.path().join("the model.bin")).expect("removed");
    let packed = GltfDocument::read(&out.join("b.glb")).expect("nothing else is needed");
    assert_eq!(packed.json()["buffers"].as_array().map(Vec::len), Some(1));
    assert_eq!(packed.json()["images"][0]["uri"], "../../textures/a%20b.png");
    assert_eq!(packed.surface().expect("a surface").mesh, surface.mesh);
    // And back: the folder of the original from one below.
    packed.write(&folder.path().join("c.gltf")).expect("written");
    let back = json_of(&folder.path().join("c.gltf"));
    assert_eq!(back["images"][0]["uri"], "out%20put/deep/../../textures/a%20b.png");
    assert_eq!(back["buffers"][0]["uri"], "c.bin");
    assert_eq!(read(&folder.path().join("c.gltf")).expect("readable").mesh, surface.mesh);
}

#[test]
fn a_document_in_lines_stays_in_lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.gltf");
    let bytes = extended().with_data();
    document(&bytes).write(&path).expect("written");
    assert_eq!(String::from_utf8(std::fs::read(&path).expect("read")), String::from_utf8(bytes));
}

#[test]
fn a_document_with_everything_inside_stays_one_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut document = document(&extended().with_data());
    let surface = document.surface().expect("a surface");
    document.set_uvs(&layout(&surface, true), GltfTexcoords::default()).expect("set");
    document.write(&folder.path().join("a.gltf")).expect("written");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    let again = GltfDocument::read(&folder.path().join("a.gltf")).expect("readable");
    assert_eq!(again.json()["buffers"].as_array().map(Vec::len), Some(2));
    assert_eq!(again.surface().expect("a surface").mesh, surface.mesh);
}

#[test]
fn a_missing_buffer_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = with_file(folder.path());
    std::fs::remove_file(folder.path().join("the model.bin")).expect("removed");
    let e = GltfDocument::read(&path).unwrap_err();
    assert!(matches!(&e, ReadError::Buffer { uri, .. } if uri == "the%20model.bin"), "{e}");
    assert!(e.to_string().contains("model.gltf, buffers[0]: the buffer `the%20model.bin` cannot be read"), "{e}");
    std::fs::write(folder.path().join("the model.bin"), [0; 10]).expect("written");
    let e = GltfDocument::read(&path).unwrap_err();
    assert!(e.to_string().contains("buffers[0]: truncated: "), "{e}");
}

#[test]
fn other_meshes_are_written_as_gltf_and_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mesh, map) = (pyramid(), seam_map());
    for name in ["a.glb", "b.GLTF"] {
        let path = folder.path().join(name);
        write(&path, &mesh, Some(&map)).expect("written");
        let file = read(&path).expect("read");
        assert_eq!(file.mesh, mesh);
        let stored = map.clone().mapped(stored_uv);
        assert_eq!(file.uv.expect("a map").triangles().collect::<Vec<_>>(), stored.triangles().collect::<Vec<_>>());
        // Two of the five vertices are on the seam.
        let document = GltfDocument::read(&path).expect("read");
        assert_eq!(document.primitives().expect("primitives")[0].positions.len(), 7);
        write(&path, &mesh, None).expect("written");
        assert_eq!(read(&path).expect("read").uv, None);
    }
    assert!(folder.path().join("b.bin").is_file());
    let e = write(
        &folder.path().join("c.glb"),
        &TriMesh::new(vec![Point3::new(1e39, 0.0, 0.0); 3], &[[0, 1, 2]]).expect("a mesh"),
        None,
    );
    assert!(matches!(e, Err(WriteError::NotFinite { count: 3, .. })), "{e:?}");
    let empty = TriMesh::new(Vec::new(), &[]).expect("a mesh");
    write(&folder.path().join("c.glb"), &empty, None).expect("written");
    assert!(matches!(read(&folder.path().join("c.glb")), Err(ReadError::NoFaces { .. })));
}

#[test]
fn a_document_is_read_as_any_mesh() {
    for (name, bytes) in kinds() {
        let surface = document(&bytes).surface().expect("a surface");
        for format in [MeshFormat::Gltf, MeshFormat::Glb] {
            let file = abf_mesh::io::parse(format, name, &bytes).expect("readable");
            let mesh = surface.sized().unwrap_or_else(|| surface.mesh.clone());
            assert_eq!((&file.mesh, &file.notes), (&mesh, &surface.notes), "{name}");
            assert_eq!(file.uv.as_ref().map(uv_bits), surface.uv.as_ref().map(uv_bits), "{name}");
        }
    }
}

/// `scripts/check-gltf` gives these to the Khronos validator and to three.js.
#[test]
fn documents_are_written_for_other_programs() {
    let Some(out) = std::env::var_os("ABF_GLTF_OUT") else { return };
    let (before, after) = (Path::new(&out).join("before"), Path::new(&out).join("after"));
    [&before, &after].into_iter().for_each(|folder| std::fs::create_dir_all(folder).expect("a folder"));
    let mut list = Vec::new();
    let mut add =
        |from: &str, how: &str, mut document: GltfDocument, seam: bool, texcoords: GltfTexcoords, extension: &str| {
            let surface = document.surface().expect("a surface");
            let remap = document.set_uvs(&layout(&surface, seam), texcoords).expect("set");
            let counts: Vec<usize> = remap.primitives.iter().map(|p| p.vertices.len()).collect();
            let file = format!("{from}{how}.{extension}");
            document.write(&after.join(&file)).expect("written");
            let corners = 3 * surface.mesh.face_count();
            list.push(json!({"file": file, "before": from, "set": remap.set, "vertices": counts, "corners": corners}));
        };
    for (name, bytes) in kinds() {
        std::fs::write(before.join(name), &bytes).expect("written");
        for (seam, overwrite) in [(false, false), (true, false), (true, true)] {
            let how = format!("{}{}", if seam { "-seam" } else { "" }, if overwrite { "-overwritten" } else { "" });
            let texcoords = GltfTexcoords { set: None, overwrite };
            let extension = if name == "data-uri" { "gltf" } else { "glb" };
            add(name, &how, document(&bytes), seam, texcoords, extension);
        }
    }
    let file = with_file(&before);
    std::fs::create_dir_all(before.join("textures")).expect("a folder");
    let mut json = json_of(&file);
    json.as_object_mut().expect("an object").retain(|key, _| key != "images");
    std::fs::write(before.join("external"), json.to_string()).expect("written");
    let external = || GltfDocument::read(&before.join("external")).expect("readable");
    add("external", "", external(), true, GltfTexcoords::default(), "gltf");
    add("external", "-packed", external(), true, GltfTexcoords::default(), "glb");
    let plain = GltfDocument::of_mesh(&pyramid(), None).expect("a document");
    plain.write(&before.join("plain.glb")).expect("written");
    std::fs::rename(before.join("plain.glb"), before.join("plain")).expect("renamed");
    let plain = || GltfDocument::of_mesh(&pyramid(), None).expect("a document");
    add("plain", "", plain(), true, GltfTexcoords::default(), "glb");
    add("plain", "-file", plain(), true, GltfTexcoords::default(), "gltf");
    std::fs::write(Path::new(&out).join("list.json"), Value::Array(list).to_string()).expect("written");
}
