//! What can be wrong with a mesh file, and where.

use super::MeshFormat;
use std::fmt;
use std::io;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FilePlace {
    /// A line of a text file, counted from 1. A statement over several lines is at its first.
    Line(usize),
    /// A byte of a binary file, counted from 0: the first of the record.
    Byte(usize),
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// A place in a named file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The name of the file.
    pub file: String,
    /// Where in it.
    pub place: FilePlace,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.file, self.place)
    }
}

/// Why a mesh file cannot be read.
///
/// Where a fault can occur many times in one file, the location is that of the first and `count`
/// says how many there are.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {cause}")]
    Open {
        /// The file.
        file: String,
        /// What the system says.
        cause: io::Error,
    },
    /// The extension names no known format.
    #[error("{file}: the extension names no known mesh format; known are {known}")]
    UnknownExtension {
        /// The file.
        file: String,
        /// The known extensions.
        known: String,
    },
    /// No byte at all.
    #[error("{file}: the file is empty")]
    Empty {
        /// The file.
        file: String,
    },
    /// Nothing that is a vertex.
    #[error("{file}: no vertices")]
    NoVertices {
        /// The file.
        file: String,
    },
    /// Vertices, but no face.
    #[error("{file}: no faces (vertices: {vertices})")]
    NoFaces {
        /// The file.
        file: String,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A word that should be a number.
    #[error("{at}: `{text}` is not a number")]
    BadNumber {
        /// Where.
        at: Location,
        /// The word.
        text: String,
    },
    /// A vertex coordinate that is NaN or infinite, or too large for 64 bits.
    #[error("{at}: the vertex has a coordinate that is not finite ({count} in all)")]
    NotFinite {
        /// The first such vertex.
        at: Location,
        /// How many there are.
        count: usize,
    },
    /// Fewer coordinates than needed.
    #[error("{at}: {found} coordinates where {expected} are needed")]
    MissingCoordinate {
        /// Where.
        at: Location,
        /// How many there are.
        found: usize,
        /// How many are needed.
        expected: usize,
    },
    /// A line that ends too early.
    #[error("{at}: the line ends before {what}")]
    MissingValue {
        /// Where.
        at: Location,
        /// What should have come next.
        what: String,
    },
    /// An index that is not a whole number.
    #[error("{at}: `{text}` is not an index")]
    BadIndex {
        /// Where.
        at: Location,
        /// The word.
        text: String,
    },
    /// Index 0 where indices count from 1.
    #[error("{at}: `{text}` has index 0, but indices count from 1")]
    IndexZero {
        /// Where.
        at: Location,
        /// The corner as written.
        text: String,
    },
    /// An index of nothing.
    #[error("{at}: {what} index {index} is out of range: there are {available}, counted from {base} ({count} in all)")]
    IndexOutOfRange {
        /// The first such face.
        at: Location,
        /// `vertex` or `UV`.
        what: &'static str,
        /// The index as written.
        index: i64,
        /// How many elements there are; for a negative index, how many before it.
        available: usize,
        /// What the first element is called, 0 or 1.
        base: u8,
        /// How many such indices there are.
        count: usize,
    },
    /// A polygon without area.
    #[error("{at}: a face with {corners} corners ({count} faces with fewer than 3 in all)")]
    TooFewCorners {
        /// The first such face.
        at: Location,
        /// How many corners it has.
        corners: usize,
        /// How many such faces there are.
        count: usize,
    },
    /// A list whose length makes no sense.
    #[error("{at}: the list `{list}` has length {length}; it should be {expected}")]
    BadListLength {
        /// Where.
        at: Location,
        /// The name of the list.
        list: String,
        /// Its length as written.
        length: f64,
        /// What the length should be.
        expected: String,
    },
    /// A binary file that ends too early.
    #[error("{file}: truncated: {expected} bytes or more are expected, {present} are there")]
    Truncated {
        /// The file.
        file: String,
        /// How many bytes there should be, as far as is known at the place where they end.
        expected: usize,
        /// How many there are.
        present: usize,
    },
    /// A text file that ends too early.
    #[error("{file}: the file ends before {missing}")]
    UnexpectedEnd {
        /// The file.
        file: String,
        /// What should have come next.
        missing: String,
    },
    /// A header that makes no sense.
    #[error("{at}: bad header: {reason}")]
    BadHeader {
        /// Where.
        at: Location,
        /// What is wrong.
        reason: String,
    },
    /// A word where the format wants another.
    #[error("{at}: expected {expected}, found `{found}`")]
    Syntax {
        /// Where.
        at: Location,
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: String,
    },
    /// Something that the format allows and this reader does not read.
    #[error("{at}: {feature} is not supported")]
    Unsupported {
        /// Where.
        at: Location,
        /// What.
        feature: String,
    },
    /// A header that promises more than the bytes after it can hold.
    #[error("{at}: {claimed} of `{what}` are claimed, more than the {present} bytes that follow can hold")]
    ClaimTooLarge {
        /// Where.
        at: Location,
        /// Of what.
        what: String,
        /// How many are claimed.
        claimed: usize,
        /// How many bytes follow the header.
        present: usize,
    },
    /// A text that is no JSON; with the feature `gltf`.
    #[cfg(feature = "gltf")]
    #[error("{file}: not JSON: {cause}")]
    Json {
        /// The file.
        file: String,
        /// What the parser says, with line and column.
        cause: serde_json::Error,
    },
    /// Something in a glTF document that is wrong or missing.
    #[error("{file}, {path}: {reason}")]
    Document {
        /// The file.
        file: String,
        /// Where in the document, such as `meshes[0].primitives[1].indices`.
        path: String,
        /// What is wrong.
        reason: String,
    },
    /// A buffer of a glTF document that cannot be read.
    #[error("{file}, {path}: the buffer `{uri}` cannot be read: {cause}")]
    Buffer {
        /// The document.
        file: String,
        /// Where in the document it is named.
        path: String,
        /// Its name.
        uri: String,
        /// What the system says.
        cause: io::Error,
    },
    /// Geometry in a form that only a decoder of its own can read.
    #[error("{file}, {path}: geometry compressed with {extension} is not read")]
    Compressed {
        /// The file.
        file: String,
        /// Where in the document.
        path: String,
        /// The extension of glTF.
        extension: &'static str,
    },
    /// More elements than 32-bit ids can name.
    #[error("{file}: {count} {what} are more than 32-bit indices can name")]
    TooLarge {
        /// The file.
        file: String,
        /// `vertices` or `corners`.
        what: &'static str,
        /// How many.
        count: usize,
    },
}

fn written() -> String {
    MeshFormat::list(MeshFormat::is_written, ", ")
}

/// Why a mesh cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The system refuses.
    #[error("{target}: cannot be written: {cause}")]
    Io {
        /// The file, or `output` where there is none.
        target: String,
        /// What the system says.
        cause: io::Error,
    },
    /// The extension names no format that is written.
    #[error("{file}: the extension names no format that can be written; known are {known}", known = written())]
    UnknownExtension {
        /// The file.
        file: String,
    },
    /// The UV map belongs to another mesh.
    #[error("the UV map has {map} corners, but the mesh has {mesh}")]
    UvMismatch {
        /// How many corners the map has.
        map: usize,
        /// How many corners the mesh has.
        mesh: usize,
    },
    /// The colours belong to another mesh.
    #[error("there are {colours} vertex colours, but the mesh has {vertices} vertices")]
    ColourMismatch {
        /// How many colours there are.
        colours: usize,
        /// How many vertices the mesh has.
        vertices: usize,
    },
    /// A number that no reader would take back.
    #[error("{what} {first} has a coordinate that is not finite ({count} in all)")]
    NotFinite {
        /// `vertex` or `UV point`.
        what: &'static str,
        /// The first, counted from 0.
        first: usize,
        /// How many there are.
        count: usize,
    },
    /// A glTF document cannot be edited because something in it is wrong.
    #[error(transparent)]
    Document(#[from] ReadError),
    /// A set of texture coordinates that a primitive has already.
    #[error(
        "{file}, meshes[{mesh}].primitives[{primitive}]: there is a TEXCOORD_{set} already; the next free set is TEXCOORD_{next}"
    )]
    TexcoordTaken {
        /// The document.
        file: String,
        /// The mesh.
        mesh: usize,
        /// The primitive in the mesh.
        primitive: usize,
        /// The set that was asked for.
        set: u32,
        /// The first that is free in all primitives.
        next: u32,
    },
    /// A set of texture coordinates that would leave a gap.
    #[error(
        "{file}: TEXCOORD_{set} would leave a gap, which glTF does not allow; the next free set is TEXCOORD_{next}"
    )]
    TexcoordGap {
        /// The document.
        file: String,
        /// The set that was asked for.
        set: u32,
        /// The first that is free in all primitives.
        next: u32,
    },
    /// More bytes or vertices than 32 bits can count.
    #[error("{target}: {what} are more than 32 bits can count")]
    TooLarge {
        /// The file, or `output` where there is none.
        target: String,
        /// What there is too much of.
        what: &'static str,
    },
    /// A file that the document names cannot be named from the folder it is written to.
    #[error("{target}: `{uri}` cannot be named from there")]
    Unreachable {
        /// The file to be written.
        target: String,
        /// The name in the document.
        uri: String,
    },
}
