//! Where a map covers the plane more than once, found on its boundary alone, exactly.
//!
//! Let every triangle be counter-clockwise. Then the number of triangles over a point is the winding number
//! of the boundary around it, and the map is one to one exactly where that is at most 1. The winding number
//! changes only across the boundary, so it is at most 1 everywhere if it is so beside the boundary:
//!
//! 1. Two boundary edges that cross inside both have two faces over each other at the crossing.
//! 2. Where the boundary meets itself otherwise, at the end of an edge, the sectors that its faces cover
//!    around that point are compared: no direction may be in two of them, nor twice in one.
//! 3. Without crossings, what covers the points beside one connected piece of the boundary, apart from the
//!    faces that touch it, is the same all along it. It is found at the leftmost point of the piece: left
//!    of that the piece itself does not wind, so the number of triangles is the winding number of all
//!    other pieces, and those that touch the point are known.
//!
//! Crossings, and sectors over each other, within the rounding of the coordinates are sorted out after that ([`shallow`]): they
//! are touches, unless the boundary lies deeper under a face near them.
//!
//! Only signs of areas and comparisons of coordinates decide. The boundary edges are found pairwise by a
//! hierarchy of boxes: `O(b log b)` for b boundary edges that are short against the whole.

mod meeting;
mod outline;
mod shallow;

use crate::box_tree::{BoxTree, Extent};
use crate::sheet::{Fan, Sheet};
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::predicates::orient2d;
use abf_mesh::{DisjointSets, FaceId, Point2};
use meeting::Meeting;
use outline::{Outline, Segment};
use shallow::Shallow;

/// After so many pairs of segments it is asked whether to go on.
const PAIRS: usize = 1 << 16;
/// The search ends after so many crossings, shallow ones too, and passes, and [`PER_SEGMENT`] for every segment: nobody needs to know them all,
/// and thousands of charts in one place have billions.
const ENOUGH: usize = 4_000_000;
/// Through a spot that nothing lies over at most two segments pass, and segments have at most twice as many spots. So a map
/// with more passes has an overlap.
const PER_SEGMENT: usize = 4;

/// Where a map covers the plane more than once.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Overlaps {
    /// Pairs of boundary segments that cross inside both.
    pub crossings: usize,
    /// Points at ends of edges where the boundary meets itself, or turns around the point more than once,
    /// and two faces cover one sector.
    pub meetings: usize,
    /// Connected pieces of the boundary whose leftmost point lies under faces that do not touch it.
    pub nested: usize,
    /// Points where the boundary meets itself and no sector is covered twice, and crossings within rounding.
    pub touches: usize,
    /// How deep the deepest of these crossings is.
    pub touch_depth: f64,
    /// Whether there may be more of them: the search ended early.
    pub are_least: bool,
    /// Pairs of faces that lie over each other, at the first places found.
    pub faces: Vec<[FaceId; 2]>,
}

/// Why not all pairs of segments are looked at.
enum End {
    Cancelled(Cancelled),
    Enough,
}

/// Where segments pass spots that are not their ends, and the crossings within rounding.
type Crossings = (Vec<(u32, u32)>, Vec<Shallow>);

impl Overlaps {
    /// Finds them; at most `listed` pairs of faces are named. `fans` are the fans on the boundary, `twice`
    /// those of them that wind more than once. `rounding` is how far rounding may move the coordinates of the chart of a face.
    ///
    /// # Errors
    /// [`Cancelled`], from the checkpoint.
    pub fn find(
        sheet: &Sheet<'_>,
        fans: &[Fan],
        twice: &[Fan],
        listed: usize,
        rounding: impl Fn(FaceId) -> f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, Cancelled> {
        let outline = Outline::new(sheet);
        let mut found = Self::default();
        let mut pieces = DisjointSets::new(outline.spots.len());
        for s in &outline.segments {
            pieces.unite(s.low as usize, s.high as usize);
        }
        let tree = BoxTree::new((0..outline.segments.len() as u32).collect(), |s| outline.extent(s));
        checkpoint()?;
        let (passes, mut shallow) = found.cross(&outline, &tree, &mut pieces, listed, &rounding, checkpoint)?;
        checkpoint()?;
        let fans = fans_at_spots(sheet, &outline, fans);
        found.meet(sheet, &outline, (&fans, twice), &passes, listed, (&rounding, &mut shallow));
        if found.are_least {
            return Ok(found);
        }
        checkpoint()?;
        found.nest(sheet, &outline, &fans, &mut pieces, listed);
        checkpoint()?;
        if !shallow.is_empty() {
            found.settle(sheet, &outline, &tree, &shallow, &mut pieces, listed);
        }
        Ok(found)
    }

    /// Finds crossings, and returns where a segment passes a spot that is not its end, and the crossings within rounding.
    fn cross(
        &mut self,
        outline: &Outline,
        tree: &BoxTree,
        pieces: &mut DisjointSets,
        listed: usize,
        rounding: &dyn Fn(FaceId) -> f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Crossings, Cancelled> {
        let mut passes = Vec::new();
        let mut shallow = Vec::new();
        let mut crossed: Vec<[Option<FaceId>; 2]> = Vec::new();
        let mut looked_at = 0_usize;
        let enough = ENOUGH + PER_SEGMENT * outline.segments.len();
        let all = tree.pairs(|i, j| {
            looked_at += 1;
            if looked_at.is_multiple_of(PAIRS) {
                checkpoint().map_err(End::Cancelled)?;
            }
            if self.crossings + passes.len() + shallow.len() > enough {
                return Err(End::Enough);
            }
            if !outline.extent(i).meets(&outline.extent(j)) {
                return Ok(());
            }
            let [a, b] = [i, j].map(|s| outline.segments[s as usize]);
            let sides = [a.low, a.high].map(|spot| side_of(outline, &b, spot));
            let other_sides = [b.low, b.high].map(|spot| side_of(outline, &a, spot));
            if sides[0] * sides[1] < 0 && other_sides[0] * other_sides[1] < 0 {
                pieces.unite(a.low as usize, b.low as usize);
                let mut faces = [a.face(), b.face()];
                faces.sort_unstable();
                let limit = faces.iter().flatten().map(|&face| rounding(face)).fold(0.0, f64::max);
                let depth = shallow::depth(outline, &a, &b);
                if depth <= limit {
                    shallow.push(Shallow { depth, limit, segment: i, faces, is_meeting: false });
                    return Ok(());
                }
                self.crossings += 1;
                // Two triangles may cross six times.
                if crossed.len() < listed && !crossed.contains(&faces) {
                    crossed.push(faces);
                }
            }
            let on =
                [(a.low, sides[0], j), (a.high, sides[1], j), (b.low, other_sides[0], i), (b.high, other_sides[1], i)];
            for (spot, side, segment) in on {
                if side == 0 && lies_within(outline, spot, segment) {
                    passes.push((spot, segment));
                }
            }
            Ok(())
        });
        match all {
            Ok(()) => {}
            Err(End::Enough) => self.are_least = true,
            Err(End::Cancelled(cancelled)) => return Err(cancelled),
        }
        crossed.into_iter().for_each(|faces| self.name(faces, listed));
        passes.sort_unstable();
        passes.dedup();
        for &(spot, s) in &passes {
            pieces.unite(spot as usize, outline.segments[s as usize].low as usize);
        }
        Ok((passes, shallow))
    }

    /// Looks around every spot where more than one fan or segment is.
    fn meet(
        &mut self,
        sheet: &Sheet<'_>,
        outline: &Outline,
        (fans, twice): (&[(u32, Fan)], &[Fan]),
        passes: &[(u32, u32)],
        listed: usize,
        (rounding, shallow): (&dyn Fn(FaceId) -> f64, &mut Vec<Shallow>),
    ) {
        let mut over = twice.to_vec();
        over.sort_unstable_by_key(|fan| fan.first);
        let is_over = |fan: &Fan| over.binary_search_by_key(&fan.first, |fan| fan.first).is_ok();
        let mut rest = passes;
        for here in fans.chunk_by(|a, b| a.0 == b.0) {
            let spot = here[0].0;
            // Every end of a segment has a fan, so none of the passes is skipped.
            let (passing, after) = rest.split_at(rest.partition_point(|&(other, _)| other <= spot));
            rest = after;
            let fans: Vec<Fan> = here.iter().map(|&(_, fan)| fan).collect();
            let is_alone = fans.len() == 1 && passing.is_empty();
            let over = fans.iter().find(|fan| is_over(fan));
            if is_alone && over.is_none() {
                continue;
            }
            let overlap = match over {
                Some(&fan) => Some(meeting::fan_over_itself(sheet, fan, is_alone)),
                None => {
                    let passing: Vec<&Segment> = passing.iter().map(|&(_, s)| &outline.segments[s as usize]).collect();
                    Meeting::new(sheet, outline, spot, &fans, &passing).overlap()
                }
            };
            match overlap {
                None => self.touches += 1,
                Some((faces, depth)) => {
                    let limit = faces.iter().flatten().map(|&face| rounding(face)).fold(0.0, f64::max);
                    let at = outline.segments.partition_point(|s| s.low < spot);
                    let starts_here = outline.segments.get(at).is_some_and(|s| s.low == spot);
                    let segment = if depth > limit {
                        None
                    } else if starts_here {
                        Some(at)
                    } else {
                        outline.segments.iter().position(|s| s.high == spot)
                    };
                    match segment {
                        Some(segment) => {
                            let segment = segment as u32;
                            shallow.push(Shallow { depth, limit, segment, faces, is_meeting: true });
                        }
                        None => {
                            self.meetings += 1;
                            self.name(faces, listed);
                        }
                    }
                }
            }
        }
    }

    /// Looks from every piece at the others.
    fn nest(
        &mut self,
        sheet: &Sheet<'_>,
        outline: &Outline,
        fans: &[(u32, Fan)],
        pieces: &mut DisjointSets,
        listed: usize,
    ) {
        // The lower index is the root of its set: the lowest leftmost spot of its piece.
        let mut by_piece: Vec<(u32, u32)> =
            outline.segments.iter().zip(0..).map(|(s, k)| (pieces.find(s.low as usize) as u32, k)).collect();
        by_piece.sort_unstable();
        let pieces: Vec<Piece> = by_piece.chunk_by(|a, b| a.0 == b.0).map(|part| Piece::new(outline, part)).collect();
        if pieces.len() < 2 {
            return;
        }
        let around = BoxTree::new((0..pieces.len() as u32).collect(), |k| pieces[k as usize].extent);
        let mut trees: Vec<Option<BoxTree>> = pieces.iter().map(|_| None).collect();
        let mut inside: Vec<u32> = Vec::new();
        for piece in &pieces {
            let place = outline.place(piece.root);
            let mut winding = 0;
            around.visit(
                |extent| extent.holds(place),
                |k| {
                    let other = &pieces[k as usize];
                    if other.root != piece.root && other.extent.holds(place) {
                        let tree = trees[k as usize].get_or_insert_with(|| other.tree(outline));
                        winding += winding_around(outline, tree, place);
                    }
                },
            );
            if winding > faces_left_of(sheet, outline, fans, piece.root) {
                self.nested += 1;
                if self.faces.len() + inside.len() < listed {
                    inside.push(piece.segments[0]);
                }
            }
        }
        for pair in faces_over(sheet, outline, &inside) {
            self.name(pair, listed);
        }
    }

    fn name(&mut self, faces: [Option<FaceId>; 2], listed: usize) {
        if let ([Some(a), Some(b)], true) = (faces, self.faces.len() < listed) {
            let pair = [a.min(b), a.max(b)];
            if !self.faces.contains(&pair) {
                self.faces.push(pair);
            }
        }
    }
}

/// The fans on the boundary with their spots, ordered by them.
fn fans_at_spots(sheet: &Sheet<'_>, outline: &Outline, fans: &[Fan]) -> Vec<(u32, Fan)> {
    let mut at_spots: Vec<(u32, Fan)> = fans.iter().map(|&fan| (outline.spot(sheet, fan.first), fan)).collect();
    at_spots.sort_by_key(|&(spot, fan)| (spot, fan.first));
    at_spots
}

/// How many fans at the first spot of a piece cover the points left of it.
fn faces_left_of(sheet: &Sheet<'_>, outline: &Outline, fans: &[(u32, Fan)], spot: u32) -> i64 {
    let begin = fans.partition_point(|&(other, _)| other < spot);
    let here = fans[begin..].iter().take_while(|&&(other, _)| other == spot);
    let centre = outline.place(spot);
    let is_left = |&&(_, fan): &&(u32, Fan)| {
        let [first, last] = [sheet.place(fan.first.next()), sheet.place(fan.last.prev())];
        // Both edges point to the right, or straight up: the fan goes round the left if it turns back.
        first != centre && last != centre && orient2d(centre, first, last) <= 0.0
    };
    here.filter(is_left).count() as i64
}

/// A connected piece of the boundary.
struct Piece {
    root: u32,
    extent: Extent,
    segments: Vec<u32>,
}

impl Piece {
    fn new(outline: &Outline, part: &[(u32, u32)]) -> Self {
        let segments: Vec<u32> = part.iter().map(|&(_, segment)| segment).collect();
        let extent = segments.iter().map(|&s| outline.extent(s)).reduce(Extent::with).expect("a piece has segments");
        Self { root: part[0].0, extent, segments }
    }

    fn tree(&self, outline: &Outline) -> BoxTree {
        BoxTree::new(self.segments.clone(), |s| outline.extent(s))
    }
}

/// On which side of a segment, from low to high, a spot lies: 1 left, −1 right, 0 on its line.
fn side_of(outline: &Outline, segment: &Segment, spot: u32) -> i8 {
    if spot == segment.low || spot == segment.high {
        return 0;
    }
    let area = orient2d(outline.place(segment.low), outline.place(segment.high), outline.place(spot));
    i8::from(area > 0.0) - i8::from(area < 0.0)
}

/// Whether a spot on the line of a segment lies between its ends and is neither.
fn lies_within(outline: &Outline, spot: u32, segment: u32) -> bool {
    let ends = outline.segments[segment as usize];
    // Spots are ordered as points of a line are.
    ends.low < spot && spot < ends.high && outline.extent(segment).holds(outline.place(spot))
}

/// The winding number of a piece of the boundary around a point that is not on it: the edges that a ray to
/// the left meets, those with the face on the right side counted positive.
fn winding_around(outline: &Outline, tree: &BoxTree, place: Point2<f64>) -> i64 {
    let mut winding = 0;
    tree.visit(
        |extent| extent.low.y <= place.y && place.y <= extent.high.y && extent.low.x <= place.x,
        |s| {
            let segment = &outline.segments[s as usize];
            let [low, high] = [segment.low, segment.high].map(|spot| outline.place(spot));
            let is_rising = low.y <= place.y && place.y < high.y;
            let is_falling = high.y <= place.y && place.y < low.y;
            let side = if is_rising || is_falling { orient2d(low, high, place) } else { 0.0 };
            let net = i64::from(segment.left.count) - i64::from(segment.right.count);
            // The ray to the left meets a rising segment if the point is right of it, a falling one if it is left.
            if is_rising && side < 0.0 {
                winding -= net;
            } else if is_falling && side > 0.0 {
                winding += net;
            }
        },
    );
    winding
}

/// For each of a few segments that lie under faces elsewhere: one of its faces, and a face over it.
fn faces_over(sheet: &Sheet<'_>, outline: &Outline, segments: &[u32]) -> Vec<[Option<FaceId>; 2]> {
    let own: Vec<FaceId> = segments.iter().filter_map(|&s| outline.segments[s as usize].face()).collect();
    let mut over = vec![None; own.len()];
    if own.is_empty() {
        return Vec::new();
    }
    for f in (0..sheet.corner_count() / 3).map(FaceId::new) {
        for (own, over) in own.iter().zip(&mut over).filter(|(own, over)| over.is_none() && **own != f) {
            if triangles_overlap(&sheet.triangle(*own), &sheet.triangle(f)) {
                *over = Some(f);
            }
        }
    }
    own.into_iter().zip(over).map(|(own, over)| [Some(own), over]).collect()
}

/// Whether two counter-clockwise triangles have an inner point in common: no edge of either has the
/// other triangle on its right.
fn triangles_overlap(a: &[Point2<f64>; 3], b: &[Point2<f64>; 3]) -> bool {
    let is_left_of = |from, to, other: &[Point2<f64>; 3]| other.iter().any(|&p| orient2d(from, to, p) > 0.0);
    let (one, two) = (Extent::around(a[0], a[1]), Extent::around(b[0], b[1]));
    let (one, two) = (one.with(Extent::around(a[2], a[2])), two.with(Extent::around(b[2], b[2])));
    one.meets(&two)
        && (0..3).all(|k| is_left_of(a[k], a[(k + 1) % 3], b))
        && (0..3).all(|k| is_left_of(b[k], b[(k + 1) % 3], a))
}
