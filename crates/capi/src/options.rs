//! Settings as a C struct, and what they mean.

use crate::event::AbfProgress;
use crate::status::{AbfStatus, Failure};
use abf::{
    ArrayUnwrapper, Atlas, Boundary, BoundaryAngle, InnerTolerance, Parting, Passes, Pin, PinWeight, Pins, Relax,
    SeamRule, SolverSettings,
};
use std::ffi::{c_char, c_void};
use std::mem::offset_of;
use std::str::FromStr;
use std::time::Duration;

/// What `margin` is for charts that may touch.
pub const ABF_NO_MARGIN: u32 = u32::MAX;

/// Settings. Fill it with zeros, set `size`, then what differs: 0 and null mean the default. Names are those of the
/// program's options.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AbfOptions {
    /// `sizeof(AbfOptions)`. Later versions append fields, and take what was compiled with less of them.
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
    /// What becomes of faces without area: "carry", "refuse".
    pub zero_area: *const c_char,
    /// `abf_flatten`: what the boundary is to be: "free", "convex", "below-2pi[=EPS]", "rectangle[=v0,v1,v2,v3]", "circle".
    pub boundary: *const c_char,
    /// `abf_flatten`: or the angles of these vertices of the boundary, `boundary_count` of them; null: none.
    pub boundary_vertices: *const u32,
    /// As many angles, rad.
    pub boundary_angles: *const f64,
    /// How many there are.
    pub boundary_count: usize,
    /// "linabf": no angle moves in a pass by more than this part of its way to 0 or π; 0: no bound.
    pub error_bound: f64,
    /// "auto", "barrier", "descent": the last weight of the barrier, in units of energy per corner; 0: 0.001.
    pub barrier_floor: f64,
    /// Rings whose angle deficit is above this start from their target angles, rad; 0: 1; infinite: none does.
    pub ring_switch: f64,
    /// Angles start from at least this and at most π less this, rad; 0: 0.001.
    pub angle_bound: f64,
    /// "uzawa", "minres": inner iterations go to this relative residual; 0: it follows the constraint residual.
    pub inner_tolerance: f64,
    /// "uzawa", "minres": inner iterations in an outer one, at most; 0: 20000.
    pub max_inner_iterations: u32,
    /// "auto", "linabf": passes to make; 0: until the constraints are met.
    pub passes: u32,
    /// Solvers with a fixed target: the wheel condition, "product" or "log".
    pub wheel: *const c_char,
    /// Those: second derivatives, "exact" or "gauss-newton".
    pub hessian: *const c_char,
    /// Those: "merit" shortens steps until a merit function falls, "full" does not.
    pub line_search: *const c_char,
    /// "uzawa", "minres": which unknowns are eliminated first, "none" or "triangles".
    pub reduction: *const c_char,
    /// "uzawa", "minres": "none", "jacobi", "block".
    pub preconditioner: *const c_char,
    /// `abf_unwrap`: part the largest chart where that lets charts cover more, until they cover this part of the pages; 0: no.
    pub coverage: f64,
    /// `abf_unwrap`: by which part of their length seams may grow for that; 0: 0.25.
    pub seam_budget: f64,
    /// `abf_unwrap`: charts that come nearer to themselves than the margin: "count" leaves them, "keep" parts them there.
    pub inner_margin: *const c_char,
    /// `abf_unwrap`: seams grow until they are so long at most, as a multiple of the diagonal of their component; 0: no limit.
    pub max_seam: f64,
    /// `abf_unwrap`: which charts share a page: "one", "per-component", "per-material".
    pub atlas: *const c_char,
    /// `abf_unwrap`: sets the margin to what mip levels up to this one need, 2 · 2^level texels; 0: `margin` counts.
    pub mip_levels: u32,
    /// 0. It keeps the next field where it is.
    pub reserved2: u32,
    /// `abf_unwrap`: whether a map that lies over itself is `certified`: "refuse", "allow".
    pub overlap: *const c_char,
    /// `abf_unwrap`: where charts end: "auto": where the map stretches; "keep": at `seam_vertices`, at the seams of `uv` and where
    /// `materials` change, and what they leave is cut only as far as is needed. Null: "keep" where `seam_vertices` are given,
    /// or pages are per material; else "auto".
    pub seams: *const c_char,
    /// `abf_unwrap`: edges that are seams, each by its two vertices; null: none.
    pub seam_vertices: *const u32,
    /// How many edges.
    pub seam_count: usize,
    /// `abf_unwrap`: UVs that the mesh has, two numbers each; null: none.
    pub uv: *const f32,
    /// How many: as many as there are vertices, unless there are `uv_indices`.
    pub uv_count: usize,
    /// `abf_unwrap`: for every index of the mesh that of its UV; null: that of its vertex.
    pub uv_indices: *const u32,
    /// `abf_unwrap`: a number for every triangle; null: none.
    pub materials: *const u32,
    /// `abf_unwrap`: a number for every triangle; vertices in one place are joined within one object only; null: one object.
    pub objects: *const u32,
    /// `abf_unwrap`: a number for every triangle; no seam runs between two of one polygon; null: no polygons.
    pub polygons: *const u32,
    /// Relax the map, or each chart, until an energy is least: "abf" (angles), "isometric" (lengths), "usable" (angles, and areas
    /// within bounds), or the weight of areas beside angles as a number; "usable" is 0.01. Null: no; `abf_relax`: "isometric".
    pub energy: *const c_char,
    /// `abf_flatten`, `abf_relax`: bring these vertices to given places, `pin_count` of them; null: none. One or two are met by
    /// moving, turning and scaling the map, more by moving the others with `energy`, or "isometric".
    pub pin_vertices: *const u32,
    /// As many places, u and v.
    pub pin_uvs: *const f64,
    /// As many weights: a place with a weight above 0 need not be met; 0: it must. Null: all must.
    pub pin_weights: *const f64,
    /// How many there are.
    pub pin_count: usize,
    /// What becomes of a map that lies over itself: "off" leaves it, "split" parts it along the overlap, "deform" makes it anew
    /// without overlaps, which takes many times as long. `abf_unwrap` parts charts in any case.
    pub injective: *const c_char,
    /// With "deform", how far parts of the boundary stay from each other, in units of the mesh.
    pub boundary_gap: f64,
}

impl AbfOptions {
    /// The sizes of the struct in all versions of the header. What is appended begins where the one before ended.
    pub(crate) const SIZES: [usize; 2] = [offset_of!(Self, zero_area), size_of::<Self>()];
}

/// The fields of [`AbfOptions`] that are names, as text.
macro_rules! names {
    ($($field:ident),+ $(,)?) => {
        /// Names in [`AbfOptions`], as text.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub(crate) struct Names {
            $(pub(crate) $field: Option<String>,)+
        }

        impl Names {
            /// Reads all of them with `text`, which gives none for null.
            pub(crate) fn read(options: &AbfOptions, text: impl Fn(*const c_char) -> Option<String>) -> Self {
                Self { $($field: text(options.$field),)+ }
            }
        }
    };
}

names! {
    solver, layout, weld, holes, double_sided, pack, zero_area, boundary, wheel, hessian, line_search, reduction,
    preconditioner, inner_margin, atlas, overlap, seams, energy, injective,
}

/// What a call is told.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settings {
    /// Its [`Pipeline`](abf::Pipeline) is that of `abf_flatten`, too.
    pub(crate) unwrapper: ArrayUnwrapper,
    /// 0: the pool that all calls share.
    pub(crate) threads: usize,
    /// Whether a map that lies over itself may be certified.
    pub(crate) may_overlap: bool,
}

impl Settings {
    /// Reads settings; fields that are 0 stay at their defaults.
    pub(crate) fn read(options: &AbfOptions, names: &Names) -> Result<Self, Failure> {
        let mut unwrapper = ArrayUnwrapper::new();
        flattening(&mut unwrapper, options, names)?;
        charts(&mut unwrapper, options, names)?;
        atlas(&mut unwrapper.atlas, options, names)?;
        unwrapper.parting = parting(unwrapper.unwrap.max_stretch, options, names)?;
        let may_overlap = is("overlap", names.overlap.as_deref(), "allow", "refuse")?;
        Ok(Self { unwrapper, threads: options.threads as usize, may_overlap })
    }

    /// The angles of vertices of the boundary.
    pub(crate) fn ask_of_boundary(&mut self, vertices: &[u32], angles: &[f64]) -> Result<(), Failure> {
        let boundary = &mut self.unwrapper.unwrap.pipeline.boundary;
        if vertices.is_empty() {
            return Ok(());
        }
        if !boundary.is_free() {
            let text = "boundary and boundary_vertices are both given: leave one out";
            return Err(Failure::new(AbfStatus::Setting, text));
        }
        let angle = |(&vertex, &angle): (&u32, &f64)| BoundaryAngle { vertex, angle, line: None };
        *boundary = Boundary::Angles(vertices.iter().zip(angles).map(angle).collect());
        Ok(())
    }
}

impl Settings {
    /// Vertices in given places, with their weights or without any.
    pub(crate) fn pin(&mut self, vertices: &[u32], places: &[[f64; 2]], weights: Option<&[f64]>) {
        let weight = |at: usize| match weights.map_or(0.0, |weights| weights[at]) {
            0.0 => PinWeight::Hard,
            weight => PinWeight::Soft(weight),
        };
        let pin = |(at, (&vertex, &uv)): (usize, (&u32, &[f64; 2]))| Pin { vertex, uv, weight: weight(at) };
        let pins: Vec<Pin> = vertices.iter().zip(places).enumerate().map(pin).collect();
        self.unwrapper.unwrap.pipeline.pins = (!pins.is_empty()).then_some(Pins { pins });
    }
}

fn flattening(unwrapper: &mut ArrayUnwrapper, options: &AbfOptions, names: &Names) -> Result<(), Failure> {
    let pipeline = &mut unwrapper.unwrap.pipeline;
    named(&mut pipeline.solver, names.solver.as_deref())?;
    solver_settings(options, names)?.give(&mut pipeline.solver).map_err(|error| Failure::setting(&error))?;
    named(&mut pipeline.layout.kind, names.layout.as_deref())?;
    named(&mut pipeline.zero_area, names.zero_area.as_deref())?;
    named(&mut pipeline.boundary, names.boundary.as_deref())?;
    differing(&mut pipeline.initial_guess.angle_bound, options.angle_bound);
    if options.ring_switch == f64::INFINITY {
        pipeline.initial_guess.ring_switch = None;
    } else if options.ring_switch != 0.0 {
        pipeline.initial_guess.ring_switch = Some(options.ring_switch);
    }
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
    named(&mut pipeline.injective, names.injective.as_deref())?;
    pipeline.boundary_gap = options.boundary_gap;
    pipeline.relax = parsed(names.energy.as_deref())?.map(|energy| Relax { energy, ..Relax::default() });
    Ok(())
}

fn solver_settings(options: &AbfOptions, names: &Names) -> Result<SolverSettings, Failure> {
    let given = |number: f64| (number != 0.0).then_some(number);
    let passes = |count: u32| count.to_string().parse::<Passes>().map_err(|error| Failure::setting(&error));
    Ok(SolverSettings {
        passes: Some(options.passes).filter(|&count| count != 0).map(passes).transpose()?,
        error_bound: given(options.error_bound),
        barrier_floor: given(options.barrier_floor),
        wheel: parsed(names.wheel.as_deref())?,
        hessian: parsed(names.hessian.as_deref())?,
        line_search: parsed(names.line_search.as_deref())?,
        reduction: parsed(names.reduction.as_deref())?,
        preconditioner: parsed(names.preconditioner.as_deref())?,
        max_inner_iterations: Some(options.max_inner_iterations as usize).filter(|&count| count != 0),
        inner_tolerance: given(options.inner_tolerance).map(InnerTolerance::Fixed),
    })
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
    if options.max_seam != 0.0 {
        unwrap.max_seam = Some(options.max_seam);
    }
    // Pages per material make sense only where charts end at their borders.
    let keeps = !options.seam_vertices.is_null() || names.atlas.as_deref() == Some("per-material");
    unwrap.seams = parsed(names.seams.as_deref())?.unwrap_or(if keeps { SeamRule::Keep } else { SeamRule::Auto });
    unwrap.strict = options.strict != 0;
    unwrap.cut_disks = options.keep_disks == 0;
    Ok(())
}

fn atlas(atlas: &mut Atlas, options: &AbfOptions, names: &Names) -> Result<(), Failure> {
    named(&mut atlas.pages, names.atlas.as_deref())?;
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
    if options.mip_levels != 0 {
        if options.margin != 0 {
            let text = format!("mip_levels sets the margin: leave margin 0, got {}", options.margin);
            return Err(Failure::new(AbfStatus::Setting, text));
        }
        atlas.margin = Atlas::margin_for_mip_levels(options.mip_levels);
    }
    if options.max_pages != 0 {
        atlas.max_pages = options.max_pages as usize;
    }
    if options.texels_per_unit != 0.0 {
        atlas.texels_per_unit = Some(options.texels_per_unit);
    }
    Ok(())
}

fn parting(max_stretch: f64, options: &AbfOptions, names: &Names) -> Result<Option<Parting>, Failure> {
    let plain = Parting::default();
    let coverage = Some(options.coverage).filter(|&coverage| coverage != 0.0);
    if coverage.is_none() && options.seam_budget != 0.0 {
        let text = format!("seam_budget is what coverage may cost: set coverage, too, got {}", options.seam_budget);
        return Err(Failure::new(AbfStatus::Setting, text));
    }
    let keeps_inner_margin = is("inner_margin", names.inner_margin.as_deref(), "keep", "count")?;
    let mut parting = Parting { coverage, keeps_inner_margin, max_stretch, ..plain };
    differing(&mut parting.seam_budget, options.seam_budget);
    let parting = (coverage.is_some() || keeps_inner_margin).then_some(parting);
    parting.map(|parting| parting.check().map(|()| parting)).transpose().map_err(|error| Failure::setting(&error))
}

/// Whether a name is this one, and not the `other` one, which is the default.
fn is(field: &str, name: Option<&str>, this: &str, other: &str) -> Result<bool, Failure> {
    match name {
        Some(name) if name == this => Ok(true),
        None => Ok(false),
        Some(name) if name == other => Ok(false),
        Some(name) => {
            Err(Failure::new(AbfStatus::Setting, format!("{field} must be '{this}' or '{other}', got '{name}'")))
        }
    }
}

fn differing(setting: &mut f64, given: f64) {
    // NaN differs, too, and is refused by the check.
    if given != 0.0 {
        *setting = given;
    }
}

fn parsed<T: FromStr<Err: std::error::Error>>(name: Option<&str>) -> Result<Option<T>, Failure> {
    name.map(|name| name.parse().map_err(|error: T::Err| Failure::setting(&error))).transpose()
}

fn named<T: FromStr<Err: std::error::Error>>(setting: &mut T, name: Option<&str>) -> Result<(), Failure> {
    if let Some(given) = parsed(name)? {
        *setting = given;
    }
    Ok(())
}
