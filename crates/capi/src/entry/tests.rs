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
        unsafe { read_options(&options) }.map(|(settings, _)| settings.unwrapper).expect("settings")
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
