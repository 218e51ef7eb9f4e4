//! Crossings, and sectors over each other, no deeper than the rounding of coordinates: sides that meet, and were rounded.

use super::outline::{Outline, Segment};
use super::{Overlaps, winding_around};
use crate::box_tree::{BoxTree, Extent};
use crate::sheet::Sheet;
use abf_mesh::predicates::orient2d;
use abf_mesh::{DisjointSets, FaceId, Point2};
use std::collections::BTreeMap;

/// How far a test point is from its corner, as a part of the way to the centroid of the face.
const INWARDS: f64 = 1.0 / 1024.0;

/// A crossing at which an end of one segment is within rounding of the other; or two sectors at a spot, as deep over each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shallow {
    /// How far the nearest end is from the other segment.
    pub(super) depth: f64,
    /// How far it may be.
    pub(super) limit: f64,
    /// One of the two segments.
    pub(super) segment: u32,
    /// A face at each of them.
    pub(super) faces: [Option<FaceId>; 2],
    /// Whether it is at the end of a segment: a meeting.
    pub(super) is_meeting: bool,
}

/// How deep two segments cross: the least distance of an end of one from the other.
pub(super) fn depth(outline: &Outline, a: &Segment, b: &Segment) -> f64 {
    let ends = |s: &Segment| [s.low, s.high].map(|spot| outline.place(spot));
    let ([a0, a1], [b0, b1]) = (ends(a), ends(b));
    [(a0, [b0, b1]), (a1, [b0, b1]), (b0, [a0, a1]), (b1, [a0, a1])]
        .into_iter()
        .map(|(p, [from, to])| distance(p, from, to))
        .fold(f64::INFINITY, f64::min)
}

/// The distance of a point from a segment; that from its line to the accuracy of the exact sign.
pub(super) fn distance(p: Point2<f64>, from: Point2<f64>, to: Point2<f64>) -> f64 {
    let along = to - from;
    let foot = (p - from).dot(&along);
    if foot <= 0.0 || foot >= along.norm_squared() {
        return (p - from).norm().min((p - to).norm());
    }
    orient2d(from, to, p).abs() / along.norm()
}

impl Overlaps {
    /// Counts shallow crossings: as touches, but as crossings where pieces of the boundary lie deeper under faces somewhere.
    /// A piece is what `pieces` joins; each of its faces is looked at near its corners on the boundary and in its middle.
    pub(super) fn settle(
        &mut self,
        sheet: &Sheet<'_>,
        outline: &Outline,
        tree: &BoxTree,
        shallow: &[Shallow],
        pieces: &mut DisjointSets,
        listed: usize,
    ) {
        let mut limits: BTreeMap<usize, f64> = BTreeMap::new();
        for crossing in shallow {
            let root = pieces.find(outline.segments[crossing.segment as usize].low as usize);
            let limit = limits.entry(root).or_default();
            *limit = limit.max(crossing.limit);
        }
        let mut deep: Vec<usize> = Vec::new();
        for segment in &outline.segments {
            let root = pieces.find(segment.low as usize);
            let Some(&limit) = limits.get(&root).filter(|_| !deep.contains(&root)) else { continue };
            let faces = segment.left.faces.into_iter().chain(segment.right.faces).flatten();
            if faces.into_iter().any(|face| is_deep(sheet, outline, tree, segment, face, limit)) {
                deep.push(root);
            }
        }
        for crossing in shallow {
            let root = pieces.find(outline.segments[crossing.segment as usize].low as usize);
            if deep.contains(&root) {
                *(if crossing.is_meeting { &mut self.meetings } else { &mut self.crossings }) += 1;
                self.name(crossing.faces, listed);
            } else {
                self.touches += 1;
                self.touch_depth = self.touch_depth.max(crossing.depth);
            }
        }
    }
}

/// Whether a face at a segment lies under another in its middle, or near an end of the segment that is not within rounding
/// of the rest of the boundary.
fn is_deep(sheet: &Sheet<'_>, outline: &Outline, tree: &BoxTree, segment: &Segment, face: FaceId, limit: f64) -> bool {
    let [a, b, c] = sheet.triangle(face);
    let middle = Point2::from((a.coords + b.coords + c.coords) / 3.0);
    if winding_around(outline, tree, middle) > 1 {
        return true;
    }
    [segment.low, segment.high].into_iter().any(|spot| {
        let place = outline.place(spot);
        let inside = place + (middle - place) * INWARDS;
        winding_around(outline, tree, inside) > 1 && !is_near(outline, tree, spot, limit)
    })
}

/// Whether a segment that does not end at a spot comes this near to it.
fn is_near(outline: &Outline, tree: &BoxTree, spot: u32, limit: f64) -> bool {
    let place = outline.place(spot);
    let around = Extent { low: place.map(|x| x - limit), high: place.map(|x| x + limit) };
    let mut found = false;
    tree.visit(
        |extent| extent.meets(&around),
        |s| {
            let segment = &outline.segments[s as usize];
            let ends = [segment.low, segment.high];
            let [from, to] = ends.map(|end| outline.place(end));
            found |= !ends.contains(&spot) && distance(place, from, to) <= limit;
        },
    );
    found
}
