//! An OBJ kept as it was: the text of the file with other UVs.
//!
//! Everything but the `vt` lines and the UV indices stays to the byte: comments, materials, groups, smoothing, normals,
//! colours of vertices, polygons, the order and the ends of lines, continued lines. The new `vt` lines stand where the first
//! old one was, or else before the first face. Indices of vertices and normals are copied as text, so that negative ones
//! stay negative. Other statements that name UVs (`l`, `surf`) lose them, because the old ones are gone.

mod pen;

use std::collections::HashMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::OnceLock;

use super::super::WriteError;
use super::super::blocks::check;
use super::super::error::ReadError;
use super::super::file::replace;
use super::super::polygon::Inside;
use super::super::text::{Lines, Words, without_mark};
use super::super::{MeshFile, MeshFormat, check_readable};
use crate::{UvMap, VertexId};
use pen::{Pen, Statement, Triangles, is_side};

/// A name for every triangle.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Labels {
    /// The names, in the order of their first use.
    pub names: Vec<String>,
    /// For every triangle the place of its name among these.
    pub of_faces: Vec<u32>,
}

/// An OBJ file: its text and its mesh.
#[derive(Clone, Debug)]
pub struct ObjDocument {
    name: String,
    bytes: Vec<u8>,
    file: MeshFile,
    /// The polygons that are no fans.
    inside: Inside,
    /// What a pass over the statements finds, when it is asked for.
    statements: OnceLock<Statements>,
}

/// What the statements say besides the mesh.
#[derive(Clone, Debug)]
struct Statements {
    /// For every polygon how many triangles it became.
    polygons: Vec<u32>,
    groups: Labels,
    materials: Labels,
}

/// What was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ObjWritten {
    /// Polygons written as triangles, because a seam runs along a diagonal.
    pub polygons_split: usize,
}

impl ObjDocument {
    /// Reads a file.
    ///
    /// # Errors
    /// Those of [`read`](crate::io::read).
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        let name = path.display().to_string();
        match crate::io::read_bytes(path) {
            Ok(bytes) => Self::parse(&name, bytes),
            Err(cause) => Err(ReadError::Open { file: name, cause }),
        }
    }

    /// Reads the bytes of a file. The name serves the messages only.
    ///
    /// # Errors
    /// Those of [`parse`](crate::io::parse).
    pub fn parse(name: &str, bytes: Vec<u8>) -> Result<Self, ReadError> {
        check_readable(MeshFormat::Obj, name, &bytes)?;
        let (file, inside) = super::parse_with_polygons(name, &bytes)?;
        Ok(Self { name: name.to_owned(), bytes, file, inside, statements: OnceLock::new() })
    }

    /// The mesh, as [`read`](crate::io::read) gives it.
    #[must_use]
    pub fn file(&self) -> &MeshFile {
        &self.file
    }

    /// The mesh alone; the text is given back.
    #[must_use]
    pub fn into_file(self) -> MeshFile {
        self.file
    }

    /// Whether the text has comments, which a writer of meshes would not write again.
    #[must_use]
    pub fn has_comments(&self) -> bool {
        self.bytes.contains(&b'#')
    }

    /// The groups of the triangles: object (`o`) and group (`g`), with ` / ` between if there are both.
    #[must_use]
    pub fn groups(&self) -> &Labels {
        &self.statements().groups
    }

    /// The materials of the triangles (`usemtl`); an empty name before the first.
    #[must_use]
    pub fn materials(&self) -> &Labels {
        &self.statements().materials
    }

    /// The edges that polygons were cut along, which the file does not have: no seam should run there.
    #[must_use]
    pub fn diagonals(&self) -> Vec<[VertexId; 2]> {
        let faces = self.file.mesh.faces();
        let mut out = Vec::new();
        let mut first = 0;
        for (number, &triangles) in self.statements().polygons.iter().enumerate() {
            let next = first + triangles as usize;
            match self.inside.get(&number) {
                // Every triangle of a fan but the last ends at a diagonal.
                None => out.extend(faces[first..next].iter().take(triangles as usize - 1).map(|&[a, _, c]| [a, c])),
                Some(own) => out.extend(own.iter().zip(&faces[first..next]).flat_map(|(own, face)| {
                    let is_diagonal = |&(i, j): &(usize, usize)| own[i] < own[j] && !is_side(own[i], own[j], triangles);
                    [(0, 1), (1, 2), (2, 0)].into_iter().filter(is_diagonal).map(|(i, j)| [face[i], face[j]])
                })),
            }
            first = next;
        }
        out
    }

    /// Writes the text with these UVs to a file, which appears when it is complete.
    ///
    /// # Errors
    /// A [`WriteError`]; what stood under that name before is then still there.
    pub fn write(&self, path: &Path, uv: &UvMap) -> Result<ObjWritten, WriteError> {
        check(&self.file.mesh, Some(uv))?;
        let mut written = ObjWritten::default();
        replace(path, |out| {
            written = self.fill(out, uv)?;
            Ok(())
        })
        .map_err(|cause| WriteError::Io { target: path.display().to_string(), cause })?;
        Ok(written)
    }

    /// Writes the text with these UVs.
    ///
    /// # Errors
    /// A [`WriteError`].
    pub fn write_to(&self, out: impl Write, uv: &UvMap) -> Result<ObjWritten, WriteError> {
        check(&self.file.mesh, Some(uv))?;
        let mut out = BufWriter::new(out);
        let written = self.fill(&mut out, uv).and_then(|written| out.flush().map(|()| written));
        written.map_err(|cause| WriteError::Io { target: "output".to_owned(), cause })
    }

    fn statements(&self) -> &Statements {
        self.statements.get_or_init(|| {
            let Scan { polygons, groups, materials, .. } = Scan::of(&self.name, &self.bytes);
            debug_assert_eq!(groups.labels.of_faces.len(), self.file.mesh.face_count());
            Statements { polygons, groups: groups.labels, materials: materials.labels }
        })
    }

    fn fill(&self, out: &mut dyn Write, uv: &UvMap) -> io::Result<ObjWritten> {
        /// Bytes that are collected before they are written.
        const ENOUGH: usize = 1 << 16;
        let text = without_mark(&self.bytes);
        out.write_all(&self.bytes[..self.bytes.len() - text.len()])?;
        let mut pen = Pen { text, uv, out: Vec::new(), copied: 0, uvs_written: false, written: ObjWritten::default() };
        let mut polygons = self.statements().polygons.iter().enumerate();
        let mut corners = uv.corners();
        // A mark is gone already.
        let mut lines = Lines::after(&self.name, text, 0);
        let mut start = 0;
        while let Some(line) = lines.next_joined() {
            let end = lines.taken();
            let statement = Statement { start, text: line.text(), end };
            let mut words = Words::of(statement.text);
            match words.next() {
                Some(b"vt") => pen.uvs(&statement),
                Some(keyword @ (b"f" | b"fo")) => {
                    let (number, triangles) = polygons.next().map_or((0, 0), |(number, &n)| (number, n as usize));
                    let (own, others) = corners.split_at((3 * triangles).min(corners.len()));
                    corners = others;
                    pen.face(&statement, keyword, words, &Triangles { inside: self.inside.get(&number), corners: own });
                }
                Some(b"l" | b"surf") => pen.without_uvs(&statement, words),
                _ => {}
            }
            if pen.out.len() >= ENOUGH {
                out.write_all(&pen.out)?;
                pen.out.clear();
            }
            start = end;
        }
        pen.copy_to(text.len());
        out.write_all(&pen.out)?;
        Ok(pen.written)
    }
}

/// What a first pass over the text finds.
#[derive(Default)]
struct Scan {
    object: String,
    group: String,
    material: String,
    polygons: Vec<u32>,
    groups: Interned,
    materials: Interned,
}

impl Scan {
    fn of(name: &str, bytes: &[u8]) -> Self {
        let mut scan = Self::default();
        let mut lines = Lines::new(name, bytes);
        while let Some(line) = lines.next_joined() {
            let text = line.text();
            let mut words = Words::of(text);
            // Most lines are vertices, which are not looked at.
            match words.next() {
                Some(b"f" | b"fo") => scan.polygon(words.count()),
                Some(b"g") => (scan.group, scan.groups.current) = (words.remainder(), None),
                Some(b"o") => (scan.object, scan.groups.current) = (words.remainder(), None),
                Some(b"usemtl") => (scan.material, scan.materials.current) = (words.remainder(), None),
                _ => {}
            }
        }
        scan
    }

    fn polygon(&mut self, corners: usize) {
        // The reader refuses polygons of fewer than three corners, and more corners than ids can name.
        let triangles = corners.saturating_sub(2) as u32;
        self.polygons.push(triangles);
        self.groups.add(triangles, || match (self.object.as_str(), self.group.as_str()) {
            (object, "") => object.to_owned(),
            ("", group) => group.to_owned(),
            (object, group) => format!("{object} / {group}"),
        });
        self.materials.add(triangles, || self.material.clone());
    }
}

/// Names as numbers.
#[derive(Default)]
struct Interned {
    labels: Labels,
    known: HashMap<String, u32>,
    /// The number of the name that holds now; `None` after a change.
    current: Option<u32>,
}

impl Interned {
    /// Gives the next triangles the name that holds now.
    fn add(&mut self, triangles: u32, name: impl FnOnce() -> String) {
        let (known, names) = (&mut self.known, &mut self.labels.names);
        let label = *self.current.get_or_insert_with(|| {
            let name = name();
            *known.entry(name).or_insert_with_key(|name| {
                names.push(name.clone());
                // There are no more names than polygons.
                names.len() as u32 - 1
            })
        });
        self.labels.of_faces.extend(std::iter::repeat_n(label, triangles as usize));
    }
}
