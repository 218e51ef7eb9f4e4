//! The islands of a UV map.

use super::super::AtlasError;
use super::super::judge::Judge;
use super::super::outline;
use super::overlapping::overlapping;
use super::stacked::Stacked;
use super::xy;
use abf_mesh::{DisjointSets, FaceId, Point2, TriMesh, UvId, UvMap};
use abf_metrics::{Precision, charts};
use std::collections::HashMap;

/// The islands of a map, and which lie over each other.
pub(super) struct Islands<'a> {
    uv: &'a UvMap,
    /// The island of every face.
    pub(super) of_face: Vec<usize>,
    /// The faces of every island, ascending.
    pub(super) faces: Vec<Vec<FaceId>>,
    /// Whether an island is locally injective.
    pub(super) is_valid: Vec<bool>,
    /// Whether it lies nowhere over itself, either.
    is_injective: Vec<bool>,
    /// The lowest island of those that lie over each other.
    bundle: Vec<usize>,
    /// Whether an island lies over no other one.
    is_single: Vec<bool>,
}

impl<'a> Islands<'a> {
    pub(super) fn find(
        mesh: &TriMesh,
        turned: &[FaceId],
        uv: &'a UvMap,
        precision: Precision,
    ) -> Result<Self, AtlasError> {
        let of_face = charts(mesh, uv)?;
        let count = of_face.iter().max().map_or(0, |last| last + 1);
        let mut faces = vec![Vec::new(); count];
        of_face.iter().enumerate().for_each(|(f, &island)| faces[island].push(FaceId::new(f)));
        let judge = Judge::new(mesh, turned, uv, precision);
        let whole = judge.certificate(&[(0..mesh.face_count()).map(FaceId::new).collect()])?;
        let mut found = Self {
            uv,
            of_face,
            is_valid: vec![true; count],
            is_injective: vec![true; count],
            bundle: (0..count).collect(),
            is_single: vec![true; count],
            faces,
        };
        if !whole.injective() {
            for (i, faces) in found.faces.iter().enumerate() {
                let own = judge.certificate_of(faces)?;
                found.is_valid[i] = own.valid();
                found.is_injective[i] = own.injective();
            }
            let mut sets = DisjointSets::new(count);
            overlapping(uv, &found.of_face, &mut sets);
            found.bundle = (0..count).map(|i| sets.find(i)).collect();
            for (i, &lowest) in found.bundle.iter().enumerate().filter(|&(i, &lowest)| i != lowest) {
                (found.is_single[i], found.is_single[lowest]) = (false, false);
            }
        }
        Ok(found)
    }

    pub(super) fn len(&self) -> usize {
        self.faces.len()
    }

    /// Whether an island lies neither over itself nor over another one.
    pub(super) fn is_alone(&self, island: usize) -> bool {
        self.is_injective[island] && self.is_single[island]
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

    /// The UV points of an island's corners, three for each of its faces.
    pub(super) fn corners(&self, island: usize) -> impl Iterator<Item = UvId> + '_ {
        self.faces[island].iter().flat_map(|face| face.corners()).map(|corner| self.uv.corners()[corner.index()])
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
        outline::polygons(self.joined(island).triangles(), |id| self.point(id), self.is_injective[island])
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
                None => self.corners(island).for_each(|id| {
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
