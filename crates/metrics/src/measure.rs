//! One map in a few numbers.

use abf_mesh::{FaceId, TriMesh, UvMap};
use serde::{Serialize, Serializer};

use crate::MetricsError;
use crate::face::{FaceDistortion, Orientation, Survey};

/// How valid and how distorted a UV map is.
///
/// No figure but [`uv_area`](Self::uv_area) changes when the UVs are moved, turned, mirrored or
/// scaled uniformly. Symbols are those of the [crate documentation](crate); "judged" faces are those
/// that have an area in 3-D, that is all but [`degenerate_3d`](Self::degenerate_3d) of them.
///
/// The distortion of a map with a collapsed or nearly collapsed triangle is infinite. JSON has no
/// infinity: `serde_json` writes `null` there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Metrics {
    /// How many triangles there are.
    pub triangles: usize,
    /// How many charts: connected components of the UV points, where a face connects its three.
    pub charts: usize,
    /// Triangles whose exact orientation is opposite to the area-weighted majority of their chart,
    /// however small they are. A chart that is mirrored as a whole has none.
    pub flips: usize,
    /// Triangles whose three UVs lie on one line, exactly.
    pub collapsed: usize,
    /// Triangles on the right side by their exact orientation, but with an area
    /// `A₂ ≤ 4 ε · max |coordinate| · (|e₁| + |e₂|)` that the rounding of the stored coordinates
    /// could have made: valid as they are, but not after the next rounding.
    pub near_collapsed: usize,
    /// Triangles without an area in 3-D, `A₃ ≤ 1e-14 ΣA₃`. They are left out of every distortion
    /// below, but not out of the counts above.
    pub degenerate_3d: usize,
    /// The angle error `F / 3nt = Σ (x − α°)² / (3 nt)` over the corners of the nt judged faces,
    /// rad² (as reported by Zayer, Lévy, Seidel 2007).
    pub f: f64,
    /// The relative angle error `Σ ((x − α°) / α°)² / (3 nt)` over the same corners, no unit: the
    /// energy of ABF (Sheffer, de Sturler 2001) divided by its number of terms.
    pub f_weighted: f64,
    /// The largest `|x − α°|`, in radians.
    pub max_angle_error: f64,
    /// L² stretch `√(Σ ½(s₁² + s₂²) A₃ / ΣA₃) · √(ΣA₂ / ΣA₃)`, no unit, 1 for an isometry
    /// (Sander et al. 2001). A flipped triangle enters with its singular values; Sander's own rule
    /// would make it infinite, but here [`flips`](Self::flips) says so.
    pub stretch_l2: f64,
    /// L∞ stretch `max s₁ · √(ΣA₂ / ΣA₃)`, no unit, 1 for an isometry (Sander et al. 2001).
    pub stretch_linf: f64,
    /// Quasi-conformal distortion `s₁ / s₂`, mean weighted by A₃, no unit, 1 for a conformal map.
    pub qc_mean: f64,
    /// The largest `s₁ / s₂`.
    pub qc_max: f64,
    /// Area distortion `√(Σ ln²((A₂ / A₃) / (ΣA₂ / ΣA₃)) A₃ / ΣA₃)`, no unit, 0 where areas keep
    /// their proportions.
    pub area_l2: f64,
    /// ΣA₂, the area of all UV triangles without sign, in UV units squared.
    pub uv_area: f64,
    /// ΣA₃, the area of the surface, in mesh units squared.
    pub surface_area: f64,
    /// The first flipped faces, at most [`LISTED`](Self::LISTED) of them.
    #[serde(serialize_with = "as_indices")]
    pub flipped_faces: Vec<FaceId>,
    /// The first collapsed faces, at most [`LISTED`](Self::LISTED) of them.
    #[serde(serialize_with = "as_indices")]
    pub collapsed_faces: Vec<FaceId>,
}

impl Metrics {
    /// How many offending faces are listed by name.
    pub const LISTED: usize = 10;

    /// Whether no triangle is flipped and none collapsed.
    ///
    /// Where charts overlap, or one chart overlaps itself without a flip, is not asked.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.flips == 0 && self.collapsed == 0
    }
}

/// Measures a UV map against its mesh.
///
/// Takes time linear in the number of faces and gives the same bits every time. Corners are joined
/// where they share a UV point, and where they are the same vertex at the same place in the plane.
///
/// # Errors
/// [`MetricsError`] when there is nothing to compare: no faces, no area in 3-D, coordinates that
/// are not finite, a UV map of another mesh. A UV map without any area is a result, not an error.
pub fn measure(mesh: &TriMesh, uv: &UvMap) -> Result<Metrics, MetricsError> {
    let survey = Survey::new(mesh, uv)?;
    let mut sums = Sums::default();
    survey.by_block(Sums::take).iter().for_each(|block| sums.merge(block));
    let corners = 3.0 * (mesh.face_count() - sums.degenerate_3d) as f64;
    Ok(Metrics {
        triangles: mesh.face_count(),
        charts: survey.chart_count(),
        flips: sums.flips,
        collapsed: sums.collapsed,
        near_collapsed: sums.near_collapsed,
        degenerate_3d: sums.degenerate_3d,
        f: sums.squared_error / corners,
        f_weighted: sums.squared_relative_error / corners,
        max_angle_error: sums.max_angle_error,
        stretch_l2: (sums.squared_stretch / sums.surface).sqrt(),
        stretch_linf: sums.max_stretch,
        qc_mean: sums.quasi_conformal / sums.surface,
        qc_max: sums.max_quasi_conformal,
        area_l2: (sums.squared_log_area / sums.surface).sqrt(),
        uv_area: survey.uv_area(),
        surface_area: survey.surface_area(),
        flipped_faces: sums.flipped_faces,
        collapsed_faces: sums.collapsed_faces,
    })
}

/// Running counts, sums and maxima over the faces.
#[derive(Default)]
struct Sums {
    flips: usize,
    flipped_faces: Vec<FaceId>,
    collapsed: usize,
    collapsed_faces: Vec<FaceId>,
    near_collapsed: usize,
    degenerate_3d: usize,
    squared_error: f64,
    squared_relative_error: f64,
    max_angle_error: f64,
    /// The weight of the means below: the share of the surface that is judged.
    surface: f64,
    squared_stretch: f64,
    max_stretch: f64,
    quasi_conformal: f64,
    max_quasi_conformal: f64,
    squared_log_area: f64,
}

impl Sums {
    /// Takes one face in.
    fn take(&mut self, id: FaceId, face: &FaceDistortion) {
        self.count(id, face);
        if face.degenerate_3d {
            self.degenerate_3d += 1;
        } else {
            self.add(face);
        }
    }

    /// Takes the sums over later faces in.
    fn merge(&mut self, later: &Self) {
        merge_noted(&mut self.flips, &mut self.flipped_faces, later.flips, &later.flipped_faces);
        merge_noted(&mut self.collapsed, &mut self.collapsed_faces, later.collapsed, &later.collapsed_faces);
        self.near_collapsed += later.near_collapsed;
        self.degenerate_3d += later.degenerate_3d;
        self.squared_error += later.squared_error;
        self.squared_relative_error += later.squared_relative_error;
        self.max_angle_error = self.max_angle_error.max(later.max_angle_error);
        self.surface += later.surface;
        self.squared_stretch += later.squared_stretch;
        self.max_stretch = self.max_stretch.max(later.max_stretch);
        self.quasi_conformal += later.quasi_conformal;
        self.max_quasi_conformal = self.max_quasi_conformal.max(later.max_quasi_conformal);
        self.squared_log_area += later.squared_log_area;
    }

    /// Takes note of how a face lies.
    fn count(&mut self, id: FaceId, face: &FaceDistortion) {
        match face.orientation {
            Orientation::Flipped => note(&mut self.flips, &mut self.flipped_faces, id),
            Orientation::Collapsed => note(&mut self.collapsed, &mut self.collapsed_faces, id),
            Orientation::Kept if face.within_rounding => self.near_collapsed += 1,
            Orientation::Kept => {}
        }
    }

    /// Adds the distortion of a judged face.
    fn add(&mut self, face: &FaceDistortion) {
        /// No angle is taken for less when an error is divided by it, in radians.
        const SMALLEST_ANGLE: f64 = 1e-12;
        for (error, angle) in face.angle_errors().into_iter().zip(face.mesh_angles) {
            self.squared_error += error.powi(2);
            self.squared_relative_error += (error / angle.max(SMALLEST_ANGLE)).powi(2);
            self.max_angle_error = self.max_angle_error.max(error.abs());
        }
        let weight = face.surface_share;
        self.surface += weight;
        self.squared_stretch += weight * face.stretch_l2.powi(2);
        self.max_stretch = self.max_stretch.max(face.stretch_linf);
        self.quasi_conformal += weight * face.quasi_conformal;
        self.max_quasi_conformal = self.max_quasi_conformal.max(face.quasi_conformal);
        self.squared_log_area += weight * face.area_ratio.ln().powi(2);
    }
}

/// Counts a face, and lists it while there is room.
fn note(count: &mut usize, listed: &mut Vec<FaceId>, face: FaceId) {
    *count += 1;
    if listed.len() < Metrics::LISTED {
        listed.push(face);
    }
}

/// Adds the count of later faces, and lists them while there is room.
fn merge_noted(count: &mut usize, listed: &mut Vec<FaceId>, later: usize, later_listed: &[FaceId]) {
    *count += later;
    listed.extend(later_listed.iter().take(Metrics::LISTED - listed.len()));
}

fn as_indices<S: Serializer>(faces: &[FaceId], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(faces.iter().map(|face| face.index()))
}
