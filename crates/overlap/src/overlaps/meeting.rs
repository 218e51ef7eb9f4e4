//! What lies around a spot where the boundary meets itself.

use super::outline::{Outline, Segment};
use super::shallow::distance;
use crate::direction;
use crate::sheet::{Fan, Sheet};
use abf_mesh::predicates::orient2d;
use abf_mesh::{CornerId, FaceId, Point2};

/// A sector at a spot that is covered: by a fan of faces, or by the face beside a segment that passes.
#[derive(Clone, Copy)]
enum Cover {
    Fan(Fan),
    Face(FaceId),
}

/// All sectors at one spot.
pub(super) struct Meeting<'a> {
    sheet: &'a Sheet<'a>,
    centre: Point2<f64>,
    /// Where each sector begins and ends, counter-clockwise.
    sectors: Vec<([Point2<f64>; 2], Cover)>,
}

impl<'a> Meeting<'a> {
    /// The sectors at a spot: those of the fans there, and those beside the segments that pass it.
    pub(super) fn new(sheet: &'a Sheet<'a>, outline: &Outline, spot: u32, fans: &[Fan], passing: &[&Segment]) -> Self {
        let centre = outline.place(spot);
        let mut sectors = Vec::new();
        for &fan in fans {
            let ends = [sheet.place(fan.first.next()), sheet.place(fan.last.prev())];
            // A fan that begins or ends with an edge without length has no sector; it is collapsed.
            if !ends.contains(&centre) {
                sectors.push((ends, Cover::Fan(fan)));
            }
        }
        for segment in passing {
            let [low, high] = [segment.low, segment.high].map(|end| outline.place(end));
            for (side, ends) in [(segment.left, [high, low]), (segment.right, [low, high])] {
                sectors.extend(side.faces.into_iter().flatten().map(|face| (ends, Cover::Face(face))));
            }
        }
        Self { sheet, centre, sectors }
    }

    /// Two faces that cover the same sector, if any do, and how deep sectors lie over each other here.
    pub(super) fn overlap(&self) -> Option<([Option<FaceId>; 2], f64)> {
        let directions = self.directions();
        let rank = |p: Point2<f64>| self.find(&directions, p).unwrap_or_default();
        // How many sectors begin at each direction, less those that end there.
        let mut change = vec![0_i64; directions.len() + 1];
        let ranks: Vec<[usize; 2]> = self.sectors.iter().map(|(ends, _)| ends.map(rank)).collect();
        for &[begin, end] in &ranks {
            change[begin] += 1;
            change[end] -= 1;
            if end <= begin {
                // Across the positive x axis; a sector that ends where it begins is a full turn.
                change[0] += 1;
            }
        }
        let crowded = change.iter().scan(0, |cover, change| {
            *cover += change;
            Some(*cover)
        });
        let at = crowded.take(directions.len()).position(|cover| cover > 1)?;
        let covers = |&&[begin, end]: &&[usize; 2]| {
            if begin < end { (begin..end).contains(&at) } else { at >= begin || at < end }
        };
        let both = ranks.iter().zip(&self.sectors).filter(|(rank, _)| covers(rank)).map(|(_, (_, cover))| *cover);
        let mut faces = both.map(|cover| self.face_at(cover, directions[at]));
        let faces = [faces.next().flatten(), faces.next().flatten()];
        Some((faces, self.depth(&ranks, directions.len())))
    }

    /// How deep sectors lie over each other, at most: how far the end of the one side from the other side is where a sector
    /// begins inside of another and ends after that; infinite where it ends before. `ranks` are their directions of `count`.
    fn depth(&self, ranks: &[[usize; 2]], count: usize) -> f64 {
        /// Where more sectors meet, they are not compared.
        const MOST: usize = 16;
        if ranks.len() > MOST {
            return f64::INFINITY;
        }
        let mut deepest = 0.0_f64;
        for (i, &[begin, end]) in ranks.iter().enumerate() {
            // From here on, counter-clockwise; a whole turn for the direction itself.
            let after = |rank: usize| (rank + count - begin - 1) % count + 1;
            for (j, &[other_begin, other_end]) in ranks.iter().enumerate().filter(|&(j, _)| j != i) {
                // The other one holds where this one begins.
                let is_inside =
                    after(other_end) < after(other_begin) || other_begin == begin || other_begin == other_end;
                if !is_inside {
                    continue;
                }
                let ([from, _], [_, to]) = (self.sectors[i].0, self.sectors[j].0);
                let is_cut_off = after(other_end) <= after(end);
                let side = distance(to, self.centre, from).min(distance(from, self.centre, to));
                deepest = deepest.max(if is_cut_off { side } else { f64::INFINITY });
            }
        }
        deepest
    }

    /// The directions in which sectors begin or end, each once, counter-clockwise.
    fn directions(&self) -> Vec<Point2<f64>> {
        let mut directions = Vec::new();
        for &p in self.sectors.iter().flat_map(|(ends, _)| ends) {
            // Sorting would panic if coordinates so close that products underflow broke the order.
            if let Err(place) = self.find(&directions, p) {
                directions.insert(place, p);
            }
        }
        directions
    }

    fn find(&self, directions: &[Point2<f64>], p: Point2<f64>) -> Result<usize, usize> {
        directions.binary_search_by(|&other| direction::compare(self.centre, other, p))
    }

    /// The face of a cover that lies just counter-clockwise of a direction.
    fn face_at(&self, cover: Cover, towards: Point2<f64>) -> Option<FaceId> {
        let fan = match cover {
            Cover::Face(face) => return Some(face),
            Cover::Fan(fan) => fan,
        };
        self.sheet.fan_corners(fan).find(|&c| is_towards(self.sheet, c, towards)).map(CornerId::face)
    }
}

/// The first face of a fan that winds more than once, the one that covers it after a full turn, and how deep they lie over each
/// other, as sectors do; infinite where more than the last face over the first one does, or others are at the spot.
pub(super) fn fan_over_itself(sheet: &Sheet<'_>, fan: Fan, is_alone: bool) -> ([Option<FaceId>; 2], f64) {
    let [centre, begin, end] = [fan.first, fan.first.next(), fan.last.prev()].map(|c| sheet.place(c));
    let again = sheet.fan_corners(fan).skip(1).find(|&c| is_towards(sheet, c, begin));
    let depth = if is_alone && again == Some(fan.last) && is_towards(sheet, fan.first, end) {
        distance(end, centre, begin).min(distance(begin, centre, end))
    } else {
        f64::INFINITY
    };
    ([Some(fan.first.face()), again.map(CornerId::face)], depth)
}

/// Whether the face of a corner lies just counter-clockwise of a direction from that corner.
fn is_towards(sheet: &Sheet<'_>, corner: CornerId, towards: Point2<f64>) -> bool {
    let [centre, begin, end] = [corner, corner.next(), corner.prev()].map(|c| sheet.place(c));
    let begins = direction::is_upper(centre, begin) == direction::is_upper(centre, towards)
        && orient2d(centre, begin, towards) == 0.0;
    begins || (orient2d(centre, begin, towards) > 0.0 && orient2d(centre, towards, end) > 0.0)
}
