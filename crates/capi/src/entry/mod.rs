//! What other languages call: pointers are checked here, and nowhere else.
#![allow(unsafe_code, reason = "pointers of a caller")]
#![allow(
    clippy::missing_safety_doc,
    reason = "the comments are those of the header, which says what callers must keep"
)]

#[cfg(target_arch = "wasm32")]
pub mod web;

use crate::event::{ABF_CONTINUE, AbfEvent};
use crate::known::Known;
use crate::options::{AbfOptions, Names, Settings};
use crate::run;
use crate::status::{AbfStatus, Failure};
use crate::view::{AbfResult, AbfView, text};
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::{ptr, slice};

thread_local!(static LAST: RefCell<CString> = RefCell::default());

/// Flattens a disk: one UV per vertex.
///
/// `positions` has three numbers per vertex, `indices` three vertices per triangle. `options` may be null. `*result` is a result
/// to be freed by `abf_result_free`, or null where the status is not `ABF_STATUS_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_flatten(
    positions: *const f64,
    vertex_count: usize,
    indices: *const u32,
    index_count: usize,
    options: *const AbfOptions,
    result: *mut *mut AbfResult,
) -> AbfStatus {
    // SAFETY: the caller's arrays are as long as said, and `result` may be written to.
    unsafe {
        give(result, || {
            let Call { mut settings, mut host, options } = read_options(options)?;
            let (positions, indices) = mesh((positions, vertex_count, size_of::<[f64; 3]>()), (indices, index_count))?;
            let count = options.boundary_count;
            check_count(count, size_of::<f64>(), "boundary_count")?;
            let vertices = array(options.boundary_vertices, count, "boundary_vertices")?;
            let angles = array(options.boundary_angles, vertices.len(), "boundary_angles")?;
            settings.ask_of_boundary(vertices, angles)?;
            pin(&mut settings, &options)?;
            run::flatten(positions.as_chunks().0, indices, &settings, &mut |event| host.tell(event))
        })
    }
}

/// Unwraps any mesh into an atlas: it is repaired, cut, flattened and packed. Vertices are split where seams run.
///
/// `positions` has three numbers per vertex; `stride` is the distance from a vertex to the next in bytes, a multiple of 4; 0: 12.
/// `indices` has three vertices per triangle. `options` may be null. `*result` is a result to be freed by `abf_result_free`, or
/// null where the status is not `ABF_STATUS_OK`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_unwrap(
    positions: *const f32,
    vertex_count: usize,
    stride: usize,
    indices: *const u32,
    index_count: usize,
    options: *const AbfOptions,
    result: *mut *mut AbfResult,
) -> AbfStatus {
    // SAFETY: the caller's arrays are as long as said, and `result` may be written to.
    unsafe {
        give(result, || {
            let Call { mut settings, mut host, options } = read_options(options)?;
            pin(&mut settings, &options)?;
            let stride = if stride == 0 { size_of::<[f32; 3]>() } else { stride };
            if stride < size_of::<[f32; 3]>() || !stride.is_multiple_of(size_of::<f32>()) {
                let text = format!("stride must be a multiple of 4 and at least 12 bytes, got {stride}");
                return Err(Failure::new(AbfStatus::Stride, text));
            }
            let (numbers, indices) = mesh((positions, vertex_count, stride), (indices, index_count))?;
            let vertices = numbers.chunks(stride / size_of::<f32>());
            let positions: Vec<[f32; 3]> = vertices.map(|v| [v[0], v[1], v[2]]).collect();
            let known = known(&options, index_count)?;
            run::unwrap(&positions, indices, &known, &settings, &mut |event| host.tell(event))
        })
    }
}

/// Relaxes a map that anybody made until an energy is least, each chart by itself, through valid maps only.
///
/// `positions` and `indices` are those of `abf_flatten`. `uv` has two numbers per vertex, and `uv_count` is `vertex_count`; or it
/// has `uv_count` UVs, and `uv_indices` for every index that of its UV. Of the options `energy`, pins, `time_limit`, `max_memory`,
/// `normalize`, `zero_area`, `threads` and `progress` count. A chart that is not valid starts from Tutte's embedding, if it is a
/// disk; else it stays. One that cannot be relaxed, as it is no manifold for example, stays, too, and counts as unfinished. The area
/// of the whole map stays, and every chart keeps its centre: charts may come to lie over each other.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_relax(
    positions: *const f64,
    vertex_count: usize,
    indices: *const u32,
    index_count: usize,
    uv: *const f64,
    uv_count: usize,
    uv_indices: *const u32,
    options: *const AbfOptions,
    result: *mut *mut AbfResult,
) -> AbfStatus {
    // SAFETY: the caller's arrays are as long as said, and `result` may be written to.
    unsafe {
        give(result, || {
            let Call { mut settings, mut host, options } = read_options(options)?;
            pin(&mut settings, &options)?;
            let (positions, indices) = mesh((positions, vertex_count, size_of::<[f64; 3]>()), (indices, index_count))?;
            check_count(uv_count, size_of::<[f64; 2]>(), "uv_count")?;
            let uv = array(uv, 2 * uv_count, "uv")?.as_chunks().0;
            let given = run::GivenMap { uv, corners: array_if(uv_indices, index_count, "uv_indices")? };
            run::relax(positions.as_chunks().0, indices, given, &settings, &mut |event| host.tell(event))
        })
    }
}

/// Shows what a result holds. `view->size` must be `sizeof(AbfView)`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_result_view(result: *const AbfResult, view: *mut AbfView) -> AbfStatus {
    guarded(|| {
        check_pointer(result, "result")?;
        check_pointer(view, "view")?;
        // SAFETY: both are what the caller says. Of the view only the size is read: the rest may be uninitialised. No more is
        // written than the caller has.
        unsafe {
            let size = ptr::addr_of!((*view).size).read();
            check_size(size, AbfView::SIZES, "AbfView")?;
            let shown = AbfView { size, ..(*result).view() };
            ptr::copy_nonoverlapping((&raw const shown).cast::<u8>(), view.cast::<u8>(), size);
        }
        Ok(())
    })
}

/// Frees a result. Null is fine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_result_free(result: *mut AbfResult) {
    if !result.is_null() {
        // SAFETY: it came out of a box here, and the caller frees it once.
        let result = unsafe { Box::from_raw(result) };
        // Nothing in it can panic; if it does, the caller is not unwound.
        let _ = catch_unwind(AssertUnwindSafe(|| drop(result)));
    }
}

/// Why the last call that failed on this thread did so. Valid until the next call on this thread.
#[unsafe(no_mangle)]
pub extern "C" fn abf_last_error() -> *const c_char {
    LAST.try_with(|last| last.try_borrow().map_or(ptr::null(), |text| text.as_ptr())).unwrap_or(c"".as_ptr())
}

/// The name of a status, such as "not-a-disk". Of a number that is no status: "unknown".
#[unsafe(no_mangle)]
pub extern "C" fn abf_status_name(status: i32) -> *const c_char {
    let known = usize::try_from(status).ok().and_then(|code| AbfStatus::ALL.get(code));
    known.map_or(c"unknown", |status| status.name()).as_ptr()
}

/// About how many bytes it takes at most to flatten a disk; what `max_memory` is compared with. Null stands for "auto".
/// 0 means that there is no such solver.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_predict_memory(solver: *const c_char, triangles: usize, vertices: usize) -> u64 {
    let mut bytes = 0;
    guarded(|| {
        // SAFETY: the caller's text ends with a zero.
        let solver = unsafe { name(solver) };
        bytes = run::predict(solver.as_deref(), triangles, vertices)?;
        Ok(())
    });
    bytes
}

/// The version of the library: 10000 major + 100 minor + patch.
#[unsafe(no_mangle)]
pub extern "C" fn abf_version() -> u32 {
    VERSION
}

const VERSION: u32 = 10_000 * number(env!("CARGO_PKG_VERSION_MAJOR"))
    + 100 * number(env!("CARGO_PKG_VERSION_MINOR"))
    + number(env!("CARGO_PKG_VERSION_PATCH"));

const fn number(digits: &str) -> u32 {
    match u32::from_str_radix(digits, 10) {
        Ok(number) => number,
        Err(_) => panic!("a version is made of numbers"),
    }
}

/// A callback with what it wants to be handed.
struct Host {
    call: Option<unsafe extern "C" fn(*mut c_void, *const AbfEvent) -> i32>,
    user: *mut c_void,
}

// SAFETY: the header says that the callback runs on another thread, one at a time.
unsafe impl Send for Host {}

impl Host {
    fn tell(&mut self, event: &AbfEvent) -> i32 {
        // SAFETY: it is what the caller says that it is.
        self.call.map_or(ABF_CONTINUE, |call| unsafe { call(self.user, event) })
    }
}

/// What a call was told.
struct Call {
    settings: Settings,
    host: Host,
    /// As the caller gave them; zero where the caller's header has less of them.
    options: AbfOptions,
}

/// Reads options; of the caller's they keep the callback and arrays, which are not looked at here.
unsafe fn read_options(options: *const AbfOptions) -> Result<Call, Failure> {
    // SAFETY: every field may be zero. If there are options, they are of the size that they say, and names end with a zero.
    // Nothing but the size is read before it is known to be right.
    unsafe {
        let mut read = MaybeUninit::<AbfOptions>::zeroed();
        if !options.is_null() {
            check_pointer(options, "options")?;
            let size = ptr::addr_of!((*options).size).read();
            check_size(size, AbfOptions::SIZES, "AbfOptions")?;
            ptr::copy_nonoverlapping(options.cast::<u8>(), read.as_mut_ptr().cast::<u8>(), size);
        }
        let options = read.assume_init();
        let names = Names::read(&options, |text| name(text));
        let host = Host { call: options.progress, user: options.user };
        Ok(Call { settings: Settings::read(&options, &names)?, host, options })
    }
}

/// The arrays of a mesh: three numbers per vertex, `stride` bytes from one to the next, and indices.
unsafe fn mesh<'a, T>(
    (positions, vertex_count, stride): (*const T, usize, usize),
    (indices, index_count): (*const u32, usize),
) -> Result<(&'a [T], &'a [u32]), Failure> {
    check_count(vertex_count, stride, "vertex_count")?;
    check_count(index_count, size_of::<u32>(), "index_count")?;
    // The last vertex need not be followed by what lies between two.
    let count = vertex_count.checked_sub(1).map_or(0, |between| between * (stride / size_of::<T>()) + 3);
    // SAFETY: they are as long as the caller says, and their sizes were checked.
    unsafe { Ok((array(positions, count, "positions")?, array(indices, index_count, "indices")?)) }
}

/// Reads the caller's pins.
unsafe fn pin(settings: &mut Settings, options: &AbfOptions) -> Result<(), Failure> {
    let count = options.pin_count;
    check_count(count, size_of::<[f64; 2]>(), "pin_count")?;
    // SAFETY: they are as long as the caller says, and their size was checked.
    unsafe {
        let vertices = array(options.pin_vertices, count, "pin_vertices")?;
        let places = array(options.pin_uvs, 2 * count, "pin_uvs")?.as_chunks().0;
        settings.pin(vertices, places, array_if(options.pin_weights, count, "pin_weights")?);
    }
    Ok(())
}

/// What the caller knows of a mesh with so many indices.
unsafe fn known<'a>(options: &AbfOptions, index_count: usize) -> Result<Known<'a>, Failure> {
    check_count(options.seam_count, size_of::<[u32; 2]>(), "seam_count")?;
    check_count(options.uv_count, size_of::<[f32; 2]>(), "uv_count")?;
    let triangles = index_count / 3;
    // SAFETY: they are as long as the caller says, and their sizes were checked.
    unsafe {
        Ok(Known {
            seams: counted(options.seam_vertices, 2 * options.seam_count, "seam_vertices")?
                .map(|all| all.as_chunks().0),
            uv: counted(options.uv, 2 * options.uv_count, "uv")?.map(|all| all.as_chunks().0),
            uv_indices: array_if(options.uv_indices, index_count, "uv_indices")?,
            materials: array_if(options.materials, triangles, "materials")?,
            objects: array_if(options.objects, triangles, "objects")?,
            polygons: array_if(options.polygons, triangles, "polygons")?,
        })
    }
}

unsafe fn name(text: *const c_char) -> Option<String> {
    // SAFETY: it ends with a zero.
    (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned())
}

/// An array with a count of its own, which need not be there where the count is 0.
unsafe fn counted<'a, T>(start: *const T, count: usize, what: &str) -> Result<Option<&'a [T]>, Failure> {
    // SAFETY: as for `array`.
    if start.is_null() && count == 0 { Ok(None) } else { unsafe { array(start, count, what) }.map(Some) }
}

/// An array that need not be there.
unsafe fn array_if<'a, T>(start: *const T, count: usize, what: &str) -> Result<Option<&'a [T]>, Failure> {
    // SAFETY: as for `array`.
    if start.is_null() { Ok(None) } else { unsafe { array(start, count, what) }.map(Some) }
}

unsafe fn array<'a, T>(start: *const T, count: usize, what: &str) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    check_pointer(start, what)?;
    // SAFETY: it is neither null nor misaligned, the caller says that so many are there, and the size was checked.
    Ok(unsafe { slice::from_raw_parts(start, count) })
}

fn check_pointer<T>(pointer: *const T, what: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(Failure::new(AbfStatus::Pointer, format!("{what} is null")));
    }
    if !pointer.is_aligned() {
        let text = format!("{what} is not aligned to {} bytes", align_of::<T>());
        return Err(Failure::new(AbfStatus::Pointer, text));
    }
    Ok(())
}

/// Whether so many elements of so many bytes can be in memory, and be counted in 32 bits.
fn check_count(count: usize, bytes: usize, what: &str) -> Result<(), Failure> {
    let fits = count.checked_mul(bytes).is_some_and(|size| isize::try_from(size).is_ok());
    if fits && u32::try_from(count).is_ok() {
        return Ok(());
    }
    Err(Failure::new(AbfStatus::TooLarge, format!("{what} is {count}: no array has so many elements of {bytes} bytes")))
}

fn check_size(given: usize, known: [usize; 2], what: &str) -> Result<(), Failure> {
    if known.contains(&given) {
        return Ok(());
    }
    let [.., known] = known;
    let text =
        format!("size is {given}, and sizeof({what}) is {known}: was it set, and is the header that of this library?");
    Err(Failure::new(AbfStatus::StructSize, text))
}

/// Hands a result over. `*result` is null where there is none.
unsafe fn give(result: *mut *mut AbfResult, work: impl FnOnce() -> Result<AbfResult, Failure>) -> AbfStatus {
    guarded(|| {
        check_pointer(result, "result")?;
        // SAFETY: the caller says that it may be written to.
        unsafe {
            *result = ptr::null_mut();
            *result = Box::into_raw(Box::new(work()?));
        }
        Ok(())
    })
}

/// Runs without unwinding, and keeps the sentence of a failure.
fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> AbfStatus {
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return AbfStatus::Ok,
        Ok(Err(failure)) => failure,
        Err(panic) => Failure::new(AbfStatus::Internal, message(&*panic)),
    };
    keep(&failure.text);
    failure.status
}

fn keep(sentence: &str) {
    // A thread that is about to end has no place for it any more.
    let _ = LAST.try_with(|last| last.try_borrow_mut().map(|mut last| *last = text(sentence)));
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|&text| text.to_owned())).unwrap_or_default()
}

#[cfg(test)]
mod tests;
