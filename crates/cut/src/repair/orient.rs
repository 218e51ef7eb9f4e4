//! One orientation for every connected piece.

use super::pairs::Pairs;
use abf_mesh::{CornerId, FaceId, VertexId};
use std::collections::VecDeque;

/// An orientation of all faces.
pub(super) struct Oriented {
    /// Which faces are turned around.
    pub(super) turned: Vec<bool>,
    /// The pairs that were let go because their faces cannot both be oriented, by their lower corners.
    pub(super) cut: Vec<CornerId>,
}

/// Orients every piece breadth first, the way of most of its faces; of as many, that of its first face.
pub(super) fn orient(faces: &[[VertexId; 3]], pairs: &mut Pairs) -> Oriented {
    let corner_vertex = faces.as_flattened();
    let runs_from = |c: CornerId| corner_vertex[c.next().index()];
    let mut turned: Vec<Option<bool>> = vec![None; faces.len()];
    let mut cut = Vec::new();
    for seed in 0..faces.len() {
        if turned[seed].is_some() {
            continue;
        }
        turned[seed] = Some(false);
        let mut piece = vec![seed];
        let mut queue = VecDeque::from([seed]);
        while let Some(f) = queue.pop_front() {
            for c in FaceId::new(f).corners() {
                let Some(o) = pairs.partner(c) else { continue };
                let is_against = runs_from(c) == runs_from(o);
                let wanted = turned[f].map(|t| t != is_against);
                let g = o.face().index();
                if turned[g].is_none() {
                    turned[g] = wanted;
                    piece.push(g);
                    queue.push_back(g);
                } else if turned[g] != wanted {
                    cut.push(c.min(o));
                    pairs.let_go(c);
                }
            }
        }
        let count = piece.iter().filter(|&&f| turned[f] == Some(true)).count();
        if 2 * count > piece.len() {
            piece.iter().for_each(|&f| turned[f] = turned[f].map(|t| !t));
        }
    }
    cut.sort_unstable();
    Oriented { turned: turned.into_iter().map(|t| t == Some(true)).collect(), cut }
}
