//! Ids as numbers, for `serde`.

use abf_mesh::{FaceId, VertexId};
use serde::Serializer;
use std::fmt::Display;

pub(crate) fn text<S: Serializer>(value: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

pub(crate) fn faces<S: Serializer>(faces: &[FaceId], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(faces.iter().map(|face| face.index()))
}

pub(crate) fn vertices<S: Serializer>(vertices: &[VertexId], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(vertices.iter().map(|vertex| vertex.index()))
}

pub(crate) fn pairs<S: Serializer>(pairs: &[[FaceId; 2]], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(pairs.iter().map(|pair| pair.map(FaceId::index)))
}
