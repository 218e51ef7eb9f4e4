//! One component: a list of pieces, each worked on until it is as it should be, or in smaller pieces.

use super::finish::{Finished, finish};
use super::relay::{Ear, Relay};
use super::{SeamRule, Unwrap};
use crate::{FlattenError, Pipeline, ZeroArea};
use abf_constraints::ProblemError;
use abf_control::{Cancelled, Event, Termination, TimeBudget, ask};
use abf_cut::{Chart, CostSettings, EdgeCosts, Seams, hard_surface_asking, split, two_parts_asking};
use abf_embed::EmbedError;
use abf_mesh::{CornerId, FaceId, Topology, TriMesh};
use abf_metrics::MetricsError;
use abf_parallel::prelude::*;
use abf_solve_core::SolveError;

/// A component, or what kept seams have made of one.
#[derive(Clone, Copy)]
pub(super) struct Component<'c, 'o> {
    pub(super) settings: &'c Unwrap,
    pub(super) part: &'c Chart,
    /// Which one it is.
    pub(super) number: usize,
    /// Which of its charts is worked on.
    pub(super) chart: usize,
    /// Whether it comes out as it is if it is a disk, whatever its stretch.
    pub(super) stays_whole: bool,
    /// Whether the edge that a corner of `part` faces may not be a seam.
    pub(super) is_forbidden: &'c (dyn Fn(CornerId) -> bool + Sync),
    /// The time there is for all of them.
    pub(super) budget: &'c TimeBudget,
    pub(super) relay: &'c Relay<'o>,
}

/// What became of a piece.
pub(super) enum Attempt {
    /// Charts that are as they should be, and pieces that are not.
    Done(Vec<Finished>, Vec<Chart>),
    /// No map of it is as it should be.
    Missed,
    /// There was no time to finish it; with its last valid map.
    Interrupted(Termination, Option<Box<Finished>>),
}

impl<'o> Component<'_, 'o> {
    /// Faces that are in none of the charts have no area.
    pub(super) fn run(&self) -> Result<Vec<Finished>, FlattenError> {
        let part = self.part;
        if self.stays_whole && part.topology.require_disk().is_ok() {
            self.relay.begin_charts(self.number, 1);
            let flat = self.pipeline().run(&part.mesh, &mut self.ear())?;
            self.end_chart(part.faces.len());
            return Ok(vec![finish(part, part.mesh.face_count(), flat, &mut || self.go_on())?]);
