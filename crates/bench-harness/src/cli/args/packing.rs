//! The options of packing: those of flattening and those of `pack`.

use super::method::{MOST_THREADS, one_of};
use crate::record::misread::Misread;
use abf::{AtlasPages, Effort};
use abf_mesh::io::MeshFormat;
use clap::value_parser;
use std::path::PathBuf;
use std::str::FromStr;

/// The heading of the options of charts.
pub(super) const CHARTS: &str = "Charts: for meshes that are no disks, or when one of these is given";

/// How charts are laid out. What was not given is `None`.
#[derive(Debug, Default, clap::Args)]
pub(crate) struct PackingArgs {
    /// Which charts share a unit square [default: one]
    #[arg(long, value_name = "PAGES", value_parser = one_of::<AtlasPages, _>(AtlasPages::ALL.map(AtlasPages::name)), help_heading = CHARTS)]
    pub(crate) atlas: Option<AtlasPages>,
    /// Texels along the sides of a square page of the atlas, for the margin [default: 1024]
    #[arg(long, value_name = "N", help_heading = CHARTS)]
    pub(crate) resolution: Option<u32>,
    /// Texels of a page along x and y, where it is no square: 2048x1024, say
    #[arg(long, hide_short_help = true, value_name = "WxH", conflicts_with = "resolution", help_heading = CHARTS)]
    pub(crate) page: Option<PageSize>,
    /// Texels between charts; auto is what the mip levels need [default: 2]
    #[arg(long, value_name = "N|auto", help_heading = CHARTS)]
    pub(crate) margin: Option<Margin>,
    /// Keep charts apart in mip levels up to K: 2 · 2^K texels
    #[arg(long, hide_short_help = true, value_name = "K", help_heading = CHARTS)]
    pub(crate) mip_levels: Option<u32>,
    /// How hard to try to fill the atlas: milliseconds, about a second, or several [default: good]
    #[arg(long, hide_short_help = true, value_name = "EFFORT", value_parser = one_of::<Effort, _>(Effort::ALL.map(Effort::name)), help_heading = CHARTS)]
    pub(crate) pack: Option<Effort>,
    /// How many pages the charts may take that share pages [default: 1]
    #[arg(long, hide_short_help = true, value_name = "N", help_heading = CHARTS)]
    pub(crate) max_pages: Option<usize>,
    /// Texels per unit of the mesh, on as many pages as that takes [default: as many as fit]
    #[arg(long, hide_short_help = true, value_name = "T", help_heading = CHARTS)]
    pub(crate) texels_per_unit: Option<f64>,
}

impl PackingArgs {
    /// Whether any was given.
    pub(super) fn is_given(&self) -> bool {
        self.first_given().is_some()
    }

    /// The first option that was given.
    pub(crate) fn first_given(&self) -> Option<&'static str> {
        let Self { atlas, resolution, page, margin, mip_levels, pack, max_pages, texels_per_unit } = self;
        let given = [
            ("--atlas", atlas.is_some()),
            ("--resolution", resolution.is_some()),
            ("--page", page.is_some()),
            ("--margin", margin.is_some()),
            ("--mip-levels", mip_levels.is_some()),
            ("--pack", pack.is_some()),
            ("--max-pages", max_pages.is_some()),
            ("--texels-per-unit", texels_per_unit.is_some()),
        ];
        given.into_iter().find(|(_, is_given)| *is_given).map(|(option, _)| option)
    }
}

/// How far charts are apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Margin {
    /// As far as the mip levels need.
    Auto,
    /// So many texels.
    Texels(u32),
}

impl FromStr for Margin {
    type Err = Misread;

    fn from_str(s: &str) -> Result<Self, Misread> {
        match s {
            "auto" => Ok(Self::Auto),
            _ => s.parse().map(Self::Texels).map_err(|_| Misread::new("a number of texels or auto", s)),
        }
    }
}

/// The sides of a page in texels, as `2048x1024`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PageSize(pub(crate) [u32; 2]);

impl FromStr for PageSize {
    type Err = Misread;

    fn from_str(s: &str) -> Result<Self, Misread> {
        let wrong = || Misread::new("WIDTHxHEIGHT in texels, as 2048x1024", s);
        let (width, height) = s.split_once(['x', '×']).ok_or_else(wrong)?;
        let side = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
        Ok(Self([side(width)?, side(height)?]))
    }
}

/// The heading of the options of islands.
const ISLANDS: &str = "Islands";

/// An option of charts in the words of `pack`.
fn of_islands(arg: clap::Arg) -> clap::Arg {
    let arg = if arg.get_help_heading() == Some(CHARTS) { arg.help_heading(ISLANDS) } else { arg };
    match arg.get_id().as_str() {
        "atlas" => arg.help("Which islands share a unit square [default: one]"),
        "margin" => arg.help("Texels between islands; auto is what the mip levels need [default: 2]"),
        "mip_levels" => arg.help("Keep islands apart in mip levels up to K: 2 · 2^K texels"),
        "max_pages" => arg.help("How many pages the islands may take that share pages [default: 1]"),
        "texels_per_unit" => {
            arg.help("Texels per unit of the UVs as they are, on as many pages as that takes [default: as many as fit]")
        }
        _ => arg,
    }
}

/// The arguments of `pack`.
#[derive(Debug, clap::Args)]
#[command(mut_args = of_islands)]
pub(crate) struct PackArgs {
    #[arg(value_name = "MESH", help = format!("A file with UVs: {}", MeshFormat::list(MeshFormat::has_uvs, " or ")))]
    pub(crate) mesh: PathBuf,
    /// Lay islands of one shape upon each other, turned but not mirrored
    #[arg(long, help_heading = ISLANDS)]
    pub(crate) stack: bool,
    /// Pack the UVs of set N of a glTF, and write them there [default: the set that this program wrote last, else 0]
    #[arg(long, value_name = "N", help_heading = ISLANDS)]
    pub(crate) uv_set: Option<u32>,
    /// How islands are laid out.
    #[command(flatten)]
    pub(crate) packing: PackingArgs,
    #[arg(short, long, value_name = "FILE", help_heading = "Outputs", help = super::output_help())]
    pub(crate) output: Option<PathBuf>,
    /// Write from which vertex of a glTF input every vertex of the output is, as JSON
    #[arg(long, value_name = "FILE", help_heading = "Outputs")]
    pub(crate) remap: Option<PathBuf>,
    /// Write the results as JSON; with - to stdout, and the table goes to stderr
    #[arg(long, value_name = "FILE|-", help_heading = "Outputs")]
    pub(crate) json: Option<PathBuf>,
    /// How many threads to use; the results are the same for any number [default: one per core]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..=MOST_THREADS))]
    pub(crate) threads: Option<u16>,
}
