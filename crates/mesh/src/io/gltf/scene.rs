//! Where the nodes of a document put its meshes, and how large that makes them (sections 3.5 and 3.5.3).

use std::fmt::Write;

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

use super::super::error::ReadError;
use super::GltfDocument;
use super::json::{Item, whole};
use super::place::{GltfPlace, Places};
use super::surface::{GltfPrimitive, GltfSurface};
use crate::{Point3, TriMesh};

/// A matrix that differs from a rotation times a number by no more than this part of it is one.
const UNIFORM: f64 = 1e-9;

/// A size that is one but for the rounding of a product of matrices.
const SAME_SIZE: f64 = 1e-12;

impl GltfSurface {
    /// The surface with every mesh as large as its largest instance in the scene, of the shape that it has as stored;
    /// `None` where that is the surface as stored.
    #[must_use]
    pub fn sized(&self) -> Option<TriMesh> {
        let is_resized = self.places.iter().any(|place| place.scale != 1.0);
        is_resized.then(|| self.moved(|place, p| p * place.scale))
    }

    /// The surface with every mesh where its largest instance is in the scene.
    #[must_use]
    pub fn placed(&self) -> TriMesh {
        self.moved(GltfPlace::point)
    }

    fn moved(&self, place_point: impl Fn(&GltfPlace, Point3<f64>) -> Point3<f64>) -> TriMesh {
        let mut positions = self.mesh.positions().to_vec();
        // A vertex is of one mesh only; its faces may be in several primitives of that.
        let mut is_moved = vec![false; positions.len()];
        for (faces, place) in self.faces.iter().zip(&self.places) {
            for v in self.mesh.faces()[faces.clone()].iter().flatten().map(|v| v.index()) {
                if !std::mem::replace(&mut is_moved[v], true) {
                    positions[v] = place_point(place, positions[v]);
                }
            }
        }
        TriMesh::of_ids(positions, self.mesh.faces().to_vec())
    }
}

impl GltfDocument {
    /// Where the primitives are: in the default scene, or in all scenes where none is the default.
    pub(super) fn places(&self, primitives: &[GltfPrimitive]) -> Result<Places, ReadError> {
        let nodes = Nodes::read(&self.root())?;
        let instances = nodes.instances(&self.root())?;
        let mut of_meshes: Vec<(usize, Found)> = Vec::new();
        let mut of_primitives = Vec::with_capacity(primitives.len());
        for of_mesh in primitives.chunk_by(|a, b| a.mesh == b.mesh) {
            let mesh = of_mesh[0].mesh;
            let mine = instances.iter().filter(|instance| instance.mesh == mesh);
            let found = largest(of_mesh, mine);
            of_primitives.extend(std::iter::repeat_n(found.place, of_mesh.len()));
            of_meshes.push((mesh, found));
        }
        Ok(Places { of_primitives, said: sentence(&of_meshes) })
    }
}

/// What was found of a mesh.
struct Found {
    place: GltfPlace,
    /// Whether it has a size in the scene.
    is_placed: bool,
}

/// The instance with the largest area; the first of several.
fn largest<'i>(primitives: &[GltfPrimitive], instances: impl Iterator<Item = &'i Instance>) -> Found {
    let normals: Vec<Vector3<f64>> = primitives.iter().flat_map(normals).collect();
    let own: f64 = normals.iter().map(Vector3::norm).sum();
    let mut best: Option<(f64, GltfPlace)> = None;
    for instance in instances {
        let scale = match instance.matrix {
            None => 1.0,
            Some(matrix) => scale(&matrix, &normals, own),
        };
        if scale > 0.0 && best.is_none_or(|(largest, _)| scale > largest) {
            let scale = if (scale - 1.0).abs() <= SAME_SIZE { 1.0 } else { scale };
            let place = instance.matrix.map_or(GltfPlace::AS_STORED, |m| GltfPlace { scale, matrix: rows(&m) });
            best = Some((scale, place));
        }
    }
    Found { place: best.map_or(GltfPlace::AS_STORED, |(_, place)| place), is_placed: best.is_some() }
}

/// Twice the areas of the triangles, in the direction of their normals.
fn normals(primitive: &GltfPrimitive) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let at = |v: u32| primitive.positions[v as usize];
    primitive.triangles.iter().map(move |&[a, b, c]| (at(b) - at(a)).cross(&(at(c) - at(a))))
}

/// What a matrix multiplies lengths by, in the mean of the areas.
fn scale(matrix: &Matrix4<f64>, normals: &[Vector3<f64>], own: f64) -> f64 {
    let linear: Matrix3<f64> = matrix.fixed_view::<3, 3>(0, 0).into();
    let squared = linear.transpose() * linear;
    let mean = squared.trace() / 3.0;
    if (squared - Matrix3::identity() * mean).amax() <= UNIFORM * mean || own == 0.0 {
        return mean.sqrt();
    }
    // Normals times areas are mapped by the cofactors.
    let columns: Vec<Vector3<f64>> = (0..3).map(|i| linear.column(i).into()).collect();
    let cofactors = Matrix3::from_columns(&[
        columns[1].cross(&columns[2]),
        columns[2].cross(&columns[0]),
        columns[0].cross(&columns[1]),
    ]);
    let area: f64 = normals.iter().map(|n| (cofactors * n).norm()).sum();
    (area / own).sqrt()
}

fn rows(m: &Matrix4<f64>) -> [[f64; 4]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2, 3].map(|column| m[(row, column)]))
}

/// What there is to say: nothing where all sizes are those of the file.
fn sentence(of_meshes: &[(usize, Found)]) -> Option<String> {
    let scales = of_meshes.iter().map(|(_, found)| found.place.scale).filter(|&scale| scale != 1.0);
    let (low, high) = scales.clone().fold((f64::INFINITY, 0.0_f64), |(low, high), s| (low.min(s), high.max(s)));
    let (resized, all) = (scales.count(), of_meshes.len());
    let nowhere = of_meshes.iter().filter(|(_, found)| !found.is_placed).count();
    let mut said = String::new();
    // Writing to a string cannot fail.
    if resized > 0 {
        let to = if low == high { String::new() } else { format!(" to {}", short(high)) };
        let _ = write!(said, "sizes are those of the scene: {resized} of {all} meshes scaled by {}{to}", short(low));
    }
    if nowhere > 0 {
        let between = if said.is_empty() { "" } else { "; " };
        let _ = write!(said, "{between}{nowhere} of {all} meshes without a size in the scene keep their own units");
    }
    (!said.is_empty()).then_some(said)
}

/// A number with three digits that count.
fn short(x: f64) -> String {
    let digits = 2 - x.log10().floor() as i32;
    let power = 10.0_f64.powi(digits);
    format!("{}", (x * power).round() / power)
}

/// A mesh at a node.
struct Instance {
    mesh: usize,
    /// From the coordinates of the mesh to those of the scene; `None` for a skinned mesh, to which no node does anything.
    matrix: Option<Matrix4<f64>>,
}

/// The nodes of a document, each with at most one parent.
struct Nodes<'a> {
    items: Vec<Item<'a>>,
    children: Vec<Vec<usize>>,
    parent: Vec<Option<usize>>,
}

impl<'a> Nodes<'a> {
    fn read(root: &Item<'a>) -> Result<Self, ReadError> {
        let items = root.list("nodes")?;
        let children: Vec<Vec<usize>> =
            items.iter().map(|item| indices(item, "children", items.len())).collect::<Result<_, _>>()?;
        let mut parent: Vec<Option<usize>> = vec![None; items.len()];
        for (node, list) in children.iter().enumerate() {
            for &child in list {
                if let Some(other) = parent[child].replace(node) {
                    let reason = format!("node {child} is a child of node {other} and of node {node}");
                    return Err(items[child].fault(reason));
                }
            }
        }
        let nodes = Self { items, children, parent };
        nodes.check_acyclic()?;
        Ok(nodes)
    }

    /// Nodes that no node without a parent leads to are in a cycle, or below one.
    fn check_acyclic(&self) -> Result<(), ReadError> {
        let mut is_reached = vec![false; self.items.len()];
        let mut stack: Vec<usize> = (0..self.items.len()).filter(|&node| self.parent[node].is_none()).collect();
        while let Some(node) = stack.pop() {
            is_reached[node] = true;
            stack.extend(&self.children[node]);
        }
        match is_reached.iter().position(|reached| !reached) {
            Some(node) => Err(self.items[node].fault(format!("node {node} is in a cycle of children, or below one"))),
            None => Ok(()),
        }
    }

    /// The meshes of the default scene; of all scenes where none is the default; of all nodes where there is no scene.
    fn instances(&self, root: &Item<'_>) -> Result<Vec<Instance>, ReadError> {
        let scenes = root.list("scenes")?;
        let default = root.number("scene")?;
        let shown = match default {
            Some(scene) => vec![root.element("scenes", scene, (root, "scene"))?],
            None => scenes,
        };
        let mut starts = Vec::new();
        for scene in &shown {
            starts.extend(indices(scene, "nodes", self.items.len())?);
        }
        if shown.is_empty() {
            starts = (0..self.items.len()).filter(|&node| self.parent[node].is_none()).collect();
        }
        let mut stack: Vec<(usize, Matrix4<f64>)> =
            starts.into_iter().rev().map(|node| (node, Matrix4::identity())).collect();
        let mut out = Vec::new();
        let mut is_seen = vec![false; self.items.len()];
        while let Some((node, before)) = stack.pop() {
            // A scene may name a node twice, or one below another.
            if std::mem::replace(&mut is_seen[node], true) {
                continue;
            }
            let item = &self.items[node];
            let matrix = before * local(item)?;
            if !matrix.iter().all(|x| x.is_finite()) {
                return Err(item.fault(format!("the transform of node {node} is not finite")));
            }
            if let Some(mesh) = item.number("mesh")? {
                let is_skinned = item.fields().contains_key("skin");
                out.push(Instance { mesh, matrix: (!is_skinned).then_some(matrix) });
            }
            stack.extend(self.children[node].iter().rev().map(|&child| (child, matrix)));
        }
        Ok(out)
    }
}

/// What a node does to its own coordinates (section 3.5.3).
fn local(node: &Item<'_>) -> Result<Matrix4<f64>, ReadError> {
    if let Some(numbers) = numbers::<16>(node, "matrix")? {
        return Ok(Matrix4::from_column_slice(&numbers));
    }
    let translation = numbers::<3>(node, "translation")?.unwrap_or([0.0; 3]);
    let [x, y, z, w] = numbers::<4>(node, "rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = numbers::<3>(node, "scale")?.unwrap_or([1.0; 3]);
    let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.0)
        .ok_or_else(|| node.fault_at("rotation", "is no rotation: its length is 0"))?;
    let scaled = rotation.to_rotation_matrix().into_inner() * Matrix3::from_diagonal(&Vector3::from(scale));
    let mut matrix = scaled.to_homogeneous();
    matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::from(translation));
    Ok(matrix)
}

/// A list of so many finite numbers, if there is one.
fn numbers<const N: usize>(item: &Item<'_>, key: &str) -> Result<Option<[f64; N]>, ReadError> {
    let Some(value) = item.fields().get(key) else { return Ok(None) };
    let list = value.as_array().filter(|list| list.len() == N);
    let list = list.ok_or_else(|| item.fault_at(key, format!("is not a list of {N} numbers")))?;
    let mut out = [0.0; N];
    for (i, (x, value)) in out.iter_mut().zip(list).enumerate() {
        let number = value.as_f64().filter(|x| x.is_finite());
        *x = number.ok_or_else(|| item.fault_at(key, format!("entry {i} is no finite number")))?;
    }
    Ok(Some(out))
}

/// A list of indices below `count`; empty where there is none.
fn indices(item: &Item<'_>, key: &str, count: usize) -> Result<Vec<usize>, ReadError> {
    let Some(value) = item.fields().get(key) else { return Ok(Vec::new()) };
    let list = value.as_array().ok_or_else(|| item.fault_at(key, "is not a list"))?;
    let index = |value: &Value| {
        let index = whole(value).and_then(|n| usize::try_from(n).ok()).filter(|&n| n < count);
        index.ok_or_else(|| item.fault_at(key, format!("names a node beyond the {count} there are (counted from 0)")))
    };
    list.iter().map(index).collect()
}
