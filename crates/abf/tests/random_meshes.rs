//! Small random disks, most of them ugly, through `auto`: no panic, and nothing that is called valid is not.
//!
//! A few thousand by default; `ABF_RANDOM_MESHES=1000000 cargo test --release -p abf --test random_meshes -- --nocapture`
//! for a million, `ABF_RANDOM_FIRST=n` to begin at another seed. What "valid" means is decided here by whole numbers of
//! any size, and by no code of the library.

#![allow(clippy::print_stdout, reason = "the counts are the point")]

#[path = "support/exact.rs"]
mod exact;

use abf::mesh::{Point3, TriMesh, UvMap, VertexId, io};
use abf_parallel::prelude::*;
use exact::{Sign, turns};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::panic::{AssertUnwindSafe, catch_unwind};

const BY_DEFAULT: u64 = 2000;
const MOST_TRIANGLES: u64 = 60;

/// Splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> usize {
        (self.next() % n) as usize
    }

    /// In [−1, 1).
    fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn chance(&mut self, one_in: u64) -> bool {
        self.next().is_multiple_of(one_in)
    }
}

/// A disk under construction: faces, and the boundary with the surface on its left.
struct Disk {
    faces: Vec<[usize; 3]>,
    boundary: Vec<usize>,
    points: Vec<[f64; 3]>,
    edges: BTreeSet<(usize, usize)>,
}

fn edge(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

impl Disk {
    fn random(random: &mut Random) -> Self {
        let mut disk = Self {
            faces: vec![[0, 1, 2]],
            boundary: vec![0, 1, 2],
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.8, 0.0]],
            edges: [(0, 1), (1, 2), (0, 2)].into(),
        };
        let triangles = 1 + random.below(MOST_TRIANGLES);
        // A few of the attempts lead nowhere.
        for _ in 0..3 * triangles {
            if disk.faces.len() >= triangles {
                break;
            }
            match random.below(5) {
                0 | 1 => disk.attach(random),
                2 | 3 => disk.close(random),
                _ => disk.split(random),
            }
        }
        disk
    }

    fn join(&mut self, a: usize, b: usize) {
        self.edges.insert(edge(a, b));
    }

    /// A triangle on a boundary edge, its tip outside.
    fn attach(&mut self, random: &mut Random) {
        let k = random.below(self.boundary.len() as u64);
        let (a, b) = (self.boundary[k], self.boundary[(k + 1) % self.boundary.len()]);
        let ([ax, ay, _], [bx, by, _]) = (self.points[a], self.points[b]);
        let out = 0.4 + 0.4 * random.signed();
        let tip = self.points.len();
        self.points.push([0.5 * (ax + bx) + out * (by - ay), 0.5 * (ay + by) - out * (bx - ax), 0.0]);
        self.faces.push([b, a, tip]);
        self.join(a, tip);
        self.join(b, tip);
        self.boundary.insert(k + 1, tip);
    }

    /// A triangle between two boundary edges; their common vertex becomes interior.
    fn close(&mut self, random: &mut Random) {
        let n = self.boundary.len();
        let k = random.below(n as u64);
        let [a, b, c] = [0, 1, 2].map(|i| self.boundary[(k + i) % n]);
        if n > 3 && !self.edges.contains(&edge(a, c)) {
            self.faces.push([b, a, c]);
            self.join(a, c);
            self.boundary.remove((k + 1) % n);
        }
    }

    /// A vertex inside a triangle.
    fn split(&mut self, random: &mut Random) {
        let f = random.below(self.faces.len() as u64);
        let [a, b, c] = self.faces[f];
        let middle = self.points.len();
        let mean = |k: usize| (self.points[a][k] + self.points[b][k] + self.points[c][k]) / 3.0;
        self.points.push([mean(0), mean(1), mean(2)]);
        self.faces[f] = [a, b, middle];
        self.faces.extend([[b, c, middle], [c, a, middle]]);
        [a, b, c].into_iter().for_each(|v| self.join(v, middle));
    }

    /// Spoils the positions in one of many ways.
    fn spoil(&mut self, random: &mut Random) {
        let n = self.points.len() as u64;
        let kind = random.below(10);
        for p in &mut self.points {
            match kind {
                // Wild in space.
                0 => *p = [random.signed(), random.signed(), random.signed()],
                // Folded over itself in the plane.
                1 => *p = [random.signed(), random.signed(), 0.0],
                // A bumpy sheet.
                2 => p[2] = 0.3 * random.signed(),
                // Spikes, up to 1e6 high.
                3 if random.chance(4) => p[2] = 10_f64.powf(3.0 + 3.0 * random.signed()) * random.signed(),
                // On a coarse lattice: many points coincide, many lie on a line.
                4 => *p = [random.below(3) as f64, random.below(3) as f64, random.below(2) as f64],
                // Pressed flat into slivers.
                5 => *p = [p[0] + random.signed(), 1e-7 * random.signed(), 0.0],
                // Sizes over ten orders of magnitude.
                6 => *p = [p[0], p[1], random.signed()].map(|x| x * 10_f64.powf(5.0 * random.signed())),
                // Slivers of all kinds.
                7 => *p = [random.signed(), 10_f64.powf(-10.0 * random.signed().abs()) * random.signed(), 0.0],
                _ => p[2] = random.signed(),
            }
        }
        if random.chance(3) {
            for _ in 0..=random.below(3) {
                let (from, to) = (random.below(n), random.below(n));
                self.points[to] = self.points[from];
            }
        }
        if random.chance(50) {
            let scale = 10_f64.powf(if random.chance(2) { 150.0 } else { -150.0 });
            self.points.iter_mut().flatten().for_each(|x| *x *= scale);
        }
    }
}

fn random_mesh(seed: u64) -> TriMesh {
    let mut random = Random(seed);
    random.0 = random.next();
    let mut disk = Disk::random(&mut random);
    disk.spoil(&mut random);
    TriMesh::new(disk.points.into_iter().map(Point3::from).collect(), &disk.faces).expect("indices in range")
}

/// Whether every triangle turns left and the triangles around every interior vertex turn once.
fn is_valid(mesh: &TriMesh, uv: &UvMap) -> bool {
    if uv.triangles().any(|triangle| turns(&triangle) != Sign::Plus) {
        return false;
    }
    let mut around: BTreeMap<VertexId, f64> = BTreeMap::new();
    let mut sides: BTreeMap<(VertexId, VertexId), usize> = BTreeMap::new();
    for (face, [a, b, c]) in mesh.faces().iter().zip(uv.triangles()) {
        for (k, (at, next, prev)) in [(a, b, c), (b, c, a), (c, a, b)].into_iter().enumerate() {
            let largest = (next - at).amax().max((prev - at).amax());
            let (e, f) = ((next - at) / largest, (prev - at) / largest);
            *around.entry(face[k]).or_default() += e.perp(&f).abs().atan2(e.dot(&f));
            let (v, w) = (face[k], face[(k + 1) % 3]);
            *sides.entry((v.min(w), v.max(w))).or_default() += 1;
        }
    }
    let boundary: BTreeSet<VertexId> =
        sides.iter().filter(|(_, n)| **n == 1).flat_map(|((v, w), _)| [*v, *w]).collect();
    around.iter().filter(|(v, _)| !boundary.contains(v)).all(|(_, sum)| (sum / TAU).round() == 1.0)
}

/// How one mesh went, in a few words.
fn outcome(seed: u64) -> Result<String, String> {
    let mesh = random_mesh(seed);
    let flat = match catch_unwind(AssertUnwindSafe(|| abf::flatten(&mesh))) {
        Err(_) => return Err(format!("seed {seed}: panicked")),
        Ok(Err(error)) => return Ok(format!("error: {}", named(&error))),
        Ok(Ok(flat)) => flat,
    };
    let valid = is_valid(&mesh, &flat.uv);
    if valid != flat.certificate.valid() {
        let said = flat.certificate.valid();
        return Err(format!("seed {seed}: {} is said to be valid: {said}, and is: {valid}", flat.solver));
    }
    if seed.is_multiple_of(64) {
        let mut text = Vec::new();
        io::write_obj(&mut text, &mesh, Some(&flat.uv)).expect("memory is writable");
        let read = io::parse(io::MeshFormat::Obj, "random.obj", &text).expect("what was written");
        if read.uv.as_ref().is_none_or(|uv| uv.triangles().ne(flat.uv.triangles())) {
            return Err(format!("seed {seed}: the file has other UVs"));
        }
    }
    let word = match (valid, flat.termination.is_as_asked()) {
        (true, true) => "certified".to_owned(),
        (true, false) => format!("valid, {}", flat.termination),
        (false, _) => {
            let why = flat.rungs.iter().rev().find_map(|rung| rung.error.as_ref());
            format!("not valid, {}: {}", flat.termination, why.map_or_else(String::new, |error| named(error)))
        }
    };
    let limits = if flat.precision_limits.is_some() { ", near the limits of doubles" } else { "" };
    Ok(format!("{} {word}{limits}", flat.solver))
}

/// The chain of messages without its numbers.
fn named(error: &dyn std::error::Error) -> String {
    let chain = std::iter::successors(Some(error), |error| error.source());
    let text = chain.map(ToString::to_string).collect::<Vec<_>>().join(": ");
    text.chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).collect::<String>().replace("##", "#")
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap_or_else(|_| panic!("{name} is no number: {text}")))
}

#[test]
fn the_descent_does_not_jump_to_a_drawing_that_winds_twice() {
    // Found among a million: all triangles counter-clockwise, and one vertex wound around twice.
    let flat = abf::flatten(&random_mesh(649_291)).expect("a disk");
    assert!(flat.certificate.valid(), "{:?}", flat.certificate);
}

#[test]
fn random_disks_are_valid_or_said_not_to_be() {
    let (first, count) = (number("ABF_RANDOM_FIRST", 0), number("ABF_RANDOM_MESHES", BY_DEFAULT));
    let outcomes: Vec<(u64, Result<String, String>)> =
        (first..first + count).into_par_iter().map(|seed| (seed, outcome(seed))).collect();
    let mut counts: BTreeMap<&str, (usize, u64)> = BTreeMap::new();
    for (seed, outcome) in &outcomes {
        if let Ok(word) = outcome {
            counts.entry(word).or_insert((0, *seed)).0 += 1;
        }
    }
    for (word, (n, seed)) in &counts {
        println!("{n:>8}  {word} (for example seed {seed})");
    }
    let wrong: Vec<&String> = outcomes.iter().filter_map(|(_, outcome)| outcome.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{} of {count}: {:#?}", wrong.len(), &wrong[..wrong.len().min(20)]);
    let not_valid: usize = counts.iter().filter(|(word, _)| word.contains("not valid")).map(|(_, (n, _))| n).sum();
    assert_eq!(not_valid, 0, "of {count}; the descent leaves no drawing without flips, so there should be none");
}
