//! New texture coordinates: which vertices are split, and what that changes in the document.

use std::borrow::Cow;
use std::collections::HashMap;

use serde::Serialize;
use serde_json::{Value, json};

use super::super::WriteError;
use super::super::blocks::check_finite;
use super::super::{ReadError, ReadNotes};
use super::accessor::{Component, OWN};
use super::append::{Appended, object};
use super::json::{Item, Object, whole};
use super::surface::{Found, TRIANGLES, check_count};
use super::{GltfDocument, GltfPrimitive};
use crate::{Point2, UvMap};

/// Where new UVs go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct GltfTexcoords {
    /// The number `n` of `TEXCOORD_n`. `None` is the first that is free in all primitives, or 0 when it may be
    /// overwritten. Few viewers show more than 0 to 3.
    pub set: Option<u32>,
    /// Whether a set that is there already is replaced.
    pub overwrite: bool,
}

/// What became of the vertices of a document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct GltfRemap {
    /// The number `n` of the new `TEXCOORD_n`.
    pub set: u32,
    /// How many vertices were added because corners of one vertex have different UVs.
    pub vertices_added: usize,
    /// The primitives that have new UVs.
    pub primitives: Vec<PrimitiveRemap>,
}

/// What became of the vertices of a primitive.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct PrimitiveRemap {
    /// The mesh, counted from 0.
    pub mesh: usize,
    /// The primitive in the mesh, counted from 0.
    pub primitive: usize,
    /// For every vertex now the vertex it was. The old ones come first, in their order.
    pub vertices: Vec<u32>,
}

impl GltfRemap {
    /// The remap as JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("numbers in lists under texts can always be written")
    }
}

/// What a reader finds where a UV was written: `u` rounded to 32 bits, and `v = 1 − t` with `t` rounded so.
///
/// Applied twice it says the same as once, so that UVs that went through it are stored exactly. Whatever has to hold of a
/// layout as written has to be checked of these.
#[must_use]
pub fn stored_uv(uv: Point2<f64>) -> Point2<f64> {
    let [u, t] = texcoord(uv);
    Point2::new(u.into(), 1.0 - f64::from(t))
}

/// The numbers of a `TEXCOORD`. Below 2⁻²⁹ a `t` of 32 bits is finer than 1 − t, and takes the steps of that.
fn texcoord(uv: Point2<f64>) -> [f32; 2] {
    let t = (1.0 - uv.y) as f32;
    // Adding +0 turns −0, which differs from 0 in its bits only, into +0.
    [uv.x as f32 + 0.0, (1.0 - (1.0 - f64::from(t))) as f32 + 0.0]
}

/// A primitive that gets new UVs.
struct Target<'a> {
    found: &'a Found<'a>,
    primitive: &'a GltfPrimitive,
    /// Where its corners begin in the map.
    first_corner: usize,
}

/// What one primitive names from now on.
struct Edit {
    mesh: usize,
    primitive: usize,
    attributes: Vec<(String, usize)>,
    targets: Vec<Vec<(String, usize)>>,
    indices: Option<usize>,
}

impl GltfDocument {
    /// Gives all triangles UVs, one per corner of [`GltfDocument::surface`], as a set `TEXCOORD_n` of 32-bit numbers.
    ///
    /// Vertices are split only where corners of one have different UVs. Primitives of one mesh that share all their
    /// attributes go on sharing them. A primitive that lacks sets below `n` gets the new UVs as those too, because sets
    /// count without gaps. Nothing else of the document changes, and nothing at all if there is an error. Tangents are
    /// kept: they belong to the UVs they were made for.
    ///
    /// The accessors of the new UVs have a name of their own, and those that had it before lose it:
    /// [`GltfDocument::surface`] finds the last set by it.
    ///
    /// # Errors
    /// [`WriteError::UvMismatch`], [`WriteError::NotFinite`] (in 32 bits), [`WriteError::TexcoordTaken`],
    /// [`WriteError::TexcoordGap`], and [`WriteError::Document`] for attributes that cannot be copied.
    pub fn set_uvs(&mut self, uv: &UvMap, texcoords: GltfTexcoords) -> Result<GltfRemap, WriteError> {
        let mut notes = ReadNotes::default();
        let found = self.found(&mut notes)?;
        let primitives: Vec<_> =
            found.iter().map(|found| self.primitive(found, &mut notes)).collect::<Result<_, ReadError>>()?;
        let corners = primitives.iter().map(|p| 3 * p.triangles.len()).sum();
        if uv.corners().len() != corners {
            return Err(WriteError::UvMismatch { map: uv.corners().len(), mesh: corners });
        }
        let points: Vec<[f32; 2]> = uv.points().iter().map(|&p| texcoord(p)).collect();
        check_finite("UV point", points.iter().map(|p| p.iter().all(|x| x.is_finite())))?;
        let set = self.choose_set(&primitives, texcoords)?;
        let corners: Vec<[f32; 2]> = uv.corners().iter().map(|id| points[id.index()]).collect();

        let mut appended = Appended::to(self);
        let mut edits = Vec::new();
        let mut remap = GltfRemap { set, vertices_added: 0, primitives: Vec::new() };
        for group in groups(&found, &primitives) {
            let split = Split::of(&group, &corners);
            if u32::try_from(split.uvs.len()).is_err() {
                return Err(WriteError::TooLarge { target: self.file.clone(), what: "the vertices of a primitive" });
            }
            edits.extend(self.edit(&group, &split, set, &mut appended)?);
            remap.vertices_added += split.added.len();
            remap.primitives.extend(group.iter().map(|target| PrimitiveRemap {
                mesh: target.found.mesh,
                primitive: target.found.primitive,
                vertices: split.old_vertices().collect(),
            }));
        }
        remap.primitives.sort_unstable_by_key(|p| (p.mesh, p.primitive));
        self.disown();
        appended.commit(self);
        edits.into_iter().for_each(|edit| self.apply(edit));
        Ok(remap)
    }

    /// Takes the name of the last UVs from the accessors that have it.
    fn disown(&mut self) {
        let accessors = self.json.get_mut("accessors").and_then(Value::as_array_mut);
        for accessor in accessors.into_iter().flatten().filter_map(Value::as_object_mut) {
            *accessor = without_own_name(accessor);
        }
    }

    /// The set that is asked for, if it is possible.
    fn choose_set(&self, primitives: &[GltfPrimitive], asked: GltfTexcoords) -> Result<u32, WriteError> {
        let file = || self.file.clone();
        let has = |set: u32| primitives.iter().any(|p| p.texcoords.contains(&set));
        // Not one more than the last: whoever writes TEXCOORD_4000000000 would get as many.
        let next = (0..u32::MAX).find(|&set| !has(set)).unwrap_or(u32::MAX);
        let set = asked.set.unwrap_or(if asked.overwrite { 0 } else { next });
        if set > next {
            return Err(WriteError::TexcoordGap { file: file(), set, next });
        }
        match primitives.iter().find(|p| p.texcoords.contains(&set)) {
            Some(&GltfPrimitive { mesh, primitive, .. }) if !asked.overwrite => {
                Err(WriteError::TexcoordTaken { file: file(), mesh, primitive, set, next })
            }
            _ => Ok(set),
        }
    }

    /// Makes the data that a group of primitives with common vertices needs.
    fn edit(
        &self,
        group: &[Target<'_>],
        split: &Split,
        set: u32,
        appended: &mut Appended,
    ) -> Result<Vec<Edit>, WriteError> {
        let vertices = split.uvs.len();
        let Some(first) = group.first() else { return Ok(Vec::new()) };
        let attributes = &first.found.attributes;
        let new = format!("TEXCOORD_{set}");
        let template = object(json!({"name": OWN, "componentType": Component::F32.code(), "type": "VEC2"}));
        let uvs = split.uvs.iter().map(|uv| Cow::Owned(uv.map(f32::to_le_bytes).as_flattened().to_vec()));
        let uv_accessor = appended.attribute(template, 2 * Component::F32.size(), uvs);
        let mut names = Vec::new();
        let mut targets = Vec::new();
        if !split.added.is_empty() {
            let mut copies = HashMap::new();
            names = self.copy_all(attributes, &new, split, &mut copies, appended)?;
            for target in first.found.item.list("targets")? {
                targets.push(self.copy_all(&target, "", split, &mut copies, appended)?);
            }
        }
        let has = |set: u32| attributes.fields().contains_key(&format!("TEXCOORD_{set}"));
        names.extend((0..set).filter(|&lower| !has(lower)).map(|lower| (format!("TEXCOORD_{lower}"), uv_accessor)));
        names.push((new, uv_accessor));
        let mut edits = Vec::new();
        for (target, triangles) in group.iter().zip(&split.triangles) {
            // Without indices a primitive is all its vertices, of which there may be more now.
            let all_vertices = !target.found.item.fields().contains_key("indices");
            let changed = *triangles != target.primitive.triangles || (all_vertices && !split.added.is_empty());
            let indices = changed.then(|| self.new_indices(target, triangles, vertices, appended)).transpose()?;
            edits.push(Edit {
                mesh: target.found.mesh,
                primitive: target.found.primitive,
                attributes: names.clone(),
                targets: targets.clone(),
                indices,
            });
        }
        Ok(edits)
    }

    /// Copies what every name of `attributes` but one stands for, with the elements of split vertices doubled.
    fn copy_all(
        &self,
        attributes: &Item<'_>,
        but: &str,
        split: &Split,
        copies: &mut HashMap<usize, usize>,
        appended: &mut Appended,
    ) -> Result<Vec<(String, usize)>, WriteError> {
        let mut out = Vec::new();
        for name in attributes.fields().keys().filter(|name| *name != but) {
            let index = attributes.required(name)?;
            let accessor = self.accessor(index, (attributes, name))?;
            check_count(&accessor, split.old_count)?;
            let copy = *copies.entry(index).or_insert_with(|| {
                let old: Vec<u32> = split.old_vertices().collect();
                let elements = old.iter().map(|&v| accessor.element(v as usize));
                appended.attribute(without_own_name(accessor.item().fields()), accessor.size(), elements)
            });
            out.push((name.clone(), copy));
        }
        Ok(out)
    }

    /// Adds the indices of a primitive, which is a list of triangles from now on.
    fn new_indices(
        &self,
        target: &Target<'_>,
        triangles: &[[u32; 3]],
        vertices: usize,
        appended: &mut Appended,
    ) -> Result<usize, WriteError> {
        let item = &target.found.item;
        let (template, least) = match item.number("indices")? {
            Some(index) => {
                let accessor = self.accessor(index, (item, "indices"))?;
                (accessor.item().fields().clone(), accessor.component())
            }
            // Indices of 8 bits are not what graphics processors like.
            None => (object(json!({"componentType": Component::U16.code(), "type": "SCALAR"})), Component::U16),
        };
        Ok(appended.indices(template, triangles, vertices, least))
    }

    /// Changes the names in one primitive.
    fn apply(&mut self, edit: Edit) {
        let primitive = self.json.get_mut("meshes").and_then(|meshes| {
            meshes.get_mut(edit.mesh)?.get_mut("primitives")?.get_mut(edit.primitive)?.as_object_mut()
        });
        let Some(primitive) = primitive else { return };
        let point = |object: &mut Object, names: Vec<(String, usize)>| {
            names.into_iter().for_each(|(name, accessor)| drop(object.insert(name, accessor.into())));
        };
        if let Some(Value::Object(attributes)) = primitive.get_mut("attributes") {
            point(attributes, edit.attributes);
        }
        if let Some(Value::Array(targets)) = primitive.get_mut("targets") {
            for (target, names) in targets.iter_mut().filter_map(Value::as_object_mut).zip(edit.targets) {
                point(target, names);
            }
        }
        if let Some(indices) = edit.indices {
            primitive.insert("indices".to_owned(), indices.into());
            if primitive.get("mode").and_then(whole).is_some_and(|mode| mode != TRIANGLES as u64) {
                primitive.insert("mode".to_owned(), TRIANGLES.into());
            }
        }
    }
}

/// The fields of an accessor, without the name of the last UVs.
fn without_own_name(accessor: &Object) -> Object {
    let mut accessor = accessor.clone();
    if accessor.get("name").and_then(Value::as_str) == Some(OWN) {
        accessor.shift_remove("name");
    }
    accessor
}

/// Primitives of one mesh that share all attributes and morph targets share their vertices.
fn groups<'a>(found: &'a [Found<'a>], primitives: &'a [GltfPrimitive]) -> Vec<Vec<Target<'a>>> {
    let mut out: Vec<Vec<Target<'a>>> = Vec::new();
    let mut known = HashMap::new();
    let mut first_corner = 0;
    for (found, primitive) in found.iter().zip(primitives) {
        let target = Target { found, primitive, first_corner };
        first_corner += 3 * primitive.triangles.len();
        if primitive.triangles.is_empty() {
            continue;
        }
        let targets = found.item.fields().get("targets").map(Value::to_string);
        let attributes = serde_json::to_string(found.attributes.fields()).unwrap_or_default();
        let group = *known.entry((found.mesh, attributes, targets)).or_insert(out.len());
        if group == out.len() {
            out.push(Vec::new());
        }
        out[group].push(target);
    }
    out
}

/// The vertices of a group, split where their corners have different UVs.
struct Split {
    old_count: usize,
    /// The UVs of all vertices, the old ones first; zeros where no triangle uses one.
    uvs: Vec<[f32; 2]>,
    /// What the new vertices were.
    added: Vec<u32>,
    /// The triangles of every primitive of the group.
    triangles: Vec<Vec<[u32; 3]>>,
}

impl Split {
    fn of(group: &[Target<'_>], corners: &[[f32; 2]]) -> Self {
        let old_count = group.first().map_or(0, |target| target.primitive.positions.len());
        let mut out = Self { old_count, uvs: vec![[0.0; 2]; old_count], added: Vec::new(), triangles: Vec::new() };
        let mut used = vec![false; old_count];
        let mut others: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
        for target in group {
            let mut triangles = target.primitive.triangles.clone();
            let corners = &corners[target.first_corner..];
            for (v, &uv) in triangles.as_flattened_mut().iter_mut().zip(corners) {
                let old = *v as usize;
                if !std::mem::replace(&mut used[old], true) {
                    out.uvs[old] = uv;
                } else if out.uvs[old] != uv {
                    *v = *others.entry((*v, uv.map(f32::to_bits))).or_insert_with(|| {
                        out.uvs.push(uv);
                        out.added.push(*v);
                        // One that does not fit is found by the count of all, which is checked.
                        u32::try_from(out.uvs.len() - 1).unwrap_or(u32::MAX)
                    });
                }
            }
            out.triangles.push(triangles);
        }
        out
    }

    /// For every vertex what it was.
    fn old_vertices(&self) -> impl Iterator<Item = u32> + '_ {
        // As many as indices of 32 bits were checked to name.
        (0..self.old_count as u32).chain(self.added.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stored_uvs_are_stored_as_they_are() {
        let mut state = 1_u64;
        for _ in 0..100_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let magnitude = 2.0_f64.powi((state >> 58) as i32 - 40);
            let part = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            for v in [part, part * magnitude, 1.0 - part * magnitude] {
                let once = stored_uv(Point2::new(v, v));
                assert_eq!(stored_uv(once), once, "{v:e}");
                assert!((once.y - v).abs() <= 2.0_f64.powi(-24) * (1.0 - v).abs() + f64::EPSILON, "{v:e}");
            }
        }
    }
}
