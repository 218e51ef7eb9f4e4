//! The stretch that a piece will have, before it is flattened.

use super::stretch::{Stretch, scaled_aim};
use super::surface::Surface;
use abf_control::{Cancelled, Checkpoint};
use abf_cut::{Chart, ConformalScale, Seams, scaled_angles};
use abf_linalg::LinearError;
use abf_mesh::{Topology, TriMesh};

/// So many rounds in a row without [`PROGRESS`] end the cutting of a piece.
const PATIENCE: usize = 8;

/// The same for maps that have missed the aim though less stretch was foreseen: what spoils them, a hole that had to be closed or
/// faces far from their angles, seldom leaves with a longer seam, and each of them takes as long as all that is foreseen.
const PATIENCE_OF_MAPS: usize = 2;

/// Maps with no more than so many times the stretch of the aim, above 1, are made as long as others.
const ALMOST: f64 = 1.06;

/// Progress brings what the stretch is above 1 below this part of the least so far.
const PROGRESS: f64 = 0.9;

/// Maps come out worse than foreseen: what is foreseen is to be this part of the aim, above 1.
const CAUTION: f64 = 0.9;

/// A map may miss the aim by so many times what is foreseen, above 1, at most: beyond that it is not worth making.
const HOPELESS: f64 = 4.0;

/// A surface with no more stretch than this is flat but for noise.
const FLAT: f64 = 1.001;

/// A map that misses the aim makes what is to be foreseen smaller, above 1: by no more than this factor.
const LEAST_FACTOR: f64 = 0.5;

/// One more cut is worth a longer seam where it brings what is foreseen, above 1, below this part of it.
const WORTH_A_CUT: f64 = 0.4;

/// Where what is foreseen is above this part of the aim, above 1, a map may well miss it: it comes out up to 1.3 times as bad.
const DOUBTFUL: f64 = 0.7;

/// Where that is so, one more cut is worth it, too, if it takes off so many times as large a part of what is foreseen, above 1,
/// as it makes the seam longer by.
const GAIN: f64 = 3.0;

/// Angles that are foreseen are refined by so many steps at most.
const STEPS: usize = 2;

/// What is foreseen of the stretch of one piece: that of a conformal map ([`ConformalScale`]).
pub(super) struct Foresight {
    /// The aim of the piece.
    max_stretch: f64,
    /// What is to be foreseen for a map to be worth trying: less where a map has turned out worse than foreseen.
    pub(super) worth_trying: f64,
    /// For the surface with so many faces. Holes that are closed, or open again, make it another.
    system: Option<(usize, Option<ConformalScale>)>,
    /// The last stretch foreseen.
    l2: Option<f64>,
    /// The logarithm of the scale at every vertex that it was foreseen with.
    log_scale: Option<Vec<f64>>,
}

impl Foresight {
    pub(super) fn new(max_stretch: f64) -> Self {
        let worth_trying = scaled_aim(max_stretch, CAUTION);
        Self { max_stretch, worth_trying, system: None, l2: None, log_scale: None }
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
        !self.is_flat() && self.l2.is_some_and(|l2| l2 > scaled_aim(self.max_stretch, HOPELESS))
    }

    /// Whether what was looked at last is flat or nearly so, as far as is known.
    pub(super) fn is_flat(&self) -> bool {
        self.l2.is_none_or(|l2| l2 <= FLAT)
    }

    /// The angles, rad, of a chart of what was looked at last once its edges are scaled as foreseen; where that leaves no
    /// triangle, those it has. `None` where nothing is foreseen, or no change.
    pub(super) fn angles(&self, chart: &Chart) -> Option<Vec<f64>> {
        let u = self.log_scale.as_ref().filter(|_| !self.is_flat())?;
        let fits = chart.vertices.iter().all(|v| v.index() < u.len());
        fits.then(|| scaled_angles(&chart.mesh, |v| u[chart.vertices[v.index()].index()]))
    }

    /// The same of what was looked at last itself.
    pub(super) fn angles_as_it_is(&self, mesh: &TriMesh) -> Option<Vec<f64>> {
        let u = self.log_scale.as_ref().filter(|u| !self.is_flat() && u.len() == mesh.vertex_count())?;
        Some(scaled_angles(mesh, |v| u[v.index()]))
    }

    /// Makes what is foreseen of a surface that was looked at last better, before its angles are asked for: the stretch that
    /// it comes to, where there is one.
    pub(super) fn refine(
        &mut self,
        surface: &Surface,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<Stretch>, Cancelled> {
        self.refine_of((&surface.mesh, &surface.topology), &surface.seams, checkpoint)?;
        let stretch = self.log_scale.as_ref().map(|u| Stretch::predicted(&surface.mesh, surface.real, u));
        Ok(stretch.filter(|stretch| !stretch.l2.is_nan()))
    }

    /// The same of a piece as it is.
    pub(super) fn refine_as_it_is(&mut self, piece: &Chart, checkpoint: &mut Checkpoint<'_>) -> Result<(), Cancelled> {
        self.refine_of((&piece.mesh, &piece.topology), &Seams::none(&piece.topology), checkpoint)
    }

    fn refine_of(
        &mut self,
        (mesh, topology): (&TriMesh, &Topology),
        seams: &Seams,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        let is_of = |u: &Vec<f64>| u.len() == mesh.vertex_count();
        if let (Some((_, Some(system))), false) = (&self.system, self.is_flat())
            && let Some(u) = self.log_scale.take().filter(is_of)
        {
            self.log_scale = Some(system.refined((mesh, topology), seams, u, STEPS, checkpoint)?);
        }
        Ok(())
    }

    /// Whether a map of what was looked at last may well miss the aim.
    pub(super) fn is_doubtful(&self) -> bool {
        self.l2.is_some_and(|l2| l2 > scaled_aim(self.max_stretch, DOUBTFUL))
    }

    /// Whether the surface that was looked at last has so much less stretch now that seams so many times as long are worth it.
    /// Otherwise what was foreseen before stays.
    pub(super) fn pays(
        &mut self,
        surface: &Surface,
        longer: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<bool, Cancelled> {
        let is_doubtful = self.is_doubtful();
        let before = (self.l2, self.log_scale.clone());
        self.stretch(surface, checkpoint)?;
        let left = self.l2.zip(before.0).map(|(after, before)| (after - 1.0) / (before - 1.0));
        let pays = left.is_some_and(|left| is_worth_it(left, longer, is_doubtful));
        if !pays {
            (self.l2, self.log_scale) = before;
        }
        Ok(pays)
    }

    /// What was looked at last has a map with this stretch.
    pub(super) fn learn(&mut self, l2: f64) {
        if let Some(foreseen) = self.l2.filter(|&foreseen| foreseen < l2) {
            let factor = ((foreseen - 1.0) / (l2 - 1.0)).max(LEAST_FACTOR);
            self.worth_trying = self.worth_trying.min(scaled_aim(self.max_stretch, factor));
        }
    }

    fn of(
        &mut self,
        real: usize,
        (mesh, topology): (&TriMesh, &Topology),
        seams: &Seams,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Option<Stretch>, Cancelled> {
        // What is not known of this surface is not what was known of another.
        (self.l2, self.log_scale) = (None, None);
        let faces = mesh.face_count();
        if self.system.as_ref().is_none_or(|(of, _)| *of != faces) {
            let system = possible(ConformalScale::new(mesh, topology, checkpoint))?;
            self.system = Some((faces, system));
        }
        checkpoint()?;
        let Some((_, Some(system))) = &self.system else { return Ok(None) };
        let u = possible(system.log_scale(topology, seams))?;
        checkpoint()?;
        // Where no face has an area there is no stretch.
        let stretch = u.as_ref().map(|u| Stretch::predicted(mesh, real, u)).filter(|stretch| !stretch.l2.is_nan());
        self.log_scale = u;
        self.l2 = stretch.as_ref().map(|stretch| stretch.l2);
        Ok(stretch)
    }
}

/// Whether a cut that leaves this part of what is foreseen above 1 is worth seams so many times as long.
fn is_worth_it(left: f64, longer: f64, is_doubtful: bool) -> bool {
    left < WORTH_A_CUT || (is_doubtful && 1.0 - left > GAIN * (longer - 1.0))
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
    rounds: usize,
    without: usize,
}

impl Default for Progress {
    fn default() -> Self {
        Self { least: f64::INFINITY, rounds: 0, without: 0 }
    }
}

impl Progress {
    pub(super) fn is_stalled(&mut self, l2: f64) -> bool {
        self.rounds += 1;
        if l2 - 1.0 < PROGRESS * self.least {
            (self.least, self.without) = (l2 - 1.0, 0);
        } else {
            self.without += 1;
        }
        self.without >= PATIENCE
    }

    /// How many rounds it was asked after.
    pub(super) fn rounds(&self) -> usize {
        self.rounds
    }

    /// The same of maps that were made because their stretch was foreseen to be small enough for this aim.
    pub(super) fn is_stalled_in_maps(&mut self, l2: f64, max_stretch: f64) -> bool {
        let is_far = l2 > scaled_aim(max_stretch, ALMOST);
        self.is_stalled(l2) || (is_far && self.without >= PATIENCE_OF_MAPS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::{FaceId, Point3, VertexId};

    fn piece(positions: &[[f64; 3]], faces: &[[usize; 3]]) -> Chart {
        let mesh = TriMesh::new(positions.iter().copied().map(Point3::from).collect(), faces).expect("a mesh");
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        Chart {
            faces: (0..faces.len()).map(FaceId::new).collect(),
            vertices: (0..positions.len()).map(VertexId::new).collect(),
            mesh,
            topology,
        }
    }

    /// A pyramid on a square plain.
    fn pyramid(height: f64) -> Chart {
        let around = |r: f64| [[r, 0.0, 0.0], [0.0, r, 0.0], [-r, 0.0, 0.0], [0.0, -r, 0.0]];
        let mut positions = around(1.0).to_vec();
        positions.extend(around(3.0));
        positions.push([0.0, 0.0, height]);
        let sides = (0..4).map(|i| (i, (i + 1) % 4));
        let faces: Vec<_> = sides.flat_map(|(i, j)| [[i, j, 8], [i, 4 + i, 4 + j], [i, 4 + j, j]]).collect();
        piece(&positions, &faces)
    }

    fn is_hopeless(piece: &Chart, max_stretch: f64) -> bool {
        Foresight::new(max_stretch).is_hopeless_as_it_is(piece, &mut || Ok(())).expect("nobody aborts")
    }

    #[test]
    fn a_spike_is_not_worth_a_map_and_what_is_flat_always_is() {
        assert!(is_hopeless(&pyramid(9.0), 1.15));
        assert!(!is_hopeless(&pyramid(0.1), 1.15));
        assert!(!is_hopeless(&pyramid(0.0), 1.0));
        assert!(!is_hopeless(&piece(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]), 1.0));
    }

    #[test]
    fn the_foreseen_angles_of_a_tip_sum_to_about_a_turn() {
        let piece = pyramid(0.5);
        let mut foresight = Foresight::new(1.15);
        foresight.is_hopeless_as_it_is(&piece, &mut || Ok(())).expect("nobody aborts");
        let foreseen = foresight.angles_as_it_is(&piece.mesh).expect("it is not flat");
        assert_eq!(foresight.angles(&piece), Some(foreseen.clone()), "it is its own chart");
        let around_the_tip = |angles: &[f64]| {
            let corners = piece.topology.corners().filter(|&c| piece.topology.vertex(c) == VertexId::new(8));
            corners.map(|c| angles[c.index()]).sum::<f64>()
        };
        let off = |angles: &[f64]| (std::f64::consts::TAU - around_the_tip(angles)).abs();
        let own = piece.mesh.corner_angles();
        assert!(off(&foreseen) < 0.2 * off(&own), "{} for {}", off(&foreseen), off(&own));
    }

    /// It would be parted for ever.
    #[test]
    fn a_face_without_area_is_not_hopeless() {
        assert!(!is_hopeless(&piece(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]]), 1.15));
    }

    #[test]
    fn a_longer_seam_is_worth_most_of_the_stretch_or_less_where_a_map_may_miss_the_aim() {
        // A foot; a gargoyle; a horse, whose map misses the aim before that cut.
        assert!(is_worth_it(0.34, 1.32, false));
        assert!(!is_worth_it(0.93, 1.05, true));
        assert!(is_worth_it(0.70, 1.05, true) && !is_worth_it(0.70, 1.05, false));
        assert!(!is_worth_it(f64::NAN, 1.0, true), "nothing foreseen before");
        let mut foresight = Foresight::new(1.15);
        assert!(!foresight.is_doubtful());
        foresight.l2 = Some(1.10);
        assert!(!foresight.is_doubtful());
        foresight.l2 = Some(1.12);
        assert!(foresight.is_doubtful());
    }

    #[test]
    fn maps_far_from_the_aim_are_given_up_sooner() {
        let rounds_until = |l2: f64, is_stalled: fn(&mut Progress, f64) -> bool| {
            let mut progress = Progress::default();
            (0..).find(|_| is_stalled(&mut progress, l2)).expect("an end")
        };
        assert_eq!(rounds_until(1.3, Progress::is_stalled), PATIENCE);
        assert_eq!(rounds_until(1.3, |progress, l2| progress.is_stalled_in_maps(l2, 1.15)), PATIENCE_OF_MAPS);
        assert_eq!(rounds_until(1.155, |progress, l2| progress.is_stalled_in_maps(l2, 1.15)), PATIENCE);
    }

    #[test]
    fn a_map_that_is_worse_than_foreseen_makes_less_worth_trying() {
        let mut foresight = Foresight::new(1.15);
        let before = foresight.worth_trying;
        foresight.l2 = Some(1.13);
        foresight.learn(1.2);
        assert!(foresight.worth_trying < before && foresight.worth_trying > 1.05, "{}", foresight.worth_trying);
        let worse = foresight.worth_trying;
        foresight.learn(1.12);
        assert_eq!(foresight.worth_trying, worse, "better than foreseen changes nothing");
    }
}
