//! The command line as it is typed.

use abf::{LayoutKind, Passes, SolverKind};
use abf_shapes::Shape;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, value_parser};
use std::path::PathBuf;
use std::str::FromStr;

/// More threads than any machine this was tried on has cores; some systems die of many more.
const MOST_THREADS: i64 = 1024;

const EXIT_CODES: &str = "\
Exit codes:
  0  finished as asked, no flipped and no collapsed triangle
  1  finished, but not converged, or with flipped or collapsed triangles, or cancelled
  2  unusable input or usage, or a file that cannot be written
Of several meshes the worst counts.";

/// Flatten triangle meshes and say how good, how valid and how fast it was.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true, after_help = EXIT_CODES)]
pub(crate) struct Args {
    /// Something else than flattening.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// How to flatten.
    #[command(flatten)]
    pub(crate) flatten: FlattenArgs,
}

/// What there is to do besides flattening.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Judge the UVs that files already have
    #[command(after_help = "Exit codes:\n  0  all valid\n  1  flipped or collapsed triangles\n  2  unusable input")]
    Metrics(MetricsArgs),
    /// Write the fixture meshes, or one shape of any size
    Fixtures(FixturesArgs),
}

/// The arguments of flattening.
#[derive(Debug, clap::Args)]
pub(crate) struct FlattenArgs {
    /// The meshes: obj, off, ply or stl. None: the built-in face of 20 000 triangles
    #[arg(value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    /// The method
    #[arg(long, value_name = "NAME", default_value_t, value_parser = solvers())]
    pub(crate) solver: SolverKind,
    /// How many passes linabf makes: a number, or auto: until the constraints are met
    #[arg(long, value_name = "N|auto", default_value_t)]
    pub(crate) passes: Passes,
    /// How angles become coordinates; auto is the tree when the angles close, else least squares
    #[arg(long, value_name = "KIND", default_value_t, value_parser = layouts())]
    pub(crate) layout: LayoutKind,
    /// Start rings whose angle deficit is above T rad from their target angles; off: none
    #[arg(long, value_name = "T|off", default_value_t)]
    pub(crate) ring_switch: RingSwitch,
    /// A pass starts from angles of at least B and at most π − B, rad [default: 0.001]
    #[arg(long, value_name = "B")]
    pub(crate) angle_bound: Option<f64>,
    /// Converged means a constraint residual of at most T, rad [default: 1e-8]
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
    /// At most N passes with --passes auto [default: 50]
    #[arg(long, value_name = "N")]
    pub(crate) max_iterations: Option<usize>,
    /// Stop the solver after so long and lay out what it has
    #[arg(long, value_name = "SECONDS")]
    pub(crate) time_limit: Option<f64>,
    /// Scale the UVs into the unit square; otherwise they have the area of the surface
    #[arg(long)]
    pub(crate) normalize: bool,
    /// How many threads to use; the results are the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=MOST_THREADS))]
    pub(crate) threads: Option<u16>,
    /// Write the mesh with its UVs: obj or ply
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Write the results as JSON; with - to stdout, and the table goes to stderr
    #[arg(long, value_name = "FILE|-")]
    pub(crate) json: Option<PathBuf>,
    /// Draw the checkered surface next to its layout
    #[arg(long, value_name = "FILE")]
    pub(crate) png: Option<PathBuf>,
}

/// The arguments of `metrics`.
#[derive(Debug, clap::Args)]
pub(crate) struct MetricsArgs {
    /// Files with UVs: obj, off or ply
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Write the results as JSON; with - to stdout, and the table goes to stderr
    #[arg(long, value_name = "FILE|-")]
    pub(crate) json: Option<PathBuf>,
}

/// The arguments of `fixtures`.
#[derive(Debug, clap::Args)]
pub(crate) struct FixturesArgs {
    /// Where to write all fixtures, NAME.obj each
    #[arg(value_name = "DIR", required_unless_present = "shape", conflicts_with = "shape")]
    pub(crate) dir: Option<PathBuf>,
    /// Write this shape only
    #[arg(long, value_name = "NAME", requires = "output", value_parser = shapes())]
    pub(crate) shape: Option<Shape>,
    /// About how many triangles the shape gets
    #[arg(long, value_name = "N", default_value_t = 20_000, requires = "shape")]
    pub(crate) triangles: usize,
    /// Where to write the shape: obj or ply
    #[arg(short, long, value_name = "FILE", requires = "shape")]
    pub(crate) output: Option<PathBuf>,
}

/// A threshold, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingSwitch(
    /// `None` for "off".
    pub(crate) Option<f64>,
);

impl Default for RingSwitch {
    fn default() -> Self {
        Self(abf::EstimateSettings::default().ring_switch)
    }
}

impl std::fmt::Display for RingSwitch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            Some(threshold) => threshold.fmt(f),
            None => f.write_str("off"),
        }
    }
}

impl FromStr for RingSwitch {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        if s == "off" {
            return Ok(Self(None));
        }
        s.parse().map(|threshold| Self(Some(threshold))).map_err(|_| format!("must be a number or 'off', got '{s}'"))
    }
}

/// A parser that takes exactly these names and lists them when it gets another.
fn one_of<T, const N: usize>(names: [&'static str; N]) -> impl TypedValueParser<Value = T>
where
    T: FromStr + Clone + Send + Sync + 'static,
    T::Err: Into<Box<dyn std::error::Error + Send + Sync>> + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

fn solvers() -> impl TypedValueParser<Value = SolverKind> {
    one_of(SolverKind::ALL.map(SolverKind::name))
}

fn layouts() -> impl TypedValueParser<Value = LayoutKind> {
    one_of(LayoutKind::ALL.map(LayoutKind::name))
}

fn shapes() -> impl TypedValueParser<Value = Shape> {
    let value = |shape: Shape| PossibleValue::new(shape.name()).help(shape.description());
    PossibleValuesParser::new(Shape::ALL.map(value)).try_map(|name| name.parse::<Shape>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn the_defaults_in_the_help_are_those_of_the_library() {
        let help = Args::command().render_long_help().to_string();
        let stop = abf::StopCriteria::default();
        let bound = abf::EstimateSettings::default().angle_bound;
        for text in [format!("{:e}", stop.tolerance), stop.max_iterations.to_string(), bound.to_string()] {
            assert!(help.contains(&format!("[default: {text}]")), "{text}: {help}");
        }
    }
}
