//! A drawing brought to its pins.

use super::energies::Energies;
use super::pins::{Pin, PinWeight, Pins, place, vertex};
use super::run::{RelaxStep, Run};
use super::settings::Relax;
use super::terms::{Directions, Spring};
use crate::EmbedError;
use crate::place::check_start;
use crate::plane::{of_face, orientation};
use abf_constraints::AngleProblem;
use abf_control::{Observer, StopCriteria, Termination, Watch};
use abf_mesh::{Point2, Topology, TriMesh, Vector2, VertexId};

/// The weights of hard pins over the area of the surface and the number of pins: one after the other, until all are near.
const WEIGHTS: [f64; 6] = [1e-1, 1e1, 1e3, 1e5, 1e7, 1e9];

/// A vertex this near to its place is put there, where the exact predicate allows it; the side of a square as large as the
/// surface is 1.
const NEAR: f64 = 1e-4;

/// How near a pin is to its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinResidual {
    /// Which vertex.
    pub vertex: u32,
    /// Whether it was to be met exactly.
    pub is_hard: bool,
    /// How far the vertex is from the place, in units of the UVs; 0 where it is there.
    pub distance: f64,
}

impl PinResidual {
    /// Whether it was to be met exactly, and is not.
    #[must_use]
    pub fn is_missed(&self) -> bool {
        self.is_hard && self.distance > 0.0
    }
}

/// A drawing with its pins.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PinnedDrawing {
    /// One point per vertex.
    pub uv: Vec<Point2<f64>>,
    /// How the last descent ended; [`Termination::Stalled`], too, where a hard pin is not in its place.
    pub termination: Termination,
    /// The energy at the end, without the pins and without a barrier, of a surface as large as the drawing.
    pub energy: f64,
    /// Every step.
    pub steps: Vec<RelaxStep>,
    /// Of every pin, in their order.
    pub residuals: Vec<PinResidual>,
}

/// `p ↦ turn p + shift`, the turn a rotation with a scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Similarity {
    /// The first column of its matrix; the second is that turned by π/2.
    turn: Vector2<f64>,
    from: Point2<f64>,
    to: Point2<f64>,
}

impl Similarity {
    /// A shift, the turn that brings pins nearest to their places, and the scale by which they are as far apart.
    pub(crate) fn to_pins(uv: &[Point2<f64>], pins: &[Pin]) -> Self {
        /// Places that are turned over have hardly a nearest turn: less than this part of their size is none.
        const NO_TURN: f64 = 1e-9;
        let n = pins.len().max(1) as f64;
        let mean = |of: &dyn Fn(&Pin) -> Point2<f64>| {
            Point2::from(pins.iter().map(|pin| of(pin).coords).sum::<Vector2<f64>>() / n)
        };
        let at = |pin: &Pin| uv[pin.vertex as usize];
        let (from, to) = (mean(&at), mean(&place));
        let (mut turn, mut here, mut there) = (Vector2::zeros(), 0.0, 0.0);
        for pin in pins {
            let (p, q) = (at(pin) - from, place(pin) - to);
            turn += Vector2::new(p.dot(&q), p.perp(&q));
            here += p.norm_squared();
            there += q.norm_squared();
        }
        let scale = if here > 0.0 && there > 0.0 { (there / here).sqrt() } else { 1.0 };
        let is_turned = turn.norm() > NO_TURN * (here * there).sqrt();
        let turn = if is_turned { turn.normalize() } else { Vector2::new(1.0, 0.0) };
        Self { turn: turn * scale, from, to }
    }

    pub(crate) fn of(&self, p: Point2<f64>) -> Point2<f64> {
        let d = p - self.from;
        self.to + Vector2::new(self.turn.x * d.x - self.turn.y * d.y, self.turn.y * d.x + self.turn.x * d.y)
    }
}

impl Relax {
    /// Brings pinned vertices of a drawing to their places: one or two by a similarity, more by weights that grow, and the rest
    /// of the drawing after them, through valid drawings only. The energy is that of a surface as large as the pins ask for.
    ///
    /// # Errors
    /// Those of [`Relax::solve`], and [`EmbedError::Pins`] with all that is wrong with the pins.
    ///
    /// # Panics
    /// If the problem is not that of `mesh`.
    pub fn solve_pinned(
        &self,
        mesh: &TriMesh,
        problem: &AngleProblem<'_>,
        start: &[Point2<f64>],
        pins: &Pins,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<PinnedDrawing, EmbedError> {
        self.check()?;
        stop.check()?;
        let topology = problem.topology();
        check_start(topology, start)?;
        pins.check(topology)?;
        let energies = Energies::new(self, mesh, problem);
        let similarity = Similarity::to_pins(start, &pins.pins);
        let mut drawing = PinnedDrawing {
            uv: start.iter().map(|&p| similarity.of(p)).collect(),
            termination: Termination::Converged,
            energy: f64::NAN,
            steps: Vec::new(),
            residuals: Vec::new(),
        };
        pins.check_held(topology, &drawing.uv)?;
        // The energy knows the size of the surface: the drawing is worked on at that.
        let unit = mesh.area().sqrt() / double_area(topology, &drawing.uv).sqrt() * std::f64::consts::SQRT_2;
        if !pins.need_a_similarity_only() {
            let mut watch = Watch::start(stop, observer);
            let work = Pinned { relax: self, problem, topology, pins: &pins.pins, unit, area: mesh.area() };
            work.bring(&energies, &mut drawing, &mut watch)?;
        }
        put(topology, &mut drawing.uv, &pins.pins, NEAR * mesh.area().sqrt() / unit);
        let scaled: Vec<Point2<f64>> = drawing.uv.iter().map(|p| p * unit).collect();
        drawing.energy = energies.terms(topology, &[]).without_barrier(&scaled);
        let residual = |pin: &Pin| PinResidual {
            vertex: pin.vertex,
            is_hard: pin.is_hard(),
            distance: (drawing.uv[pin.vertex as usize] - place(pin)).norm(),
        };
        drawing.residuals = pins.pins.iter().map(residual).collect();
        let is_missed = drawing.residuals.iter().any(PinResidual::is_missed);
        if is_missed && drawing.termination.is_as_asked() {
            drawing.termination = Termination::Stalled;
        }
        Ok(drawing)
    }
}

/// A drawing that is brought to its pins.
struct Pinned<'p, 'a> {
    relax: &'p Relax,
    problem: &'p AngleProblem<'a>,
    topology: &'p Topology,
    pins: &'p [Pin],
    /// By what the drawing is multiplied to be as large as the surface.
    unit: f64,
    area: f64,
}

impl Pinned<'_, '_> {
    fn bring(
        &self,
        energies: &Energies<'_, '_>,
        drawing: &mut PinnedDrawing,
        watch: &mut Watch<'_>,
    ) -> Result<(), EmbedError> {
        let mut run = self.run(drawing.uv.iter().map(|p| p * self.unit).collect(), &[], watch)?;
        let mut last_weight = 0.0;
        for weight in WEIGHTS {
            last_weight = weight;
            let springs = self.springs(weight, |_| true);
            let terms = energies.terms(self.topology, &springs);
            run.start(&terms, watch)?;
            drawing.termination = run.descend(&terms, watch)?;
            if drawing.termination.is_interruption() || self.are_near(&run.uv) {
                break;
            }
        }
        drawing.uv = run.uv.iter().map(|p| p / self.unit).collect();
        put(self.topology, &mut drawing.uv, self.pins, NEAR * self.area.sqrt() / self.unit);
        let is_there = |pin: &&Pin| pin.is_hard() && drawing.uv[pin.vertex as usize] == place(pin);
        let held: Vec<VertexId> = self.pins.iter().filter(is_there).map(vertex).collect();
        let mut is_held = vec![false; self.topology.vertex_count()];
        held.iter().for_each(|v| is_held[v.index()] = true);
        let mut steps = std::mem::take(&mut run.steps);
        if !held.is_empty() && !drawing.termination.is_interruption() {
            // The others follow, with those that are there held.
            let mut last = self.run(drawing.uv.iter().map(|p| p * self.unit).collect(), &held, watch)?;
            last.max_steps = self.relax.max_steps.saturating_sub(steps.len()).max(1);
            let springs = self.springs(last_weight, |pin| !is_held[pin.vertex as usize]);
            let terms = energies.terms(self.topology, &springs);
            last.start(&terms, watch)?;
            drawing.termination = last.descend(&terms, watch)?;
            // The held ones to the bit.
            let mut exact: Vec<Point2<f64>> = last.uv.iter().map(|p| p / self.unit).collect();
            held.iter().for_each(|v| exact[v.index()] = drawing.uv[v.index()]);
            if check_start(self.topology, &exact).is_ok() {
                drawing.uv = exact;
            } else {
                drawing.termination = Termination::Stalled;
            }
            steps.append(&mut last.steps);
        }
        drawing.steps = steps;
        Ok(())
    }

    /// Whether all hard pins are near their places, in a drawing as large as the surface.
    fn are_near(&self, uv: &[Point2<f64>]) -> bool {
        let away = |pin: &Pin| (uv[pin.vertex as usize] - place(pin) * self.unit).norm();
        self.pins.iter().filter(|pin| pin.is_hard()).all(|pin| away(pin) <= NEAR * self.area.sqrt())
    }

    fn run(&self, uv: Vec<Point2<f64>>, held: &[VertexId], watch: &mut Watch<'_>) -> Result<Run<'_>, EmbedError> {
        let directions = Directions::new(self.topology, held, &mut || watch.checkpoint())?;
        Ok(Run::new(self.relax, (self.topology, self.problem.mesh_angles()), uv, directions, self.area))
    }

    /// Hard pins with this weight, soft ones with their own.
    fn springs(&self, hard: f64, wanted: impl Fn(&Pin) -> bool) -> Vec<Spring> {
        let share = 1.0 / (self.area * self.pins.len() as f64);
        let weight = |pin: &Pin| match pin.weight {
            PinWeight::Hard => hard,
            PinWeight::Soft(weight) => weight,
        };
        let spring =
            |pin: &Pin| Spring { vertex: vertex(pin), target: place(pin) * self.unit, weight: weight(pin) * share };
        self.pins.iter().filter(|pin| wanted(pin)).map(spring).collect()
    }
}

/// Puts hard pins that are near their places there, all together where that is valid, else one by one.
fn put(topology: &Topology, uv: &mut Vec<Point2<f64>>, pins: &[Pin], near: f64) {
    let is_near = |pin: &&Pin| pin.is_hard() && (uv[pin.vertex as usize] - place(pin)).norm() <= near;
    let near: Vec<Pin> = pins.iter().filter(is_near).copied().collect();
    let mut all = uv.clone();
    near.iter().for_each(|pin| all[pin.vertex as usize] = place(pin));
    if check_start(topology, &all).is_ok() {
        *uv = all;
        return;
    }
    for pin in near {
        let before = std::mem::replace(&mut uv[pin.vertex as usize], place(&pin));
        let is_valid = topology.fan(vertex(&pin)).all(|c| orientation(&of_face(topology, uv, c.face())) > 0.0);
        if !is_valid {
            uv[pin.vertex as usize] = before;
        }
    }
}

/// Twice the area of a drawing.
fn double_area(topology: &Topology, uv: &[Point2<f64>]) -> f64 {
    topology.faces().map(|f| orientation(&of_face(topology, uv, f))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::not_counter_clockwise;
    use crate::tutte;
    use abf_constraints::GuessSettings;
    use abf_control::Silent;
    use abf_shapes::Shape;

    fn topology(mesh: &TriMesh) -> Topology {
        Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
    }

    fn solve(mesh: &TriMesh, topology: &Topology, start: &[Point2<f64>], pins: &Pins) -> PinnedDrawing {
        let problem = AngleProblem::new(topology, mesh.corner_angles(), GuessSettings::default()).expect("a problem");
        let stop = StopCriteria::default();
        Relax::default().solve_pinned(mesh, &problem, start, pins, &stop, &mut Silent).expect("a drawing")
    }

    fn hard(v: VertexId, place: Point2<f64>) -> Pin {
        Pin { vertex: u32::try_from(v.index()).expect("few"), uv: [place.x, place.y], weight: PinWeight::Hard }
    }

    #[test]
    fn two_pins_keep_the_shape_of_the_drawing() {
        let mesh = Shape::BumpySheet.mesh(200);
        let topology = topology(&mesh);
        let start = tutte(&mesh, &topology).expect("an embedding").uv;
        let places = [Point2::new(2.0, -1.0), Point2::new(5.0, 7.0)];
        let pins = Pins { pins: vec![hard(VertexId::new(3), places[0]), hard(VertexId::new(90), places[1])] };
        let drawing = solve(&mesh, &topology, &start, &pins);
        assert_eq!([drawing.uv[3], drawing.uv[90]], places);
        let scale = 73.0_f64.sqrt() / (start[3] - start[90]).norm();
        for (p, q) in start.iter().zip(&drawing.uv) {
            assert!(((p - start[3]).norm() * scale - (q - places[0]).norm()).abs() < 1e-12 * 73.0);
        }
    }

    #[test]
    fn pins_all_around_the_boundary_are_met_to_the_bit() {
        let mesh = Shape::BumpySheet.mesh(300);
        let topology = topology(&mesh);
        let circle = tutte(&mesh, &topology).expect("an embedding").uv;
        // The same circle as an ellipse.
        let oval: Vec<Point2<f64>> = circle.iter().map(|p| Point2::new(1.5 * p.x, p.y)).collect();
        let is_around = |v: &VertexId| topology.fan_start(*v).is_some() && !topology.is_interior(*v);
        let pins = Pins { pins: topology.vertices().filter(is_around).map(|v| hard(v, oval[v.index()])).collect() };
        assert!(pins.pins.len() > 20);
        let drawing = solve(&mesh, &topology, &circle, &pins);
        assert!(drawing.residuals.iter().all(|pin| pin.distance == 0.0), "{:?}", drawing.residuals);
        assert_eq!(
            (drawing.termination, not_counter_clockwise(&topology, &drawing.uv)),
            (Termination::Converged, None)
        );
    }

    #[test]
    fn pins_have_the_same_bits_for_any_number_of_threads() {
        let mesh = Shape::BumpySheet.mesh(3000);
        let topology = topology(&mesh);
        let start = tutte(&mesh, &topology).expect("an embedding").uv;
        let moved = |v: usize| hard(VertexId::new(v), start[v] * 1.1 + Vector2::new(0.05 * v as f64 / 1000.0, 0.0));
        let pins = Pins { pins: [10, 500, 1000, 1400].map(moved).to_vec() };
        let with = |threads| abf_parallel::with_threads(threads, || solve(&mesh, &topology, &start, &pins).uv);
        assert_eq!(with(1).expect("threads"), with(3).expect("threads"));
    }
}
