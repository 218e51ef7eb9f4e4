//! A corner table that shrinks: edges of it collapse.

use abf_mesh::{CornerId, Topology};

/// "No corner", "no vertex".
pub(crate) const NONE: u32 = u32::MAX;

/// A vertex with more faces is never removed.
pub(crate) const MOST_FACES: usize = 14;

/// A collapse may leave no vertex of more than `MOST_VALENCE − 4` neighbours.
const MOST_VALENCE: usize = 18;

/// Corner `3f + k` sits at vertex `k` of face `f`. The names are those of [`Topology`].
pub(crate) struct Working {
    vertex: Vec<u32>,
    opposite: Vec<u32>,
    /// A corner at every vertex, on the boundary the first counter-clockwise; `NONE` for a vertex without faces.
    start: Vec<u32>,
    interior: Vec<bool>,
    faces: usize,
}

/// The neighbours of a vertex, counter-clockwise.
#[derive(Clone, Copy)]
pub(crate) struct Ring {
    vertices: [u32; MOST_FACES + 1],
    len: usize,
    /// Whether there is a face between the last and the first.
    pub(crate) is_closed: bool,
}

impl Ring {
    pub(crate) fn vertices(&self) -> &[u32] {
        &self.vertices[..self.len]
    }

    /// Which neighbours the vertex may collapse into, by their places in the ring: on the boundary those along it.
    pub(crate) fn targets(&self) -> impl Iterator<Item = usize> + use<> {
        let (last, step) = (self.len - 1, if self.is_closed { 1 } else { self.len - 1 });
        (0..=last).step_by(step)
    }
}

fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

fn prev(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

impl Working {
    pub(crate) fn new(topology: &Topology) -> Self {
        let packed = |corner: Option<CornerId>| corner.map_or(NONE, |c| c.index() as u32);
        Self {
            vertex: topology.corners().map(|c| topology.vertex(c).index() as u32).collect(),
            opposite: topology.packed_opposites().to_vec(),
            start: topology.vertices().map(|v| packed(topology.fan_start(v))).collect(),
            interior: topology.vertices().map(|v| topology.is_interior(v)).collect(),
            faces: topology.face_count(),
        }
    }

    /// How many faces are left.
    pub(crate) fn face_count(&self) -> usize {
        self.faces
    }

    /// The faces that are left, by their vertices.
    pub(crate) fn faces(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.vertex.as_chunks::<3>().0.iter().filter(|face| face[0] != NONE).copied()
    }

    /// Whether some face is left at a vertex.
    pub(crate) fn is_used(&self, vertex: u32) -> bool {
        self.start[vertex as usize] != NONE
    }

    /// Whether a vertex is not on the boundary.
    pub(crate) fn is_interior(&self, vertex: u32) -> bool {
        self.interior[vertex as usize]
    }

    fn across(&self, corner: u32) -> Option<u32> {
        Some(self.opposite[corner as usize]).filter(|&c| c != NONE)
    }

    fn rotate_ccw(&self, corner: u32) -> Option<u32> {
        self.across(next(corner)).map(next)
    }

    fn rotate_cw(&self, corner: u32) -> Option<u32> {
        self.across(prev(corner)).map(prev)
    }

    fn fan(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let start = self.start[vertex as usize];
        std::iter::successors(Some(start), move |&c| self.rotate_ccw(c).filter(|&c| c != start))
    }

    /// The ring of a vertex that has faces; `None` where there are too many.
    pub(crate) fn ring(&self, vertex: u32) -> Option<Ring> {
        let mut ring = Ring { vertices: [NONE; MOST_FACES + 1], len: 0, is_closed: self.interior[vertex as usize] };
        let mut last = NONE;
        for corner in self.fan(vertex) {
            if ring.len == MOST_FACES {
                return None;
            }
            ring.vertices[ring.len] = self.vertex[next(corner) as usize];
            ring.len += 1;
            last = corner;
        }
        if !ring.is_closed {
            ring.vertices[ring.len] = self.vertex[prev(last) as usize];
            ring.len += 1;
        }
        Some(ring)
    }

    /// Whether `vertex`, which has this ring, may collapse into `ring[place]`: the result is a manifold of the same kind
    /// (the link condition: the two have no other common neighbours than the edge has faces), and no neighbour gets
    /// too many others.
    pub(crate) fn may_collapse(&self, vertex: u32, ring: &Ring, place: usize) -> bool {
        let target = ring.vertices()[place];
        let (mut valence, mut common, mut last) = (0, 0, NONE);
        let is_common = |v: u32| ring.vertices().contains(&v);
        for corner in self.fan(target) {
            valence += 1;
            common += usize::from(is_common(self.vertex[next(corner) as usize]));
            last = corner;
        }
        if !self.interior[target as usize] {
            valence += 1;
            common += usize::from(is_common(self.vertex[prev(last) as usize]));
        }
        // An ear ends with its only face: that needs a neighbour.
        let is_joined = ring.len > 2 || self.across(self.start[vertex as usize]).is_some();
        common == if ring.is_closed { 2 } else { 1 } && valence + ring.len <= MOST_VALENCE && is_joined
    }

    /// Moves `vertex`, which has this ring, into a neighbour for which [`Working::may_collapse`] holds.
    pub(crate) fn collapse(&mut self, vertex: u32, ring: &Ring, target: u32) {
        let mut corners = [NONE; MOST_FACES];
        let mut count = 0;
        for corner in self.fan(vertex) {
            corners[count] = corner;
            count += 1;
        }
        for &corner in &corners[..count] {
            let (a, b) = (next(corner), prev(corner));
            if self.vertex[a as usize] == target {
                self.end_face([corner, a, b]);
            } else if self.vertex[b as usize] == target {
                self.end_face([corner, b, a]);
            } else {
                self.vertex[corner as usize] = target;
                self.start[target as usize] = corner;
            }
        }
        self.start[vertex as usize] = NONE;
        for &v in ring.vertices() {
            self.restart(v);
        }
    }

    /// Ends the face of the corners at the vertex that goes, its target, and the third; its neighbours become neighbours.
    fn end_face(&mut self, [vertex, target, third]: [u32; 3]) {
        let [beyond, beside] = [vertex, target].map(|c| self.opposite[c as usize]);
        let stays = [target, third].map(|c| self.vertex[c as usize]);
        for (corner, facing) in [(beyond, beside), (beside, beyond)] {
            if corner != NONE {
                self.opposite[corner as usize] = facing;
                for end in [next(corner), prev(corner)] {
                    let v = self.vertex[end as usize];
                    if stays.contains(&v) {
                        self.start[v as usize] = end;
                    }
                }
            }
        }
        for corner in [vertex, target, third] {
            self.vertex[corner as usize] = NONE;
        }
        self.faces -= 1;
    }

    /// Brings the first corner of a vertex back to the beginning of its fan.
    fn restart(&mut self, vertex: u32) {
        let any = self.start[vertex as usize];
        let mut first = any;
        while !self.interior[vertex as usize]
            && let Some(before) = self.rotate_cw(first).filter(|&c| c != any)
        {
            first = before;
        }
        self.start[vertex as usize] = first;
    }
}
