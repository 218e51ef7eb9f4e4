//! Relaxing a drawing: from a valid one to one of less energy, through valid ones only.
//!
//! The unknowns are the points of the vertices. One loop of projected Newton serves every energy: the second derivatives
//! of each triangle without their negative part, one sparse factorisation, a line search that ends before the first
//! triangle collapses and accepts only what an exact predicate finds counter-clockwise.
//!
//! Where the areas of a drawing and of its surface differ by powers of ten, the steps from it are short: every triangle
//! then gets a shape of its own to go for, as much of the way to that on the surface as is within reach, anew for every
//! step (progressive parameterizations: Liu, Ye, Ni, Fu 2018).

mod energies;
mod energy;
mod guard;
mod injective;
mod linear;
mod pinned;
mod pins;
mod rest;
mod run;
mod settings;
mod terms;

use crate::EmbedError;
use crate::place::{centred, check_start, pins as anchors, scaled_to};
use crate::plane::not_counter_clockwise;
use abf_constraints::AngleProblem;
use abf_control::{IterationRecord, Observer, StopCriteria, Termination, Watch};
use abf_mesh::{Point2, Topology, TriMesh};
use energies::Energies;
use energy::{Isometric, SymmetricDirichlet};
pub use injective::{InjectiveDrawing, boundary_gap, check_gap};
pub use pinned::{PinResidual, PinnedDrawing};
pub use pins::{Pin, PinError, PinFault, PinWeight, Pins};
use rest::{rest_shapes, within_reach};
pub use run::RelaxStep;
use run::{Outcome, Run};
pub use settings::{Energy, Relax};
use std::sync::Arc;
use terms::{Directions, Terms};

/// A drawing whose energy, for area 1, is below this is near enough for plain steps.
const NEAR: f64 = 30.0;

/// A drawing in which at most this part of the triangles is out of reach is near enough, too.
const FEW: f64 = 1e-3;

/// At most so many steps are progressive.
const MOST_PROGRESSIVE: usize = 140;

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
        let crowded = anchors(topology, start)[0];
        let uv = centred(topology, start, crowded);
        let energies = Energies::new(self, mesh, problem);
        watch.checkpoint()?;
        let uv = scaled_by(topology, uv, energies.isometric.best_scale(topology, start));
        let directions = Directions::new(topology, &[crowded], &mut || watch.checkpoint())?;
        let mut run = Run::new(self, (topology, problem.mesh_angles()), uv, directions, mesh.area());
        let terms = energies.terms(topology, &[]);
        let energy_before = terms.without_barrier(&run.uv);
        run.start(&terms, &mut watch)?;
        if self.energy != Energy::Abf {
            approach(&mut run, &energies.isometric, &mut watch)?;
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
}

impl Relax {
    /// The energy of a drawing, at the scale at which it is least, without barriers; not finite for one that has flips.
    ///
    /// # Panics
    /// If the problem is not that of `mesh`, or there is not one point for every vertex.
    #[must_use]
    pub fn energy_of(&self, mesh: &TriMesh, problem: &AngleProblem<'_>, uv: &[Point2<f64>]) -> f64 {
        let topology = problem.topology();
        let energies = Energies::new(self, mesh, problem);
        let scale = energies.isometric.best_scale(topology, uv);
        let scaled: Vec<Point2<f64>> = uv.iter().map(|p| p * scale).collect();
        energies.terms(topology, &[]).without_barrier(&scaled)
    }
}

/// A drawing of a surface after some steps towards the least symmetric Dirichlet energy, or as it is if there is no time.
pub(crate) fn roomier(
    mesh: &TriMesh,
    topology: &Topology,
    start: &[Point2<f64>],
    watch: &mut Watch<'_>,
) -> Result<Vec<Point2<f64>>, EmbedError> {
    /// Triangles with room are enough.
    const ROOMY: Relax = Relax { energy: Energy::Isometric, energy_tolerance: 1e-2, max_steps: 60, barrier: 1e-3 };
    if watch.interruption().is_some() {
        return Ok(start.to_vec());
    }
    let crowded = anchors(topology, start)[0];
    let truth = Isometric { density: Arc::new(SymmetricDirichlet), rest: rest_shapes(mesh) };
    let uv = scaled_by(topology, centred(topology, start, crowded), truth.best_scale(topology, start));
    let directions = Directions::new(topology, &[crowded], &mut || watch.checkpoint())?;
    let mut run = Run { is_quiet: true, ..Run::new(&ROOMY, (topology, &[]), uv, directions, mesh.area()) };
    approach(&mut run, &truth, watch)?;
    run.descend(&Terms { topology, triangles: &truth, springs: &[], barrier: None }, watch)?;
    Ok(run.uv)
}

/// Progressive steps, while the drawing is far from the surface.
fn approach(run: &mut Run<'_>, truth: &Isometric, watch: &mut Watch<'_>) -> Result<(), EmbedError> {
    let topology = run.topology;
    let is_near =
        |uv: &[Point2<f64>]| Terms { topology, triangles: truth, springs: &[], barrier: None }.value(uv) < NEAR;
    while run.steps.len() < MOST_PROGRESSIVE && run.end(watch).is_none() && !is_near(&run.uv) {
        let (rest, limited) = within_reach(topology, &run.uv, &truth.rest);
        if limited as f64 <= FEW * topology.face_count() as f64 {
            return Ok(());
        }
        let triangles = &Isometric { density: Arc::clone(&truth.density), rest };
        let outcome = run.step(&Terms { topology, triangles, springs: &[], barrier: None }, true, watch)?;
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
