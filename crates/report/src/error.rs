//! Why there is no picture.

use abf_control::Cancelled;
use abf_metrics::MetricsError;

/// Why a picture could not be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// A mesh and a map of which there is no picture: no faces or no area, a map of another mesh,
    /// coordinates that are not finite.
    #[error(transparent)]
    Input(#[from] MetricsError),
    /// Charts of another mesh.
    #[error("there are charts for {given} faces, and the mesh has {faces}")]
    Charts {
        /// For how many faces.
        given: usize,
        /// How many there are.
        faces: usize,
    },
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A canvas without room for two panels.
    #[error("a canvas of {width} × {height} pixels is too small: each side must have at least {min}")]
    CanvasTooSmall {
        /// Its width, pixels.
        width: u32,
        /// Its height, pixels.
        height: u32,
        /// The shortest side allowed.
        min: u32,
    },
    /// A canvas that would not fit in memory.
    #[error(
        "a canvas of {width} × {height} pixels with {supersampling} × {supersampling} samples in each is too large: at most {max} samples"
    )]
    CanvasTooLarge {
        /// Its width, pixels.
        width: u32,
        /// Its height, pixels.
        height: u32,
        /// Samples along each side of a pixel.
        supersampling: u32,
        /// The most samples allowed.
        max: u64,
    },
    /// A setting of the style outside its range.
    #[error("{setting} must be in {min}..={max}, got {value}")]
    OutOfRange {
        /// The field of the style.
        setting: &'static str,
        /// Its value.
        value: u32,
        /// The least value allowed.
        min: u32,
        /// The largest value allowed.
        max: u32,
    },
    /// A line width outside its range.
    #[error("line_width must be in 0..={max} pixels, got {pixels}")]
    LineWidth {
        /// The width asked for, pixels.
        pixels: f64,
        /// The largest width allowed, pixels.
        max: u32,
    },
    /// A length of an SVG layout outside its range.
    #[error("{setting} must be {allowed} and at most {max:e} mm, got {value}")]
    Length {
        /// The field of the style, or what follows from it.
        setting: &'static str,
        /// What it must be besides.
        allowed: &'static str,
        /// Its value.
        value: f64,
        /// The largest value allowed, millimetres.
        max: f64,
    },
    /// A view direction that is zero, not finite, or parallel to its up vector.
    #[error(
        "the view direction {towards_viewer:?} with up vector {up:?} spans no plane: both must be finite, not zero and not parallel"
    )]
    BadView {
        /// The direction asked for.
        towards_viewer: [f64; 3],
        /// The up vector asked for.
        up: [f64; 3],
    },
    /// The PNG encoder gave up.
    #[error("the picture could not be written as PNG: {reason}")]
    Encoding {
        /// What the encoder said.
        reason: String,
    },
}
