//! A map relaxed after the solver.

use super::task::{Given, Single, Task};
use super::thin::ISOMETRIC;
use crate::{FlattenError, Flattening, PinReport, PrecisionLimits, RelaxReport};
use abf_control::{Event, Observer, Stage, StopCriteria, ask};
use abf_embed::{EmbedError, Pin, PinResidual, Pins, Relax, first_drawing, vertex_points};
use abf_mesh::{Point2, UvMap, VertexId};

/// Relaxes the map of a solver if that is valid, else a first drawing. One that was interrupted stays as it is, and so
/// does one that is not valid where there is no such drawing.
pub(super) fn relaxed(
    given: Given<'_>,
    relax: &Relax,
    mut flat: Flattening,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    if keeps_lengths(&given, &flat) {
        return Ok(flat);
    }
    let Some((start, from_tutte)) = begin(&given, &mut flat, stop, observer)? else { return Ok(flat) };
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

/// Whether a map is valid, has no stretch, and every face has a shape to keep: no energy can be less, whatever shapes it gives to
/// thin triangles.
fn keeps_lengths(given: &Given<'_>, flat: &Flattening) -> bool {
    let metrics = flat.certificate.valid().then(|| flat.metrics(given.original)).and_then(Result::ok);
    metrics.is_some_and(|metrics| metrics.degenerate_3d == 0 && metrics.stretch_l2 <= 1.0 + ISOMETRIC)
}

/// Brings pins that fit the mesh to their places. A map that was interrupted stays as it is.
pub(super) fn pinned(
    given: Given<'_>,
    pins: &Pins,
    mut flat: Flattening,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    let Some((start, _)) = begin(&given, &mut flat, stop, observer)? else { return Ok(flat) };
    let relax = given.pipeline.relax.unwrap_or_default();
    // A power of two moves no bit.
    let scaled = |pin: &Pin| Pin { uv: pin.uv.map(|x| x * given.scale), ..*pin };
    let scaled = Pins { pins: pins.pins.iter().map(scaled).collect() };
    let drawing = relax.solve_pinned(given.mesh, given.problem, &start, &scaled, stop, observer);
    let drawing = drawing.map_err(|error| match error {
        EmbedError::Pins(error) => FlattenError::Pins(error),
        other => FlattenError::of_relaxing(other),
    })?;
    ask(observer, Event::StageStarted(Stage::Certificate))?;
    let task = Task::new(given, flat.solver, Single::SurfaceAngles);
    let placed = task.certified(UvMap::per_vertex(given.mesh, &drawing.uv), observer)?;
    let (uv, mut certificate) = (placed.uv, placed.certificate);
    certificate.constraint_residual = flat.certificate.constraint_residual;
    let precision = given.pipeline.precision;
    let residual = |(pin, residual): (&Pin, &PinResidual)| {
        let at = given.problem.topology().fan_start(VertexId::new(pin.vertex as usize)).expect("a face, by the check");
        let place = Point2::from(pin.uv.map(|x| precision.round(x)));
        PinResidual { distance: (uv.corner(at) - place).norm(), ..*residual }
    };
    let report = PinReport {
        energy: relax.energy,
        after: drawing.energy,
        steps: drawing.steps.len(),
        residuals: pins.pins.iter().zip(&drawing.residuals).map(residual).collect(),
    };
    let is_unsolved = !flat.termination.is_as_asked() && drawing.steps.is_empty();
    Ok(Flattening {
        precision_limits: PrecisionLimits::of(&certificate, &[]),
        uv,
        certificate,
        termination: if is_unsolved { flat.termination } else { drawing.termination },
        layout: crate::LayoutReport { pinned: false, scaled: true, ..flat.layout },
        pinned: Some(report),
        ..flat
    })
}

/// Where to start from: the map of the solver if it is valid, else a first drawing, and whether it is Tutte's embedding. `None` after an
/// interruption, and where there is neither.
fn begin(
    given: &Given<'_>,
    flat: &mut Flattening,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<Option<Start>, FlattenError> {
    if flat.termination.is_interruption() {
        return Ok(None);
    }
    ask(observer, Event::StageStarted(Stage::Relax))?;
    if let Some(points) = upright(given, flat) {
        return Ok(Some((points, false)));
    }
    match first_drawing(given.mesh, given.problem.topology(), stop, observer) {
        Ok(first) => Ok(Some((first.uv, first.tutte.is_some()))),
        Err(EmbedError::Cancelled(cancelled)) => Err(cancelled.into()),
        Err(EmbedError::Interrupted(termination)) => {
            flat.termination = termination;
            Ok(None)
        }
        Err(_) => Ok(None),
    }
}

type Start = (Vec<Point2<f64>>, bool);

/// The points of a valid map that is not mirrored, as large as the mesh that is worked on.
pub(super) fn upright(given: &Given<'_>, flat: &Flattening) -> Option<Vec<Point2<f64>>> {
    let is_upright = flat.certificate.valid() && flat.uv.signed_area() > 0.0;
    let points = vertex_points(given.problem.topology(), &flat.uv).ok().filter(|_| is_upright)?;
    // The areas of some would underflow at another scale.
    let scale = if given.pipeline.normalize { 1.0 } else { given.scale };
    Some(points.into_iter().map(|p| p * scale).collect())
}
