//! The shapes by name.

use crate::{bands, domes, letters, pyramids, sheets};
use abf_mesh::TriMesh;
use std::fmt;
use std::str::FromStr;

/// A family of disk meshes, one for every size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Shape {
    /// Three triangles around an apex whose angles sum to 2π − 4.56; of fixed size.
    Obtuse,
    /// A low six-sided pyramid without base: all curvature (deficit π/6) in one vertex.
    Pyramid,
    /// A steep six-sided pyramid without base: deficit 4π/3 in one vertex.
    Spike,
    /// Half a sphere in rings.
    Hemisphere,
    /// A square sheet with smooth hills.
    BumpySheet,
    /// A Miura fold, exactly developable.
    FoldedSheet,
    /// A sheet rolled up in a spiral, developable.
    Roll,
    /// A ring cyclide of Dupin cut open along a meridian and a parallel.
    Cyclide,
    /// A long band with three twists.
    TwistedBand,
    /// A half-pipe of nine humps along a spiral: its free map lies over itself.
    Caterpillar,
    /// The digit 2 as a curved sheet.
    Letter2,
    /// The letter V as a curved sheet.
    LetterV,
    /// The letter X as a curved sheet.
    LetterX,
    /// A sheet full of cones, many of deficit above 1: a stress test.
    SpikyField,
    /// A monkey saddle with ripples.
    WavySaddle,
    /// A face on a bit more than half an ellipsoid: the default model.
    Mask,
    /// A round sheet with small bumps, for scaling.
    FatDisk,
}

/// A name that is no shape's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no shape is called '{name}'; there are {}", names())]
pub struct UnknownShape {
    /// What was asked for.
    pub name: String,
}

impl Shape {
    /// Every shape.
    pub const ALL: [Self; 17] = [
        Self::Obtuse,
        Self::Pyramid,
        Self::Spike,
        Self::Hemisphere,
        Self::BumpySheet,
        Self::FoldedSheet,
        Self::Roll,
        Self::Cyclide,
        Self::TwistedBand,
        Self::Caterpillar,
        Self::Letter2,
        Self::LetterV,
        Self::LetterX,
        Self::SpikyField,
        Self::WavySaddle,
        Self::Mask,
        Self::FatDisk,
    ];

    /// The name, as files and the command line use it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Obtuse => "obtuse",
            Self::Pyramid => "pyramid",
            Self::Spike => "spike",
            Self::Hemisphere => "hemisphere",
            Self::BumpySheet => "bumpy-sheet",
            Self::FoldedSheet => "folded-sheet",
            Self::Roll => "roll",
            Self::Cyclide => "cyclide",
            Self::TwistedBand => "twisted-band",
            Self::Caterpillar => "caterpillar",
            Self::Letter2 => "letter-2",
            Self::LetterV => "letter-v",
            Self::LetterX => "letter-x",
            Self::SpikyField => "spiky-field",
            Self::WavySaddle => "wavy-saddle",
            Self::Mask => "mask",
            Self::FatDisk => "fat-disk",
        }
    }

    /// One line on what it is and what it is for.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Obtuse => "three triangles, apex deficit 4.56 (fixed size): needs the exponential-map initial guess",
            Self::Pyramid => "low six-sided pyramid without base: all curvature in one vertex",
            Self::Spike => "steep six-sided pyramid without base: deficit 4.19 in one vertex",
            Self::Hemisphere => "half a sphere in rings",
            Self::BumpySheet => "square sheet with smooth hills",
            Self::FoldedSheet => "Miura fold, exactly developable: flattens without distortion",
            Self::Roll => "sheet rolled up in a spiral, developable",
            Self::Cyclide => "ring cyclide of Dupin cut open: conformally a rectangle",
            Self::TwistedBand => "long band with three twists",
            Self::Caterpillar => "half-pipe of nine humps along a spiral: its free map lies over itself",
            Self::Letter2 => "the digit 2 as a curved sheet",
            Self::LetterV => "the letter V as a curved sheet",
            Self::LetterX => "the letter X as a curved sheet",
            Self::SpikyField => "sheet with a field of cones, many of deficit above 1: a stress test",
            Self::WavySaddle => "monkey saddle with ripples",
            Self::Mask => "a face on half an ellipsoid: the default model",
            Self::FatDisk => "round sheet with small bumps, for scaling to millions of triangles",
        }
    }

    /// A mesh of about `triangles` triangles, in time linear in them.
    ///
    /// From 200 triangles on the number is met within 20 %; below that it is the nearest the
    /// shape has (6 triangles for the round ones, 8 for sheets, up to 156 for the others).
    /// [`Shape::Obtuse`] always has 3. A larger number makes smaller triangles on the same surface;
    /// only the folds of [`Shape::FoldedSheet`] and the cones of [`Shape::SpikyField`] are placed
    /// on the grid and so depend on it.
    #[must_use]
    pub fn mesh(self, triangles: usize) -> TriMesh {
        match self {
            Self::Obtuse => pyramids::obtuse(),
            Self::Pyramid => pyramids::low(triangles),
            Self::Spike => pyramids::spike(triangles),
            Self::Hemisphere => domes::hemisphere(triangles),
            Self::BumpySheet => sheets::bumpy(triangles),
            Self::FoldedSheet => sheets::folded(triangles),
            Self::Roll => sheets::roll(triangles),
            Self::Cyclide => bands::cyclide(triangles),
            Self::TwistedBand => bands::twisted_band(triangles),
            Self::Caterpillar => bands::caterpillar(triangles),
            Self::Letter2 => letters::two(triangles),
            Self::LetterV => letters::v(triangles),
            Self::LetterX => letters::x(triangles),
            Self::SpikyField => sheets::spiky_field(triangles),
            Self::WavySaddle => domes::wavy_saddle(triangles),
            Self::Mask => domes::mask(triangles),
            Self::FatDisk => domes::fat_disk(triangles),
        }
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Shape {
    type Err = UnknownShape;

    fn from_str(name: &str) -> Result<Self, UnknownShape> {
        Self::ALL.into_iter().find(|s| s.name() == name).ok_or_else(|| UnknownShape { name: name.to_owned() })
    }
}

/// Every name, in a sentence.
fn names() -> String {
    Shape::ALL.map(Shape::name).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Topology;

    const SIZES: [usize; 6] = [0, 60, 200, 470, 1800, 20_000];

    /// From this many triangles on [`least_angle_deg`] holds, below it [`COARSE_LEAST_ANGLE_DEG`].
    const FINE: usize = 200;
    const COARSE_LEAST_ANGLE_DEG: f64 = 7.0;

    /// A bound on the smallest angle of any triangle, degrees.
    fn least_angle_deg(shape: Shape) -> f64 {
        match shape {
            Shape::FoldedSheet => 59.0,
            Shape::Pyramid => 54.9,
            Shape::Roll => 43.0,
            Shape::FatDisk => 38.0,
            Shape::SpikyField | Shape::WavySaddle | Shape::Hemisphere => 33.0,
            Shape::TwistedBand => 32.0,
            Shape::BumpySheet => 30.0,
            Shape::LetterV | Shape::LetterX => 26.0,
            Shape::Cyclide | Shape::Obtuse => 25.0,
            Shape::Spike => 19.9,
            Shape::Letter2 | Shape::Mask => 18.0,
            Shape::Caterpillar => 13.6,
        }
    }

    fn smallest_angle_deg(mesh: &TriMesh) -> f64 {
        mesh.corner_angles().into_iter().fold(f64::INFINITY, f64::min).to_degrees()
    }

    #[test]
    fn every_shape_is_a_disk_at_every_size() {
        for shape in Shape::ALL {
            for size in SIZES {
                let mesh = shape.mesh(size);
                let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
                topology.check().expect("the laws of the corner table");
                topology.require_disk().unwrap_or_else(|e| panic!("{shape} at {size}: {e}"));
                mesh.check_geometry().unwrap_or_else(|e| panic!("{shape} at {size}: {e}"));
                assert_eq!(mesh.unreferenced_vertices(), 0, "{shape} at {size}");
                assert!(topology.interior_vertex_count() > 0, "{shape} at {size}");
            }
        }
    }

    #[test]
    fn the_number_of_triangles_is_met_within_a_fifth() {
        for shape in Shape::ALL.into_iter().filter(|&s| s != Shape::Obtuse) {
            for size in (200..4000).step_by(71).chain([20_000, 50_000]) {
                let off = shape.mesh(size).face_count() as f64 / size as f64 - 1.0;
                assert!(off.abs() <= 0.2, "{shape} at {size}: {off:+.2}");
            }
            assert!(shape.mesh(0).face_count() <= 156, "{shape}");
        }
    }

    #[test]
    fn triangles_are_well_shaped() {
        for shape in Shape::ALL {
            for size in SIZES {
                let smallest = smallest_angle_deg(&shape.mesh(size));
                let bound = if size < FINE { COARSE_LEAST_ANGLE_DEG } else { least_angle_deg(shape) };
                assert!(smallest >= bound, "{shape} at {size}: {smallest:.1}°");
            }
        }
    }

    #[test]
    fn the_same_request_gives_the_same_bits() {
        for shape in Shape::ALL {
            assert_eq!(shape.mesh(700), shape.mesh(700), "{shape}");
        }
    }

    #[test]
    fn text_of_nine_decimals_holds_every_coordinate_exactly() {
        for shape in Shape::ALL {
            for x in shape.mesh(700).positions().iter().flat_map(|p| [p.x, p.y, p.z]) {
                assert_eq!(format!("{x:.9}").parse::<f64>().expect("a number").to_bits(), x.to_bits(), "{shape}");
            }
        }
    }

    #[test]
    fn names_are_read_back_and_unknown_ones_are_answered_with_the_list() {
        for shape in Shape::ALL {
            assert_eq!(shape.name().parse(), Ok(shape));
        }
        let message = "letter-z".parse::<Shape>().unwrap_err().to_string();
        assert!(message.contains("'letter-z'") && Shape::ALL.iter().all(|s| message.contains(s.name())), "{message}");
    }
}
