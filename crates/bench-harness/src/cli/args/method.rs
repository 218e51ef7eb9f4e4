//! The options of the solvers, and the values they take.

use super::BoundaryRule;
use crate::record::InnerAccuracy;
use crate::record::misread::Misread;
use abf::{
    Energy, Hessian, Injective, LayoutKind, LineSearch, Passes, PreconditionerKind, Reduction, SolverKind, UnknownName,
    WheelForm, ZeroArea,
};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::value_parser;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// More threads than any machine this was tried on has cores; some systems die of many more.
pub(super) const MOST_THREADS: i64 = 1024;

/// Every solver at once.
const ALL: &str = "all";
/// A threshold that is none.
const OFF: &str = "off";

const BOUNDARY: &str = "Options of auto, linabf, barrier";
const PASSES: &str = "Options of auto, linabf";
const ERRORS: &str = "Options of linabf";
const BARRIER: &str = "Options of auto, barrier, descent";
const CONSTRAINTS: &str = "Options of every solver but descent and lscm";
const ANGLES: &str = "Options of every solver but lscm";
const NEWTON: &str = "Options of abf, abf++, abf-newton, abf-fixed-target, uzawa, minres";
const ITERATIVE: &str = "Options of uzawa, minres";

/// How to flatten: what every command that flattens takes, besides the solver's name.
///
/// What was not given is `None`, so that an option that means nothing to a solver can be refused.
#[derive(Debug, clap::Args)]
pub(crate) struct MethodArgs {
    /// How angles become coordinates; auto is the tree when the angles close, else least squares
    #[arg(long, hide_short_help = true, value_name = "KIND", default_value_t, value_parser = one_of::<LayoutKind, _>(LayoutKind::ALL.map(LayoutKind::name)))]
    pub(crate) layout: LayoutKind,
    /// Relax the map, or each chart, until an energy is least: abf (angles), isometric (lengths), usable (angles, and areas
    /// within bounds) or THETA, the weight of areas beside angles; usable is 0.01. Not with --boundary
    #[arg(long, value_name = "abf|isometric|usable|THETA", allow_negative_numbers = true)]
    pub(crate) energy: Option<Energy>,
    /// Bring vertices of a disk to given places: FILE has a vertex, counted from 0, and its U and V on each line, and
    /// 'soft W' after it where the place need not be met. More than two: with --energy, or isometric
    #[arg(long, hide_short_help = true, value_name = "FILE")]
    pub(crate) pins: Option<PathBuf>,
    /// What becomes of a map that lies over itself: off leaves it, split parts it along the overlap, deform makes it anew
    /// without overlaps, which takes many times as long. Not with --pins or --boundary
    #[arg(long, hide_short_help = true, value_name = "off|split|deform", default_value_t, value_parser = one_of::<Injective, _>(["off", "split", "deform"]))]
    pub(crate) injective: Injective,
    /// With --injective deform, keep parts of the boundary of a chart this far from each other, in units of the mesh [default: 0]
    #[arg(long, hide_short_help = true, value_name = "LENGTH", allow_negative_numbers = true)]
    pub(crate) boundary_gap: Option<f64>,
    /// Scale the UVs into the unit square; otherwise they have the area of the surface, and charts are in it anyway
    #[arg(long)]
    pub(crate) normalize: bool,
    /// What becomes of faces without area: they get a place like all others, or are refused
    #[arg(long, hide_short_help = true, value_name = "carry|refuse", default_value_t, value_parser = one_of::<ZeroArea, _>(["carry", "refuse"]))]
    pub(crate) zero_area: ZeroArea,
    /// How many threads to use; the results are the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=MOST_THREADS))]
    pub(crate) threads: Option<u16>,

    /// Refuse meshes that would take more than SIZE, such as 500M or 4G; predicted, with K, M, G and T for
    /// thousands, millions and so on of bytes [default: no limit]
    #[arg(long, value_name = "SIZE")]
    pub(crate) max_memory: Option<MemorySize>,

    /// Start rings whose angle deficit is above T rad from their target angles; off: none [default: 1]
    #[arg(long, hide_short_help = true, value_name = "T|off", help_heading = CONSTRAINTS)]
    pub(crate) ring_switch: Option<RingSwitch>,
    /// Start, and every pass of linabf again, from angles of at least B and at most π − B, rad [default: 0.001; charts that are cut: 0.0001]
    #[arg(long, hide_short_help = true, value_name = "B", help_heading = CONSTRAINTS)]
    pub(crate) angle_bound: Option<f64>,
    /// Converged means a constraint residual of at most T, rad [default: 1e-8]
    #[arg(long, hide_short_help = true, value_name = "T", help_heading = CONSTRAINTS)]
    pub(crate) tolerance: Option<f64>,
    /// At most N outer iterations; of linabf passes, with --passes auto; of auto each rung [default: 50]
    #[arg(long, hide_short_help = true, value_name = "N", help_heading = ANGLES)]
    pub(crate) max_iterations: Option<usize>,
    /// Stop after so long, all rungs of auto together, and lay out what there is
    #[arg(long, value_name = "SECONDS", help_heading = ANGLES)]
    pub(crate) time_limit: Option<f64>,

    /// What the boundary is to be: free, convex, below-2pi[=EPS], rectangle[=v0,v1,v2,v3], circle or angles=FILE
    /// [default: free]
    ///
    /// Vertices are counted from 0, angles are in rad. below-2pi keeps every angle of the boundary EPS below 2π (0.01).
    /// A rectangle finds its corners itself where they are not named. FILE has a vertex and its angle on each line.
    /// What it goes with:
    /// * one disk, uncut, to OBJ or PLY: yes
    /// * holes, handles, several parts, an atlas, a glTF: no
    /// * auto: yes, by linabf, then barrier
    /// * linabf, barrier: yes
    /// * linabf with --error-bound, all other solvers: no
    #[arg(long, hide_short_help = true, value_name = "RULE", help_heading = BOUNDARY, verbatim_doc_comment)]
    pub(crate) boundary: Option<BoundaryRule>,

    /// How many passes to make: a number, or auto: until the constraints are met [default: auto]
    #[arg(long, hide_short_help = true, value_name = "N|auto", help_heading = PASSES)]
    pub(crate) passes: Option<Passes>,

    /// No angle moves in a pass by more than this part of its way to 0 or π, in (0, 1) [default: no bound]
    #[arg(long, hide_short_help = true, value_name = "B", help_heading = ERRORS)]
    pub(crate) error_bound: Option<f64>,

    /// The last weight of the barrier that keeps triangles usable, in units of energy per corner [default: 0.001]
    #[arg(long, hide_short_help = true, value_name = "M", help_heading = BARRIER)]
    pub(crate) barrier_floor: Option<f64>,

    /// The form of the wheel condition [default: product for abf and abf++, else log]
    #[arg(long, hide_short_help = true, value_name = "FORM", help_heading = NEWTON, value_parser = one_of::<WheelForm, _>(["product", "log"]))]
    pub(crate) wheel: Option<WheelForm>,
    /// The second derivatives [default: gauss-newton for abf++ and abf-fixed-target, else exact]
    #[arg(long, hide_short_help = true, value_name = "KIND", help_heading = NEWTON, value_parser = one_of::<Hessian, _>(["exact", "gauss-newton"]))]
    pub(crate) hessian: Option<Hessian>,
    /// Shorten steps until a merit function falls, or take them in full [default: merit]
    #[arg(long, hide_short_help = true, value_name = "KIND", help_heading = NEWTON, value_parser = one_of::<LineSearch, _>(["merit", "full"]))]
    pub(crate) line_search: Option<LineSearch>,

    /// Which unknowns are eliminated first; none as published in 2004 [default: triangles]
    #[arg(long, hide_short_help = true, value_name = "ROWS", help_heading = ITERATIVE, value_parser = one_of::<Reduction, _>(["none", "triangles"]))]
    pub(crate) reduction: Option<Reduction>,
    /// The preconditioner; none as published in 2004 [default: block]
    #[arg(long, hide_short_help = true, value_name = "KIND", help_heading = ITERATIVE, value_parser = one_of::<PreconditionerKind, _>(["none", "jacobi", "block"]))]
    pub(crate) preconditioner: Option<PreconditionerKind>,
    /// At most N inner iterations in an outer one [default: 20000]
    #[arg(long, hide_short_help = true, value_name = "N", help_heading = ITERATIVE)]
    pub(crate) max_inner_iterations: Option<usize>,
    /// Solve to this relative residual; auto follows the constraint residual [default: auto]
    #[arg(long, hide_short_help = true, value_name = "T|auto", help_heading = ITERATIVE)]
    pub(crate) inner_tolerance: Option<InnerAccuracy>,
}

/// Which solvers are asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum SolverChoice {
    /// All there are.
    All,
    /// These, in this order; at least one.
    Named(Vec<SolverKind>),
}

impl SolverChoice {
    /// The solvers, in order.
    pub(crate) fn kinds(&self) -> Vec<SolverKind> {
        match self {
            Self::All => SolverKind::ALL.to_vec(),
            Self::Named(kinds) => kinds.clone(),
        }
    }
}

impl Default for SolverChoice {
    fn default() -> Self {
        Self::Named(vec![SolverKind::default()])
    }
}

impl fmt::Display for SolverChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::All => f.write_str(ALL),
            Self::Named(kinds) => f.write_str(&names(kinds).join(",")),
        }
    }
}

/// Names that make no choice of solvers.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum SolverChoiceError {
    /// A name of no solver.
    #[error("{0}, {ALL}")]
    Unknown(#[from] UnknownName),
    /// A solver that is there already.
    #[error("'{0}' is named twice")]
    Twice(String),
}

impl FromStr for SolverChoice {
    type Err = SolverChoiceError;

    fn from_str(s: &str) -> Result<Self, SolverChoiceError> {
        if s == ALL {
            return Ok(Self::All);
        }
        let mut kinds = Vec::new();
        for name in s.split(',') {
            let kind: SolverKind = name.parse()?;
            if kinds.contains(&kind) {
                return Err(SolverChoiceError::Twice(name.to_owned()));
            }
            kinds.push(kind);
        }
        Ok(Self::Named(kinds))
    }
}

/// The names of solvers.
pub(crate) fn names(kinds: &[SolverKind]) -> Vec<&'static str> {
    kinds.iter().map(|kind| kind.name()).collect()
}

/// A threshold, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingSwitch(
    /// `None` for "off".
    pub(crate) Option<f64>,
);

impl FromStr for RingSwitch {
    type Err = Misread;

    fn from_str(s: &str) -> Result<Self, Misread> {
        if s == OFF {
            return Ok(Self(None));
        }
        s.parse().map(|threshold| Self(Some(threshold))).map_err(|_| Misread::new(format!("a number or '{OFF}'"), s))
    }
}

/// An amount of memory, in bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MemorySize(
    /// Bytes; not zero.
    pub(crate) u64,
);

impl FromStr for MemorySize {
    type Err = Misread;

    fn from_str(s: &str) -> Result<Self, Misread> {
        const UNITS: [(char, f64); 4] = [('k', 1e3), ('m', 1e6), ('g', 1e9), ('t', 1e12)];
        let unit = s.chars().last().map(|c| c.to_ascii_lowercase());
        let scale = UNITS.into_iter().find(|&(letter, _)| unit == Some(letter));
        let (number, scale) = scale.map_or((s, 1.0), |(_, scale)| (&s[..s.len() - 1], scale));
        let bytes = number.parse::<f64>().ok().map(|number| number * scale);
        let bytes = bytes.filter(|&bytes| bytes >= 1.0 && bytes.is_finite());
        bytes.map(|bytes| Self(bytes as u64)).ok_or_else(|| Misread::new("an amount such as 500M or 4G", s))
    }
}

/// A parser that takes exactly these names and lists them when it gets another.
pub(super) fn one_of<T, const N: usize>(names: [&'static str; N]) -> impl TypedValueParser<Value = T>
where
    T: FromStr + Clone + Send + Sync + 'static,
    T::Err: Into<Box<dyn std::error::Error + Send + Sync>> + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solvers_read_back_and_unknown_or_repeated_ones_are_refused() {
        for text in ["all", "linabf", "uzawa,abf++"] {
            assert_eq!(text.parse::<SolverChoice>().expect("solvers").to_string(), text);
        }
        assert!("slim".parse::<SolverChoice>().unwrap_err().to_string().ends_with("lscm, all"));
        assert_eq!("lscm,lscm".parse::<SolverChoice>(), Err(SolverChoiceError::Twice("lscm".to_owned())));
        assert!("".parse::<SolverChoice>().is_err());
    }

    #[test]
    fn amounts_of_memory_have_units() {
        for (text, bytes) in
            [("4G", 4_000_000_000), ("1.5m", 1_500_000), ("20k", 20_000), ("7", 7), ("1T", 1_000_000_000_000)]
        {
            assert_eq!(text.parse(), Ok(MemorySize(bytes)), "{text}");
        }
        for text in ["", "G", "0", "-1G", "4GB", "nan", "inf", "4µ"] {
            assert!(text.parse::<MemorySize>().unwrap_err().to_string().contains("such as 500M"), "{text}");
        }
    }
}
