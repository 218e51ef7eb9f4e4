//! The options of real units.

use super::method::one_of;
use abf::Orient;
use clap::ValueEnum;

const SHEET: &str = "Real units: charts side by side at scale 1";

/// How charts lie on a sheet. What was not given is `None`.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct SheetArgs {
    /// What UVs are in: real puts charts side by side in units of the mesh, and turns a disk into its tightest box
    /// [default: a disk in units of the mesh as it comes out, charts in the unit square]
    #[arg(long, value_name = "UNITS", help_heading = SHEET)]
    pub(crate) units: Option<Units>,
    /// Whether charts on a sheet are turned into their tightest boxes, or keep their angle [default: tight]
    #[arg(long, hide_short_help = true, value_name = "tight|keep", value_parser = one_of::<Orient, _>(Orient::ALL.map(Orient::name)), help_heading = SHEET)]
    pub(crate) orient: Option<Orient>,
    /// What stays free between charts on a sheet, in units of the mesh [default: a fiftieth of the longest chart]
    #[arg(long, hide_short_help = true, value_name = "D", help_heading = SHEET)]
    pub(crate) gap: Option<f64>,
    /// Draw folds: edges where the surface turns by at least A degrees, mountains and valleys in layers of their own
    /// [default: none; without A: 10]
    #[arg(long, hide_short_help = true, value_name = "A", num_args = 0..=1, require_equals = true, default_missing_value = "10", help_heading = SHEET)]
    pub(crate) folds: Option<f64>,
    /// What one unit of the mesh is, for --svg and --dxf [default: mm, and m for a glTF]
    #[arg(long, value_name = "UNIT", help_heading = SHEET)]
    pub(crate) unit: Option<ModelUnit>,
}

/// What UVs are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Units {
    /// Units of the mesh
    Real,
}

/// What one unit of the mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ModelUnit {
    /// A millimetre
    Mm,
    /// A centimetre
    Cm,
    /// A metre
    M,
    /// An inch
    In,
}

impl ModelUnit {
    /// Its length in millimetres.
    pub(crate) const fn millimetres(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
            Self::In => 25.4,
        }
    }
}
