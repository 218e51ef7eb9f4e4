//! Settings as a C struct, and what they mean.

use crate::event::AbfProgress;
use crate::status::{AbfStatus, Failure};
use abf::ArrayUnwrapper;
use std::ffi::{c_char, c_void};
use std::str::FromStr;
use std::time::Duration;

/// What `margin` is for charts that may touch.
pub const ABF_NO_MARGIN: u32 = u32::MAX;

/// Settings. Fill it with zeros, set `size`, then what differs: 0 and null mean the default. Names are those of the
/// program's options.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AbfOptions {
    /// `sizeof(AbfOptions)`. Later versions append fields.
    pub size: usize,
    /// "auto", "linabf", "abf", "abf++", "abf-newton", "abf-fixed-target", "uzawa", "minres", "barrier", "descent",
    /// "habf++", "hlinabf", "lscm".
    pub solver: *const c_char,
    /// "auto", "least-squares", "least-squares-weighted", "tree", "poisson".
    pub layout: *const c_char,
    /// Converged means a constraint residual of at most this, rad; 0: 1e-8.
    pub tolerance: f64,
    /// And a last step of at most this, rad, where an energy is minimised; 0: 1e-7.
    pub step_tolerance: f64,
    /// Seconds; 0: no limit. When the time is up, the result is the best so far.
    pub time_limit: f64,
    /// Bytes; 0: no limit. A mesh for which more is predicted is refused; `abf_unwrap` asks for every flattening.
    /// In a browser 0 stands for what is left of 4 GB.
    pub max_memory: u64,
    /// Outer iterations or passes; 0: 50.
    pub max_iterations: u32,
    /// Threads of a pool for this call alone; 0: one pool for all calls, with a thread per processor.
    pub threads: u32,
    /// `abf_flatten`: 1 scales into the unit square; 0 keeps the area of the surface.
    pub normalize: i32,
    /// `abf_unwrap`: 1 refuses a mesh that needs repair.
    pub strict: i32,
    /// `abf_unwrap`: 1 leaves a mesh whole that is one disk; 0 cuts it, too, where it misses the stretch.
    pub keep_disks: i32,
    /// `abf_unwrap`: texels between charts; 0: 2; `ABF_NO_MARGIN`: none.
    pub margin: u32,
    /// `abf_unwrap`: texels along x; 0: 1024.
    pub width: u32,
    /// `abf_unwrap`: texels along y; 0: as many as along x.
    pub height: u32,
    /// `abf_unwrap`: pages that charts may take; 0: 1.
    pub max_pages: u32,
    /// 0. It keeps the next field where it is.
    pub reserved: u32,
    /// `abf_unwrap`: seams grow until the L² stretch of every chart is at most this; 0: 1.15.
    pub max_stretch: f64,
    /// `abf_unwrap`: edges that turn by at most this are smooth, rad; 0: π/6.
    pub crease_angle: f64,
    /// `abf_unwrap`: longer charts are parted, in widths of a page; 0: 4; infinite: none.
    pub max_chart_length: f64,
    /// `abf_unwrap`: texels per unit of the mesh; 0: as many as fit.
    pub texels_per_unit: f64,
    /// `abf_unwrap`: which vertices are joined: "auto", "off", or a distance.
    pub weld: *const c_char,
    /// `abf_unwrap`: what becomes of holes: "auto", "fill", "fill-fan", "fill-ears", "cut", "free".
    pub holes: *const c_char,
    /// `abf_unwrap`: room for faces with the same vertices: "own", "shared".
    pub double_sided: *const c_char,
    /// `abf_unwrap`: how hard the packer tries: "fast", "good", "best".
    pub pack: *const c_char,
    /// Told what happens; may be null.
    pub progress: AbfProgress,
    /// Handed to it.
    pub user: *mut c_void,
}

/// Names in [`AbfOptions`], as text.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Names {
    pub(crate) solver: Option<String>,
    pub(crate) layout: Option<String>,
    pub(crate) weld: Option<String>,
    pub(crate) holes: Option<String>,
    pub(crate) double_sided: Option<String>,
    pub(crate) pack: Option<String>,
}

/// What a call is told.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settings {
    /// Its [`Pipeline`](abf::Pipeline) is that of `abf_flatten`, too.
    pub(crate) unwrapper: ArrayUnwrapper,
    /// 0: the pool that all calls share.
    pub(crate) threads: usize,
}

impl Settings {
    /// Reads settings; fields that are 0 stay at their defaults.
    pub(crate) fn read(options: &AbfOptions, names: &Names) -> Result<Self, Failure> {
        let mut unwrapper = ArrayUnwrapper::new();
        flattening(&mut unwrapper, options, names)?;
        charts(&mut unwrapper, options, names)?;
        atlas(&mut unwrapper, options, names)?;
        unwrapper.unwrap.check().map_err(|error| Failure::setting(&error))?;
        Ok(Self { unwrapper, threads: options.threads as usize })
    }
}

fn flattening(unwrapper: &mut ArrayUnwrapper, options: &AbfOptions, names: &Names) -> Result<(), Failure> {
    let pipeline = &mut unwrapper.unwrap.pipeline;
    named(&mut pipeline.solver, names.solver.as_deref())?;
    named(&mut pipeline.layout.kind, names.layout.as_deref())?;
    differing(&mut pipeline.stop.tolerance, options.tolerance);
    differing(&mut pipeline.stop.step_tolerance, options.step_tolerance);
    if options.time_limit != 0.0 {
        let text = || format!("time_limit must be a number of seconds above 0, got {}", options.time_limit);
        let limit = Duration::try_from_secs_f64(options.time_limit);
        pipeline.stop.time_limit = Some(limit.map_err(|_| Failure::new(AbfStatus::Setting, text()))?);
    }
    if options.max_iterations != 0 {
        pipeline.stop.max_iterations = options.max_iterations as usize;
    }
    pipeline.max_memory = Some(options.max_memory).filter(|&bytes| bytes != 0);
    pipeline.normalize = options.normalize != 0;
    Ok(())
}

fn charts(unwrapper: &mut ArrayUnwrapper, options: &AbfOptions, names: &Names) -> Result<(), Failure> {
    let unwrap = &mut unwrapper.unwrap;
    named(&mut unwrap.weld, names.weld.as_deref())?;
    named(&mut unwrap.holes, names.holes.as_deref())?;
    named(&mut unwrap.double_sided, names.double_sided.as_deref())?;
    differing(&mut unwrap.max_stretch, options.max_stretch);
    differing(&mut unwrap.crease_angle, options.crease_angle);
    if options.max_chart_length == f64::INFINITY {
        unwrap.max_chart_length = None;
    } else if options.max_chart_length != 0.0 {
        unwrap.max_chart_length = Some(options.max_chart_length);
    }
    unwrap.strict = options.strict != 0;
    unwrap.cut_disks = options.keep_disks == 0;
    Ok(())
}

fn atlas(unwrapper: &mut ArrayUnwrapper, options: &AbfOptions, names: &Names) -> Result<(), Failure> {
    let atlas = &mut unwrapper.atlas;
    named(&mut atlas.effort, names.pack.as_deref())?;
    if options.width != 0 {
        atlas.page = [options.width; 2];
    }
    if options.height != 0 {
        atlas.page[1] = options.height;
    }
    match options.margin {
        0 => {}
        ABF_NO_MARGIN => atlas.margin = 0,
        texels => atlas.margin = texels,
    }
    if options.max_pages != 0 {
        atlas.max_pages = options.max_pages as usize;
    }
    if options.texels_per_unit != 0.0 {
        atlas.texels_per_unit = Some(options.texels_per_unit);
    }
    Ok(())
}

fn differing(setting: &mut f64, given: f64) {
    // NaN differs, too, and is refused by the check.
    if given != 0.0 {
        *setting = given;
    }
}

fn named<T: FromStr<Err: std::error::Error>>(setting: &mut T, name: Option<&str>) -> Result<(), Failure> {
    if let Some(name) = name {
        *setting = name.parse().map_err(|error: T::Err| Failure::setting(&error))?;
    }
    Ok(())
}
