//! Positions and indices in, UVs and a remap out: what engines keep meshes in.

use crate::atlas::{Atlas, AtlasError, AtlasPages, Packed, Parted, Parting, Stored};
use crate::unwrap::{HoleRule, SeamRule, SurfaceHints, Unwrap, UnwrapError, Unwrapped};
use crate::{Pipeline, Solver};
use abf_control::{Cancelled, Event, Observer, Silent, Verdict};
use abf_cut::{DoubleSided, Weld};
use abf_mesh::{GeometryError, Point3, TriMesh};
use abf_metrics::Precision;
use std::collections::HashMap;

/// Unwraps a mesh given as arrays into an atlas in the unit square.
///
/// ```
/// // A tetrahedron.
/// let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let indices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
///
/// let flat = abf::ArrayUnwrapper::new().resolution(512).margin(4).run(&positions, &indices)?;
/// assert!(flat.packed.metrics.injective());
/// assert_eq!(flat.indices.len(), indices.len());
/// // A vertex on a seam has become several; everything else of it is copied from where it came.
/// let new_positions: Vec<[f32; 3]> = flat.remap.iter().map(|&old| positions[old as usize]).collect();
/// assert_eq!(new_positions.len(), flat.uvs.len());
/// # Ok::<(), abf::ArrayError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct ArrayUnwrapper {
    /// Seams, holes and the solver.
    pub unwrap: Unwrap,
    /// The layout of the charts.
    pub atlas: Atlas,
    /// Why charts are parted when they are packed; `None`: they are not.
    pub parting: Option<Parting>,
}

impl Default for ArrayUnwrapper {
    /// The defaults of its parts, but that a disk is cut like everything else when it misses the aim: a texture wants that.
    fn default() -> Self {
        Self { unwrap: Unwrap { cut_disks: true, ..Unwrap::default() }, atlas: Atlas::default(), parting: None }
    }
}

/// Why arrays could not be unwrapped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArrayError {
    /// Indices that are no triangles.
    #[error("{count} indices are no triangles: their number must be a multiple of 3")]
    IndexCount {
        /// How many there are.
        count: usize,
    },
    /// An index without a vertex.
    #[error("triangle {triangle} has the index {index}, and there are {vertex_count} vertices")]
    Index {
        /// The first such triangle.
        triangle: usize,
        /// Its index.
        index: u32,
        /// How many vertices there are.
        vertex_count: usize,
    },
    /// A position that is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// The first such vertex.
        vertex: usize,
    },
    /// The welded mesh cannot be worked with.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// There are no charts.
    #[error(transparent)]
    Unwrap(#[from] UnwrapError),
    /// The charts cannot be packed.
    #[error(transparent)]
    Atlas(#[from] AtlasError),
}

/// A mesh as arrays, with UVs.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct UnwrappedArrays {
    /// One UV per new vertex, in `[0, 1]²`, v upwards.
    pub uvs: Vec<[f32; 2]>,
    /// Three new vertices per triangle, in the order of the input.
    pub indices: Vec<u32>,
    /// For every new vertex the vertex of the input it is a copy of. The first copies have the numbers of the input.
    pub remap: Vec<u32>,
    /// The atlas, with its judgement of the UVs as 32-bit numbers.
    pub packed: Packed,
    /// The charts and what was repaired. Vertices in it are those of the mesh with vertices of one position made one, in the
    /// order of their first appearance; faces are triangles of the input.
    pub unwrapped: Unwrapped,
    /// How many cuts were made for coverage ([`Parting::coverage`]).
    pub parted_for_coverage: usize,
    /// How many were made for the margin inside of charts ([`Parting::keeps_inner_margin`]).
    pub parted_for_margin: usize,
    /// Whether the observer ended these cuts before there was nothing more to cut.
    pub is_parting_unfinished: bool,
}

impl UnwrappedArrays {
    /// Whether this is what was asked for: every chart is finished and valid, of a solver that ended as asked, no cut is missing
    /// that the observer did not allow, and nothing lies over anything else, unless `may_overlap`.
    #[must_use]
    pub fn is_certified(&self, may_overlap: bool) -> bool {
        let metrics = &self.packed.metrics;
        let mut charts = self.unwrapped.charts.iter();
        (metrics.injective() || may_overlap && metrics.valid())
            && !self.is_parting_unfinished
            && charts.all(|chart| chart.is_certified() && !chart.unfinished)
    }
}

impl ArrayUnwrapper {
    /// The defaults: seams from the shape and the stretch, holes filled, one page of 1024 texels.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Which solver flattens the charts.
    #[must_use]
    pub fn solver(mut self, solver: impl Into<Solver>) -> Self {
        self.unwrap.pipeline.solver = solver.into();
        self
    }

    /// Every setting of it.
    #[must_use]
    pub fn pipeline(mut self, pipeline: Pipeline) -> Self {
        self.unwrap.pipeline = pipeline;
        self
    }

    /// Where seams come from.
    #[must_use]
    pub fn seams(mut self, seams: SeamRule) -> Self {
        self.unwrap.seams = seams;
        self
    }

    /// What becomes of holes.
    #[must_use]
    pub fn holes(mut self, holes: HoleRule) -> Self {
        self.unwrap.holes = holes;
        self
    }

    /// The L² stretch that seams aim at.
    #[must_use]
    pub fn max_stretch(mut self, max_stretch: f64) -> Self {
        self.unwrap.max_stretch = max_stretch;
        self
    }

    /// Which vertices in one place are joined. [`Weld::Off`] takes the vertices as they are; the others join equal
    /// positions first, wherever they are.
    #[must_use]
    pub fn weld(mut self, weld: Weld) -> Self {
        self.unwrap.weld = weld;
        self
    }

    /// What becomes of faces with the same three vertices.
    #[must_use]
    pub fn double_sided(mut self, double_sided: DoubleSided) -> Self {
        self.unwrap.double_sided = double_sided;
        self
    }

    /// Whether a mesh that needs repair is refused.
    #[must_use]
    pub fn strict(mut self, strict: bool) -> Self {
        self.unwrap.strict = strict;
        self
    }

    /// Which charts share a page.
    #[must_use]
    pub fn pages(mut self, pages: AtlasPages) -> Self {
        self.atlas.pages = pages;
        self
    }

    /// Texels along the sides of a page, which is a square.
    #[must_use]
    pub fn resolution(mut self, texels: u32) -> Self {
        self.atlas.page = [texels; 2];
        self
    }

    /// Texels of a page along x and y.
    #[must_use]
    pub fn page(mut self, width: u32, height: u32) -> Self {
        self.atlas.page = [width, height];
        self
    }

    /// Texels between charts.
    #[must_use]
    pub fn margin(mut self, texels: u32) -> Self {
        self.atlas.margin = texels;
        self
    }

    /// Why charts are parted when they are packed.
    #[must_use]
    pub fn parting(mut self, parting: Parting) -> Self {
        self.parting = Some(parting);
        self
    }

    /// Unwraps a mesh.
    ///
    /// # Errors
    /// [`ArrayError`].
    pub fn run(&self, positions: &[[f32; 3]], indices: &[u32]) -> Result<UnwrappedArrays, ArrayError> {
        self.run_with(positions, indices, &SurfaceHints::default(), &mut Silent)
    }

    /// The same with hints, per face and corner of `indices`, and with an observer, which hears of progress and may cancel.
    ///
    /// # Errors
    /// [`ArrayError`].
    pub fn run_with(
        &self,
        positions: &[[f32; 3]],
        indices: &[u32],
        hints: &SurfaceHints<'_>,
        observer: &mut (dyn Observer + Send),
    ) -> Result<UnwrappedArrays, ArrayError> {
        let positions: Vec<[f64; 3]> = positions.iter().map(|p| p.map(f64::from)).collect();
        self.run_in_doubles(&positions, indices, hints, observer)
    }

    /// [`run_with`](Self::run_with) for positions of 64 bits. UVs are stored, and certified, as 32-bit numbers.
    ///
    /// Vertices are joined where they have one position, but not those of two
    /// [objects](SurfaceHints::objects); a vertex is of the object of its first triangle.
    ///
    /// # Errors
    /// [`ArrayError`].
    pub fn run_in_doubles(
        &self,
        positions: &[[f64; 3]],
        indices: &[u32],
        hints: &SurfaceHints<'_>,
        observer: &mut (dyn Observer + Send),
    ) -> Result<UnwrappedArrays, ArrayError> {
        let (triangles, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(ArrayError::IndexCount { count: indices.len() });
        }
        let vertex_count = positions.len();
        if let Some(at) = indices.iter().position(|&i| i as usize >= vertex_count) {
            return Err(ArrayError::Index { triangle: at / 3, index: indices[at], vertex_count });
        }
        if let Some(vertex) = positions.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
            return Err(ArrayError::NotFinite { vertex });
        }
        if let Some(parting) = &self.parting {
            parting.check()?;
        }
        let mesh = match self.unwrap.weld {
            Weld::Off => separate(positions, triangles)?,
            _ => welded(positions, triangles, hints.objects)?,
        };
        let unwrapped = self.unwrap.run(&mesh, hints, observer)?;
        let Parted {
            unwrapped,
            packed,
            for_coverage: parted_for_coverage,
            for_margin: parted_for_margin,
            is_unfinished,
        } = self.pack(&mesh, unwrapped, hints, observer)?;
        let is_parting_unfinished = is_unfinished;
        let (indices, remap, uvs) = split(positions.len(), indices, &packed);
        Ok(UnwrappedArrays {
            uvs,
            indices,
            remap,
            packed,
            unwrapped,
            parted_for_coverage,
            parted_for_margin,
            is_parting_unfinished,
        })
    }

    fn pack(
        &self,
        mesh: &TriMesh,
        unwrapped: Unwrapped,
        hints: &SurfaceHints<'_>,
        observer: &mut (dyn Observer + Send),
    ) -> Result<Parted, ArrayError> {
        let stored = Stored::in_precision(Precision::Single);
        match &self.parting {
            Some(parting) => {
                let known = (hints.face_labels, hints.forbidden);
                let mut verdict = Verdict::Continue;
                let mut may_go_on = || {
                    // The first answer that is no leave to go on holds.
                    if matches!(verdict, Verdict::Continue) {
                        verdict = observer.observe(Event::Working);
                    }
                    matches!(verdict, Verdict::Continue)
                };
                let how: (_, &mut dyn FnMut() -> bool) = (parting, &mut may_go_on);
                let parted = self.atlas.pack_parting_while(mesh, unwrapped, known, stored, how)?;
                match verdict {
                    Verdict::Abort => Err(UnwrapError::from(Cancelled).into()),
                    Verdict::Continue | Verdict::Stop => Ok(parted),
                }
            }
            None => {
                let packed = self.atlas.pack(mesh, &unwrapped, hints.face_labels, stored)?;
                Ok(Parted { unwrapped, packed, for_coverage: 0, for_margin: 0, is_unfinished: false })
            }
        }
    }
}

/// The mesh with the vertices it has.
fn separate(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<TriMesh, GeometryError> {
    let points = positions.iter().map(|&p| Point3::from(p)).collect();
    TriMesh::new(points, &triangles.iter().map(|t| t.map(|i| i as usize)).collect::<Vec<_>>())
}

/// The mesh with vertices at one position made one: engines split them where normals or UVs differ.
fn welded(positions: &[[f64; 3]], triangles: &[[u32; 3]], objects: Option<&[u32]>) -> Result<TriMesh, GeometryError> {
    let mut object_of = vec![None; positions.len()];
    // The check of the hints comes later: a label too few is no reason to stop here.
    for (triangle, &object) in triangles.iter().zip(objects.unwrap_or_default()) {
        for &vertex in triangle {
            object_of[vertex as usize].get_or_insert(object);
        }
    }
    let mut at: HashMap<(Option<u32>, [u64; 3]), usize> = HashMap::with_capacity(positions.len());
    let mut points = Vec::new();
    // Adding zero makes −0 positive, which is the same place.
    let vertex = |(p, object): (&[f64; 3], Option<u32>)| {
        *at.entry((object, p.map(|x| (x + 0.0).to_bits()))).or_insert_with(|| {
            points.push(Point3::from(*p));
            points.len() - 1
        })
    };
    let vertices: Vec<usize> = positions.iter().zip(object_of).map(vertex).collect();
    TriMesh::new(points, &triangles.iter().map(|t| t.map(|i| vertices[i as usize])).collect::<Vec<_>>())
}

/// New indices, for every new vertex its old one, and its UV: vertices are split where corners have different UVs.
fn split(vertex_count: usize, indices: &[u32], packed: &Packed) -> (Vec<u32>, Vec<u32>, Vec<[f32; 2]>) {
    let uv = &packed.uv;
    let mut remap: Vec<u32> = (0..vertex_count as u32).collect();
    let mut uvs: Vec<Option<[f32; 2]>> = vec![None; vertex_count];
    let mut copies: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
    let new_index = |(&old, id): (&u32, &abf_mesh::UvId)| {
        let point = uv.points()[id.index()];
        let point = [point.x as f32, point.y as f32];
        let bits = point.map(f32::to_bits);
        match uvs[old as usize] {
            None => {
                uvs[old as usize] = Some(point);
                old
            }
            Some(known) if known.map(f32::to_bits) == bits => old,
            Some(_) => *copies.entry((old, bits)).or_insert_with(|| {
                remap.push(old);
                uvs.push(Some(point));
                remap.len() as u32 - 1
            }),
        }
    };
    let indices = indices.iter().zip(uv.corners()).map(new_index).collect();
    // Vertices of no triangle have none.
    (indices, remap, uvs.into_iter().map(Option::unwrap_or_default).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_shapes::Shape;

    #[test]
    fn vertices_of_one_place_are_one_and_come_back_as_they_were() {
        // Every triangle has vertices of its own, as after flat shading.
        let mesh = Shape::Hemisphere.mesh(200);
        let positions: Vec<[f32; 3]> = mesh.triangles().flatten().map(|p| p.coords.map(|x| x as f32).into()).collect();
        let indices: Vec<u32> = (0..positions.len() as u32).collect();
        let flat = ArrayUnwrapper::new().run(&positions, &indices).expect("a disk");
        assert!(flat.packed.metrics.injective());
        assert_eq!((flat.unwrapped.charts.len(), flat.packed.pages), (1, 1));
        assert_eq!((flat.indices, flat.remap), (indices.clone(), indices));
        assert!(flat.uvs.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    }

    #[test]
    fn a_soup_that_is_not_welded_is_a_chart_per_triangle() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let charts = |weld| {
            let flat = ArrayUnwrapper::new().weld(weld).run(&positions, &[0, 1, 2, 3, 4, 5]).expect("charts");
            (flat.unwrapped.charts.len(), flat.remap.len())
        };
        assert_eq!(charts(Weld::Off), (2, 6));
        assert_eq!(charts(Weld::Auto), (1, 6));
        assert_eq!(charts(Weld::Within(0.1)), (1, 6));
    }

    #[test]
    fn a_seam_splits_its_vertices_and_says_where_they_came_from() {
        let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let indices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3];
        let flat = ArrayUnwrapper::new().run(&positions, &indices).expect("a closed surface");
        assert!(flat.packed.metrics.injective() && flat.remap.len() > 4);
        let old: Vec<u32> = flat.indices.iter().map(|&new| flat.remap[new as usize]).collect();
        assert_eq!(old, indices);
        assert_eq!(flat.uvs.len(), flat.remap.len());
    }

    #[test]
    fn vertices_of_two_objects_stay_two() {
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0_f64]];
        let charts = |objects: Option<&[u32]>| {
            let hints = SurfaceHints { objects, ..SurfaceHints::default() };
            let flat = ArrayUnwrapper::new().run_in_doubles(&positions, &[0, 1, 2, 3, 4, 5], &hints, &mut Silent);
            flat.expect("charts").unwrapped.charts.len()
        };
        assert_eq!((charts(None), charts(Some(&[7, 7])), charts(Some(&[7, 8]))), (1, 1, 2));
    }

    #[test]
    fn positions_of_64_bits_are_not_rounded() {
        // One square on a map of a country: 32 bits hold metres there, and no centimetres.
        let at = |x: f64, y: f64| [500_000.0 + x, 5_500_000.0 + y, 0.0];
        let positions = [at(0.0, 0.0), at(0.01, 0.0), at(0.01, 0.01), at(0.0, 0.01)];
        let run = |positions: &[[f64; 3]]| {
            ArrayUnwrapper::new().run_in_doubles(positions, &[0, 1, 2, 0, 2, 3], &SurfaceHints::default(), &mut Silent)
        };
        let flat = run(&positions).expect("a disk");
        assert!((flat.packed.metrics.stretch_l2 - 1.0).abs() < 1e-6, "{}", flat.packed.metrics.stretch_l2);
        let rounded = positions.map(|p| p.map(|x| f64::from(x as f32)));
        assert!(run(&rounded).is_err(), "nothing is left of it in 32 bits");
    }

    #[test]
    fn a_marked_edge_is_a_seam_and_one_of_its_sides_is_enough() {
        // Two squares side by side; the edge between them is marked, from its left side only.
        let positions =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0_f64]];
        let indices = [0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2];
        let mut marked = vec![false; indices.len()];
        let charts = |marked: &[bool], seams| {
            let hints = SurfaceHints { seams: Some(marked), ..SurfaceHints::default() };
            let flat = ArrayUnwrapper::new().seams(seams).run_in_doubles(&positions, &indices, &hints, &mut Silent);
            flat.expect("charts").unwrapped.charts.len()
        };
        assert_eq!(charts(&marked, SeamRule::Keep), 1);
        marked[0] = true;
        assert_eq!((charts(&marked, SeamRule::Keep), charts(&marked, SeamRule::Auto)), (2, 1));
    }

    #[test]
    fn charts_are_parted_where_that_is_asked_for() {
        // A flat strip along a half circle covers little of a page.
        let ring = |i: u32| {
            let angle = std::f32::consts::PI * i as f32 / 48.0;
            [4.0, 4.5, 5.0].map(|r: f32| [r * angle.cos(), r * angle.sin(), 0.0])
        };
        let positions: Vec<[f32; 3]> = (0..=48).flat_map(ring).collect();
        let quads = (0..48).flat_map(|i| [3 * i, 3 * i + 1]);
        let indices: Vec<u32> = quads.flat_map(|a| [a, a + 1, a + 4, a, a + 4, a + 3]).collect();
        let whole = ArrayUnwrapper::new().run(&positions, &indices).expect("a chart");
        assert_eq!((whole.unwrapped.charts.len(), whole.parted_for_coverage), (1, 0));
        assert!(whole.is_certified(false));
        let parting = Parting { coverage: Some(0.6), seam_budget: 0.5, ..Parting::default() };
        let parted = ArrayUnwrapper::new().parting(parting).run(&positions, &indices).expect("charts");
        assert_eq!(parted.unwrapped.charts.len(), 1 + parted.parted_for_coverage);
        assert!(parted.parted_for_coverage > 0 && parted.packed.coverage > 1.2 * whole.packed.coverage);
        assert!(parted.is_certified(false));
        let wrong = Parting { coverage: Some(2.0), ..Parting::default() };
        let error = ArrayUnwrapper::new().parting(wrong).run(&positions, &indices).unwrap_err().to_string();
        assert_eq!(error, "coverage must be in (0, 1], got 2");
    }

    #[test]
    fn what_is_no_mesh_is_named() {
        let run = |indices: &[u32]| ArrayUnwrapper::new().run(&[[0.0; 3]; 3], indices).unwrap_err();
        assert_eq!(run(&[0, 1]), ArrayError::IndexCount { count: 2 });
        assert_eq!(run(&[0, 1, 7]), ArrayError::Index { triangle: 0, index: 7, vertex_count: 3 });
    }
}
