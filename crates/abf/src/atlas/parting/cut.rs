//! Cuts across a chart.

use super::super::outline::boundary_loops;
use super::corners::{corners, length};
use crate::unwrap::UnwrappedChart;
use abf_mesh::TriMesh;
use abf_pack::{Piece, gaps};
use abf_parallel::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Points of the boundary that cuts begin and end at, evenly apart.
const ENDS: usize = 28;
/// Neither side of a cut for coverage is smaller than this part of the chart.
const LEAST_SIDE: f64 = 0.02;
/// Cuts at one narrow place whose effect is measured, the most promising first.
const MEASURED: usize = 4;

/// A way across a chart.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    /// Where its ends are in the outer loop, the first before the last.
    ends: [usize; 2],
    /// Its points, ends included.
    pub(super) path: Vec<usize>,
    /// Its length on the surface.
    pub(super) length: f64,
}

/// The edges of a chart.
pub(super) struct Sheet {
    places: Vec<[f64; 2]>,
    /// The outer loop.
    ring: Vec<usize>,
    is_border: Vec<bool>,
    /// The neighbours of every point along edges that may be cut, and how far they are on the surface.
    around: Vec<Vec<(usize, f64)>>,
    area: f64,
}

/// How long the way to every point is, infinite where there is none, and the point before.
type Ways = Vec<(f64, Option<usize>)>;

impl Sheet {
    /// `None` where the boundary meets itself in a point, or there is none. `forbidden` is that of
    /// [`pack_parting`](crate::Atlas::pack_parting).
    pub(super) fn new(mesh: &TriMesh, chart: &UnwrappedChart, forbidden: Option<&[bool]>) -> Option<Self> {
        let places: Vec<[f64; 2]> = chart.uv.points().iter().map(|p| [p.x, p.y]).collect();
        let mut around = vec![Vec::new(); places.len()];
        for ((three, vertices), face) in corners(mesh, chart).zip(&chart.faces) {
            for (k, next, facing) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                let is_forbidden = forbidden.is_some_and(|all| all[face.corner(facing).index()]);
                let length = if is_forbidden { f64::INFINITY } else { length(mesh, [vertices[k], vertices[next]]) };
                around[three[k]].push((three[next], length));
                around[three[next]].push((three[k], length));
            }
        }
        for neighbours in &mut around {
            neighbours.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
            // An edge inside is there twice, one on the boundary once. The longer comes first: it may be forbidden.
            *neighbours = neighbours
                .chunk_by(|a, b| a.0 == b.0)
                .filter(|same| same.len() > 1 && same[0].1.is_finite())
                .map(|same| same[0])
                .collect();
        }
        let loops = boundary_loops(corners(mesh, chart).map(|(three, _)| three));
        let mut is_border = vec![false; places.len()];
        for &point in loops.iter().flatten() {
            if std::mem::replace(&mut is_border[point], true) {
                return None;
            }
        }
        let area = |ring: &Vec<usize>| area(&ring.iter().map(|&i| places[i]).collect::<Vec<_>>());
        let (area, ring) = loops.into_iter().map(|ring| (area(&ring), ring)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Self { places, ring, is_border, around, area })
    }

    /// Ways between points of the outer loop, none longer than `most`, the shortest first.
    pub(super) fn across(&self, most: f64) -> Vec<Cut> {
        let ends = self.ends();
        let searches: Vec<(usize, &[usize])> =
            ends.iter().enumerate().map(|(number, &from)| (from, &ends[number + 1..])).collect();
        self.between(&searches, most)
    }

    /// Ways as [`Self::across`] finds them, between points beside the ends of these cuts.
    pub(super) fn beside(&self, cuts: &[Cut], most: f64) -> Vec<Cut> {
        let ends: Vec<[Vec<usize>; 2]> = cuts.iter().map(|cut| cut.ends.map(|end| self.places_beside(end))).collect();
        let searches: Vec<(usize, &[usize])> =
            ends.iter().flat_map(|[one, other]| one.iter().map(move |&from| (from, other.as_slice()))).collect();
        self.between(&searches, most)
    }

    /// The ways from one place of the outer loop to some others, for each of these, the shortest first.
    fn between(&self, searches: &[(usize, &[usize])], most: f64) -> Vec<Cut> {
        let is_wide = |cut: &Cut| {
            let side = area(&self.sides(cut)[0]) / self.area;
            (LEAST_SIDE..=1.0 - LEAST_SIDE).contains(&side)
        };
        let search = |&(from, to): &(usize, &[usize])| -> Vec<Cut> {
            let ways = self.ways(self.ring[from], most);
            to.iter().filter_map(|&to| self.cut(&ways, from, to)).filter(is_wide).collect()
        };
        let found: Vec<Vec<Cut>> = searches.par_iter().map(search).collect();
        let mut cuts = found.concat();
        cuts.sort_by(|a, b| a.length.total_cmp(&b.length).then(a.ends.cmp(&b.ends)));
        cuts.dedup_by_key(|cut| cut.ends);
        cuts
    }

    /// A place of the outer loop and two on each side, a quarter of the way to the next end and half of it away.
    fn places_beside(&self, place: usize) -> Vec<usize> {
        let count = self.ring.len();
        let whole: f64 = (0..count).map(|i| self.step(i)).sum();
        let mut found = vec![place];
        for way in [0.25, 0.5].map(|part| part * whole / ENDS as f64) {
            let (mut on, mut so_far) = (place, 0.0);
            while so_far < way {
                so_far += self.step(on);
                on = (on + 1) % count;
            }
            let (mut back, mut so_far) = (place, 0.0);
            while so_far < way {
                back = (back + count - 1) % count;
                so_far += self.step(back);
            }
            found.extend([on, back]);
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Cuts that leave fewer places where the outer loop is nearer to itself than `within`: of every such place those from
    /// the middle between its two sides on.
    pub(super) fn between_narrow_sides(&self, within: f64) -> impl Iterator<Item = Cut> + '_ {
        let count = move |rings: &[Vec<[f64; 2]>]| {
            rings.iter().map(|ring| gaps(&Piece::new(vec![ring.clone()]), within).len()).sum::<usize>()
        };
        let whole: Vec<[f64; 2]> = self.ring.iter().map(|&i| self.places[i]).collect();
        let narrow: Vec<[usize; 2]> =
            gaps(&Piece::new(vec![whole]), within).iter().map(|gap| gap.edges.map(|[_, edge]| edge)).collect();
        let before = narrow.len();
        (0..before).flat_map(move |place| {
            let mut cuts: Vec<(usize, Cut)> = self
                .middles(narrow[place])
                .into_iter()
                .flat_map(|from| {
                    let ways = self.ways(self.ring[from], f64::INFINITY);
                    self.nearest_ends(&ways)
                        .into_iter()
                        .filter_map(move |to| self.cut(&ways, from, to))
                        .collect::<Vec<_>>()
                })
                .filter(|cut| cut.separates(narrow[place]))
                .map(|cut| (narrow.iter().filter(|&&sides| !cut.separates(sides)).count(), cut))
                .collect();
            cuts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.length.total_cmp(&b.1.length)).then(a.1.ends.cmp(&b.1.ends)));
            cuts.into_iter().take(MEASURED).map(|(_, cut)| cut).filter(move |cut| count(&self.sides(cut)) < before)
        })
    }

    /// Places in the outer loop halfway between two of its edges, on both ways around, and those beside them.
    fn middles(&self, [a, b]: [usize; 2]) -> Vec<usize> {
        let (a, b) = (a.min(b), a.max(b));
        let count = self.ring.len();
        // From the end of the one edge to the begin of the other.
        let halfway = |from: usize, to: usize| {
            let to = if to < from { to + count } else { to };
            let whole: f64 = (from..to).map(|i| self.step(i % count)).sum();
            let (mut way, mut at) = (0.0, from);
            while at < to && way + 0.5 * self.step(at % count) < 0.5 * whole {
                way += self.step(at % count);
                at += 1;
            }
            at % count
        };
        let mut found: Vec<usize> = [halfway(a + 1, b), halfway((b + 1) % count, a)]
            .into_iter()
            .flat_map(|middle| [middle, (middle + 1) % count, (middle + count - 1) % count])
            .collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Of every part of the outer loop the point that is reached by the shortest way.
    fn nearest_ends(&self, ways: &Ways) -> Vec<usize> {
        let mut starts = self.ends();
        starts.push(self.ring.len());
        let way = |i: usize| Some(ways[self.ring[i]]).filter(|(_, before)| before.is_some()).map(|way| (way.0, i));
        starts
            .windows(2)
            .filter_map(|part| (part[0]..part[1]).filter_map(way).min_by(|a, b| a.0.total_cmp(&b.0)))
            .map(|(_, i)| i)
            .collect()
    }

    /// How far it is from a point of the outer loop to the next one.
    fn step(&self, i: usize) -> f64 {
        let [a, b] = [i, (i + 1) % self.ring.len()].map(|k| self.places[self.ring[k]]);
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    /// Places in the outer loop, evenly apart along it.
    fn ends(&self) -> Vec<usize> {
        let whole: f64 = (0..self.ring.len()).map(|i| self.step(i)).sum();
        let (mut ends, mut way) = (Vec::new(), 0.0);
        for i in 0..self.ring.len() {
            if way >= whole * ends.len() as f64 / ENDS as f64 {
                ends.push(i);
            }
            way += self.step(i);
        }
        ends
    }

    /// The way from one point of the outer loop to another, if there is one.
    fn cut(&self, ways: &Ways, from: usize, to: usize) -> Option<Cut> {
        let (length, mut before) = ways[self.ring[to]];
        before?;
        let mut path = vec![self.ring[to]];
        while let Some(previous) = before {
            path.push(previous);
            before = ways[previous].1;
        }
        if from < to {
            path.reverse();
        }
        Some(Cut { ends: [from.min(to), from.max(to)], path, length })
    }

    /// All ways inside of the chart from a point on, none longer than `most`. They end at the boundary.
    fn ways(&self, from: usize, most: f64) -> Ways {
        let mut found = vec![(f64::INFINITY, None); self.places.len()];
        found[from].0 = 0.0;
        let mut is_done = vec![false; self.places.len()];
        // Lengths are not negative, so that their bits are in their order.
        let mut waiting = BinaryHeap::from([Reverse((0_u64, from))]);
        while let Some(Reverse((bits, point))) = waiting.pop() {
            let so_far = f64::from_bits(bits);
            if std::mem::replace(&mut is_done[point], true) || (self.is_border[point] && point != from) {
                continue;
            }
            for &(next, step) in &self.around[point] {
                let length = so_far + step;
                if length <= most && length < found[next].0 {
                    found[next] = (length, Some(point));
                    waiting.push(Reverse((length.to_bits(), next)));
                }
            }
        }
        found
    }

    /// The outlines on both sides of a cut, without holes.
    pub(super) fn sides(&self, cut: &Cut) -> [Vec<[f64; 2]>; 2] {
        let [from, to] = cut.ends;
        let inner = &cut.path[1..cut.path.len() - 1];
        let one = self.ring[from..=to].iter().chain(inner.iter().rev());
        let other = self.ring[to..].iter().chain(&self.ring[..=from]).chain(inner);
        [one.map(|&i| self.places[i]).collect(), other.map(|&i| self.places[i]).collect()]
    }
}

impl Cut {
    /// Whether two edges of the outer loop are on different sides.
    fn separates(&self, edges: [usize; 2]) -> bool {
        let [a, b] = edges.map(|edge| (self.ends[0]..self.ends[1]).contains(&edge));
        a != b
    }
}

fn area(ring: &[[f64; 2]]) -> f64 {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    0.5 * pairs.map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>().abs()
}
