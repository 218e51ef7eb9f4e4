//! The stretch that a piece will have, before it is flattened.

use super::stretch::Stretch;
use super::surface::Surface;
use abf_control::{Cancelled, Checkpoint};
use abf_cut::{Chart, ConformalScale, Seams};
use abf_linalg::LinearError;

/// So many rounds in a row without [`PROGRESS`] end the cutting of a piece.
const PATIENCE: usize = 8;

/// Progress brings what the stretch is above 1 below this part of the least so far.
const PROGRESS: f64 = 0.9;

/// A map may miss the aim by so many times what is foreseen, above 1, at most: beyond that it is not worth making.
const HOPELESS: f64 = 4.0;

/// A surface with no more stretch than this is flat but for noise.
const FLAT: f64 = 1.001;

/// A map that misses the aim makes what is to be foreseen smaller, above 1: by no more than this factor.
const LEAST_FACTOR: f64 = 0.5;

/// What is foreseen of the stretch of one piece: that of a conformal map ([`ConformalScale`]), which costs a tenth of a map.
pub(super) struct Foresight {
    /// The aim of the piece.
    max_stretch: f64,
    /// The stretch at which it is worth trying a map: the aim, or less where maps turned out worse than foreseen.
    pub(super) worth_trying: f64,
    /// For the surface with so many faces. Holes that are closed, or open again, make it another.
    system: Option<(usize, Option<ConformalScale>)>,
    /// The last stretch foreseen.
    l2: Option<f64>,
}

impl Foresight {
    pub(super) fn new(max_stretch: f64) -> Self {
        let factor = std::env::var("ABF_FACTOR").ok().and_then(|s| s.parse().ok()).unwrap_or(0.9);
        let worth_trying = 1.0 + factor * (max_stretch - 1.0);
        Self { max_stretch, worth_trying, system: None, l2: None }
    }

    /// Whether it would be a waste of time to flatten a piece as it is.
    pub(super) fn is_hopeless_as_it_is(
        &mut self,
        piece: &Chart,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<bool, Cancelled> {
        let none = Seams::none(&piece.topology);
        let foreseen = self.of(piece.mesh.face_count(), (&piece.mesh, &piece.topology), &none, checkpoint)?;
        Ok(foreseen.is_some() && self.is_hopeless())
    }

    /// What is foreseen of a surface; `None` where nothing can be.
    pub(super) fn stretch(
        &mut self,
        surface: &Surface,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<Stretch>, Cancelled> {
        self.of(surface.real, (&surface.mesh, &surface.topology), &surface.seams, checkpoint)
    }

    /// Whether a map of what was looked at last is not worth making.
    pub(super) fn is_hopeless(&self) -> bool {
        self.l2.is_some_and(|l2| l2.is_nan() || l2 - 1.0 > HOPELESS * (self.max_stretch - 1.0))
    }

    /// Whether what was looked at last is flat or nearly so, as far as is known.
    pub(super) fn is_flat(&self) -> bool {
        self.l2.is_none_or(|l2| l2 <= FLAT)
    }

    /// What was looked at last has a map with this stretch.
    pub(super) fn learn(&mut self, l2: f64) {
        if let Some(foreseen) = self.l2.filter(|&foreseen| foreseen < l2) {
            let factor = ((foreseen - 1.0) / (l2 - 1.0)).max(LEAST_FACTOR);
            self.worth_trying = self.worth_trying.min(1.0 + factor * (self.max_stretch - 1.0));
        }
    }

    fn of(
        &mut self,
        real: usize,
        (mesh, topology): (&abf_mesh::TriMesh, &abf_mesh::Topology),
        seams: &Seams,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<Stretch>, Cancelled> {
        let faces = mesh.face_count();
        if self.system.as_ref().is_none_or(|(of, _)| *of != faces) {
            let system = possible(ConformalScale::new(mesh, topology, checkpoint))?;
            self.system = Some((faces, system));
        }
        checkpoint()?;
        let Some((_, Some(system))) = &self.system else { return Ok(None) };
        let u = possible(system.log_scale(topology, seams))?;
        checkpoint()?;
        let stretch = u.map(|u| Stretch::predicted(mesh, real, &u));
        self.l2 = stretch.as_ref().map(|stretch| stretch.l2);
        Ok(stretch)
    }
}

/// Only an abort is an error: without a prediction there are maps.
fn possible<T>(result: Result<T, LinearError>) -> Result<Option<T>, Cancelled> {
    match result {
        Err(LinearError::Cancelled(cancelled)) => Err(cancelled),
        result => Ok(result.ok()),
    }
}

/// Whether rounds still improve the stretch.
pub(super) struct Progress {
    /// What the stretch is above 1, the least that counted as progress.
    least: f64,
    without: usize,
}

impl Default for Progress {
    fn default() -> Self {
        Self { least: f64::INFINITY, without: 0 }
    }
}

impl Progress {
    pub(super) fn is_stalled(&mut self, l2: f64) -> bool {
        if l2 - 1.0 < PROGRESS * self.least {
            *self = Self { least: l2 - 1.0, without: 0 };
        } else {
            self.without += 1;
        }
        self.without >= PATIENCE
    }
}
