//! What pages are like, and how hard to try.

use crate::PackError;
use abf_control::{SettingError, UnknownName};

/// How pieces are packed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct PackSettings {
    /// Texels of a page along x and y.
    pub page: [u32; 2],
    /// Texels that stay free between two pieces, and between a piece and the border.
    pub margin: f64,
    /// By how many texels a point may move afterwards: when it is stored as a number of fewer digits, say. The margin
    /// holds for the points as moved.
    pub rounding: f64,
    /// How many pages a group of pieces may have.
    pub pages: usize,
    /// The scale. Without it the largest that is found.
    pub texels_per_unit: Option<f64>,
    /// How hard to try.
    pub effort: Effort,
}

impl Default for PackSettings {
    fn default() -> Self {
        Self { page: [1024; 2], margin: 2.0, rounding: 0.0, pages: 1, texels_per_unit: None, effort: Effort::default() }
    }
}

/// How hard to try. More effort never covers less than boxes do.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    strum::Display,
    strum::EnumString,
    strum::IntoStaticStr,
    strum::VariantNames,
)]
#[strum(serialize_all = "kebab-case", parse_err_ty = UnknownName, parse_err_fn = unknown)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Effort {
    /// Milliseconds: a coarse grid, a few angles, and the fewer layouts the more pieces there are.
    Fast,
    /// About a second: fifteen ways to choose the next place, sixteen angles.
    #[default]
    Good,
    /// Several seconds: after that a grid twice as fine and 64 angles.
    Best,
}

impl Effort {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::Fast, Self::Good, Self::Best];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<Effort>("packing effort", given)
}

impl PackSettings {
    /// The most texels along a side of a page.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// A page may be this many times as long as it is wide.
    const MAX_ASPECT: u32 = 64;

    /// Checks every setting.
    ///
    /// # Errors
    /// [`PackError::Setting`] and [`PackError::PageTooSmall`].
    pub fn check(&self) -> Result<(), PackError> {
        let wrong = |name, allowed, value: f64| Err(SettingError::new(name, allowed, value).into());
        let [width, height] = self.page;
        for side in self.page {
            if !(1..=Self::MAX_SIDE).contains(&side) {
                return wrong("page side", "in 1..=65536 texels", f64::from(side));
            }
        }
        if width.max(height) > Self::MAX_ASPECT * width.min(height) {
            return wrong("page aspect", "at most 64", f64::from(width.max(height)) / f64::from(width.min(height)));
        }
        for (name, length) in [("margin", self.margin), ("rounding", self.rounding)] {
            if !(length >= 0.0 && length.is_finite()) {
                return wrong(name, "a number of texels from 0 on", length);
            }
        }
        if self.pages == 0 {
            return wrong("pages", "1 or more", 0.0);
        }
        if let Some(scale) = self.texels_per_unit
            && !(scale > 0.0 && scale.is_finite())
        {
            return wrong("texels per unit", "positive", scale);
        }
        if self.inner().iter().any(|side| *side <= 0.0) {
            return Err(PackError::PageTooSmall { width, height, margin: self.margin });
        }
        Ok(())
    }

    /// The margin with what rounding, here and afterwards, may take of it.
    pub(crate) fn kept_margin(&self) -> f64 {
        /// Of the longer side of a page: far more than the arithmetic of the packer loses.
        const HAIR: f64 = 1e-10;
        self.margin + 2.0 * self.rounding + HAIR * f64::from(self.page[0].max(self.page[1]))
    }

    /// Width and height inside the margins along the border.
    pub(crate) fn inner(&self) -> [f64; 2] {
        self.page.map(|side| f64::from(side) - 2.0 * self.kept_margin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_smaller_than_its_margins_is_refused_by_name() {
        let error = PackSettings { page: [64, 3], margin: 2.0, ..PackSettings::default() }.check().unwrap_err();
        assert_eq!(error, PackError::PageTooSmall { width: 64, height: 3, margin: 2.0 });
        assert!(error.to_string().ends_with("take a larger page or a smaller margin"), "{error}");
    }

    #[test]
    fn settings_outside_their_range_are_named() {
        let good = PackSettings::default();
        for (settings, name) in [
            (PackSettings { margin: f64::NAN, ..good }, "margin"),
            (PackSettings { rounding: -1.0, ..good }, "rounding"),
            (PackSettings { pages: 0, ..good }, "pages"),
            (PackSettings { texels_per_unit: Some(0.0), ..good }, "texels per unit"),
            (PackSettings { page: [0, 5], ..good }, "page side"),
            (PackSettings { page: [65, 1], margin: 0.0, ..good }, "page aspect"),
        ] {
            let error = settings.check().unwrap_err();
            assert!(error.to_string().starts_with(name), "{error}");
        }
    }

    #[test]
    fn every_effort_reads_back_from_its_name() {
        Effort::ALL.into_iter().for_each(|effort| assert_eq!(effort.name().parse(), Ok(effort)));
        assert!("slow".parse::<Effort>().unwrap_err().to_string().contains("fast, good, best"));
    }
}
