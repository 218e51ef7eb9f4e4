//! Targets, weights and the initial guess.

use crate::{BoundaryConditions, BoundaryError, ConstraintRows};
use abf_control::SettingError;
use abf_mesh::{CornerId, DiskError, Topology, VertexId};
use abf_parallel::prelude::*;
use std::f64::consts::{PI, TAU};

/// Fewer corners or vertices are not worth a thread.
const PER_TASK: usize = 1 << 13;

/// A triangle with an angle below this, rad, has no shape to speak of.
const NO_SHAPE: f64 = 1e-6;

/// How the initial guess is made from the angles of the surface (LinABF §4.2).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct GuessSettings {
    /// Rings whose deficit `|2π − Σα°|` is above this, in radians, start from their target angles
    /// instead of their own. `None` never switches. LinABF recommends 1.
    pub ring_switch: Option<f64>,
    /// The smallest angle a pass may start from, rad; the largest is π minus this. Angles beyond
    /// are clamped to it, and counted. Triangles without a shape get at least this, too.
    pub angle_bound: f64,
    /// Whether an angle that the surface itself has beyond the bound may stay as it is: the bound of each corner is then
    /// the smaller of [`angle_bound`](Self::angle_bound) and its own angle, and likewise below π. A thin triangle of a
    /// flat sheet keeps its shape this way.
    pub keep_thin: bool,
}

impl Default for GuessSettings {
    fn default() -> Self {
        Self { ring_switch: Some(1.0), angle_bound: 1e-3, keep_thin: true }
    }
}

impl GuessSettings {
    /// Clamps every angle to `[angle_bound, π − angle_bound]` and says how many were outside.
    /// NaN becomes the lower bound.
    #[must_use]
    pub fn clamp(&self, angles: &mut [f64]) -> usize {
        let (low, high) = (self.angle_bound, PI - self.angle_bound);
        let is_outside = |x: &&mut f64| !(low..=high).contains(*x);
        let clamp_in = |x: &mut f64| *x = if *x > high { high } else { low };
        angles.par_iter_mut().with_min_len(PER_TASK).filter(is_outside).map(clamp_in).count()
    }

    /// Checks that every setting is in its range; posing a problem does so first.
    ///
    /// # Errors
    /// [`ProblemError::Setting`] naming the setting and its range.
    pub fn check(&self) -> Result<(), ProblemError> {
        if self.ring_switch.is_some_and(|t| t.is_nan() || t < 0.0) {
            let value = self.ring_switch.unwrap_or_default();
            return Err(SettingError::new("ring_switch", "at least 0", value).into());
        }
        if !(self.angle_bound > 0.0 && self.angle_bound < PI / 3.0) {
            let value = self.angle_bound;
            return Err(SettingError::new("angle_bound", "in (0, π/3)", value).into());
        }
        Ok(())
    }
}

/// Why there is no angle problem to solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// The constraints describe disks only.
    #[error(transparent)]
    NotADisk(#[from] DiskError),
    /// There must be one angle for every corner.
    #[error("{given} angles for {corners} corners")]
    AngleCount {
        /// How many angles were given.
        given: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// An angle that no triangle has.
    #[error(
        "corner {corner} of face {face} has the angle {angle} rad, which is not in [0, π] ({count} such corners in all)"
    )]
    Angle {
        /// The place of the first such corner in its face: 0, 1 or 2.
        corner: usize,
        /// Its face.
        face: usize,
        /// Its angle.
        angle: f64,
        /// How many there are.
        count: usize,
    },
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A boundary that no map of this surface has.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
}

/// A disk with the angles to come close to and the place to start from.
#[derive(Clone, Debug)]
pub struct AngleProblem<'a> {
    topology: &'a Topology,
    rows: ConstraintRows,
    settings: GuessSettings,
    mesh_angles: Vec<f64>,
    target: Vec<f64>,
    weight: Vec<f64>,
    initial_guess: Vec<f64>,
    switched_rings: usize,
    clamped_angles: usize,
    shapeless_faces: usize,
    /// How many angles of the surface are beyond the bounds and may stay there.
    thin_corners: usize,
    expected: Option<Vec<f64>>,
    boundary: Option<BoundaryConditions>,
}

impl<'a> AngleProblem<'a> {
    /// The problem of a disk whose corners have `mesh_angles` (radians, one per corner).
    ///
    /// A triangle with an angle below 1e-6, as one without area has, has no shape that could be kept: its angles are
    /// raised to [`GuessSettings::angle_bound`] where they are below, and the rest of π is shared by what they have
    /// above it. So `α°`, targets and weights are those of a thin triangle instead.
    ///
    /// # Errors
    /// [`ProblemError`] when the surface is no disk, an angle is not in `[0, π]`, or a setting
    /// is out of range.
    pub fn new(topology: &'a Topology, mesh_angles: Vec<f64>, settings: GuessSettings) -> Result<Self, ProblemError> {
        settings.check()?;
        let (is_disk, rows) = abf_parallel::join(|| topology.require_disk(), || ConstraintRows::new(topology));
        is_disk?;
        Self::with_rows(topology, rows, mesh_angles, settings)
    }

    /// The same for a surface that need not be a disk. Its constraints are necessary and, where there are holes or
    /// handles, not sufficient: with b boundary loops and g handles `4 (b − 1 + g)` conditions are missing, and angles that
    /// satisfy the others need not close around them.
    ///
    /// # Errors
    /// [`ProblemError`] when an angle is not in `[0, π]`, or a setting is out of range.
    pub fn unclosed(
        topology: &'a Topology,
        mesh_angles: Vec<f64>,
        settings: GuessSettings,
    ) -> Result<Self, ProblemError> {
        settings.check()?;
        Self::with_rows(topology, ConstraintRows::new(topology), mesh_angles, settings)
    }

    fn with_rows(
        topology: &'a Topology,
        rows: ConstraintRows,
        mut mesh_angles: Vec<f64>,
        settings: GuessSettings,
    ) -> Result<Self, ProblemError> {
        check_angles(topology, &mesh_angles)?;
        let shapeless_faces = give_shape(&mut mesh_angles, settings.angle_bound);
        let sum = |i: usize| rows.hubs(i).iter().map(|c| mesh_angles[c.index()]).sum::<f64>();
        let sums: Vec<f64> = (0..rows.interior_count()).into_par_iter().with_min_len(PER_TASK).map(sum).collect();
        let is_switched = |sum: f64| settings.ring_switch.is_some_and(|threshold| (TAU - sum).abs() > threshold);
        let switched_rings = sums.iter().filter(|&&sum| is_switched(sum)).count();
        let ring = |c: usize| rows.interior_index(topology.vertex(CornerId::new(c))).map(|i| sums[i]);
        let target_of = |(c, &angle): (usize, &f64)| ring(c).map_or(angle, |sum| angle * (TAU / sum));
        let angles = || mesh_angles.par_iter().with_min_len(PER_TASK).enumerate();
        let target: Vec<f64> = angles().map(target_of).collect();
        let start_of = |(c, &angle): (usize, &f64)| if ring(c).is_some_and(is_switched) { target[c] } else { angle };
        let mut guess: Vec<f64> = match switched_rings {
            0 => mesh_angles.clone(),
            _ => angles().map(start_of).collect(),
        };
        let bounds = settings.angle_bound..=PI - settings.angle_bound;
        let thin_corners = match settings.keep_thin {
            true => mesh_angles.iter().filter(|x| !bounds.contains(x)).count(),
            false => 0,
        };
        let clamped_angles = clamp(&settings, &mesh_angles, thin_corners, &mut guess);
        let weight = target.par_iter().with_min_len(PER_TASK).map(|a| 1.0 / (a * a)).collect();
        Ok(Self {
            topology,
            rows,
            settings,
            mesh_angles,
            target,
            weight,
            initial_guess: guess,
            switched_rings,
            clamped_angles,
            shapeless_faces,
            thin_corners,
            expected: None,
            boundary: None,
        })
    }

    /// The same with conditions on the boundary. Only some solvers keep them; the residual of a solution tells.
    #[must_use]
    pub fn with_boundary(mut self, boundary: Option<BoundaryConditions>) -> Self {
        self.boundary = boundary;
        self
    }

    /// The same, started from these angles, one per corner, rad; they are kept inside the bounds. Targets and weights
    /// stay as they are.
    ///
    /// # Panics
    /// If there is not one angle per corner.
    #[must_use]
    pub fn with_initial_guess(mut self, angles: Vec<f64>) -> Self {
        assert_eq!(angles.len(), self.initial_guess.len(), "one angle per corner");
        self.initial_guess = angles;
        self.clamped_angles = clamp(&self.settings, &self.mesh_angles, self.thin_corners, &mut self.initial_guess);
        self.switched_rings = 0;
        self
    }

    /// The same, with angles near which the solution is expected, one per corner, rad; they are kept inside the bounds.
    /// They decide where LinABF linearises first, and nothing else: what the solution is to be close to stays.
    ///
    /// # Panics
    /// If there is not one angle per corner.
    #[must_use]
    pub fn with_expected(mut self, mut angles: Vec<f64>) -> Self {
        assert_eq!(angles.len(), self.initial_guess.len(), "one angle per corner");
        let _ = self.clamp(&mut angles);
        self.expected = Some(angles);
        self
    }

    /// Angles near which the solution is expected, if that is known.
    #[must_use]
    pub fn expected(&self) -> Option<&[f64]> {
        self.expected.as_deref()
    }

    /// The conditions on the boundary, if there are any.
    #[must_use]
    pub fn boundary(&self) -> Option<&BoundaryConditions> {
        self.boundary.as_ref()
    }

    /// Who meets whom.
    #[must_use]
    pub fn topology(&self) -> &'a Topology {
        self.topology
    }

    /// The numbering of the constraints.
    #[must_use]
    pub fn rows(&self) -> &ConstraintRows {
        &self.rows
    }

    /// How the initial guess was made.
    #[must_use]
    pub fn settings(&self) -> &GuessSettings {
        &self.settings
    }

    /// α°: the angles of the surface, those of triangles without a shape bounded.
    #[must_use]
    pub fn mesh_angles(&self) -> &[f64] {
        &self.mesh_angles
    }

    /// a: the target angles, `α° · 2π / Σα°` around an interior vertex, α° around a boundary vertex
    /// (VMV04 §5; LinABF §4.2 calls them the exponential map of the one-ring). Can reach π and beyond
    /// where a ring has little angle to share; never clipped.
    #[must_use]
    pub fn target(&self) -> &[f64] {
        &self.target
    }

    /// w = 1/a²: the weight of each corner in the energy `Σ w (x − a)²`.
    #[must_use]
    pub fn weight(&self) -> &[f64] {
        &self.weight
    }

    /// `Σ w (x − a)²`: what every solver with a fixed target minimises (ABF; VMV04 §5).
    #[must_use]
    pub fn energy(&self, angles: &[f64]) -> f64 {
        let terms = self.weight.iter().zip(&self.target).zip(angles);
        terms.map(|((w, a), x)| w * (x - a) * (x - a)).sum()
    }

    /// α: where to start and where LinABF linearises, inside the angle bounds.
    #[must_use]
    pub fn initial_guess(&self) -> &[f64] {
        &self.initial_guess
    }

    /// How many rings start from their target angles because of their deficit.
    #[must_use]
    pub fn switched_rings(&self) -> usize {
        self.switched_rings
    }

    /// How many triangles had no shape and were given one.
    #[must_use]
    pub fn shapeless_faces(&self) -> usize {
        self.shapeless_faces
    }

    /// How many angles of the initial guess were clamped to the angle bounds.
    #[must_use]
    pub fn clamped_angles(&self) -> usize {
        self.clamped_angles
    }

    /// How many angles of the surface are beyond the angle bounds and may stay there: see [`GuessSettings::keep_thin`].
    #[must_use]
    pub fn thin_corners(&self) -> usize {
        self.thin_corners
    }

    /// Clamps every angle to the bounds of its corner and says how many were outside. NaN becomes the lower bound.
    #[must_use]
    pub fn clamp(&self, angles: &mut [f64]) -> usize {
        clamp(&self.settings, &self.mesh_angles, self.thin_corners, angles)
    }

    /// `2π − Σα°` at an interior vertex: its angle deficit, the discrete Gauss curvature, rad.
    #[must_use]
    pub fn deficit(&self, vertex: VertexId) -> f64 {
        TAU - ring_sum(self.topology, vertex, &self.mesh_angles)
    }
}

/// Clamps angles to the bounds of their corners, which reach as far as the angles of the surface where some are thin.
fn clamp(settings: &GuessSettings, own: &[f64], thin_corners: usize, angles: &mut [f64]) -> usize {
    if thin_corners == 0 {
        return settings.clamp(angles);
    }
    let bound = settings.angle_bound;
    let clamp_in = |(x, &own): (&mut f64, &f64)| {
        let (low, high) = (bound.min(own), (PI - bound).max(own));
        let is_outside = !(low..=high).contains(x);
        if is_outside {
            *x = if *x > high { high } else { low };
        }
        usize::from(is_outside)
    };
    angles.par_iter_mut().with_min_len(PER_TASK).zip(own).map(clamp_in).sum()
}

fn ring_sum(topology: &Topology, vertex: VertexId, angles: &[f64]) -> f64 {
    topology.fan(vertex).map(|c| angles[c.index()]).sum()
}

/// Bounds the angles of the triangles that have no shape, and counts them.
fn give_shape(angles: &mut [f64], bound: f64) -> usize {
    let is_shapeless = |face: &[f64]| face.iter().any(|x| *x < NO_SHAPE);
    let mut count = 0;
    for face in angles.chunks_exact_mut(3).filter(|face| is_shapeless(face)) {
        face.iter_mut().for_each(|x| *x = x.max(bound) - bound);
        let sum: f64 = face.iter().sum();
        let room = PI - 3.0 * bound;
        // Without any angle above the bound there is nothing to share by.
        face.iter_mut().for_each(|x| *x = bound + room * if sum > 0.0 { *x / sum } else { 1.0 / 3.0 });
        count += 1;
    }
    count
}

fn check_angles(topology: &Topology, angles: &[f64]) -> Result<(), ProblemError> {
    if angles.len() != topology.corner_count() {
        return Err(ProblemError::AngleCount { given: angles.len(), corners: topology.corner_count() });
    }
    let outside = |x: &f64| !(0.0..=PI).contains(x);
    match angles.iter().position(outside) {
        None => Ok(()),
        Some(c) => Err(ProblemError::Angle {
            corner: c % 3,
            face: c / 3,
            angle: angles[c],
            count: angles.iter().filter(|x| outside(x)).count(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    fn topology(mesh: &abf_mesh::TriMesh) -> Topology {
        Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
    }

    #[test]
    fn a_triangle_without_any_angle_becomes_equilateral() {
        // Found by fuzzing: it got angles that were no numbers.
        let mut angles = [0.0, 1e-9, 0.0];
        assert_eq!(give_shape(&mut angles, 1e-3), 1);
        assert!(angles.iter().all(|x| (x - PI / 3.0).abs() < 1e-12), "{angles:?}");
    }

    #[test]
    fn targets_close_every_ring() {
        let mesh = Shape::BumpySheet.mesh(500);
        let topology = topology(&mesh);
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        for &v in problem.rows().interior() {
            assert!((ring_sum(&topology, v, problem.target()) - TAU).abs() < 1e-13);
        }
        for c in topology.corners().filter(|&c| topology.is_boundary(topology.vertex(c))) {
            assert_eq!(problem.target()[c.index()], problem.mesh_angles()[c.index()]);
        }
    }

    #[test]
    fn the_ring_switch_takes_the_target_on_rings_of_large_deficit_only() {
        let mesh = Shape::Obtuse.mesh(3);
        let topology = topology(&mesh);
        let with = |ring_switch| {
            let settings = GuessSettings { ring_switch, ..GuessSettings::default() };
            AngleProblem::new(&topology, mesh.corner_angles(), settings).expect("a disk")
        };
        assert_eq!(with(Some(1.0)).switched_rings(), 1);
        assert_eq!(with(Some(5.0)).switched_rings(), 0);
        assert_eq!(with(None).initial_guess(), mesh.corner_angles());
        let problem = with(Some(1.0));
        assert!((problem.deficit(problem.rows().interior()[0]).abs() - 4.56).abs() < 0.01);
    }

    #[test]
    fn angles_outside_the_bounds_are_clamped_and_counted() {
        let settings = GuessSettings::default();
        let mut angles = [-0.5, 1.0, 3.2, f64::NAN, settings.angle_bound];
        assert_eq!(settings.clamp(&mut angles), 3);
        assert_eq!(angles, [1e-3, 1.0, PI - 1e-3, 1e-3, 1e-3]);
    }

    #[test]
    fn a_thin_triangle_keeps_its_angles_and_others_keep_the_bound() {
        let mesh = Shape::Obtuse.mesh(3);
        let topology = topology(&mesh);
        let mut own = mesh.corner_angles();
        own[..3].copy_from_slice(&[1e-4, PI - 3e-4, 2e-4]);
        let with = |keep_thin| {
            let settings = GuessSettings { keep_thin, ring_switch: None, ..GuessSettings::default() };
            AngleProblem::new(&topology, own.clone(), settings).expect("a disk")
        };
        let (kept, clamped) = (with(true), with(false));
        assert_eq!((kept.thin_corners(), kept.clamped_angles(), kept.initial_guess()), (3, 0, &own[..]));
        assert_eq!((clamped.thin_corners(), clamped.clamped_angles()), (0, 3));
        let mut angles = own.clone();
        (angles[0], angles[1], angles[4]) = (1e-5, 4.0, 1e-5);
        assert_eq!(kept.clamp(&mut angles), 3);
        assert_eq!((angles[0], angles[1], angles[4]), (1e-4, PI - 3e-4, 1e-3));
    }

    #[test]
    fn triangles_without_a_shape_are_given_a_thin_one_and_counted() {
        let mesh = Shape::Obtuse.mesh(3);
        let topology = topology(&mesh);
        let mut angles = mesh.corner_angles();
        angles[..3].copy_from_slice(&[0.0, PI, 0.0]);
        angles[3..6].copy_from_slice(&[PI / 2.0, 0.0, PI / 2.0]);
        let problem = AngleProblem::new(&topology, angles.clone(), GuessSettings::default()).expect("a disk");
        assert_eq!(problem.shapeless_faces(), 2);
        assert!((problem.mesh_angles()[1] - (PI - 2e-3)).abs() < 1e-15);
        assert!((problem.mesh_angles()[4] - 1e-3).abs() < 1e-15);
        let sum = |face: usize| problem.mesh_angles()[3 * face..3 * face + 3].iter().sum::<f64>();
        assert!((0..3).all(|face| (sum(face) - PI).abs() < 1e-14));
        assert_eq!(problem.mesh_angles()[6..], angles[6..], "what has a shape keeps it");
    }

    #[test]
    fn bad_settings_and_angles_are_named() {
        let mesh = Shape::Obtuse.mesh(3);
        let topology = topology(&mesh);
        let bad = GuessSettings { angle_bound: 2.0, ..GuessSettings::default() };
        let e = AngleProblem::new(&topology, mesh.corner_angles(), bad).unwrap_err();
        assert_eq!(e.to_string(), "angle_bound must be in (0, π/3), got 2");
        let mut angles = mesh.corner_angles();
        angles[4] = -0.5;
        let e = AngleProblem::new(&topology, angles, GuessSettings::default()).unwrap_err();
        assert_eq!(e, ProblemError::Angle { corner: 1, face: 1, angle: -0.5, count: 1 });
        let e = AngleProblem::new(&topology, vec![1.0; 4], GuessSettings::default()).unwrap_err();
        assert_eq!(e, ProblemError::AngleCount { given: 4, corners: 9 });
    }
}
