//! Coarser and back, on meshes that are made by code.

use abf_control::Cancelled;
use abf_mesh::predicates::orient2d;
use abf_mesh::{Point2, Topology, TriMesh, VertexId};
use abf_multires::{Hierarchy, LevelReport, RefineError};
use abf_parallel::with_threads;
use abf_shapes::Shape;

fn topology(mesh: &TriMesh) -> Topology {
    Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
}

fn coarsened(mesh: &TriMesh, triangles: usize) -> Hierarchy {
    Hierarchy::coarsen(mesh, &topology(mesh), triangles, &mut || Ok(())).expect("not cancelled")
}

/// A sheet is a drawing of itself from above.
fn from_above(mesh: &TriMesh) -> Vec<Point2<f64>> {
    mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect()
}

fn refined(mesh: &TriMesh, hierarchy: &Hierarchy, sweeps: usize) -> (Vec<Point2<f64>>, Vec<LevelReport>) {
    let topology = topology(mesh);
    let mut uv = from_above(mesh);
    // What was removed is nowhere: it has to come back from its neighbours.
    let coarse = hierarchy.coarsest(mesh);
    let mut is_left = vec![false; mesh.vertex_count()];
    coarse.vertices.iter().for_each(|v| is_left[v.index()] = true);
    uv.iter_mut().zip(&is_left).filter(|(_, left)| !**left).for_each(|(p, _)| *p = Point2::new(f64::NAN, f64::NAN));
    let levels = hierarchy.refine((mesh, &topology), &mesh.corner_angles(), &mut uv, sweeps, &mut || Ok(()));
    (uv, levels.expect("a place for every vertex"))
}

fn flips(mesh: &TriMesh, uv: &[Point2<f64>]) -> usize {
    let is_flipped = |f: &&[abf_mesh::VertexId; 3]| {
        let [a, b, c] = f.map(|v| uv[v.index()]);
        !(orient2d(a, b, c) > 0.0)
    };
    mesh.faces().iter().filter(is_flipped).count()
}

#[test]
fn collapses_keep_a_manifold_of_the_same_kind() {
    for shape in [Shape::BumpySheet, Shape::Mask, Shape::Hemisphere, Shape::Letter2, Shape::SpikyField] {
        let mesh = shape.mesh(3000);
        let coarse = coarsened(&mesh, 200).coarsest(&mesh).mesh;
        let small = topology(&coarse);
        small.check().expect("every law");
        small.require_disk().expect("a disk");
        assert!(coarse.face_count() < mesh.face_count() / 4, "{shape:?}: {}", coarse.face_count());
        assert_eq!(coarse.unreferenced_vertices(), 0);
    }
}

#[test]
fn a_mesh_that_is_small_enough_stays_as_it_is() {
    let mesh = Shape::BumpySheet.mesh(300);
    let hierarchy = coarsened(&mesh, mesh.face_count());
    assert_eq!((hierarchy.removed(), hierarchy.rounds()), (0, 0));
    assert_eq!(hierarchy.coarsest(&mesh).mesh, mesh);
    let (uv, levels) = refined(&mesh, &hierarchy, 1);
    assert_eq!((uv, levels.len()), (from_above(&mesh), 1));
}

#[test]
fn collapses_end_where_no_edge_can_go() {
    let triangle =
        TriMesh::new(vec![[0.0, 0.0, 0.0].into(), [1.0, 0.0, 0.0].into(), [0.0, 1.0, 0.0].into()], &[[0, 1, 2]]);
    let triangle = triangle.expect("a mesh");
    assert_eq!(coarsened(&triangle, 1).removed(), 0);
    let mesh = Shape::BumpySheet.mesh(300);
    let coarse = coarsened(&mesh, 1).coarsest(&mesh).mesh;
    assert!(coarse.face_count() >= 1 && topology(&coarse).require_disk().is_ok());
}

#[test]
fn a_drawing_comes_back_without_flips_and_close_to_its_angles() {
    let mesh = Shape::BumpySheet.mesh(6000);
    let hierarchy = coarsened(&mesh, 300);
    let mean = |sweeps: usize| {
        let (uv, levels) = refined(&mesh, &hierarchy, sweeps);
        assert_eq!(flips(&mesh, &uv), 0);
        assert_eq!(levels.first().map(|level| level.inserted), Some(0));
        assert_eq!(levels.last().map(|level| level.triangles), Some(mesh.face_count()));
        assert_eq!(levels.iter().map(|level| level.inserted).sum::<usize>(), hierarchy.removed());
        let positions = uv.iter().map(|p| [p.x, p.y, 0.0].into()).collect();
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(VertexId::index)).collect();
        let drawn = TriMesh::new(positions, &faces).expect("a mesh").corner_angles();
        let off = drawn.iter().zip(mesh.corner_angles()).map(|(x, a)| (x - a).powi(2)).sum::<f64>();
        (off / drawn.len() as f64).sqrt()
    };
    let (without, with) = (mean(0), mean(2));
    assert!(with < without && with < 0.2, "{without} {with}");
}

#[test]
fn the_way_back_has_the_same_bits_on_any_number_of_threads() {
    let mesh = Shape::SpikyField.mesh(20_000);
    let run = || {
        let hierarchy = coarsened(&mesh, 1000);
        let drawing = refined(&mesh, &hierarchy, 1);
        (hierarchy, drawing)
    };
    let one = with_threads(1, run).expect("threads");
    assert!(one == with_threads(4, run).expect("threads"));
    assert!(one.0.triangles().len() >= 2, "levels between");
}

#[test]
fn an_abort_is_heard_at_every_question() {
    let mesh = Shape::BumpySheet.mesh(2000);
    let topology = topology(&mesh);
    let mut asked = 0;
    let hierarchy = Hierarchy::coarsen(&mesh, &topology, 100, &mut || {
        asked += 1;
        Ok(())
    });
    let hierarchy = hierarchy.expect("not cancelled");
    assert!(asked > 3);
    for question in 1..=asked {
        let mut left = question;
        let ended = Hierarchy::coarsen(&mesh, &topology, 100, &mut || {
            left -= 1;
            if left == 0 { Err(Cancelled) } else { Ok(()) }
        });
        assert_eq!((ended, left), (Err(Cancelled), 0));
    }
    let (target, mut uv) = (mesh.corner_angles(), from_above(&mesh));
    let ended = hierarchy.refine((&mesh, &topology), &target, &mut uv, 1, &mut || Err(Cancelled));
    assert_eq!(ended, Err(RefineError::Cancelled(Cancelled)));
}

#[test]
fn a_ring_that_is_turned_over_has_no_place_for_its_vertex() {
    let mesh = Shape::BumpySheet.mesh(2000);
    let hierarchy = coarsened(&mesh, 200);
    let mut uv: Vec<Point2<f64>> = from_above(&mesh).iter().map(|p| Point2::new(-p.x, p.y)).collect();
    let ended = hierarchy.refine((&mesh, &topology(&mesh)), &mesh.corner_angles(), &mut uv, 1, &mut || Ok(()));
    assert!(matches!(ended, Err(RefineError::EmptyKernel { .. })), "{ended:?}");
}

#[test]
fn where_only_connections_count_collapses_go_on_and_lead_back() {
    for shape in [Shape::SpikyField, Shape::Mask, Shape::BumpySheet] {
        let mesh = shape.mesh(3000);
        let fine = topology(&mesh);
        let hierarchy = Hierarchy::coarsen_in_any_shape(&mesh, &fine, 30, &mut || Ok(())).expect("not cancelled");
        let coarse = hierarchy.coarsest(&mesh);
        topology(&coarse.mesh).require_disk().expect("a disk");
        assert!(coarse.mesh.face_count() < 100, "{shape:?}: {}", coarse.mesh.face_count());
        // What is on the boundary stays there, and nothing else comes to it.
        let small = topology(&coarse.mesh);
        let is_inside = |v: usize| small.is_interior(VertexId::new(v));
        assert!(coarse.vertices.iter().enumerate().all(|(v, of)| is_inside(v) == fine.is_interior(*of)));
    }
    let mesh = Shape::BumpySheet.mesh(3000);
    let hierarchy =
        Hierarchy::coarsen_in_any_shape(&mesh, &topology(&mesh), 30, &mut || Ok(())).expect("not cancelled");
    let mut uv = from_above(&mesh);
    for level in (0..hierarchy.triangles().len()).rev() {
        let report = hierarchy.refine_level(level, &mesh, &mut uv, &mut || Ok(())).expect("a place for every vertex");
        assert!(report.inserted > 0);
    }
    assert_eq!(flips(&mesh, &uv), 0);
}
