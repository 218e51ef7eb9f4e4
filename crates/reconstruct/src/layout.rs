//! The choice of a method, and what they all share.

use crate::tree::EdgeVectors;
use crate::{LinearError, LinearStats, PinnedPair, least_squares, poisson};
use abf_control::{Cancelled, Checkpoint, UnknownName};
use abf_linalg::Complex64;
use abf_mesh::{Point2, Topology, TriMesh, UvMap};
use abf_parallel::prelude::*;
use std::f64::consts::PI;

/// Angles are kept this far from 0 and π, rad, when they are laid out.
pub const ANGLE_CLAMP: f64 = 1e-6;

/// Fewer angles or points are not worth a thread.
const PER_TASK: usize = 1 << 13;

/// How to get from angles to coordinates.
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
pub enum LayoutKind {
    /// The tree when the angles close, else least squares.
    #[default]
    Auto,
    /// Least squares, each triangle's equation unweighted, as in the papers.
    LeastSquares,
    /// Least squares with the area weights of LSCM.
    LeastSquaresWeighted,
    /// Integration along a tree of triangles.
    Tree,
    /// Integration, then a Poisson solve.
    Poisson,
}

impl LayoutKind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Self; 5] = [Self::Auto, Self::LeastSquares, Self::LeastSquaresWeighted, Self::Tree, Self::Poisson];

    /// The name on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(given: &str) -> UnknownName {
    UnknownName::of::<LayoutKind>("layout", given)
}

/// What a layout may be told.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct LayoutSettings {
    /// Which method.
    pub kind: LayoutKind,
    /// With [`LayoutKind::Auto`]: the angles close when the two sides of every edge agree to this,
    /// in log length and in direction (rad), after integration.
    pub closing_tolerance: f64,
}

impl Default for LayoutSettings {
    fn default() -> Self {
        Self { kind: LayoutKind::Auto, closing_tolerance: 1e-6 }
    }
}

/// Coordinates, and how they were found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Layout {
    /// One UV per vertex.
    pub uv: UvMap,
    /// The method that was used; never [`LayoutKind::Auto`].
    pub kind: LayoutKind,
    /// The linear solve; `None` for the tree.
    pub linear: Option<LinearStats>,
    /// The largest disagreement between the two sides of an edge after integration; `None` where
    /// nothing was integrated.
    pub closing_error: Option<f64>,
    /// How many angles were clamped by [`ANGLE_CLAMP`].
    pub clamped_angles: usize,
}

/// Why angles could not be laid out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// A surface without boundary.
    #[error("the surface has no boundary to lay out")]
    NoBoundary,
    /// There must be one angle for every corner.
    #[error("{given} angles for {corners} corners")]
    AngleCount {
        /// How many angles were given.
        given: usize,
        /// How many corners there are.
        corners: usize,
    },
    /// The linear system could not be solved.
    #[error("the linear system of the {kind} layout has no usable solution")]
    Linear {
        /// Which layout.
        kind: LayoutKind,
        /// Why.
        source: LinearError,
    },
    /// Coordinates beyond the range of doubles.
    #[error("the {kind} layout has coordinates that doubles cannot hold")]
    NotFinite {
        /// Which layout.
        kind: LayoutKind,
    },
    /// The checkpoint ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl LayoutError {
    /// A linear system without solution, or the abort that ended its solve.
    fn of_linear(kind: LayoutKind, source: LinearError) -> Self {
        match source {
            LinearError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            source => Self::Linear { kind, source },
        }
    }
}

/// Lays out the disk `mesh` with the given corner angles (radians, one per corner).
///
/// # Errors
/// [`LayoutError`] when the linear system has no solution or the coordinates are not finite.
pub fn layout(
    mesh: &TriMesh,
    topology: &Topology,
    angles: &[f64],
    settings: &LayoutSettings,
) -> Result<Layout, LayoutError> {
    layout_asking(mesh, topology, angles, settings, &mut || Ok(()))
}

/// [`layout()`] that asks between its parts whether to go on.
///
/// # Errors
/// As `layout`, and [`LayoutError::Cancelled`].
pub fn layout_asking(
    mesh: &TriMesh,
    topology: &Topology,
    angles: &[f64],
    settings: &LayoutSettings,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Layout, LayoutError> {
    if angles.len() != topology.corner_count() {
        return Err(LayoutError::AngleCount { given: angles.len(), corners: topology.corner_count() });
    }
    let pins = PinnedPair::far_apart(mesh, topology).ok_or(LayoutError::NoBoundary)?;
    let clamped: Vec<f64> =
        angles.par_iter().with_min_len(PER_TASK).map(|x| x.clamp(ANGLE_CLAMP, PI - ANGLE_CLAMP)).collect();
    let clamped_angles = angles.iter().zip(&clamped).filter(|(x, y)| x != y).count();
    let Placed { z, kind, linear, closing_error } = place(topology, &clamped, pins, settings, checkpoint)?;
    checkpoint()?;
    let uv = finish(mesh, &z, pins).ok_or(LayoutError::NotFinite { kind })?;
    Ok(Layout { uv, kind, linear, closing_error, clamped_angles })
}

struct Placed {
    z: Vec<Complex64>,
    kind: LayoutKind,
    linear: Option<LinearStats>,
    closing_error: Option<f64>,
}

fn place(
    topology: &Topology,
    angles: &[f64],
    pins: PinnedPair,
    settings: &LayoutSettings,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Placed, LayoutError> {
    let least_squares = |weighted: bool, closing_error: Option<f64>, checkpoint: &mut Checkpoint<'_>| {
        let kind = if weighted { LayoutKind::LeastSquaresWeighted } else { LayoutKind::LeastSquares };
        let solved = least_squares::place(topology, angles, pins, weighted, checkpoint);
        let (z, stats) = solved.map_err(|source| LayoutError::of_linear(kind, source))?;
        Ok(Placed { z, kind, linear: Some(stats), closing_error })
    };
    let edges = match settings.kind {
        LayoutKind::LeastSquares => return least_squares(false, None, checkpoint),
        LayoutKind::LeastSquaresWeighted => return least_squares(true, None, checkpoint),
        LayoutKind::Auto | LayoutKind::Tree | LayoutKind::Poisson => {
            EdgeVectors::integrate(topology, angles, checkpoint)?
        }
    };
    let closing_error = Some(edges.closing_error);
    match settings.kind {
        LayoutKind::Auto if !(edges.closing_error <= settings.closing_tolerance) => {
            least_squares(false, closing_error, checkpoint)
        }
        LayoutKind::Poisson => {
            let kind = LayoutKind::Poisson;
            let solved = poisson::place(topology, angles, &edges, pins, checkpoint);
            let (z, stats) = solved.map_err(|source| LayoutError::of_linear(kind, source))?;
            Ok(Placed { z, kind, linear: Some(stats), closing_error })
        }
        _ => Ok(Placed { z: edges.place(topology), kind: LayoutKind::Tree, linear: None, closing_error }),
    }
}

/// Moves, turns and scales a drawing that was not laid out here as every layout is: pins on the x-axis, triangles
/// counter-clockwise, the area of the surface. `None` without a boundary, and when a coordinate is not finite.
///
/// All of that rounds: who needs the signs of the smallest triangles looks at them again.
///
/// # Panics
/// If there is not one point per vertex.
#[must_use]
pub fn aligned(mesh: &TriMesh, topology: &Topology, points: &[Point2<f64>]) -> Option<UvMap> {
    assert_eq!(points.len(), mesh.vertex_count(), "one point per vertex");
    let z: Vec<Complex64> = points.iter().map(|p| Complex64::new(p.x, p.y)).collect();
    finish(mesh, &z, PinnedPair::far_apart(mesh, topology)?)
}

/// Moves, turns and scales: pins on the x-axis, triangles counter-clockwise, the area of the
/// surface. `None` when a coordinate is not finite.
fn finish(mesh: &TriMesh, z: &[Complex64], pins: PinnedPair) -> Option<UvMap> {
    let origin = z[pins.origin.index()];
    let axis = z[pins.axis.index()] - origin;
    // Pins that fell on each other fix no direction.
    let turn = if axis.norm() > 0.0 { axis.conj() / axis.norm() } else { Complex64::from(1.0) };
    let turned = |z: &Complex64| {
        let p = (z - origin) * turn;
        Point2::new(p.re, p.im)
    };
    let points: Vec<Point2<f64>> = z.par_iter().with_min_len(PER_TASK).map(turned).collect();
    let map = UvMap::per_vertex(mesh, &points);
    let scale = (mesh.area() / map.area()).sqrt();
    let mirror = if map.signed_area() < 0.0 { -1.0 } else { 1.0 };
    let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
    let map = map.mapped(|p| Point2::new(scale * p.x, mirror * scale * p.y));
    map.points().iter().all(|p| p.x.is_finite() && p.y.is_finite()).then_some(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    fn lay_out(shape: Shape, kind: LayoutKind) -> (TriMesh, Layout) {
        let mesh = shape.mesh(600);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let settings = LayoutSettings { kind, ..LayoutSettings::default() };
        let layout = layout(&mesh, &topology, &mesh.corner_angles(), &settings).expect("a layout");
        (mesh, layout)
    }

    #[test]
    fn every_method_lays_a_developable_sheet_out_isometrically() {
        for kind in LayoutKind::ALL {
            let (mesh, layout) = lay_out(Shape::FoldedSheet, kind);
            for (flat, folded) in layout.uv.triangles().zip(mesh.triangles()) {
                for k in 0..3 {
                    let flat = (flat[(k + 1) % 3] - flat[k]).norm();
                    let folded = (folded[(k + 1) % 3] - folded[k]).norm();
                    assert!((flat - folded).abs() < 1e-9 * folded, "{kind}: {flat} {folded}");
                }
            }
            assert!(layout.uv.signed_area() > 0.0);
        }
    }

    #[test]
    fn auto_takes_the_tree_only_when_the_angles_close() {
        assert_eq!(lay_out(Shape::FoldedSheet, LayoutKind::Auto).1.kind, LayoutKind::Tree);
        let (_, curved) = lay_out(Shape::Hemisphere, LayoutKind::Auto);
        assert_eq!(curved.kind, LayoutKind::LeastSquares);
        assert!(curved.closing_error.expect("integrated") > 1e-3);
    }

    #[test]
    fn the_area_is_kept_and_the_pins_lie_on_the_axis() {
        let (mesh, layout) = lay_out(Shape::Hemisphere, LayoutKind::LeastSquaresWeighted);
        assert!((layout.uv.signed_area() / mesh.area() - 1.0).abs() < 1e-12);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let pins = PinnedPair::far_apart(&mesh, &topology).expect("a boundary");
        let at = |v| layout.uv.corner(topology.fan_start(v).expect("used"));
        assert!(at(pins.origin).coords.norm() < 1e-12);
        assert!(at(pins.axis).y.abs() < 1e-12 && at(pins.axis).x > 0.0);
    }

    #[test]
    fn one_triangle_is_laid_out_by_every_method() {
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [0.5, 1.0, 0.0]].map(abf_mesh::Point3::from);
        let mesh = TriMesh::new(points.to_vec(), &[[0, 1, 2]]).expect("indices in range");
        let topology = Topology::build(3, mesh.faces()).expect("a manifold");
        for kind in LayoutKind::ALL {
            let settings = LayoutSettings { kind, ..LayoutSettings::default() };
            let layout = layout(&mesh, &topology, &mesh.corner_angles(), &settings).expect("a layout");
            assert!((layout.uv.signed_area() / mesh.area() - 1.0).abs() < 1e-12, "{kind}");
        }
    }

    #[test]
    fn names_read_back_and_unknown_ones_list_the_known() {
        for kind in LayoutKind::ALL {
            assert_eq!(kind.name().parse(), Ok(kind));
        }
        assert!("greedy".parse::<LayoutKind>().unwrap_err().known.contains(&"least-squares-weighted"));
    }

    #[test]
    fn angles_outside_the_interval_are_clamped_and_counted() {
        let mesh = Shape::Hemisphere.mesh(100);
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        let mut angles = mesh.corner_angles();
        angles[7] = -0.1;
        angles[8] = 4.0;
        let laid_out = layout(&mesh, &topology, &angles, &LayoutSettings::default()).expect("a layout");
        assert_eq!(laid_out.clamped_angles, 2);
    }
}
