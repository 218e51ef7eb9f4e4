//! The islands of a UV map.

use super::super::AtlasError;
use super::super::judge::{Judge, Proved, sharing};
use super::super::outline;
use super::overlapping::overlapping;
use super::stacked::Stacked;
use super::xy;
use abf_cut::Repaired;
use abf_mesh::{DisjointSets, FaceId, Point2, TriMesh, UvId, UvMap};
use abf_metrics::{Precision, charts};
use std::borrow::Cow;
use std::collections::HashMap;

/// The islands of a map, and which lie over each other.
pub(super) struct Islands<'a> {
    uv: &'a UvMap,
    /// The island of every face.
    pub(super) of_face: Vec<usize>,
    /// The faces of every island, ascending.
    pub(super) faces: Vec<Vec<FaceId>>,
    /// Those that are judged: without faces that have the vertices and the UVs of an earlier one.
    pub(super) judged: Vec<Vec<FaceId>>,
    /// The faces that repair turned around, ascending, those that are not judged left out.
    pub(super) turned: Vec<FaceId>,
    /// What is proved of every island.
    pub(super) proved: Vec<Proved>,
    /// The lowest island of those that lie over each other.
    bundle: Vec<usize>,
    /// Whether an island lies over no other one.
    is_single: Vec<bool>,
}

impl<'a> Islands<'a> {
    pub(super) fn find(
        mesh: &TriMesh,
        repaired: Option<&(Cow<'_, TriMesh>, Repaired)>,
        uv: &'a UvMap,
        precision: Precision,
    ) -> Result<Self, AtlasError> {
        let of_face = charts(mesh, uv)?;
        // What is shared is looked up in the UVs, which are known to be those of the mesh by now.
        let is_shared = repaired.map_or_else(|| vec![false; mesh.face_count()], |(joined, _)| sharing(joined, uv));
        let mut turned = repaired.map(|(_, repaired)| repaired.turned_faces()).unwrap_or_default();
        turned.retain(|f| !is_shared[f.index()]);
        let count = of_face.iter().max().map_or(0, |last| last + 1);
        let mut faces = vec![Vec::new(); count];
        of_face.iter().enumerate().for_each(|(f, &island)| faces[island].push(FaceId::new(f)));
        let is_judged = |f: &FaceId| !is_shared[f.index()];
        let judged: Vec<Vec<FaceId>> =
            faces.iter().map(|faces: &Vec<FaceId>| faces.iter().copied().filter(is_judged).collect()).collect();
        let judge = Judge::new(mesh, &turned, uv, precision);
        let whole = judge.certificate(&[judged.concat()])?;
        let mut found = Self {
            uv,
            of_face,
            judged,
            turned: Vec::new(),
            proved: vec![Proved { is_valid: true, is_injective: true }; count],
            bundle: (0..count).collect(),
            is_single: vec![true; count],
            faces,
        };
        // An island whose faces are all shared stays with the one that it shares them with.
        if !whole.injective() || found.shared() > 0 {
            for (i, faces) in found.judged.iter().enumerate().filter(|(_, faces)| !faces.is_empty()) {
                found.proved[i] = Proved::of(&judge.certificate_of(faces)?);
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

    /// How many faces have the vertices and the UVs of an earlier one.
    pub(super) fn shared(&self) -> usize {
        self.of_face.len() - self.judged.iter().map(Vec::len).sum::<usize>()
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
                None => self.all_corners(island).for_each(|id| {
                    points[id.index()] = place(island, self.uv.points()[id.index()]);
                }),
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
