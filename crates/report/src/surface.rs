//! The left panel: the surface in space, textured through its UVs.

use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, FaceId, Point2, Point3, TriMesh, UvMap, Vector2, Vector3, VertexId};
use std::collections::HashSet;
use tiny_skia::Pixmap;

use crate::camera::Camera;
use crate::colour::{Colour, Palette};
use crate::panel::{Panel, bounds};
use crate::raster::{Barycentric, Visibility};
use crate::skin::Skin;

/// The number under which lines are drawn; no face has it, as its corners would not fit 32 bits.
const LINE: u32 = u32::MAX - 1;
/// Lines lie this much nearer to the viewer than the surface they are on, in half widths.
const LIFT: f64 = 3.0;
/// Where the light comes from, in the camera's frame: over the viewer's left shoulder.
const LIGHT: [f64; 3] = [-0.35, 0.55, 0.75];
/// A corner whose vertex normal leaves the face normal by more (cosine of 35°) is at a crease.
const CREASE: f64 = 0.82;

/// What the panel shows.
#[derive(Clone, Copy)]
pub(crate) struct Surface<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) uv: &'a UvMap,
    pub(crate) camera: &'a Camera,
    pub(crate) skin: &'a Skin<'a>,
    /// For every face whether the layout has it upside down.
    pub(crate) flipped: &'a [bool],
    /// Boundary and seams.
    pub(crate) outline: &'a [CornerId],
}

impl Surface<'_> {
    /// Draws the surface into its panel; `line_width` is in pixels.
    pub(crate) fn draw(
        &self,
        canvas: &mut Pixmap,
        panel: &Panel,
        palette: &Palette,
        line_width: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<(), Cancelled> {
        let screen = self.on_screen(panel);
        let seen = self.visibility(panel, &screen, panel.length(0.5 * line_width), checkpoint)?;
        let normals = vertex_normals(self.mesh, &screen);
        let light = Vector3::from(LIGHT).normalize();
        let mut texture = Cached { face: LINE, texture: None };
        panel.resolve(canvas, palette.background, &seen, checkpoint, |item, at| {
            if item == LINE {
                return palette.ink;
            }
            let texture = texture.get(item, || self.texture(FaceId::new(item as usize), &screen, &normals));
            texture.map_or(palette.back, |t| t.colour(at, self.skin, palette, &light))
        })
    }

    /// Every vertex in the panel: samples to the right, up, and towards the viewer.
    fn on_screen(&self, panel: &Panel) -> Vec<Point3<f64>> {
        let used = self.mesh.triangles().flatten().map(|p| self.camera.project(&p).xy());
        let fit = panel.fit(bounds(used));
        let project = |p: &Point3<f64>| {
            let p = self.camera.project(p);
            let at = fit.apply(p.xy());
            Point3::new(at.x, at.y, p.z * fit.scale)
        };
        self.mesh.positions().iter().map(project).collect()
    }

    /// What is seen at every sample: a face or a line. Of faces in one place the first is drawn, and of lines; the nearest
    /// faces come first, because they hide others.
    fn visibility(
        &self,
        panel: &Panel,
        screen: &[Point3<f64>],
        half_width: f64,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Visibility, Cancelled> {
        let mut seen = panel.grid();
        let nearest = |(face, vertices): (usize, &[VertexId; 3])| {
            let [a, b, c] = vertices.map(|v| screen[v.index()].z);
            (a.max(b).max(c), face)
        };
        let mut order: Vec<(f64, usize)> = self.mesh.faces().iter().enumerate().map(nearest).collect();
        order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut drawn = HashSet::with_capacity(order.len());
        for (_, face) in order {
            checkpoint()?;
            let corners = self.mesh.faces()[face].map(|v| screen[v.index()]);
            if drawn.insert(place(corners)) {
                seen.triangle(&corners, face as u32);
            }
        }
        let mut drawn = HashSet::with_capacity(self.outline.len());
        for &corner in self.outline {
            checkpoint()?;
            let vertices = self.mesh.faces()[corner.face().index()];
            let [from, to] = [corner, corner.next()].map(|c| {
                let p = screen[vertices[c.place()].index()];
                Point3::new(p.x, p.y, p.z + LIFT * half_width)
            });
            if drawn.insert(place([from, to])) {
                seen.line(from, to, half_width, LINE);
            }
        }
        Ok(seen)
    }

    /// How one face is coloured; `None` if it is seen exactly from the side.
    fn texture(&self, face: FaceId, screen: &[Point3<f64>], normals: &[Vector3<f64>]) -> Option<Texture> {
        let vertices = self.mesh.faces()[face.index()];
        let corners = vertices.map(|v| screen[v.index()]);
        let inside = Barycentric::new(&corners.map(|p| p.xy()))?;
        let flat = normal(&corners).try_normalize(0.0)?;
        let uv = self.uv.triangle(face);
        Some(Texture {
            face: face.index() as u32,
            inside,
            uv,
            footprint: Vector2::new(inside.change(uv.map(|p| p.x)), inside.change(uv.map(|p| p.y))),
            normals: vertices.map(|v| Some(normals[v.index()]).filter(|n| n.dot(&flat) > CREASE).unwrap_or(flat)),
            front: flat.z > 0.0,
            flipped: self.flipped[face.index()],
        })
    }
}

/// What is the same for everything with the same corners.
fn place<const N: usize>(corners: [Point3<f64>; N]) -> [[u64; 3]; N] {
    // Adding zero makes −0 and +0 the same bits.
    let mut bits = corners.map(|p| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits()));
    bits.sort_unstable();
    bits
}

/// The texture of the face asked for last: neighbouring samples mostly see the same one.
struct Cached {
    face: u32,
    texture: Option<Texture>,
}

impl Cached {
    fn get(&mut self, face: u32, make: impl FnOnce() -> Option<Texture>) -> Option<&Texture> {
        if self.face != face {
            *self = Self { face, texture: make() };
        }
        self.texture.as_ref()
    }
}

/// Everything that colours the samples of one face.
struct Texture {
    face: u32,
    inside: Barycentric,
    uv: [Point2<f64>; 3],
    /// The extent in the UV plane of one sample.
    footprint: Vector2<f64>,
    normals: [Vector3<f64>; 3],
    front: bool,
    flipped: bool,
}

impl Texture {
    /// The colour of the face at one sample.
    ///
    /// The camera is orthographic, so what is linear on the face is linear in the picture.
    fn colour(&self, at: Point2<f64>, skin: &Skin<'_>, palette: &Palette, light: &Vector3<f64>) -> Colour {
        let [a, b, c] = self.inside.weights(at);
        let [p, q, r] = self.uv.map(|p| p.coords);
        let uv = Point2::from(a * p + b * q + c * r);
        let paint = match (self.front, self.flipped) {
            (true, false) => skin.front(self.face, uv, self.footprint),
            (true, true) => palette.flipped,
            (false, _) => skin.back(self.face, uv, self.footprint, palette),
        };
        let [l, m, n] = self.normals;
        let normal = (a * l + b * m + c * n).try_normalize(0.0).unwrap_or(l);
        // Both sides are lit as if they were the outer one.
        let normal = if self.front { normal } else { -normal };
        paint * (skin.ambient() + (1.0 - skin.ambient()) * normal.dot(light).max(0.0))
    }
}

/// The unit normal of every vertex, its faces weighted by area.
fn vertex_normals(mesh: &TriMesh, screen: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); screen.len()];
    for vertices in mesh.faces() {
        let normal = normal(&vertices.map(|v| screen[v.index()]));
        vertices.iter().for_each(|v| normals[v.index()] += normal);
    }
    normals.iter_mut().for_each(|n| *n = n.try_normalize(0.0).unwrap_or_default());
    normals
}

/// The normal of a triangle, as long as twice its area.
fn normal([a, b, c]: &[Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}
