//! Makes small glTF documents.

use base64::Engine;
use serde_json::{Value, json};

pub(crate) const I8: u32 = 5120;
pub(crate) const U8: u32 = 5121;
pub(crate) const I16: u32 = 5122;
pub(crate) const U16: u32 = 5123;
pub(crate) const U32: u32 = 5125;
pub(crate) const F32: u32 = 5126;

const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// A document in the making, with one buffer.
pub(crate) struct Builder {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

/// A sheet of `columns` × `rows` squares: bent, so that no three vertices are on a line.
pub(crate) struct Sheet {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

pub(crate) fn sheet(columns: u32, rows: u32) -> Sheet {
    let across = columns + 1;
    let point = |i: u32| {
        let (x, y) = ((i % across) as f32, (i / across) as f32);
        [x / columns as f32, y / rows as f32, (0.7 * x + 0.3 * y).sin() / 4.0]
    };
    let square = |i: u32| {
        let a = i % columns + i / columns * across;
        [[a, a + 1, a + across + 1], [a, a + across + 1, a + across]]
    };
    Sheet {
        positions: (0..across * (rows + 1)).map(point).collect(),
        triangles: (0..columns * rows).flat_map(square).collect(),
    }
}

impl Sheet {
    /// A vector of length 1 for every vertex.
    pub(crate) fn normals(&self) -> Vec<[f32; 3]> {
        self.positions.iter().map(|p| [0.6 * p[2].signum(), 0.0, 0.8]).collect()
    }

    /// A UV for every vertex.
    pub(crate) fn uvs(&self) -> Vec<[f32; 2]> {
        self.positions.iter().map(|p| [p[0], 1.0 - p[1]]).collect()
    }
}

/// The bytes of numbers.
pub(crate) fn floats<const N: usize>(list: &[[f32; N]]) -> Vec<u8> {
    list.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect()
}

impl Builder {
    pub(crate) fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0", "generator": "a test", "extras": {"kept": [1, 0.1, 1e-7, "ü"]}},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "name": "sheet"}],
            "meshes": [],
            "buffers": [{"byteLength": 0, "name": "all"}],
            "bufferViews": [],
            "accessors": [],
        });
        Self { json, bin: Vec::new() }
    }

    fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// A view of new bytes.
    pub(crate) fn view(&mut self, bytes: &[u8], target: Option<u32>, stride: Option<usize>) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    pub(crate) fn accessor(&mut self, mut accessor: Value, component: u32, kind: &str, count: usize) -> usize {
        accessor["componentType"] = component.into();
        accessor["type"] = kind.into();
        accessor["count"] = count.into();
        self.push("accessors", accessor)
    }

    /// An attribute in a view of its own.
    pub(crate) fn attribute<const N: usize>(&mut self, list: &[[f32; N]]) -> usize {
        let view = self.view(&floats(list), Some(VERTICES), None);
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.accessor(json!({"bufferView": view}), F32, kind, list.len())
    }

    /// Positions, with their bounds.
    pub(crate) fn positions(&mut self, list: &[[f32; 3]]) -> usize {
        let accessor = self.attribute(list);
        self.bounds(accessor, list);
        accessor
    }

    pub(crate) fn bounds(&mut self, accessor: usize, list: &[[f32; 3]]) {
        let bound = |pick: fn(f32, f32) -> f32| {
            let all = list.iter().fold(list[0], |a, b| [0, 1, 2].map(|k| pick(a[k], b[k])));
            json!(all.map(f64::from))
        };
        self.json["accessors"][accessor]["min"] = bound(f32::min);
        self.json["accessors"][accessor]["max"] = bound(f32::max);
    }

    /// An attribute of bytes, at distances of `stride`.
    pub(crate) fn raw(&mut self, bytes: &[u8], stride: usize, component: u32, kind: &str, normalized: bool) -> usize {
        let view = self.view(bytes, Some(VERTICES), Some(stride));
        let mut accessor = json!({"bufferView": view});
        if normalized {
            accessor["normalized"] = true.into();
        }
        self.accessor(accessor, component, kind, bytes.len() / stride)
    }

    pub(crate) fn indices(&mut self, list: &[u32], component: u32) -> usize {
        let size = match component {
            U8 => 1,
            U16 => 2,
            _ => 4,
        };
        let bytes: Vec<u8> = list.iter().flat_map(|i| i.to_le_bytes().into_iter().take(size)).collect();
        let view = self.view(&bytes, Some(INDICES), None);
        self.accessor(json!({"bufferView": view, "name": "indices"}), component, "SCALAR", list.len())
    }

    pub(crate) fn mesh(&mut self, primitives: &Value) -> usize {
        self.push("meshes", json!({"name": "mesh", "primitives": primitives}))
    }

    pub(crate) fn glb(mut self) -> Vec<u8> {
        self.json["buffers"][0]["byteLength"] = self.bin.len().into();
        let mut json = self.json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let length = 12 + 8 + json.len() + 8 + self.bin.len();
        let four = |n: usize| (n as u32).to_le_bytes();
        let chunks = [&four(json.len())[..], b"JSON", &json, &four(self.bin.len()), b"BIN\0", &self.bin].concat();
        [&b"glTF\x02\0\0\0"[..], &four(length), &chunks].concat()
    }

    /// The document with its buffer in a data URI.
    pub(crate) fn with_data(mut self) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bin);
        self.json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{data}").into();
        self.json["buffers"][0]["byteLength"] = self.bin.len().into();
        serde_json::to_vec_pretty(&self.json).expect("JSON")
    }

    /// The document, and the buffer that it names.
    pub(crate) fn with_file(mut self, uri: &str) -> (Vec<u8>, Vec<u8>) {
        self.json["buffers"][0]["uri"] = uri.into();
        self.json["buffers"][0]["byteLength"] = self.bin.len().into();
        (self.json.to_string().into_bytes(), self.bin)
    }
}
