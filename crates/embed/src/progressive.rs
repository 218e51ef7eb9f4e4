//! A first drawing, also where doubles do not hold Tutte's embedding.
//!
//! Progressive embedding (Shen, Jiang, Zorin, Panozzo, *Progressive embedding*, 2019): edges collapse until Tutte's
//! embedding is a drawing of what is left, and the vertices come back one by one, each into the kernel of its ring. In
//! between the drawing is relaxed, so that no triangle gets small. Here the collapses are those of `abf-multires`, and a
//! level is relaxed as a whole, to the symmetric Dirichlet energy: its triangles get the size that they have on the surface.
//! The boundary is free, so long corridors need not be pressed into a circle.

use crate::plane::not_counter_clockwise;
use crate::relax::roomier;
use crate::tutte::tutte_watched;
use crate::{BoundarySpacing, EmbedError, TutteEmbedding, TutteWeights};
use abf_control::{Observer, StopCriteria, Watch};
use abf_mesh::{Point2, Topology, TriMesh};
use abf_multires::{CoarseMesh, Hierarchy, RefineError};

/// Collapses go on until so many triangles are left, or none is possible.
const COARSEST: usize = 100;

/// A drawing of a disk in which every triangle is counter-clockwise, by an exact predicate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FirstDrawing {
    /// One point per vertex; the origin for vertices that no face uses.
    pub uv: Vec<Point2<f64>>,
    /// How it was found where it is Tutte's embedding; `None` where it is progressive.
    pub tutte: Option<(BoundarySpacing, TutteWeights)>,
}

/// Tutte's embedding; where doubles hold none, a progressive one, whose triangles are about as large as on the surface.
///
/// Of `stop` it heeds the time limit. Same input, same bits.
///
/// # Errors
/// Those of [`tutte()`](crate::tutte()), where there is no progressive embedding, either; [`EmbedError::Interrupted`] if it was
/// stopped before there was a drawing; [`EmbedError::Cancelled`].
///
/// # Panics
/// If `topology` is not that of `mesh`.
pub fn first_drawing(
    mesh: &TriMesh,
    topology: &Topology,
    stop: &StopCriteria,
    observer: &mut dyn Observer,
) -> Result<FirstDrawing, EmbedError> {
    stop.check()?;
    first_drawing_watched(mesh, topology, &mut Watch::start(stop, observer))
}

/// The same with a clock that runs.
pub(crate) fn first_drawing_watched(
    mesh: &TriMesh,
    topology: &Topology,
    watch: &mut Watch<'_>,
) -> Result<FirstDrawing, EmbedError> {
    let flipped = match tutte_watched(mesh, topology, watch) {
        Ok(TutteEmbedding { uv, spacing, weights }) => {
            return Ok(FirstDrawing { uv, tutte: Some((spacing, weights)) });
        }
        Err(error @ (EmbedError::TutteFlipped { .. } | EmbedError::Linear(_))) => error,
        Err(error) => return Err(error),
    };
    match progressive(mesh, topology, watch)? {
        Some(uv) => Ok(FirstDrawing { uv, tutte: None }),
        None => Err(watch.interruption().map_or(flipped, EmbedError::Interrupted)),
    }
}

/// A progressive embedding; `None` where doubles hold no place for some vertex.
fn progressive(
    mesh: &TriMesh,
    topology: &Topology,
    watch: &mut Watch<'_>,
) -> Result<Option<Vec<Point2<f64>>>, EmbedError> {
    let hierarchy = Hierarchy::coarsen_in_any_shape(mesh, topology, COARSEST, &mut || watch.checkpoint())?;
    let mut uv = vec![Point2::origin(); mesh.vertex_count()];
    let coarse = Level::of(hierarchy.coarsest(mesh));
    let embedding = match tutte_watched(&coarse.mesh, &coarse.topology, watch) {
        Ok(embedding) => embedding,
        Err(EmbedError::TutteFlipped { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    coarse.write(embedding.uv, &mut uv);
    coarse.relax(&mut uv, watch)?;
    for level in (0..hierarchy.triangles().len()).rev() {
        match hierarchy.refine_level(level, mesh, &mut uv, &mut || watch.checkpoint()) {
            Ok(_) => {}
            Err(RefineError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(_) => return Ok(None),
        }
        match level.checked_sub(1) {
            Some(finer) => Level::of(hierarchy.level(mesh, finer)).relax(&mut uv, watch)?,
            None => uv = roomier(mesh, topology, &uv, watch)?,
        }
    }
    Ok(not_counter_clockwise(topology, &uv).is_none().then_some(uv))
}

/// A coarser version of the mesh.
struct Level {
    mesh: TriMesh,
    topology: Topology,
    coarse: CoarseMesh,
}

impl Level {
    fn of(coarse: CoarseMesh) -> Self {
        let mesh = coarse.mesh.clone();
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("collapses keep a manifold");
        Self { mesh, topology, coarse }
    }

    fn relax(&self, uv: &mut [Point2<f64>], watch: &mut Watch<'_>) -> Result<(), EmbedError> {
        let points: Vec<Point2<f64>> = self.coarse.vertices.iter().map(|v| uv[v.index()]).collect();
        self.write(roomier(&self.mesh, &self.topology, &points, watch)?, uv);
        Ok(())
    }

    fn write(&self, points: Vec<Point2<f64>>, uv: &mut [Point2<f64>]) {
        self.coarse.vertices.iter().zip(points).for_each(|(v, p)| uv[v.index()] = p);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Descent;
    use crate::tutte::tests::deep_pocket;
    use abf_constraints::{AngleProblem, GuessSettings};
    use abf_control::{Event, Silent, Termination, Verdict};
    use abf_shapes::Shape;
    use std::time::Duration;

    fn topology(mesh: &TriMesh) -> Topology {
        Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
    }

    #[test]
    fn a_pocket_too_deep_for_tutte_has_a_first_drawing_and_a_descent_from_it() {
        let mesh = deep_pocket(1100);
        let topology = topology(&mesh);
        let stop = StopCriteria { max_iterations: 3, ..StopCriteria::default() };
        let first = first_drawing(&mesh, &topology, &stop, &mut Silent).expect("a drawing");
        assert_eq!((first.tutte, not_counter_clockwise(&topology, &first.uv)), (None, None));
        let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
        let solution = Descent::default().solve(&mesh, &problem, None, &stop, &mut Silent).expect("a drawing");
        assert_eq!((solution.tutte, solution.history.len()), (None, 3));
        assert_eq!(not_counter_clockwise(&topology, &solution.uv), None);
    }

    #[test]
    fn every_shape_has_a_progressive_embedding() {
        let stop = StopCriteria::default();
        for shape in Shape::ALL {
            let mesh = shape.mesh(1500);
            let topology = topology(&mesh);
            let uv = progressive(&mesh, &topology, &mut Watch::start(&stop, &mut Silent)).expect("not cancelled");
            assert_eq!(uv.map(|uv| not_counter_clockwise(&topology, &uv)), Some(None), "{}", shape.name());
        }
    }

    #[test]
    fn where_doubles_hold_it_the_first_drawing_is_tuttes() {
        let mesh = Shape::Mask.mesh(400);
        let topology = topology(&mesh);
        let first = first_drawing(&mesh, &topology, &StopCriteria::default(), &mut Silent).expect("a drawing");
        assert_eq!(Some(first.uv), crate::tutte(&mesh, &topology).ok().map(|embedding| embedding.uv));
    }

    /// Answers every event with `Continue`, and all after so many with another verdict.
    struct After {
        left: usize,
        verdict: Verdict,
    }

    impl Observer for After {
        fn observe(&mut self, _: Event<'_>) -> Verdict {
            self.left = self.left.saturating_sub(1);
            if self.left == 0 { self.verdict } else { Verdict::Continue }
        }
    }

    /// After how many events the progressive embedding of this mesh begins, and ends.
    fn progressive_events(mesh: &TriMesh, topology: &Topology) -> [usize; 2] {
        let (most, stop) = (usize::MAX, StopCriteria::default());
        let mut observers = [(); 2].map(|()| After { left: most, verdict: Verdict::Continue });
        let [of_tutte, of_both] = &mut observers;
        assert!(tutte_watched(mesh, topology, &mut Watch::start(&stop, of_tutte)).is_err());
        let first = first_drawing(mesh, topology, &stop, of_both).expect("a drawing");
        assert_eq!(first.tutte, None);
        observers.map(|observer| most - observer.left)
    }

    #[test]
    fn a_progressive_embedding_ends_when_it_is_aborted() {
        let mesh = deep_pocket(1100);
        let topology = topology(&mesh);
        let [begin, end] = progressive_events(&mesh, &topology);
        assert!(end > begin + 100, "{begin} {end}");
        for part in [1, 3, 6, 9] {
            let mut observer = After { left: begin + (end - begin) * part / 10, verdict: Verdict::Abort };
            let ended = first_drawing(&mesh, &topology, &StopCriteria::default(), &mut observer);
            assert!(matches!(ended, Err(EmbedError::Cancelled(_))), "{part}: {ended:?}");
        }
    }

    #[test]
    fn a_progressive_embedding_that_is_stopped_is_a_drawing_or_says_so() {
        let mesh = deep_pocket(1100);
        let topology = topology(&mesh);
        let [begin, end] = progressive_events(&mesh, &topology);
        for part in [1, 3, 6, 9] {
            let mut observer = After { left: begin + (end - begin) * part / 10, verdict: Verdict::Stop };
            match first_drawing(&mesh, &topology, &StopCriteria::default(), &mut observer) {
                Ok(first) => {
                    assert_eq!((first.tutte, not_counter_clockwise(&topology, &first.uv)), (None, None), "{part}");
                }
                ended => assert_eq!(ended, Err(EmbedError::Interrupted(Termination::Cancelled)), "{part}"),
            }
        }
        // Without any time there is not even a start for it.
        let stop = StopCriteria { time_limit: Some(Duration::ZERO), ..StopCriteria::default() };
        let late = progressive(&mesh, &topology, &mut Watch::start(&stop, &mut Silent));
        assert_eq!(late, Err(EmbedError::Interrupted(Termination::TimeLimit)));
    }
}
