//! Relaxing a drawing: from a valid one to one of less energy, through valid ones only.
//!
//! The unknowns are the points of the vertices. One loop of projected Newton serves every energy: the second derivatives
//! of each triangle without their negative part, one sparse factorisation, a line search that ends before the first
//! triangle collapses and accepts only what an exact predicate finds counter-clockwise.
//!
//! Where the areas of a drawing and of its surface differ by powers of ten, the steps from it are short: every triangle
//! then gets a shape of its own to go for, as much of the way to that on the surface as is within reach, anew for every
//! step (progressive parameterizations: Liu, Ye, Ni, Fu 2018).

mod energy;
mod linear;
mod rest;
mod run;
mod terms;

use crate::EmbedError;
use crate::objective::Objective;
use crate::place::{centred, check_start, pins, scaled_to};
use crate::plane::not_counter_clockwise;
use abf_constraints::AngleProblem;
use abf_control::{IterationRecord, Observer, SettingError, StopCriteria, Termination, Watch};
use abf_mesh::{Point2, Topology, TriMesh};
use energy::{AngleEnergy, Density, Isometric, Slider, SymmetricDirichlet};
use rest::{RestShape, rest_shapes, within_reach};
pub use run::RelaxStep;
use run::{Outcome, Run};
use std::fmt;
use std::str::FromStr;
use terms::{Directions, Terms};

/// A drawing whose energy, for area 1, is below this is near enough for plain steps.
const NEAR: f64 = 30.0;

/// A drawing in which at most this part of the triangles is out of reach is near enough, too.
const FEW: f64 = 1e-3;

/// At most so many steps are progressive.
const MOST_PROGRESSIVE: usize = 140;

/// What is to be little in a map.
///
/// It is read from, and written as, `abf`, `isometric`, `usable` or the number θ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Energy {
    /// The errors of angles: `Σ w (x − a)²` with the barrier of the descent. Areas are free.
    Abf,
    /// The symmetric Dirichlet energy `∫ s₁² + s₂² + s₁⁻² + s₂⁻² − 4` over the surface, its area as 1; `s₁` and `s₂` are the
    /// singular values of the map: lengths are kept.
    #[default]
    Isometric,
    /// `∫ s₁/s₂ + s₂/s₁ − 2 + θ (s₁s₂ + 1/(s₁s₂) − 2)`: angles first, areas with the weight θ, in (0, ∞).
    Slider(f64),
}

impl Energy {
    /// The slider with θ = 0.01: hardly less true in angles than the least angle energy, and areas within bounds.
    pub const USABLE: Self = Self::Slider(0.01);

    /// Checks that θ is in its range.
    ///
    /// # Errors
    /// [`SettingError`] with the range.
    pub fn check(self) -> Result<(), SettingError> {
        match self {
            Self::Slider(theta) if !(theta > 0.0 && theta.is_finite()) => {
                Err(SettingError::new("energy", "abf, isometric, usable or a positive number", theta))
            }
            Self::Slider(_) | Self::Abf | Self::Isometric => Ok(()),
        }
    }
}

impl fmt::Display for Energy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Abf => f.write_str("abf"),
            Self::Isometric => f.write_str("isometric"),
            Self::Slider(theta) if Self::Slider(*theta) == Self::USABLE => f.write_str("usable"),
            Self::Slider(theta) => theta.fmt(f),
        }
    }
}

impl FromStr for Energy {
    type Err = SettingError;

    fn from_str(s: &str) -> Result<Self, SettingError> {
        let energy = match s {
            "abf" => Self::Abf,
            "isometric" => Self::Isometric,
            "usable" => Self::USABLE,
            // A word is no number, which is out of range.
            other => Self::Slider(other.parse().unwrap_or(f64::NAN)),
        };
        let wrong = |error: SettingError| SettingError::new(error.name, error.allowed, format_args!("'{s}'"));
        energy.check().map(|()| energy).map_err(wrong)
    }
}

/// The settings of a relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Relax {
    /// What is to be little.
    pub energy: Energy,
    /// Converged means that a full step promises to lower the energy by no more than half of this share of it; beside
    /// [`Energy::Abf`] the weight of the barrier counts for every angle.
    pub energy_tolerance: f64,
    /// At most so many steps, progressive ones included, of which there are at most 140.
    pub max_steps: usize,
    /// The weight of the barrier beside [`Energy::Abf`], as [`Descent::barrier_floor`](crate::Descent::barrier_floor).
    pub barrier: f64,
}

impl Default for Relax {
    fn default() -> Self {
        Self { energy: Energy::default(), energy_tolerance: 1e-6, max_steps: 400, barrier: 1e-3 }
    }
}

/// A drawing in which every triangle is counter-clockwise, by an exact predicate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RelaxedDrawing {
    /// One point per vertex; the origin for vertices that no face uses.
    pub uv: Vec<Point2<f64>>,
    /// How it ended. [`Termination::Stalled`]: no step led anywhere.
    pub termination: Termination,
    /// The energy of the start, at the scale at which it is least; without the barrier, here and below.
    pub energy_before: f64,
    /// The energy at the end, at the scale of the last step.
    pub energy: f64,
    /// Every step.
    pub steps: Vec<RelaxStep>,
    /// The same steps as observers were told of them.
    pub iterations: Vec<IterationRecord>,
    /// Whether the UV area is the area of the surface. If doubles do not hold the drawing at that scale it is the
    /// nearest power of two that multiplies the scale, which moves no bit.
    pub area_matched: bool,
}

impl Relax {
    /// Relaxes a drawing of `mesh`, one point per vertex: of a disk, or of a connected surface with holes.
    ///
    /// Of `stop` it heeds the time limit. Without time there is the start. Same input, same bits.
    ///
    /// # Errors
    /// [`EmbedError::Setting`]; [`EmbedError::PointCount`] and [`EmbedError::StartFlipped`] for a start that is not a
    /// drawing; [`EmbedError::Cancelled`]; [`EmbedError::Linear`] for a mesh whose matrices are too large.
    ///
    /// # Panics
    /// If the problem is not that of `mesh`.
    pub fn solve(
        &self,
        mesh: &TriMesh,
        problem: &AngleProblem<'_>,
        start: &[Point2<f64>],
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<RelaxedDrawing, EmbedError> {
        self.check()?;
        stop.check()?;
        let topology = problem.topology();
        check_start(topology, start)?;
        let mut watch = Watch::start(stop, observer);
        let crowded = pins(topology, start)[0];
        let uv = centred(topology, start, crowded);
        let rest = rest_shapes(mesh);
        watch.checkpoint()?;
        let density: &dyn Density = match self.energy {
            Energy::Slider(theta) => &Slider { theta },
            Energy::Abf | Energy::Isometric => &SymmetricDirichlet,
        };
        let isometric = Isometric { density, rest: &rest };
        let uv = scaled_by(topology, uv, isometric.best_scale(topology, start));
        let directions = Directions::new(topology, &[crowded], &mut || watch.checkpoint())?;
        let mut run = Run {
            topology,
            uv,
            directions,
            steps: Vec::new(),
            reported: Vec::new(),
            tolerance: self.energy_tolerance,
            max_steps: self.max_steps,
            unit: mesh.area().sqrt(),
        };
        let angle_energy = AngleEnergy { objective: Objective { problem, barrier: self.barrier } };
        let terms = match self.energy {
            Energy::Abf => Terms { topology, triangles: &angle_energy, springs: &[] },
            Energy::Isometric | Energy::Slider(_) => Terms { topology, triangles: &isometric, springs: &[] },
        };
        let energy_before = terms.without_barrier(&run.uv);
        if self.energy != Energy::Abf {
            approach(&mut run, density, &rest, &mut watch)?;
        }
        let termination = run.descend(&terms, &mut watch)?;
        let energy = terms.without_barrier(&run.uv);
        let (uv, area_matched) = scaled_to(topology, run.uv, mesh.area());
        Ok(RelaxedDrawing {
            uv,
            termination,
            energy_before,
            energy,
            steps: run.steps,
            iterations: run.reported,
            area_matched,
        })
    }

    /// Checks that every setting is in its range; [`Relax::solve`] calls it first.
    ///
    /// # Errors
    /// [`EmbedError::Setting`] naming the setting and its range.
    pub fn check(&self) -> Result<(), EmbedError> {
        self.energy.check()?;
        for (name, value) in [("energy_tolerance", self.energy_tolerance), ("barrier", self.barrier)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SettingError::new(name, "positive and finite", value).into());
            }
        }
        if self.max_steps == 0 {
            return Err(SettingError::new("max_steps", "at least 1", 0).into());
        }
        Ok(())
    }
}

/// Progressive steps, while the drawing is far from the surface.
fn approach(
    run: &mut Run<'_>,
    density: &dyn Density,
    rest: &[RestShape],
    watch: &mut Watch<'_>,
) -> Result<(), EmbedError> {
    let topology = run.topology;
    let truth = Isometric { density, rest };
    let is_near = |uv: &[Point2<f64>]| Terms { topology, triangles: &truth, springs: &[] }.value(uv) < NEAR;
    while run.steps.len() < MOST_PROGRESSIVE && run.end(watch).is_none() && !is_near(&run.uv) {
        let (reached, limited) = within_reach(topology, &run.uv, rest);
        if limited as f64 <= FEW * topology.face_count() as f64 {
            return Ok(());
        }
        let triangles = &Isometric { density, rest: &reached };
        let outcome = run.step(&Terms { topology, triangles, springs: &[] }, true, watch)?;
        // The same step would be found again.
        let has_moved = run.steps.last().is_some_and(|step| step.step_length > 0.0);
        if outcome == Outcome::Stuck || !has_moved {
            return Ok(());
        }
    }
    Ok(())
}

/// The drawing at another scale, or at the nearest power of two where doubles do not hold it at that scale.
fn scaled_by(topology: &Topology, uv: Vec<Point2<f64>>, scale: f64) -> Vec<Point2<f64>> {
    let by = |scale: f64| -> Vec<Point2<f64>> { uv.iter().map(|p| p * scale).collect() };
    let is_held = |uv: &[Point2<f64>]| not_counter_clockwise(topology, uv).is_none();
    let scales = [scale, scale.log2().round().exp2()];
    scales.into_iter().map(by).find(|uv| is_held(uv)).unwrap_or(uv)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tutte;
    use abf_constraints::GuessSettings;
    use abf_control::Silent;
    use abf_mesh::VertexId;
    use abf_shapes::Shape;

    #[test]
    fn from_tutte_and_from_another_optimum_the_same_energy_comes_out() {
        let mesh = Shape::BumpySheet.mesh(800);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a problem");
        let solve = |energy, start: &[Point2<f64>]| {
            let relax = Relax { energy, ..Relax::default() };
            let drawing =
                relax.solve(&mesh, &problem, start, &StopCriteria::default(), &mut Silent).expect("a drawing");
            assert_eq!(drawing.termination, Termination::Converged, "{energy}");
            assert!(drawing.energy > 0.0 && drawing.energy < drawing.energy_before, "{energy}");
            assert_eq!(not_counter_clockwise(&topology, &drawing.uv), None);
            drawing
        };
        let first = tutte(&mesh, &topology).expect("an embedding").uv;
        let conformal = solve(Energy::Abf, &first).uv;
        for energy in [Energy::Isometric, Energy::USABLE] {
            let [one, other] = [&first, &conformal].map(|start| solve(energy, start).energy);
            assert!((one - other).abs() < 1e-5 * one, "{energy}: {one} {other}");
        }
    }

    #[test]
    fn a_surface_that_is_flat_already_comes_out_as_it_is() {
        let mesh = Shape::BumpySheet.mesh(200);
        let points = mesh.positions().iter().map(|p| abf_mesh::Point3::new(p.x, p.y, 0.0)).collect();
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(VertexId::index)).collect();
        let mesh = TriMesh::new(points, &faces).expect("indices in range");
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a problem");
        let start = tutte(&mesh, &topology).expect("an embedding").uv;
        let drawing = Relax::default().solve(&mesh, &problem, &start, &StopCriteria::default(), &mut Silent);
        let drawing = drawing.expect("a drawing");
        assert!(drawing.termination == Termination::Converged && drawing.energy < 1e-12, "{}", drawing.energy);
        let length = |a: usize, b: usize| (drawing.uv[a] - drawing.uv[b]).norm();
        for [a, b, _] in faces {
            assert!((length(a, b) - (mesh.positions()[a] - mesh.positions()[b]).norm()).abs() < 1e-6);
        }
    }

    #[test]
    fn a_start_that_is_no_drawing_is_refused() {
        let mesh = Shape::BumpySheet.mesh(50);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a problem");
        let solve = |start: &[Point2<f64>]| {
            Relax::default().solve(&mesh, &problem, start, &StopCriteria::default(), &mut Silent).expect_err("no start")
        };
        assert!(matches!(solve(&[]), EmbedError::PointCount { .. }));
        let in_one_place = vec![Point2::origin(); mesh.vertex_count()];
        assert!(matches!(solve(&in_one_place), EmbedError::StartFlipped { .. }));
    }
}
