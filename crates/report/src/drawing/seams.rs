//! Numbers on both sides of every seam, so that what belongs together is found.

use super::outline::Edges;
use abf_mesh::{CornerId, Point2, Point3, TriMesh, UvMap, Vector2};
use std::collections::HashMap;

/// A stretch of a seam that is farther from its chord than this part of the chord is numbered in two.
const BEND: f64 = 0.25;

/// A number at one side of a seam.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mark {
    /// The same at all sides of this stretch of seam, counted from 1.
    pub(crate) number: usize,
    /// Its middle, the same point of the surface at all sides, in UVs.
    pub(crate) at: Point2<f64>,
    /// The direction into the chart, of length 1.
    pub(crate) inward: Vector2<f64>,
    /// How long the stretch is, in units of the mesh.
    pub(crate) length: f64,
}

/// An edge of the surface that is a seam.
struct Seam {
    ends: [u32; 2],
    sides: Vec<CornerId>,
}

/// The marks of all seams. A stretch ends where seams meet, where the seam reaches the boundary, and where it bends.
pub(crate) fn marks(mesh: &TriMesh, uv: &UvMap, edges: &Edges) -> Vec<Mark> {
    let seams = seams(edges);
    let mut marks = Vec::new();
    let stretches = chains(&seams, edges).into_iter().flat_map(|chain| {
        let points: Vec<Point3<f64>> = chain.places.iter().map(|&v| mesh.positions()[v as usize]).collect();
        let mut ends = vec![0];
        bends(&points, 0, points.len() - 1, chain.is_closed(), &mut ends);
        ends.windows(2)
            .map(|w| (chain.edges[w[0]..w[1]].to_vec(), chain.places[w[0]..=w[1]].to_vec()))
            .collect::<Vec<_>>()
    });
    for (i, (stretch, places)) in stretches.enumerate() {
        let lengths: Vec<f64> = places
            .windows(2)
            .map(|w| (mesh.positions()[w[1] as usize] - mesh.positions()[w[0] as usize]).norm())
            .collect();
        let length: f64 = lengths.iter().sum();
        let mut left = 0.5 * length;
        let mut k = 0;
        while k + 1 < lengths.len() && left > lengths[k] {
            left -= lengths[k];
            k += 1;
        }
        let part = if lengths[k] > 0.0 { left / lengths[k] } else { 0.5 };
        for &side in &seams[stretch[k]].sides {
            let part = if edges.place_of(mesh, side) == places[k] { part } else { 1.0 - part };
            let (from, to) = (uv.corner(side), uv.corner(side.next()));
            let along = to - from;
            // Faces are counter-clockwise: the chart is on the left.
            let inward = Vector2::new(-along.y, along.x).try_normalize(0.0).unwrap_or_else(Vector2::zeros);
            marks.push(Mark { number: i + 1, at: from + along * part, inward, length });
        }
    }
    marks
}

/// The seams by the places of their ends, in the order of their lowest corners.
fn seams(edges: &Edges) -> Vec<Seam> {
    let mut number: HashMap<[u32; 2], usize> = HashMap::new();
    let mut seams: Vec<Seam> = Vec::new();
    for (&side, &ends) in edges.seams.iter().zip(&edges.seam_ends) {
        let i = *number.entry(ends).or_insert(seams.len());
        if i == seams.len() {
            seams.push(Seam { ends, sides: Vec::new() });
        }
        seams[i].sides.push(side);
    }
    seams
}

/// Seams in a row: one more place than edges.
struct Chain {
    edges: Vec<usize>,
    places: Vec<u32>,
}

impl Chain {
    fn is_closed(&self) -> bool {
        self.places.first() == self.places.last()
    }
}

fn chains(seams: &[Seam], edges: &Edges) -> Vec<Chain> {
    let mut at: HashMap<u32, Vec<usize>> = HashMap::new();
    seams.iter().enumerate().for_each(|(i, seam)| seam.ends.iter().for_each(|&v| at.entry(v).or_default().push(i)));
    let goes_on = |v: u32| at[&v].len() == 2 && edges.rims.binary_search(&v).is_err();
    let ended = (0..seams.len()).filter_map(|i| Some((i, seams[i].ends.into_iter().find(|&v| !goes_on(v))?)));
    // Rings without an end come last, from their first edge on.
    let starts = ended.chain((0..seams.len()).map(|i| (i, seams[i].ends[0])));
    let mut used = vec![false; seams.len()];
    let mut chains = Vec::new();
    for (first, start) in starts {
        let mut next = Some(first).filter(|&i| !used[i]);
        let mut chain = Chain { edges: Vec::new(), places: vec![start] };
        let mut place = start;
        while let Some(edge) = next {
            used[edge] = true;
            let [a, b] = seams[edge].ends;
            place = if a == place { b } else { a };
            chain.edges.push(edge);
            chain.places.push(place);
            next = at[&place].iter().copied().find(|&i| !used[i]).filter(|_| goes_on(place));
        }
        if !chain.edges.is_empty() {
            chains.push(chain);
        }
    }
    chains
}

/// Adds the ends of the stretches between two points of a chain, the last one included.
fn bends(points: &[Point3<f64>], first: usize, last: usize, is_closed: bool, ends: &mut Vec<usize>) {
    let chord = points[last] - points[first];
    let off = |i: &usize| {
        let from = points[*i] - points[first];
        let along = if chord.norm() > 0.0 { from.dot(&chord) / chord.norm_squared() } else { 0.0 };
        (from - chord * along).norm()
    };
    let farthest = (first + 1..last).max_by(|a, b| off(a).total_cmp(&off(b)));
    match farthest.filter(|i| is_closed || off(i) > BEND * chord.norm()) {
        None => ends.push(last),
        Some(middle) => {
            bends(points, first, middle, false, ends);
            bends(points, middle, last, false, ends);
        }
    }
}
