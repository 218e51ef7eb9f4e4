//! The settings of a run, as they are in the JSON.

use super::accuracy::InnerAccuracy;
use super::{number_or_text, text};
use abf::{Hessian, LayoutKind, LineSearch, Passes, Pipeline, PreconditionerKind, Reduction, WheelForm, ZeroArea};
use serde::{Deserialize, Serialize};

/// The settings. What does not concern the solver is `None`, but for those every run has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Asked {
    /// A number or `"auto"`.
    #[serde(with = "number_or_text")]
    pub(crate) passes: Option<Passes>,
    /// The form of the wheel condition.
    #[serde(with = "text::optional")]
    pub(crate) wheel: Option<WheelForm>,
    /// The second derivatives.
    #[serde(with = "text::optional")]
    pub(crate) hessian: Option<Hessian>,
    /// How the length of a step is chosen.
    #[serde(with = "text::optional")]
    pub(crate) line_search: Option<LineSearch>,
    /// What the inner method iterates on.
    #[serde(with = "text::optional")]
    pub(crate) reduction: Option<Reduction>,
    /// Its preconditioner.
    #[serde(with = "text::optional")]
    pub(crate) preconditioner: Option<PreconditionerKind>,
    /// Its iterations in one outer iteration.
    pub(crate) max_inner_iterations: Option<usize>,
    /// Relative; a number or `"auto"`.
    #[serde(with = "number_or_text")]
    pub(crate) inner_tolerance: Option<InnerAccuracy>,
    /// The last weight of the descent's barrier, in units of energy per corner.
    pub(crate) barrier_floor: Option<f64>,
    /// Which layout; `auto` where the program may choose.
    #[serde(with = "text")]
    pub(crate) layout: LayoutKind,
    /// Radians; `None` for off.
    pub(crate) ring_switch: Option<f64>,
    /// Radians.
    pub(crate) angle_bound: f64,
    /// Radians.
    pub(crate) tolerance: f64,
    /// Outer iterations; passes with `auto`.
    pub(crate) max_iterations: usize,
    /// Seconds; `None` for no limit.
    pub(crate) time_limit_s: Option<f64>,
    /// What becomes of faces without area.
    #[serde(with = "text")]
    pub(crate) zero_area: ZeroArea,
    /// Whether the UVs are scaled into the unit square.
    pub(crate) normalize: bool,
    /// Threads in use.
    pub(crate) threads: usize,
}

impl Asked {
    /// The settings of a pipeline.
    pub(crate) fn new(pipeline: &Pipeline) -> Self {
        let solver = &pipeline.solver;
        let (newton, iterative) = (solver.newton_settings(), solver.iterative_settings());
        Self {
            passes: solver.passes(),
            wheel: newton.map(|newton| newton.wheel),
            hessian: newton.map(|newton| newton.hessian),
            line_search: newton.map(|newton| newton.line_search),
            reduction: iterative.map(|iterative| iterative.reduction),
            preconditioner: iterative.map(|iterative| iterative.preconditioner),
            max_inner_iterations: iterative.map(|iterative| iterative.max_inner_iterations),
            inner_tolerance: iterative.and(newton).map(|newton| InnerAccuracy(newton.inner_tolerance)),
            barrier_floor: solver.barrier_floor(),
            layout: pipeline.layout.kind,
            ring_switch: pipeline.estimate.ring_switch,
            angle_bound: pipeline.estimate.angle_bound,
            tolerance: pipeline.stop.tolerance,
            max_iterations: pipeline.stop.max_iterations,
            time_limit_s: pipeline.stop.time_limit.map(|limit| limit.as_secs_f64()),
            zero_area: pipeline.zero_area,
            normalize: pipeline.normalize,
            threads: rayon::current_num_threads(),
        }
    }
}
