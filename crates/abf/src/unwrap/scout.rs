//! Seams of large pieces, looked for on a coarser mesh: the rounds of a thousand faces cost next to nothing.

use super::component::{Component, costs_with_caps};
use super::piece::Progress;
use super::stretch::Stretch;
use super::surface::Surface;
use super::{SeamRule, Unwrap};
use crate::FlattenError;
use abf_cut::{Chart, HoleFilling, extend, simplify_asking};
use abf_mesh::{FaceId, Topology, TriMesh, VertexId};

/// Pieces of fewer faces are not worth it: their seams come out with a larger F.
const LARGE: usize = 30_000;

/// The coarse mesh has at least so many faces …
const LEAST: usize = 3000;

/// … and this part of those there are.
const PART: usize = 12;

impl Component<'_, '_> {
    /// The places that the seam of a piece is to reach, round by round, as found on a coarser mesh: vertices of the piece.
    /// None where the piece is small, or the coarse mesh is within the aim as it is.
    pub(super) fn scout(
        &self,
        piece: &Chart,
        filling: Option<HoleFilling>,
    ) -> Result<Vec<Vec<VertexId>>, FlattenError> {
        let faces = piece.mesh.face_count();
        if faces < LARGE || self.settings.seams == SeamRule::Keep || self.settings.max_seam.is_some() {
            return Ok(Vec::new());
        }
        let faces = LEAST.max(faces / PART);
        let coarse = simplify_asking(&piece.mesh, &piece.topology, faces, &mut || self.go_on())?;
        let Some(coarse) = coarse else { return Ok(Vec::new()) };
        let names = coarse.vertices;
        let coarse = Chart {
            faces: (0..coarse.mesh.face_count()).map(FaceId::new).collect(),
            vertices: (0..coarse.mesh.vertex_count()).map(VertexId::new).collect(),
            mesh: coarse.mesh,
            topology: coarse.topology,
        };
        let mut rounds = Vec::new();
        // What the coarse mesh cannot tell, the fine one will.
        let _ = self.tried(self.scout_on(&coarse, filling, &mut rounds))?;
        let in_piece = |peaks: Vec<VertexId>| peaks.into_iter().filter_map(|v| names.get(v.index()).copied()).collect();
        Ok(rounds.into_iter().map(in_piece).collect())
    }

    fn scout_on(
        &self,
        coarse: &Chart,
        filling: Option<HoleFilling>,
        rounds: &mut Vec<Vec<VertexId>>,
    ) -> Result<(), FlattenError> {
        let Unwrap { max_stretch, costs, .. } = *self.settings;
        // No edge of the coarse mesh is one of the file, so the hints forbid none.
        let costs =
            |mesh: &TriMesh, topology: &Topology, real: usize| costs_with_caps(mesh, topology, real, &costs, |_| false);
        let mut surface = Surface::new(coarse, filling, &costs)?;
        let mut progress = Progress::default();
        while self.interruption().is_none() {
            let chart = surface.chart()?;
            let uv = self.flatten_quickly(&chart, &mut self.ear())?;
            let stretch = Stretch::measure(&chart, &uv, surface.real, surface.mesh.vertex_count())?;
            if stretch.l2 <= max_stretch || progress.is_stalled(stretch.l2) {
                break;
            }
            let peaks = self.peaks(&surface, &stretch);
            if extend(&surface.topology, &surface.costs, &mut surface.seams, &peaks) == 0 {
                break;
            }
            rounds.push(peaks);
            if let Some(filling) = filling {
                surface.release_caps(coarse, filling, &costs)?;
            }
        }
        Ok(())
    }
}
