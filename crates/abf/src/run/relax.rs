//! A map relaxed after the solver.

use super::task::{Given, Single, Task};
use crate::{FlattenError, Flattening, PrecisionLimits, RelaxReport};
use abf_control::{Event, Observer, Stage, StopCriteria, Termination, ask};
use abf_embed::{Relax, tutte, vertex_points};
use abf_mesh::Point2;

/// Relaxes the map of a solver if that is valid, else Tutte's embedding. One that was interrupted stays as it is, and so
/// does one that is not valid where there is no such embedding.
pub(super) fn relaxed(
    given: Given<'_>,
    relax: &Relax,
    flat: Flattening,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    if matches!(flat.termination, Termination::TimeLimit | Termination::Cancelled) {
        return Ok(flat);
    }
    ask(observer, Event::StageStarted(Stage::Relax))?;
    let own = upright(&given, &flat);
    let from_tutte = own.is_none();
    let embedding = || tutte(given.mesh, given.problem.topology()).ok().map(|embedding| embedding.uv);
    let Some(start) = own.or_else(embedding) else { return Ok(flat) };
    let drawing = relax.solve(given.mesh, given.problem, &start, stop, observer).map_err(FlattenError::of_relaxing)?;
    ask(observer, Event::StageStarted(Stage::Certificate))?;
    let task = Task::new(given, flat.solver, Single::SurfaceAngles);
    let candidates = task.placements(&drawing.uv, drawing.area_matched);
    let (placed, pinned, scaled) = task.first_valid(candidates, observer)?;
    // The digits that are stored may not hold the relaxed map.
    if flat.certificate.valid() && !placed.certificate.valid() {
        return Ok(flat);
    }
    let residual = flat.certificate.constraint_residual;
    let (uv, mut certificate) = (placed.uv, placed.certificate);
    certificate.constraint_residual = residual;
    let report = RelaxReport {
        energy: relax.energy,
        before: drawing.energy_before,
        after: drawing.energy,
        steps: drawing.steps.len(),
        progressive_steps: drawing.steps.iter().filter(|step| step.is_progressive).count(),
        from_tutte,
    };
    Ok(Flattening {
        precision_limits: PrecisionLimits::of(&certificate, &[]),
        uv,
        certificate,
        termination: drawing.termination,
        layout: crate::LayoutReport { pinned, scaled, ..flat.layout },
        relaxed: Some(report),
        ..flat
    })
}

/// The points of a valid map that is not mirrored, as large as the mesh that is worked on.
fn upright(given: &Given<'_>, flat: &Flattening) -> Option<Vec<Point2<f64>>> {
    let is_upright = flat.certificate.valid() && flat.uv.signed_area() > 0.0;
    let points = vertex_points(given.problem.topology(), &flat.uv).ok().filter(|_| is_upright)?;
    // The areas of some would underflow at another scale.
    let scale = if given.pipeline.normalize { 1.0 } else { given.scale };
    Some(points.into_iter().map(|p| p * scale).collect())
}
