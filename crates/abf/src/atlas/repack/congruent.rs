//! Islands of the same shape.

use super::islands::Islands;
use super::stacked::Stacked;
use abf_mesh::UvId;
use std::collections::{BTreeMap, HashMap};

/// Points of islands that count as the same are at most this part of the extent of all UVs apart,
const OF_ALL: f64 = 1e-5;
/// and this part of their island's own.
const OF_OWN: f64 = 1e-3;

/// For every island the first one of its group that has its shape, turned or not. Islands that lie over themselves or over
/// others stay as they are.
pub(super) fn stacks(islands: &Islands<'_>, group: &[usize]) -> Vec<Option<Stacked>> {
    let [low, high] = islands.extent();
    let most = OF_ALL * (high[0] - low[0]).max(high[1] - low[1]);
    let mut leaders: HashMap<(usize, usize, usize), ByArea> = HashMap::new();
    let mut stacked = vec![None; islands.len()];
    for island in (0..islands.len()).filter(|&i| islands.is_alone(i)) {
        let Some(shape) = Shape::new(islands, island, most) else { continue };
        let alike = leaders.entry((group[island], shape.places.len(), shape.border.len())).or_default();
        // Moving the border by the tolerance changes the area by so much at most; areas are positive, so that their bits
        // are in their order.
        let slack = shape.tolerance * shape.length;
        let (from, to) = ((shape.area - slack).max(0.0).to_bits(), (shape.area + slack).to_bits());
        let found = alike.range((from, 0)..=(to, usize::MAX)).find_map(|(&(_, on), leader)| {
            let points = leader.matched(&shape)?;
            Some(Stacked { on, points })
        });
        match found {
            Some(found) => stacked[island] = Some(found),
            None => {
                alike.insert((shape.area.to_bits(), island), shape);
            }
        }
    }
    stacked
}

/// The first islands of their shapes, by the bits of their areas and their numbers.
type ByArea = BTreeMap<(u64, usize), Shape>;

/// The points of an island around their middle, and its border.
struct Shape {
    places: Vec<[f64; 2]>,
    radii: Vec<f64>,
    /// All points in each place.
    ids: Vec<Vec<UvId>>,
    /// The edges of one triangle, by the lower place first, ascending.
    border: Vec<[usize; 2]>,
    /// The length of the border.
    length: f64,
    area: f64,
    tolerance: f64,
    /// The places in every square with a side of four times the tolerance.
    squares: HashMap<[i64; 2], Vec<usize>>,
}

impl Shape {
    /// `None` for what has no area.
    fn new(islands: &Islands<'_>, island: usize, most: f64) -> Option<Self> {
        let mut number: HashMap<[u64; 2], usize> = HashMap::new();
        let (mut places, mut ids): (Vec<[f64; 2]>, Vec<Vec<UvId>>) = (Vec::new(), Vec::new());
        let corners: Vec<usize> = islands
            .corners(island)
            .map(|id| {
                let p = islands.point(id);
                let place = *number.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(places.len());
                if place == places.len() {
                    places.push(p);
                    ids.push(Vec::new());
                }
                ids[place].push(id);
                place
            })
            .collect();
        // Faces on others may have points of their own in the places of those.
        for id in islands.all_corners(island) {
            number
                .get(&islands.point(id).map(|x| (x + 0.0).to_bits()))
                .into_iter()
                .for_each(|&place| ids[place].push(id));
        }
        ids.iter_mut().for_each(|same| {
            same.sort_unstable();
            same.dedup();
        });
        let middle = [0, 1].map(|i| places.iter().map(|p| p[i]).sum::<f64>() / places.len() as f64);
        places.iter_mut().for_each(|p| *p = [p[0] - middle[0], p[1] - middle[1]]);
        let radii: Vec<f64> = places.iter().map(|p| p[0].hypot(p[1])).collect();
        let border = border(&corners);
        let span = |&[a, b]: &[usize; 2]| (places[a][0] - places[b][0]).hypot(places[a][1] - places[b][1]);
        let length = border.iter().map(span).sum();
        let area = area(&corners, &places);
        let tolerance = most.min(OF_OWN * radii.iter().copied().fold(0.0, f64::max));
        let mut shape = Self { places, radii, ids, border, length, area, tolerance, squares: HashMap::new() };
        for i in 0..shape.places.len() {
            let square = shape.square(shape.places[i]);
            shape.squares.entry(square).or_default().push(i);
        }
        (area > tolerance * tolerance && tolerance > 0.0).then_some(shape)
    }

    fn square(&self, p: [f64; 2]) -> [i64; 2] {
        p.map(|x| (x / (4.0 * self.tolerance)).floor() as i64)
    }

    /// The points of `other` with those of this shape that they lie upon after a turn, if all of them do, and the borders
    /// do.
    fn matched(&self, other: &Self) -> Option<Vec<(UvId, UvId)>> {
        let far = (0..self.radii.len()).max_by(|&a, &b| self.radii[a].total_cmp(&self.radii[b]).then(b.cmp(&a)))?;
        let (p, r) = (self.places[far], self.radii[far]);
        let at_far = (0..other.radii.len()).filter(|&j| (other.radii[j] - r).abs() <= 2.0 * self.tolerance);
        at_far.filter(|&j| other.radii[j] > 0.0).find_map(|j| {
            let q = other.places[j];
            let scale = r * other.radii[j];
            // From q to p.
            let turn = [(p[0] * q[0] + p[1] * q[1]) / scale, (p[1] * q[0] - p[0] * q[1]) / scale];
            self.matched_at(other, turn)
        })
    }

    fn matched_at(&self, other: &Self, [cos, sin]: [f64; 2]) -> Option<Vec<(UvId, UvId)>> {
        let mut partner = vec![usize::MAX; other.places.len()];
        let mut is_taken = vec![false; self.places.len()];
        for (j, &[x, y]) in other.places.iter().enumerate() {
            let at = [cos * x - sin * y, sin * x + cos * y];
            let i = self.nearest(at)?;
            if std::mem::replace(&mut is_taken[i], true) {
                return None;
            }
            partner[j] = i;
        }
        let mut border: Vec<[usize; 2]> =
            other.border.iter().map(|edge| edge.map(|j| partner[j])).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        border.sort_unstable();
        let all = || other.ids.iter().zip(&partner);
        (border == self.border)
            .then(|| all().flat_map(|(ids, &i)| ids.iter().map(move |&id| (id, self.ids[i][0]))).collect())
    }

    /// The place nearest to a point, if it is within the tolerance, which the turn may double.
    fn nearest(&self, at: [f64; 2]) -> Option<usize> {
        let [x, y] = self.square(at);
        let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
        let near = around.filter_map(|square| self.squares.get(&square)).flatten().copied();
        let away = |i: usize| (self.places[i][0] - at[0]).hypot(self.places[i][1] - at[1]);
        near.map(|i| (away(i), i))
            .filter(|&(d, _)| d <= 2.0 * self.tolerance)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, i)| i)
    }
}

/// The edges that one triangle has.
fn border(corners: &[usize]) -> Vec<[usize; 2]> {
    let sides = corners.as_chunks::<3>().0.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<[usize; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}

fn area(corners: &[usize], places: &[[f64; 2]]) -> f64 {
    let of = |&[a, b, c]: &[usize; 3]| {
        let [p, q, r] = [a, b, c].map(|i| places[i]);
        0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])).abs()
    };
    corners.as_chunks::<3>().0.iter().map(of).sum()
}
