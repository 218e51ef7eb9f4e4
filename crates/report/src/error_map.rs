//! The layout, every triangle coloured by its largest angle error, as a vector drawing.

use std::fmt::Write;

use abf_mesh::{Point2, TriMesh, UvMap};
use abf_metrics::{Orientation, per_face};

use crate::PictureError;
use crate::colour::FLIPPED;
use crate::page::{FINE, quantile, round, round_up};
use crate::panel::bounds;
use crate::scale::ColourScale;
use crate::scene::largest_angle_error;

/// The longer side of the layout in the drawing, and the room around it.
const SIDE: f64 = 1000.0;
const MARGIN: f64 = 20.0;
/// The height of the legend below, and of its bar.
const LEGEND: f64 = 50.0;
const BAR: f64 = 14.0;
/// The scale ends above this share of the triangles; the rest has its last colour.
const SHARE_ON_SCALE: f64 = 0.98;
/// The shortest scale, degrees: errors below are rounding.
const SHORTEST_SCALE_DEG: f64 = 1e-6;
/// Colours from which the bar is blended.
const STOPS: usize = 13;

/// The layout as SVG: `|x − α°|` at the corner of a triangle where it is largest gives its colour, flipped triangles are
/// red, and a legend says which error has which colour.
///
/// # Errors
/// [`PictureError::Input`] for a map that cannot be judged.
pub fn error_svg(mesh: &TriMesh, uv: &UvMap) -> Result<String, PictureError> {
    let faces = per_face(mesh, uv)?;
    let mut errors: Vec<f64> = faces.iter().map(|face| largest_angle_error(face).to_degrees()).collect();
    let (low, high) = bounds(uv.triangles().flatten());
    let extent = (high - low).amax();
    let scale = if extent > 0.0 && extent.is_finite() { SIDE / extent } else { 0.0 };
    let place = |p: &Point2<f64>| [MARGIN + (p.x - low.x) * scale, MARGIN + (high.y - p.y) * scale];
    let size = [0, 1].map(|k| (high - low)[k] * scale + 2.0 * MARGIN);

    let most = quantile(&mut errors.clone(), SHARE_ON_SCALE);
    let limit = round_up(most.max(SHORTEST_SCALE_DEG), FINE);
    let colours = ColourScale::up_to(limit);
    let colour = |k: usize| match faces[k].orientation {
        Orientation::Flipped => hex(FLIPPED),
        Orientation::Kept | Orientation::Collapsed => hex(colours.colour(errors[k]).to_srgb()),
    };
    let mut painted: Vec<(String, usize)> = (0..faces.len()).map(|k| (colour(k), k)).collect();
    painted.sort();
    let triangles: Vec<[Point2<f64>; 3]> = uv.triangles().collect();

    let mut out = String::new();
    let [width, height] = [size[0].max(SIDE / 2.0), size[1] + LEGEND];
    let head = "<svg xmlns=\"http://www.w3.org/2000/svg\"";
    let _ = writeln!(out, "{head} width=\"{width:.2}\" height=\"{height:.2}\" viewBox=\"0 0 {width:.2} {height:.2}\">");
    out.push_str(
        "<title>Largest angle error of each triangle</title>\n<g stroke-width=\"0.2\" stroke-linejoin=\"round\">\n",
    );
    for group in painted.chunk_by(|(one, _), (other, _)| one == other) {
        let _ = write!(out, "<path fill=\"{0}\" stroke=\"{0}\" d=\"", group[0].0);
        for (_, k) in group {
            let [a, b, c] = triangles[*k].each_ref().map(place);
            let _ = write!(out, "M{:.3} {:.3}L{:.3} {:.3}L{:.3} {:.3}Z", a[0], a[1], b[0], b[1], c[0], c[1]);
        }
        out.push_str("\"/>\n");
    }
    out.push_str("</g>\n");
    errors.sort_by(f64::total_cmp);
    let largest = errors.last().copied().unwrap_or(0.0);
    out.push_str(&legend(size[1], limit, largest));
    out.push_str("</svg>\n");
    Ok(out)
}

/// The bar with its ends.
fn legend(top: f64, limit: f64, largest: f64) -> String {
    let stop = |(k, [r, g, b]): (usize, [u8; 3])| {
        format!("<stop offset=\"{:.4}\" stop-color=\"#{r:02x}{g:02x}{b:02x}\"/>", k as f64 / (STOPS - 1) as f64)
    };
    let stops: String = ColourScale::samples(STOPS).into_iter().enumerate().map(stop).collect();
    let width = 0.3 * SIDE;
    let baseline = top + BAR + 18.0;
    format!(
        concat!(
            "<defs><linearGradient id=\"scale\">{}</linearGradient></defs>\n",
            "<rect x=\"{}\" y=\"{:.2}\" width=\"{}\" height=\"{}\" fill=\"url(#scale)\"/>\n",
            "<g font-family=\"sans-serif\" font-size=\"16\">\n<text x=\"{}\" y=\"{:.2}\">0°</text>\n",
            "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"end\">≥ {}°, largest {}°</text>\n</g>\n"
        ),
        stops,
        MARGIN,
        top,
        width,
        BAR,
        MARGIN,
        baseline,
        MARGIN + width,
        baseline,
        round(limit),
        crate::page::significant(largest, 3)
    )
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::Point3;

    fn square(last: [f64; 2]) -> (TriMesh, UvMap) {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let positions = corners.iter().map(|p| Point3::new(p[0], p[1], 0.0)).collect();
        let mesh = TriMesh::new(positions, &[[0, 1, 2], [0, 2, 3]]).expect("indices in range");
        let uv: Vec<Point2<f64>> = corners[..3].iter().chain([&last]).map(|&p| Point2::from(p)).collect();
        (mesh.clone(), UvMap::per_vertex(&mesh, &uv))
    }

    #[test]
    fn every_triangle_is_there_once_and_flipped_ones_are_red() {
        for (last, red) in [([0.0, 1.0], 0), ([0.2, 0.9], 0), ([0.8, 0.1], 1)] {
            let (mesh, uv) = square(last);
            let svg = error_svg(&mesh, &uv).expect("a drawing");
            roxmltree::Document::parse(&svg).expect("SVG");
            assert_eq!(svg.matches('M').count(), 2, "{svg}");
            assert_eq!(svg.matches(&format!("fill=\"{}\"", hex(FLIPPED))).count(), red);
            assert_eq!(svg, error_svg(&mesh, &uv).expect("a drawing"));
        }
    }

    #[test]
    fn a_layout_without_extent_is_drawn_without_panic_and_one_that_is_not_finite_is_refused() {
        let (mesh, uv) = square([0.0, 1.0]);
        assert!(error_svg(&mesh, &uv.clone().mapped(|_| Point2::origin())).is_ok());
        let broken = uv.mapped(|p| Point2::new(p.x, f64::NAN));
        assert!(matches!(error_svg(&mesh, &broken), Err(PictureError::Input(_))));
    }
}
