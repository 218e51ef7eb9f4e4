//! Pieces for which there was no time: their last valid map, or one that is quickly made.

use super::component::{Component, parts};
use super::finish::Finished;
use super::surface::Surface;
use crate::{FlattenError, SolverKind};
use abf_control::Termination;
use abf_cut::{Chart, planar_facets};
use abf_embed::tutte;
use abf_mesh::{FaceId, Point2, UvId, UvMap};

impl Component<'_, '_> {
    /// Charts of a piece that was given up for `end`: its last valid map; else Tutte's embedding of it; else its planar
    /// parts.
    pub(super) fn given_up(
        &self,
        piece: &Chart,
        end: Termination,
        last: Option<Finished>,
    ) -> Result<Vec<Finished>, FlattenError> {
        let how = (self.settings.pipeline.solver.kind(), end);
        let last = last.or_else(|| self.drawn(piece, how).ok().filter(|map| map.metrics.valid()));
        let charts = match last {
            Some(last) => vec![last],
            None => self.planar_parts(piece, how)?,
        };
        let marked = |chart| Finished { is_unfinished: true, termination: end, ..chart };
        Ok(charts.into_iter().map(marked).collect())
    }

    fn drawn(&self, piece: &Chart, how: (SolverKind, Termination)) -> Result<Finished, FlattenError> {
        let surface = Surface::new(piece, None, &|mesh, topology, real| self.costs(piece, mesh, topology, real))?;
        let chart = surface.chart()?;
        let uv = UvMap::per_vertex(&chart.mesh, &tutte(&chart.mesh, &chart.topology)?.uv);
        let mut map =
            Finished::of_map(&chart, surface.real, &uv, how, self.settings.pipeline.precision, &mut || self.go_on())?;
        map.faces.iter_mut().for_each(|f| *f = piece.faces[f.index()]);
        Ok(map)
    }

    fn planar_parts(&self, piece: &Chart, how: (SolverKind, Termination)) -> Result<Vec<Finished>, FlattenError> {
        let facets = planar_facets(&piece.mesh, &piece.topology);
        let mut charts = Vec::new();
        for part in parts(piece, &facets.seams)? {
            // Corners of one vertex lie in one place.
            let mut points = vec![Point2::origin(); part.mesh.vertex_count()];
            for (face, corners) in part.faces.iter().zip(part.mesh.faces()) {
                let in_piece = FaceId::new(piece.faces.binary_search(face).unwrap_or_default());
                for (c, v) in in_piece.corners().into_iter().zip(corners) {
                    points[v.index()] = facets.layout[c.index()];
                }
            }
            let corners = part.mesh.faces().iter().flatten().map(|v| UvId::new(v.index())).collect();
            let uv = UvMap::new(points, corners);
            let map =
                Finished::of_map(&part, part.faces.len(), &uv, how, self.settings.pipeline.precision, &mut || {
                    self.go_on()
                });
            // A part without area has no map.
            charts.extend(map.ok().map(|map| Finished { faces: part.faces.clone(), ..map }));
        }
        Ok(charts)
    }
}
