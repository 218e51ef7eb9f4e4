//! Why there is no atlas.

use abf_control::SettingError;
use abf_metrics::MetricsError;
use abf_pack::PackError;

/// Why charts cannot be packed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AtlasError {
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Pages per material without materials.
    #[error("pages per material need a material for each of the {faces} faces, and there are {given}")]
    Labels {
        /// How many faces there are.
        faces: usize,
        /// How many labels were given.
        given: usize,
    },
    /// Even at one texel each the charts do not fit.
    #[error("{charts} charts with {margin} texels between them do not fit into {} × {} texels", page[0], page[1])]
    TooManyCharts {
        /// How many on the fullest page.
        charts: usize,
        /// The margin asked for.
        margin: u32,
        /// The page asked for.
        page: [u32; 2],
    },
    /// Charts that do not fit at the scale that was given, and settings of the packer.
    #[error(transparent)]
    Pack(PackError),
    /// The packed UVs cannot be judged.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
}
