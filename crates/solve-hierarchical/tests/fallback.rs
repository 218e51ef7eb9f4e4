//! What happens where there is no hierarchy to use.

use abf_constraints::{AngleProblem, GuessSettings};
use abf_control::{Cancelled, Checkpoint, Observer, Silent, StopCriteria, Termination};
use abf_mesh::{Point2, Topology, TriMesh};
use abf_shapes::Shape;
use abf_solve_core::{AngleSolution, AngleSolver, SolveError};
use abf_solve_hierarchical::{Coarse, Hierarchical, HierarchicalMethod, HierarchicalSolution, NoHierarchy};
use std::sync::Arc;

/// Believes the targets; of meshes below so many triangles it finds nothing.
struct Trusting {
    refuses_below: usize,
}

impl AngleSolver for Trusting {
    fn name(&self) -> &'static str {
        "trusting"
    }

    fn solve(
        &self,
        problem: &AngleProblem<'_>,
        _: &StopCriteria,
        _: &mut dyn Observer,
    ) -> Result<AngleSolution, SolveError> {
        if problem.topology().face_count() < self.refuses_below {
            return Err(SolveError::Unsupported("too small"));
        }
        Ok(AngleSolution::measure(problem, problem.target().to_vec(), Termination::OnePass, Vec::new()))
    }
}

type Drawn = Result<Option<Vec<Point2<f64>>>, Cancelled>;

/// Seen from above.
fn from_above(mesh: &TriMesh) -> Drawn {
    Ok(Some(mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect()))
}

fn solved(
    hierarchical: Hierarchical,
    refuses_below: usize,
    draw: fn(&TriMesh) -> Drawn,
) -> Result<HierarchicalSolution, SolveError> {
    let mesh = Shape::BumpySheet.mesh(3000);
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let problem = AngleProblem::new(&topology, mesh.corner_angles(), GuessSettings::default()).expect("a disk");
    let layout = &mut |mesh: &TriMesh, _: &Topology, _: &[f64], _: &mut Checkpoint<'_>| draw(mesh);
    let coarse = Coarse { solver: Arc::new(Trusting { refuses_below }), layout };
    hierarchical.solve(&mesh, &problem, coarse, &StopCriteria::default(), &mut Silent)
}

fn small() -> Hierarchical {
    Hierarchical { least_triangles: 300, ..Hierarchical::default() }
}

#[test]
fn a_coarse_drawing_is_carried_to_the_mesh() {
    let found = solved(small(), 0, from_above).expect("a result");
    assert_eq!((found.uv.is_some(), found.fallback, found.levels.len() > 1), (true, None, true));
    // A drawing closes by itself.
    assert!(found.solution.constraint_residual() < 1e-10 && found.solution.angles_out_of_range() == 0);
    assert_eq!(found.solution.termination(), Termination::OnePass);
}

#[test]
fn hierarchical_linabf_closes_the_angles_of_the_fine_mesh_itself() {
    let found =
        solved(Hierarchical { method: HierarchicalMethod::HLinAbf, ..small() }, 0, from_above).expect("a result");
    assert_eq!((found.uv, found.fallback), (None, None));
    assert_eq!(found.solution.termination(), Termination::Converged);
    assert!(found.solution.constraint_residual() <= 1e-8 && found.solution.iterations() > 0);
}

#[test]
fn a_coarse_mesh_without_angles_or_drawing_is_said_and_the_mesh_is_solved_as_a_whole() {
    let no_angles = solved(small(), 2000, from_above).expect("angles of the whole");
    assert!(matches!(no_angles.fallback, Some(NoHierarchy::CoarseAngles { triangles: 1..=300, .. })));
    let no_drawing = solved(small(), 0, |_| Ok(None)).expect("angles of the whole");
    assert!(matches!(no_drawing.fallback, Some(NoHierarchy::CoarseDrawing { triangles: 1..=300 })));
    let mirrored =
        solved(small(), 0, |mesh| Ok(Some(mesh.positions().iter().map(|p| Point2::new(-p.x, p.y)).collect())));
    let mirrored = mirrored.expect("angles of the whole");
    assert!(matches!(mirrored.fallback, Some(NoHierarchy::Refine(_))), "{:?}", mirrored.fallback);
    for found in [no_angles, no_drawing, mirrored] {
        assert_eq!((found.uv, found.levels.len()), (None, 0));
        assert_eq!(found.solution.termination(), Termination::OnePass);
    }
}

#[test]
fn a_small_mesh_is_solved_as_a_whole_and_that_is_no_failure() {
    let found = solved(Hierarchical { least_triangles: 1 << 20, ..small() }, 0, |_| panic!("nothing to draw"));
    let found = found.expect("angles");
    assert_eq!((found.uv, found.levels.len(), found.fallback), (None, 0, None));
}

#[test]
fn an_abort_in_the_layout_ends_it() {
    assert_eq!(solved(small(), 0, |_| Err(Cancelled)), Err(SolveError::Cancelled(Cancelled)));
}

#[test]
fn settings_of_zero_are_refused_by_name() {
    for (hierarchical, name) in [
        (Hierarchical { factor: 0, ..small() }, "factor"),
        (Hierarchical { least_triangles: 0, ..small() }, "least_triangles"),
    ] {
        let error = solved(hierarchical, 0, from_above).expect_err("refused").to_string();
        assert!(error.starts_with(&format!("{name} must be at least 1")), "{error}");
    }
}
