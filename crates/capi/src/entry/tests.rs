use super::*;
use crate::event::{ABF_ABORT, ABF_STOP, AbfEventKind};
use crate::options::ABF_NO_MARGIN;
use abf_shapes::Shape;
use std::mem::{MaybeUninit, zeroed};

const CUBE: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];
const FACES: [u32; 36] =
    [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5];

fn options() -> AbfOptions {
    // SAFETY: that is what the header asks for.
    AbfOptions { size: size_of::<AbfOptions>(), ..unsafe { zeroed() } }
}

fn unwrap(options: &AbfOptions) -> Result<Owned, (AbfStatus, String)> {
    unwrap_of(&CUBE, &FACES, options)
}

fn unwrap_of(positions: &[[f32; 3]], indices: &[u32], options: &AbfOptions) -> Result<Owned, (AbfStatus, String)> {
    let mut result = ptr::null_mut();
    // SAFETY: slices are as long as they say.
    let status = unsafe {
        abf_unwrap(positions.as_ptr().cast(), positions.len(), 0, indices.as_ptr(), indices.len(), options, &mut result)
    };
    owned(status, result)
}

fn flatten_of(positions: &[[f64; 3]], indices: &[u32], options: &AbfOptions) -> Result<Owned, (AbfStatus, String)> {
    let mut result = ptr::null_mut();
    // SAFETY: slices are as long as they say.
    let status = unsafe {
        abf_flatten(positions.as_ptr().cast(), positions.len(), indices.as_ptr(), indices.len(), options, &mut result)
    };
    owned(status, result)
}

fn owned(status: AbfStatus, result: *mut AbfResult) -> Result<Owned, (AbfStatus, String)> {
    assert_eq!(result.is_null(), status != AbfStatus::Ok);
    if status == AbfStatus::Ok { Ok(Owned(result)) } else { Err((status, said())) }
}

fn said() -> String {
    // SAFETY: it ends with a zero.
    unsafe { CStr::from_ptr(abf_last_error()) }.to_string_lossy().into_owned()
}

struct Owned(*mut AbfResult);

impl std::fmt::Debug for Owned {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a result")
    }
}

impl Owned {
    fn view(&self) -> AbfView {
        let mut view = MaybeUninit::<AbfView>::uninit();
        // SAFETY: only the size is read, and then all of it is written.
        unsafe {
            (&raw mut (*view.as_mut_ptr()).size).write(size_of::<AbfView>());
            assert_eq!(abf_result_view(self.0, view.as_mut_ptr()), AbfStatus::Ok);
            view.assume_init()
        }
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: it is freed once.
        unsafe { abf_result_free(self.0) };
    }
}

fn sheet() -> (Vec<[f64; 3]>, Vec<u32>) {
    let mesh = Shape::BumpySheet.mesh(800);
    let positions = mesh.positions().iter().map(|p| [p.x, p.y, p.z]).collect();
    (positions, mesh.faces().iter().flatten().map(|v| v.index() as u32).collect())
}

#[test]
fn a_cube_comes_back_in_its_vertices() {
    let view = unwrap(&AbfOptions { margin: 4, width: 256, ..options() }).map(|result| (result.view(), result));
    let (view, _result) = view.expect("a cube");
    assert!(view.certified && view.injective && view.chart_count >= 1 && view.triangle_count == 12);
    assert_eq!((view.width, view.height, view.page_count), (256, 256, 1));
    // SAFETY: that is how long they are said to be.
    let (indices, remap) =
        unsafe { (slice::from_raw_parts(view.indices, 36), slice::from_raw_parts(view.remap, view.vertex_count)) };
    let old: Vec<u32> = indices.iter().map(|&new| remap[new as usize]).collect();
    assert_eq!(old, FACES);
}

#[test]
fn a_disk_has_the_bits_of_the_library() {
    let (positions, indices) = sheet();
    let flat = abf::flatten(&Shape::BumpySheet.mesh(800)).expect("a disk");
    let result = flatten_of(&positions, &indices, &AbfOptions { threads: 2, ..options() }).expect("a disk");
    let view = result.view();
    // SAFETY: that is how long it is said to be.
    let uv = unsafe { slice::from_raw_parts(view.uv64, 2 * view.vertex_count) };
    let expected: Vec<f64> = flat.uv.points().iter().flat_map(|p| [p.x, p.y]).collect();
    assert_eq!(uv, expected);
    assert!(view.certified && view.uv32.is_null() && view.indices.is_null());
}

#[test]
fn a_vertex_of_no_face_shifts_no_uv() {
    let (mut positions, mut indices) = sheet();
    let plain = flatten_of(&positions, &indices, &options()).expect("a disk");
    positions.insert(0, [9.0; 3]);
    indices.iter_mut().for_each(|i| *i += 1);
    let shifted = flatten_of(&positions, &indices, &options()).expect("a disk");
    assert_eq!(shifted.view().vertex_count, positions.len());
    let uv = uv_of(&shifted);
    assert_eq!((uv[0], &uv[1..]), ([0.0; 2], &uv_of(&plain)[..]));
    let relaxed = relax_of((&positions, &indices), (&uv, None), &options()).expect("a map");
    assert_eq!((relaxed.view().vertex_count, uv_of(&relaxed)[0]), (positions.len(), [0.0; 2]));
}

#[test]
fn every_wrong_argument_has_a_status_and_a_sentence() {
    let cube: Vec<[f64; 3]> = CUBE.iter().map(|p| p.map(f64::from)).collect();
    let wrong = |options: AbfOptions| unwrap(&options).expect_err("refused");
    let cases = [
        (wrong(AbfOptions { size: 12, ..options() }), AbfStatus::StructSize, "size is 12"),
        (wrong(AbfOptions { solver: c"abc".as_ptr(), ..options() }), AbfStatus::Setting, "solver 'abc'"),
        (wrong(AbfOptions { pack: c"abc".as_ptr(), ..options() }), AbfStatus::Setting, "packing effort 'abc'"),
        (wrong(AbfOptions { max_stretch: 0.5, ..options() }), AbfStatus::Setting, "max_stretch must be at least 1"),
        (wrong(AbfOptions { tolerance: f64::NAN, ..options() }), AbfStatus::Setting, "tolerance must be"),
        (wrong(AbfOptions { time_limit: -1.0, ..options() }), AbfStatus::Setting, "time_limit must be"),
        (wrong(AbfOptions { max_memory: 1000, ..options() }), AbfStatus::Memory, "the limit is 1.0 kB"),
        (wrong(AbfOptions { texels_per_unit: 1e5, ..options() }), AbfStatus::Packing, "page"),
        (wrong(AbfOptions { coverage: 2.0, ..options() }), AbfStatus::Setting, "coverage must be in (0, 1], got 2"),
        (wrong(AbfOptions { seam_budget: 0.5, ..options() }), AbfStatus::Setting, "set coverage, too"),
        (
            wrong(AbfOptions { coverage: 0.5, seam_budget: -1.0, ..options() }),
            AbfStatus::Setting,
            "seam budget must be",
        ),
        (wrong(AbfOptions { inner_margin: c"part".as_ptr(), ..options() }), AbfStatus::Setting, "'keep' or 'count'"),
        (wrong(AbfOptions { overlap: c"yes".as_ptr(), ..options() }), AbfStatus::Setting, "'allow' or 'refuse'"),
        (wrong(AbfOptions { atlas: c"two".as_ptr(), ..options() }), AbfStatus::Setting, "'two'"),
        (wrong(AbfOptions { atlas: c"per-material".as_ptr(), ..options() }), AbfStatus::Setting, "material"),
        (wrong(AbfOptions { seams: c"keep".as_ptr(), ..options() }), AbfStatus::Setting, "none of them is given"),
        (wrong(AbfOptions { mip_levels: 2, margin: 3, ..options() }), AbfStatus::Setting, "mip_levels sets the margin"),
        (wrong(AbfOptions { max_seam: -1.0, ..options() }), AbfStatus::Setting, "max_seam"),
        (wrong(AbfOptions { wheel: c"log".as_ptr(), ..options() }), AbfStatus::Setting, "means nothing to the solver"),
        (wrong(AbfOptions { boundary: c"convex".as_ptr(), ..options() }), AbfStatus::Setting, "for one disk"),
        (wrong(AbfOptions { energy: c"little".as_ptr(), ..options() }), AbfStatus::Setting, "energy must be abf"),
        (wrong(AbfOptions { energy: c"-1".as_ptr(), ..options() }), AbfStatus::Setting, "energy must be abf"),
        (wrong(AbfOptions { pin_count: 1, ..options() }), AbfStatus::Pointer, "pin_vertices is null"),
        (wrong(AbfOptions { pin_count: usize::MAX, ..options() }), AbfStatus::TooLarge, "pin_count is"),
        (wrong(AbfOptions { uv_indices: FACES.as_ptr(), ..options() }), AbfStatus::Setting, "uv, which is not given"),
        (unwrap_of(&CUBE, &FACES[..35], &options()).unwrap_err(), AbfStatus::IndexCount, "35 indices"),
        (unwrap_of(&CUBE, &[0, 1, 8], &options()).unwrap_err(), AbfStatus::IndexRange, "has the index 8"),
        (unwrap_of(&[[f32::NAN; 3]; 3], &[0, 1, 2], &options()).unwrap_err(), AbfStatus::NotFinite, "vertex 0"),
        (unwrap_of(&CUBE, &[], &options()).unwrap_err(), AbfStatus::Topology, "no face"),
        (unwrap_of(&[[0.0; 3], [1.0; 3], [2.0; 3]], &[0, 1, 2], &options()).unwrap_err(), AbfStatus::Geometry, "area"),
        (flatten_of(&cube, &FACES, &options()).unwrap_err(), AbfStatus::NotADisk, "closed"),
        (flatten_of(&cube, &FACES[..35], &options()).unwrap_err(), AbfStatus::IndexCount, "35 indices"),
        (flatten_of(&cube, &[0, 1, 9], &options()).unwrap_err(), AbfStatus::IndexRange, "vertex 9"),
        (flatten_of(&[[f64::NAN; 3]; 3], &[0, 1, 2], &options()).unwrap_err(), AbfStatus::NotFinite, "vertex 0"),
    ];
    for ((status, sentence), expected, part) in cases {
        assert_eq!(status, expected, "{sentence}");
        assert!(sentence.contains(part), "{sentence}");
    }
}

#[test]
fn a_boundary_that_no_map_has_is_a_wrong_setting() {
    let (positions, indices) = sheet();
    let refused = |options: AbfOptions| {
        let (status, sentence) = flatten_of(&positions, &indices, &options).expect_err("refused");
        assert_eq!(status, AbfStatus::Setting, "{sentence}");
        sentence
    };
    assert!(
        refused(AbfOptions { boundary: c"oval".as_ptr(), ..options() }).starts_with("boundary must be free, convex")
    );
    let twice = AbfOptions { boundary: c"rectangle=0,0,1,2".as_ptr(), ..options() };
    assert!(refused(twice).contains("the corner 0 of the rectangle is named twice"));
    let alone = AbfOptions { boundary: c"convex".as_ptr(), solver: c"lscm".as_ptr(), ..options() };
    assert!(refused(alone).contains("does not keep a boundary rule"));
    let (vertices, angles) = ([0_u32, 100_000], [1.0, 1.0]);
    let angles = AbfOptions {
        boundary_vertices: vertices.as_ptr(),
        boundary_angles: angles.as_ptr(),
        boundary_count: 2,
        ..options()
    };
    assert!(refused(angles).contains("100000"));
    assert!(refused(AbfOptions { boundary: c"circle".as_ptr(), ..angles }).contains("leave one out"));
    let bound = AbfOptions { solver: c"linabf".as_ptr(), error_bound: 1.5, ..options() };
    assert!(refused(bound).contains("error_bound must be in (0, 1), got 1.5"));
}

#[test]
fn a_boundary_is_what_was_asked_for() {
    let (positions, indices) = sheet();
    let mesh = Shape::BumpySheet.mesh(800);
    let flat = |options: AbfOptions| {
        let result = flatten_of(&positions, &indices, &options).expect("a disk");
        let view = result.view();
        // SAFETY: that is how long it is said to be.
        unsafe { slice::from_raw_parts(view.uv64, 2 * view.vertex_count) }.to_vec()
    };
    let expected = |boundary: abf::Boundary| {
        let flat = abf::Pipeline { boundary, ..abf::Pipeline::default() }.run(&mesh, &mut abf::Silent).expect("a disk");
        flat.uv.points().iter().flat_map(|p| [p.x, p.y]).collect::<Vec<f64>>()
    };
    assert_eq!(flat(AbfOptions { boundary: c"circle".as_ptr(), ..options() }), expected(abf::Boundary::Circle));
    let (vertices, angles) = ([0_u32], [1.0]);
    let given = AbfOptions {
        boundary_vertices: vertices.as_ptr(),
        boundary_angles: angles.as_ptr(),
        boundary_count: 1,
        ..options()
    };
    let angle = abf::BoundaryAngle { vertex: 0, angle: 1.0, line: None };
    assert_eq!(flat(given), expected(abf::Boundary::Angles(vec![angle])));
}

/// Pins of the first vertices at these places.
fn pinned<'a>(vertices: &'a [u32], places: &'a [[f64; 2]]) -> AbfOptions {
    AbfOptions {
        pin_vertices: vertices.as_ptr(),
        pin_uvs: places.as_ptr().cast(),
        pin_count: vertices.len(),
        ..options()
    }
}

fn uv_of(owned: &Owned) -> Vec<[f64; 2]> {
    let view = owned.view();
    // SAFETY: that is how long it is said to be.
    unsafe { slice::from_raw_parts(view.uv64.cast(), view.vertex_count) }.to_vec()
}

#[test]
fn an_energy_is_less_after_relaxing() {
    let (positions, indices) = sheet();
    let mesh = Shape::BumpySheet.mesh(800);
    let plain = flatten_of(&positions, &indices, &options()).expect("a disk").view();
    assert_eq!((plain.relax_steps, plain.energy_before, plain.pin_count), (0, 0.0, 0));
    for (name, energy) in [(c"isometric", abf::Energy::Isometric), (c"0.5", abf::Energy::Slider(0.5))] {
        let result = flatten_of(&positions, &indices, &AbfOptions { energy: name.as_ptr(), ..options() });
        let result = result.expect("a disk");
        let view = result.view();
        let relax = Some(abf::Relax { energy, ..abf::Relax::default() });
        let flat = abf::Pipeline { relax, ..abf::Pipeline::default() }.run(&mesh, &mut abf::Silent).expect("a disk");
        let report = flat.relaxed.expect("a report");
        assert_eq!(
            (view.energy_before, view.energy_after, view.relax_steps),
            (report.before, report.after, report.steps)
        );
        assert!(view.certified && view.energy_after < view.energy_before && view.stretch_l2 < plain.stretch_l2);
        assert_eq!(uv_of(&result), flat.uv.points().iter().map(|p| [p.x, p.y]).collect::<Vec<_>>());
    }
    let atlas = unwrap(&AbfOptions { energy: c"usable".as_ptr(), ..options() }).expect("a cube").view();
    assert!(atlas.certified && atlas.energy_after <= atlas.energy_before * (1.0 + 1e-9));
    let kept = AbfOptions { energy: c"usable".as_ptr(), boundary: c"convex".as_ptr(), ..options() };
    let (status, sentence) = flatten_of(&positions, &indices, &kept).unwrap_err();
    assert_eq!((status, sentence.contains("moves the boundary")), (AbfStatus::Setting, true));
}

#[test]
fn pins_are_met_or_said_to_be_missed() {
    let (positions, indices) = sheet();
    let places = [[1.0, 2.0], [4.0, 2.0]];
    let result = flatten_of(&positions, &indices, &pinned(&[0, 9], &places)).expect("a disk");
    let (view, uv) = (result.view(), uv_of(&result));
    assert_eq!((uv[0], uv[9], view.pin_count, view.pins_missed), (places[0], places[1], 2, 0));
    // SAFETY: that is how long it is said to be.
    assert_eq!(unsafe { slice::from_raw_parts(view.pin_distances, 2) }, [0.0, 0.0]);
    // A weight makes a pin soft.
    let weights = [0.0, 0.5];
    let soft = AbfOptions { pin_weights: weights.as_ptr(), ..pinned(&[0, 9], &places) };
    let result = flatten_of(&positions, &indices, &soft).expect("a disk");
    assert!(result.view().pins_missed == 0 && uv_of(&result)[0] == places[0] && uv_of(&result)[9] != places[1]);
    let refused = |options: AbfOptions, part: &str| {
        let (status, sentence) = flatten_of(&positions, &indices, &options).map(|_| ()).unwrap_err();
        assert_eq!((status, sentence.contains(part)), (AbfStatus::Setting, true), "{sentence}");
    };
    refused(pinned(&[0, 100_000], &places), "there is no vertex 100000");
    refused(pinned(&[0, 0], &places), "vertex 0 is pinned twice");
    refused(pinned(&[0, 9], &[[1.0; 2]; 2]), "in one place");
    refused(pinned(&[0, 9], &[[f64::NAN; 2], [0.0; 2]]), "not finite");
    refused(AbfOptions { normalize: 1, ..pinned(&[0, 9], &places) }, "pins do not go with normalize");
    let (status, sentence) = unwrap(&pinned(&[0, 1], &places)).unwrap_err();
    assert_eq!((status, sentence.contains("charts")), (AbfStatus::Setting, true), "{sentence}");
}

fn relax_of(
    (positions, indices): (&[[f64; 3]], &[u32]),
    (uv, corners): (&[[f64; 2]], Option<&[u32]>),
    options: &AbfOptions,
) -> Result<Owned, (AbfStatus, String)> {
    let mut result = ptr::null_mut();
    let corners = corners.map_or(ptr::null(), <[u32]>::as_ptr);
    let (vertices, count) = (positions.as_ptr().cast(), indices.len());
    // SAFETY: slices are as long as they say.
    let status = unsafe {
        let (at, rows) = (uv.as_ptr().cast(), uv.len());
        abf_relax(vertices, positions.len(), indices.as_ptr(), count, at, rows, corners, options, &mut result)
    };
    owned(status, result)
}

#[test]
fn a_chart_that_is_no_manifold_stays_and_counts_as_unfinished() {
    let (mut positions, mut indices) = sheet();
    let mut uv: Vec<[f64; 2]> = positions.iter().map(|&[x, y, _]| [x, y]).collect();
    let first = positions.len() as u32;
    let bow = [[9.0, 0.0], [10.0, 0.0], [10.0, 1.0], [11.0, 2.0], [10.0, 2.0]];
    positions.extend(bow.map(|[x, y]| [x, y, 0.0]));
    indices.extend([0, 1, 2, 2, 3, 4].map(|v| first + v));
    uv.extend(bow);
    let relaxed = relax_of((&positions, &indices), (&uv, None), &options()).expect("a map");
    let view = relaxed.view();
    assert_eq!((view.chart_count, view.unfinished, view.certified), (2, 1, false));
    let alone = relax_of(
        (&positions[..first as usize], &indices[..indices.len() - 6]),
        (&uv[..first as usize], None),
        &options(),
    );
    assert_eq!(alone.expect("a map").view().unfinished, 0);
    let (uv_before, uv_after) = (&uv[first as usize..], &uv_of(&relaxed)[first as usize..]);
    assert_eq!(uv_after, uv_before);
}

#[test]
fn a_map_that_is_there_is_relaxed() {
    let (positions, indices) = sheet();
    let mesh = (&positions[..], &indices[..]);
    let start = flatten_of(&positions, &indices, &AbfOptions { solver: c"lscm".as_ptr(), normalize: 1, ..options() });
    let start = start.expect("a disk");
    let uv = uv_of(&start);
    let relaxed = relax_of(mesh, (&uv, None), &options()).expect("a map");
    let view = relaxed.view();
    assert!(view.certified && view.relax_steps > 0 && view.energy_after < view.energy_before);
    assert!(
        view.stretch_l2 < start.view().stretch_l2 && view.indices.is_null() && view.vertex_count == positions.len()
    );
    // The same UVs corner by corner come to the same points, each with its vertex.
    let corners = relax_of(mesh, (&uv, Some(&indices)), &options()).expect("a map");
    let (each, points) = (corners.view(), uv_of(&corners));
    // SAFETY: that is how long they are said to be.
    let (rows, remap) = unsafe {
        (slice::from_raw_parts(each.indices, indices.len()), slice::from_raw_parts(each.remap, each.vertex_count))
    };
    let per_vertex = uv_of(&relaxed);
    for (&row, &vertex) in rows.iter().zip(&indices) {
        assert_eq!((remap[row as usize], points[row as usize]), (vertex, per_vertex[vertex as usize]));
    }
    let wrong = |uv: &[[f64; 2]], corners: Option<&[u32]>, options: &AbfOptions| {
        relax_of(mesh, (uv, corners), options).map(|_| ()).unwrap_err()
    };
    let cases = [
        (wrong(&uv[1..], None, &options()), AbfStatus::Setting, "uv_count must be the number of vertices"),
        (wrong(&uv[..9], Some(&indices), &options()), AbfStatus::IndexRange, "there are 9 UVs"),
        (wrong(&vec![[f64::NAN; 2]; uv.len()], None, &options()), AbfStatus::NotFinite, "not finite"),
        (wrong(&uv, None, &AbfOptions { energy: c"0".as_ptr(), ..options() }), AbfStatus::Setting, "energy must be"),
        (wrong(&uv, None, &AbfOptions { max_memory: 9, ..options() }), AbfStatus::Memory, "the limit"),
        (
            relax_of((&positions, &indices[1..]), (&uv, None), &options()).unwrap_err(),
            AbfStatus::IndexCount,
            "no triangles",
        ),
    ];
    for ((status, sentence), expected, part) in cases {
        assert!(status == expected && sentence.contains(part), "{status:?}: {sentence}");
    }
    let mut result = ptr::null_mut();
    // SAFETY: nothing is read where a call is refused.
    let status = unsafe {
        let (v, i) = (positions.as_ptr().cast(), indices.as_ptr());
        abf_relax(v, positions.len(), i, indices.len(), ptr::null(), 3, ptr::null(), ptr::null(), &mut result)
    };
    assert_eq!((status, said().as_str()), (AbfStatus::Pointer, "uv is null"));
    let stages = |event: &AbfEvent| event.kind == AbfEventKind::Stage && event.stage == crate::event::AbfStage::Relax;
    let mut heard = false;
    let energy = AbfOptions { energy: c"usable".as_ptr(), ..options() };
    // SAFETY: it is a live struct.
    let settings = unsafe { read_options(&energy) }.expect("settings").settings;
    run::flatten(&positions, &indices, &settings, &mut |event| {
        heard |= stages(event);
        ABF_CONTINUE
    })
    .expect("a disk");
    assert!(heard);
}

#[test]
fn what_is_known_of_a_mesh_decides_where_its_charts_end() {
    let charts = |options: AbfOptions| unwrap(&options).map(|result| result.view().chart_count);
    assert_eq!(charts(options()), Ok(1));
    // The four edges around the bottom of the cube.
    let around = [0_u32, 1, 1, 3, 3, 2, 2, 0];
    let marked = AbfOptions { seam_vertices: around.as_ptr(), seam_count: 4, ..options() };
    assert_eq!(charts(marked), Ok(2));
    assert_eq!(charts(AbfOptions { seams: c"auto".as_ptr(), ..marked }), Ok(1));
    let materials: Vec<u32> = (0..12).map(|triangle| triangle / 2).collect();
    let painted = AbfOptions { materials: materials.as_ptr(), ..options() };
    assert_eq!(charts(painted), Ok(1));
    assert_eq!(charts(AbfOptions { seams: c"keep".as_ptr(), ..painted }), Ok(6));
    let by_material = AbfOptions { atlas: c"per-material".as_ptr(), ..painted };
    assert_eq!(unwrap(&by_material).map(|result| result.view().page_count), Ok(6));
    // UVs of its own for every corner: each triangle is an island.
    let uv: Vec<[f32; 2]> = (0..36).map(|corner| [(corner % 3 / 2) as f32, (corner % 3 % 2) as f32]).collect();
    let corners: Vec<u32> = (0..36).collect();
    let islands = AbfOptions {
        uv: uv.as_ptr().cast(),
        uv_count: 36,
        uv_indices: corners.as_ptr(),
        seams: c"keep".as_ptr(),
        ..options()
    };
    assert!(charts(islands).expect("islands") >= 6);
    let too_few = AbfOptions { uv_indices: ptr::null(), uv_count: 7, ..islands };
    let (status, sentence) = charts(too_few).unwrap_err();
    assert_eq!((status, sentence.contains("uv_count must be the number of vertices, 8")), (AbfStatus::Setting, true));
    let nowhere = AbfOptions { uv_count: 35, ..islands };
    assert_eq!(charts(nowhere).unwrap_err().0, AbfStatus::IndexRange);
    let outside = [0_u32, 8];
    let (status, sentence) =
        charts(AbfOptions { seam_vertices: outside.as_ptr(), seam_count: 1, ..options() }).unwrap_err();
    assert_eq!((status, sentence.contains("has the index 8, and there are 8 vertices")), (AbfStatus::IndexRange, true));
}

#[test]
fn what_was_compiled_with_the_first_header_works() {
    let (positions, indices) = sheet();
    let [first, now] = AbfOptions::SIZES;
    assert!(first < now && now == size_of::<AbfOptions>());
    // What lies behind such options belongs to somebody else: it is not read.
    let (one, angle) = (0_u32, f64::NAN);
    let behind = AbfOptions { boundary_vertices: &one, boundary_angles: &angle, boundary_count: 1, ..options() };
    let plain = flatten_of(&positions, &indices, &options()).expect("a disk").view().angle_error;
    let old = flatten_of(&positions, &indices, &AbfOptions { size: first, ..behind }).expect("a disk");
    assert_eq!(old.view().angle_error, plain);
    assert!(flatten_of(&positions, &indices, &behind).is_err());
    let mut view = MaybeUninit::<[AbfView; 2]>::zeroed();
    // SAFETY: zeros are what the header asks for, and every field may be zero.
    let view = unsafe {
        let size = AbfView::SIZES[0];
        view.as_mut_ptr().cast::<usize>().write(size);
        let shown = view.as_mut_ptr().cast::<u8>();
        *shown.add(size) = 7;
        assert_eq!(abf_result_view(old.0, shown.cast()), AbfStatus::Ok);
        assert_eq!(*shown.add(size), 7, "nothing is written behind it");
        shown.cast::<AbfView>().read()
    };
    assert_eq!((view.size, view.angle_error), (AbfView::SIZES[0], plain));
}

#[test]
fn pointers_and_counts_are_looked_at_before_they_are_used() {
    let mut result = ptr::null_mut();
    let (positions, indices) = (CUBE.as_ptr().cast::<f32>(), FACES.as_ptr());
    // SAFETY: nothing is read where a call is refused.
    let refused = |status: AbfStatus, part: &str| assert!(said().contains(part), "{status:?}: {}", said());
    unsafe {
        let status = abf_unwrap(ptr::null(), 8, 0, indices, 36, ptr::null(), &mut result);
        assert_eq!(status, AbfStatus::Pointer);
        refused(status, "positions is null");
        let status = abf_unwrap(positions, 8, 0, ptr::null(), 36, ptr::null(), &mut result);
        assert_eq!(status, AbfStatus::Pointer);
        refused(status, "indices is null");
        let status = abf_unwrap(positions, 8, 0, indices, 36, ptr::null(), ptr::null_mut());
        assert_eq!(status, AbfStatus::Pointer);
        refused(status, "result is null");
        let status = abf_flatten(positions.byte_add(4).cast(), 1, indices, 3, ptr::null(), &mut result);
        // The array itself is aligned to 4 bytes only, so one of two addresses is not to 8.
        assert!(status != AbfStatus::Ok);
        for stride in [8, 13] {
            let status = abf_unwrap(positions, 8, stride, indices, 36, ptr::null(), &mut result);
            assert_eq!(status, AbfStatus::Stride);
        }
        for count in [usize::MAX, usize::MAX / 12 + 2, 1 << 33] {
            let status = abf_unwrap(positions, count, 0, indices, 36, ptr::null(), &mut result);
            assert_eq!(status, AbfStatus::TooLarge);
            refused(status, &format!("vertex_count is {count}"));
            let status = abf_flatten(ptr::null(), count, indices, 36, ptr::null(), &mut result);
            assert_eq!(status, AbfStatus::TooLarge);
            let status = abf_unwrap(positions, 8, 0, indices, count, ptr::null(), &mut result);
            assert_eq!(status, AbfStatus::TooLarge);
        }
        assert_eq!(abf_result_view(ptr::null(), ptr::null_mut()), AbfStatus::Pointer);
        abf_result_free(ptr::null_mut());
    }
    assert!(result.is_null());
}

#[test]
fn a_stride_skips_what_lies_between_vertices() {
    let apart: Vec<[f32; 5]> = CUBE.iter().map(|&[x, y, z]| [x, y, z, f32::NAN, 7.0]).collect();
    let mut result = ptr::null_mut();
    // SAFETY: the array is as long as said; the last vertex ends after 12 bytes.
    let status = unsafe { abf_unwrap(apart.as_ptr().cast(), 8, 20, FACES.as_ptr(), 36, ptr::null(), &mut result) };
    let (apart, close) = (owned(status, result).expect("a cube"), unwrap(&options()).expect("a cube"));
    let uv = |owned: &Owned| {
        let view = owned.view();
        // SAFETY: that is how long it is said to be.
        unsafe { slice::from_raw_parts(view.uv32, 2 * view.vertex_count) }.to_vec()
    };
    assert_eq!(uv(&apart), uv(&close));
}

#[test]
fn settings_reach_the_library() {
    let settings = |options: AbfOptions| {
        // SAFETY: it is a live struct with texts that end.
        unsafe { read_options(&options) }.map(|call| call.settings.unwrapper).expect("settings")
    };
    let default = settings(options());
    assert_eq!(default, abf::ArrayUnwrapper::new());
    let given = settings(AbfOptions {
        solver: c"abf++".as_ptr(),
        layout: c"tree".as_ptr(),
        weld: c"0.25".as_ptr(),
        holes: c"cut".as_ptr(),
        double_sided: c"shared".as_ptr(),
        pack: c"best".as_ptr(),
        tolerance: 1e-6,
        step_tolerance: 1e-5,
        time_limit: 2.5,
        max_memory: 1 << 30,
        max_iterations: 7,
        normalize: 1,
        strict: 1,
        keep_disks: 1,
        margin: ABF_NO_MARGIN,
        width: 512,
        height: 256,
        max_pages: 3,
        max_stretch: 1.5,
        crease_angle: 1.0,
        max_chart_length: f64::INFINITY,
        texels_per_unit: 12.0,
        zero_area: c"refuse".as_ptr(),
        ring_switch: f64::INFINITY,
        angle_bound: 0.25,
        wheel: c"log".as_ptr(),
        hessian: c"exact".as_ptr(),
        line_search: c"full".as_ptr(),
        coverage: 0.75,
        seam_budget: 0.5,
        inner_margin: c"keep".as_ptr(),
        max_seam: 3.0,
        atlas: c"per-component".as_ptr(),
        ..options()
    });
    let (unwrap, pipeline, atlas) = (&given.unwrap, &given.unwrap.pipeline, &given.atlas);
    assert_eq!((pipeline.solver.name(), pipeline.layout.kind.name()), ("abf++", "tree"));
    assert_eq!((pipeline.stop.tolerance, pipeline.stop.step_tolerance), (1e-6, 1e-5));
    assert_eq!(pipeline.stop.time_limit, Some(std::time::Duration::from_millis(2500)));
    assert_eq!((pipeline.max_memory, pipeline.stop.max_iterations, pipeline.normalize), (Some(1 << 30), 7, true));
    assert_eq!((unwrap.weld, unwrap.holes.to_string().as_str()), (abf::Weld::Within(0.25), "cut"));
    assert_eq!((unwrap.double_sided, atlas.effort), (abf::DoubleSided::Shared, abf::Effort::Best));
    assert_eq!((unwrap.strict, unwrap.cut_disks, unwrap.max_stretch, unwrap.crease_angle), (true, false, 1.5, 1.0));
    assert_eq!((unwrap.max_chart_length, atlas.texels_per_unit), (None, Some(12.0)));
    assert_eq!((atlas.page, atlas.margin, atlas.max_pages), ([512, 256], 0, 3));
    assert_eq!((pipeline.initial_guess.ring_switch, pipeline.initial_guess.angle_bound), (None, 0.25));
    assert_eq!((pipeline.zero_area, unwrap.max_seam), (abf::ZeroArea::Refuse, Some(3.0)));
    let newton = pipeline.solver.newton_settings().expect("a point of the grid");
    let expected = (abf::WheelForm::Log, abf::Hessian::Exact, abf::LineSearch::Full);
    assert_eq!((newton.wheel, newton.hessian, newton.line_search), expected);
    let parting = abf::Parting { coverage: Some(0.75), seam_budget: 0.5, keeps_inner_margin: true, max_stretch: 1.5 };
    assert_eq!((given.parting, atlas.pages), (Some(parting), abf::AtlasPages::PerComponent));
    let uzawa = settings(AbfOptions {
        solver: c"uzawa".as_ptr(),
        reduction: c"none".as_ptr(),
        preconditioner: c"jacobi".as_ptr(),
        max_inner_iterations: 9,
        inner_tolerance: 0.125,
        mip_levels: 3,
        ..options()
    });
    let iterative = uzawa.unwrap.pipeline.solver.iterative_settings().expect("it iterates");
    assert_eq!((iterative.reduction, iterative.max_inner_iterations), (abf::Reduction::None, 9));
    assert_eq!((iterative.preconditioner, uzawa.atlas.margin), (abf::PreconditionerKind::Jacobi, 16));
    let linabf = settings(AbfOptions { solver: c"linabf".as_ptr(), passes: 2, error_bound: 0.5, ..options() });
    let abf::Solver::LinAbf(linabf) = linabf.unwrap.pipeline.solver else { panic!("it is another solver") };
    assert_eq!((linabf.passes.to_string().as_str(), linabf.error_bound), ("2", Some(0.5)));
    let barrier = settings(AbfOptions { solver: c"barrier".as_ptr(), barrier_floor: 1e-7, ..options() });
    assert_eq!(barrier.unwrap.pipeline.solver.barrier_floor(), Some(1e-7));
}

/// Counts events, and answers with the second number from the first iteration on.
unsafe extern "C" fn count(user: *mut c_void, event: *const AbfEvent) -> i32 {
    // SAFETY: the test hands in two numbers.
    unsafe {
        let [events, answer] = &mut *user.cast::<[i32; 2]>();
        assert!((*event).faces_done <= (*event).faces);
        *events += 1;
        if (*event).kind == AbfEventKind::Iteration { *answer } else { ABF_CONTINUE }
    }
}

#[test]
fn a_callback_hears_stops_and_aborts() {
    let (positions, indices) = sheet();
    let run = |answer: i32| {
        let mut user = [0, answer];
        let options = AbfOptions { progress: Some(count), user: (&raw mut user).cast(), ..options() };
        let ended = flatten_of(&positions, &indices, &options).map(|result| result.view().termination);
        (user[0], ended)
    };
    let (events, ended) = run(ABF_CONTINUE);
    assert!(events > 3 && ended.is_ok());
    let (_, ended) = run(ABF_STOP);
    assert_eq!(ended.expect("the best so far"), crate::view::AbfTermination::Cancelled);
    let (aborted_after, ended) = run(ABF_ABORT);
    assert!(aborted_after < events);
    assert_eq!(ended.unwrap_err().0, AbfStatus::Cancelled);
}

#[test]
fn memory_is_predicted_as_the_library_does() {
    // SAFETY: names end with a zero.
    unsafe {
        let expected = abf::predict_memory(&"barrier".parse().expect("a solver"), 1000, 600);
        assert_eq!(abf_predict_memory(c"barrier".as_ptr(), 1000, 600), expected);
        assert!(abf_predict_memory(ptr::null(), 1000, 600) < expected);
        assert_eq!(abf_predict_memory(c"abc".as_ptr(), 1000, 600), 0);
    }
    assert!(said().contains("there is no solver 'abc'"), "{}", said());
}

#[test]
fn a_panic_is_a_status_and_a_sentence() {
    assert_eq!(guarded(|| panic!("seven of {}", 9)), AbfStatus::Internal);
    assert_eq!(said(), "seven of 9");
}

#[test]
fn versions_and_statuses_have_names() {
    assert_eq!(abf_version(), 100);
    // SAFETY: they end with a zero.
    let name = |status| unsafe { CStr::from_ptr(abf_status_name(status)) };
    assert_eq!((name(0), name(18), name(19), name(-1)), (c"ok", c"internal", c"unknown", c"unknown"));
}
