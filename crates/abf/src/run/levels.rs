//! A hierarchical solver on one problem: who solves the coarse mesh, and who draws it.

use super::task::{Given, Task};
use crate::{FlattenError, Flattening, HierarchyReport};
use abf_control::{Cancelled, Checkpoint, Observer};
use abf_embed::vertex_points;
use abf_mesh::{Point2, Topology, TriMesh};
use abf_metrics::{MetricsError, Precision, certify_connected_asking};
use abf_reconstruct::{LayoutError, LayoutSettings, layout_asking};
use abf_solve_abf_newton::AbfNewton;
use abf_solve_core::AngleSolver;
use abf_solve_hierarchical::{Coarse, Hierarchical, HierarchicalMethod, HierarchicalSolution};
use abf_solve_linabf::LinAbf;
use std::sync::Arc;

impl Task<'_> {
    /// Solves by levels. The layout that the pipeline asks for draws the coarse mesh, and the angles that were solved for on
    /// the fine one.
    pub(super) fn by_levels(
        &self,
        hierarchical: &Hierarchical,
        observer: &mut dyn Observer,
    ) -> Result<Flattening, FlattenError> {
        let Given { mesh, problem, pipeline, .. } = self.given;
        let solver: Arc<dyn AngleSolver> = match hierarchical.method {
            HierarchicalMethod::HLinAbf => Arc::new(LinAbf::default()),
            HierarchicalMethod::HabfPlusPlus => Arc::new(AbfNewton::abf_plus_plus()),
        };
        let layout = &mut |mesh: &TriMesh, topology: &Topology, angles: &[f64], checkpoint: &mut Checkpoint<'_>| {
            valid_drawing(mesh, topology, angles, &pipeline.layout, checkpoint)
        };
        let found = hierarchical.solve(mesh, problem, Coarse { solver, layout }, &self.stop, observer);
        let found = found.map_err(|source| FlattenError::of_solver(self.solver, source))?;
        let HierarchicalSolution { uv, solution, levels, fallback, .. } = found;
        let flat = match uv {
            Some(uv) => self.placed((&uv, false), solution, &[], observer)?,
            None => self.laid_out(Some(solution), pipeline.layout, observer)?,
        };
        Ok(Flattening { hierarchy: Some(HierarchyReport { levels, fallback }), ..flat })
    }
}

/// A drawing of a mesh from its angles, one point per vertex; `None` where it is not valid.
fn valid_drawing(
    mesh: &TriMesh,
    topology: &Topology,
    angles: &[f64],
    settings: &LayoutSettings,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Option<Vec<Point2<f64>>>, Cancelled> {
    let uv = match layout_asking(mesh, topology, angles, settings, checkpoint) {
        Ok(layout) => layout.uv,
        Err(LayoutError::Cancelled(cancelled)) => return Err(cancelled),
        Err(_) => return Ok(None),
    };
    match certify_connected_asking(mesh, topology, &uv, Precision::Double, checkpoint) {
        Ok(certificate) if certificate.valid() => Ok(vertex_points(topology, &uv).ok()),
        Err(MetricsError::Cancelled(cancelled)) => Err(cancelled),
        Ok(_) | Err(_) => Ok(None),
    }
}
