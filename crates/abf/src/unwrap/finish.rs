//! From a flattened chart with virtual faces to one without.

use crate::{
    FlattenError, Flattening, InjectiveReport, LayoutReport, RelaxReport, RungReport, SolveReport, SolverKind,
};
use abf_control::{Checkpoint, Termination};
use abf_cut::Chart;
use abf_mesh::{FaceId, Submesh, TriMesh, UvMap};
use abf_metrics::{Certificate, Metrics, Precision, certify_asking, measure_certified, per_face};
use abf_solve_core::AngleSolution;

/// A chart as it comes out, by the faces of its component.
#[derive(Clone)]
pub(super) struct Finished {
    /// The piece of the component that it was flattened as.
    pub(super) piece: usize,
    /// Its faces, by their numbers in the component, ascending.
    pub(super) faces: Vec<FaceId>,
    /// Corner `k` of its `i`-th face is corner `k` of `faces[i]`.
    pub(super) uv: UvMap,
    pub(super) metrics: Metrics,
    pub(super) solver: SolverKind,
    pub(super) termination: Termination,
    /// What the solver did.
    pub(super) solve: SolveReport,
    pub(super) layout: LayoutReport,
    pub(super) rungs: Vec<RungReport>,
    pub(super) layout_error: Option<f64>,
    pub(super) relaxed: Option<RelaxReport>,
    pub(super) injective: Option<InjectiveReport>,
    pub(super) rounds: usize,
    pub(super) holes_filled: usize,
    pub(super) virtual_faces: usize,
    /// Whether it was given up before it was as it should be.
    pub(super) is_unfinished: bool,
}

impl Finished {
    /// The first `real` faces of a map that no solver has finished.
    pub(super) fn of_map(
        chart: &Chart,
        real: usize,
        uv: &UvMap,
        how: (SolverKind, Termination),
        precision: Precision,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, FlattenError> {
        Self::of_points(chart, (real, uv, true), how, precision, checkpoint)
    }

    /// A piece that is flat as it is, in the coordinates of its plane.
    pub(super) fn of_flat(
        piece: &Chart,
        uv: &UvMap,
        how: (SolverKind, Termination),
        precision: Precision,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, FlattenError> {
        let flat = Self::of_points(piece, (piece.mesh.face_count(), uv, false), how, precision, checkpoint)?;
        Ok(Self { faces: piece.faces.clone(), is_unfinished: false, ..flat })
    }

    fn of_points(
        chart: &Chart,
        (real, uv, is_scaled): (usize, &UvMap, bool),
        (solver, termination): (SolverKind, Termination),
        precision: Precision,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Self, FlattenError> {
        let faces: Vec<FaceId> = (0..real).map(FaceId::new).collect();
        let certificate = certify_asking(&chart.mesh, uv, precision, checkpoint)?;
        let (uv, metrics) = excerpt(&chart.mesh, uv, &certificate, &faces, is_scaled, checkpoint)?;
        let layout = LayoutReport::placed(false, true);
        Ok(Self {
            piece: 0,
            faces,
            uv,
            metrics,
            solver,
            termination,
            solve: SolveReport::default(),
            layout,
            rungs: Vec::new(),
            layout_error: None,
            relaxed: None,
            injective: None,
            rounds: 0,
            holes_filled: 0,
            virtual_faces: real.abs_diff(chart.mesh.face_count()),
            is_unfinished: true,
        })
    }
}

/// Of a chart that is a whole piece: drops the faces from `real` on, gives the rest the area of its surface, and judges it.
pub(super) fn finish(
    chart: &Chart,
    real: usize,
    flat: Flattening,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Finished, FlattenError> {
    checkpoint()?;
    let layout_error = layout_error(chart, real, &flat)?;
    checkpoint()?;
    let solve = flat.solve_report();
    let faces: Vec<FaceId> = (0..real).map(FaceId::new).collect();
    let (uv, metrics) = if real == chart.mesh.face_count() {
        let metrics = measure_certified(&chart.mesh, &flat.uv, flat.certificate)?;
        checkpoint()?;
        (flat.uv, metrics)
    } else {
        excerpt(&chart.mesh, &flat.uv, &flat.certificate, &faces, flat.layout.scaled, checkpoint)?
    };
    Ok(Finished {
        piece: 0,
        faces,
        uv,
        metrics,
        solver: flat.solver,
        termination: flat.termination,
        solve,
        layout: flat.layout,
        rungs: flat.rungs,
        layout_error,
        relaxed: flat.relaxed,
        injective: flat.injective,
        rounds: 0,
        holes_filled: 0,
        virtual_faces: 0,
        is_unfinished: false,
    })
}

/// The largest difference between a laid-out angle and the one solved for, rad.
fn layout_error(chart: &Chart, real: usize, flat: &Flattening) -> Result<Option<f64>, FlattenError> {
    // A map that was relaxed or deformed has left the angles that were solved for.
    let solution = flat.solution.as_ref().filter(|_| flat.relaxed.is_none() && flat.injective.is_none());
    let Some(angles) = solution.map(AngleSolution::angles) else { return Ok(None) };
    let faces = per_face(&chart.mesh, &flat.uv)?;
    let laid_out = faces[..real].iter().flat_map(|face| face.uv_angles);
    Ok(Some(laid_out.zip(angles).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)))
}

/// The UVs of some of the faces, given the area of their surface if that can be, and judged.
pub(super) fn excerpt(
    mesh: &TriMesh,
    uv: &UvMap,
    certificate: &Certificate,
    faces: &[FaceId],
    is_scaled: bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<(UvMap, Metrics), FlattenError> {
    let corners = || faces.iter().map(|f| f.corners());
    let Submesh { mesh: part, vertices, .. } = mesh.submesh(corners());
    let uv = uv.submap(corners());
    let factor = (part.area() / uv.signed_area()).sqrt();
    let factor = if is_scaled && factor.is_finite() && factor > 0.0 { factor } else { 1.0 };
    let precision = certificate.precision;
    let uv = uv.mapped(|p| p.map(|x| precision.round(x * factor)));
    let constraint_residual = certificate.constraint_residual;
    let mut certificate = certify_asking(&part, &uv, precision, checkpoint)?;
    certificate.constraint_residual = constraint_residual;
    checkpoint()?;
    let mut metrics = measure_certified(&part, &uv, certificate)?;
    metrics.certificate.wound_vertices.iter_mut().for_each(|v| *v = vertices[v.index()]);
    Ok((uv, metrics))
}
