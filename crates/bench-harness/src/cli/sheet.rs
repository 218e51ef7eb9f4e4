//! What was meant by real units: the options, checked.

use super::args::{ChartArgs, ModelUnit, SheetArgs};
use super::usage::usage;
use abf::{Orient, Pattern};
use clap::error::ErrorKind;

/// How charts lie on a sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    /// Where they lie.
    pub(crate) pattern: Pattern,
    /// Whether the UVs are those of the sheet.
    pub(crate) is_for_uvs: bool,
    /// Whether the sheet is drawn.
    pub(crate) is_drawn: bool,
    /// The least angle of a fold that is drawn, rad.
    pub(crate) folds: Option<f64>,
    /// What one unit of the mesh is, if that was said.
    unit: Option<ModelUnit>,
}

impl Sheet {
    /// Checks the options; `None` if no sheet is asked for.
    ///
    /// # Errors
    /// A usage error: options that do not go together, a gap that is no length.
    pub(crate) fn new(
        args: &SheetArgs,
        charts: &ChartArgs,
        normalize: bool,
        is_drawn: bool,
    ) -> Result<Option<Self>, clap::Error> {
        let conflict = |message: String| Err(usage(ErrorKind::ArgumentConflict, message));
        let is_for_uvs = args.units.is_some();
        if args.unit.is_some() && !is_drawn {
            return conflict(
                "--unit says how large a drawing is: add --svg FILE or --dxf FILE, or leave it out".to_owned(),
            );
        }
        if args.folds.is_some() && !is_drawn {
            return conflict("--folds concerns a drawing: add --svg FILE or --dxf FILE, or leave it out".to_owned());
        }
        if !is_for_uvs && !is_drawn {
            for (option, is_given) in [("--orient", args.orient.is_some()), ("--gap", args.gap.is_some())] {
                if is_given {
                    return conflict(format!("{option} concerns a sheet: add --units real, --svg FILE or --dxf FILE"));
                }
            }
            return Ok(None);
        }
        if is_for_uvs && normalize {
            return conflict("--units real and --normalize are two scales: leave out one of them".to_owned());
        }
        let of_pages = charts.packing.first_given().or_else(|| charts.first_of_pages());
        if let Some(option) = of_pages.filter(|_| is_for_uvs) {
            return conflict(format!("{option} concerns the unit square: leave it out, or --units real"));
        }
        if let Some(gap) = args.gap.filter(|gap| !(*gap >= 0.0 && gap.is_finite())) {
            return Err(usage(ErrorKind::ValueValidation, format!("--gap must be a length of at least 0, got {gap}")));
        }
        if let Some(angle) = args.folds.filter(|a| !(0.0..=180.0).contains(a)) {
            let message = format!("--folds must be in 0..=180 degrees, got {angle}");
            return Err(usage(ErrorKind::ValueValidation, message));
        }
        let pattern = Pattern { orient: args.orient.unwrap_or(Orient::Tight), gap: args.gap };
        Ok(Some(Self { pattern, is_for_uvs, is_drawn, folds: args.folds.map(f64::to_radians), unit: args.unit }))
    }

    /// What one unit of the mesh is, in millimetres.
    pub(crate) fn mm_per_unit(&self, is_gltf: bool) -> f64 {
        let known = if is_gltf { ModelUnit::M } else { ModelUnit::Mm };
        self.unit.unwrap_or(known).millimetres()
    }
}
