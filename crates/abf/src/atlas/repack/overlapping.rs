//! Which islands lie over each other.

use super::xy;
use abf_mesh::{DisjointSets, UvMap};
use std::collections::{BTreeSet, HashMap};

/// Islands that reach into each other by less than this part of the extent of all UVs touch: a thousandth of a texel of a
/// page of 1024.
const TOUCH: f64 = 1e-6;

type Triangle = [[f64; 2]; 3];

/// Unites the islands of which triangles lie over each other.
///
/// Triangles go into the squares of a grid as large as they are, and meet those in squares of their size and above. A square
/// keeps the triangles of united islands together: they are not compared with each other.
pub(super) fn overlapping(uv: &UvMap, island_of_face: &[usize], sets: &mut DisjointSets) {
    let triangles: Vec<Triangle> = uv.triangles().map(|three| three.map(xy)).collect();
    let extent = triangles
        .iter()
        .flatten()
        .flatten()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &x| [low.min(x), high.max(x)]);
    let touch = TOUCH * (extent[1] - extent[0]);
    let mut order: Vec<(i32, usize)> = (0..triangles.len())
        .filter(|&f| depth_alone(&triangles[f]) > touch)
        .map(|f| (level(&triangles[f]), f))
        .collect();
    order.sort_unstable_by_key(|&(level, f)| (std::cmp::Reverse(level), f));
    let mut squares: HashMap<(i32, [i64; 2]), Vec<Group>> = HashMap::new();
    let mut levels = BTreeSet::new();
    for (own_level, f) in order {
        levels.insert(own_level);
        let island = island_of_face[f];
        for &level in levels.range(own_level..) {
            for square in squares_of(&triangles[f], level) {
                let Some(groups) = squares.get_mut(&(level, square)) else { continue };
                unite(groups, sets);
                for group in groups.iter() {
                    let is_other = sets.find(group.island) != sets.find(island);
                    let meets = |&other: &usize| depth(&triangles[f], &triangles[other]) > touch;
                    if is_other && group.triangles.iter().any(meets) {
                        sets.unite(group.island, island);
                    }
                }
            }
        }
        for square in squares_of(&triangles[f], own_level) {
            squares.entry((own_level, square)).or_default().push(Group { island, triangles: vec![f] });
        }
    }
}

/// Triangles of united islands.
struct Group {
    island: usize,
    triangles: Vec<usize>,
}

/// Puts the triangles of islands together that were united since.
fn unite(groups: &mut Vec<Group>, sets: &mut DisjointSets) {
    groups.iter_mut().for_each(|group| group.island = sets.find(group.island));
    let mut at: HashMap<usize, usize> = HashMap::with_capacity(groups.len());
    let mut united: Vec<Group> = Vec::with_capacity(groups.len());
    for group in groups.drain(..) {
        match at.get(&group.island) {
            Some(&i) => united[i].triangles.extend(group.triangles),
            None => {
                at.insert(group.island, united.len());
                united.push(group);
            }
        }
    }
    *groups = united;
}

fn bounds(triangle: &Triangle) -> [[f64; 2]; 2] {
    let along = |i: usize| triangle.map(|p| p[i]);
    let least = |i| along(i).into_iter().fold(f64::INFINITY, f64::min);
    let most = |i| along(i).into_iter().fold(f64::NEG_INFINITY, f64::max);
    [[least(0), least(1)], [most(0), most(1)]]
}

/// The power of two that the extent of a triangle is below.
fn level(triangle: &Triangle) -> i32 {
    let [low, high] = bounds(triangle);
    (high[0] - low[0]).max(high[1] - low[1]).log2().floor() as i32 + 1
}

/// The squares of a level that a triangle of that level or below reaches: four at most.
fn squares_of(triangle: &Triangle, level: i32) -> impl Iterator<Item = [i64; 2]> {
    let side = f64::from(level).exp2();
    let [low, high] = bounds(triangle).map(|p| p.map(|x| (x / side).floor() as i64));
    (low[0]..=high[0]).flat_map(move |x| (low[1]..=high[1]).map(move |y| [x, y]))
}

/// How far two triangles reach into each other: the least way that parts them, along a normal of an edge. 0 where they do
/// not meet.
fn depth(a: &Triangle, b: &Triangle) -> f64 {
    let normals = [a, b].into_iter().flat_map(|three| (0..3).filter_map(|k| normal(three[k], three[(k + 1) % 3])));
    let mut least = f64::INFINITY;
    for n in normals {
        let [(low, high), (other_low, other_high)] = [a, b].map(|three| span(three, n));
        least = least.min(high.min(other_high) - low.max(other_low));
        if least <= 0.0 {
            return 0.0;
        }
    }
    if least.is_finite() { least } else { 0.0 }
}

/// The least height of a triangle.
fn depth_alone(triangle: &Triangle) -> f64 {
    depth(triangle, triangle)
}

fn normal(p: [f64; 2], q: [f64; 2]) -> Option<[f64; 2]> {
    let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
    let length = (dx * dx + dy * dy).sqrt();
    (length > 0.0).then(|| [-dy / length, dx / length])
}

fn span(triangle: &Triangle, n: [f64; 2]) -> (f64, f64) {
    let along = triangle.map(|p| p[0] * n[0] + p[1] * n[1]);
    (along.into_iter().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max))
}
