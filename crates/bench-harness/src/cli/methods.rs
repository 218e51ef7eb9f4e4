//! From the options of the solvers to one pipeline for each solver.

use super::args::{BoundaryRule, MethodArgs, SolverChoice, names};
use super::usage::usage;
use crate::record::NotRun;
use crate::record::failure::chain;
use crate::record::kind::NotRunKind;
use abf::constraints::ProblemError;
use abf::embed::EmbedError;
use abf::mesh::{Point3, TriMesh};
use abf::solve_core::SolveError;
use abf::{
    Boundary, Elsewhere, FlattenError, GuessSettings, Injective, LayoutSettings, LinAbf, Pins, Pipeline, Relax, Solver,
    SolverKind, SolverParts, SolverSettings, StopCriteria,
};
use clap::error::ErrorKind;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Above so many triangles the LU factorisation of the whole matrix takes minutes and gigabytes; who
/// wants to wait for it names the solver.
const MOST_TRIANGLES_OF_ABF: usize = 20_000;

/// One solver with its settings.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    /// How to flatten.
    pub(crate) pipeline: Pipeline,
    /// The file that the angles of the boundary are from.
    pub(crate) angles_file: Option<PathBuf>,
    /// Larger meshes are left out, because nobody asked for this solver by name.
    most_triangles: Option<usize>,
    /// Why it cannot run at all with these settings.
    unsupported: Option<String>,
}

impl Method {
    /// Why this mesh is not given to the solver, if it is not.
    pub(crate) fn not_run(&self, mesh: &TriMesh) -> Option<NotRun> {
        if let Some(message) = &self.unsupported {
            return Some(NotRun { kind: NotRunKind::Settings, message: message.clone() });
        }
        let triangles = mesh.face_count();
        let limit = self.most_triangles.filter(|&limit| triangles > limit)?;
        let solver = self.pipeline.solver.kind();
        let message = format!(
            "the LU factorisation of its nearly {} unknowns takes long; above {limit} triangles it runs only when \
             asked for with --solver {solver}",
            5 * triangles
        );
        Some(NotRun { kind: NotRunKind::TooLarge, message })
    }
}

/// Checks the options and makes one method of each solver.
///
/// # Errors
/// A usage error: an option that concerns none of the solvers, or a setting out of range. Settings
/// that go with some solvers but not with others are an error only where there is one solver.
pub(crate) fn methods(choice: &SolverChoice, args: &MethodArgs) -> Result<Vec<Method>, clap::Error> {
    let kinds = choice.kinds();
    check_concerns(&kinds, args)?;
    let pipeline = pipeline(args)?;
    let method = |&kind: &SolverKind| {
        let pipeline = Pipeline { solver: solver(kind, args), ..pipeline.clone() };
        let is_left_out = kind == SolverKind::Abf && *choice == SolverChoice::All;
        let tried = match pipeline.boundary.is_free() || !bounds_error(&pipeline.solver) {
            true => try_out(&pipeline),
            false => Err(Refusal::Combination(BOUND_AND_BOUNDARY.to_owned())),
        };
        let unsupported = match tried {
            Ok(()) => None,
            Err(Refusal::Combination(message)) if kinds.len() > 1 => Some(message),
            Err(Refusal::Combination(message) | Refusal::Setting(message)) => {
                return Err(usage(ErrorKind::ValueValidation, message));
            }
        };
        let angles_file = args.boundary.as_ref().and_then(BoundaryRule::file).map(Path::to_owned);
        Ok(Method { pipeline, angles_file, most_triangles: is_left_out.then_some(MOST_TRIANGLES_OF_ABF), unsupported })
    };
    kinds.iter().map(method).collect()
}

/// What is said of two options that do not go together.
const BOUND_AND_BOUNDARY: &str = "--error-bound and --boundary do not go together: leave out one of them";

fn bounds_error(solver: &Solver) -> bool {
    matches!(solver, Solver::LinAbf(LinAbf { error_bound: Some(_), .. }))
}

/// An option that concerns some solvers only.
struct Offer {
    name: &'static str,
    is_given: bool,
    concerns: fn(SolverKind) -> bool,
}

/// Every option that concerns some solvers only.
fn offers(args: &MethodArgs) -> [Offer; 16] {
    let of = |concerns: fn(SolverKind) -> bool| move |name, is_given| Offer { name, is_given, concerns };
    let (angles, passes, inner) =
        (of(SolverKind::finds_angles), of(SolverKind::makes_passes), of(SolverKind::iterates_inside));
    let (fixed_target, constrained, barrier) =
        (of(SolverKind::has_a_fixed_target), of(SolverKind::keeps_constraints), of(SolverKind::has_a_barrier));
    [
        constrained("--ring-switch", args.ring_switch.is_some()),
        constrained("--angle-bound", args.angle_bound.is_some()),
        constrained("--tolerance", args.tolerance.is_some()),
        angles("--max-iterations", args.max_iterations.is_some()),
        angles("--time-limit", args.time_limit.is_some()),
        of(SolverKind::keeps_boundary)("--boundary", args.boundary.is_some()),
        passes("--passes", args.passes.is_some()),
        of(SolverKind::bounds_errors)("--error-bound", args.error_bound.is_some()),
        barrier("--barrier-floor", args.barrier_floor.is_some()),
        fixed_target("--wheel", args.wheel.is_some()),
        fixed_target("--hessian", args.hessian.is_some()),
        fixed_target("--line-search", args.line_search.is_some()),
        inner("--reduction", args.reduction.is_some()),
        inner("--preconditioner", args.preconditioner.is_some()),
        inner("--max-inner-iterations", args.max_inner_iterations.is_some()),
        inner("--inner-tolerance", args.inner_tolerance.is_some()),
    ]
}

/// Refuses options that mean nothing to any of the solvers.
fn check_concerns(solvers: &[SolverKind], args: &MethodArgs) -> Result<(), clap::Error> {
    let is_void = |offer: &Offer| offer.is_given && !solvers.iter().any(|&solver| (offer.concerns)(solver));
    let Some(Offer { name, concerns, .. }) = offers(args).into_iter().find(is_void) else { return Ok(()) };
    let concerned: Vec<SolverKind> = SolverKind::ALL.into_iter().filter(|&solver| concerns(solver)).collect();
    let (asked, concerned) = (names(solvers).join(", "), names(&concerned).join(", "));
    let message = format!("{name} means nothing to {asked}: leave it out, or choose from {concerned}");
    Err(usage(ErrorKind::ArgumentConflict, message))
}

/// A solver with the options that concern it.
fn solver(kind: SolverKind, args: &MethodArgs) -> Solver {
    let mut solver = kind.with_defaults().expect("solvers are named on the command line");
    let settings = SolverSettings {
        passes: args.passes,
        error_bound: args.error_bound,
        barrier_floor: args.barrier_floor,
        wheel: args.wheel,
        hessian: args.hessian,
        line_search: args.line_search,
        reduction: args.reduction,
        preconditioner: args.preconditioner,
        max_inner_iterations: args.max_inner_iterations,
        inner_tolerance: args.inner_tolerance.map(|accuracy| accuracy.0),
    };
    settings.give_what_it_has(&mut solver);
    solver
}

/// The settings for all solvers.
fn pipeline(args: &MethodArgs) -> Result<Pipeline, clap::Error> {
    let (initial_guess, stop) = (GuessSettings::default(), StopCriteria::default());
    Ok(Pipeline {
        zero_area: args.zero_area,
        boundary: args.boundary.as_ref().map(boundary).transpose()?.unwrap_or_default(),
        initial_guess: GuessSettings {
            ring_switch: args.ring_switch.map_or(initial_guess.ring_switch, |given| given.0),
            angle_bound: args.angle_bound.unwrap_or(initial_guess.angle_bound),
            ..initial_guess
        },
        stop: StopCriteria {
            tolerance: args.tolerance.unwrap_or(stop.tolerance),
            max_iterations: args.max_iterations.unwrap_or(stop.max_iterations),
            time_limit: args.time_limit.map(seconds).transpose()?,
            ..stop
        },
        layout: LayoutSettings { kind: args.layout, ..LayoutSettings::default() },
        relax: args.energy.map(|energy| Relax { energy, ..Relax::default() }),
        pins: args.pins.as_deref().map(pins).transpose()?,
        injective: args.injective,
        boundary_gap: args.boundary_gap.unwrap_or_default(),
        normalize: args.normalize,
        max_memory: args.max_memory.map(|size| size.0),
        ..Pipeline::default()
    })
}

/// A rule for the boundary; its file is read.
fn boundary(rule: &BoundaryRule) -> Result<Boundary, clap::Error> {
    let path = match rule {
        BoundaryRule::Rule(boundary) => return Ok(boundary.clone()),
        BoundaryRule::File(path) => path,
    };
    let refused = |cause: &dyn fmt::Display| {
        usage(ErrorKind::ValueValidation, format!("--boundary: {}: {cause}", path.display()))
    };
    let text = std::fs::read_to_string(path).map_err(|error| refused(&error))?;
    Boundary::read_angles(&text).map_err(|error| refused(&error))
}

/// Pins from a file.
fn pins(path: &Path) -> Result<Pins, clap::Error> {
    let refused =
        |cause: &dyn fmt::Display| usage(ErrorKind::ValueValidation, format!("--pins: {}: {cause}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| refused(&error))?;
    Pins::read(&text).map_err(|error| refused(&error))
}

fn seconds(limit: f64) -> Result<Duration, clap::Error> {
    let message = || format!("--time-limit must be a number of seconds, at least 0, got {limit}");
    Duration::try_from_secs_f64(limit).map_err(|_| usage(ErrorKind::ValueValidation, message()))
}

/// Why the library does not take settings.
enum Refusal {
    /// One is out of range, whatever the solver.
    Setting(String),
    /// They do not go with this solver.
    Combination(String),
}

/// Asks the library whether it takes these settings, on a mesh of one triangle: its rules are not
/// repeated here, and no file is read in vain.
fn try_out(pipeline: &Pipeline) -> Result<(), Refusal> {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from).to_vec();
    let triangle = TriMesh::new(points, &[[0, 1, 2]]).expect("indices in range");
    // How little memory there is says nothing about the settings, and neither does a boundary that a triangle cannot have.
    let tried = Pipeline { max_memory: None, boundary: Boundary::Free, pins: None, ..pipeline.clone() };
    match pipeline.check().and_then(|()| tried.run(&triangle, &mut abf::Silent)) {
        Ok(_) => Ok(()),
        Err(FlattenError::Solve { source: error @ SolveError::Unsupported(_), .. }) => {
            Err(Refusal::Combination(error.to_string()))
        }
        Err(
            error @ (FlattenError::LscmLayout(_) | FlattenError::DescentLayout(_) | FlattenError::BoundarySolver(_)),
        ) => Err(Refusal::Combination(error.to_string())),
        Err(error) => {
            let said = together(&error).or_else(|| out_of_range(pipeline, &error));
            Err(Refusal::Setting(said.unwrap_or_else(|| chain(&error))))
        }
    }
}

/// Which options do not go together, whatever the solver.
fn together(error: &FlattenError) -> Option<String> {
    let both = |one: String, other: &str| format!("{one} and --{other} do not go together: leave out one of them");
    let option = |other: Elsewhere| match other {
        Elsewhere::Normalize => Some("normalize"),
        Elsewhere::Boundary => Some("boundary"),
        Elsewhere::Pins => Some("pins"),
        _ => None,
    };
    Some(match error {
        FlattenError::GapElsewhere => {
            format!("--boundary-gap needs --injective {}, and does not go with --normalize", Injective::Deform.name())
        }
        FlattenError::InjectiveElsewhere(rule, other) => both(format!("--injective {rule}"), option(*other)?),
        FlattenError::PinsElsewhere(other) => both("--pins".to_owned(), option(*other)?),
        FlattenError::RelaxBoundary(energy) => both(format!("--energy {energy}"), "boundary"),
        _ => return None,
    })
}

/// Which option has a value out of its range; options are called as the settings of the library are.
fn out_of_range(pipeline: &Pipeline, error: &FlattenError) -> Option<String> {
    let (FlattenError::Problem(ProblemError::Setting(setting))
    | FlattenError::Solve { source: SolveError::Setting(setting), .. }
    | FlattenError::Descent(EmbedError::Setting(setting))
    | FlattenError::Injective(EmbedError::Setting(setting))) = error
    else {
        return None;
    };
    let mut solver = pipeline.solver.clone();
    let SolverParts { barrier, descent, .. } = solver.parts_mut();
    let start = match error {
        FlattenError::Descent(_) => descent.map(|descent| descent.barrier_start),
        _ => barrier.map(|barrier| barrier.barrier_start),
    };
    // There is no option for where the barrier starts.
    let allowed = start.map_or_else(
        || setting.allowed.to_owned(),
        |start| setting.allowed.replace("barrier_start", &start.to_string()),
    );
    Some(format!("--{} must be {allowed}, got {}", setting.name.replace('_', "-"), setting.value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Args, FlattenArgs};
    use clap::{CommandFactory, Parser};

    fn typed(options: &str) -> FlattenArgs {
        Args::try_parse_from(["bench-harness"].into_iter().chain(options.split_whitespace())).expect("usage").flatten
    }

    fn methods_of(options: &str) -> Result<Vec<Method>, clap::Error> {
        let args = typed(options);
        methods(&args.solver, &args.method)
    }

    #[test]
    fn every_option_of_some_solvers_stands_under_a_heading_that_names_them() {
        for argument in Args::command().get_arguments() {
            let Some(heading) = argument.get_help_heading().and_then(|heading| heading.strip_prefix("Options of "))
            else {
                continue;
            };
            let option = argument.get_long().expect("a long name");
            let sample = match option {
                "passes" => "3",
                "boundary" => "convex",
                "wheel" => "log",
                "hessian" => "exact",
                "line-search" => "full",
                "reduction" | "preconditioner" => "none",
                "max-iterations" | "max-inner-iterations" => "7",
                _ => "0.1",
            };
            let concerned: Vec<&str> = SolverKind::ALL
                .into_iter()
                .filter(|solver| methods_of(&format!("--solver {solver} --{option} {sample}")).is_ok())
                .map(SolverKind::name)
                .collect();
            let others: Vec<&str> =
                SolverKind::ALL.into_iter().map(SolverKind::name).filter(|name| !concerned.contains(name)).collect();
            let most = others.len() <= 2;
            let expected =
                if most { format!("every solver but {}", others.join(" and ")) } else { concerned.join(", ") };
            assert_eq!(heading, expected, "--{option}");
        }
    }

    #[test]
    fn with_all_solvers_every_option_applies_to_those_it_concerns() {
        let methods = methods_of("--solver all --passes 2 --wheel log --reduction none").expect("methods");
        assert_eq!(methods.len(), SolverKind::ALL.len());
        assert!(methods.iter().all(|method| method.unsupported.is_none()));
    }

    #[test]
    fn what_goes_with_some_solvers_only_is_an_error_for_one_and_a_row_among_several() {
        let error = methods_of("--solver uzawa --wheel product").unwrap_err().to_string();
        assert!(error.contains("exact Hessian of the product wheel"), "{error}");
        let methods = methods_of("--solver all --wheel product --layout tree").expect("methods");
        let unsupported: Vec<&str> =
            methods.iter().filter(|m| m.unsupported.is_some()).map(|m| m.pipeline.solver.name()).collect();
        assert_eq!(unsupported, ["uzawa", "minres", "descent", "lscm"]);
    }

    #[test]
    fn abf_is_left_out_on_large_meshes_unless_it_is_named() {
        let large = abf_shapes::Shape::BumpySheet.mesh(MOST_TRIANGLES_OF_ABF + 2000);
        let not_run = |options: &str| {
            let methods = methods_of(options).expect("methods");
            methods.iter().filter_map(|m| m.not_run(&large)).map(|n| n.kind).collect::<Vec<_>>()
        };
        assert_eq!(not_run("--solver all"), [NotRunKind::TooLarge]);
        assert_eq!(not_run("--solver abf,lscm"), []);
    }
}
