//! The triangles of a document: primitives as they are stored, and all of them as one welded surface.

use std::collections::HashMap;
use std::ops::Range;

use super::super::error::ReadError;
use super::super::{MeshFile, ReadNotes, UvDropped};
use super::GltfDocument;
use super::accessor::{Accessor, Component, OWN};
use super::json::Item;
use super::place::{GltfPlace, Places};
use crate::{Point2, Point3, TriMesh, UvId, UvMap, VertexId};

/// What a primitive is made of (section 3.7.2.1).
const MODES: [&str; 7] = ["points", "lines", "line loop", "line strip", "triangles", "triangle strip", "triangle fan"];
pub(super) const TRIANGLES: usize = 4;
const STRIP: usize = 5;
const FAN: usize = 6;

/// A primitive of triangles, as stored: vertices are split wherever an attribute differs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GltfPrimitive {
    /// The mesh it belongs to, counted from 0.
    pub mesh: usize,
    /// Its number in that mesh, counted from 0: points and lines count too, though they are in no list of these.
    pub primitive: usize,
    /// The name of the mesh.
    pub mesh_name: Option<String>,
    /// Its material, counted from 0.
    pub material: Option<usize>,
    /// The name of the material.
    pub material_name: Option<String>,
    /// The vertices.
    pub positions: Vec<Point3<f64>>,
    /// The triangles; strips and fans are taken apart, with the triangles of strips that only turn it left out.
    pub triangles: Vec<[u32; 3]>,
    /// The numbers `n` of its `TEXCOORD_n`, in ascending order.
    pub texcoords: Vec<u32>,
}

/// All triangles of a document as one mesh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GltfSurface {
    /// The surface: the vertices of each mesh welded by exact position, without those that no triangle uses.
    pub mesh: TriMesh,
    /// The UVs, if every primitive has the set.
    pub uv: Option<UvMap>,
    /// The number `n` of the `TEXCOORD_n` that they are.
    pub set: u32,
    /// What was done to get there.
    pub notes: ReadNotes,
    /// The primitives it consists of.
    pub primitives: Vec<GltfPrimitive>,
    /// For every primitive its faces, which follow each other.
    pub faces: Vec<Range<usize>>,
    /// For every primitive where its mesh is in the scene.
    pub places: Vec<GltfPlace>,
    /// For every corner the vertex of its primitive.
    pub vertices: Vec<u32>,
}

impl GltfSurface {
    /// For every face its primitive, as an index into [`Self::primitives`].
    #[must_use]
    pub fn primitive_of_faces(&self) -> Vec<u32> {
        self.label(|p, _| p)
    }

    /// For every face its mesh, counted from 0.
    #[must_use]
    pub fn mesh_of_faces(&self) -> Vec<u32> {
        self.label(|_, primitive| primitive.mesh)
    }

    /// For every face its material, and 0 for none: material `m` is `m + 1`.
    #[must_use]
    pub fn material_of_faces(&self) -> Vec<u32> {
        self.label(|_, primitive| primitive.material.map_or(0, |material| material + 1))
    }

    fn label(&self, label: impl Fn(usize, &GltfPrimitive) -> usize) -> Vec<u32> {
        let all = self.primitives.iter().zip(&self.faces).enumerate();
        // Labels are indices of things that are in memory, or of materials beyond reason.
        let one = |(p, (primitive, faces)): (usize, (&GltfPrimitive, &Range<usize>))| {
            std::iter::repeat_n(u32::try_from(label(p, primitive)).unwrap_or(u32::MAX), faces.len())
        };
        all.flat_map(one).collect()
    }
}

/// A primitive of triangles in the document.
pub(super) struct Found<'a> {
    pub(super) mesh: usize,
    pub(super) primitive: usize,
    mesh_item: Item<'a>,
    pub(super) item: Item<'a>,
    pub(super) attributes: Item<'a>,
    pub(super) mode: usize,
}

impl GltfDocument {
    /// All primitives of triangles, mesh by mesh; points and lines are left out.
    ///
    /// # Errors
    /// A [`ReadError`] with the place in the document.
    pub fn primitives(&self) -> Result<Vec<GltfPrimitive>, ReadError> {
        let mut notes = ReadNotes::default();
        self.found(&mut notes)?.iter().map(|found| self.primitive(found, &mut notes)).collect()
    }

    /// The surface with the UVs of the set that [`Self::set_uvs`] wrote last, or else of `TEXCOORD_0`.
    ///
    /// # Errors
    /// As [`Self::surface_with_set`].
    pub fn surface(&self) -> Result<GltfSurface, ReadError> {
        self.surface_with(None)
    }

    /// All triangles as one mesh, with the UVs of `TEXCOORD_set` if every primitive has it.
    ///
    /// # Errors
    /// A [`ReadError`] with the place in the document; [`ReadError::NoFaces`] where there is no triangle.
    pub fn surface_with_set(&self, set: u32) -> Result<GltfSurface, ReadError> {
        self.surface_with(Some(set))
    }

    fn surface_with(&self, set: Option<u32>) -> Result<GltfSurface, ReadError> {
        let mut notes = ReadNotes::default();
        let found = self.found(&mut notes)?;
        let primitives: Vec<_> =
            found.iter().map(|found| self.primitive(found, &mut notes)).collect::<Result<_, _>>()?;
        let corners = primitives.iter().map(|p| 3 * p.triangles.len()).sum();
        if corners > u32::MAX as usize {
            return Err(ReadError::TooLarge { file: self.file.clone(), what: "corners", count: corners });
        }
        let Places { of_primitives: places, said } = self.places(&primitives)?;
        notes.scene = said;
        let welded = Welded::of(&primitives, &mut notes);
        if welded.faces.is_empty() {
            let vertices = primitives.iter().map(|p| p.positions.len()).sum();
            return Err(ReadError::NoFaces { file: self.file.clone(), vertices });
        }
        let set = set.or_else(|| self.own_set(&found, &primitives)).unwrap_or(0);
        let uv = self.uv_map(&found, &primitives, &welded, set, &mut notes)?;
        notes.texcoord = Some(set).filter(|&set| set > 0 && uv.is_some());
        let mut end = 0;
        let faces = primitives.iter().map(|p| {
            let start = end;
            end += p.triangles.len();
            start..end
        });
        Ok(GltfSurface {
            faces: faces.collect(),
            vertices: primitives.iter().flat_map(|p| p.triangles.as_flattened()).copied().collect(),
            mesh: TriMesh::of_ids(welded.positions, welded.faces),
            uv,
            set,
            notes,
            primitives,
            places,
        })
    }

    /// The document as any other mesh file: every mesh as large as in the scene.
    pub(super) fn into_mesh(self) -> Result<MeshFile, ReadError> {
        let surface = self.surface()?;
        let mesh = surface.sized().unwrap_or(surface.mesh);
        Ok(MeshFile { mesh, uv: surface.uv, colours: None, notes: surface.notes })
    }

    /// Finds the primitives of triangles, and takes note of the others.
    pub(super) fn found(&self, notes: &mut ReadNotes) -> Result<Vec<Found<'_>>, ReadError> {
        let mut out = Vec::new();
        for (mesh, mesh_item) in self.root().list("meshes")?.into_iter().enumerate() {
            for (primitive, item) in mesh_item.list("primitives")?.into_iter().enumerate() {
                let mode = item.number("mode")?.unwrap_or(TRIANGLES);
                let name = MODES.get(mode).ok_or_else(|| item.fault_at("mode", format!("{mode} is none of 0 to 6")))?;
                let attributes = item.object("attributes")?.ok_or_else(|| item.fault("`attributes` is missing"))?;
                if mode < TRIANGLES {
                    notes.ignore(&format!("primitive of {name}"));
                } else if !attributes.fields().contains_key("POSITION") {
                    notes.ignore("primitive without POSITION");
                } else {
                    out.push(Found { mesh, primitive, mesh_item: mesh_item.clone(), item, attributes, mode });
                }
            }
        }
        Ok(out)
    }

    /// What a primitive holds.
    pub(super) fn primitive(&self, found: &Found<'_>, notes: &mut ReadNotes) -> Result<GltfPrimitive, ReadError> {
        let Found { mesh, primitive, mesh_item, item, attributes, .. } = found;
        let accessor = self.accessor(attributes.required("POSITION")?, (attributes, "POSITION"))?;
        accessor.expect_vectors(3)?;
        let positions: Vec<_> = (0..accessor.count()).map(|i| Point3::from(accessor.numbers::<3>(i))).collect();
        let triangles = self.triangles(found, positions.len(), notes)?;
        check_finite(&accessor, &positions, &triangles)?;
        let material = item.number("material")?;
        let material_item = material.map(|m| self.root().element("materials", m, (item, "material"))).transpose()?;
        let mut texcoords: Vec<u32> = attributes.fields().keys().filter_map(|key| texcoord_set(key)).collect();
        texcoords.sort_unstable();
        Ok(GltfPrimitive {
            mesh: *mesh,
            primitive: *primitive,
            mesh_name: mesh_item.text("name").map(str::to_owned),
            material,
            material_name: material_item.and_then(|item| item.text("name").map(str::to_owned)),
            positions,
            triangles,
            texcoords,
        })
    }

    /// The triangles of a primitive, whose indices are all in range.
    fn triangles(&self, found: &Found<'_>, vertices: usize, notes: &mut ReadNotes) -> Result<Vec<[u32; 3]>, ReadError> {
        if u32::try_from(vertices).is_err() {
            return Err(ReadError::TooLarge { file: self.file.clone(), what: "vertices", count: vertices });
        }
        let Some(indices) = found.item.number("indices")? else {
            return Ok(assemble(found.mode, vertices, |i| i as u32, notes));
        };
        let accessor = self.accessor(indices, (&found.item, "indices"))?;
        accessor.expect_vectors(1)?;
        if !matches!(accessor.component(), Component::U8 | Component::U16 | Component::U32) {
            return Err(accessor.item().fault_at("componentType", "is no type of indices"));
        }
        if accessor.count() == 0 {
            notes.ignore("primitive without triangles");
            return Ok(Vec::new());
        }
        // Zeros without data would be as many as the document claims, all for nothing.
        if !accessor.has_data() {
            return Err(accessor.item().fault("indices without a buffer view"));
        }
        let list: Vec<usize> = (0..accessor.count()).map(|i| accessor.index(i)).collect();
        if let Some((i, v)) = list.iter().enumerate().find(|&(_, &v)| v >= vertices) {
            let reason = format!("index {i} names vertex {v}, but there are only {vertices} (counted from 0)");
            return Err(found.item.fault_at("indices", reason));
        }
        Ok(assemble(found.mode, list.len(), |i| list[i] as u32, notes))
    }

    /// The set of all primitives with triangles that [`Self::set_uvs`] has marked as its own.
    fn own_set(&self, found: &[Found<'_>], primitives: &[GltfPrimitive]) -> Option<u32> {
        let with_triangles = || found.iter().zip(primitives).filter(|(_, p)| !p.triangles.is_empty());
        let is_own = |attributes: &Item<'_>, set: u32| {
            let name = format!("TEXCOORD_{set}");
            let index = attributes.number(&name).ok().flatten();
            let accessor = index.and_then(|i| self.root().element("accessors", i, (attributes, &name)).ok());
            accessor.is_some_and(|accessor| accessor.text("name") == Some(OWN))
        };
        let (_, first) = with_triangles().next()?;
        // Sets below may be the same where there were none: the highest is the one that was written.
        let is_everywhere = |set: &u32| with_triangles().all(|(found, _)| is_own(&found.attributes, *set));
        first.texcoords.iter().rev().copied().find(is_everywhere)
    }

    /// The UVs of a set, if all primitives have it.
    fn uv_map(
        &self,
        found: &[Found<'_>],
        primitives: &[GltfPrimitive],
        welded: &Welded,
        set: u32,
        notes: &mut ReadNotes,
    ) -> Result<Option<UvMap>, ReadError> {
        let with = |p: &&GltfPrimitive| p.texcoords.contains(&set) || p.triangles.is_empty();
        let (have, without): (Vec<_>, Vec<_>) = primitives.iter().partition(with);
        if !without.is_empty() {
            let in_all = |other: &u32| primitives.iter().all(|p| p.texcoords.contains(other) || p.triangles.is_empty());
            let other = without.iter().flat_map(|p| &p.texcoords).copied().find(in_all);
            if let Some(other) = other {
                notes.uv_dropped = Some(UvDropped::OtherSet { asked: set, other });
            } else if have.iter().any(|p| !p.triangles.is_empty()) {
                let corners = without.iter().map(|p| 3 * p.triangles.len()).sum();
                notes.uv_dropped = Some(UvDropped::CornersWithout { corners });
            }
            return Ok(None);
        }
        let name = format!("TEXCOORD_{set}");
        let mut points = Vec::new();
        let mut corners = Vec::with_capacity(3 * welded.faces.len());
        let mut known = HashMap::new();
        let mut vertices = welded.faces.as_flattened().iter();
        for (found, primitive) in found.iter().zip(primitives).filter(|(_, p)| !p.triangles.is_empty()) {
            let attributes = &found.attributes;
            let accessor = self.accessor(attributes.required(&name)?, (attributes, &name))?;
            accessor.expect_vectors(2)?;
            check_count(&accessor, primitive.positions.len())?;
            // A vertex of a primitive has one UV, whichever corner asks.
            let mut ids = vec![None; primitive.positions.len()];
            for (&v, &welded) in primitive.triangles.as_flattened().iter().zip(&mut vertices) {
                let id = ids[v as usize].get_or_insert_with(|| {
                    let [u, t] = accessor.numbers::<2>(v as usize);
                    let uv = Point2::new(u, 1.0 - t);
                    *known.entry((welded, [uv.x.to_bits(), uv.y.to_bits()])).or_insert_with(|| {
                        points.push(uv);
                        UvId::new(points.len() - 1)
                    })
                });
                corners.push(*id);
            }
        }
        let bad = points.iter().filter(|p| !(p.x.is_finite() && p.y.is_finite())).count();
        if bad > 0 {
            notes.uv_dropped = Some(UvDropped::NotFinite { points: bad });
            return Ok(None);
        }
        Ok(Some(UvMap::new(points, corners)))
    }
}

/// The number `n` of an attribute `TEXCOORD_n`.
pub(super) fn texcoord_set(key: &str) -> Option<u32> {
    let digits = key.strip_prefix("TEXCOORD_")?;
    let set: u32 = digits.parse().ok()?;
    (set.to_string() == digits).then_some(set)
}

/// All attributes of a primitive have as many elements.
pub(super) fn check_count(accessor: &Accessor<'_>, vertices: usize) -> Result<(), ReadError> {
    if accessor.count() == vertices {
        return Ok(());
    }
    let reason = format!("{} elements where POSITION has {vertices}", accessor.count());
    Err(accessor.item().fault_at("count", reason))
}

/// Positions that triangles use have to be numbers.
fn check_finite(accessor: &Accessor<'_>, positions: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<(), ReadError> {
    let finite = |v: &&u32| positions[**v as usize].iter().all(|x| x.is_finite());
    match triangles.as_flattened().iter().find(|v| !finite(v)) {
        Some(v) => Err(accessor.item().fault(format!("element {v} has a coordinate that is not finite"))),
        None => Ok(()),
    }
}

/// Triangles of a list, a strip or a fan of `count` indices (section 3.7.2.1).
fn assemble(mode: usize, count: usize, index: impl Fn(usize) -> u32, notes: &mut ReadNotes) -> Vec<[u32; 3]> {
    let triangles = if mode == TRIANGLES { count / 3 } else { count.saturating_sub(2) };
    let places = (0..triangles).map(|i| match mode {
        // Every second triangle of a strip is turned over.
        STRIP => [i, i + 1 + i % 2, i + 2 - i % 2],
        FAN => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    });
    if mode == TRIANGLES {
        notes.ignore_many("index beyond the last triangle", count % 3);
    }
    let all = places.map(|corners| corners.map(&index));
    if mode != STRIP {
        return all.collect();
    }
    let kept: Vec<_> = all.filter(|[a, b, c]| a != b && b != c && c != a).collect();
    notes.ignore_many("turn of a triangle strip", triangles - kept.len());
    kept
}

/// Vertices joined where their positions are equal as numbers.
struct Welded {
    positions: Vec<Point3<f64>>,
    faces: Vec<[VertexId; 3]>,
}

impl Welded {
    /// Joins the vertices of each mesh. Those that no triangle uses are left out.
    fn of(primitives: &[GltfPrimitive], notes: &mut ReadNotes) -> Self {
        let mut out = Self { positions: Vec::new(), faces: Vec::new() };
        let mut by_position = HashMap::new();
        let mut mesh = None;
        for primitive in primitives {
            if mesh.replace(primitive.mesh) != Some(primitive.mesh) {
                by_position.clear();
            }
            let mut used = vec![false; primitive.positions.len()];
            primitive.triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
            let mut ids = vec![VertexId::new(0); used.len()];
            for (v, p) in primitive.positions.iter().enumerate().filter(|&(v, _)| used[v]) {
                // Adding +0 turns −0 into +0 and leaves all other numbers as they are.
                let key = [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
                let next = VertexId::new(out.positions.len());
                ids[v] = *by_position.entry(key).or_insert(next);
                if ids[v] == next {
                    out.positions.push(*p);
                } else {
                    notes.vertices_welded += 1;
                }
            }
            notes.ignore_many("vertex that no triangle uses", used.iter().filter(|&&used| !used).count());
            out.faces.extend(primitive.triangles.iter().map(|face| face.map(|v| ids[v as usize])));
        }
        out
    }
}
