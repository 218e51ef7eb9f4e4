//! Steps that turn and scale.
//!
//! A direction tells every edge `e` how to change, `δe`, and on a straight line `e + s δe` a quarter turn lengthens it
//! and a shrinking by more than `e` itself turns it over: most of the steps from a disk that has to grow by powers of
//! ten in one place against another are stopped by that alone. Followed in logarithms, `log e + s δe / e`, turns stay
//! turns and no length passes zero; the angles then change by exactly `s δ`. Such edges do not close to second
//! order in `s`, so every triangle gets a target of its own, and the vertices are those whose edges come closest to
//! all targets (one Laplacian system). A triangle whose angles would leave (0, π) goes with its neighbours in turn and
//! scale, and stops in its shape: it no longer holds back the others.

use crate::newton::Direction;
use crate::plane::{edges, of_face, orientation};
use crate::system::FaceSystem;
use abf_control::{Checkpoint, at_block};
use abf_linalg::{Cholesky, Complex64, LinearError, Refinement};
use abf_mesh::{FaceId, Point2, Topology, VertexId};
use std::f64::consts::PI;

/// The largest part of its way to 0 or π that an angle of a target goes.
const WAY_TO_BOUND: f64 = 0.9;

const REFINEMENT: Refinement = Refinement { tolerance: 1e-10, max_steps: 2 };

/// The Laplacian `Σ cot x_k / A |δ_k|²` over the edges of all faces: the Dirichlet energy, each triangle by its own area,
/// so that a crowded neighbourhood counts as much as any other.
pub(crate) struct Retraction {
    system: FaceSystem<3>,
}

/// The retraction at one place.
pub(crate) struct Laplacian<'r> {
    retraction: &'r Retraction,
    factors: Cholesky<f64>,
    weights: Vec<[f64; 3]>,
}

impl Retraction {
    /// One pinned vertex takes away the translations; targets have no other freedom.
    pub(crate) fn new(
        topology: &Topology,
        pinned: VertexId,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, LinearError> {
        Ok(Self { system: FaceSystem::new(topology, &[pinned], checkpoint)? })
    }

    /// Factorises the Laplacian of this drawing.
    pub(crate) fn at(
        &mut self,
        topology: &Topology,
        uv: &[Point2<f64>],
        angles: &[f64],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Laplacian<'_>, LinearError> {
        self.system.clear();
        let mut weights = Vec::with_capacity(topology.face_count());
        for face in topology.faces() {
            at_block(face.index(), checkpoint)?;
            let double_area = orientation(&of_face(topology, uv, face));
            let of_face = face.corners().map(|c| 1.0 / (angles[c.index()].tan() * double_area));
            let [a, b, c] = of_face;
            self.system.add(face.index(), &[[b + c, -c, -b], [-c, a + c, -a], [-b, -a, a + b]]);
            weights.push(of_face);
        }
        let factors = self.system.factorise(checkpoint)?;
        Ok(Laplacian { retraction: self, factors, weights })
    }
}

impl Laplacian<'_> {
    /// The drawing this share of the direction further. Not checked for validity.
    pub(crate) fn advance(
        &self,
        topology: &Topology,
        uv: &[Point2<f64>],
        angles: &[f64],
        direction: &Direction,
        share: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Vec<Point2<f64>>, LinearError> {
        let system = &self.retraction.system;
        let mut rhs = [vec![0.0; system.matrix.size()], vec![0.0; system.matrix.size()]];
        for face in topology.faces() {
            at_block(face.index(), checkpoint)?;
            // Solved for what the targets say beyond the straight line: small, where the coordinates are not.
            let beyond = beyond_straight(topology, uv, angles, direction, face, share);
            let unknowns = topology.face_vertices(face).map(|v| system.numbering.unknown(v));
            for (k, pull) in beyond.into_iter().enumerate() {
                let pull = pull * self.weights[face.index()][k];
                for (end, sign) in [(unknowns[(k + 1) % 3], -1.0), (unknowns[(k + 2) % 3], 1.0)] {
                    if let Some(u) = end {
                        rhs[0][u] += sign * pull.re;
                        rhs[1][u] += sign * pull.im;
                    }
                }
            }
        }
        for rhs in &mut rhs {
            checkpoint()?;
            self.factors.solve_asking(&system.matrix, rhs, REFINEMENT, checkpoint)?;
        }
        checkpoint()?;
        let advanced = |v: VertexId| {
            let straight = uv[v.index()] + direction.motion[v.index()] * share;
            system
                .numbering
                .unknown(v)
                .map_or(straight, |u| Point2::new(straight.x + rhs[0][u], straight.y + rhs[1][u]))
        };
        Ok(topology.vertices().map(advanced).collect())
    }
}

/// The edges of a face's target, less those of the straight line.
fn beyond_straight(
    topology: &Topology,
    uv: &[Point2<f64>],
    angles: &[f64],
    direction: &Direction,
    face: FaceId,
    share: f64,
) -> [Complex64; 3] {
    let here = edges(&of_face(topology, uv, face));
    let change = edges(&of_face(topology, &direction.motion, face).map(Point2::from)).map(|d| d * share);
    let x = face.corners().map(|c| angles[c.index()]);
    let delta = face.corners().map(|c| direction.angle_change[c.index()]);
    let room = |k: usize| if delta[k] < 0.0 { -x[k] / delta[k] } else { (PI - x[k]) / delta[k] };
    let own_share = (0..3).fold(share, |s, k| s.min(WAY_TO_BOUND * room(k)));

    let (old, new) = (unit_shape(x), unit_shape([0, 1, 2].map(|k| x[k] + own_share * delta[k])));
    // The similarity that the edges ask for, the mean of theirs in logarithms.
    let asked: Complex64 = (0..3).map(|k| change[k] / here[k] - (new[k] / old[k]).ln()).sum::<Complex64>() / 3.0;
    let similarity = here[0] / old[0] * asked.exp();
    [0, 1, 2].map(|k| new[k] * similarity - here[k] - change[k])
}

/// The edges of the triangle with these angles, the first along the real axis, on a circle of diameter 1.
fn unit_shape([a, b, c]: [f64; 3]) -> [Complex64; 3] {
    let first = Complex64::from(a.sin());
    let second = Complex64::from_polar(b.sin(), PI - c);
    [first, second, -first - second]
}
