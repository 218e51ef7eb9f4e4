//! The command line as it is typed.

mod boundary;
mod charts;
mod method;
mod packing;
mod sheet;

use abf::{SolverKind, Weld};
use abf_mesh::io::MeshFormat;
use abf_shapes::Shape;
pub(crate) use boundary::BoundaryRule;
pub(crate) use charts::{ChartArgs, InnerMargin, SeamsFrom};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, value_parser};
use method::MOST_THREADS;
pub(crate) use method::{MethodArgs, SolverChoice, names};
pub(crate) use packing::{Margin, PackArgs, PackingArgs, PageSize};
pub(crate) use sheet::{ModelUnit, SheetArgs};
use std::path::PathBuf;

/// The names of the commands besides flattening.
pub(crate) const COMMANDS: [&str; 6] = ["compare", "survey", "metrics", "pack", "sparsity", "fixtures"];

const COMPARE: &str = "\
Every file is written anew after every mesh, so that stopping half-way keeps what is done.
The solver's options are those of flattening; each applies to the solvers it concerns.

Exit codes:
  0  every mesh compared
  1  cancelled
  2  a mesh that cannot be used, a file that cannot be written, unusable usage";

const SURVEY: &str = "\
Every finished mesh is appended to FILE.partial, and FILE is written whole at the end or after Ctrl-C. With
--resume, meshes in either are not done again if name, size, time of change and settings agree.

Exit codes:
  0  every mesh has a valid map
  1  some have not, or were refused, or it was cancelled; what is done is written
  2  no mesh at all, a file that cannot be written, unusable usage";

const PACK: &str = "\
Islands keep their shape and all are scaled alike. Those that lie over each other stay together.
A unit of --texels-per-unit is one of the UVs as they are: with the side of their page, islands keep their size.

Exit codes:
  0  packed, and valid
  1  packed, but the UVs were not valid before, and are not now
  2  no UVs, no room, a file that cannot be written, unusable usage";

/// Flatten triangle meshes and say how good, how valid and how fast it was.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true, allow_negative_numbers = true, max_term_width = 100)]
pub(crate) struct Args {
    /// Something else than flattening.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Print a completion script for a shell, or a manual page
    #[arg(long, value_name = "WHAT", exclusive = true, hide_short_help = true)]
    pub(crate) generate: Option<Generated>,
    /// How to flatten.
    #[command(flatten)]
    pub(crate) flatten: FlattenArgs,
}

/// What the program prints of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Generated {
    /// Completion for bash
    CompleteBash,
    /// Completion for zsh
    CompleteZsh,
    /// Completion for fish
    CompleteFish,
    /// A manual page
    Man,
}

impl Args {
    /// How many threads to use, if that was said.
    pub(crate) fn threads(&self) -> Option<u16> {
        match &self.command {
            None => self.flatten.method.threads,
            Some(Command::Compare(args)) => args.method.threads,
            Some(Command::Survey(args)) => args.method.threads,
            Some(Command::Pack(args)) => args.threads,
            Some(Command::Metrics(_) | Command::Sparsity(_) | Command::Fixtures(_)) => None,
        }
    }
}

/// What there is to do besides flattening.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Flatten many meshes with many solvers, several times each, and write tables
    #[command(after_help = COMPARE)]
    Compare(Box<CompareArgs>),
    /// Flatten every mesh of a folder with one solver, several at a time, and count how it went
    #[command(after_help = SURVEY)]
    Survey(Box<SurveyArgs>),
    /// Judge the UVs that files already have
    #[command(
        after_help = "Exit codes:\n  0  all valid\n  1  a file that is not valid: flipped or collapsed triangles, vertices wound around twice\n  2  unusable input"
    )]
    Metrics(MetricsArgs),
    /// Lay out anew the UV islands that a file has, without flattening
    #[command(after_help = PACK)]
    Pack(Box<PackArgs>),
    /// Count and draw the entries of the KKT matrix of a disk, with the product wheel and with the log wheel
    Sparsity(SparsityArgs),
    /// Write the fixture meshes, or one shape of any size
    Fixtures(FixturesArgs),
}

/// The arguments of flattening.
#[derive(Debug, clap::Args)]
pub(crate) struct FlattenArgs {
    #[arg(value_name = "MESH", help = format!("The meshes: {}. None: the built-in mask of 20 000 triangles", read("or")))]
    pub(crate) meshes: Vec<PathBuf>,
    /// The method: auto (linabf, descent, abf-fixed-target, barrier in turn, until a result is proved valid), linabf, abf,
    /// abf++, abf-newton, abf-fixed-target, uzawa, minres, habf++, hlinabf, barrier, descent or lscm; several with commas, or
    /// all, are compared
    #[arg(long, value_name = "NAME|all", default_value_t)]
    pub(crate) solver: SolverChoice,
    /// Its settings.
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    /// How it becomes charts.
    #[command(flatten)]
    pub(crate) charts: ChartArgs,
    /// How it lies on a sheet.
    #[command(flatten)]
    pub(crate) sheet: SheetArgs,
    #[arg(short, long, value_name = "FILE", help_heading = "Outputs", help = output_help())]
    pub(crate) output: Option<PathBuf>,
    /// Write the results as JSON; with - to stdout, and the table goes to stderr
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) json: Option<PathBuf>,
    /// Write every outer and inner iteration, for plotting: as JSON, or as rows where FILE ends in .csv; with - JSON to
    /// stdout
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs", hide_short_help = true)]
    pub(crate) history: Option<PathBuf>,
    /// Draw the checkered surface next to its layout
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) png: Option<PathBuf>,
    /// Write the errors of every triangle and of its corners: csv (rows), ply (properties of faces) or svg (the layout,
    /// coloured)
    #[arg(long, value_name = "FILE", help_heading = "Outputs", hide_short_help = true)]
    pub(crate) errors: Option<PathBuf>,
    /// Draw all charts side by side in millimetres (--unit says what a unit of the mesh is), outline and edges in layers
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) svg: Option<PathBuf>,
    /// The same for CAD programs: outlines, folds and numbers in the layers CUT, FOLD and LABEL, in millimetres
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) dxf: Option<PathBuf>,
}

/// The arguments of `compare`.
#[derive(Debug, clap::Args)]
pub(crate) struct CompareArgs {
    #[arg(value_name = "DIR|MESH", required = true, help = format!("Meshes, and folders: every {} below them", read("and")))]
    pub(crate) meshes: Vec<PathBuf>,
    /// The methods: names with commas, or all
    #[arg(long, value_name = "NAMES|all", default_value_t = SolverChoice::All)]
    pub(crate) solver: SolverChoice,
    /// Their settings.
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    /// Runs that are not measured, before those that are
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) warmup: usize,
    /// Runs whose median, least and greatest times are shown
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = at_least_one)]
    pub(crate) repeats: usize,
    /// Show what changed since the JSON of an earlier comparison
    #[arg(long, value_name = "FILE")]
    pub(crate) baseline: Option<PathBuf>,
    /// Write the results as JSON; with - to stdout at the end, and the tables go to stderr
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) json: Option<PathBuf>,
    /// Write the results as a Markdown table; with - to stdout at the end
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) markdown: Option<PathBuf>,
    /// Write the results as comma-separated values; with - to stdout at the end
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) csv: Option<PathBuf>,
    /// Write every outer and inner iteration of the first measured run of each, for plotting: as JSON, or as rows where
    /// FILE ends in .csv; with - JSON to stdout at the end
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) history: Option<PathBuf>,
    /// Write a page with pictures, curves and tables: one HTML file that needs nothing else
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) report: Option<PathBuf>,
    /// Write every chart of the page as an SVG file of its own into DIR
    #[arg(long, value_name = "DIR", help_heading = "Outputs")]
    pub(crate) plots: Option<PathBuf>,
    /// Which results of a mesh the page names the lowest F of: valid ones, or injective ones, which do not overlap
    /// themselves either
    #[arg(
        long,
        value_name = "valid|injective",
        help_heading = "Outputs",
        requires = "report",
        default_value_t,
        value_enum,
        hide_possible_values = true
    )]
    pub(crate) lowest: Lowest,
}

/// Which results the lowest F of a mesh is looked for among.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Lowest {
    /// Those without a flipped or collapsed triangle and without a vertex wound around twice
    #[default]
    Valid,
    /// Those of them that do not overlap themselves
    Injective,
}

/// The arguments of `survey`.
#[derive(Debug, clap::Args)]
pub(crate) struct SurveyArgs {
    #[arg(value_name = "DIR|MESH", required = true, help = format!("Folders: every {} below them; and meshes", read("and")))]
    pub(crate) meshes: Vec<PathBuf>,
    /// Leave out the folders inside the folders
    #[arg(long)]
    pub(crate) flat: bool,
    /// The method
    #[arg(long, value_name = "NAME", default_value_t)]
    pub(crate) solver: SolverKind,
    /// Its settings.
    #[command(flatten)]
    pub(crate) method: MethodArgs,
    /// Refuse meshes that are no disks, instead of making charts of them
    #[arg(long)]
    pub(crate) disks_only: bool,
    /// How many meshes at a time; the results are the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=MOST_THREADS))]
    pub(crate) jobs: Option<u16>,
    /// Go on with the results that are in --json FILE, and in FILE.partial
    #[arg(long)]
    pub(crate) resume: bool,
    /// Write the results as JSON; with - to stdout, and the tables go to stderr
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) json: Option<PathBuf>,
}

/// The arguments of `metrics`.
#[derive(Debug, clap::Args)]
pub(crate) struct MetricsArgs {
    #[arg(value_name = "FILE", required = true, help = format!("Files with UVs: {}", MeshFormat::list(MeshFormat::has_uvs, " or ")))]
    pub(crate) files: Vec<PathBuf>,
    /// Judge the faces as the file has them, without the repair that flattening makes first
    #[arg(long)]
    pub(crate) as_stored: bool,
    /// Which vertices in one place that repair joins: as the option of flattening [default: auto]
    #[arg(long, value_name = "auto|off|DISTANCE", allow_negative_numbers = true, conflicts_with = "as_stored")]
    pub(crate) weld: Option<Weld>,
    /// Texels of the page along x and y, where it is no square: figures are those of texels, as when it was packed so
    #[arg(long, value_name = "WxH")]
    pub(crate) page: Option<PageSize>,
    /// Judge the UVs of set N of a glTF [default: the set that this program wrote last, else 0]
    #[arg(long, value_name = "N")]
    pub(crate) uv_set: Option<u32>,
    /// Write the results as JSON; with - to stdout, and the table goes to stderr
    #[arg(long, value_name = "FILE|-")]
    pub(crate) json: Option<PathBuf>,
}

/// The arguments of `sparsity`.
#[derive(Debug, clap::Args)]
pub(crate) struct SparsityArgs {
    #[arg(value_name = "MESH", help = format!("A disk: {}", read("or")))]
    pub(crate) mesh: PathBuf,
    /// Draw both matrices side by side, a pixel dark where one of its entries is
    #[arg(long, value_name = "FILE")]
    pub(crate) png: Option<PathBuf>,
    /// Draw both with their numbers of entries
    #[arg(long, value_name = "FILE")]
    pub(crate) svg: Option<PathBuf>,
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

fn shapes() -> impl TypedValueParser<Value = Shape> {
    let value = |shape: Shape| PossibleValue::new(shape.name()).help(shape.description());
    PossibleValuesParser::new(Shape::ALL.map(value)).try_map(|name| name.parse::<Shape>())
}

fn at_least_one(s: &str) -> Result<usize, String> {
    s.parse().ok().filter(|&n| n > 0).ok_or_else(|| format!("must be a whole number, at least 1, got '{s}'"))
}

/// The formats of input, the last one after `word`.
fn read(word: &str) -> String {
    MeshFormat::list(|_| true, &format!(" {word} "))
}

fn output_help() -> String {
    let written = MeshFormat::list(MeshFormat::is_written, " or ");
    format!("Write the mesh with its UVs: {written}; an obj or glTF input is kept as it was but for them")
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
        let (stop, initial_guess) = (abf::StopCriteria::default(), abf::GuessSettings::default());
        let iterative = abf::IterativeSettings::default();
        for text in [
            format!("{:e}", stop.tolerance),
            stop.max_iterations.to_string(),
            initial_guess.angle_bound.to_string(),
            initial_guess.ring_switch.expect("on").to_string(),
            abf::Passes::default().to_string(),
            abf::LineSearch::default().to_string(),
            iterative.reduction.to_string(),
            iterative.preconditioner.to_string(),
            iterative.max_inner_iterations.to_string(),
            abf::Descent::default().barrier_floor.to_string(),
            abf::Unwrap::default().max_stretch.to_string(),
            abf::Atlas::default().page[0].to_string(),
            abf::Atlas::default().margin.to_string(),
        ] {
            assert!(help.contains(&format!("[default: {text}]")), "{text}: {help}");
        }
    }

    #[test]
    fn the_help_names_every_solver() {
        let mut command = Args::command();
        let argument = command.get_arguments().find(|argument| argument.get_id() == "solver").expect("--solver");
        let help = argument.get_help().expect("help").to_string();
        let words: Vec<&str> = help.split([' ', ',', ';', '\n']).collect();
        assert!(names(&SolverKind::ALL).iter().all(|name| words.contains(name)), "{help}");
        command.build();
    }
}
