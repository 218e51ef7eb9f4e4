//! The pictures of one mesh: its best layout twice, and every layout small.

use abf_mesh::{TriMesh, UvMap};
use tiny_skia::Pixmap;

use super::embed::data_uri;
use super::html::{Html, escape};
use super::judge::{Judgement, in_words, validity};
use super::number::{FINE, quantile, round, round_up, significant};
use crate::PictureError;
use crate::camera::View;
use crate::checker::Checker;
use crate::colour::{Colour, Palette};
use crate::panel::{Panel, bounds};
use crate::scale::ColourScale;
use crate::scene::Scene;
use crate::skin::Skin;

/// Width and height of a picture with surface and layout, pixels: twice the place it has on a page
/// of usual width, almost.
const LARGE: [u32; 2] = [960, 480];
/// Width and height of a small layout, pixels.
const SMALL: [u32; 2] = [240, 200];
/// Samples along each side of a pixel.
const SUPERSAMPLING: u32 = 3;
/// Squares along the longer side of a layout.
const CHECKS: u32 = 24;
/// Lines on large and on small pictures, pixels.
const LINE: f64 = 1.6;
const THIN_LINE: f64 = 0.8;
/// The scale of colours ends above this share of the triangles; the rest has its last colour.
const SHARE_ON_SCALE: f64 = 0.98;
/// The shortest scale, degrees: errors below are rounding.
const SHORTEST_SCALE_DEG: f64 = 1e-6;

/// All pictures of a section, as markup; nothing if there is no layout.
pub(crate) fn pictures(judgement: &Judgement<'_>) -> String {
    let (Some(mesh), Some(best)) = (judgement.section.mesh, judgement.best) else { return String::new() };
    let Some(uv) = judgement.section.runs[best].uv else { return String::new() };
    figures(judgement, mesh, uv, best).unwrap_or_else(|e| {
        let mut html = Html::default();
        html.element("p", "class=\"note\"", &format!("No picture: {e}."));
        html.finish()
    })
}

fn figures(judgement: &Judgement<'_>, mesh: &TriMesh, uv: &UvMap, best: usize) -> Result<String, PictureError> {
    let scene = Scene::new(mesh, uv, &View::Auto, LINE)?;
    let spread = Spread::of(&scene);
    let mut html = Html::default();
    html.raw("<div class=\"figures\">\n");
    html.raw(&checkered(&scene, uv, judgement, best)?);
    html.raw(&coloured(&scene, &spread, judgement, best)?);
    html.raw("</div>\n");
    html.raw(&small_layouts(judgement, mesh, &spread));
    Ok(html.finish())
}

/// How large the angle errors of the triangles are, degrees.
struct Spread {
    median: f64,
    most: f64,
    largest: f64,
    /// Where the scale ends.
    limit: f64,
}

impl Spread {
    fn of(scene: &Scene<'_>) -> Self {
        let mut errors: Vec<f64> = scene.angle_errors().iter().map(|e| e.to_degrees()).collect();
        let [median, most, largest] = [0.5, SHARE_ON_SCALE, 1.0].map(|share| quantile(&mut errors, share));
        Self { median, most, largest, limit: round_up(most.max(SHORTEST_SCALE_DEG), FINE) }
    }
}

/// Surface and layout with a checkerboard.
fn checkered(scene: &Scene<'_>, uv: &UvMap, judgement: &Judgement<'_>, run: usize) -> Result<String, PictureError> {
    let checker = Checker::over(bounds(uv.triangles().flatten()), CHECKS);
    let (name, label) = (judgement.section.name, &judgement.labels[run]);
    let figures = judgement.metrics(run).map(in_words).unwrap_or_default();
    let alt = format!("The surface of {name} and its layout by {label} with the same checkerboard: {figures}.");
    let caption = "Squares of one size are kept areas, right angles kept angles. \
                   The hue drifts, so that a place can be found on both sides.";
    Ok(figure(pair(scene, &Skin::Checker(&checker))?, LARGE, &alt, &format!("<p>{caption}</p>")))
}

/// Surface and layout coloured by the angle error of every triangle.
fn coloured(scene: &Scene<'_>, spread: &Spread, judgement: &Judgement<'_>, run: usize) -> Result<String, PictureError> {
    let colours = face_colours(scene, spread);
    let [median, most, largest] = [spread.median, spread.most, spread.largest].map(|x| significant(x, 3));
    let numbers = format!("median {median}°, 98 % below {most}°, largest {largest}°");
    let name = judgement.section.name;
    let alt =
        format!("The same surface and layout of {name}, each triangle coloured by its largest angle error: {numbers}.");
    let flips = judgement.metrics(run).map_or(0, |m| m.certificate.flips);
    let caption = format!("{}<p>Largest angle error of each triangle: {numbers}.</p>", legend(spread, flips));
    Ok(figure(pair(scene, &Skin::Faces(&colours))?, LARGE, &alt, &caption))
}

/// What the colours mean.
fn legend(spread: &Spread, flips: usize) -> String {
    let flipped = if flips > 0 { "<span class=\"swatch\"></span><span>flipped</span>" } else { "" };
    format!(
        "<p class=\"legend\"><span>0°</span><span class=\"bar\"></span><span>≥ {}°</span>{flipped}</p>",
        round(spread.limit)
    )
}

/// Every layout, small, coloured on the scale of the best one.
fn small_layouts(judgement: &Judgement<'_>, mesh: &TriMesh, spread: &Spread) -> String {
    let mut html = Html::default();
    html.raw(
        "<h3>Layouts of all runs</h3>\n<p>Coloured by angle error on the scale above.</p>\n<ul class=\"small\">\n",
    );
    for (k, run) in judgement.section.runs.iter().enumerate() {
        let Some(uv) = run.uv else { continue };
        html.raw("<li>");
        match small_layout(mesh, uv, spread) {
            Ok(canvas) => html.raw(&small_figure(canvas, judgement, k)),
            Err(e) => html.element("p", "class=\"note\"", &format!("{}: no picture: {e}", judgement.labels[k])),
        }
        html.raw("</li>\n");
    }
    html.raw("</ul>\n");
    html.finish()
}

fn small_layout(mesh: &TriMesh, uv: &UvMap, spread: &Spread) -> Result<Pixmap, PictureError> {
    let scene = Scene::new(mesh, uv, &View::Auto, THIN_LINE)?;
    let colours = face_colours(&scene, spread);
    let mut canvas = transparent(SMALL);
    let panel = Panel { left: 0, width: SMALL[0], height: SMALL[1], samples: SUPERSAMPLING };
    scene.draw_layout(&mut canvas, &panel, &Skin::Faces(&colours), &Palette::on(None), &mut || Ok(()))?;
    Ok(canvas)
}

/// A small layout with its solver's name and figures.
fn small_figure(canvas: Pixmap, judgement: &Judgement<'_>, run: usize) -> String {
    let (name, label) = (judgement.section.name, &judgement.labels[run]);
    let metrics = judgement.metrics(run);
    let figures = metrics.map_or_else(|| "not judged".to_owned(), in_words);
    let alt = format!("The layout of {name} by {label}: {figures}.");
    let short = metrics.map_or_else(|| "failed".to_owned(), |m| format!("F {}, {}", significant(m.f, 3), validity(m)));
    let caption = format!("<strong>{}</strong> <span>{}</span>", escape(label), escape(&short));
    figure(canvas, SMALL, &alt, &caption)
}

/// The colour of every face.
fn face_colours(scene: &Scene<'_>, spread: &Spread) -> Vec<Colour> {
    let scale = ColourScale::up_to(spread.limit);
    scene.angle_errors().iter().map(|error| scale.colour(error.to_degrees())).collect()
}

/// The surface on the left, the layout on the right.
fn pair(scene: &Scene<'_>, skin: &Skin<'_>) -> Result<Pixmap, PictureError> {
    let [width, height] = LARGE;
    let mut canvas = transparent(LARGE);
    let panel = |left| Panel { left, width: width / 2, height, samples: SUPERSAMPLING };
    // Without a background the page shines through, be it light or dark.
    let palette = Palette::on(None);
    scene.draw_surface(&mut canvas, &panel(0), skin, &palette, &mut || Ok(()))?;
    scene.draw_layout(&mut canvas, &panel(width / 2), skin, &palette, &mut || Ok(()))?;
    Ok(canvas)
}

fn transparent([width, height]: [u32; 2]) -> Pixmap {
    Pixmap::new(width, height).expect("a canvas of constant size that is not empty")
}

/// A picture with its caption, which is markup.
fn figure(canvas: Pixmap, [width, height]: [u32; 2], alt: &str, caption: &str) -> String {
    let image = match data_uri(canvas) {
        Some(uri) => {
            format!(
                "<img src=\"{uri}\" width=\"{width}\" height=\"{height}\" loading=\"lazy\" alt=\"{}\">",
                escape(alt)
            )
        }
        None => format!("<p class=\"note\">{}</p>", escape(alt)),
    };
    format!("<figure>{image}<figcaption>{caption}</figcaption></figure>\n")
}
