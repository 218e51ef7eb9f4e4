//! Vertices and the places where they are to be.

use crate::plane::{not_counter_clockwise, orientation};
use abf_mesh::{FaceId, Point2, Topology, VertexId};
use std::collections::HashSet;
use std::fmt;

/// Places that differ from a line by no more than this part of their extent are on it.
const ON_LINE: f64 = 1e-12;

/// A vertex and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Pin {
    /// Which vertex, counted from 0.
    pub vertex: u32,
    /// Where it is to be, in units of the UVs.
    pub uv: [f64; 2],
    /// Whether it must be there.
    #[cfg_attr(feature = "serde", serde(default))]
    pub weight: PinWeight,
}

/// Whether a vertex must be in its place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum PinWeight {
    /// It must: it is put there exactly, or it is reported as missed.
    #[default]
    Hard,
    /// It is drawn there with the weight `W`, in (0, ∞): `W |u − uv|²` over the area of the UVs and the number of pins is
    /// added to the energy of a surface of area 1.
    Soft(f64),
}

/// Vertices and their places.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(transparent))]
pub struct Pins {
    /// One for each vertex.
    pub pins: Vec<Pin>,
}

/// What is wrong with a pin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PinFault {
    /// A line of a file that is no pin.
    #[error("line {line}: '{text}' is not 'VERTEX U V' or 'VERTEX U V soft WEIGHT'")]
    Line {
        /// Which line, counted from 1.
        line: usize,
        /// What stands there.
        text: String,
    },
    /// A file without pins.
    #[error(
        "the file has no pins: write a vertex, counted from 0, and its place on each line, such as '12 0.5 0.25', or leave the \
         pins out"
    )]
    NoPins,
    /// Something else is wrong with a line of a file.
    #[error("line {line}: {fault}")]
    InLine {
        /// Which line, counted from 1.
        line: usize,
        /// What is wrong.
        fault: Box<PinFault>,
    },
    /// There is no such vertex.
    #[error("there is no vertex {vertex}: the mesh has {vertices}, counted from 0")]
    Unknown {
        /// Its number.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// No face uses the vertex.
    #[error("no face uses vertex {0}")]
    Unused(
        /// Its number.
        u32,
    ),
    /// A vertex has two pins.
    #[error("vertex {0} is pinned twice")]
    Doubled(
        /// Its number.
        u32,
    ),
    /// A place or a weight that is none.
    #[error("the pin of vertex {0} has a number that is not finite, or a weight that is not positive")]
    NotFinite(
        /// Its number.
        u32,
    ),
    /// Hard pins that no map without flips can have.
    #[error("all {0} hard pins are {1}")]
    Flat(
        /// How many.
        usize,
        /// Where.
        &'static str,
    ),
    /// The three pins of a face do not leave it counter-clockwise.
    #[error("the hard pins of vertices {}, {} and {} turn face {face} over", of[0], of[1], of[2])]
    TurnedOver {
        /// Which face.
        face: FaceId,
        /// Its vertices.
        of: [VertexId; 3],
    },
    /// Places so far from the origin, or so near to each other, that the rounding there turns triangles over.
    #[error("doubles do not hold a map of that size in these places: {0} triangles would be turned over")]
    NotHeld(
        /// How many.
        usize,
    ),
}

/// Everything that is wrong with pins.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "))]
#[non_exhaustive]
pub struct PinError {
    /// At least one.
    pub faults: Vec<PinFault>,
}

impl Pin {
    /// Whether it is to be met exactly.
    #[must_use]
    pub fn is_hard(&self) -> bool {
        self.weight == PinWeight::Hard
    }

    fn not_finite(&self) -> Option<PinFault> {
        let is_weight = match self.weight {
            PinWeight::Hard => true,
            PinWeight::Soft(weight) => weight > 0.0 && weight.is_finite(),
        };
        let is_pin = is_weight && self.uv.iter().all(|x| x.is_finite());
        (!is_pin).then_some(PinFault::NotFinite(self.vertex))
    }
}

impl Pins {
    /// Reads pins, one on each line: a vertex counted from 0, its place `u v`, and `soft W` if it is soft. Empty lines and what
    /// stands after `#` are left out.
    ///
    /// # Errors
    /// [`PinError`] with every line that is no pin, has a number that is none, or pins a vertex again; or where there is no
    /// pin at all.
    pub fn read(text: &str) -> Result<Self, PinError> {
        let (mut pins, mut faults) = (Vec::new(), Vec::new());
        let mut seen = HashSet::new();
        for (line, meant) in abf_mesh::text::lines(text) {
            match read_pin(meant) {
                Some(pin) => {
                    let doubled = (!seen.insert(pin.vertex)).then_some(PinFault::Doubled(pin.vertex));
                    let found = doubled.into_iter().chain(pin.not_finite());
                    faults.extend(found.map(|fault| PinFault::InLine { line, fault: Box::new(fault) }));
                    pins.push(pin);
                }
                None => faults.push(PinFault::Line { line, text: meant.to_owned() }),
            }
        }
        if pins.is_empty() && faults.is_empty() {
            faults.push(PinFault::NoPins);
        }
        if faults.is_empty() { Ok(Self { pins }) } else { Err(PinError { faults }) }
    }

    /// Checks the pins against a mesh.
    ///
    /// # Errors
    /// [`PinError`] with all that is wrong.
    pub fn check(&self, topology: &Topology) -> Result<(), PinError> {
        let vertices = topology.vertex_count();
        let mut faults = Vec::new();
        let mut seen = vec![false; vertices];
        for pin in &self.pins {
            let vertex = pin.vertex;
            if vertex as usize >= vertices {
                faults.push(PinFault::Unknown { vertex, vertices });
                continue;
            }
            if topology.fan_start(VertexId::new(vertex as usize)).is_none() {
                faults.push(PinFault::Unused(vertex));
            }
            if std::mem::replace(&mut seen[vertex as usize], true) {
                faults.push(PinFault::Doubled(vertex));
            }
            faults.extend(pin.not_finite());
        }
        if faults.is_empty() {
            faults.extend(self.flat());
            faults.extend(self.turned_over(topology));
        }
        if faults.is_empty() { Ok(()) } else { Err(PinError { faults }) }
    }

    /// Whether a similarity brings all of them to their places: at most two, and hard.
    #[must_use]
    pub fn need_a_similarity_only(&self) -> bool {
        self.pins.len() <= 2 && self.pins.iter().all(Pin::is_hard)
    }

    /// The faces with three hard pins that do not leave them counter-clockwise.
    fn turned_over(&self, topology: &Topology) -> Vec<PinFault> {
        let mut places = vec![None; topology.vertex_count()];
        self.pins.iter().filter(|pin| pin.is_hard()).for_each(|pin| places[pin.vertex as usize] = Some(place(pin)));
        let fault = |face: FaceId| {
            let of = topology.face_vertices(face);
            let [Some(a), Some(b), Some(c)] = of.map(|v| places[v.index()]) else { return None };
            (!(orientation(&[a, b, c]) > 0.0)).then_some(PinFault::TurnedOver { face, of })
        };
        topology.faces().filter_map(fault).collect()
    }

    /// Checks that doubles hold a drawing that a similarity brought to the pins.
    pub(crate) fn check_held(&self, topology: &Topology, uv: &[Point2<f64>]) -> Result<(), PinError> {
        match not_counter_clockwise(topology, uv) {
            None => Ok(()),
            Some((_, count)) => Err(PinError { faults: vec![PinFault::NotHeld(count)] }),
        }
    }

    /// Hard pins on one point, or three and more on one line.
    fn flat(&self) -> Option<PinFault> {
        let hard: Vec<Point2<f64>> = self.pins.iter().filter(|pin| pin.is_hard()).map(place).collect();
        let first = *hard.first()?;
        let far = hard.iter().max_by(|p, q| (*p - first).norm().total_cmp(&(*q - first).norm()))? - first;
        if hard.len() > 1 && far.norm() == 0.0 {
            return Some(PinFault::Flat(hard.len(), "in one place"));
        }
        let is_on_line = |p: &Point2<f64>| far.perp(&(p - first)).abs() <= ON_LINE * far.norm_squared();
        (hard.len() > 2 && hard.iter().all(is_on_line)).then_some(PinFault::Flat(hard.len(), "on one line"))
    }
}

impl fmt::Display for Pins {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for pin in &self.pins {
            write!(f, "{} {} {}", pin.vertex, pin.uv[0], pin.uv[1])?;
            match pin.weight {
                PinWeight::Soft(weight) => writeln!(f, " soft {weight}")?,
                PinWeight::Hard => writeln!(f)?,
            }
        }
        Ok(())
    }
}

fn read_pin(line: &str) -> Option<Pin> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |word: &str| word.parse::<f64>().ok();
    let (vertex, u, v, weight) = match words[..] {
        [vertex, u, v] => (vertex, u, v, PinWeight::Hard),
        [vertex, u, v, "soft", weight] => (vertex, u, v, PinWeight::Soft(number(weight)?)),
        _ => return None,
    };
    Some(Pin { vertex: vertex.parse().ok()?, uv: [number(u)?, number(v)?], weight })
}

pub(crate) fn place(pin: &Pin) -> Point2<f64> {
    Point2::from(pin.uv)
}

pub(crate) fn vertex(pin: &Pin) -> VertexId {
    VertexId::new(pin.vertex as usize)
}
