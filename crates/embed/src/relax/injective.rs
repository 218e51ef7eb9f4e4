//! A drawing that does not lie over itself: from Tutte's embedding, which is convex, through injective drawings only.

use super::energies::Energies;
use super::guard::Guard;
use super::run::{RelaxStep, Run};
use super::settings::{Energy, Relax};
use super::terms::Directions;
use super::{approach, scaled_by};
use crate::EmbedError;
use crate::place::{centred, pins as anchors, scaled_to};
use crate::tutte::tutte_watched;
use abf_constraints::AngleProblem;
use abf_control::{IterationRecord, Observer, SettingError, StopCriteria, Termination, Watch};
use abf_mesh::{Point2, Point3, Topology, TriMesh, Vector3, VertexId};

/// The energy of lengths comes first, to this tolerance and with at most so many plain steps.
const FIRST_TOLERANCE: f64 = 1e-4;
const FIRST_STEPS: usize = 60;

/// A gap that is not reached makes the barrier stiffer, so often at most.
const STIFFENINGS: usize = 6;
/// By how much.
const STIFFER: f64 = 10.0;
/// The part of a gap that is as good as all of it.
const ALL_OF_GAP: f64 = 0.999;

/// A drawing that is injective, by exact predicates.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct InjectiveDrawing {
    /// One point per vertex; the origin for vertices that no face uses.
    pub uv: Vec<Point2<f64>>,
    /// How it ended. [`Termination::Stalled`]: no step led anywhere, or the gap that was asked for is not there.
    pub termination: Termination,
    /// The energy at the end, without barriers.
    pub energy: f64,
    /// The smallest distance, in units of the UVs, of a boundary vertex and a boundary edge that are nearer to each other than
    /// a quarter of their way along the boundary; `None` where there are no such two.
    pub gap: Option<f64>,
    /// Every step to this drawing.
    pub steps: Vec<RelaxStep>,
    /// How many of these went for lengths first.
    pub first_steps: usize,
    /// The same steps as observers were told of them.
    pub iterations: Vec<IterationRecord>,
    /// Whether the UV area is the area of the surface: see [`RelaxedDrawing`](super::RelaxedDrawing).
    pub area_matched: bool,
}

impl Relax {
    /// Makes a drawing of `mesh` that does not lie over itself: of a disk, or of a connected surface of genus 0 with holes.
    ///
    /// Tutte's embedding is the start, of a surface with holes that of the same with its holes filled. The energy of lengths
    /// comes first, then [`Relax::energy`], both with a barrier between parts of the boundary. At the end these are at least
    /// `gap` from each other, in units of the UVs, or a quarter of their way along the boundary if that is less. Where that
    /// cannot be had the drawing is made without it, too, and the one of the two with the larger gap is left.
    ///
    /// Of `stop` it heeds the time limit. Without time there is the drawing so far. Same input, same bits.
    ///
    /// # Errors
    /// Those of [`tutte()`](crate::tutte()), and [`EmbedError::Setting`], [`EmbedError::Cancelled`],
    /// [`EmbedError::Linear`] and [`EmbedError::Interrupted`].
    ///
    /// # Panics
    /// If the problem is not that of `mesh`.
    pub fn solve_injective(
        &self,
        mesh: &TriMesh,
        problem: &AngleProblem<'_>,
        gap: f64,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<InjectiveDrawing, EmbedError> {
        self.check()?;
        stop.check()?;
        check_gap(gap)?;
        let topology = problem.topology();
        let mut watch = Watch::start(stop, observer);
        let start = embedded(mesh, topology, &mut watch)?;
        let crowded = anchors(topology, &start)[0];
        let uv = centred(topology, &start, crowded);
        let lengths = Energies::new(&Self { energy: Energy::Isometric, ..*self }, mesh, problem);
        let uv = scaled_by(topology, uv, lengths.isometric.best_scale(topology, &start));
        // Doubles hold Tutte's embedding, but its boundary may be too crowded for them.
        if !Guard::new(topology, mesh.area(), gap).is_clear(&uv, &mut || watch.checkpoint())? {
            return Err(EmbedError::BoundaryTooCrowded);
        }
        let mut made = |gap: f64, uv: Vec<Point2<f64>>| {
            let directions = Directions::new(topology, &[crowded], &mut || watch.checkpoint())?;
            let mut run = Run::new(self, (topology, problem.mesh_angles()), uv, directions, mesh.area());
            run.guard = Some(Guard::new(topology, mesh.area(), gap));
            run.start(&lengths.terms(topology, &[]), &mut watch)?;
            let ended = self.guarded(&mut run, &lengths, (mesh, problem, crowded), &mut watch)?;
            Ok::<_, EmbedError>((ended.is_short, ended.into_drawing(run, mesh.area())))
        };
        let (is_short, drawing) = made(gap, uv.clone())?;
        if !is_short || drawing.termination.is_interruption() {
            return Ok(drawing);
        }
        let (_, without) = made(0.0, uv)?;
        let is_wider = without.gap.unwrap_or(f64::INFINITY) > drawing.gap.unwrap_or(f64::INFINITY);
        let termination =
            if without.termination.is_interruption() { without.termination } else { Termination::Stalled };
        Ok(InjectiveDrawing { termination, ..if is_wider { without } else { drawing } })
    }

    /// Both energies, one after the other.
    fn guarded(
        &self,
        run: &mut Run<'_>,
        lengths: &Energies<'_, '_>,
        (mesh, problem, crowded): (&TriMesh, &AngleProblem<'_>, VertexId),
        watch: &mut Watch<'_>,
    ) -> Result<Ended, EmbedError> {
        approach(run, &lengths.isometric, watch)?;
        let is_last = self.energy == Energy::Isometric;
        let topology = run.topology;
        if !is_last {
            (run.tolerance, run.max_steps) = (FIRST_TOLERANCE, run.steps.len() + FIRST_STEPS);
            run.descend(&lengths.terms(topology, &[]), watch)?;
        }
        let first_steps = run.steps.len();
        let own = Energies::new(self, mesh, problem);
        let terms = own.terms(topology, &[]);
        if self.energy == Energy::Abf {
            // Angles do not hold the size of the drawing, which the barrier would have grow.
            let pinned = [crowded, farthest(topology, &run.uv, crowded)];
            run.directions = Directions::new(topology, &pinned, &mut || watch.checkpoint())?;
        }
        run.guard.as_mut().expect("set by the caller").stiffness = 1.0;
        (run.tolerance, run.max_steps) = (self.energy_tolerance, first_steps + self.max_steps);
        run.start(&terms, watch)?;
        let mut termination = run.descend(&terms, watch)?;
        let least = ALL_OF_GAP * run.guard.as_ref().expect("set by the caller").gap;
        let mut reached = gap_of(run);
        let mut widest = (reached, run.uv.clone());
        run.max_steps = run.steps.len() + self.max_steps;
        for _ in 0..STIFFENINGS {
            if reached >= least || termination.is_interruption() || run.steps.len() >= run.max_steps {
                break;
            }
            run.guard.as_mut().expect("set by the caller").stiffness *= STIFFER;
            termination = run.descend(&terms, watch)?;
            reached = gap_of(run);
            if reached <= widest.0 {
                break;
            }
            widest = (reached, run.uv.clone());
        }
        let is_short = reached < least;
        if is_short {
            // A gap that cannot be had bends a drawing for nothing.
            run.uv = widest.1;
            termination = if termination.is_interruption() { termination } else { Termination::Stalled };
        }
        Ok(Ended { termination, is_short, first_steps, energy: terms.without_barrier(&run.uv) })
    }
}

/// What came of a run.
struct Ended {
    termination: Termination,
    /// Whether the gap that was asked for is not there.
    is_short: bool,
    first_steps: usize,
    energy: f64,
}

impl Ended {
    fn into_drawing(self, run: Run<'_>, area: f64) -> InjectiveDrawing {
        let Self { termination, first_steps, energy, .. } = self;
        let (uv, area_matched) = scaled_to(run.topology, run.uv, area);
        let gap = run.guard.as_ref().and_then(|guard| guard.least_gap(&uv));
        let (steps, iterations) = (run.steps, run.reported);
        InjectiveDrawing { uv, termination, energy, gap, steps, first_steps, iterations, area_matched }
    }
}

/// The smallest distance of a boundary vertex and a boundary edge of a drawing, one point per vertex, that are nearer to each
/// other than a quarter of their way along the boundary; `None` where there are no such two.
#[must_use]
pub fn boundary_gap(topology: &Topology, uv: &[Point2<f64>]) -> Option<f64> {
    Guard::new(topology, 1.0, 0.0).least_gap(uv)
}

/// Checks that a gap is in its range.
///
/// # Errors
/// [`SettingError`] with the range.
pub fn check_gap(gap: f64) -> Result<(), SettingError> {
    if gap >= 0.0 && gap.is_finite() {
        Ok(())
    } else {
        Err(SettingError::new("boundary_gap", "0 or more, finite", gap))
    }
}

/// The vertex that is farthest from another one.
fn farthest(topology: &Topology, uv: &[Point2<f64>], from: VertexId) -> VertexId {
    let distance = |v: VertexId| (uv[v.index()] - uv[from.index()]).norm_squared();
    let used = topology.vertices().filter(|&v| topology.fan_start(v).is_some());
    used.max_by(|&a, &b| distance(a).total_cmp(&distance(b))).expect("a disk has vertices")
}

/// The smallest gap, for a drawing as large as the surface; infinite where there is none, or none is asked for.
fn gap_of(run: &Run<'_>) -> f64 {
    let guard = run.guard.as_ref().filter(|guard| guard.gap > 0.0);
    let least = guard.and_then(|guard| Some(guard.least_gap(&run.uv)? / guard.scale(&run.uv)));
    least.unwrap_or(f64::INFINITY)
}

/// Tutte's embedding, of a surface with holes by way of the same with its holes filled.
fn embedded(mesh: &TriMesh, topology: &Topology, watch: &mut Watch<'_>) -> Result<Vec<Point2<f64>>, EmbedError> {
    if topology.boundary_loops().len() < 2 {
        return Ok(tutte_watched(mesh, topology, watch)?.uv);
    }
    let filled = with_caps(mesh, topology);
    // A face of a manifold with a cap on every hole is one of a manifold.
    let closed = Topology::build(filled.vertex_count(), filled.faces()).expect("caps fit to the holes");
    let mut uv = tutte_watched(&filled, &closed, watch)?.uv;
    uv.truncate(mesh.vertex_count());
    Ok(uv)
}

/// The mesh with a new vertex in every hole; the longest boundary stays.
fn with_caps(mesh: &TriMesh, topology: &Topology) -> TriMesh {
    let at = |v: VertexId| mesh.positions()[v.index()];
    let loops = topology.boundary_loops();
    let length = |vertices: &[VertexId]| -> f64 {
        (0..vertices.len()).map(|k| (at(vertices[(k + 1) % vertices.len()]) - at(vertices[k])).norm()).sum()
    };
    let lengths: Vec<f64> = loops.iter().map(|l| length(&l.vertices)).collect();
    let longest = (0..loops.len()).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j]).then(j.cmp(&i)));
    let mut points = mesh.positions().to_vec();
    let mut faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(VertexId::index)).collect();
    for hole in (0..loops.len()).filter(|&k| Some(k) != longest).map(|k| &loops[k].vertices) {
        let middle = hole.iter().map(|&v| at(v).coords).sum::<Vector3<f64>>() / hole.len() as f64;
        let centre = points.len();
        points.push(Point3::from(middle));
        faces.extend((0..hole.len()).map(|k| [hole[(k + 1) % hole.len()].index(), hole[k].index(), centre]));
    }
    TriMesh::new(points, &faces).expect("vertices of the mesh, and new ones")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::not_counter_clockwise;
    use abf_constraints::GuessSettings;
    use abf_control::{Event, Silent, Verdict};
    use abf_overlap::BoundaryTest;
    use abf_shapes::Shape;

    /// A flat strip wound up to a helix without a rise: its own plane has it over itself.
    fn helix(turns: f64, steps: usize) -> TriMesh {
        let points = (0..=steps).flat_map(|k| {
            let turn = std::f64::consts::TAU * turns * k as f64 / steps as f64;
            [1.0, 1.5, 2.0].map(|r| Point3::new(r * turn.cos(), r * turn.sin(), 0.3 * turn))
        });
        let faces: Vec<[usize; 3]> = (0..steps)
            .flat_map(|k| [3 * k, 3 * k + 1])
            .flat_map(|k| [[k, k + 1, k + 3], [k + 1, k + 4, k + 3]])
            .collect();
        TriMesh::new(points.collect(), &faces).expect("indices in range")
    }

    fn topology(mesh: &TriMesh) -> Topology {
        Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
    }

    fn solve(
        mesh: &TriMesh,
        topology: &Topology,
        relax: Relax,
        gap: f64,
        observer: &mut dyn Observer,
    ) -> InjectiveDrawing {
        let problem = AngleProblem::unclosed(topology, mesh.corner_angles(), GuessSettings::default());
        let problem = problem.expect("a problem");
        relax.solve_injective(mesh, &problem, gap, &StopCriteria::default(), observer).expect("a drawing")
    }

    fn is_injective(topology: &Topology, uv: &[Point2<f64>]) -> bool {
        let is_clear = BoundaryTest::new(topology).is_clear(uv, &mut || Ok(())).expect("not cancelled");
        not_counter_clockwise(topology, uv).is_none() && is_clear
    }

    #[test]
    fn a_strip_that_winds_over_itself_is_bent_until_it_does_not() {
        let mesh = helix(1.6, 60);
        let topology = topology(&mesh);
        for energy in [Energy::Abf, Energy::Isometric, Energy::USABLE] {
            let drawing = solve(&mesh, &topology, Relax { energy, ..Relax::default() }, 0.0, &mut Silent);
            assert!(is_injective(&topology, &drawing.uv), "{energy}");
            assert_eq!(drawing.termination, Termination::Converged, "{energy}");
            assert!(drawing.gap.is_some_and(|gap| gap > 0.0), "{energy}");
        }
    }

    #[test]
    fn a_gap_that_cannot_be_had_leaves_no_smaller_one_than_there_is_without() {
        // A road of one quad across that climbs around its axis twice and a half: too few to bend into a wide spiral.
        let points = (0..=48).flat_map(|k| {
            let turn = 0.1 * std::f64::consts::PI * f64::from(k);
            [2.0, 2.4].map(|r| Point3::new(r * turn.cos(), r * turn.sin(), 0.25 * f64::from(k)))
        });
        let faces: Vec<[usize; 3]> =
            (0..48).flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 2], [2 * k + 1, 2 * k + 3, 2 * k + 2]]).collect();
        let mesh = TriMesh::new(points.collect(), &faces).expect("indices in range");
        let topology = topology(&mesh);
        let (asked, relax) = (0.45, Relax { energy: Energy::Abf, ..Relax::default() });
        let without = solve(&mesh, &topology, relax, 0.0, &mut Silent);
        let drawing = solve(&mesh, &topology, relax, asked, &mut Silent);
        let [gap, least] = [&drawing, &without].map(|drawing| drawing.gap.unwrap_or(f64::INFINITY));
        assert!(gap < asked && drawing.termination == Termination::Stalled, "{gap} of {asked}");
        assert!(gap >= least && is_injective(&topology, &drawing.uv), "{gap} {least}");
        assert!(drawing.steps.len() <= 60 + 2 * Relax::default().max_steps, "{}", drawing.steps.len());
    }

    #[test]
    fn the_smallest_gap_is_kept() {
        let mesh = helix(1.6, 60);
        let topology = topology(&mesh);
        let free = solve(&mesh, &topology, Relax::default(), 0.0, &mut Silent).gap.expect("a gap");
        let asked = 4.0 * free;
        let drawing = solve(&mesh, &topology, Relax::default(), asked, &mut Silent);
        assert!(is_injective(&topology, &drawing.uv));
        assert_eq!(drawing.termination, Termination::Converged);
        let gap = drawing.gap.expect("a gap");
        assert!(gap >= 0.99 * asked && gap < 4.0 * asked, "{free} {asked} {gap}");
    }

    #[test]
    fn a_surface_with_a_hole_is_drawn_with_the_hole() {
        let whole = Shape::BumpySheet.mesh(800);
        let centre = whole.positions().iter().map(|p| p.coords).sum::<Vector3<f64>>() / whole.vertex_count() as f64;
        let is_kept = |face: &&[VertexId; 3]| {
            face.iter().all(|v| {
                let d = whole.positions()[v.index()].coords - centre;
                d.x.hypot(d.y) > 0.2
            })
        };
        let faces: Vec<[usize; 3]> =
            whole.faces().iter().filter(is_kept).map(|face| face.map(VertexId::index)).collect();
        let mesh = TriMesh::new(whole.positions().to_vec(), &faces).expect("indices in range");
        let topology = topology(&mesh);
        assert_eq!(topology.boundary_loops().len(), 2);
        let drawing = solve(&mesh, &topology, Relax { energy: Energy::Abf, ..Relax::default() }, 0.0, &mut Silent);
        assert!(is_injective(&topology, &drawing.uv) && drawing.termination == Termination::Converged);
    }

    /// Stops at a step.
    struct StopAt(usize);

    impl Observer for StopAt {
        fn observe(&mut self, event: Event<'_>) -> Verdict {
            let is_late = matches!(event, Event::Iteration(record) if record.iteration >= self.0);
            if is_late { Verdict::Stop } else { Verdict::Continue }
        }
    }

    #[test]
    fn stopped_it_leaves_an_injective_drawing() {
        let mesh = helix(1.6, 60);
        let topology = topology(&mesh);
        let drawing = solve(&mesh, &topology, Relax::default(), 0.0, &mut StopAt(4));
        assert_eq!((drawing.termination, drawing.steps.len()), (Termination::Cancelled, 4));
        assert!(is_injective(&topology, &drawing.uv));
    }

    #[test]
    fn injective_drawings_have_the_same_bits_for_any_number_of_threads() {
        let mesh = helix(1.6, 1200);
        let topology = topology(&mesh);
        let relax = Relax { energy: Energy::Abf, max_steps: 8, ..Relax::default() };
        let with =
            |threads| abf_parallel::with_threads(threads, || solve(&mesh, &topology, relax, 0.0, &mut Silent).uv);
        assert_eq!(with(1).expect("threads"), with(3).expect("threads"));
    }

    #[test]
    fn a_gap_that_is_no_length_is_refused() {
        for gap in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(check_gap(gap).expect_err("refused").to_string().contains("boundary_gap"));
        }
    }
}
