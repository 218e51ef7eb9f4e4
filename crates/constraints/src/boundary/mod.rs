//! What is asked of the boundary: bounds on, or values of, the angle sums at its vertices.
//!
//! A boundary vertex `v` can have a row of its own,
//!
//! ```text
//! Σ x at v ≤ b    or    Σ x at v = b,
//! ```
//!
//! next to those of the disk. It has no wheel. ZRS05 and VMV04 §4 name convex boundaries and given angles.
//!
//! The boundary of a disk turns by 2π in all, so with `n` boundary vertices `Σ b = (n − 2) π` when every sum is given. One
//! of the rows then follows from the others.

mod circle;
mod conditions;
mod error;

pub use conditions::{BoundaryAngle, BoundaryConditions, boundary_loop};
pub use error::{BadAngle, BadAngleCause, BoundaryError};

use abf_control::SettingError;
use abf_mesh::Topology;
use std::collections::HashSet;
use std::f64::consts::{PI, TAU};
use std::fmt;
use std::str::FromStr;

/// How far below 2π `below-2pi` keeps the angle sums where nothing else is said, rad.
pub const DEFAULT_BELOW: f64 = 0.01;

/// What the boundary of the flat mesh is to look like.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Boundary {
    /// Whatever comes out best.
    #[default]
    Free,
    /// No angle sum above π. Then the boundary is convex, and a valid map does not overlap itself. It is good for
    /// surfaces that are nearly convex, and costs much distortion where seams run deep into the surface.
    Convex,
    /// No angle sum above 2π less this, rad: no overlap around a single boundary vertex.
    #[cfg_attr(feature = "serde", serde(rename = "below-2pi"))]
    Below2Pi(f64),
    /// π/2 at four corners and π elsewhere, the aspect ratio free. The corners are vertices, counted from 0, in any
    /// order; `None` finds those that fit best.
    Rectangle(Option<[u32; 4]>),
    /// The boundary becomes a circle: `b = π − (θ + θ′)/2`, with `θ = 2 asin(ℓ / 2R)` and `ℓ` the lengths of the two boundary
    /// edges at the vertex in the layout; `θ = 2πℓ/Σℓ` while one edge is too long for a circle of the others. It is solved again with the lengths of each layout until they agree.
    Circle,
    /// These angle sums; the other boundary vertices are free.
    Angles(Vec<BoundaryAngle>),
}

impl Boundary {
    /// Whether nothing is asked.
    #[must_use]
    pub fn is_free(&self) -> bool {
        *self == Self::Free
    }

    /// Checks what can be checked without a mesh.
    ///
    /// # Errors
    /// [`SettingError`] naming `boundary`.
    pub fn check(&self) -> Result<(), SettingError> {
        match self {
            Self::Below2Pi(below) if !(*below > 0.0 && *below < TAU) => {
                Err(SettingError::new("boundary", "below-2pi=EPS with EPS in (0, 2π) rad", below))
            }
            _ => Ok(()),
        }
    }

    /// The conditions on the vertices of a disk; `None` where there are none, and where the rule needs more than the
    /// topology: the circle needs lengths ([`BoundaryConditions::circle`]), the rectangle without corners needs corners.
    ///
    /// # Errors
    /// [`BoundaryError`] when no map of this disk can meet them.
    pub fn conditions(&self, topology: &Topology) -> Result<Option<BoundaryConditions>, BoundaryError> {
        Ok(match self {
            Self::Free | Self::Circle | Self::Rectangle(None) => None,
            Self::Convex => Some(BoundaryConditions::at_most(topology, PI)),
            Self::Below2Pi(below) => {
                let conditions = BoundaryConditions::at_most(topology, TAU - below);
                let count = conditions.len();
                let (most, needed) = ((TAU - below) * count as f64, (count as f64 - 2.0) * PI);
                if most <= needed {
                    return Err(BoundaryError::TooSmall { count, most, needed });
                }
                Some(conditions)
            }
            Self::Rectangle(Some(corners)) => Some(BoundaryConditions::rectangle(topology, *corners)?),
            Self::Angles(angles) => Some(BoundaryConditions::given(topology, angles)?),
        })
    }

    /// Reads angles: a vertex, counted from 0, and its angle sum in rad on each line. What follows `#` is a comment.
    ///
    /// # Errors
    /// [`BoundaryError::Angles`] where a line has no vertex and angle: with every such line, and every one with an angle that is
    /// not finite or not positive, or that of a vertex that has one already. Where all lines can be read, the last two are found
    /// together with what does not fit the mesh, by [`Boundary::conditions`]. [`BoundaryError::NoAngles`] where no line has any.
    pub fn read_angles(text: &str) -> Result<Self, BoundaryError> {
        let (mut angles, mut bad, mut is_readable) = (Vec::new(), Vec::new(), true);
        let mut seen = HashSet::new();
        for (number, line) in abf_mesh::text::lines(text) {
            let line_number = Some(number);
            let Some((vertex, angle)) = vertex_and_angle(line) else {
                bad.push(BadAngle { vertex: None, line: line_number, cause: BadAngleCause::Unreadable });
                is_readable = false;
                continue;
            };
            let is_angle = angle > 0.0 && angle.is_finite();
            let doubled = (!seen.insert(vertex)).then_some(BadAngleCause::Twice);
            let causes = doubled.into_iter().chain((!is_angle).then_some(BadAngleCause::NotPositive(angle)));
            bad.extend(causes.map(|cause| BadAngle { vertex: Some(vertex), line: line_number, cause }));
            angles.push(BoundaryAngle { vertex, angle, line: line_number });
        }
        if angles.is_empty() && bad.is_empty() {
            return Err(BoundaryError::NoAngles);
        }
        if is_readable { Ok(Self::Angles(angles)) } else { Err(BoundaryError::Angles(bad)) }
    }
}

/// A line of a file of angles.
fn vertex_and_angle(line: &str) -> Option<(u32, f64)> {
    let (vertex, angle) = line.split_once(char::is_whitespace)?;
    Some((vertex.parse().ok()?, angle.trim().parse().ok()?))
}

/// What can be written without a file: `free`, `convex`, `below-2pi[=EPS]`, `rectangle[=v0,v1,v2,v3]`, `circle`.
impl FromStr for Boundary {
    type Err = SettingError;

    fn from_str(s: &str) -> Result<Self, SettingError> {
        const ALLOWED: &str = "free, convex, below-2pi[=EPS], rectangle[=v0,v1,v2,v3], circle or angles=FILE";
        let fault = || SettingError::new("boundary", ALLOWED, format_args!("'{s}'"));
        let (name, value) = s.split_once('=').map_or((s, None), |(name, value)| (name, Some(value)));
        let boundary = match (name, value) {
            ("free", None) => Self::Free,
            ("convex", None) => Self::Convex,
            ("circle", None) => Self::Circle,
            ("below-2pi", None) => Self::Below2Pi(DEFAULT_BELOW),
            ("below-2pi", Some(below)) => Self::Below2Pi(below.parse().map_err(|_| fault())?),
            ("rectangle", None) => Self::Rectangle(None),
            ("rectangle", Some(corners)) => {
                let corners: Result<Vec<u32>, _> = corners.split(',').map(str::parse).collect();
                let corners = corners.map_err(|_| fault())?;
                Self::Rectangle(Some(corners.try_into().map_err(|_| fault())?))
            }
            _ => return Err(fault()),
        };
        boundary.check()?;
        Ok(boundary)
    }
}

impl fmt::Display for Boundary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Free => f.write_str("free"),
            Self::Convex => f.write_str("convex"),
            Self::Below2Pi(below) => write!(f, "below-2pi={below}"),
            Self::Rectangle(None) => f.write_str("rectangle"),
            Self::Rectangle(Some([a, b, c, d])) => write!(f, "rectangle={a},{b},{c},{d}"),
            Self::Circle => f.write_str("circle"),
            Self::Angles(angles) => write!(f, "angles of {} vertices", angles.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_read_back_and_others_are_refused_by_name() {
        for text in ["free", "convex", "below-2pi=0.25", "rectangle", "rectangle=0,3,5,9", "circle"] {
            assert_eq!(text.parse::<Boundary>().expect("a rule").to_string(), text);
        }
        assert_eq!("below-2pi".parse(), Ok(Boundary::Below2Pi(DEFAULT_BELOW)));
        for text in ["", "square", "convex=1", "rectangle=1,2,3", "rectangle=1,2,3,x", "below-2pi=7", "below-2pi=nan"] {
            let error = text.parse::<Boundary>().unwrap_err().to_string();
            assert!(error.starts_with("boundary must be "), "{error}");
        }
    }

    #[test]
    fn a_byte_order_mark_is_no_part_of_the_first_vertex() {
        let text = "3 1.5\r\n7 2.5\r\n";
        let [plain, marked] = ["", "\u{feff}"].map(|mark| Boundary::read_angles(&format!("{mark}{text}")));
        assert!(plain.is_ok() && plain == marked, "{marked:?}");
    }

    #[test]
    fn every_line_that_is_no_angle_is_named() {
        let read = Boundary::read_angles("# corners\n3 1.5707963\n\n7 1.5 # here\n").expect("angles");
        let Boundary::Angles(angles) = read else { panic!("{read}") };
        assert_eq!(angles.iter().map(|a| (a.vertex, a.line)).collect::<Vec<_>>(), [(3, Some(2)), (7, Some(4))]);
        let error = Boundary::read_angles("3 1.5\nthree 1.5\n4\n5 1 1\n").unwrap_err().to_string();
        for line in ["line 2", "line 3", "line 4"] {
            assert!(error.contains(line), "{error}");
        }
        assert!(!error.contains("line 1"), "{error}");
        let error = Boundary::read_angles("3 1.5\n3 1.5\n4 inf\n5 -1\nfive").unwrap_err().to_string();
        for part in ["line 2: vertex 3: it has", "line 3: vertex 4: the angle inf", "line 4: vertex 5", "line 5"] {
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn a_file_without_angles_is_not_one_that_asks_for_nothing() {
        for text in ["", "\n\n", "# 3 1.5"] {
            assert_eq!(Boundary::read_angles(text), Err(BoundaryError::NoAngles), "{text}");
        }
    }
}
