//! A boundary that is asked for: posed, solved once or in rounds, and looked at in the result.

use super::corners::best_corners;
use super::hearing::Hearing;
use crate::settings::Pipeline;
use crate::{BoundaryReport, FlattenError, Flattening};
use abf_constraints::{AngleProblem, Boundary, BoundaryConditions, ProblemError, boundary_loop};
use abf_control::{Observer, Termination, TimeBudget};
use abf_embed::vertex_points;
use abf_mesh::{CornerId, Point2, Topology, TriMesh, UvMap, Vector2, VertexId};
use std::f64::consts::{PI, TAU};

/// A circle is solved for in at most so many rounds.
const ROUNDS: usize = 16;

/// Radii that differ by at most this part are those of a circle.
const ROUND: f64 = 5e-4;

/// UVs whose angle sums are off by no more than this, rad, have the boundary that was asked for.
pub(super) const MET: f64 = 1e-6;

/// What solves one problem with a pipeline.
type Solve<'s> = dyn Fn(&AngleProblem<'_>, &Pipeline, &mut dyn Observer) -> Result<Flattening, FlattenError> + 's;

/// Solves with the boundary that the pipeline asks for. `mesh` is the one that is worked on.
pub(super) fn solve_bounded(
    (pipeline, mesh): (&Pipeline, &TriMesh),
    problem: &AngleProblem<'_>,
    solve: &Solve<'_>,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    let topology = problem.topology();
    match &pipeline.boundary {
        Boundary::Free => solve(problem, pipeline, observer),
        Boundary::Circle => in_rounds((pipeline, mesh), problem, solve, observer),
        Boundary::Rectangle(None) => {
            let budget = TimeBudget::start(&pipeline.stop);
            let free = Pipeline { boundary: Boundary::Free, ..pipeline.clone() };
            let flat = solve(problem, &free, observer)?;
            if flat.termination.is_interruption() {
                return Ok(flat);
            }
            let angles = flat.solution.as_ref().map_or(problem.initial_guess(), |solution| solution.angles());
            let corners = best_corners(mesh, topology, angles).map_err(ProblemError::from)?;
            let conditions = BoundaryConditions::rectangle(topology, corners).map_err(ProblemError::from)?;
            let posed = problem.clone().with_boundary(Some(conditions));
            let flat = solve(&posed, &Pipeline { stop: budget.left(), ..pipeline.clone() }, observer)?;
            Ok(finished(flat, topology, 1, Some(corners)))
        }
        rule => {
            let conditions = rule.conditions(topology).map_err(ProblemError::from)?;
            let flat = solve(&problem.clone().with_boundary(conditions), pipeline, observer)?;
            let corners = if let Boundary::Rectangle(corners) = rule { *corners } else { None };
            Ok(finished(flat, topology, 1, corners))
        }
    }
}

/// A circle: with the lengths of the surface, then with those of each layout, until they agree.
fn in_rounds(
    (pipeline, mesh): (&Pipeline, &TriMesh),
    problem: &AngleProblem<'_>,
    solve: &Solve<'_>,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    let budget = TimeBudget::start(&pipeline.stop);
    let observer = &mut Hearing::new(observer);
    let topology = problem.topology();
    let all = boundary_loop(topology);
    let next = |j: usize| (j + 1) % all.len();
    let mut lengths: Vec<f64> = (0..all.len())
        .map(|j| (mesh.positions()[all[next(j)].index()] - mesh.positions()[all[j].index()]).norm())
        .collect();
    let mut problem = problem.clone();
    let mut round = 1;
    let mut last: Option<Flattening> = None;
    loop {
        let conditions = match BoundaryConditions::circle(topology, &lengths) {
            Ok(conditions) => conditions,
            // Lengths of a layout may ask for what those of the surface did not.
            Err(error) => {
                return last.map(|last| ended_as(Termination::Stalled, last)).ok_or(ProblemError::from(error).into());
            }
        };
        problem = problem.with_boundary(Some(conditions));
        let solved = solve(&problem, &Pipeline { stop: budget.left(), ..pipeline.clone() }, observer);
        observer.aborted()?;
        let flat = match solved {
            Ok(flat) => finished(flat, topology, round, None),
            // It was stopped: the round before is there.
            Err(error @ FlattenError::Cancelled(_)) => {
                return last.map(|last| ended_as(Termination::Cancelled, last)).ok_or(error);
            }
            Err(error) => return last.map(|last| ended_as(Termination::Stalled, last)).ok_or(error),
        };
        let ended = flat.termination;
        // The last round that came to its end is better than half of one.
        if ended.is_interruption() {
            return Ok(last.map_or(flat, |last| ended_as(ended, last)));
        }
        if !flat.certificate.valid() {
            return Ok(last.map_or(flat, |last| ended_as(Termination::Stalled, last)));
        }
        let spread = flat.boundary.as_ref().and_then(|boundary| boundary.radius_spread);
        let is_round = spread.is_some_and(|spread| spread <= 1.0 + ROUND);
        if is_round {
            return Ok(flat);
        }
        if round == ROUNDS {
            return Ok(ended_as(Termination::Stalled, flat));
        }
        // Only their ratios count.
        let scaled = flat.uv.in_range();
        let points = vertex_points(topology, scaled.as_ref().unwrap_or(&flat.uv));
        let (Some(solution), Ok(points)) = (&flat.solution, points) else {
            return Ok(flat);
        };
        lengths = (0..all.len()).map(|j| (points[all[next(j)].index()] - points[all[j].index()]).norm()).collect();
        problem = problem.with_initial_guess(solution.angles().to_vec());
        last = Some(flat);
        round += 1;
    }
}

fn ended_as(termination: Termination, flat: Flattening) -> Flattening {
    Flattening { termination, ..flat }
}

/// The result with what only the rule knows of its boundary.
fn finished(flat: Flattening, topology: &Topology, rounds: usize, corners: Option<[u32; 4]>) -> Flattening {
    let sides = corners.and_then(|corners| sides(topology, &flat.uv, corners));
    let boundary = flat.boundary.map(|report| BoundaryReport { rounds, corners, sides, ..report });
    Flattening { boundary, ..flat }
}

/// How far it is along the boundary from each corner to the next.
fn sides(topology: &Topology, uv: &UvMap, corners: [u32; 4]) -> Option<[f64; 4]> {
    let points = vertex_points(topology, uv).ok()?;
    let is_corner = |v: &VertexId| corners.iter().any(|&corner| corner as usize == v.index());
    let at: Vec<VertexId> = boundary_loop(topology).into_iter().filter(is_corner).collect();
    let at: [VertexId; 4] = at.try_into().ok()?;
    Some([0, 1, 2, 3].map(|k| length(points[at[(k + 1) % 4].index()] - points[at[k].index()])))
}

/// The length of a difference of UVs; `hypot` neither overflows nor underflows.
fn length(v: Vector2<f64>) -> f64 {
    v.x.hypot(v.y)
}

/// What the boundary of UVs is like, under conditions.
pub(super) fn report(
    topology: &Topology,
    conditions: &BoundaryConditions,
    uv: &UvMap,
    is_valid: bool,
) -> BoundaryReport {
    // Angles and ratios do not depend on the size, but products of coordinates may leave the range of doubles.
    let scaled = uv.in_range();
    let uv = scaled.as_ref().unwrap_or(uv);
    let angles: Vec<f64> = topology.corners().map(|c| uv_angle(uv, c)).collect();
    let all = boundary_loop(topology);
    let sums: Vec<f64> = all.iter().map(|&v| topology.fan(v).map(|c| angles[c.index()]).sum()).collect();
    let largest_angle = sums.iter().copied().fold(0.0, f64::max);
    let turns_once = (sums.iter().map(|sum| PI - sum).sum::<f64>() - TAU).abs() <= MET;
    let polygon: Vec<Point2<f64>> = all.iter().filter_map(|&v| topology.fan_start(v)).map(|c| uv.corner(c)).collect();
    BoundaryReport {
        rounds: 1,
        corners: None,
        sides: None,
        violation: conditions.violation(topology, &angles),
        largest_angle,
        radius_spread: radius_spread(&polygon),
        injective_by_convexity: is_valid && turns_once && largest_angle <= PI + MET,
    }
}

/// The angle of a triangle of the UVs, in [0, π].
fn uv_angle(uv: &UvMap, corner: CornerId) -> f64 {
    let (p, q, r) = (uv.corner(corner), uv.corner(corner.next()), uv.corner(corner.prev()));
    (q - p).perp(&(r - p)).abs().atan2((q - p).dot(&(r - p)))
}

/// The largest distance from the centre of the circle of least squares over the smallest.
fn radius_spread(polygon: &[Point2<f64>]) -> Option<f64> {
    let n = polygon.len() as f64;
    let mean = polygon.iter().fold(Vector2::zeros(), |sum, p| sum + p.coords) / n;
    // With p measured from the mean: Σ p pᵀ c = ½ Σ |p|² p (Kåsa 1976).
    let (mut xx, mut xy, mut yy, mut x, mut y) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for p in polygon {
        let p = p.coords - mean;
        let square = 0.5 * p.norm_squared();
        (xx, xy, yy) = (xx + p.x * p.x, xy + p.x * p.y, yy + p.y * p.y);
        (x, y) = (x + square * p.x, y + square * p.y);
    }
    let determinant = xx * yy - xy * xy;
    let centre = mean + Vector2::new(yy * x - xy * y, xx * y - xy * x) / determinant;
    let radii = polygon.iter().map(|p| (p.coords - centre).norm());
    let (least, most) = radii.fold((f64::INFINITY, 0.0_f64), |(a, b), r| (a.min(r), b.max(r)));
    (determinant > 0.0 && least > 0.0).then(|| most / least)
}
