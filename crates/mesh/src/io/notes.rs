//! What reading did, and what it left alone.

use std::collections::BTreeMap;
use std::fmt;

use super::polygon::Cut;

/// Everything that reading did beyond copying, and everything it left alone.
///
/// The default says that nothing of the kind happened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReadNotes {
    /// How many faces had more than three corners and were cut into triangles.
    pub polygons_fanned: usize,
    /// How many triangles those made.
    pub triangles_from_polygons: usize,
    /// How many of those are no fan around their first corner, because that would leave the outline or, in a polygon that
    /// is not convex, make a triangle without area.
    pub polygons_not_fanned: usize,
    /// How many of those have corners off their plane, by more than a thousandth of their extent.
    pub polygons_not_planar: usize,
    /// How many of those cross or touch themselves; they are fans, in which some triangles are turned over.
    pub polygons_crossing: usize,
    /// Vertices that no face uses; they are kept.
    pub unreferenced_vertices: usize,
    /// UVs that no corner uses; they are not in the map.
    pub unreferenced_uvs: usize,
    /// How many corners (STL, which has no other way to share a vertex) or vertices (glTF, which splits them where
    /// normals differ) found a vertex at their exact position already there.
    pub vertices_welded: usize,
    /// Why there is no UV map though the file has UVs.
    pub uv_dropped: Option<UvDropped>,
    /// The number `n` of the `TEXCOORD_n` of a glTF that the UVs are, where that is not 0.
    pub texcoord: Option<u32>,
    /// Whether the file stores its UVs with 24 bits (PLY's `float`): what is proved of them is to be proved of those.
    pub uv_single: bool,
    /// Whether the last line is missing (`endsolid` of STL); everything before it is complete.
    pub end_missing: bool,
    /// What the nodes of a glTF do to the sizes of its meshes, in words.
    pub scene: Option<String>,
    /// What was not read: keywords of OBJ, properties and elements of PLY and the like, with how
    /// many there were of each.
    pub ignored: BTreeMap<String, usize>,
    /// The material libraries that an OBJ names, as written. They are not read.
    pub material_libraries: Vec<String>,
}

/// Why the UVs of a file are not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UvDropped {
    /// Some corners have none.
    CornersWithout {
        /// How many.
        corners: usize,
    },
    /// A glTF does not have the set that was asked for, and has another.
    OtherSet {
        /// The number of the one that was asked for.
        asked: u32,
        /// That of the first that all triangles have.
        other: u32,
    },
    /// Some that corners use are NaN or infinite.
    NotFinite {
        /// How many.
        points: usize,
    },
}

impl fmt::Display for UvDropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CornersWithout { corners } => f.write_str(&counted(*corners, "corner has none", "corners have none")),
            Self::OtherSet { asked, other } => {
                write!(f, "not all triangles have TEXCOORD_{asked}, but all have TEXCOORD_{other}")
            }
            Self::NotFinite { points } => {
                f.write_str(&counted(*points, "of them is not finite", "of them are not finite"))
            }
        }
    }
}

/// A number, and the word for one or for several.
fn counted(n: usize, one: &str, several: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { several })
}

impl ReadNotes {
    /// One sentence for every note that has something to say.
    #[must_use]
    pub fn sentences(&self) -> Vec<String> {
        let mut out = Vec::new();
        let mut say = |count: usize, text: String| {
            if count > 0 {
                out.push(text);
            }
        };
        let (n, made) = (self.polygons_fanned, self.triangles_from_polygons);
        say(n, format!("{} cut into {made} triangles", counted(n, "polygon", "polygons")));
        let bent = self.polygons_not_planar;
        say(bent, counted(bent, "polygon is not planar", "polygons are not planar"));
        let crossing = counted(self.polygons_crossing, "polygon crosses itself", "polygons cross themselves");
        say(self.polygons_crossing, format!("{crossing}: some of the triangles are turned over"));
        let unused = self.unreferenced_vertices;
        say(unused, counted(unused, "vertex that no face uses kept", "vertices that no face uses kept"));
        let unused = self.unreferenced_uvs;
        say(unused, counted(unused, "UV that no corner uses left out", "UVs that no corner uses left out"));
        let welded = counted(self.vertices_welded, "vertex", "vertices");
        say(self.vertices_welded, format!("{welded} welded by exact position"));
        if let Some(why) = self.uv_dropped {
            say(1, format!("UVs left out: {why}"));
        }
        if let Some(set) = self.texcoord {
            say(1, format!("its UVs are those of TEXCOORD_{set}"));
        }
        say(usize::from(self.end_missing), "the last line, `endsolid`, is missing".to_owned());
        if let Some(scene) = &self.scene {
            say(1, scene.clone());
        }
        let ignored: Vec<String> = self.ignored.iter().map(|(what, n)| format!("{what} ({n})")).collect();
        say(ignored.len(), format!("not read: {}", ignored.join(", ")));
        let libraries = &self.material_libraries;
        say(libraries.len(), format!("material libraries named: {}", libraries.join(", ")));
        out
    }

    /// Counts a polygon of more than three corners.
    pub(super) fn polygon(&mut self, triangles: usize, cut: &Cut) {
        self.polygons_fanned += 1;
        self.triangles_from_polygons += triangles;
        self.polygons_not_fanned += usize::from(cut.inside.is_some());
        self.polygons_not_planar += usize::from(cut.is_bent);
        self.polygons_crossing += usize::from(cut.is_crossing);
    }

    /// Counts one more of something that is not read.
    pub(super) fn ignore(&mut self, what: &str) {
        self.ignore_many(what, 1);
    }

    /// Counts `count` more of something that is not read.
    pub(super) fn ignore_many(&mut self, what: &str, count: usize) {
        if count == 0 {
            return;
        }
        // `entry` would need an owned key for every line of normals.
        if let Some(n) = self.ignored.get_mut(what) {
            *n += count;
        } else {
            self.ignored.insert(what.to_owned(), count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_notes_with_something_to_say_speak() {
        assert!(ReadNotes::default().sentences().is_empty());
        let mut notes = ReadNotes { polygons_fanned: 2, triangles_from_polygons: 5, ..ReadNotes::default() };
        notes.ignore("vn");
        notes.ignore_many("l", 3);
        notes.ignore("vn");
        notes.uv_dropped = Some(UvDropped::CornersWithout { corners: 7 });
        assert_eq!(
            notes.sentences(),
            ["2 polygons cut into 5 triangles", "UVs left out: 7 corners have none", "not read: l (3), vn (2)"]
        );
    }
}
