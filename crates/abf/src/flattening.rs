//! What comes out: UVs, and everything that is known of them.

use crate::{FlattenError, Injective, PrecisionLimits, SolverKind};
use abf_constraints::KktCounts;
use abf_control::Termination;
use abf_embed::{Energy, PinResidual};
use abf_mesh::{TriMesh, UvMap};
use abf_metrics::{Certificate, Metrics, MetricsError, measure_certified};
use abf_reconstruct::LayoutKind;
use abf_solve_core::AngleSolution;
use abf_solve_hierarchical::{LevelReport, NoHierarchy};

/// A flattened mesh.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Flattening {
    /// One UV per vertex, in the precision asked for.
    pub uv: UvMap,
    /// What is proved of these UVs: whether triangles are turned over, wind, or lie over each other.
    pub certificate: Certificate,
    /// Whose result this is; never [`SolverKind::Auto`], and a user's own by its name.
    pub solver: SolverKind,
    /// How the solver ended, or relaxing if that came after it; [`Termination::OnePass`] for LSCM, which is one linear solve. When a ladder broke off
    /// because it was cancelled or out of time, and has nothing certified, that.
    pub termination: Termination,
    /// The angles; `None` for LSCM, which does not solve for any.
    pub solution: Option<AngleSolution>,
    /// What the layout did.
    pub layout: LayoutReport,
    /// How many vertices have faces all around: `ni`.
    pub interior_vertices: usize,
    /// How large the KKT matrix of the problem is: with the log wheel, and with the product wheel.
    pub kkt: [KktCounts; 2],
    /// How many rings started from their target angles because of their deficit.
    pub switched_rings: usize,
    /// How many triangles had no shape, an angle below 1e-6, and were solved for as thin ones instead.
    pub shapeless_faces: usize,
    /// How near the UVs are to what doubles can hold; `None` where there is room to spare.
    pub precision_limits: Option<PrecisionLimits>,
    /// What became of the boundary that was asked for; `None` where it was free.
    pub boundary: Option<BoundaryReport>,
    /// The levels of a hierarchical solver; `None` for the others.
    pub hierarchy: Option<HierarchyReport>,
    /// What relaxing did; `None` where it was not asked for, there was no map or no time for it, or the map keeps all lengths
    /// as it is, which is the least of every energy.
    pub relaxed: Option<RelaxReport>,
    /// What was done about overlaps; `None` where nothing was.
    pub injective: Option<InjectiveReport>,
    /// What became of pins; `None` where there are none, or there was no map or no time for them.
    pub pinned: Option<PinReport>,
    /// Every solver that was tried, in order, by [`SolverKind::Auto`]; empty for the others.
    pub rungs: Vec<RungReport>,
}

/// What the boundary of a map is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryReport {
    /// In how many rounds it was solved for; more than one for a circle only.
    pub rounds: usize,
    /// The corners of the rectangle, in the order of the boundary where they were found.
    pub corners: Option<[u32; 4]>,
    /// The lengths of its sides, from corner to corner in the order of the boundary.
    pub sides: Option<[f64; 4]>,
    /// By how much the angle sums of the UVs miss what was asked for, rad: the largest difference. Above 1e-6 a solve that
    /// converged is [`Termination::Stalled`]: doubles do not hold what its angles have.
    pub violation: f64,
    /// The largest angle of the boundary, measured on the UVs, rad.
    pub largest_angle: f64,
    /// The largest distance of a boundary vertex from the centre of the circle that fits best, over the smallest; `None`
    /// where there is no such circle.
    pub radius_spread: Option<f64>,
    /// Whether the map is injective because it is valid, its boundary turns once and no angle of the boundary is above π
    /// by more than 1e-6 rad. A curve that only turns to the left, once, does not meet itself, and a map without flips
    /// inside such a curve does not overlap. The overlap test of the certificate is exact and does not use this.
    pub injective_by_convexity: bool,
}

/// The levels that a hierarchical solver went through.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct HierarchyReport {
    /// Every level, the coarsest first, the mesh itself last; empty where the mesh was solved without a hierarchy, because
    /// it is small enough or for the reason below.
    pub levels: Vec<LevelReport>,
    /// Why there is no hierarchy, where there should be one. The solver of its coarse mesh has solved the fine one then.
    pub fallback: Option<NoHierarchy>,
}

/// What relaxing a map did.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RelaxReport {
    /// Which energy, for a surface of area 1.
    pub energy: Energy,
    /// What it was before, at the scale at which it is least.
    pub before: f64,
    /// What it is at the end, at the scale at which it is least.
    pub after: f64,
    /// How many steps it took.
    pub steps: usize,
    /// How many of these went for shapes within reach, because the map was far from the surface.
    pub progressive_steps: usize,
    /// Whether it started from Tutte's embedding, because the map of the solver is not valid.
    pub from_tutte: bool,
}

/// What was done about a map that lay over itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct InjectiveReport {
    /// By which rule.
    pub rule: Injective,
    /// How many overlaps there were: [`Certificate::overlaps`].
    pub overlaps: usize,
    /// Which energy was least at the end; `None` of a map that was parted.
    pub energy: Option<Energy>,
    /// What that energy was before, with the overlaps; `None` where the map was not valid.
    pub before: Option<f64>,
    /// What it is at the end; `None` where there is no other map.
    pub after: Option<f64>,
    /// How many steps it took.
    pub steps: usize,
    /// How many of these went for lengths first.
    pub first_steps: usize,
    /// The smallest distance, in units of the UVs, of a boundary vertex and a boundary edge that are nearer to each other than a
    /// quarter of their way along the boundary; `None` where there are no such two, or it is not known.
    pub gap: Option<f64>,
    /// In how many parts the map is.
    pub parts: usize,
    /// Why the map is as it was; the termination is [`Termination::Stalled`] then.
    pub error: Option<FlattenError>,
}

/// What became of pins.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PinReport {
    /// Which energy moved the other vertices.
    pub energy: Energy,
    /// What it is at the end, of a surface of area 1 in a map as large as the surface.
    pub after: f64,
    /// How many steps it took; none for a similarity.
    pub steps: usize,
    /// Of every pin, in their order, as the precision of the map holds its place. A hard one that is not in its place makes the map [`Termination::Stalled`].
    pub residuals: Vec<PinResidual>,
}

/// A map that was there, relaxed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RelaxedMap {
    /// The map, in the precision asked for. Where vertices of the map given had one place it has one point.
    pub uv: UvMap,
    /// What is proved of it.
    pub certificate: Certificate,
    /// How relaxing ended; of several charts the first end that was not as asked. [`Termination::Stalled`], too, where a
    /// chart stays as it was because it could not be relaxed, or is not valid and has no valid map to start from.
    pub termination: Termination,
    /// The chart of every face, numbered by first appearance.
    pub chart_of_face: Vec<usize>,
    /// What relaxing did to every chart; `None` for one that stays as it was.
    pub charts: Vec<Option<RelaxReport>>,
    /// Why charts could not be relaxed and stay as they were, each with its first face ([`FlattenError::RelaxChart`]).
    pub refused: Vec<FlattenError>,
    /// What became of pins; `None` where there are none, or there was no map or no time for them.
    pub pinned: Option<PinReport>,
}

impl RelaxedMap {
    /// Whether this is what was asked for: a valid map, every chart relaxed.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.certificate.valid() && self.termination.is_as_asked()
    }
}

/// What one solver of the ladder [`SolverKind::Auto`] came to.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RungReport {
    /// Which solver.
    pub solver: SolverKind,
    /// How it ended; `None` when it found nothing.
    pub termination: Option<Termination>,
    /// Passes, iterations or steps.
    pub iterations: usize,
    /// Whether its UVs are valid, as they would be written: [`Certificate::valid`].
    pub valid: bool,
    /// How many triangles are flipped in them.
    pub flips: usize,
    /// How many are collapsed.
    pub collapsed: usize,
    /// Around how many interior vertices they wind twice.
    pub wound: usize,
    /// Their `F / 3nt` ([`Metrics::f`]), rad²; `None` where there was nothing to compare it with, or nothing at all.
    pub f: Option<f64>,
    /// Why it found nothing.
    pub error: Option<FlattenError>,
}

impl RungReport {
    /// Whether the ladder ends here: valid UVs of a solver that ended as asked.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.valid && self.termination.is_some_and(Termination::is_as_asked)
    }
}

/// What the layout did: [`Layout`](abf_reconstruct::Layout) without its UVs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LayoutReport {
    /// The method that was used; never [`LayoutKind::Auto`]. `None` for the descent and HABF++,
    /// whose results are the UVs, and for a flat mesh that is laid out as it lies.
    pub kind: Option<LayoutKind>,
    /// The true relative residual of its linear solve; `None` for the tree.
    pub linear_residual: Option<f64>,
    /// The largest disagreement between the two sides of an edge; `None` where nothing was integrated.
    pub closing_error: Option<f64>,
    /// How many angles were clamped to the open interval (0, π) to be laid out.
    pub clamped_angles: usize,
    /// Whether the first pin is at the origin and the second on the positive x-axis. Only the UVs of the descent may
    /// stand elsewhere: where moving or turning them would round triangles over, they stay.
    pub pinned: bool,
    /// Whether the scale is the one asked for: the area of the surface, or the unit square. Only the UVs of the descent
    /// may have another, the nearest power of two, where doubles hold them at no scale but such a one.
    pub scaled: bool,
}

impl LayoutReport {
    /// Of UVs that were found without a layout.
    pub(crate) fn placed(pinned: bool, scaled: bool) -> Self {
        Self { kind: None, linear_residual: None, closing_error: None, clamped_angles: 0, pinned, scaled }
    }
}

impl Flattening {
    /// Whether this is what was asked for: valid UVs of a solver that ended as asked.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.certificate.valid() && self.termination.is_as_asked()
    }

    /// Distortion, measured on the UVs, with their certificate.
    ///
    /// # Errors
    /// [`MetricsError`] when `mesh` is not the mesh that was flattened.
    pub fn metrics(&self, mesh: &TriMesh) -> Result<Metrics, MetricsError> {
        measure_certified(mesh, &self.uv, self.certificate.clone())
    }
}
