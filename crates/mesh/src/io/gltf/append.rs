//! What is added to a document: data at the end of a buffer, with the views and accessors that describe it.

use std::borrow::Cow;

use serde_json::{Value, json};

use super::accessor::Component;
use super::json::Object;
use super::{Buffer, GltfDocument, Origin};

/// Where data begins: a multiple of the size of every number.
const ALIGNMENT: usize = 4;
/// What a view is for (section 5.11.5).
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Data for a document that is not changed yet.
pub(super) struct Appended {
    buffer: usize,
    /// Where the data will begin in the buffer.
    start: usize,
    data: Vec<u8>,
    first_view: usize,
    views: Vec<Value>,
    first_accessor: usize,
    accessors: Vec<Value>,
}

impl Appended {
    /// Nothing yet. The data will go into the buffer that has no file of its own, or else into a new one.
    pub(super) fn to(document: &GltfDocument) -> Self {
        let own = document.buffers.iter().position(|buffer| buffer.origin == Origin::Own);
        let length = own.map_or(0, |own| document.buffers[own].bytes.len());
        let count = |key: &str| document.json.get(key).and_then(Value::as_array).map_or(0, Vec::len);
        Self {
            buffer: own.unwrap_or(document.buffers.len()),
            start: length.next_multiple_of(ALIGNMENT),
            data: Vec::new(),
            first_view: count("bufferViews"),
            views: Vec::new(),
            first_accessor: count("accessors"),
            accessors: Vec::new(),
        }
    }

    /// Adds an attribute of vertices and returns its accessor. `accessor` has everything but the data.
    pub(super) fn attribute<'a>(
        &mut self,
        accessor: Object,
        size: usize,
        elements: impl ExactSizeIterator<Item = Cow<'a, [u8]>>,
    ) -> usize {
        let stride = size.next_multiple_of(ALIGNMENT);
        let (begin, count) = (self.data.len(), elements.len());
        for element in elements {
            self.data.extend_from_slice(&element);
            self.data.resize(self.data.len().next_multiple_of(ALIGNMENT), 0);
        }
        let mut view = self.view(begin, VERTICES);
        if stride != size {
            view.insert("byteStride".to_owned(), stride.into());
        }
        self.finish(accessor, view, count)
    }

    /// Adds indices of triangles and returns their accessor. They get the type `least` if that can name all vertices
    /// without its highest number, which is kept for other uses (section 3.7.2.1).
    pub(super) fn indices(
        &mut self,
        accessor: Object,
        triangles: &[[u32; 3]],
        vertices: usize,
        least: Component,
    ) -> usize {
        let fits = |component: Component| match component {
            Component::U8 => vertices <= usize::from(u8::MAX),
            Component::U16 => vertices <= usize::from(u16::MAX),
            _ => true,
        };
        let wider = [Component::U8, Component::U16, Component::U32].into_iter().filter(|c| c.size() >= least.size());
        let component = wider.into_iter().find(|&c| fits(c)).unwrap_or(Component::U32);
        let begin = self.data.len();
        let indices = triangles.as_flattened();
        self.data.reserve(indices.len() * component.size());
        for index in indices {
            self.data.extend_from_slice(&index.to_le_bytes()[..component.size()]);
        }
        let view = self.view(begin, INDICES);
        self.data.resize(self.data.len().next_multiple_of(ALIGNMENT), 0);
        let mut accessor = accessor;
        accessor.insert("componentType".to_owned(), component.code().into());
        accessor.insert("type".to_owned(), "SCALAR".into());
        // Bounds of indices are allowed, but these are new.
        accessor.shift_remove("min");
        accessor.shift_remove("max");
        self.finish(accessor, view, indices.len())
    }

    /// A view of what was added from `begin` on.
    fn view(&self, begin: usize, target: u32) -> Object {
        let (offset, length) = (self.start + begin, self.data.len() - begin);
        object(json!({"buffer": self.buffer, "byteOffset": offset, "byteLength": length, "target": target}))
    }

    fn finish(&mut self, mut accessor: Object, view: Object, count: usize) -> usize {
        accessor.insert("bufferView".to_owned(), (self.first_view + self.views.len()).into());
        accessor.insert("count".to_owned(), count.into());
        // `remove` would move the last key into the gap.
        accessor.shift_remove("byteOffset");
        accessor.shift_remove("sparse");
        self.views.push(Value::Object(view));
        self.accessors.push(Value::Object(accessor));
        self.first_accessor + self.accessors.len() - 1
    }

    /// Adds all of it to the document it was made for.
    pub(super) fn commit(self, document: &mut GltfDocument) {
        if self.data.is_empty() {
            return;
        }
        if document.buffers.len() == self.buffer {
            document.buffers.push(Buffer { bytes: Vec::new(), origin: Origin::Own });
            array(&mut document.json, "buffers").push(json!({"byteLength": 0}));
        }
        let bytes = &mut document.buffers[self.buffer].bytes;
        bytes.resize(self.start, 0);
        bytes.extend_from_slice(&self.data);
        let length = bytes.len();
        if let Some(Value::Object(buffer)) = array(&mut document.json, "buffers").get_mut(self.buffer) {
            buffer.insert("byteLength".to_owned(), length.into());
        }
        array(&mut document.json, "bufferViews").extend(self.views);
        array(&mut document.json, "accessors").extend(self.accessors);
    }
}

/// The list under a key, made if there is none.
pub(super) fn array<'a>(fields: &'a mut Object, key: &str) -> &'a mut Vec<Value> {
    let value = fields.entry(key).or_insert_with(|| Value::Array(Vec::new()));
    if !value.is_array() {
        *value = Value::Array(Vec::new());
    }
    value.as_array_mut().expect("it is one by now")
}

/// The fields of an object written with `json!`.
pub(super) fn object(value: Value) -> Object {
    match value {
        Value::Object(fields) => fields,
        _ => Object::new(),
    }
}
