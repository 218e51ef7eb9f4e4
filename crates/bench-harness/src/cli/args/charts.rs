//! The options of seams, holes and the atlas.

use super::method::one_of;
use super::packing::{CHARTS, PackingArgs};
use abf::{DoubleSided, HoleRule, UnknownName, Weld};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// How meshes become charts, and charts an atlas. What was not given is `None`.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct ChartArgs {
    /// Where seams come from: found where the map stretches; those of the UVs the file has; or those and the borders of its
    /// groups and materials; what these leave is cut only as far as makes disks [default: auto; file with --atlas per-material]
    #[arg(long, value_name = "auto|keep|file", value_parser = one_of::<SeamsFrom, _>(SeamsFrom::ALL.map(SeamsFrom::name)), help_heading = CHARTS)]
    pub(crate) seams: Option<SeamsFrom>,
    /// What becomes of holes: closed while the angles are solved for, joined by seams, or left to least squares; auto leaves
    /// them where that comes out well, else cuts, else closes them [default: auto]
    #[arg(long, hide_short_help = true, value_name = "RULE", value_parser = one_of::<HoleRule, _>(["auto", "fill", "fill-fan", "fill-ears", "cut", "free"]), help_heading = CHARTS)]
    pub(crate) holes: Option<HoleRule>,
    /// Seams grow until the L² stretch is at most S [default: 1.15]
    #[arg(long, value_name = "S", help_heading = CHARTS)]
    pub(crate) max_stretch: Option<f64>,
    /// Or until they are L times as long as the diagonal of the component [default: no limit]
    #[arg(long, hide_short_help = true, value_name = "L", help_heading = CHARTS)]
    pub(crate) max_seam: Option<f64>,
    /// Edges that turn by no more than A degrees are smooth: flat and developable parts stay whole across them
    /// [default: 30]
    #[arg(long, hide_short_help = true, value_name = "A", help_heading = CHARTS)]
    pub(crate) crease_angle: Option<f64>,
    /// Part charts that are longer than L page widths, where charts together cover half of a page; inf for no limit
    /// [default: 4]
    #[arg(long, hide_short_help = true, value_name = "L", help_heading = CHARTS)]
    pub(crate) max_chart_length: Option<f64>,
    /// Cut a file that is one disk, too, where its stretch is above --max-stretch; in an atlas every disk is
    #[arg(long, hide_short_help = true, help_heading = CHARTS)]
    pub(crate) cut_disks: bool,
    /// Which vertices in one place are joined where that makes boundary edges meet: those within rounding, but none in a
    /// file that is one disk; none; or those at most DISTANCE apart [default: auto]
    #[arg(long, hide_short_help = true, value_name = "auto|off|DISTANCE", allow_negative_numbers = true, help_heading = CHARTS)]
    pub(crate) weld: Option<Weld>,
    /// What becomes of faces with the same three vertices, as the sides of a leaf: each has texels of its own, or all share
    /// those of the first [default: own]
    #[arg(long, hide_short_help = true, value_name = "own|shared", value_parser = one_of::<DoubleSided, _>(DoubleSided::ALL.map(DoubleSided::name)), help_heading = CHARTS)]
    pub(crate) double_sided: Option<DoubleSided>,
    /// Whether an atlas with charts over each other or over themselves is as asked (exit code 0) [default: refuse]
    #[arg(long, hide_short_help = true, value_name = "refuse|allow", value_parser = PossibleValuesParser::new(["refuse", "allow"]).map(|rule| rule == "allow"), help_heading = CHARTS)]
    pub(crate) overlap: Option<bool>,
    /// Refuse meshes that need repair, and faces without area
    #[arg(long, hide_short_help = true, help_heading = CHARTS)]
    pub(crate) strict: bool,
    /// Refuse meshes that are no disks, instead of making charts of them
    #[arg(long, hide_short_help = true, help_heading = CHARTS)]
    pub(crate) disks_only: bool,
    /// How they are laid out.
    #[command(flatten)]
    pub(crate) packing: PackingArgs,
    /// Part the largest chart along edges where that lets charts cover more, until they cover C of the atlas
    #[arg(long, hide_short_help = true, value_name = "C", help_heading = CHARTS)]
    pub(crate) coverage: Option<f64>,
    /// By which part seams may grow for --coverage [default: 0.25]
    #[arg(long, hide_short_help = true, value_name = "B", requires = "coverage", help_heading = CHARTS)]
    pub(crate) seam_budget: Option<f64>,
    /// What becomes of charts that come nearer to themselves than the margin: they are counted, or parted there
    /// [default: count]
    #[arg(long, hide_short_help = true, value_name = "count|keep", help_heading = CHARTS)]
    pub(crate) inner_margin: Option<InnerMargin>,
    /// Write the seams as lines: obj
    #[arg(long, hide_short_help = true, value_name = "FILE", help_heading = CHARTS)]
    pub(crate) seam_lines: Option<PathBuf>,
    /// Write from which vertex of a glTF input every vertex of the output is, as JSON
    #[arg(long, hide_short_help = true, value_name = "FILE", help_heading = CHARTS)]
    pub(crate) remap: Option<PathBuf>,
    /// Replace the texture coordinates that a glTF has, instead of adding a set
    #[arg(long, hide_short_help = true, help_heading = CHARTS)]
    pub(crate) overwrite: bool,
}

impl ChartArgs {
    /// The first option beside those of packing that was given and concerns pages.
    pub(crate) fn first_of_pages(&self) -> Option<&'static str> {
        let given = [
            ("--max-chart-length", self.max_chart_length.is_some()),
            ("--coverage", self.coverage.is_some()),
            ("--inner-margin", self.inner_margin.is_some()),
        ];
        given.into_iter().find(|(_, is_given)| *is_given).map(|(option, _)| option)
    }

    /// Whether charts are asked for, whatever the mesh is.
    pub(crate) fn is_asked(&self) -> bool {
        let Self { seams, holes, max_stretch, max_seam, cut_disks, weld, strict, crease_angle, .. } = self;
        seams.is_some()
            || holes.is_some()
            || max_stretch.is_some()
            || max_seam.is_some()
            || crease_angle.is_some()
            || *cut_disks
            || weld.is_some()
            || *strict
            || self.double_sided.is_some()
            || self.overlap.is_some()
            || self.max_chart_length.is_some()
            || self.packing.is_given()
            || self.coverage.is_some()
            || self.inner_margin.is_some()
            || self.seam_lines.is_some()
            || self.remap.is_some()
    }
}

/// What becomes of charts that come nearer to themselves than the margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InnerMargin {
    /// They are counted
    Count,
    /// They are parted there
    Keep,
}

/// Where seams come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum SeamsFrom {
    /// The shape and the stretch.
    #[default]
    Auto,
    /// The UVs of the file.
    Keep,
    /// The UVs, groups and materials of the file.
    File,
}

impl SeamsFrom {
    const ALL: [Self; 3] = [Self::Auto, Self::Keep, Self::File];
    const NAMES: [&'static str; 3] = [Self::Auto.name(), Self::Keep.name(), Self::File.name()];

    const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Keep => "keep",
            Self::File => "file",
        }
    }
}

impl fmt::Display for SeamsFrom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for SeamsFrom {
    type Err = UnknownName;

    fn from_str(s: &str) -> Result<Self, UnknownName> {
        Self::ALL
            .into_iter()
            .find(|from| from.name() == s)
            .ok_or_else(|| UnknownName::new("source of seams", s, &Self::NAMES))
    }
}
