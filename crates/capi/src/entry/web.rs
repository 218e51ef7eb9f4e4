//! What the loader in `web/package` needs beyond the C interface.

use super::{AbfEvent, keep};
use crate::event::AbfProgress;
use crate::options::AbfOptions;
use crate::status::AbfStatus;
use crate::view::{AbfView, text};
use std::alloc::{Layout, alloc, dealloc};
use std::ffi::{CString, c_char, c_void};
use std::mem::offset_of;
use std::sync::OnceLock;
use std::time::Duration;
use std::{panic, ptr};

#[link(wasm_import_module = "abf")]
unsafe extern "C" {
    /// Milliseconds since some moment.
    fn clock() -> f64;
    /// What JavaScript says to an event.
    fn progress(user: *mut c_void, event: *const AbfEvent) -> i32;
}

/// More than any field needs.
const ALIGNMENT: usize = 16;

/// To be called once before anything else.
#[unsafe(no_mangle)]
pub extern "C" fn abf_web_start() {
    // SAFETY: the loader provides it.
    abf::control::set_clock(|| Duration::try_from_secs_f64(unsafe { clock() } / 1000.0).unwrap_or_default());
    // A panic ends in a trap: its sentence is kept for who catches that.
    panic::set_hook(Box::new(|info| keep(&info.to_string())));
}

/// Memory for arguments; null where there is none.
#[unsafe(no_mangle)]
pub extern "C" fn abf_web_alloc(bytes: usize) -> *mut u8 {
    match Layout::from_size_align(bytes.max(1), ALIGNMENT) {
        // SAFETY: it has a size.
        Ok(layout) => unsafe { alloc(layout) },
        Err(_) => ptr::null_mut(),
    }
}

/// Gives memory back: what `abf_web_alloc` gave for as many bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn abf_web_free(pointer: *mut u8, bytes: usize) {
    if let (false, Ok(layout)) = (pointer.is_null(), Layout::from_size_align(bytes.max(1), ALIGNMENT)) {
        // SAFETY: it was allocated like this.
        unsafe { dealloc(pointer, layout) };
    }
}

/// The callback that asks JavaScript.
#[unsafe(no_mangle)]
pub extern "C" fn abf_web_progress() -> AbfProgress {
    unsafe extern "C" fn ask(user: *mut c_void, event: *const AbfEvent) -> i32 {
        // SAFETY: the loader provides it.
        unsafe { progress(user, event) }
    }
    Some(ask)
}

/// Where the fields of the structs are, and the names of the statuses, as JSON: of every struct its size, and of every field its
/// place and its type.
#[unsafe(no_mangle)]
pub extern "C" fn abf_web_layout() -> *const c_char {
    static LAYOUT: OnceLock<CString> = OnceLock::new();
    LAYOUT.get_or_init(layout).as_ptr()
}

/// `"name":{"size":…,"fields":{"field":[place,"type"],…}}` of a struct.
macro_rules! described {
    ($type:ident { $($field:ident: $kind:literal),+ $(,)? }) => {{
        let fields = [$(format!("\"{}\":[{},\"{}\"]", stringify!($field), offset_of!($type, $field), $kind)),+];
        format!("\"{}\":{{\"size\":{},\"fields\":{{{}}}}}", stringify!($type), size_of::<$type>(), fields.join(","))
    }};
}

fn layout() -> CString {
    let structs = [
        described!(AbfOptions {
            size: "u32",
            solver: "text",
            layout: "text",
            tolerance: "f64",
            step_tolerance: "f64",
            time_limit: "f64",
            max_memory: "u64",
            max_iterations: "u32",
            normalize: "u32",
            strict: "u32",
            keep_disks: "u32",
            margin: "u32",
            width: "u32",
            height: "u32",
            max_pages: "u32",
            max_stretch: "f64",
            crease_angle: "f64",
            max_chart_length: "f64",
            texels_per_unit: "f64",
            weld: "text",
            holes: "text",
            double_sided: "text",
            pack: "text",
            progress: "u32",
            user: "u32",
            zero_area: "text",
            boundary: "text",
            boundary_vertices: "u32",
            boundary_angles: "u32",
            boundary_count: "u32",
            error_bound: "f64",
            barrier_floor: "f64",
            ring_switch: "f64",
            angle_bound: "f64",
            inner_tolerance: "f64",
            max_inner_iterations: "u32",
            passes: "u32",
            wheel: "text",
            hessian: "text",
            line_search: "text",
            reduction: "text",
            preconditioner: "text",
            coverage: "f64",
            seam_budget: "f64",
            inner_margin: "text",
            max_seam: "f64",
            atlas: "text",
            mip_levels: "u32",
            overlap: "text",
            seams: "text",
            seam_vertices: "u32",
            seam_count: "u32",
            uv: "u32",
            uv_count: "u32",
            uv_indices: "u32",
            materials: "u32",
            objects: "u32",
            polygons: "u32",
            energy: "text",
            pin_vertices: "u32",
            pin_uvs: "u32",
            pin_weights: "u32",
            pin_count: "u32",
            injective: "text",
            boundary_gap: "f64",
        }),
        described!(AbfView {
            size: "u32",
            vertex_count: "u32",
            uv64: "u32",
            uv32: "u32",
            remap: "u32",
            triangle_count: "u32",
            indices: "u32",
            triangle_charts: "u32",
            chart_count: "u32",
            chart_pages: "u32",
            page_count: "u32",
            width: "u32",
            height: "u32",
            texels_per_unit: "f64",
            coverage: "f64",
            certified: "bool",
            valid: "bool",
            injective: "bool",
            termination: "u32",
            flips: "u32",
            collapsed: "u32",
            wound: "u32",
            overlaps: "u32",
            unfinished: "u32",
            angle_error: "f64",
            stretch_l2: "f64",
            stretch_linf: "f64",
            qc_mean: "f64",
            qc_max: "f64",
            area_l2: "f64",
            surface_area: "f64",
            uv_area: "f64",
            solver: "text",
            repairs: "text",
            parted_for_coverage: "u32",
            parted_for_margin: "u32",
            relax_steps: "u32",
            energy_before: "f64",
            energy_after: "f64",
            pin_count: "u32",
            pin_distances: "u32",
            pins_missed: "u32",
        }),
        described!(AbfEvent {
            kind: "u32",
            stage: "u32",
            solver: "text",
            iteration: "u32",
            inner: "u32",
            residual: "f64",
            component: "u32",
            components: "u32",
            faces: "u32",
            faces_done: "u32",
            round: "u32",
        }),
    ];
    let names = AbfStatus::ALL.map(|status| format!("\"{}\"", status.name().to_string_lossy()));
    text(&format!("{{{},\"statuses\":[{}]}}", structs.join(","), names.join(",")))
}
