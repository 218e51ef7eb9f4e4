//! What a collapse costs, and where its triangles would be too bad.

use crate::working::{MOST_FACES, Ring, Working};
use abf_mesh::{Point3, Vector3};

/// What the new triangles of a collapse have to be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    /// The least shape quality, `4√3 A / Σ l²`: 1 for an equilateral triangle.
    pub(crate) quality: f64,
    /// The least cosine between the normals of a triangle before and after.
    pub(crate) cosine: f64,
    /// Whether vertices of the interior collapse into such vertices only.
    pub(crate) is_apart: bool,
}

impl Limits {
    pub(crate) const STRICT: Self = Self { quality: 0.3, cosine: 0.3, is_apart: false };

    /// The same, where only connections count in the end.
    pub(crate) const APART: Self = Self { is_apart: true, ..Self::STRICT };

    /// Any shape will do.
    pub(crate) const ANY_SHAPE: Self = Self { quality: f64::NEG_INFINITY, ..Self::APART };

    /// Half as strict.
    pub(crate) fn relaxed(self) -> Self {
        Self { quality: 0.5 * self.quality, cosine: 0.5 * self.cosine, ..self }
    }
}

/// What a moved vertex costs beside its distance to the planes around it, as a share of the squared length of the move:
/// it makes flat surfaces collapse evenly.
const BY_LENGTH: f64 = 1e-2;

/// The cheapest collapse of a vertex, and its cost; `None` where none is allowed.
///
/// The cost is `Σ A d²` over the faces around the vertex, `A` their areas and `d` the distances of its target from their
/// planes, plus the square of twice the area by which the boundary moves, over the worst quality of a new triangle.
pub(crate) fn cheapest(working: &Working, points: &[Point3<f64>], vertex: u32, limits: Limits) -> Option<(f64, u32)> {
    let ring = working.ring(vertex)?;
    let star = Star::new(&ring, points, vertex);
    let may_collapse = |place: usize| working.may_collapse(vertex, &ring, place);
    // Looking at the ring of a target takes longest, and the cheapest one is mostly allowed.
    let is_kept_apart =
        |place: &usize| limits.is_apart && ring.is_closed && !working.is_interior(ring.vertices()[*place]);
    let targets = || ring.targets().filter(|place| !is_kept_apart(place));
    let mut found = star.cheapest(targets(), limits, |_| true)?;
    if !may_collapse(found.1) {
        found = star.cheapest(targets(), limits, may_collapse)?;
    }
    Some((found.0, ring.vertices()[found.1]))
}

/// The faces around a vertex.
struct Star {
    /// From the vertex to its neighbours.
    spokes: [Vector3<f64>; MOST_FACES + 1],
    /// Of the faces, twice their areas long.
    normals: [Vector3<f64>; MOST_FACES],
    lengths: [f64; MOST_FACES],
    neighbours: usize,
    faces: usize,
    /// Twice the area that the boundary would lose; 0 in the interior.
    boundary: f64,
    area: f64,
}

impl Star {
    fn new(ring: &Ring, points: &[Point3<f64>], vertex: u32) -> Self {
        let neighbours = ring.vertices().len();
        let faces = if ring.is_closed { neighbours } else { neighbours - 1 };
        let mut spokes = [Vector3::zeros(); MOST_FACES + 1];
        let at = points[vertex as usize];
        for (spoke, &v) in spokes.iter_mut().zip(ring.vertices()) {
            *spoke = points[v as usize] - at;
        }
        let (mut normals, mut lengths, mut area) = ([Vector3::zeros(); MOST_FACES], [0.0; MOST_FACES], 0.0);
        for i in 0..faces {
            normals[i] = spokes[i].cross(&spokes[(i + 1) % neighbours]);
            lengths[i] = normals[i].norm();
            area += 0.5 * lengths[i];
        }
        let boundary = if ring.is_closed { 0.0 } else { spokes[0].cross(&spokes[neighbours - 1]).norm() };
        Self { spokes, normals, lengths, neighbours, faces, boundary, area }
    }

    /// The cheapest of the allowed targets with a shape within the limits: its cost and its place. The first of equal ones.
    fn cheapest(
        &self,
        targets: impl Iterator<Item = usize>,
        limits: Limits,
        is_allowed: impl Fn(usize) -> bool,
    ) -> Option<(f64, usize)> {
        let mut least = [(f64::INFINITY, 0); MOST_FACES + 1];
        let mut count = 0;
        for place in targets {
            least[count] = (self.deviation(place), place);
            count += 1;
        }
        // Qualities take longest. They are at most 1, so the first ones leave little to look at.
        let left = &mut least[..count];
        left.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut best: Option<(f64, usize)> = None;
        for &(least, place) in &*left {
            let is_better =
                |cost: f64| best.is_none_or(|before| cost < before.0 || (cost == before.0 && place < before.1));
            if !is_better(least) {
                continue;
            }
            let Some(quality) = self.worst_quality(place, limits) else { continue };
            let cost = least / quality.max(f64::MIN_POSITIVE);
            if is_better(cost) && is_allowed(place) {
                best = Some((cost, place));
            }
        }
        best
    }

    fn deviation(&self, place: usize) -> f64 {
        let to = self.spokes[place];
        let of_face = |i: usize| {
            let volume = to.dot(&self.normals[i]);
            if self.lengths[i] > 0.0 { 0.5 * volume * volume / self.lengths[i] } else { 0.0 }
        };
        let planes: f64 = (0..self.faces).map(of_face).sum();
        planes + self.boundary * self.boundary + BY_LENGTH * self.area * to.norm_squared()
    }

    /// The worst quality of the triangles that a collapse leaves, 1 if there are none; `None` below the limits.
    fn worst_quality(&self, place: usize, limits: Limits) -> Option<f64> {
        let mut worst = 1.0;
        for i in 0..self.faces {
            let after = (i + 1) % self.neighbours;
            if i == place || after == place {
                continue;
            }
            let (a, b) = (self.spokes[i] - self.spokes[place], self.spokes[after] - self.spokes[place]);
            let normal = a.cross(&b);
            let double_area = normal.norm();
            let quality =
                2.0 * 3.0_f64.sqrt() * double_area / (a.norm_squared() + b.norm_squared() + (a - b).norm_squared());
            let turned = normal.dot(&self.normals[i]) < limits.cosine * double_area * self.lengths[i];
            if limits != Limits::ANY_SHAPE && (turned || !(quality >= limits.quality)) {
                return None;
            }
            worst = f64::min(worst, quality);
        }
        Some(worst)
    }
}
