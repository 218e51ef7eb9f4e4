//! Demands on a boundary that no map can meet.

use std::fmt;

/// Why no map of a disk meets what is asked of its boundary. Vertices are counted from 0, angles are in rad.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BoundaryError {
    /// Entries of a list of angles that mean nothing on this mesh.
    #[error("{}", listed(.0))]
    Angles(Vec<BadAngle>),
    /// A file of angles without any.
    #[error(
        "the file has no angles: write a vertex, counted from 0, and its angle in rad on each line, such as '12 1.5708', or \
         leave the boundary free"
    )]
    NoAngles,
    /// The corners of a rectangle are four different boundary vertices.
    #[error("the corner {vertex} of the rectangle {}", if *is_twice { "is named twice" } else { "is no boundary vertex" })]
    Corner {
        /// Which.
        vertex: u32,
        /// Whether it is there already; else it is not on the boundary.
        is_twice: bool,
    },
    /// The boundary has fewer vertices than a rectangle has corners.
    #[error("a rectangle needs 4 boundary vertices, and there are {0}")]
    TooFew(usize),
    /// The angles from which the corners are found are not all numbers, or lengths are beyond them.
    #[error("no four corners of a rectangle can be told from the free solution: name them, rectangle=v0,v1,v2,v3")]
    NoCorners,
    /// A vertex between two edges of one triangle, whose angle is that of the triangle.
    #[error(
        "vertex {vertex} is in one triangle only, so its angle is below π, and {angle} is asked for; make it a corner \
         of the boundary or split the triangle"
    )]
    Ear {
        /// Which.
        vertex: u32,
        /// What is asked for.
        angle: f64,
    },
    /// An edge inside the surface between two boundary vertices, which cuts off a polygon without room for its angles.
    #[error(
        "the edge between the vertices {a} and {b} cuts off {between} boundary vertices that are to be on one straight \
         or bent-back side: nothing is left for the faces between; put a corner among them or split the edge"
    )]
    Chord {
        /// One end.
        a: u32,
        /// The other.
        b: u32,
        /// How many boundary vertices are between them.
        between: usize,
    },
    /// All angles are given and their sum is not that of a polygon.
    #[error("the {count} angles of the boundary sum to {sum}; those of a polygon sum to (n − 2) π = {needed}")]
    Sum {
        /// How many.
        count: usize,
        /// What they sum to.
        sum: f64,
        /// What they have to sum to.
        needed: f64,
    },
    /// All angles together may not be as large as those of a polygon.
    #[error(
        "the {count} angles of the boundary may sum to {most} in all; those of a polygon sum to (n − 2) π = {needed}; \
         allow larger ones"
    )]
    TooSmall {
        /// How many.
        count: usize,
        /// What they may sum to.
        most: f64,
        /// What they have to sum to.
        needed: f64,
    },
    /// Some angles are given and leave the others none, or more than they can have.
    #[error(
        "the angles of {given} of {count} boundary vertices sum to {sum}; the others would have {left} in all, and can \
         have more than 0 and less than {room}"
    )]
    Rest {
        /// How many are given.
        given: usize,
        /// How many boundary vertices there are.
        count: usize,
        /// What the given ones sum to.
        sum: f64,
        /// What the others would have.
        left: f64,
        /// What they can have: π for each of their triangles.
        room: f64,
    },
    /// The surface is flattened with its holes open, so its boundary is no polygon.
    #[error("a boundary rule needs a surface with one boundary loop: fill the holes, or leave the boundary free")]
    Holes,
}

/// An entry of a list of angles that means nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BadAngle {
    /// The vertex it names, if it names one.
    pub vertex: Option<u32>,
    /// In which line of a file, counted from 1.
    pub line: Option<usize>,
    /// Why.
    pub cause: BadAngleCause,
}

/// Why an entry of a list of angles means nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BadAngleCause {
    /// A line without a vertex and an angle.
    #[error("a vertex and its angle in rad are wanted, such as '12 1.5708'")]
    Unreadable,
    /// A vertex that the mesh does not have.
    #[error("there are only {0} vertices, counted from 0")]
    Unknown(usize),
    /// A vertex with faces all around, or none.
    #[error("it is not on the boundary")]
    NotOnTheBoundary,
    /// A vertex that is there already.
    #[error("it has an angle already: leave one of the two out")]
    Twice,
    /// An angle that no vertex can have.
    #[error("the angle {0} is not positive and finite")]
    NotPositive(f64),
    /// An angle that its triangles cannot have.
    #[error("the angle {angle} is not in (0, {most}), which its triangles can have")]
    Angle {
        /// What is asked for.
        angle: f64,
        /// π for each triangle.
        most: f64,
    },
}

impl fmt::Display for BadAngle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.vertex) {
            (Some(line), Some(vertex)) => write!(f, "line {line}: vertex {vertex}: {}", self.cause),
            (Some(line), None) => write!(f, "line {line}: {}", self.cause),
            (None, Some(vertex)) => write!(f, "vertex {vertex}: {}", self.cause),
            (None, None) => self.cause.fmt(f),
        }
    }
}

/// One after the other.
fn listed(bad: &[BadAngle]) -> String {
    bad.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}
