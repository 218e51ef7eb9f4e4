//! The islands of a UV map.

use super::super::AtlasError;
use super::super::judge::{Judge, Proved, Selected, has_area};
use super::super::outline;
use super::overlapping::overlapping;
use super::stacked::Stacked;
use super::xy;
use abf_mesh::{DisjointSets, FaceId, Point2, TriMesh, UvId, UvMap};
use abf_metrics::{MetricsError, Precision};
use std::collections::HashMap;

/// The islands of a map, and which lie over each other.
pub(super) struct Islands<'a> {
    uv: &'a UvMap,
    /// The island of every face.
    pub(super) of_face: Vec<usize>,
    /// The faces of every island, ascending.
    pub(super) faces: Vec<Vec<FaceId>>,
    /// Those that are judged.
    pub(super) judged: Vec<Vec<FaceId>>,
    /// The faces that repair turned around, ascending, those that are not judged left out.
    pub(super) turned: Vec<FaceId>,
    /// How many faces have the vertices and the UVs of an earlier one.
    pub(super) shared: usize,
    /// What is proved of every island.
    pub(super) proved: Vec<Proved>,
    /// Whether all faces of an island that are judged are lines. It is put into one point: rounding would make triangles of
    /// them.
    is_line: Vec<bool>,
    /// The lowest island of those that lie over each other.
    bundle: Vec<usize>,
    /// Whether an island lies over no other one.
    is_single: Vec<bool>,
}

impl<'a> Islands<'a> {
    /// The islands of a map, which has a point for every corner of the mesh.
    pub(super) fn find(
        mesh: &TriMesh,
        (uv, of_face): (&'a UvMap, Vec<usize>),
        selected: Selected,
        precision: Precision,
    ) -> Result<Self, AtlasError> {
        let shared = selected.shared();
        let Selected { faces: all_judged, turned, .. } = selected;
        let count = of_face.iter().max().map_or(0, |last| last + 1);
        let by_island = |faces: &mut dyn Iterator<Item = FaceId>| {
            let mut of_island = vec![Vec::new(); count];
            faces.for_each(|f| of_island[of_face[f.index()]].push(f));
            of_island
        };
        let faces = by_island(&mut (0..of_face.len()).map(FaceId::new));
        let judged = by_island(&mut all_judged.iter().copied());
        let judge = Judge::new(mesh, &turned, uv, precision);
        let whole = judge.certificate(&[all_judged])?;
        // Of an island that is not judged nothing is proved: its faces may be lines.
        let of_none = |judged: &Vec<FaceId>| Proved { is_valid: !judged.is_empty(), is_injective: !judged.is_empty() };
        let mut found = Self {
            uv,
            proved: judged.iter().map(of_none).collect(),
            is_line: vec![false; count],
            of_face,
            judged,
            turned: Vec::new(),
            shared,
            bundle: (0..count).collect(),
            is_single: vec![true; count],
            faces,
        };
        // An island whose faces are all shared stays with the one that it shares them with.
        if !whole.injective() || shared > 0 {
            for (i, faces) in found.judged.iter().enumerate().filter(|(_, faces)| !faces.is_empty()) {
                found.proved[i] = match judge.certificate_of(faces) {
                    Err(MetricsError::NoArea { .. }) => Proved { is_valid: false, is_injective: false },
                    certificate => Proved::of(&certificate?),
                };
                found.is_line[i] = !found.proved[i].is_valid && judge.are_flat(faces);
            }
            for (faces, _) in found.judged.iter_mut().zip(&found.is_line).filter(|(_, is_line)| **is_line) {
                // Without area in one point they are nothing to judge.
                faces.retain(|&f| has_area(mesh, f));
            }
            let mut sets = DisjointSets::new(count);
            overlapping(uv, &found.of_face, &mut sets);
            found.bundle = (0..count).map(|i| sets.find(i)).collect();
            for (i, &lowest) in found.bundle.iter().enumerate().filter(|&(i, &lowest)| i != lowest) {
                (found.is_single[i], found.is_single[lowest]) = (false, false);
            }
        }
        found.turned = turned;
        Ok(found)
    }

    pub(super) fn len(&self) -> usize {
        self.faces.len()
    }

    /// Whether an island lies neither over itself nor over another one.
    pub(super) fn is_alone(&self, island: usize) -> bool {
        self.proved[island].is_injective && self.is_single[island]
    }

    /// Islands that lie over each other, those that are laid upon others left out.
    pub(super) fn bundles(&self, stacked_on: &[Option<Stacked>]) -> Vec<Vec<usize>> {
        let mut of_lowest = vec![Vec::new(); self.len()];
        for (i, _) in stacked_on.iter().enumerate().filter(|(_, leader)| leader.is_none()) {
            of_lowest[self.bundle[i]].push(i);
        }
        of_lowest.retain(|bundle| !bundle.is_empty());
        of_lowest
    }

    /// For every island the lowest vertex that is connected with it.
    pub(super) fn components(&self, mesh: &TriMesh) -> Vec<usize> {
        let mut sets = DisjointSets::new(mesh.vertex_count());
        for [a, b, c] in mesh.faces() {
            sets.unite(a.index(), b.index());
            sets.unite(a.index(), c.index());
        }
        self.faces.iter().map(|faces| sets.find(mesh.faces()[faces[0].index()][0].index())).collect()
    }

    /// The UV points of the corners of an island's faces that are judged, three for each; of all its faces where none is.
    pub(super) fn corners(&self, island: usize) -> impl Iterator<Item = UvId> + '_ {
        let judged = &self.judged[island];
        self.ids(if judged.is_empty() { &self.faces[island] } else { judged })
    }

    /// Those of all its faces.
    pub(super) fn all_corners(&self, island: usize) -> impl Iterator<Item = UvId> + '_ {
        self.ids(&self.faces[island])
    }

    fn ids<'f>(&'f self, faces: &'f [FaceId]) -> impl Iterator<Item = UvId> + 'f {
        faces.iter().flat_map(|face| face.corners()).map(|corner| self.uv.corners()[corner.index()])
    }

    fn first_point(&self, island: usize) -> Point2<f64> {
        self.uv.corner(self.faces[island][0].corner(0))
    }

    pub(super) fn point(&self, id: UvId) -> [f64; 2] {
        xy(self.uv.points()[id.index()])
    }

    /// The least and the greatest coordinates that corners have.
    pub(super) fn extent(&self) -> [[f64; 2]; 2] {
        let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        self.uv.corners().iter().map(|&id| self.point(id)).fold(start, |[low, high], p| {
            [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
        })
    }

    /// What an island covers.
    pub(super) fn polygons(&self, island: usize) -> Vec<Vec<Vec<[f64; 2]>>> {
        if self.is_line[island] {
            return vec![vec![vec![xy(self.first_point(island)); 3]]];
        }
        outline::polygons(self.joined(island).triangles(), |id| self.point(id), self.proved[island].is_injective)
    }

    /// The triangles of an island, points in one place made one.
    pub(super) fn joined(&self, island: usize) -> Joined {
        let mut ids: Vec<UvId> = self.corners(island).collect();
        let key = |id: &UvId| (self.point(*id).map(|x| (x + 0.0).to_bits()), *id);
        ids.sort_unstable_by_key(key);
        ids.dedup();
        let first: HashMap<UvId, UvId> =
            ids.chunk_by(|a, b| key(a).0 == key(b).0).flat_map(|same| same.iter().map(|&id| (id, same[0]))).collect();
        Joined(self.corners(island).map(|id| first[&id]).collect())
    }

    /// The map with every point moved as its island is.
    pub(super) fn moved(
        &self,
        stacked_on: &[Option<Stacked>],
        place: impl Fn(usize, Point2<f64>) -> Point2<f64>,
    ) -> UvMap {
        let mut points = vec![Point2::origin(); self.uv.points().len()];
        for (island, leader) in stacked_on.iter().enumerate() {
            match leader {
                None => {
                    let first = self.first_point(island);
                    self.all_corners(island).for_each(|id| {
                        let p = if self.is_line[island] { first } else { self.uv.points()[id.index()] };
                        points[id.index()] = place(island, p);
                    });
                }
                Some(leader) => leader.points.iter().for_each(|&(own, upon)| {
                    points[own.index()] = place(leader.on, self.uv.points()[upon.index()]);
                }),
            }
        }
        UvMap::new(points, self.uv.corners().to_vec())
    }
}

/// Triangles with one point in every place.
pub(super) struct Joined(Vec<UvId>);

impl Joined {
    pub(super) fn triangles(&self) -> impl Iterator<Item = [UvId; 3]> + '_ {
        self.0.as_chunks::<3>().0.iter().copied()
    }
}
