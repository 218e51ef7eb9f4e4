//! What an observer is told of where the work is: enough for a bar that ends when the work ends.

use abf::{Event, Observer, SurfaceHints, Unwrap, UnwrapProgress, Verdict};
use abf_mesh::{TriMesh, Vector3, VertexId};
use abf_shapes::Shape;

#[derive(Default)]
struct Places(Vec<UnwrapProgress>);

impl Observer for Places {
    fn observe(&mut self, _: Event<'_>) -> Verdict {
        Verdict::Continue
    }

    fn observe_at(&mut self, place: UnwrapProgress, _: Event<'_>) -> Verdict {
        self.0.push(place);
        Verdict::Continue
    }
}

/// A sheet, and the same sheet far away.
fn two_sheets() -> TriMesh {
    let one = Shape::BumpySheet.mesh(300);
    let far = one.positions().iter().map(|p| p + Vector3::new(100.0, 0.0, 0.0));
    let faces = one.faces().iter().map(|face| face.map(VertexId::index));
    let n = one.vertex_count();
    let all: Vec<[usize; 3]> = faces.clone().chain(faces.map(|face| face.map(|v| v + n))).collect();
    TriMesh::new(one.positions().iter().copied().chain(far).collect(), &all).expect("indices in range")
}

#[test]
fn the_faces_that_are_done_grow_to_all_of_them_and_every_event_says_which_piece_it_is_of() {
    let mesh = two_sheets();
    let mut places = Places::default();
    let unwrap = Unwrap { max_stretch: 1.02, ..Unwrap::default() };
    let charts = unwrap.run(&mesh, &SurfaceHints::default(), &mut places).expect("charts").charts;
    // What is asked before there are components has no place.
    let places: Vec<UnwrapProgress> = places.0.into_iter().filter(|place| place.components > 0).collect();
    let last = places.last().expect("events");
    assert_eq!((last.components, last.components_done, last.faces), (2, 2, mesh.face_count()));
    assert_eq!(last.faces_done, last.faces, "{last:?}");
    assert!(places.windows(2).all(|two| two[0].faces_done <= two[1].faces_done), "the bar never goes back");
    let is_possible = |place: &UnwrapProgress| {
        place.component < place.components && place.chart < place.charts && place.charts_done <= place.charts
    };
    assert_eq!(places.iter().find(|place| !is_possible(place)), None);
    let most = |component| places.iter().filter(|p| p.component == component).map(|p| p.charts).max().unwrap_or(0);
    for component in 0..2 {
        let own = charts.iter().filter(|chart| chart.component == component).count();
        assert!(own >= 1 && most(component) >= own, "{own} charts, {} pieces", most(component));
    }
}
