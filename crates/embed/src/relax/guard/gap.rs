//! The smallest distance of parts of the boundary that are not near along it.

use super::contact::Nearness;
use super::{Guard, NEAR_BESIDE_WAY, Walk};
use abf_mesh::{Point2, Vector2};
use abf_overlap::Extent;

impl Guard<'_> {
    /// The smallest distance of a vertex and an edge that are nearer in the plane than a quarter of the way between them along the
    /// boundary; `None` where there is no such pair.
    pub(crate) fn least_gap(&self, uv: &[Point2<f64>]) -> Option<f64> {
        self.least_gap_counting(uv, &mut 0)
    }

    /// The same; counts the pairs that were looked at. Of a run of edges none is looked at where the box around it is too far away:
    /// farther than the least distance so far, or than a quarter of the way to its farthest edge. The second has to be
    /// asked, too: around a convex boundary there is no least distance.
    fn least_gap_counting(&self, uv: &[Point2<f64>], looked_at: &mut usize) -> Option<f64> {
        let points: Vec<Point2<f64>> = self.vertices.iter().map(|v| uv[v.index()]).collect();
        let ends = |k: u32| [points[k as usize], points[self.next[k as usize] as usize]];
        let walk = self.walk(&points);
        let runs = Runs::new(&self.loop_of, |k| {
            let [a, b] = ends(k);
            Extent::around(a, b)
        });
        let mut least = f64::INFINITY;
        let mut stack = Vec::new();
        for (vertex, &p) in (0..).zip(&points) {
            stack.extend(&runs.whole_loops);
            while let Some(at) = stack.pop() {
                let run = &runs.runs[at];
                let most = least.min(NEAR_BESIDE_WAY * self.longest_way(&walk, vertex, run));
                if distance(&run.extent, p) >= most {
                    continue;
                }
                if run.second != 0 {
                    stack.extend([run.second, at + 1]);
                    continue;
                }
                for edge in (run.begin..run.end).filter(|&edge| self.is_pair(vertex, edge)) {
                    *looked_at += 1;
                    let [a, b] = ends(edge);
                    let distance = Nearness::of([p, a, b]).distance;
                    if distance < least && distance < NEAR_BESIDE_WAY * self.way(&walk, vertex, edge) {
                        least = distance;
                    }
                }
            }
        }
        Some(least).filter(|least| least.is_finite())
    }

    /// At least the way along the boundary from a vertex to any end of an edge of a run; infinite between loops.
    fn longest_way(&self, walk: &Walk, vertex: u32, run: &Run) -> f64 {
        let own = self.loop_of[vertex as usize];
        if own != self.loop_of[run.begin as usize] {
            return f64::INFINITY;
        }
        let (from, total) = (walk.at[vertex as usize], walk.total[own as usize]);
        let after = self.next[run.end as usize - 1];
        let begin = walk.at[run.begin as usize];
        // The last edge of a loop ends where the loop begins.
        let end = if after < run.end { total } else { walk.at[after as usize] };
        let way = |to: f64| (to - from).abs().min(total - (to - from).abs());
        (way(begin).min(way(end)) + (end - begin)).min(0.5 * total)
    }
}

/// The edges of every loop, halved again and again.
struct Runs {
    /// The first half of a run stands right behind it.
    runs: Vec<Run>,
    whole_loops: Vec<usize>,
}

/// Edges one after another.
struct Run {
    extent: Extent,
    begin: u32,
    end: u32,
    /// Where its second half is; zero for one that is not halved.
    second: usize,
}

impl Runs {
    /// The most edges of a run that is not halved.
    const FEW: u32 = 8;

    fn new(loop_of: &[u32], extent: impl Fn(u32) -> Extent) -> Self {
        let mut all = Self { runs: Vec::new(), whole_loops: Vec::new() };
        let mut begin = 0;
        for edges in loop_of.chunk_by(|a, b| a == b) {
            let end = begin + edges.len() as u32;
            all.whole_loops.push(all.runs.len());
            all.grow(begin, end, &extent);
            begin = end;
        }
        all
    }

    /// Adds a run and its halves.
    fn grow(&mut self, begin: u32, end: u32, extent: &impl Fn(u32) -> Extent) -> Extent {
        let this = self.runs.len();
        self.runs.push(Run { extent: extent(begin), begin, end, second: 0 });
        let bounds = if end - begin <= Self::FEW {
            (begin..end).map(extent).reduce(Extent::with).expect("a run has edges")
        } else {
            let half = begin + (end - begin) / 2;
            let first = self.grow(begin, half, extent);
            self.runs[this].second = self.runs.len();
            first.with(self.grow(half, end, extent))
        };
        self.runs[this].extent = bounds;
        bounds
    }
}

/// How far a point is from a box; 0 inside.
fn distance(extent: &Extent, p: Point2<f64>) -> f64 {
    let beyond = |low: f64, high: f64, x: f64| (low - x).max(x - high).max(0.0);
    Vector2::new(beyond(extent.low.x, extent.high.x, p.x), beyond(extent.low.y, extent.high.y, p.y)).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{Point3, Topology, TriMesh};
    use std::f64::consts::TAU;

    /// A fan around the last vertex; its boundary is `0..n`.
    fn fan(n: usize) -> Topology {
        let faces: Vec<[usize; 3]> = (0..n).map(|k| [k, (k + 1) % n, n]).collect();
        topology(n + 1, &faces)
    }

    /// A ring: the outer boundary is `0..n`, that of the hole `n..2n`.
    fn ring(n: usize) -> Topology {
        let faces = |k: usize| [[k, (k + 1) % n, n + k], [(k + 1) % n, n + (k + 1) % n, n + k]];
        topology(2 * n, &(0..n).flat_map(faces).collect::<Vec<_>>())
    }

    fn topology(vertices: usize, faces: &[[usize; 3]]) -> Topology {
        let mesh = TriMesh::new(vec![Point3::origin(); vertices], faces).expect("indices in range");
        Topology::build(vertices, mesh.faces()).expect("a manifold")
    }

    fn around(n: usize, radius: impl Fn(f64) -> f64) -> impl Iterator<Item = Point2<f64>> {
        (0..n).map(move |k| {
            let turn = TAU * k as f64 / n as f64;
            Point2::new(turn.cos(), turn.sin()) * radius(turn)
        })
    }

    /// A square with sides of a quarter of the boundary each.
    fn square(n: usize) -> impl Iterator<Item = Point2<f64>> {
        (0..n).map(move |k| {
            let along = 4.0 * k as f64 / n as f64;
            let (x, (sine, cosine)) = (along.fract(), (along.floor() * TAU / 4.0).sin_cos());
            let (a, b) = (x - 0.5, -0.5);
            Point2::new(cosine * a - sine * b, sine * a + cosine * b)
        })
    }

    /// All pairs, one by one.
    fn slowly(guard: &Guard<'_>, uv: &[Point2<f64>]) -> Option<f64> {
        let points: Vec<Point2<f64>> = guard.vertices.iter().map(|v| uv[v.index()]).collect();
        let (walk, count) = (guard.walk(&points), points.len() as u32);
        let pairs = (0..count).flat_map(|v| (0..count).map(move |e| (v, e))).filter(|&(v, e)| guard.is_pair(v, e));
        let near = pairs.filter_map(|(v, e)| {
            let ends = [v, e, guard.next[e as usize]].map(|k| points[k as usize]);
            let distance = Nearness::of(ends).distance;
            (distance < NEAR_BESIDE_WAY * guard.way(&walk, v, e)).then_some(distance)
        });
        near.reduce(f64::min)
    }

    #[test]
    fn the_gap_of_a_convex_outline_is_found_without_looking_at_all_pairs() {
        for n in [1 << 10, 1 << 15] {
            let topology = fan(n);
            let guard = Guard::new(&topology, 1.0, 0.0);
            for outline in [around(n, |_| 1.0).collect::<Vec<_>>(), square(n).collect()] {
                let uv: Vec<Point2<f64>> = outline.into_iter().chain([Point2::origin()]).collect();
                let mut looked_at = 0;
                assert_eq!(guard.least_gap_counting(&uv, &mut looked_at), None);
                assert!(looked_at < 64 * n, "{n}: {looked_at}");
            }
        }
    }

    #[test]
    fn two_sides_all_along_each_other_take_no_longer() {
        let n = 1 << 14;
        let topology = fan(n);
        // A hundred times as long as it is wide.
        let flat = square(n).map(|p| Point2::new(100.0 * p.x, p.y));
        let uv: Vec<Point2<f64>> = flat.chain([Point2::origin()]).collect();
        let mut looked_at = 0;
        let gap = Guard::new(&topology, 1.0, 0.0).least_gap_counting(&uv, &mut looked_at);
        assert!(gap.is_some_and(|gap| (gap - 1.0).abs() < 1e-12), "{gap:?}");
        assert!(looked_at < 64 * n, "{looked_at}");
    }

    #[test]
    fn it_is_the_least_of_all_pairs() {
        let n = 300;
        let (one_loop, two_loops) = (fan(n), ring(n));
        for (lobes, depth) in [(5.0, 0.6), (8.0, 0.85), (13.0, 0.95)] {
            let outer: Vec<Point2<f64>> = around(n, |turn| 1.0 + depth * (lobes * turn).cos()).collect();
            let inner = around(n, |turn| 0.5 * (1.0 + depth * (lobes * turn + 0.3).cos()));
            let of_fan: Vec<Point2<f64>> = outer.iter().copied().chain([Point2::origin()]).collect();
            let of_ring: Vec<Point2<f64>> = outer.iter().copied().chain(inner).collect();
            for (topology, uv) in [(&one_loop, of_fan), (&two_loops, of_ring)] {
                let guard = Guard::new(topology, 1.0, 0.0);
                let [quick, slow] = [guard.least_gap(&uv), slowly(&guard, &uv)].map(|gap| gap.expect("parts are near"));
                assert!((quick - slow).abs() <= 1e-14 * slow, "{lobes} {depth}: {quick} {slow}");
            }
        }
    }
}
