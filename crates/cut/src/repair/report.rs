//! What a repair did.

use abf_mesh::{GeometryError, TriMesh};

/// How many of a kind there are, and the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Found {
    /// How many.
    pub count: usize,
    /// The number of the first face or vertex of the input, counted from 0.
    pub first: Option<usize>,
}

impl Found {
    pub(crate) fn of(mut all: impl Iterator<Item = usize>) -> Self {
        let first = all.next();
        Self { count: usize::from(first.is_some()) + all.count(), first }
    }
}

/// Everything that [`repair`](super::repair()) did, and what it saw and left alone. The default says that the mesh was an
/// oriented manifold without anything to mention.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RepairReport {
    /// Faces dropped because an earlier one has the same three vertices; the first by its number.
    pub duplicate_faces: Found,
    /// Faces that have the same three vertices as an earlier one, and copies of them for a place of their own.
    pub double_faces: Found,
    /// Faces dropped because they use a vertex twice.
    pub repeated_vertex_faces: Found,
    /// Faces turned around to agree with most of their piece.
    pub turned_faces: Found,
    /// Edges of three or more faces, split; the first by one of its faces.
    pub non_manifold_edges: Found,
    /// Vertices split, so that each copy has one fan of faces. Ends of split and cut edges are among them.
    pub split_vertices: Found,
    /// Edges cut because the surface has one side only; the first by one of its faces.
    pub one_sided_cuts: Found,
    /// Vertices joined with another in the same place, before the repair ([`weld`](crate::weld())).
    pub joined_vertices: Found,
    /// Faces without area. They are kept.
    pub zero_area_faces: Found,
    /// Vertices that no face of the input uses. They are kept.
    pub unused_vertices: usize,
}

impl RepairReport {
    /// Whether the mesh was an oriented manifold once vertices in one place were joined. Faces without area and unused vertices change nothing about that.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.changes().iter().all(|(found, _)| found.count == 0)
    }

    /// One sentence for everything there is to say.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let joined = ["vertex joined with another in its place", "vertices joined with others in their place"];
        let kept = [
            (self.joined_vertices, joined),
            (self.zero_area_faces, ["face without area carried along", "faces without area carried along"]),
        ];
        let all = self.changes().into_iter().chain(kept).filter(|(found, _)| found.count > 0);
        let mut out: Vec<String> = all.map(|(found, what)| sentence(found, what)).collect();
        if self.unused_vertices > 0 {
            let unused = Found { count: self.unused_vertices, first: None };
            out.push(sentence(unused, ["vertex that no face uses kept", "vertices that no face uses kept"]));
        }
        out
    }

    /// What was changed, in words for one and for several.
    fn changes(&self) -> [(Found, [&'static str; 2]); 7] {
        [
            (self.duplicate_faces, ["duplicate face dropped", "duplicate faces dropped"]),
            (self.double_faces, ["face on another given room of its own", "faces on others given room of their own"]),
            (
                self.repeated_vertex_faces,
                ["face that uses a vertex twice dropped", "faces that use a vertex twice dropped"],
            ),
            (self.turned_faces, ["face turned around", "faces turned around"]),
            (self.non_manifold_edges, ["edge of three or more faces split", "edges of three or more faces split"]),
            (self.split_vertices, ["vertex split", "vertices split"]),
            (
                self.one_sided_cuts,
                ["edge cut because the surface has one side only", "edges cut because the surface has one side only"],
            ),
        ]
    }

    /// Counts what is seen and left alone.
    pub(super) fn note_kept(&mut self, mesh: &TriMesh) {
        self.unused_vertices = mesh.unreferenced_vertices();
        if let Err(GeometryError::ZeroArea { first, count }) = mesh.check_geometry() {
            self.zero_area_faces = Found { count, first: Some(first.index()) };
        }
    }
}

fn sentence(found: Found, [one, several]: [&str; 2]) -> String {
    let Found { count, first } = found;
    let what = if count == 1 { one } else { several };
    first.map_or_else(|| format!("{count} {what}"), |first| format!("{count} {what} (the first at {first})"))
}
