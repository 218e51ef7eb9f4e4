//! Edges joined to chains, so that a tool follows an outline without lifting.

use std::collections::HashMap;

use abf_mesh::{CornerId, Point2, UvMap};

/// Points in a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Chain {
    /// The points; the last one of a closed chain is not the first one again.
    pub(crate) points: Vec<Point2<f64>>,
    /// Whether the last point is joined to the first.
    pub(crate) closed: bool,
}

/// Joins edges, each from its corner to the next one, to chains as long as possible.
///
/// A chain starts at the lowest edge left and goes on with the lowest edge that starts where the
/// last one ended, until it is back or there is none. Places count, not the ids of UV points.
pub(crate) fn chains(uv: &UvMap, edges: &[CornerId]) -> Vec<Chain> {
    let start = |c: CornerId| bits(uv.corner(c));
    let mut leaving: HashMap<[u64; 2], Vec<CornerId>> = HashMap::new();
    // In descending order, so that the lowest is popped first.
    edges.iter().rev().for_each(|&c| leaving.entry(start(c)).or_default().push(c));
    let mut used = vec![false; uv.corners().len()];
    let mut found = Vec::new();
    for &first in edges {
        if used[first.index()] {
            continue;
        }
        let home = start(first);
        let mut points = Vec::new();
        let mut at = home;
        while let Some(edge) = leaving.get_mut(&at).and_then(Vec::pop) {
            used[edge.index()] = true;
            points.push(uv.corner(edge));
            at = start(edge.next());
            if at == home {
                break;
            }
        }
        let closed = at == home;
        if !closed {
            points.push(Point2::from(at.map(f64::from_bits)));
        }
        found.push(Chain { points, closed });
    }
    found
}

/// The place of a point, to be compared exactly; adding zero makes −0 and +0 one place.
fn bits(p: Point2<f64>) -> [u64; 2] {
    [p.x, p.y].map(|x| (x + 0.0).to_bits())
}
