//! Islands upon each other.

use abf_mesh::UvId;

/// An island that is laid upon another one.
#[derive(Clone, Debug)]
pub(super) struct Stacked {
    /// The other one.
    pub(super) on: usize,
    /// Every point of the island with the point of the other one that it takes the place of.
    pub(super) points: Vec<(UvId, UvId)>,
}
