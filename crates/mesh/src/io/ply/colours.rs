//! The colours of vertices, kept as they are stored.

use super::header::{Element, Scalar};

/// What programs call the parts of a colour; the last may be missing.
const NAMES: [&str; 4] = ["red", "green", "blue", "alpha"];

/// Colours of the vertices of a PLY: its properties `red`, `green`, `blue` and perhaps `alpha`, in their own types.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexColours {
    channels: Vec<(&'static str, Scalar)>,
    /// The channels of the first vertex, then those of the next. Every type of PLY is exact in an `f64`.
    values: Vec<f64>,
}

impl VertexColours {
    /// How many vertices have a colour.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.values.len() / self.channels.len()
    }

    /// The names of the channels.
    pub fn channels(&self) -> impl Iterator<Item = &'static str> {
        self.channels.iter().map(|&(name, _)| name)
    }

    /// The channels of a vertex, as stored; `None` where there is no such vertex.
    #[must_use]
    pub fn of_vertex(&self, vertex: usize) -> Option<&[f64]> {
        self.values.chunks_exact(self.channels.len()).nth(vertex)
    }

    /// Those that an element has, still without values; `None` where a part of the colours is missing.
    pub(super) fn declared(vertex: &Element) -> Option<Self> {
        let channel = |name: &'static str| {
            let property = vertex.properties.iter().find(|p| p.length.is_none() && p.name == name);
            property.map(|property| (name, property.value))
        };
        let channels: Vec<_> = NAMES.into_iter().map_while(channel).collect();
        (channels.len() + 1 >= NAMES.len()).then_some(Self { channels, values: Vec::new() })
    }

    /// The next vertex.
    pub(super) fn push(&mut self, values: &[f64]) {
        self.values.extend_from_slice(values);
    }

    /// The lines of the header that declare them.
    pub(super) fn header(&self) -> String {
        self.channels.iter().map(|(name, scalar)| format!("property {} {name}\n", scalar.name())).collect()
    }

    /// Appends the bytes of a vertex, the lowest first.
    pub(super) fn append(&self, block: &mut Vec<u8>, vertex: usize) {
        let values = self.of_vertex(vertex).unwrap_or_default();
        values.iter().zip(&self.channels).for_each(|(&value, (_, scalar))| scalar.append(block, value));
    }
}
