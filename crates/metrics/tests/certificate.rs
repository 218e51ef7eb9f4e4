//! The certificate against an exact judge of another kind: integer coordinates, every pair of triangles.

mod support;

use abf_mesh::{FaceId, Point2, Point3, Topology, TriMesh, UvId, UvMap, VertexId};
use abf_metrics::{Certificate, Precision, certify, certify_connected};
use std::collections::{BTreeMap, BTreeSet};
use support::{Noise, mesh, per_vertex, sheet, uv_map};

/// A point with whole coordinates.
type Lattice = [i64; 2];

/// Faces as vertices, and the place of every vertex.
struct Drawing {
    places: Vec<Lattice>,
    faces: Vec<[usize; 3]>,
}

/// A whole number in `0..below`.
fn pick(noise: &mut Noise, below: usize) -> usize {
    ((noise.next() + 1.0) * 0.5 * below as f64) as usize
}

fn turn(a: Lattice, b: Lattice, c: Lattice) -> i128 {
    let [x, y] = [0, 1].map(|k| (i128::from(b[k] - a[k]), i128::from(c[k] - a[k])));
    x.0 * y.1 - y.0 * x.1
}

impl Drawing {
    fn triangle(&self, f: usize) -> [Lattice; 3] {
        self.faces[f].map(|v| self.places[v])
    }

    /// The certificate, on a surface of which only the faces matter.
    fn certificate(&self) -> Certificate {
        let lift = |v: usize| Point3::new(v as f64, (v * v % 7) as f64, (v * v * v % 11) as f64);
        let mesh = TriMesh::new((0..self.places.len()).map(lift).collect(), &self.faces).expect("indices in range");
        let points = self.places.iter().map(|p| Point2::new(p[0] as f64, p[1] as f64)).collect();
        let corners = self.faces.iter().flatten().map(|&v| UvId::new(v)).collect();
        let uv = UvMap::new(points, corners);
        let certificate = certify(&mesh, &uv, Precision::Double).expect("a map");
        // With a corner table at hand it is another way to the same.
        if let Ok(topology) = Topology::build(mesh.vertex_count(), mesh.faces())
            && topology.components().1 == 1
        {
            let connected = certify_connected(&mesh, &topology, &uv, Precision::Double).expect("a map");
            assert_eq!(connected, certificate);
        }
        certificate
    }

    /// Pairs of triangles with an inner point in common.
    fn overlapping_pairs(&self) -> BTreeSet<[usize; 2]> {
        let separates =
            |a: [Lattice; 3], b: [Lattice; 3]| (0..3).any(|k| b.iter().all(|&p| turn(a[k], a[(k + 1) % 3], p) <= 0));
        let overlap = |i: usize, j: usize| {
            let (a, b) = (self.triangle(i), self.triangle(j));
            !separates(a, b) && !separates(b, a)
        };
        let n = self.faces.len();
        (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).filter(|&[i, j]| overlap(i, j)).collect()
    }

    /// Edges of one face only, as places, each pair of places once.
    fn boundary(&self) -> Vec<[Lattice; 2]> {
        let mut count: BTreeMap<[usize; 2], usize> = BTreeMap::new();
        for face in &self.faces {
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                *count.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let single = count.into_iter().filter(|&(_, n)| n == 1).map(|(edge, _)| edge.map(|v| self.places[v]));
        single.map(|[a, b]| [a.min(b), a.max(b)]).collect::<BTreeSet<_>>().into_iter().collect()
    }

    fn crossings(&self) -> usize {
        let edges = self.boundary();
        let crosses = |[a, b]: [Lattice; 2], [c, d]: [Lattice; 2]| {
            turn(a, b, c).signum() * turn(a, b, d).signum() < 0 && turn(c, d, a).signum() * turn(c, d, b).signum() < 0
        };
        let pairs = (0..edges.len()).flat_map(|i| (i + 1..edges.len()).map(move |j| (i, j)));
        pairs.filter(|&(i, j)| crosses(edges[i], edges[j])).count()
    }

    /// Interior vertices whose angles sum up to more than a full turn.
    fn wound(&self) -> Vec<usize> {
        let mut sums = vec![0.0; self.places.len()];
        for face in &self.faces {
            for k in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|i| self.places[face[(k + i) % 3]].map(|x| x as f64));
                let angle = |p: [f64; 2]| (p[1] - a[1]).atan2(p[0] - a[0]);
                sums[face[k]] += (angle(c) - angle(b)).rem_euclid(std::f64::consts::TAU);
            }
        }
        let edges = |v: usize| {
            self.faces.iter().filter(|f| f.contains(&v)).flatten().filter(|&&u| u != v).collect::<BTreeSet<_>>().len()
        };
        let faces = |v: usize| self.faces.iter().filter(|f| f.contains(&v)).count();
        let is_inner = |v: usize| edges(v) == faces(v);
        (0..sums.len()).filter(|&v| is_inner(v) && sums[v] > std::f64::consts::TAU + 1e-6).collect()
    }

    /// Holds the certificate of a drawing of counter-clockwise triangles against the judge.
    fn check(&self, label: &str) -> Certificate {
        let (found, pairs) = (self.certificate(), self.overlapping_pairs());
        let said = format!("{label}: {found:?}\n{:?}\n{:?}", self.places, self.faces);
        assert_eq!((found.flips, found.collapsed), (0, 0), "{said}");
        assert_eq!(found.injective(), pairs.is_empty(), "{pairs:?} {said}");
        let wound = self.wound();
        assert_eq!(found.wound, wound.len(), "{wound:?} {said}");
        assert_eq!(found.crossings, self.crossings(), "{said}");
        for pair in &found.overlapping_faces {
            assert!(pairs.contains(&pair.map(FaceId::index)), "{pair:?} are no pair of {pairs:?}: {said}");
        }
        let distinct: BTreeSet<_> = found.overlapping_faces.iter().collect();
        assert_eq!(distinct.len(), found.overlapping_faces.len(), "a pair is named once: {said}");
        assert!(found.overlaps() == 0 || !found.overlapping_faces.is_empty(), "an example is named: {said}");
        found
    }
}

#[test]
fn two_triangles_that_cross_six_times_are_one_pair() {
    let places = vec![[0, 0], [6, 0], [3, 6], [0, 4], [3, -2], [6, 4]];
    let found = Drawing { places, faces: vec![[0, 1, 2], [3, 4, 5]] }.check("a star");
    assert_eq!((found.crossings, found.overlapping_faces), (6, vec![[FaceId::new(0), FaceId::new(1)]]));
}

/// Counter-clockwise triangles that share nothing but places.
fn scattered(noise: &mut Noise, triangles: usize, side: usize) -> Drawing {
    let mut drawing = Drawing { places: Vec::new(), faces: Vec::new() };
    while drawing.faces.len() < triangles {
        let corners = [(); 3].map(|()| [pick(noise, side) as i64, pick(noise, side) as i64]);
        if turn(corners[0], corners[1], corners[2]) > 0 {
            let v = drawing.places.len();
            drawing.faces.push([v, v + 1, v + 2]);
            drawing.places.extend(corners);
        }
    }
    drawing
}

/// A disk grown triangle by triangle at its rim, every triangle counter-clockwise: it may run over itself
/// and wind around its vertices.
fn grown(noise: &mut Noise, triangles: usize, side: usize) -> Drawing {
    let first = loop {
        let start = scattered(noise, 1, side);
        if start.faces.len() == 1 {
            break start;
        }
    };
    let mut drawing = first;
    let mut rim = vec![0, 1, 2];
    for _ in 0..20 * triangles {
        if drawing.faces.len() >= triangles {
            break;
        }
        let (n, k) = (rim.len(), pick(noise, rim.len()));
        let (a, b, after) = (rim[k], rim[(k + 1) % n], rim[(k + 2) % n]);
        let place = |v: usize| drawing.places[v];
        let used = |u: usize, v: usize| drawing.faces.iter().any(|f| f.contains(&u) && f.contains(&v));
        if n > 3 && pick(noise, 3) == 0 && !used(a, after) && turn(place(b), place(a), place(after)) > 0 {
            // Close the gap at b, which becomes an inner vertex.
            drawing.faces.push([b, a, after]);
            rim.remove((k + 1) % n);
            continue;
        }
        let apex = [pick(noise, side) as i64, pick(noise, side) as i64];
        if turn(place(b), place(a), apex) > 0 {
            let v = drawing.places.len();
            drawing.places.push(apex);
            drawing.faces.push([b, a, v]);
            rim.insert(k + 1, v);
        }
    }
    drawing
}

#[test]
fn scattered_triangles_are_judged_as_every_pair_of_them_is() {
    let mut noise = Noise(7);
    let mut injective = 0;
    for round in 0..6000 {
        let (triangles, side) = (2 + round % 4, 3 + round % 5);
        let found = scattered(&mut noise, triangles, side).check(&format!("round {round}"));
        injective += usize::from(found.injective());
    }
    assert!((300..5000).contains(&injective), "both happen: {injective}");
}

#[test]
fn grown_disks_are_judged_as_every_pair_of_their_triangles_is() {
    let mut noise = Noise(8);
    let (mut injective, mut wound, mut spirals) = (0, 0, 0);
    for round in 0..6000 {
        let (triangles, side) = (2 + round % 11, 3 + round % 7);
        let found = grown(&mut noise, triangles, side).check(&format!("round {round}"));
        injective += usize::from(found.injective());
        wound += usize::from(found.wound > 0);
        spirals += usize::from(found.valid() && !found.injective());
    }
    assert!(injective > 300 && wound > 20 && spirals > 100, "all happen: {injective} {wound} {spirals}");
}

#[test]
fn a_mirrored_drawing_is_judged_as_the_drawing() {
    let mut noise = Noise(9);
    for _ in 0..300 {
        let drawing = grown(&mut noise, 8, 6);
        let mirrored =
            Drawing { places: drawing.places.iter().map(|p| [-p[0], p[1]]).collect(), faces: drawing.faces.clone() };
        let (here, there) = (drawing.certificate(), mirrored.certificate());
        let counts = |c: &Certificate| (c.flips, c.wound, c.crossings, c.meetings, c.nested, c.touches);
        assert_eq!(counts(&here), counts(&there));
    }
}

#[test]
fn signs_are_counted_as_whole_numbers_count_them() {
    let mut noise = Noise(10);
    for _ in 0..500 {
        let mesh = sheet(3, |_, _| 0.0);
        let places: Vec<Lattice> = (0..16).map(|_| [pick(&mut noise, 5) as i64, pick(&mut noise, 5) as i64]).collect();
        let uv: Vec<[f64; 2]> = places.iter().map(|p| p.map(|x| x as f64)).collect();
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|f| f.map(VertexId::index)).collect();
        let areas: Vec<i128> = faces.iter().map(|f| turn(places[f[0]], places[f[1]], places[f[2]])).collect();
        let majority = if areas.iter().sum::<i128>() < 0 { -1 } else { 1 };
        let found = certify(&mesh, &uv_map(&uv, &faces), Precision::Double).expect("a map");
        assert_eq!(found.collapsed, areas.iter().filter(|&&a| a == 0).count());
        assert_eq!(found.flips, areas.iter().filter(|&&a| a * majority < 0).count());
    }
}

#[test]
fn an_inner_vertex_that_is_wound_twice_is_found_though_no_triangle_is_flipped() {
    // A closed fan of six triangles, each of 120°: twice around the centre.
    let mesh = fan(6);
    let uv = per_vertex(&mesh, |p| if p.x == 0.0 && p.y == 0.0 { [0.0; 2] } else { doubled([p.x, p.y]) });
    let found = certify(&mesh, &uv, Precision::Double).expect("a map");
    assert_eq!((found.flips, found.collapsed, found.wound), (0, 0, 1));
    assert_eq!(found.wound_vertices, [VertexId::new(0)]);
    assert!(!found.valid() && !found.injective());
    assert!((found.uv_angle_max.to_degrees() - 120.0).abs() < 1e-9, "{}", found.uv_angle_max);
}

/// `n` triangles around the origin.
fn fan(n: usize) -> TriMesh {
    let rim = (0..n).map(|k| k as f64 / n as f64 * std::f64::consts::TAU).map(|t| [t.cos(), t.sin(), 0.0]);
    let points: Vec<[f64; 3]> = std::iter::once([0.0; 3]).chain(rim).collect();
    let faces: Vec<[usize; 3]> = (0..n).map(|k| [0, k + 1, (k + 1) % n + 1]).collect();
    mesh(&points, &faces)
}

/// The square of a complex number: twice the angle.
fn doubled([x, y]: [f64; 2]) -> [f64; 2] {
    [x * x - y * y, 2.0 * x * y]
}

/// A ring of three squares around a hole, with a small square somewhere.
fn ring_and_square(at: [f64; 2], size: f64) -> Certificate {
    let outer = [[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [0.0, 8.0]];
    let inner = [[2.0, 2.0], [6.0, 2.0], [6.0, 6.0], [2.0, 6.0]];
    let small = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|p| [at[0] + size * p[0], at[1] + size * p[1]]);
    let points: Vec<[f64; 2]> = [outer, inner, small].concat();
    let mut faces: Vec<[usize; 3]> =
        (0..4).flat_map(|k| [[k, (k + 1) % 4, 4 + k], [(k + 1) % 4, 4 + (k + 1) % 4, 4 + k]]).collect();
    faces.extend([[8, 9, 10], [8, 10, 11]]);
    let mesh = mesh(&points.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>(), &faces);
    certify(&mesh, &uv_map(&points, &faces), Precision::Double).expect("a map")
}

#[test]
fn a_chart_in_the_hole_of_another_is_beside_it_and_one_in_its_triangles_under_it() {
    let counts = |c: Certificate| (c.crossings, c.meetings, c.nested, c.touches, c.injective());
    assert_eq!(counts(ring_and_square([3.0, 3.0], 1.0)), (0, 0, 0, 0, true), "in the hole");
    assert_eq!(counts(ring_and_square([9.0, 3.0], 1.0)), (0, 0, 0, 0, true), "outside");
    assert_eq!(counts(ring_and_square([0.5, 3.0], 1.0)), (0, 0, 1, 0, false), "in the band");
    assert_eq!(counts(ring_and_square([2.0, 2.0], 4.0)), (0, 0, 0, 4, true), "fills the hole");
    assert_eq!(counts(ring_and_square([1.5, 3.0], 1.0)), (2, 0, 1, 0, false), "across the rim, from under the band");
    // The hole's rim lies under the square, and the square's rim goes around the whole ring.
    assert_eq!(counts(ring_and_square([-1.0, -1.0], 10.0)), (0, 0, 2, 0, false), "over everything");
    assert_eq!(counts(ring_and_square([2.0, 3.0], 1.0)), (0, 0, 0, 2, true), "touches the rim from within");
    assert_eq!(counts(ring_and_square([1.0, 3.0], 1.0)), (0, 2, 1, 0, false), "touches it from the band");
}

#[test]
fn what_single_precision_makes_of_a_map_is_certified_as_that() {
    // A strip of a width that doubles hold and floats do not.
    let mesh = sheet(1, |_, _| 0.0);
    let thin = per_vertex(&mesh, |p| [1.0 + p.x, 1.0 + 1e-9 * p.y]);
    let double = certify(&mesh, &thin, Precision::Double).expect("a map");
    assert!(double.injective() && double.near_collapsed == 0, "{double:?}");
    let single = certify(&mesh, &thin, Precision::Single).expect("a map");
    assert_eq!((single.collapsed, single.valid()), (2, false), "{single:?}");
    // Two units in the last place of a float: kept, but not safe.
    let tight = per_vertex(&mesh, |p| [1.0 + p.x, 1.0 + f64::from(2.0 * f32::EPSILON) * p.y]);
    assert_eq!(certify(&mesh, &tight, Precision::Single).expect("a map").near_collapsed, 2);
    assert_eq!(certify(&mesh, &tight, Precision::Double).expect("a map").near_collapsed, 0);
}

#[test]
fn everything_in_one_place_ends_in_time() {
    // Every face gets the same triangle, every second face shares its edges' places turned around.
    let mesh = sheet(300, |_, _| 0.0);
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point2::from).to_vec();
    let corners = (0..mesh.face_count()).flat_map(|f| if f % 2 == 0 { [0, 1, 2] } else { [0, 2, 3] }).map(UvId::new);
    let uv = UvMap::new(points, corners.collect());
    let found = certify(&mesh, &uv, Precision::Double).expect("a map");
    assert_eq!((found.flips, found.crossings, found.meetings), (0, 0, 4), "{found:?}");
    let nowhere = uv.mapped(|_| Point2::origin());
    assert_eq!(certify(&mesh, &nowhere, Precision::Double).expect("a map").collapsed, mesh.face_count());
}

#[test]
fn large_maps_take_little_time() {
    for charts in [1, 100] {
        let n = 700;
        let mesh = sheet(n, |_, _| 0.0);
        // A comb: the boundary of the whole is long.
        let shift = |f: usize| (f / (2 * n * n / charts).max(1)) as f64 * 2.0 * n as f64;
        let (mut points, mut corners) = (Vec::new(), Vec::new());
        for (f, face) in mesh.triangles().enumerate() {
            for p in face {
                corners.push(UvId::new(points.len()));
                points.push(Point2::new(p.x + shift(f), p.y));
            }
        }
        let found = certify(&mesh, &UvMap::new(points, corners), Precision::Double).expect("a map");
        assert!(found.injective(), "{found:?}");
    }
}

#[test]
fn overlaps_beyond_four_millions_are_not_counted_to_the_end_and_that_is_said() {
    /// Strips from left to right and from below, all over each other.
    fn crossed(strips: i64) -> Certificate {
        let long = 10 * strips;
        let corners = |k: i64| [[-5, 10 * k], [long, 10 * k], [long, 10 * k + 4], [-5, 10 * k + 4]];
        let level: Vec<Lattice> = (0..strips).flat_map(corners).collect();
        let upright: Vec<Lattice> = level.iter().map(|&[x, y]| [long - 5 - y, x]).collect();
        let faces = (0..2 * strips as usize).flat_map(|i| [[0, 1, 2], [0, 2, 3]].map(|f| f.map(|v| 4 * i + v)));
        Drawing { places: [level, upright].concat(), faces: faces.collect() }.certificate()
    }
    let few = crossed(20);
    assert_eq!((few.overlaps(), few.overlaps_are_least), (4 * 20 * 20, false));
    let many = crossed(1100);
    assert!(many.overlaps_are_least && many.overlaps() > 4_000_000 && many.overlaps() < 4 * 1100 * 1100);
}
