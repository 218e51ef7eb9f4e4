//! A map that lies over itself made one that does not.

use super::apart::{Part, taken_apart, walks};
use super::relax::upright;
use super::task::{Certified, Given, Single, Task};
use crate::settings::{Injective, Pipeline};
use crate::{FlattenError, Flattening, InjectiveReport, LayoutReport, PrecisionLimits};
use abf_control::{Checkpoint, Event, Observer, Stage, StopCriteria, Termination, ask};
use abf_cut::FaceWalks;
use abf_embed::{EmbedError, Energy, InjectiveDrawing, Relax, boundary_gap, vertex_points};
use abf_mesh::{FaceId, Point2, TriMesh, UvId, UvMap, Vector2};
use abf_metrics::{Certificate, Precision, certify_asking};

/// The largest gap that can be asked for, as a part of the side of a square as large as the surface.
const MOST_GAP: f64 = 0.25;

/// The distance between parts side by side, as a part of the side of a square as large as the map.
const BETWEEN_PARTS: f64 = 1.0 / 64.0;

/// Refuses a gap that is too large for a mesh. `working` is the mesh `scale` times as large: the area of the mesh as it was given
/// may underflow.
pub(super) fn check_gap(pipeline: &Pipeline, working: &TriMesh, scale: f64) -> Result<(), FlattenError> {
    let gap = pipeline.boundary_gap;
    if gap == 0.0 {
        return Ok(());
    }
    let most = MOST_GAP * working.area().sqrt() / scale;
    if gap > most { Err(FlattenError::GapTooLarge { gap, most }) } else { Ok(()) }
}

/// Makes a map injective as the pipeline says. One that is, and has the gap that is asked for, stays as it is, and so does one
/// that was interrupted.
pub(super) fn made_injective(
    given: Given<'_>,
    flat: Flattening,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    let rule = given.pipeline.injective;
    if rule == Injective::Off || flat.termination.is_interruption() || is_enough(&given, &flat) {
        return Ok(flat);
    }
    match rule {
        Injective::Off => Ok(flat),
        Injective::Split => split(given, flat, observer),
        Injective::Deform => deformed(given, flat, stop, observer),
    }
}

fn is_enough(given: &Given<'_>, flat: &Flattening) -> bool {
    let asked = given.pipeline.boundary_gap;
    flat.certificate.injective() && (asked == 0.0 || gap_of(given, &flat.uv).is_none_or(|gap| gap >= asked))
}

/// The smallest distance between parts of the boundary of a map with one point per vertex.
fn gap_of(given: &Given<'_>, uv: &UvMap) -> Option<f64> {
    let topology = given.problem.topology();
    // Squares of distances would underflow at another scale.
    let scale = if given.pipeline.normalize { 1.0 } else { given.scale };
    let points: Vec<Point2<f64>> = vertex_points(topology, uv).ok()?.into_iter().map(|p| p * scale).collect();
    boundary_gap(topology, &points).map(|gap| gap / scale)
}

/// A map from Tutte's embedding that never lay over itself.
fn deformed(
    given: Given<'_>,
    flat: Flattening,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    ask(observer, Event::StageStarted(Stage::Relax))?;
    let relax = given.pipeline.relax.unwrap_or(Relax { energy: Energy::Abf, ..Relax::default() });
    // A power of two moves no bit.
    let gap = given.pipeline.boundary_gap * given.scale;
    let before = upright(&given, &flat).map(|uv| relax.energy_of(given.mesh, given.problem, &uv));
    let report = InjectiveReport {
        rule: Injective::Deform,
        overlaps: flat.certificate.overlaps(),
        energy: Some(relax.energy),
        before: before.filter(|before| before.is_finite()),
        after: None,
        steps: 0,
        first_steps: 0,
        gap: None,
        parts: 1,
        error: None,
    };
    match relax.solve_injective(given.mesh, given.problem, gap, stop, observer) {
        Ok(drawing) => placed(given, flat, &drawing, report, observer),
        Err(EmbedError::Cancelled(cancelled)) => Err(cancelled.into()),
        Err(EmbedError::Interrupted(termination)) => Ok(Flattening { termination, ..flat }),
        Err(error) => {
            let report = InjectiveReport { error: Some(FlattenError::Injective(error)), ..report };
            Ok(Flattening { termination: Termination::Stalled, injective: Some(report), ..flat })
        }
    }
}

/// A drawing put where every layout is, if it is injective there as it will be stored.
fn placed(
    given: Given<'_>,
    flat: Flattening,
    drawing: &InjectiveDrawing,
    report: InjectiveReport,
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    ask(observer, Event::StageStarted(Stage::Certificate))?;
    let task = Task::new(given, flat.solver, Single::SurfaceAngles);
    let mut best: Option<(Certified, bool, bool)> = None;
    for (uv, pinned, scaled) in task.placements(&drawing.uv, drawing.area_matched) {
        let certified = task.certified(uv, observer)?;
        let is_injective = certified.certificate.injective();
        if is_injective || best.is_none() {
            best = Some((certified, pinned, scaled));
        }
        if is_injective {
            break;
        }
    }
    let (Certified { uv, mut certificate }, pinned, scaled) = best.expect("there is always the drawing as it is");
    let is_missed = !certificate.injective() && drawing.termination.is_as_asked();
    certificate.constraint_residual = flat.certificate.constraint_residual;
    let report = InjectiveReport {
        after: Some(drawing.energy).filter(|after| after.is_finite()),
        steps: drawing.steps.len(),
        first_steps: drawing.first_steps,
        gap: gap_of(&given, &uv),
        ..report
    };
    Ok(Flattening {
        precision_limits: PrecisionLimits::of(&certificate, &[]),
        uv,
        certificate,
        // The digits that are stored may not hold it.
        termination: if is_missed { Termination::Stalled } else { drawing.termination },
        layout: LayoutReport { pinned, scaled, ..flat.layout },
        injective: Some(report),
        ..flat
    })
}

/// A valid map parted along its overlaps, the parts side by side. One that is not valid stays as it is.
fn split(given: Given<'_>, flat: Flattening, observer: &mut dyn Observer) -> Result<Flattening, FlattenError> {
    if !flat.certificate.valid() {
        return Ok(flat);
    }
    ask(observer, Event::StageStarted(Stage::Certificate))?;
    // Squares of lengths would underflow at another scale. A power of two moves no bit.
    let scale = if given.pipeline.normalize { 1.0 } else { given.scale };
    let worked_on = flat.uv.clone().mapped(|p| p * scale);
    let parts = parts(&given, &worked_on, observer)?;
    let precision = given.pipeline.precision;
    let uv = side_by_side(&worked_on, &parts).mapped(|p| p / scale);
    let uv = if given.pipeline.normalize { uv.normalized() } else { uv };
    let uv = uv.mapped(|p| p.map(|x| precision.round(x)));
    let checkpoint = &mut || ask(observer, Event::Working);
    let mut certificate = certify_asking(given.original, &uv, precision, checkpoint)?;
    let is_missed = !certificate.injective() && flat.termination.is_as_asked();
    certificate.constraint_residual = flat.certificate.constraint_residual;
    let report = InjectiveReport {
        rule: Injective::Split,
        overlaps: flat.certificate.overlaps(),
        energy: None,
        before: None,
        after: None,
        steps: 0,
        first_steps: 0,
        gap: None,
        parts: parts.len(),
        error: None,
    };
    let termination = if is_missed { Termination::Stalled } else { flat.termination };
    // The digits that are stored may not hold the parts so far from the origin.
    if !certificate.valid() {
        let report = InjectiveReport { parts: 1, ..report };
        return Ok(Flattening { termination, injective: Some(report), ..flat });
    }
    Ok(Flattening {
        precision_limits: PrecisionLimits::of(&certificate, &[]),
        uv,
        certificate,
        termination,
        layout: LayoutReport { pinned: false, ..flat.layout },
        injective: Some(report),
        ..flat
    })
}

/// The faces of every part, ascending; the part with the first face first.
fn parts(given: &Given<'_>, uv: &UvMap, observer: &mut dyn Observer) -> Result<Vec<Vec<FaceId>>, FlattenError> {
    let checkpoint = &mut || ask(observer, Event::Working);
    let all = given.problem.topology().faces().collect();
    let whole = PartOfMap::of((given.mesh, uv), given.pipeline.precision, all, checkpoint)?;
    let mut parts: Vec<Vec<FaceId>> = taken_apart(whole, checkpoint)?.into_iter().map(|part| part.faces).collect();
    parts.sort_by_key(|faces| faces[0]);
    Ok(parts)
}

struct PartOfMap<'m> {
    map: (&'m TriMesh, &'m UvMap),
    precision: Precision,
    faces: Vec<FaceId>,
    uv: UvMap,
    certificate: Certificate,
}

impl<'m> PartOfMap<'m> {
    fn of(
        map: (&'m TriMesh, &'m UvMap),
        precision: Precision,
        faces: Vec<FaceId>,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, FlattenError> {
        let corners = || faces.iter().map(|f| f.corners());
        let uv = map.1.submap(corners());
        let certificate = certify_asking(&map.0.submesh(corners()).mesh, &uv, precision, checkpoint)?;
        Ok(Self { map, precision, faces, uv, certificate })
    }
}

impl Part for PartOfMap<'_> {
    fn certificate(&self) -> &Certificate {
        &self.certificate
    }

    fn walks(&self) -> FaceWalks {
        walks(&self.uv, |_, _| false)
    }

    fn some_faces(&self, faces: &[usize], checkpoint: &mut Checkpoint<'_>) -> Result<Self, FlattenError> {
        Self::of(self.map, self.precision, faces.iter().map(|&f| self.faces[f]).collect(), checkpoint)
    }
}

/// The parts in a row, each with points of its own.
fn side_by_side(uv: &UvMap, parts: &[Vec<FaceId>]) -> UvMap {
    let distance = BETWEEN_PARTS * uv.signed_area().abs().sqrt();
    let mut points: Vec<Point2<f64>> = Vec::new();
    let mut corners = uv.corners().to_vec();
    let mut right = 0.0;
    for faces in parts {
        let part = uv.submap(faces.iter().map(|f| f.corners()));
        let low = part.points().iter().copied().reduce(|a, b| a.inf(&b)).expect("a part has faces");
        let high = part.points().iter().copied().reduce(|a, b| a.sup(&b)).expect("a part has faces");
        let shift = Vector2::new(right, 0.0) - low.coords;
        let begin = points.len();
        points.extend(part.points().iter().map(|p| p + shift));
        right += high.x - low.x + distance;
        for (face, own) in faces.iter().zip(part.corners().as_chunks::<3>().0) {
            for (corner, point) in face.corners().into_iter().zip(own) {
                corners[corner.index()] = UvId::new(begin + point.index());
            }
        }
    }
    UvMap::new(points, corners)
}
