//! What was meant by charts: the options, checked.

use super::args::{ChartArgs, InnerMargin, SeamsFrom};
use super::packing::atlas_of;
use super::targets::{check_extension, is_gltf};
use super::usage::usage;
use abf::{Atlas, AtlasPages, Parting, SeamRule, Unwrap};
use clap::error::ErrorKind;
use std::path::{Path, PathBuf};

/// How meshes become charts, and charts an atlas.
#[derive(Clone, Debug)]
pub(crate) struct Charting {
    pub(crate) unwrap: Unwrap,
    pub(crate) atlas: Atlas,
    /// Why charts are parted for it, if they may be.
    pub(crate) parting: Option<Parting>,
    pub(crate) seams: SeamsFrom,
    /// Whether disks are made charts, too.
    pub(crate) is_asked: bool,
    /// Whether there are no charts at all.
    pub(crate) disks_only: bool,
    /// Where the seams go.
    pub(crate) seam_lines: Option<PathBuf>,
    /// Where the remap of vertices goes.
    pub(crate) remap: Option<PathBuf>,
    /// Whether texture coordinates may be replaced.
    pub(crate) overwrite: bool,
    /// Whether an atlas with overlaps is as asked.
    pub(crate) may_overlap: bool,
    /// Whether the output is a glTF, which stores 32 bits.
    pub(crate) to_gltf: bool,
}

impl Charting {
    /// Checks the options.
    ///
    /// # Errors
    /// A usage error that names the option and its range.
    pub(crate) fn new(args: ChartArgs, inputs: &[PathBuf], output: Option<&Path>) -> Result<Self, clap::Error> {
        let is_asked = args.is_asked();
        let unwrap = Unwrap::default();
        let wrong = |message: String| Err(usage(ErrorKind::ValueValidation, message));
        let to_gltf = output.is_some_and(is_gltf);
        if args.disks_only && to_gltf {
            let message = "a glTF takes an atlas: leave out --disks-only, or write an obj or ply";
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
        for (option, is_given) in [("--remap", args.remap.is_some()), ("--overwrite", args.overwrite)] {
            if is_given && !(to_gltf && inputs.iter().any(|input| is_gltf(input))) {
                let message =
                    format!("{option} concerns a glTF that is read and written as one: name it, and -o FILE.glb");
                return Err(usage(ErrorKind::ArgumentConflict, message));
            }
        }
        if args.disks_only && is_asked {
            let message = "--disks-only makes no charts: leave out the options of charts, or it";
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
        if let Some(stretch) = args.max_stretch.filter(|s| !(*s >= 1.0)) {
            return wrong(format!("--max-stretch must be at least 1, got {stretch}"));
        }
        if let Some(angle) = args.crease_angle.filter(|a| !(0.0..=180.0).contains(a)) {
            return wrong(format!("--crease-angle must be in 0..=180 degrees, got {angle}"));
        }
        if let Some(length) = args.max_chart_length.filter(|l| !(*l >= 1.0)) {
            return wrong(format!("--max-chart-length must be at least 1, got {length}"));
        }
        if let Some(length) = args.max_seam.filter(|l| !(*l >= 0.0)) {
            return wrong(format!("--max-seam must be at least 0, got {length}"));
        }
        let packing = atlas_of(&args.packing)?;
        if let Some(coverage) = args.coverage.filter(|c| !(*c > 0.0 && *c <= 1.0)) {
            return wrong(format!("--coverage must be in (0, 1], got {coverage}"));
        }
        if let Some(budget) = args.seam_budget.filter(|b| !(*b >= 0.0 && b.is_finite())) {
            return wrong(format!("--seam-budget must be at least 0, got {budget}"));
        }
        let seam_budget = args.seam_budget.unwrap_or(Parting::default().seam_budget);
        let keeps_inner_margin = args.inner_margin == Some(InnerMargin::Keep);
        let max_stretch = args.max_stretch.unwrap_or(unwrap.max_stretch);
        let parting = Parting { coverage: args.coverage, seam_budget, keeps_inner_margin, max_stretch };
        let parting = (args.coverage.is_some() || keeps_inner_margin).then_some(parting);
        for (option, path, extension) in [("--seam-lines", &args.seam_lines, "obj"), ("--remap", &args.remap, "json")] {
            if let Some(path) = path {
                check_extension(option, path, &[extension])?;
            }
        }
        // Pages per material make sense only where charts end at their borders.
        let by_material = args.packing.atlas == Some(AtlasPages::PerMaterial);
        let seams = args.seams.unwrap_or(if by_material { SeamsFrom::File } else { SeamsFrom::Auto });
        let rule = if seams == SeamsFrom::Auto { SeamRule::Auto } else { SeamRule::Keep };
        Ok(Self {
            unwrap: Unwrap {
                seams: rule,
                holes: args.holes.unwrap_or(unwrap.holes),
                max_stretch: args.max_stretch.unwrap_or(unwrap.max_stretch),
                max_seam: args.max_seam,
                crease_angle: args.crease_angle.map_or(unwrap.crease_angle, f64::to_radians),
                max_chart_length: args.max_chart_length.map_or(unwrap.max_chart_length, |l| l.is_finite().then_some(l)),
                cut_disks: args.cut_disks,
                weld: args.weld.unwrap_or(unwrap.weld),
                double_sided: args.double_sided.unwrap_or(unwrap.double_sided),
                strict: args.strict,
                ..unwrap
            },
            atlas: packing,
            parting,
            seams,
            is_asked,
            disks_only: args.disks_only,
            seam_lines: args.seam_lines,
            remap: args.remap,
            overwrite: args.overwrite,
            may_overlap: args.overlap == Some(true),
            to_gltf,
        })
    }

    /// How to make charts, if any are to be made.
    pub(crate) fn if_allowed(&self) -> Option<&Self> {
        (!self.disks_only).then_some(self)
    }

    /// Whether this mesh is made charts even if it is a disk: textures want UVs in the unit square.
    pub(crate) fn is_for(&self, is_gltf: bool) -> bool {
        self.is_asked || self.to_gltf || is_gltf
    }
}
