//! Valid in, valid out: drawings of a disk in which no triangle is ever turned over.
//!
//! The solvers in angle space may end outside (0, π), and their layouts with flips. Here the unknowns are the UVs of
//! the vertices, and every drawing on the way is one in which each triangle is counter-clockwise by an exact predicate:
//!
//! * [`tutte()`]: a first drawing, on a circle (Tutte 1963; mean-value weights: Floater 2003).
//! * [`first_drawing`]: the same, or a progressive embedding where doubles do not hold that one.
//! * [`Descent`]: from there, or from any valid drawing, to the least angle energy with a logarithmic barrier.
//! * [`Relax`]: from any valid drawing to the least of an energy of angles, of lengths, or of angles and areas.
//!
//! | symbol | name here | meaning |
//! | --- | --- | --- |
//! | u | `uv` | the points of the vertices |
//! | x(u) | `angles` | the angles of the drawing, rad |
//! | a, w | `AngleProblem::{target, weight}` | target angles, rad, and `1/a²` |
//! | μ | `barrier` | the weight of the barrier |
//! | E | `objective` | `Σ w (x − a)² − μ Σ [log x + log(π − x)]` |
//! | J | | dx/du |
//! | Λ | | `d²E/dx² = 2w + μ/x² + μ/(π − x)²` |
//! | d, δ | `motion`, `angle_change` | a direction, and what it does to the angles: δ = J d |
//!
//! ```
//! use abf_constraints::{AngleProblem, GuessSettings};
//! use abf_embed::Descent;
//! use abf_mesh::{Topology, UvMap};
//! use abf_shapes::Shape;
//! use abf_control::{Silent, StopCriteria, Termination};
//!
//! let mesh = Shape::SpikyField.mesh(500);
//! let topology = Topology::build(mesh.vertex_count(), mesh.faces())?;
//! let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default())?;
//! let solution = Descent::default().solve(&mesh, &problem, None, &StopCriteria::default(), &mut Silent)?;
//! assert_eq!(solution.termination, Termination::Converged);
//! let uv = UvMap::per_vertex(&mesh, &solution.uv);
//! # assert!(uv.signed_area() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Where things are: `tutte.rs` the embedding · `progressive.rs` one for meshes that have none in doubles · `descend.rs` the loop, settings and result · `objective.rs` E and its
//! derivatives by the angles · `newton.rs` a direction · `retract.rs` steps that turn and scale · `line_search.rs` how
//! far · `relax/` energies of positions and their steps · `place.rs` where a drawing lies · `plane.rs` one triangle · `system.rs` matrices over faces.

mod descend;
mod drawn;
mod line_search;
mod newton;
mod objective;
mod place;
mod plane;
mod progressive;
mod relax;
mod retract;
mod system;
mod tutte;

use abf_control::{Cancelled, SettingError, Termination};
use abf_linalg::LinearError;
use abf_mesh::{DiskError, FaceId};
pub use descend::{Descent, DescentRecord, DescentSolution};
pub use line_search::StepKind;
pub use place::vertex_points;
pub use progressive::{FirstDrawing, first_drawing};
pub use relax::{
    Energy, InjectiveDrawing, Pin, PinError, PinFault, PinResidual, PinWeight, PinnedDrawing, Pins, Relax, RelaxStep,
    RelaxedDrawing, boundary_gap, check_gap,
};
pub use tutte::{BoundarySpacing, TutteEmbedding, TutteWeights, tutte};

/// Why there is no embedding.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EmbedError {
    /// Only disks have one.
    #[error(transparent)]
    NotADisk(#[from] DiskError),
    /// Doubles do not hold Tutte's embedding of this mesh.
    #[error("Tutte's embedding turns face {face} over in double precision ({count} in all)")]
    TutteFlipped {
        /// The first such face.
        face: FaceId,
        /// How many there are.
        count: usize,
    },
    /// The start of the descent is not a drawing.
    #[error("face {face} of the start is not counter-clockwise ({count} in all)")]
    StartFlipped {
        /// The first such face.
        face: FaceId,
        /// How many there are.
        count: usize,
    },
    /// There must be one point for every vertex.
    #[error("{given} points for {vertices} vertices")]
    PointCount {
        /// How many points were given.
        given: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// Doubles do not hold the boundary of Tutte's embedding apart.
    #[error("the boundary of Tutte's embedding meets itself in double precision: merge or remove its shortest edges")]
    BoundaryTooCrowded,
    /// Pins that no drawing of the mesh can have.
    #[error(transparent)]
    Pins(#[from] PinError),
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// There is no drawing yet to stop with.
    #[error("{} before there was a first drawing", if *.0 == Termination::Cancelled { "cancelled" } else { "out of time" })]
    Interrupted(
        /// What interrupted it.
        Termination,
    ),
    /// The observer aborted it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A linear system could not be solved.
    #[error("a linear system of the embedding has no usable solution")]
    Linear(#[source] LinearError),
}

impl From<LinearError> for EmbedError {
    fn from(error: LinearError) -> Self {
        match error {
            LinearError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Linear(other),
        }
    }
}
