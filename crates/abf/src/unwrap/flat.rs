//! Pieces that are flat as they are.

use super::component::Component;
use super::finish::Finished;
use crate::FlattenError;
use crate::run::in_plane;
use abf_control::Termination;
use abf_cut::Chart;
use abf_mesh::UvMap;

impl Component<'_, '_> {
    /// A flat piece as it lies in its plane, where that is as it should be: there is nothing to solve for.
    ///
    /// The rounding of a layout adds up from face to face, so that sides that only touch may cross. Here they are where the
    /// mesh has them. Faces so thin that a solver would give them another shape keep theirs.
    pub(super) fn laid_flat(&self, piece: &Chart) -> Result<Option<Finished>, FlattenError> {
        let Some(points) = in_plane(&piece.mesh) else { return Ok(None) };
        let uv = UvMap::per_vertex(&piece.mesh, &points);
        let how = (self.pipeline_of_first_rung().solver.kind(), Termination::Converged);
        let precision = self.settings.pipeline.precision;
        let flat = Finished::of_flat(piece, &uv, how, precision, &mut || self.go_on())?;
        Ok(self.fits(&flat).then_some(flat))
    }
}
