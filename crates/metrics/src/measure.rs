//! One map in a few numbers.

use abf_mesh::{TriMesh, UvMap};

use crate::certificate::of_survey;
use crate::face::{FaceDistortion, Survey};
use crate::{Certificate, MetricsError, Precision};

/// How valid and how distorted a UV map is.
///
/// No figure but [`uv_area`](Self::uv_area) changes when the UVs are moved, turned, mirrored or
/// scaled uniformly. Symbols are those of the [crate documentation](crate); "judged" faces are those
/// that have an area in 3-D, that is all but [`degenerate_3d`](Self::degenerate_3d) of them.
///
/// The distortion of a map with a collapsed or nearly collapsed triangle is infinite. JSON has no
/// infinity: `serde_json` writes `null` there.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Metrics {
    /// How many triangles there are.
    pub triangles: usize,
    /// Triangles without an area in 3-D, `A₃ ≤ 1e-14 ΣA₃` over their component. They are left out of every distortion
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
    /// would make it infinite, but here [`flips`](Certificate::flips) says so.
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
    /// What is proved of the map: the counts of flipped and collapsed triangles, of overlaps and so on.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub certificate: Certificate,
}

impl Metrics {
    /// How many offenders of each kind are listed by name.
    pub const LISTED: usize = Certificate::LISTED;

    /// Whether the map is locally one to one: [`Certificate::valid`].
    #[must_use]
    pub fn valid(&self) -> bool {
        self.certificate.valid()
    }

    /// Whether the map is one to one: [`Certificate::injective`].
    #[must_use]
    pub fn injective(&self) -> bool {
        self.certificate.injective()
    }
}

/// Measures a UV map against its mesh.
///
/// Takes the time of [`certify`](crate::certify) and gives the same bits every time. Corners are joined
/// where they share a UV point, and where they are the same vertex at the same place in the plane.
///
/// # Errors
/// [`MetricsError`] when there is nothing to compare: no faces, no area in 3-D, coordinates that
/// are not finite, a UV map of another mesh. A UV map without any area is a result, not an error.
pub fn measure(mesh: &TriMesh, uv: &UvMap) -> Result<Metrics, MetricsError> {
    let survey = Survey::new(mesh, uv)?;
    let certificate = of_survey(&survey, None, Precision::default(), &mut || Ok(()))?;
    Ok(summed_up(&survey, certificate))
}

/// The same for a map that has been certified before.
///
/// # Errors
/// As for [`measure`].
pub fn measure_certified(mesh: &TriMesh, uv: &UvMap, certificate: Certificate) -> Result<Metrics, MetricsError> {
    // What has been found to be one chart need not be taken apart again.
    let survey = if certificate.charts == 1 { Survey::of_one_chart(mesh, uv) } else { Survey::new(mesh, uv) };
    Ok(summed_up(&survey?, certificate))
}

fn summed_up(survey: &Survey<'_>, certificate: Certificate) -> Metrics {
    let mut sums = Sums::default();
    survey.by_block(|sums: &mut Sums, face| sums.take(&survey.face(face))).iter().for_each(|block| sums.merge(block));
    let triangles = survey.mesh().face_count();
    let corners = 3.0 * (triangles - sums.degenerate_3d) as f64;
    Metrics {
        triangles,
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
        certificate,
    }
}

/// Running counts, sums and maxima over the faces.
#[derive(Default)]
struct Sums {
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
    fn take(&mut self, face: &FaceDistortion) {
        if face.degenerate_3d {
            self.degenerate_3d += 1;
        } else {
            self.add(face);
        }
    }

    /// Takes the sums over later faces in.
    fn merge(&mut self, later: &Self) {
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
