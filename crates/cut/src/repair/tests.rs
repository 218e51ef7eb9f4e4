use super::*;
use crate::test_support::{Random, mesh, moebius, octahedron, sheet, tetrahedron, torus};
use crate::{CostSettings, EdgeCosts, HoleFilling, Seams, extend, fill, open, split};
use abf_mesh::Point3;
use proptest::prelude::*;

/// Repairs, and checks every law and every map back.
fn repaired(input: &TriMesh) -> Repaired {
    let result = repair(input).expect("faces");
    result.topology.check().expect("lawful");
    assert_eq!(result.mesh.face_count(), result.faces.len());
    assert_eq!(result.mesh.face_count() + result.duplicates.len() + result.repeated.len(), input.face_count());
    for (v, p) in result.vertices.iter().zip(result.mesh.positions()) {
        assert_eq!(*p, input.positions()[v.index()]);
    }
    for c in result.topology.corners() {
        let there = result.input_corner(c);
        let in_input = input.faces()[there.face().index()][there.place()];
        assert_eq!(result.vertices[result.topology.vertex(c).index()], in_input);
    }
    for (dropped, kept) in &result.duplicates {
        let sorted = |f: &FaceId| {
            let mut face = input.faces()[f.index()];
            face.sort_unstable();
            face
        };
        assert_eq!(sorted(dropped), sorted(kept));
        assert!(result.faces.contains(kept));
    }
    assert_eq!(result, repair(input).expect("faces"), "the same again");
    result
}

fn components(r: &Repaired) -> Vec<crate::Chart> {
    split(&r.mesh, &r.topology, &Seams::none(&r.topology)).expect("charts")
}

/// Meshes side by side, in one list.
fn welded(parts: &[(&TriMesh, &dyn Fn(usize) -> usize)], points: &[[f64; 3]]) -> TriMesh {
    let faces: Vec<[usize; 3]> =
        parts.iter().flat_map(|(part, at)| part.faces().iter().map(move |f| f.map(|v| at(v.index())))).collect();
    mesh(points, &faces)
}

fn points(mesh: &TriMesh) -> Vec<[f64; 3]> {
    mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect()
}

#[test]
fn a_manifold_comes_back_as_it_is() {
    for input in [sheet(3, 4), torus(5, 5), tetrahedron()] {
        let result = repaired(&input);
        assert_eq!(result.mesh, input);
        assert!(result.report.is_clean());
        assert_eq!(result.report.sentences(), [""; 0]);
        assert!(result.turned.iter().all(|t| !t));
    }
}

#[test]
fn two_tetrahedra_that_share_an_edge_are_two_again() {
    let one = tetrahedron();
    let mut all = points(&one);
    all.extend([[-1.0, 0.2, 0.1], [-1.0, 0.1, 0.9]]);
    // The second has vertices 0 and 3 of the first, and two of its own.
    let two = welded(&[(&one, &|v| v), (&one, &|v| [3, 4, 5, 0][v])], &all);
    let result = repaired(&two);
    assert_eq!(result.report.non_manifold_edges.count, 1);
    assert_eq!(result.report.split_vertices, Found { count: 2, first: Some(0) });
    let parts = components(&result);
    assert_eq!(parts.len(), 2);
    assert!(parts.iter().all(|part| part.topology.euler_characteristic() == 2));
}

#[test]
fn two_tetrahedra_that_share_a_vertex_are_two_again() {
    let one = tetrahedron();
    let mut all = points(&one);
    all.extend([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]);
    let two = welded(&[(&one, &|v| v), (&one, &|v| if v == 0 { 0 } else { v + 3 })], &all);
    let result = repaired(&two);
    assert_eq!(result.report.split_vertices, Found { count: 1, first: Some(0) });
    assert_eq!(result.vertices[7], VertexId::new(0));
    assert_eq!(components(&result).len(), 2);
    assert_eq!(result.report.sentences(), ["1 vertex split (the first at 0)"]);
}

#[test]
fn a_page_on_a_sheet_is_taken_off_and_the_sheet_stays_whole() {
    let flat = sheet(4, 4);
    let mut all = points(&flat);
    let first = all.len();
    // A wall on the line i = 2.
    all.extend((0_u8..5).map(|j| [2.0, f64::from(j), 1.0]));
    let mut faces: Vec<[usize; 3]> = flat.faces().iter().map(|f| f.map(VertexId::index)).collect();
    for j in 0..4 {
        faces.push([10 + j, 11 + j, first + j + 1]);
        faces.push([10 + j, first + j + 1, first + j]);
    }
    let result = repaired(&mesh(&all, &faces));
    assert_eq!(result.report.non_manifold_edges.count, 4);
    let parts = components(&result);
    assert_eq!(parts.iter().map(|p| p.faces.len()).collect::<Vec<_>>(), [32, 8]);
    parts.iter().for_each(|p| p.topology.require_disk().expect("a disk"));
}

#[test]
fn faces_turned_the_wrong_way_are_turned_with_the_majority() {
    let mut faces: Vec<[usize; 3]> = octahedron().faces().iter().map(|f| f.map(VertexId::index)).collect();
    faces[3].swap(0, 1);
    faces[6].swap(1, 2);
    let result = repaired(&mesh(&points(&octahedron()), &faces));
    assert_eq!(result.report.turned_faces, Found { count: 2, first: Some(3) });
    assert_eq!(result.turned.iter().filter(|t| **t).count(), 2);
    assert_eq!(result.topology.euler_characteristic(), 2);
    assert_eq!(result.report.sentences(), ["2 faces turned around (the first at 3)"]);
}

#[test]
fn duplicates_and_faces_with_a_repeated_vertex_are_dropped() {
    let flat = sheet(2, 2);
    let mut faces: Vec<[usize; 3]> = flat.faces().iter().map(|f| f.map(VertexId::index)).collect();
    let [a, b, c] = faces[1];
    faces.insert(5, [b, c, a]);
    faces.push([c, b, a]);
    faces.push([0, 0, 1]);
    let result = repaired(&mesh(&points(&flat), &faces));
    assert_eq!(result.duplicates, [(5, 1), (9, 1)].map(|(d, k)| (FaceId::new(d), FaceId::new(k))));
    assert_eq!(result.repeated, [FaceId::new(10)]);
    assert_eq!(result.mesh.faces(), flat.faces());
    assert!(!result.report.is_clean());
}

#[test]
fn a_one_sided_band_is_cut_across() {
    let result = repaired(&moebius(12));
    assert!(result.report.one_sided_cuts.count >= 2);
    let parts = components(&result);
    assert_eq!(parts.len(), 1);
    parts[0].topology.require_disk().expect("a disk");
}

#[test]
fn a_closed_one_sided_surface_is_cut_open() {
    // A Klein bottle: a torus whose last column meets the first upside down.
    let (m, n) = (7, 6);
    let at = |i: usize, j: usize| if i < m { i * n + j % n } else { (n - j % n) % n };
    let square = |(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
    let faces: Vec<_> = (0..m).flat_map(|i| (0..n).map(move |j| (i, j))).flat_map(square).collect();
    let result = repaired(&mesh(&points(&torus(m, n)), &faces));
    assert!(result.report.one_sided_cuts.count > 0);
    assert!(result.topology.boundary_edge_count() > 0);
}

#[test]
fn nothing_to_work_with_is_said() {
    let e = repair(&mesh(&[[0.0; 3]], &[[0, 0, 0]])).unwrap_err();
    assert_eq!(e.to_string(), "the mesh has no face with three different vertices (1 faces in all)");
    let bad = TriMesh::new(vec![Point3::new(f64::NAN, 0.0, 0.0); 3], &[[0, 1, 2]]).expect("indices in range");
    assert!(matches!(repair(&bad), Err(RepairError::Geometry(_))));
}

/// The surface of a random voxel model: two triangles for each side between a full cell and an empty one, vertices
/// shared. Cells that touch along an edge or in a corner make it non-manifold.
fn voxels(side: usize, density: f64, seed: u64) -> TriMesh {
    let mut random = Random::new(seed);
    let full: Vec<bool> = (0..side.pow(3)).map(|_| random.unit() < density).collect();
    let is_full = |cell: [usize; 3]| {
        let inside = cell.iter().all(|x| (1..=side).contains(x));
        inside && full[cell.iter().fold(0, |at, x| at * side + x - 1)]
    };
    let grid = side + 3;
    let mut faces = Vec::new();
    for at in 0..(side + 1).pow(3) {
        let cell = [at / (side + 1).pow(2), at / (side + 1) % (side + 1), at % (side + 1)];
        for axis in 0..3 {
            let step = |mut place: [usize; 3], axis: usize| {
                place[axis] += 1;
                place
            };
            let beyond = step(cell, axis);
            if is_full(cell) == is_full(beyond) {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let square = [beyond, step(beyond, u), step(step(beyond, u), v), step(beyond, v)];
            let [a, b, c, d] = square.map(|[x, y, z]| (x * grid + y) * grid + z);
            faces.extend(if is_full(cell) { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
    let place = |v: usize| [v / grid / grid, v / grid % grid, v % grid].map(|x| x as f64);
    let points: Vec<[f64; 3]> = (0..grid.pow(3)).map(place).collect();
    mesh(&points, &faces)
}

#[test]
fn no_random_voxel_model_is_refused() {
    for seed in 0..200 {
        let side = 4 + (seed as usize) % 7;
        let density = 0.35 + 0.05 * ((seed / 7) % 7) as f64;
        let input = voxels(side, density, seed);
        let result = repaired(&input);
        assert_eq!(result.mesh.face_count(), input.face_count(), "{side}, {density}, {seed}");
        for part in components(&result) {
            let seams = open(&part.topology, &costs(&part.mesh, &part.topology));
            require_one_disk(&split(&part.mesh, &part.topology, &seams).expect("charts"));
        }
    }
}

#[test]
fn an_edge_whose_partner_has_moved_to_another_copy_is_let_go() {
    // Random pages around few vertices: nearly every edge has many faces.
    let mut random = Random::new(7);
    for _ in 0..1000 {
        let vertices = 4 + random.below(8);
        let places: Vec<[f64; 3]> = (0..vertices).map(|_| [(); 3].map(|()| random.unit())).collect();
        let count = 1 + random.below(40);
        let mut faces: Vec<[usize; 3]> = (0..count).map(|_| [(); 3].map(|()| random.below(vertices))).collect();
        faces.push([0, 1, 2]);
        let result = repaired(&mesh(&places, &faces));
        assert!(result.topology.face_count() > 0);
    }
}

fn costs(mesh: &TriMesh, topology: &Topology) -> EdgeCosts {
    EdgeCosts::new(mesh, topology, &CostSettings::default(), |_| false)
}

fn require_one_disk(charts: &[crate::Chart]) {
    assert_eq!(charts.len(), 1);
    charts[0].topology.check().expect("lawful");
    charts[0].topology.require_disk().expect("a disk");
}

proptest! {
    #[test]
    fn any_faces_at_all_become_a_manifold(
        faces in prop::collection::vec([0..9_usize, 0..9, 0..9], 1..60),
        places in prop::collection::vec([-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], 9),
    ) {
        let input = mesh(&places, &faces);
        if faces.iter().all(|&[a, b, c]| a == b || b == c || c == a) {
            let nothing = RepairError::NoFaces { faces: faces.len() };
            prop_assert_eq!(repair(&input), Err(nothing));
            return Ok(());
        }
        for part in components(&repaired(&input)) {
            let mut holes = part.topology.boundary_loops();
            let seams = open(&part.topology, &costs(&part.mesh, &part.topology));
            require_one_disk(&split(&part.mesh, &part.topology, &seams).expect("charts"));
            holes.truncate(holes.len() - holes.len().min(1));
            for filling in [HoleFilling::Fan, HoleFilling::Ears] {
                let filled = fill(&part.mesh, &part.topology, &holes, filling).expect("a manifold");
                prop_assert!(filled.topology.boundary_loops().len() <= 1);
                let costs = costs(&filled.mesh, &filled.topology);
                let mut seams = open(&filled.topology, &costs);
                let all: Vec<VertexId> = filled.topology.vertices().collect();
                extend(&filled.topology, &costs, &mut seams, &all[..all.len().min(4)]);
                require_one_disk(&split(&filled.mesh, &filled.topology, &seams).expect("charts"));
            }
        }
    }
}
