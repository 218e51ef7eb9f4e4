//! Why pieces cannot be packed.

use abf_control::SettingError;

/// Why pieces cannot be packed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PackError {
    /// A setting outside its range.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The margins along the border leave nothing of the page.
    #[error(
        "a page of {width} × {height} texels has no room inside a margin of {margin}: take a larger page or a smaller margin"
    )]
    PageTooSmall {
        /// Texels along x.
        width: u32,
        /// Texels along y.
        height: u32,
        /// The margin asked for.
        margin: f64,
    },
    /// A coordinate that is NaN or infinite.
    #[error("piece {piece} has a coordinate that is not finite")]
    NotFinite {
        /// The first such piece.
        piece: usize,
    },
    /// A piece without a single point.
    #[error("piece {piece} has no points")]
    NoPoints {
        /// The first such piece.
        piece: usize,
    },
    /// At the scale that was given a piece is larger than the page.
    #[error(
        "piece {piece} does not fit into {width} × {height} texels at {texels_per_unit} texels per unit, \
         only at {largest} or less: take fewer texels per unit or a larger page"
    )]
    PieceTooLarge {
        /// The first such piece.
        piece: usize,
        /// Texels along x.
        width: u32,
        /// Texels along y.
        height: u32,
        /// The scale that was given.
        texels_per_unit: f64,
        /// The largest scale at which this piece fits.
        largest: f64,
    },
    /// At the scale that was given the pieces need more pages.
    #[error(
        "{pieces} pieces do not fit onto {pages} pages at {texels_per_unit} texels per unit: \
         allow more pages, take fewer texels per unit or larger pages"
    )]
    TooManyPages {
        /// How many pieces of the group that does not fit.
        pieces: usize,
        /// How many pages it may have.
        pages: usize,
        /// The scale that was given.
        texels_per_unit: f64,
    },
    /// The margins alone leave no room, however small the pieces are.
    #[error(
        "{pieces} pieces with {margin} texels between them do not fit onto {pages} pages of {width} × {height} texels: \
         allow more pages, take a smaller margin or larger pages"
    )]
    TooManyPieces {
        /// How many pieces of the fullest group.
        pieces: usize,
        /// How many pages it may have.
        pages: usize,
        /// The margin asked for.
        margin: f64,
        /// Texels along x.
        width: u32,
        /// Texels along y.
        height: u32,
    },
}
