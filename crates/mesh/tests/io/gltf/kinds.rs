//! Documents of every kind that matters.

use serde_json::json;

use super::builder::{Builder, F32, I8, I16, Sheet, U8, U16, U32, floats, sheet};

/// All of them, by name; each is one `.glb`, or JSON with everything inside.
pub(crate) fn kinds() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("textured", textured(U16)),
        ("skinned", skinned().glb()),
        ("morphed", morphed().glb()),
        ("interleaved", interleaved().glb()),
        ("sparse", sparse().glb()),
        ("indices-8", narrow().glb()),
        ("indices-32", textured(U32)),
        ("primitives", primitives().glb()),
        ("shared", shared().glb()),
        ("strip", strip(5).glb()),
        ("fan", fan().glb()),
        ("soup", soup().glb()),
        ("quantized", quantized().glb()),
        ("data-uri", extended().with_data()),
        ("extended", extended().glb()),
        ("meshes", meshes().glb()),
    ]
}

fn base(builder: &mut Builder, sheet: &Sheet) -> serde_json::Value {
    let (position, normal) = (builder.positions(&sheet.positions), builder.attribute(&sheet.normals()));
    json!({"POSITION": position, "NORMAL": normal})
}

fn textured(component: u32) -> Vec<u8> {
    let (mut builder, sheet) = (Builder::new(), sheet(4, 3));
    let mut attributes = base(&mut builder, &sheet);
    attributes["TEXCOORD_0"] = builder.attribute(&sheet.uvs()).into();
    let indices = builder.indices(sheet.triangles.as_flattened(), component);
    builder.mesh(&json!([{"attributes": attributes, "indices": indices}]));
    builder.glb()
}

/// A sheet, and a primitive whose accessor of indices has no element: no valid document, but one that programs write.
pub(crate) fn with_empty_primitive() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(4, 3));
    let attributes = base(&mut builder, &sheet);
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    let none = builder.accessor(json!({}), U16, "SCALAR", 0);
    builder.mesh(&json!([{"attributes": attributes, "indices": none}, {"attributes": attributes, "indices": indices}]));
    builder
}

pub(crate) fn skinned() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(3, 4));
    let mut attributes = base(&mut builder, &sheet);
    let count = sheet.positions.len();
    let joints: Vec<u8> = (0..count).flat_map(|i| [0, (i % 2) as u8, 0, 0]).collect();
    attributes["JOINTS_0"] = builder.raw(&joints, 4, U8, "VEC4", false).into();
    let weights: Vec<[f32; 4]> =
        (0..count).map(|i| if i % 2 == 1 { [0.75, 0.25, 0.0, 0.0] } else { [1.0, 0.0, 0.0, 0.0] }).collect();
    attributes["WEIGHTS_0"] = builder.attribute(&weights).into();
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    builder.mesh(&json!([{"attributes": attributes, "indices": indices}]));
    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0_f32]];
    let view = builder.view(&floats(&[identity, identity].concat()), None, None);
    let matrices = builder.accessor(json!({"bufferView": view}), F32, "MAT4", 2);
    builder.json["skins"] = json!([{"inverseBindMatrices": matrices, "joints": [1, 2]}]);
    builder.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [0.0, 0.5, 0.0]}]);
    builder.json["scenes"] = json!([{"nodes": [0, 1]}]);
    animate(&mut builder, 2, "rotation", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8]]);
    builder
}

fn animate<const N: usize>(builder: &mut Builder, node: usize, path: &str, values: &[[f32; N]]) {
    let view = builder.view(&floats(&[[0.0], [1.5]]), None, None);
    let times = json!({"bufferView": view, "min": [0.0], "max": [1.5]});
    let times = builder.accessor(times, F32, "SCALAR", 2);
    let view = builder.view(&floats(values), None, None);
    let (kind, count) = if N == 4 { ("VEC4", 2) } else { ("SCALAR", 2 * N) };
    let values = builder.accessor(json!({"bufferView": view}), F32, kind, count);
    builder.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
        "samplers": [{"input": times, "output": values, "interpolation": "LINEAR"}],
    }]);
}

pub(crate) fn morphed() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(4, 4));
    let attributes = base(&mut builder, &sheet);
    let mut target = |amount: f32| {
        let moved: Vec<[f32; 3]> = sheet.positions.iter().map(|p| [0.0, amount, amount * p[0]]).collect();
        let turned: Vec<[f32; 3]> = sheet.positions.iter().map(|p| [amount * p[1], 0.0, 0.0]).collect();
        json!({"POSITION": builder.positions(&moved), "NORMAL": builder.attribute(&turned)})
    };
    let targets = [target(0.5), target(-0.25)];
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    builder.mesh(&json!([{"attributes": attributes, "indices": indices, "targets": targets}]));
    builder.json["meshes"][0]["weights"] = json!([0.0, 0.5]);
    animate(&mut builder, 0, "weights", &[[0.0, 1.0], [1.0, 0.25]]);
    builder
}

/// Positions, normals and colours in one view.
pub(crate) fn interleaved() -> Builder {
    const STRIDE: usize = 28;
    let (mut builder, sheet) = (Builder::new(), sheet(5, 2));
    let normals = sheet.normals();
    let vertex = |i: usize| {
        let color = [i as u8, 2 * i as u8, 3 * i as u8, 255];
        [floats(&[sheet.positions[i]]), floats(&[normals[i]]), color.to_vec()].concat()
    };
    let count = sheet.positions.len();
    let bytes: Vec<u8> = (0..count).flat_map(vertex).collect();
    let view = builder.view(&bytes, Some(34962), Some(STRIDE));
    let position = builder.accessor(json!({"bufferView": view}), F32, "VEC3", count);
    builder.bounds(position, &sheet.positions);
    let normal = builder.accessor(json!({"bufferView": view, "byteOffset": 12}), F32, "VEC3", count);
    let color = json!({"bufferView": view, "byteOffset": 24, "normalized": true});
    let color = builder.accessor(color, U8, "VEC4", count);
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    let attributes = json!({"POSITION": position, "NORMAL": normal, "COLOR_0": color});
    builder.mesh(&json!([{"attributes": attributes, "indices": indices}]));
    builder
}

/// Positions of which some are replaced, and a morph target of which nothing else is there.
pub(crate) fn sparse() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(3, 3));
    let count = sheet.positions.len();
    let mut positions = sheet.positions.clone();
    let position = builder.attribute(&positions);
    let (which, values) = ([2_u16, 7], [[0.9, 0.1, 0.5_f32], [0.8, 0.4, -0.5]]);
    let bytes: Vec<u8> = which.iter().flat_map(|i| i.to_le_bytes()).collect();
    let (indices, values_view) = (builder.view(&bytes, None, None), builder.view(&floats(&values), None, None));
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": U16},
        "values": {"bufferView": values_view},
    });
    builder.json["accessors"][position]["sparse"] = sparse.clone();
    (positions[2], positions[7]) = (values[0], values[1]);
    builder.bounds(position, &positions);
    let target = builder.accessor(json!({"sparse": sparse}), F32, "VEC3", count);
    builder.bounds(target, &[values[0], values[1], [0.0; 3]]);
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    builder.mesh(&json!([{
        "attributes": {"POSITION": position}, "indices": indices, "targets": [{"POSITION": target}],
    }]));
    builder
}

/// As many vertices as indices of 8 bits can name, so that any more need wider ones.
pub(crate) fn narrow() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(16, 14));
    assert_eq!(sheet.positions.len(), 255);
    let attributes = base(&mut builder, &sheet);
    let indices = builder.indices(sheet.triangles.as_flattened(), U8);
    builder.mesh(&json!([{"attributes": attributes, "indices": indices}]));
    builder
}

/// Two materials on one surface, with attributes of their own, and lines and points.
pub(crate) fn primitives() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(4, 4));
    let half = sheet.triangles.len() / 2;
    let mut list = Vec::new();
    for (material, triangles) in sheet.triangles.chunks(half).enumerate() {
        let mut used: Vec<u32> = triangles.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        let own: Vec<u32> =
            triangles.as_flattened().iter().map(|v| used.binary_search(v).expect("used") as u32).collect();
        let positions: Vec<[f32; 3]> = used.iter().map(|&v| sheet.positions[v as usize]).collect();
        let mut attributes = json!({"POSITION": builder.positions(&positions)});
        if material == 1 {
            let uvs: Vec<[f32; 2]> = positions.iter().map(|p| [p[0], p[1]]).collect();
            attributes["TEXCOORD_0"] = builder.attribute(&uvs).into();
            attributes["TEXCOORD_1"] = builder.raw(&vec![200; 4 * uvs.len()], 4, U8, "VEC2", true).into();
        }
        let indices = builder.indices(&own, U16);
        list.push(json!({"attributes": attributes, "indices": indices, "material": material}));
    }
    let corners = builder.positions(&sheet.positions[..6]);
    list.insert(1, json!({"attributes": {"POSITION": corners}, "mode": 1}));
    list.push(json!({"attributes": {"POSITION": corners}, "mode": 0}));
    builder.mesh(&json!(list));
    builder.json["materials"] = json!([{"name": "red"}, {"name": "blue", "doubleSided": true}]);
    builder
}

/// Four primitives with the same positions: two share everything, one has colours, one belongs to another mesh.
pub(crate) fn shared() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(6, 3));
    let attributes = base(&mut builder, &sheet);
    let colors: Vec<[f32; 3]> = sheet.positions.iter().map(|p| [p[0], p[1], 0.5]).collect();
    let mut colored = attributes.clone();
    colored["COLOR_0"] = builder.attribute(&colors).into();
    let thirds: Vec<usize> = sheet.triangles.chunks(12).map(|part| builder.indices(part.as_flattened(), U16)).collect();
    builder.mesh(&json!([
        {"attributes": attributes, "indices": thirds[0]},
        {"attributes": colored, "indices": thirds[1]},
        {"attributes": attributes, "indices": thirds[2]},
    ]));
    builder.mesh(&json!([{"attributes": attributes, "indices": thirds[2]}]));
    builder.json["nodes"] = json!([{"mesh": 0, "children": [1, 2]}, {"mesh": 1}, {"mesh": 0}]);
    builder
}

/// Rows of squares as one strip: the rows are joined by triangles without area.
pub(crate) fn strip(mode: u32) -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(4, 2));
    let attributes = base(&mut builder, &sheet);
    let mut list: Vec<u32> = Vec::new();
    for row in 0..2_u32 {
        if row > 0 {
            list.extend([*list.last().expect("a row"), 5 * row]);
        }
        (0..5).for_each(|x| list.extend([5 * row + x, 5 * (row + 1) + x]));
    }
    let indices = builder.indices(&list, U16);
    builder.mesh(&json!([{"attributes": attributes, "indices": indices, "mode": mode}]));
    builder
}

pub(crate) fn fan() -> Builder {
    let mut builder = Builder::new();
    let rim = |i: u32| {
        let angle = i as f32;
        [angle.cos(), angle.sin(), 0.1 * angle]
    };
    let positions: Vec<[f32; 3]> = std::iter::once([0.0; 3]).chain((0..6).map(rim)).collect();
    let position = builder.positions(&positions);
    builder.mesh(&json!([{"attributes": {"POSITION": position}, "mode": 6}]));
    builder
}

/// Triangles without indices: no vertex is shared.
pub(crate) fn soup() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(3, 2));
    let positions: Vec<[f32; 3]> =
        sheet.triangles.as_flattened().iter().map(|&v| sheet.positions[v as usize]).collect();
    let position = builder.positions(&positions);
    builder.mesh(&json!([{"attributes": {"POSITION": position}}]));
    builder
}

/// `KHR_mesh_quantization`, with elements that need padding.
pub(crate) fn quantized() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(4, 4));
    let number = |x: f32| (x * 32767.0) as i16;
    let bytes: Vec<u8> = sheet
        .positions
        .iter()
        .flat_map(|p| [number(p[0]), number(p[1]), number(p[2]), 0].map(i16::to_le_bytes).as_flattened().to_vec())
        .collect();
    let position = builder.raw(&bytes, 8, I16, "VEC3", true);
    let (low, high) = sheet.positions.iter().fold(([i16::MAX; 3], [i16::MIN; 3]), |(low, high), p| {
        let p = p.map(number);
        ([0, 1, 2].map(|k| low[k].min(p[k])), [0, 1, 2].map(|k| high[k].max(p[k])))
    });
    builder.json["accessors"][position]["min"] = json!(low);
    builder.json["accessors"][position]["max"] = json!(high);
    let normals: Vec<u8> = sheet.positions.iter().flat_map(|_| [0, 0, 127, 0]).collect();
    let normal = builder.raw(&normals, 4, I8, "VEC3", true);
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    builder.mesh(&json!([{"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices}]));
    builder.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    builder
}

/// Things that nobody knows, an attribute among them, and an animation.
pub(crate) fn extended() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(3, 3));
    let mut attributes = base(&mut builder, &sheet);
    let count = sheet.positions.len();
    let tangents = vec![[1.0, 0.0, 0.0, -1.0]; count];
    attributes["TANGENT"] = builder.attribute(&tangents).into();
    attributes["TEXCOORD_0"] = builder.attribute(&sheet.uvs()).into();
    let heat: Vec<u8> = (0..count).flat_map(|i| [i as u8, 0, 0, 0]).collect();
    attributes["_HEAT"] = builder.raw(&heat, 4, U8, "SCALAR", false).into();
    let indices = builder.indices(sheet.triangles.as_flattened(), U16);
    builder.mesh(&json!([{
        "extras": {"z": 1, "a": [true, null], "big": 12_345_678_901_234_567_890_u64},
        "extensions": {"VENDOR_unknown": {"zebra": 0.1, "ape": -1.5e-9}},
        "indices": indices,
        "attributes": attributes,
        "material": 0,
    }]));
    builder.json["materials"] =
        json!([{"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1.0], "roughnessFactor": 0.7}}]);
    builder.json["extensionsUsed"] = json!(["VENDOR_unknown"]);
    builder.json["extensions"] = json!({"VENDOR_unknown": {"y": 1, "x": 2}});
    builder.json["extras"] = json!({"later": "ümlaut", "earlier": 1e300});
    animate(&mut builder, 0, "rotation", &[[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8]]);
    builder
}

/// Two meshes at the same place, three nodes.
pub(crate) fn meshes() -> Builder {
    let (mut builder, sheet) = (Builder::new(), sheet(2, 2));
    for _ in 0..2 {
        let attributes = base(&mut builder, &sheet);
        let indices = builder.indices(sheet.triangles.as_flattened(), U16);
        builder.mesh(&json!([{"attributes": attributes, "indices": indices}]));
    }
    builder.json["nodes"] =
        json!([{"mesh": 0, "children": [1, 2]}, {"mesh": 1}, {"mesh": 0, "scale": [2.0, 2.0, 2.0]}]);
    builder
}
