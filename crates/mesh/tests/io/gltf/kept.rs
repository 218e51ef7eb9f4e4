//! Whatever a document holds is there again after UVs were added.

use std::collections::BTreeMap;

use abf_mesh::io::{GltfDocument, GltfRemap, GltfSurface, GltfTexcoords, stored_uv};
use abf_mesh::{UvMap, VertexId};
use serde_json::{Value, json};

use super::{document, kinds, layout};

/// An element of an accessor as bytes, read in the plainest way.
fn element(document: &GltfDocument, accessor: usize, i: usize) -> Vec<u8> {
    let json = document.json();
    let number = |value: &Value, key: &str| value[key].as_u64().unwrap_or(0) as usize;
    let size_of = |component: usize| [1, 1, 2, 2, 0, 4, 4][component - 5120];
    let accessor = &json["accessors"][accessor];
    let kinds = [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4), ("MAT4", 16)];
    let width = kinds.iter().find(|(name, _)| accessor["type"] == *name).expect("a type").1;
    let size = width * size_of(number(accessor, "componentType"));
    let read = |part: &Value, i: usize, size: usize| {
        let view = &json["bufferViews"][number(part, "bufferView")];
        let stride = if view["byteStride"].is_null() { size } else { number(view, "byteStride") };
        let start = number(view, "byteOffset") + number(part, "byteOffset") + i * stride;
        document.buffer(number(view, "buffer")).expect("a buffer")[start..start + size].to_vec()
    };
    let sparse = &accessor["sparse"];
    for k in 0..number(sparse, "count") {
        let mut bytes = read(&sparse["indices"], k, size_of(number(&sparse["indices"], "componentType")));
        bytes.resize(8, 0);
        if usize::from_le_bytes(bytes.try_into().expect("eight")) == i {
            return read(&sparse["values"], k, size);
        }
    }
    if accessor["bufferView"].is_null() { vec![0; size] } else { read(accessor, i, size) }
}

/// For every corner of the surface all that is known of it but the UVs of one set, by name.
fn corners(document: &GltfDocument, surface: &GltfSurface, but: &[u32]) -> Vec<BTreeMap<String, Vec<u8>>> {
    let mut out = Vec::new();
    for (primitive, faces) in surface.primitives.iter().zip(&surface.faces) {
        let json = &document.json()["meshes"][primitive.mesh]["primitives"][primitive.primitive];
        let mut names: Vec<(String, usize)> = Vec::new();
        let mut add = |prefix: &str, names_of: &Value| {
            for (name, accessor) in names_of.as_object().expect("names") {
                let skipped = but.iter().any(|set| *name == format!("TEXCOORD_{set}"));
                if !skipped {
                    names.push((format!("{prefix}{name}"), accessor.as_u64().expect("an index") as usize));
                }
            }
        };
        add("", &json["attributes"]);
        for (i, target) in json["targets"].as_array().into_iter().flatten().enumerate() {
            add(&format!("{i}:"), target);
        }
        for &v in &surface.vertices[3 * faces.start..3 * faces.end] {
            let all = names.iter().map(|(name, accessor)| (name.clone(), element(document, *accessor, v as usize)));
            out.push(all.collect());
        }
    }
    out
}

/// The document without what may differ: names of accessors in primitives, and everything that was appended.
fn rest(document: &GltfDocument, before: &GltfDocument) -> String {
    let mut json = document.json().clone();
    for key in ["accessors", "bufferViews"] {
        let count = before.json()[key].as_array().map_or(0, Vec::len);
        json[key].as_array_mut().expect("a list").truncate(count);
    }
    // The UVs that were written last have a name, which those before lose.
    for accessor in json["accessors"].as_array_mut().expect("a list").iter_mut().filter_map(Value::as_object_mut) {
        accessor.retain(|key, value| key != "name" || value != "abf UVs");
    }
    for mesh in json["meshes"].as_array_mut().expect("meshes") {
        for primitive in mesh["primitives"].as_array_mut().expect("primitives") {
            for key in ["attributes", "targets"] {
                if primitive.get(key).is_some() {
                    primitive[key] = Value::Null;
                }
            }
            primitive.as_object_mut().expect("an object").retain(|key, _| key != "indices" && key != "mode");
        }
    }
    json["buffers"][0]["byteLength"] = 0.into();
    json["buffers"][0].as_object_mut().expect("a buffer").retain(|key, _| key != "uri");
    json["buffers"].as_array_mut().expect("buffers").truncate(1);
    Value::Object(json).to_string()
}

/// Adds UVs, packs, reads again, and compares everything.
fn check(name: &str, bytes: &[u8], seam: bool, texcoords: GltfTexcoords) -> (GltfDocument, GltfRemap) {
    let before = document(bytes);
    let surface = before.surface().unwrap_or_else(|e| panic!("{name}: {e}"));
    let uv = layout(&surface, seam);
    let mut changed = before.clone();
    let remap = changed.set_uvs(&uv, texcoords).unwrap_or_else(|e| panic!("{name}: {e}"));
    let after = document(&changed.to_glb().expect("packed"));
    let again = after.surface_with_set(remap.set).unwrap_or_else(|e| panic!("{name}: {e}"));

    assert_eq!(again.mesh, surface.mesh, "{name}");
    let stored: Vec<_> = uv.triangles().flatten().map(stored_uv).collect();
    let read: Vec<_> = again.uv.as_ref().expect("a map").triangles().flatten().collect();
    assert_eq!(read, stored, "{name}");
    // Sets that a primitive lacked are new, too.
    let new: Vec<u32> =
        (0..=remap.set).filter(|set| surface.primitives.iter().any(|p| !p.texcoords.contains(set))).collect();
    let new: Vec<u32> = new.into_iter().chain([remap.set]).collect();
    assert_eq!(corners(&after, &again, &new), corners(&before, &surface, &new), "{name}");
    assert_eq!(rest(&after, &before), rest(&before, &before), "{name}");
    let old = before.buffer(0).expect("a buffer");
    assert_eq!(&after.buffer(0).expect("a buffer")[..old.len()], old, "{name}");
    check_remap(name, &surface, &again, &remap);
    if !seam {
        let changed_indices = after.json()["meshes"].to_string().matches("indices").count();
        assert_eq!(changed_indices, before.json()["meshes"].to_string().matches("indices").count());
    }
    check_with_another_reader(name, &changed.to_glb().expect("packed"), &again, remap.set);
    (after, remap)
}

fn check_remap(name: &str, before: &GltfSurface, after: &GltfSurface, remap: &GltfRemap) {
    assert_eq!(remap.primitives.len(), before.primitives.iter().filter(|p| !p.triangles.is_empty()).count());
    for primitive in &remap.primitives {
        let same = |p: &&abf_mesh::io::GltfPrimitive| (p.mesh, p.primitive) == (primitive.mesh, primitive.primitive);
        let (old, new) =
            (before.primitives.iter().find(same).expect("it"), after.primitives.iter().find(same).expect("it"));
        assert_eq!(primitive.vertices.len(), new.positions.len(), "{name}");
        for (new_vertex, &old_vertex) in primitive.vertices.iter().enumerate() {
            assert_eq!(new.positions[new_vertex], old.positions[old_vertex as usize], "{name}");
        }
        for (old, new) in old.triangles.as_flattened().iter().zip(new.triangles.as_flattened()) {
            assert_eq!(primitive.vertices[*new as usize], *old, "{name}");
        }
    }
    let again: GltfRemap = remap.clone();
    let json: Value = serde_json::from_str(&again.to_json()).expect("JSON");
    assert_eq!(json["set"], json!(remap.set));
    assert_eq!(json["primitives"].as_array().map(Vec::len), Some(remap.primitives.len()));
}

/// The `gltf` crate reads the same corners.
fn check_with_another_reader(name: &str, bytes: &[u8], surface: &GltfSurface, set: u32) {
    if name == "quantized" {
        return; // It has no quantization.
    }
    let theirs = gltf::Gltf::from_slice(bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
    let blob = theirs.blob.as_deref();
    let all = theirs.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>());
    let triangles: Vec<_> = all.filter(|p| p.mode() == gltf::mesh::Mode::Triangles).collect();
    let count = triangles.len();
    let mut corner = 0;
    for primitive in triangles {
        let reader = primitive.reader(|buffer| blob.filter(|_| buffer.index() == 0));
        let positions: Vec<[f32; 3]> = reader.read_positions().expect("positions").collect();
        let uvs: Vec<[f32; 2]> = reader.read_tex_coords(set).expect("the set").into_f32().collect();
        let every = || (0..positions.len() as u32).collect();
        let indices: Vec<u32> = reader.read_indices().map_or_else(every, |indices| indices.into_u32().collect());
        for v in indices {
            let at = surface.mesh.faces()[corner / 3][corner % 3];
            assert_eq!(surface.mesh.positions()[at.index()], positions[v as usize].map(f64::from).into(), "{name}");
            let uv = surface.uv.as_ref().expect("a map").corner(abf_mesh::CornerId::new(corner));
            let [u, t] = uvs[v as usize].map(f64::from);
            assert_eq!([uv.x, uv.y], [u, 1.0 - t], "{name}");
            corner += 1;
        }
    }
    let lists = surface.primitives.len() == count;
    assert!(!lists || corner == 3 * surface.mesh.face_count(), "{name}");
}

#[test]
fn nothing_is_lost_where_no_vertex_is_split() {
    for (name, bytes) in kinds() {
        let (_, remap) = check(name, &bytes, false, GltfTexcoords::default());
        assert_eq!(remap.vertices_added, 0, "{name}");
    }
}

#[test]
fn nothing_is_lost_where_vertices_are_split() {
    let mut added = BTreeMap::new();
    for (name, bytes) in kinds() {
        let (_, remap) = check(name, &bytes, true, GltfTexcoords::default());
        added.insert(name, remap.vertices_added);
    }
    // No vertex of a soup has two corners; all others are split along their seam.
    assert!(added.iter().all(|(name, &n)| (n == 0) == (*name == "soup")), "{added:?}");
}

#[test]
fn a_second_set_follows_and_old_ones_are_kept_unless_overwritten() {
    for (name, bytes) in kinds() {
        let first = document(&bytes).surface().expect("a surface");
        let next = first.primitives.iter().flat_map(|p| &p.texcoords).max().map_or(0, |last| last + 1);
        let (after, remap) = check(name, &bytes, true, GltfTexcoords::default());
        assert_eq!(remap.set, next, "{name}");
        let again = check(name, &after.to_glb().expect("packed"), true, GltfTexcoords::default());
        assert_eq!(again.1.set, next + 1, "{name}");
        let overwritten = GltfTexcoords { set: None, overwrite: true };
        assert_eq!(check(name, &bytes, true, overwritten).1.set, 0, "{name}");
    }
}

#[test]
fn the_surface_has_the_uvs_that_were_written_last() {
    for (name, bytes) in kinds() {
        let first = document(&bytes).surface().expect("a surface");
        assert_eq!((first.set, first.notes.texcoord), (0, None), "{name}");
        let (once, remap) = check(name, &bytes, true, GltfTexcoords::default());
        let set_of = |document: &GltfDocument| document.surface().expect("a surface").set;
        assert_eq!(set_of(&once), remap.set, "{name}");
        let (twice, remap) = check(name, &once.to_glb().expect("packed"), true, GltfTexcoords::default());
        assert_eq!(set_of(&twice), remap.set, "{name}");
        let surface = twice.surface().expect("a surface");
        assert_eq!(surface.uv, twice.surface_with_set(remap.set).expect("a surface").uv, "{name}");
        assert_eq!(surface.notes.texcoord, Some(remap.set), "{name}");
        let overwritten = GltfTexcoords { set: None, overwrite: true };
        assert_eq!(set_of(&check(name, &twice.to_glb().expect("packed"), true, overwritten).0), 0, "{name}");
    }
}

#[test]
fn a_set_that_is_not_there_is_told_with_one_that_is() {
    let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == "primitives").expect("the kind");
    let (after, remap) = check("primitives", &bytes, true, GltfTexcoords::default());
    let surface = after.surface_with_set(9).expect("a surface");
    assert_eq!(surface.uv, None);
    let said = surface.notes.uv_dropped.expect("a reason").to_string();
    assert!(remap.set == 2 && said.contains("TEXCOORD_9") && said.contains("all have TEXCOORD_0"), "{said}");
}

#[test]
fn gaps_in_the_sets_are_filled_with_the_new_uvs() {
    let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == "primitives").expect("the kind");
    let (after, remap) = check("primitives", &bytes, true, GltfTexcoords::default());
    assert_eq!(remap.set, 2);
    let sets: Vec<_> = after.primitives().expect("primitives").into_iter().map(|p| p.texcoords).collect();
    assert_eq!(sets, [[0, 1, 2], [0, 1, 2]]);
    let attributes = &after.json()["meshes"][0]["primitives"][0]["attributes"];
    assert_eq!(attributes["TEXCOORD_0"], attributes["TEXCOORD_2"]);
}

#[test]
fn narrow_indices_are_widened_only_when_they_have_to_be() {
    let find = |kind: &str| kinds().into_iter().find(|(name, _)| *name == kind).expect("the kind").1;
    let component = |document: &GltfDocument| {
        let primitive = &document.json()["meshes"][0]["primitives"][0];
        let accessor = &document.json()["accessors"][primitive["indices"].as_u64().expect("indices") as usize];
        accessor["componentType"].as_u64().expect("a number")
    };
    assert_eq!(component(&check("indices-8", &find("indices-8"), false, GltfTexcoords::default()).0), 5121);
    assert_eq!(component(&check("indices-8", &find("indices-8"), true, GltfTexcoords::default()).0), 5123);
    assert_eq!(component(&check("indices-32", &find("indices-32"), true, GltfTexcoords::default()).0), 5125);
}

#[test]
fn primitives_that_share_their_vertices_go_on_sharing_them() {
    let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == "shared").expect("the kind");
    let (after, _) = check("shared", &bytes, true, GltfTexcoords::default());
    let primitives = &after.json()["meshes"][0]["primitives"];
    assert_eq!(primitives[0]["attributes"], primitives[2]["attributes"]);
    assert_ne!(primitives[0]["attributes"]["POSITION"], primitives[1]["attributes"]["POSITION"]);
    let surface = after.surface().expect("a surface");
    assert_eq!(surface.material_of_faces(), vec![0; surface.mesh.face_count()]);
    assert_eq!(surface.primitive_of_faces()[11..13], [0, 1]);
}

#[test]
fn a_primitive_without_indices_gets_some_when_its_vertices_become_more() {
    // Found by damaging files: another primitive split the vertices that both have.
    let mut builder = super::kinds::shared();
    builder.json["meshes"][0]["primitives"][0].as_object_mut().expect("it").remove("indices");
    let bytes = builder.glb();
    let (after, remap) = check("without indices", &bytes, true, GltfTexcoords::default());
    assert!(remap.vertices_added > 0);
    assert!(after.json()["meshes"][0]["primitives"][0]["indices"].is_u64());
}

#[test]
fn meshes_are_not_welded_with_each_other_but_primitives_of_one_are() {
    let faces = |kind: &str| {
        let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == kind).expect("the kind");
        document(&bytes).surface().expect("a surface").mesh
    };
    assert_eq!(faces("meshes").vertex_count(), 2 * 9);
    assert_eq!(faces("primitives").vertex_count(), 25);
    assert_eq!(faces("soup").vertex_count(), 12);
    // Every second triangle of a strip is turned over.
    assert_eq!(faces("strip").faces()[..2], [[0, 5, 1], [5, 6, 1]].map(|f| f.map(VertexId::new)));
}

#[test]
fn a_primitive_of_no_triangles_is_skipped_and_said() {
    let bytes = super::kinds::with_empty_primitive().glb();
    let mut edited = document(&bytes);
    let surface = edited.surface().expect("a surface");
    assert_eq!(surface.mesh.face_count(), 24);
    assert_eq!(surface.notes.ignored["primitive without triangles"], 1);
    edited.set_uvs(&layout(&surface, true), GltfTexcoords::default()).expect("set");
    let after = document(&edited.to_glb().expect("packed"));
    assert_eq!(after.surface().expect("a surface").uv.map(|uv| uv.corners().len()), Some(72));
    assert_eq!(
        after.json()["meshes"][0]["primitives"][0]["indices"],
        edited.json()["meshes"][0]["primitives"][0]["indices"]
    );
}

#[test]
fn normal_splits_are_no_seams_of_the_map() {
    let (_, bytes) = kinds().into_iter().find(|(name, _)| *name == "textured").expect("the kind");
    let surface = document(&bytes).surface().expect("a surface");
    let uv: UvMap = surface.uv.expect("a map");
    assert_eq!(uv.points().len(), surface.mesh.vertex_count());
    // The upper left corner of a texture is at v = 1.
    assert_eq!([uv.points()[0].x, uv.points()[0].y], [0.0, 0.0]);
}
