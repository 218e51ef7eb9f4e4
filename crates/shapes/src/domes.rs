//! Round shapes: hemisphere, mask, bumpy disk, wavy saddle.

use crate::lattice::Rings;
use crate::portable::{exp, sin, sin_cos};
use abf_mesh::{Point3, TriMesh};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The upper half of the unit sphere; ring `k` of `n` lies at the polar angle `k/n · π/2`.
pub(crate) fn hemisphere(triangles: usize) -> TriMesh {
    Rings::sized(triangles).lift(|v| {
        let (cos, sin) = v.direction();
        let (sin_polar, cos_polar) = sin_cos(v.radius * FRAC_PI_2);
        Point3::new(sin_polar * cos, sin_polar * sin, cos_polar)
    })
}

/// A round sheet of radius 1 with many small bumps, for scaling: its shape is the same at every
/// size, so that only the number of unknowns changes.
pub(crate) fn fat_disk(triangles: usize) -> TriMesh {
    Rings::sized(triangles).lift(|v| {
        let (x, y) = v.in_unit_disk();
        let z =
            0.06 * sin(7.0 * x + 1.0) * sin(6.0 * y) + 0.03 * sin(11.0 * x - 5.0 * y) + 0.1 * sin(2.0 * x + 3.0 * y);
        Point3::new(x, y, z)
    })
}

/// A monkey saddle with ripples: `z = 0.3 (x³ − 3xy²) + 0.05 sin 8x sin 8y` over the unit disk.
/// It stands in for the Goldfeather surface of the 2004 paper, whose formula is not given there.
pub(crate) fn wavy_saddle(triangles: usize) -> TriMesh {
    Rings::sized(triangles).lift(|v| {
        let (x, y) = v.in_unit_disk();
        let z = 0.3 * (x * x * x - 3.0 * x * y * y) + 0.05 * sin(8.0 * x) * sin(8.0 * y);
        Point3::new(x, y, z)
    })
}

/// A Gaussian swelling (or hollow) of the mask, towards +z.
struct Feature {
    height: f64,
    centre: [f64; 2],
    width: [f64; 2],
    /// A second one stands at −x.
    paired: bool,
}

impl Feature {
    const fn single(height: f64, y: f64, width: [f64; 2]) -> Self {
        Self { height, centre: [0.0, y], width, paired: false }
    }

    const fn pair(height: f64, centre: [f64; 2], width: [f64; 2]) -> Self {
        Self { height, centre, width, paired: true }
    }

    /// `height · exp(−((x − cx)/wx)² − ((y − cy)/wy)²)`, and its mirror image.
    fn at(&self, x: f64, y: f64) -> f64 {
        let bump = |x: f64| {
            let (dx, dy) = ((x - self.centre[0]) / self.width[0], (y - self.centre[1]) / self.width[1]);
            self.height * exp(-dx * dx - dy * dy)
        };
        if self.paired { bump(x) + bump(-x) } else { bump(x) }
    }
}

/// The face on the mask, from the forehead down.
const FACE: [Feature; 14] = [
    Feature::pair(0.07, [0.27, 0.37], [0.22, 0.09]),   // brows
    Feature::pair(-0.19, [0.29, 0.19], [0.19, 0.13]),  // eye sockets
    Feature::pair(0.15, [0.28, 0.17], [0.12, 0.07]),   // eyes
    Feature::single(0.15, 0.12, [0.08, 0.24]),         // bridge of the nose
    Feature::single(0.17, -0.13, [0.10, 0.12]),        // tip of the nose
    Feature::pair(0.08, [0.11, -0.17], [0.07, 0.07]),  // nostrils
    Feature::pair(0.07, [0.40, -0.10], [0.17, 0.15]),  // cheekbones
    Feature::pair(-0.05, [0.40, -0.42], [0.14, 0.16]), // hollow cheeks
    Feature::single(-0.03, -0.30, [0.05, 0.06]),       // groove above the lips
    Feature::single(0.07, -0.41, [0.20, 0.06]),        // upper lip
    Feature::single(-0.05, -0.48, [0.24, 0.045]),      // mouth
    Feature::single(0.07, -0.55, [0.16, 0.06]),        // lower lip
    Feature::single(0.17, -0.79, [0.18, 0.14]),        // chin
    Feature::pair(-0.05, [0.60, 0.35], [0.12, 0.25]),  // temples
];

/// A mask: a little more than half of an ellipsoid with the features of a face on it.
pub(crate) fn mask(triangles: usize) -> TriMesh {
    const HALF_AXES: [f64; 3] = [0.78, 1.05, 0.62];
    /// The rim lies a little behind the equator.
    const RIM_POLAR_ANGLE: f64 = 98.0 * TAU / 360.0;
    Rings::sized(triangles).lift(|v| {
        let (cos, sin) = v.direction();
        let (sin_polar, cos_polar) = sin_cos(v.radius * RIM_POLAR_ANGLE);
        let (x, y) = (HALF_AXES[0] * sin_polar * cos, HALF_AXES[1] * sin_polar * sin);
        let relief: f64 = FACE.iter().map(|feature| feature.at(x, y)).sum();
        // The relief fades out smoothly towards the equator, where z runs along the surface.
        let fade = 1.0 - (sin_polar * sin_polar) * (sin_polar * sin_polar);
        Point3::new(x, y, HALF_AXES[2] * cos_polar + relief * fade)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hemisphere_lies_on_the_unit_sphere() {
        let mesh = hemisphere(600);
        assert!(mesh.positions().iter().all(|p| (p.coords.norm() - 1.0).abs() < 1e-8));
        assert!((hemisphere(20_000).area() / TAU - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_mask_is_symmetric_left_and_right() {
        let mesh = mask(600);
        let has = |x: f64, y: f64| mesh.positions().iter().any(|p| (p.x - x).abs() < 1e-8 && (p.y - y).abs() < 1e-8);
        assert!(mesh.positions().iter().all(|p| has(-p.x, p.y)));
    }

    #[test]
    fn the_default_mask_has_about_twenty_thousand_triangles() {
        assert_eq!(mask(20_000).face_count(), 20_184);
    }
}
