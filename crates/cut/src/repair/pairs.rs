//! Which faces are joined along which edges.

use abf_mesh::{CornerId, DisjointSets, TriMesh, Vector3, VertexId};

/// An edge of three or more faces, more than which are not compared with each other.
const MANY: usize = 64;

/// For every corner the corner that faces the same edge from a face joined to its own.
pub(super) struct Pairs {
    partner: Vec<Option<CornerId>>,
    /// Corners that get a vertex of their own, whatever their neighbours are.
    alone: Vec<bool>,
    /// The edges of three or more faces.
    pub(super) crowded: Vec<Crowded>,
}

/// An edge of three or more faces.
pub(super) struct Crowded {
    /// The corners that face it, in ascending order.
    pub(super) corners: Vec<CornerId>,
    /// Whether its faces have been let go once.
    is_loose: bool,
}

/// The ends of the edge that a corner faces, the lower first.
fn edge(corner_vertex: &[VertexId], c: CornerId) -> [VertexId; 2] {
    let [a, b] = [c.next(), c.prev()].map(|e| corner_vertex[e.index()]);
    [a.min(b), a.max(b)]
}

/// Corners by the edge they face, in ascending order.
fn by_edge(corner_vertex: &[VertexId]) -> Vec<([VertexId; 2], CornerId)> {
    let mut all: Vec<_> = (0..corner_vertex.len()).map(CornerId::new).map(|c| (edge(corner_vertex, c), c)).collect();
    all.sort_unstable();
    all
}

impl Pairs {
    /// Joins two faces wherever an edge has two.
    pub(super) fn of_edges(faces: &[[VertexId; 3]]) -> Self {
        let corner_vertex = faces.as_flattened();
        let mut pairs = Self {
            partner: vec![None; corner_vertex.len()],
            alone: vec![false; corner_vertex.len()],
            crowded: Vec::new(),
        };
        for same in by_edge(corner_vertex).chunk_by(|a, b| a.0 == b.0) {
            match *same {
                [_] => {}
                [(_, c), (_, o)] => pairs.join(c, o),
                _ => pairs.crowded.push(Crowded { corners: same.iter().map(|&(_, c)| c).collect(), is_loose: false }),
            }
        }
        pairs
    }

    pub(super) fn join(&mut self, c: CornerId, o: CornerId) {
        self.partner[c.index()] = Some(o);
        self.partner[o.index()] = Some(c);
    }

    pub(super) fn let_go(&mut self, c: CornerId) {
        if let Some(o) = self.partner[c.index()].take() {
            self.partner[o.index()] = None;
        }
    }

    pub(super) fn partner(&self, c: CornerId) -> Option<CornerId> {
        self.partner[c.index()]
    }

    pub(super) fn is_alone(&self, c: CornerId) -> bool {
        self.alone[c.index()]
    }

    /// Every pair, the lower corner first.
    pub(super) fn all(&self) -> impl Iterator<Item = (CornerId, CornerId)> + '_ {
        let corners = (0..self.partner.len()).map(CornerId::new);
        corners.filter_map(|c| self.partner(c).filter(|&o| c < o).map(|o| (c, o)))
    }

    /// Joins faces at crowded edges two by two: those in one piece first, then those oriented alike, then the most
    /// coplanar.
    pub(super) fn join_crowded(&mut self, mesh: &TriMesh, faces: &[[VertexId; 3]]) {
        let mut pieces = DisjointSets::new(faces.len());
        self.all().for_each(|(c, o)| {
            pieces.unite(c.face().index(), o.face().index());
        });
        let corner_vertex = faces.as_flattened();
        let mut joined = Vec::new();
        for crowd in self.crowded.iter().filter(|crowd| crowd.corners.len() <= MANY) {
            let pages: Vec<Page> = crowd.corners.iter().map(|&c| Page::new(mesh, corner_vertex, c)).collect();
            let mut choices = Vec::new();
            for (i, a) in pages.iter().enumerate() {
                for b in &pages[i + 1..] {
                    let apart = pieces.find(a.corner.face().index()) != pieces.find(b.corner.face().index());
                    choices.push((apart, a.runs_up == b.runs_up, a.away.dot(&b.away), a.corner, b.corner));
                }
            }
            choices.sort_by(|a, b| {
                (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)).then((a.3, a.4).cmp(&(b.3, b.4)))
            });
            let mut is_taken = vec![false; crowd.corners.len()];
            let place = |c: CornerId| crowd.corners.partition_point(|&d| d < c);
            for (.., c, o) in choices {
                if !is_taken[place(c)] && !is_taken[place(o)] {
                    (is_taken[place(c)], is_taken[place(o)]) = (true, true);
                    joined.push((c, o));
                }
            }
        }
        joined.into_iter().for_each(|(c, o)| self.join(c, o));
    }

    /// Looks for edges between new vertices whose faces are not as these pairs say, and loosens something there. `true`
    /// when there were any: fans have to be made again.
    ///
    /// An edge of one face loses its partner. A crowded edge is let go of first. At any other, the corners of all its faces
    /// but the first get vertices of their own, which settles it.
    pub(super) fn let_go_of_conflicts(&mut self, faces: &[[VertexId; 3]], separated: &[[VertexId; 3]]) -> bool {
        let corner_vertex = separated.as_flattened();
        let all = by_edge(corner_vertex);
        let in_conflict = |pairs: &Self, same: &[([VertexId; 2], CornerId)]| match *same {
            // Its partner faces an edge between other copies: one of the two has a corner on its own.
            [(_, c)] => pairs.partner(c).is_some(),
            [(_, c), (_, o)] => pairs.partner(c) != Some(o),
            _ => true,
        };
        let conflicts: Vec<Vec<CornerId>> = all
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|same| in_conflict(self, same))
            .map(|same| same.iter().map(|&(_, c)| c).collect())
            .collect();
        for corners in &conflicts {
            if let [c] = corners[..] {
                self.let_go(c);
            } else if !self.loosen(faces, corners[0]) {
                self.settle(corners);
            }
        }
        !conflicts.is_empty()
    }

    /// Lets go of the crowded edge that a corner faces; `false` where there is none, or that has been done.
    fn loosen(&mut self, faces: &[[VertexId; 3]], c: CornerId) -> bool {
        let key = |c: CornerId| edge(faces.as_flattened(), c);
        let at = self.crowded.partition_point(|crowd| key(crowd.corners[0]) < key(c));
        let Some(crowd) = self.crowded.get_mut(at).filter(|crowd| key(crowd.corners[0]) == key(c) && !crowd.is_loose)
        else {
            return false;
        };
        crowd.is_loose = true;
        let corners = crowd.corners.clone();
        corners.into_iter().for_each(|c| self.let_go(c));
        true
    }

    fn settle(&mut self, corners: &[CornerId]) {
        for &c in &corners[1..] {
            self.let_go(c);
            self.alone[c.next().index()] = true;
        }
    }
}

/// A face at a crowded edge.
struct Page {
    corner: CornerId,
    /// Whether the face runs from the lower end of the edge to the upper.
    runs_up: bool,
    /// The unit vector from the edge into the face, perpendicular to the edge: of coplanar faces, opposite.
    away: Vector3<f64>,
}

impl Page {
    fn new(mesh: &TriMesh, corner_vertex: &[VertexId], corner: CornerId) -> Self {
        let [tip, a, b] = [corner, corner.next(), corner.prev()].map(|c| corner_vertex[c.index()]);
        let at = |v: VertexId| mesh.positions()[v.index()];
        let along = (at(b) - at(a)).try_normalize(0.0).unwrap_or_default();
        let into = at(tip) - at(a);
        let away = (into - along * into.dot(&along)).try_normalize(0.0).unwrap_or_default();
        Self { corner, runs_up: a < b, away }
    }
}
