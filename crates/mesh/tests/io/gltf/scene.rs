//! What the nodes of a document do to the sizes of its meshes.

use abf_mesh::io::{GltfSurface, MeshFormat, parse};
use serde_json::{Value, json};

use super::builder::{Builder, U16, sheet};
use super::document;

/// Two meshes, the same sheet, with other nodes and scenes.
fn two(nodes: &Value, change: impl FnOnce(&mut Value)) -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(2, 2));
    for _ in 0..2 {
        let position = builder.positions(&sheet.positions);
        let indices = builder.indices(sheet.triangles.as_flattened(), U16);
        builder.mesh(&json!([{"attributes": {"POSITION": position}, "indices": indices}]));
    }
    builder.json["nodes"] = nodes.clone();
    change(&mut builder.json);
    builder
}

fn surface(nodes: &Value, roots: &Value) -> GltfSurface {
    let builder = two(nodes, |json| json["scenes"] = json!([{"nodes": roots}]));
    document(&builder.glb()).surface().unwrap_or_else(|e| panic!("{e}"))
}

fn scales(surface: &GltfSurface) -> [f64; 2] {
    [0, 1].map(|i| surface.places[i].scale)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

#[test]
fn a_mesh_has_the_size_of_its_largest_instance_and_that_is_said_in_one_line() {
    let turn = [0.0, 0.6, 0.0, 0.8];
    let nodes = json!([
        {"mesh": 0, "scale": [2, 2, 2], "children": [1]},
        {"mesh": 1, "rotation": turn, "scale": [1.5, -1.5, 1.5], "translation": [1, 2, 3]},
        {"mesh": 0, "scale": [0.25, 0.25, 0.25]}
    ]);
    let surface = surface(&nodes, &json!([0, 2]));
    let [first, second] = scales(&surface);
    // The second is mirrored, which changes no size.
    assert!(near(first, 2.0) && near(second, 3.0), "{first} {second}");
    assert_eq!(surface.notes.scene.as_deref(), Some("sizes are those of the scene: 2 of 2 meshes scaled by 2 to 3"));
    let sized = surface.sized().expect("other sizes");
    for (i, faces) in surface.faces.iter().enumerate() {
        let factor = surface.places[i].scale;
        for v in surface.mesh.faces()[faces.clone()].iter().flatten() {
            assert_eq!(sized.positions()[v.index()], surface.mesh.positions()[v.index()] * factor);
        }
    }
    // Where the node puts a point: the translation is that of the child in the coordinates of its parent.
    let origin = surface.places[1].point(abf_mesh::Point3::origin());
    assert!((origin - abf_mesh::Point3::new(2.0, 4.0, 6.0)).norm() < 1e-12);
    // The mesh as any other file has those sizes.
    let builder = two(&nodes, |json| json["scenes"] = json!([{"nodes": [0, 2]}]));
    let file = parse(MeshFormat::Glb, "f", &builder.glb()).expect("readable");
    assert_eq!(file.mesh, sized);
}

#[test]
fn scales_that_differ_by_axis_change_sizes_by_the_area_and_no_shape() {
    let surface = surface(&json!([{"mesh": 0, "scale": [10, 1, 3]}, {"mesh": 1}]), &json!([0, 1]));
    let placed = surface.placed();
    let area = |mesh: &abf_mesh::TriMesh| -> f64 {
        let faces = mesh.faces()[surface.faces[0].clone()].iter();
        let of_face = |f: &[abf_mesh::VertexId; 3]| {
            let [a, b, c] = f.map(|v| mesh.positions()[v.index()]);
            (b - a).cross(&(c - a)).norm()
        };
        faces.map(of_face).sum()
    };
    let [first, second] = scales(&surface);
    assert!(near(first, (area(&placed) / area(&surface.mesh)).sqrt()));
    assert_eq!(second, 1.0);
    let sized = surface.sized().expect("other sizes");
    for (a, b) in sized.corner_angles().iter().zip(surface.mesh.corner_angles()) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn what_has_no_size_in_the_scene_keeps_its_own_and_a_skin_ignores_nodes() {
    let skinned = json!([{"mesh": 0, "skin": 0, "scale": [5, 5, 5]}, {"mesh": 1, "scale": [0, 0, 0]}]);
    let flat = surface(&skinned, &json!([0, 1]));
    assert_eq!(scales(&flat), [1.0, 1.0]);
    assert_eq!(flat.sized(), None);
    let said = "1 of 2 meshes without a size in the scene keep their own units";
    assert_eq!(flat.notes.scene.as_deref(), Some(said));
    // The second mesh is in a node that the scene does not show.
    let hidden = surface(&json!([{"mesh": 0}, {"mesh": 1, "scale": [7, 7, 7]}]), &json!([0]));
    assert_eq!(scales(&hidden), [1.0, 1.0]);
    assert_eq!(hidden.notes.scene.as_deref(), Some(said));
}

#[test]
fn of_several_scenes_the_default_counts_else_all() {
    let nodes = json!([{"mesh": 0, "scale": [2, 2, 2]}, {"mesh": 0, "scale": [4, 4, 4]}, {"mesh": 1}]);
    let scenes = json!([{"nodes": [0, 2]}, {"nodes": [1]}]);
    let of = |default: Option<usize>| {
        let builder = two(&nodes, |json| {
            json["scenes"] = scenes.clone();
            match default {
                Some(scene) => json["scene"] = scene.into(),
                None => drop(json.as_object_mut().expect("an object").remove("scene")),
            }
        });
        scales(&document(&builder.glb()).surface().expect("readable"))
    };
    assert_eq!(of(Some(0)), [2.0, 1.0]);
    assert_eq!(of(Some(1)), [4.0, 1.0]);
    assert_eq!(of(None), [4.0, 1.0]);
}

#[test]
fn broken_nodes_are_refused_with_their_index() {
    let refused = |nodes: Value| {
        let builder = two(&nodes, |json| json["scenes"] = json!([{"nodes": [0]}]));
        parse(MeshFormat::Glb, "f", &builder.glb()).expect_err("a broken document").to_string()
    };
    let identity = |first: Value| {
        let mut matrix = vec![json!(0); 16];
        [0, 5, 10, 15].into_iter().for_each(|i| matrix[i] = json!(1));
        matrix[0] = first;
        matrix
    };
    let cycle = json!([{"mesh": 0}, {"children": [2]}, {"children": [1]}]);
    assert_eq!(refused(cycle), "f, nodes[1]: node 1 is in a cycle of children, or below one");
    let itself = json!([{"mesh": 0, "children": [0]}]);
    assert_eq!(refused(itself), "f, nodes[0]: node 0 is in a cycle of children, or below one");
    let parents = json!([{"children": [2]}, {"children": [2]}, {"mesh": 0}]);
    assert_eq!(refused(parents), "f, nodes[2]: node 2 is a child of node 0 and of node 1");
    let not_a_number = json!([{"mesh": 0, "matrix": identity(json!("NaN"))}]);
    assert_eq!(refused(not_a_number), "f, nodes[0].matrix: entry 0 is no finite number");
    let null = json!([{"mesh": 0, "matrix": identity(Value::Null)}]);
    assert_eq!(refused(null), "f, nodes[0].matrix: entry 0 is no finite number");
    let huge = json!([{"scale": [1e200, 1, 1], "children": [1]}, {"mesh": 0, "scale": [1e200, 1, 1]}]);
    assert_eq!(refused(huge), "f, nodes[1]: the transform of node 1 is not finite");
    let nowhere = json!([{"mesh": 0, "children": [4]}]);
    assert_eq!(refused(nowhere), "f, nodes[0].children: names a node beyond the 1 there are (counted from 0)");
}
