//! Every setting of a flattening.

use crate::settings::{Injective, Solver, ZeroArea};
use abf_constraints::{Boundary, GuessSettings};
use abf_control::StopCriteria;
use abf_embed::{Pins, Relax};
use abf_metrics::Precision;
use abf_reconstruct::LayoutSettings;

/// Every setting of a flattening. The default is what [`flatten`](crate::flatten) does.
///
/// Settings that concern one solver are in the [`Solver`].
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Pipeline {
    /// Which method, with its settings.
    pub solver: Solver,
    /// What becomes of faces without area.
    pub zero_area: ZeroArea,
    /// What the boundary is to look like. [`Solver::LinAbf`] and [`Solver::Barrier`] keep it, and [`Solver::Auto`] tries
    /// these two then; other solvers refuse it, and so does [`Unwrap`](crate::Unwrap): it is for one disk, uncut.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Boundary::is_free"))]
    pub boundary: Boundary,
    /// How the initial guess is made from the angles of the surface.
    pub initial_guess: GuessSettings,
    /// When the solver stops. A time limit is one for all solvers of [`Solver::Auto`] together; the number of
    /// iterations is one for each.
    pub stop: StopCriteria,
    /// How angles become coordinates. [`Solver::Lscm`] takes the two least squares kinds, and
    /// reads [`LayoutKind::Auto`](abf_reconstruct::LayoutKind::Auto) as the weighted one, which is LSCM proper.
    /// [`Solver::Descent`] lays out nothing.
    pub layout: LayoutSettings,
    /// Relax the map of the solver, or of [`Unwrap`](crate::Unwrap) each chart, until an energy over the positions is least;
    /// `None`: it stays as it is.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub relax: Option<Relax>,
    /// Vertices that are to be in given places, after the solver and relaxing: one or two by a similarity, more by moving the
    /// others with [`Pipeline::relax`], or with its default settings. Neither [`Unwrap`](crate::Unwrap), a rule for the
    /// boundary nor [`Pipeline::normalize`] goes with them.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub pins: Option<Pins>,
    /// What becomes of a map that lies over itself, after the solver and relaxing. Neither pins nor a rule for the boundary go
    /// with a rule other than [`Injective::Off`].
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Injective::is_off"))]
    pub injective: Injective,
    /// With [`Injective::Deform`] the smallest distance of a boundary vertex and a boundary edge, in the units of the mesh: UVs
    /// have the area of the surface. Less is enough where the two are near along the boundary: a quarter of their way. It does
    /// not go with [`Pipeline::normalize`]. What packing leaves between charts is another matter.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "is_zero"))]
    pub boundary_gap: f64,
    /// Scale the UVs into the unit square instead of giving them the area of the surface.
    pub normalize: bool,
    /// What the UVs will be stored in: they are rounded to it, and certified as that.
    pub precision: Precision,
    /// Refuse meshes for which [`predict_memory`](crate::predict_memory) says more bytes than this; `None`: no limit
    /// but that of the system, which may end the program. [`Solver::Auto`] leaves out the rungs that would take more.
    pub max_memory: Option<u64>,
}

#[cfg(feature = "serde")]
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(length: &f64) -> bool {
    *length == 0.0
}
