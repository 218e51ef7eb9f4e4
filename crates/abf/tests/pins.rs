//! Maps with vertices in given places.

use abf::mesh::{Topology, TriMesh, VertexId};
use abf::{Elsewhere, Energy, FlattenError, Flattening, Pin, PinWeight, Pins, Pipeline, Relax, Silent};
use abf_shapes::Shape;
use std::f64::consts::TAU;

fn flat(mesh: &TriMesh, energy: Option<Energy>) -> Flattening {
    let relax = energy.map(|energy| Relax { energy, ..Relax::default() });
    Pipeline { relax, ..Pipeline::default() }.run(mesh, &mut Silent).expect("a map")
}

fn pinned(mesh: &TriMesh, pins: Vec<Pin>) -> Flattening {
    Pipeline { pins: Some(Pins { pins }), ..Pipeline::default() }.run(mesh, &mut Silent).expect("a map")
}

/// The boundary vertices farthest along four directions, and the corners of a square as large as the surface.
fn corners(mesh: &TriMesh) -> Vec<Pin> {
    let free = flat(mesh, Some(Energy::Isometric));
    let at = |v: usize| {
        let corner = mesh.faces().iter().flatten().position(|w| w.index() == v).expect("a face");
        free.uv.corner(abf::mesh::CornerId::new(corner))
    };
    let side = mesh.area().sqrt();
    let pin = |[x, y]: [f64; 2]| {
        let along = |v: &usize| x * at(*v).x + y * at(*v).y;
        let vertex = (0..mesh.vertex_count()).max_by(|a, b| along(a).total_cmp(&along(b))).expect("vertices") as u32;
        Pin { vertex, uv: [x * side / 2.0, y * side / 2.0], weight: PinWeight::Hard }
    };
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(pin).to_vec()
}

#[test]
fn two_pins_are_met_exactly_by_a_similarity() {
    let mesh = Shape::SpikyField.mesh(500);
    let pins = vec![
        Pin { vertex: 3, uv: [0.1, 0.7], weight: PinWeight::Hard },
        Pin { vertex: 100, uv: [-3.0, 0.2], weight: PinWeight::Hard },
    ];
    let map = pinned(&mesh, pins);
    let report = map.pinned.as_ref().expect("a report");
    assert!(report.residuals.iter().all(|pin| pin.distance == 0.0) && report.steps == 0, "{report:?}");
    assert!(map.is_certified());
    let [free, pinned] = [&flat(&mesh, None), &map].map(|map| map.metrics(&mesh).expect("a measure").f);
    assert!((free - pinned).abs() < 1e-9);
}

#[test]
fn four_corners_of_a_square_are_met_exactly() {
    let mesh = Shape::SpikyField.mesh(1500);
    let pins = corners(&mesh);
    let map = pinned(&mesh, pins.clone());
    let report = map.pinned.as_ref().expect("a report");
    assert!(report.residuals.iter().all(|pin| pin.distance == 0.0 && pin.is_hard), "{report:?}");
    assert!(map.is_certified(), "{:?}", map.termination);
    // In a square 16 times as large, the same map 16 times as large.
    let large = pins.iter().map(|pin| Pin { uv: pin.uv.map(|x| 16.0 * x), ..*pin }).collect();
    let large = pinned(&mesh, large);
    let [one, other] = [&map, &large].map(|map| map.metrics(&mesh).expect("a measure").stretch_l2);
    assert!(large.is_certified() && (one - other).abs() < 1e-6, "{one} {other}");
}

#[test]
fn soft_pins_are_nearer_the_more_they_weigh() {
    let mesh = Shape::SpikyField.mesh(500);
    let farthest = |weight: f64| {
        let pins = corners(&mesh).into_iter().map(|pin| Pin { weight: PinWeight::Soft(weight), ..pin }).collect();
        let map = pinned(&mesh, pins);
        assert!(map.is_certified());
        map.pinned.expect("a report").residuals.iter().map(|pin| pin.distance).fold(0.0, f64::max)
    };
    let far = [0.1, 10.0, 1000.0].map(farthest);
    assert!(far[0] > far[1] && far[1] > far[2] && far[2] > 0.0, "{far:?}");
}

#[test]
fn pins_that_cannot_all_be_had_are_reported_and_the_map_stays_valid() {
    let mesh = Shape::SpikyField.mesh(300);
    // The ring of an interior vertex, turned over: whatever the place of the vertex, it would not be inside.
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let centre = topology.vertices().find(|&v| topology.is_interior(v)).expect("an interior vertex");
    let ring: Vec<VertexId> = topology.fan(centre).map(|c| topology.vertex(c.next())).collect();
    let pin = |(k, v): (usize, &VertexId)| {
        let angle = -TAU * k as f64 / ring.len() as f64;
        Pin { vertex: v.index() as u32, uv: [angle.cos(), angle.sin()], weight: PinWeight::Hard }
    };
    let map = pinned(&mesh, ring.iter().enumerate().map(pin).collect());
    assert!(map.certificate.valid() && !map.termination.is_as_asked(), "{:?}", map.termination);
    let report = map.pinned.expect("a report");
    assert!(
        report.residuals.len() == ring.len() && report.residuals.iter().any(|pin| pin.distance > 0.1),
        "{report:?}"
    );
}

#[test]
fn everything_that_is_wrong_with_pins_is_named() {
    let mesh = Shape::BumpySheet.mesh(50);
    let said = |pins: &[(u32, [f64; 2])]| {
        let pins = pins.iter().map(|&(vertex, uv)| Pin { vertex, uv, weight: PinWeight::Hard }).collect();
        let run = Pipeline { pins: Some(Pins { pins }), ..Pipeline::default() }.run(&mesh, &mut Silent);
        let Err(FlattenError::Pins(error)) = run else { panic!("{run:?}") };
        error.to_string()
    };
    let all = said(&[(9999, [0.0; 2]), (1, [f64::NAN, 0.0]), (2, [0.0; 2]), (2, [1.0, 0.0])]);
    for part in ["no vertex 9999", "vertex 1 has a number", "vertex 2 is pinned twice"] {
        assert!(all.contains(part), "{all}");
    }
    assert!(said(&[(0, [1.0; 2]), (1, [1.0; 2])]).contains("in one place"));
    assert!(said(&[(0, [0.0; 2]), (1, [1.0, 2.0]), (2, [2.0, 4.0])]).contains("on one line"));
    let error = Pins::read("0 1 2 # a corner\n\n1 x 2\n2 0 0 soft 3\n3 1").expect_err("two bad lines").to_string();
    assert!(error.contains("line 3: '1 x 2'") && error.contains("line 5: '3 1'"), "{error}");
    let error = Pins::read("0 1 2\n0 3 4\n5 inf 0\n6 0 0 soft -1").expect_err("three bad lines").to_string();
    for part in ["line 2: vertex 0 is pinned twice", "line 3: the pin of vertex 5", "line 4: the pin of vertex 6"] {
        assert!(error.contains(part), "{error}");
    }
    for text in ["", "# 0 1 2"] {
        assert!(Pins::read(text).expect_err("no pins").to_string().contains("the file has no pins"), "{text}");
    }
    let [a, b, c] = mesh.faces()[7].map(|v| v.index() as u32);
    assert!(said(&[(a, [0.0, 0.0]), (c, [1.0, 0.0]), (b, [0.0, 1.0])]).contains("turn face 7 over"));
    assert!(said(&[(0, [1e17, 1e17]), (20, [1e17, 1e17 + 16.0])]).contains("doubles do not hold"));
    let read = Pins::read("0 1 2 # a corner\n2 0 0 soft 3").expect("pins");
    // Some editors put a byte-order mark first.
    assert_eq!(Pins::read("\u{feff}0 1 2\r\n2 0 0 soft 3\r\n"), Ok(read.clone()));
    assert_eq!(Pins::read(&read.to_string()), Ok(read));
    let pipeline = Pipeline { pins: Some(Pins::default()), normalize: true, ..Pipeline::default() };
    assert_eq!(pipeline.check(), Err(FlattenError::PinsElsewhere(Elsewhere::Normalize)));
}
