//! What was meant by packing: the options, checked.

use super::args::{Margin, PackingArgs, PageSize};
use super::usage::usage;
use abf::{Atlas, Effort};
use clap::error::ErrorKind;

/// Checks that a page has sides.
///
/// # Errors
/// A usage error.
pub(crate) fn check_page(PageSize([width, height]): PageSize) -> Result<(), clap::Error> {
    if [width, height].iter().all(|side| (1..=Atlas::MAX_SIDE).contains(side)) {
        return Ok(());
    }
    let message = format!("the sides of --page must be in 1..={}, got {width}x{height}", Atlas::MAX_SIDE);
    Err(usage(ErrorKind::ValueValidation, message))
}

/// How charts are laid out.
///
/// # Errors
/// A usage error that names the option and its range.
pub(crate) fn atlas_of(args: &PackingArgs) -> Result<Atlas, clap::Error> {
    let atlas = Atlas::default();
    let wrong = |message: String| Err(usage(ErrorKind::ValueValidation, message));
    let page = match (args.page, args.resolution) {
        (Some(PageSize(page)), _) => page,
        (None, Some(side)) => [side; 2],
        (None, None) => atlas.page,
    };
    let [width, height] = page;
    let given = if args.page.is_some() { format!("--page {width}x{height}") } else { format!("--resolution {width}") };
    match args.page {
        Some(page) => check_page(page)?,
        None if !(1..=Atlas::MAX_SIDE).contains(&width) => {
            return wrong(format!("--resolution must be in 1..={}, got {width}", Atlas::MAX_SIDE));
        }
        None => {}
    }
    let shorter = width.min(height);
    let margin = match (args.margin, args.mip_levels) {
        (Some(Margin::Texels(margin)), None) => margin,
        (Some(Margin::Texels(margin)), Some(levels)) => {
            let message = format!("--mip-levels {levels} sets the margin: leave out --margin {margin}, or it");
            return Err(usage(ErrorKind::ArgumentConflict, message));
        }
        (_, Some(levels)) => Atlas::margin_for_mip_levels(levels),
        (Some(Margin::Auto), None) => Atlas::margin_for_mip_levels(0),
        (None, None) => atlas.margin.min(shorter / 4),
    };
    if margin > shorter / 4 {
        let side = if args.page.is_some() { "the shorter side of " } else { "" };
        return wrong(match args.mip_levels {
            None => format!("--margin must be at most a quarter of {side}{given}, got {margin}"),
            Some(levels) => format!(
                "--mip-levels {levels} needs a margin of {margin} texels, and at most a quarter of {side}{given} is \
                 possible: take fewer levels or a larger page"
            ),
        });
    }
    if args.max_pages == Some(0) {
        return wrong("--max-pages must be at least 1, got 0".to_owned());
    }
    if let Some(texels) = args.texels_per_unit.filter(|t| !(*t > 0.0 && t.is_finite())) {
        return wrong(format!("--texels-per-unit must be positive, got {texels}"));
    }
    Ok(Atlas {
        pages: args.atlas.unwrap_or(atlas.pages),
        page,
        margin,
        // A user of the program waits once for an atlas that is used often.
        effort: args.pack.unwrap_or(Effort::Good),
        max_pages: args.max_pages.unwrap_or(atlas.max_pages),
        texels_per_unit: args.texels_per_unit,
    })
}
