//! Copies the text of an OBJ, with other UVs.

use super::super::super::text::{Words, integer};
use super::super::write::{decimal, index};
use super::ObjWritten;
use crate::{UvId, UvMap};

/// A statement of the text, perhaps of several lines.
pub(super) struct Statement<'a> {
    /// Where it begins.
    pub(super) start: usize,
    /// Its text without the last line end.
    pub(super) text: &'a [u8],
    /// Where the next begins.
    pub(super) end: usize,
}

/// The triangles of a polygon.
pub(super) struct Triangles<'a> {
    /// Their places in the polygon; a fan if there are none.
    pub(super) inside: Option<&'a Vec<[u32; 3]>>,
    /// The UVs of their corners.
    pub(super) corners: &'a [UvId],
}

impl Triangles<'_> {
    /// Every triangle: its places in the polygon, and its UVs.
    fn each(&self) -> impl Iterator<Item = ([usize; 3], &[UvId; 3])> {
        let places = |k: usize| self.inside.map_or([0, k + 1, k + 2], |own| own[k].map(|c| c as usize));
        self.corners.as_chunks().0.iter().enumerate().map(move |(k, ids)| (places(k), ids))
    }
}

/// Whether two corners of a polygon of so many triangles are neighbours on its outline.
pub(super) fn is_side(a: u32, b: u32, triangles: u32) -> bool {
    a.abs_diff(b) == 1 || a.abs_diff(b) == triangles + 1
}

/// Copies the text, and writes other things in between.
pub(super) struct Pen<'a> {
    pub(super) text: &'a [u8],
    pub(super) uv: &'a UvMap,
    pub(super) out: Vec<u8>,
    /// What of the text has been copied, or left out.
    pub(super) copied: usize,
    pub(super) uvs_written: bool,
    pub(super) written: ObjWritten,
}

impl Pen<'_> {
    /// Copies everything up to here.
    pub(super) fn copy_to(&mut self, end: usize) {
        self.out.extend_from_slice(&self.text[self.copied..end]);
        self.copied = end;
    }

    /// The end of the line of a statement; the last line of a file may have none.
    fn line_end(&self, statement: &Statement<'_>) -> &'static [u8] {
        match &self.text[statement.start + statement.text.len()..statement.end] {
            b"\r\n" => b"\r\n",
            b"\r" => b"\r",
            _ => b"\n",
        }
    }

    /// Leaves out a `vt`. The new ones stand where the first was.
    pub(super) fn uvs(&mut self, statement: &Statement<'_>) {
        self.all_uvs(statement);
        self.copy_to(statement.start);
        self.copied = statement.end;
    }

    /// Writes the new `vt` before a statement, if they are not written yet.
    fn all_uvs(&mut self, statement: &Statement<'_>) {
        if std::mem::replace(&mut self.uvs_written, true) {
            return;
        }
        self.copy_to(statement.start);
        let line_end = self.line_end(statement);
        for p in self.uv.points() {
            self.out.extend_from_slice(b"vt ");
            decimal(&mut self.out, p.x);
            self.out.push(b' ');
            decimal(&mut self.out, p.y);
            self.out.extend_from_slice(line_end);
        }
    }

    /// Writes a polygon with the UVs of the corners of its triangles.
    pub(super) fn face(
        &mut self,
        statement: &Statement<'_>,
        keyword: &[u8],
        mut words: Words<'_>,
        own: &Triangles<'_>,
    ) {
        self.all_uvs(statement);
        let Some(ids) = self.polygon_uvs(own) else {
            return self.triangles(statement, keyword, words, own);
        };
        for id in ids {
            let Some(word) = words.next() else { return };
            let end = statement.start + statement.text.len() - words.bytes_left();
            self.copy_to(end - word.len());
            self.corner(word, Some(id));
            self.copied = end;
        }
    }

    /// The UV of every corner of a polygon, if its triangles agree.
    fn polygon_uvs(&self, own: &Triangles<'_>) -> Option<Vec<UvId>> {
        let bits = |id: UvId| {
            let p = self.uv.points()[id.index()];
            [p.x.to_bits(), p.y.to_bits()]
        };
        let same = |a: UvId, b: UvId| a == b || bits(a) == bits(b);
        let mut ids: Vec<Option<UvId>> = vec![None; own.corners.len() / 3 + 2];
        for (places, triangle) in own.each() {
            for (place, &id) in places.into_iter().zip(triangle) {
                if !same(id, *ids[place].get_or_insert(id)) {
                    return None;
                }
            }
        }
        ids.into_iter().collect()
    }

    /// Writes the triangles of a polygon, one on each line; what followed the polygon follows the last.
    fn triangles(&mut self, statement: &Statement<'_>, keyword: &[u8], mut words: Words<'_>, own: &Triangles<'_>) {
        self.copy_to(statement.start);
        self.written.polygons_split += 1;
        let line_end = self.line_end(statement);
        let list: Vec<&[u8]> = words.by_ref().take(own.corners.len() / 3 + 2).collect();
        for (k, (places, ids)) in own.each().enumerate() {
            if k > 0 {
                self.out.extend_from_slice(line_end);
            }
            self.out.extend_from_slice(keyword);
            for (place, &id) in places.into_iter().zip(ids) {
                self.out.push(b' ');
                self.corner(list[place], Some(id));
            }
        }
        self.copied = statement.start + statement.text.len() - words.bytes_left();
    }

    /// Writes a corner with another UV, or without.
    fn corner(&mut self, word: &[u8], id: Option<UvId>) {
        let mut parts = word.split(|&b| b == b'/');
        self.out.extend_from_slice(parts.next().unwrap_or_default());
        let normal = parts.nth(1).filter(|part| !part.is_empty());
        if id.is_some() || normal.is_some() {
            self.out.push(b'/');
        }
        if let Some(id) = id {
            index(&mut self.out, id.index());
        }
        if let Some(normal) = normal {
            self.out.push(b'/');
            self.out.extend_from_slice(normal);
        }
    }

    /// Takes the UVs out of a statement that is no face.
    pub(super) fn without_uvs(&mut self, statement: &Statement<'_>, mut words: Words<'_>) {
        while let Some(word) = words.next() {
            // What is no index stays as it is: without its end it could mean something, such as a `\`.
            let vertex = word.split(|&b| b == b'/').next().unwrap_or_default();
            if vertex.len() < word.len() && integer::<i64>(vertex).is_some() {
                let end = statement.start + statement.text.len() - words.bytes_left();
                self.copy_to(end - word.len());
                self.corner(word, None);
                self.copied = end;
            }
        }
    }
}
