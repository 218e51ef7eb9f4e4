//! What all readers share: collecting vertices and polygons, and turning them into a mesh.
//!
//! Polygons are kept as they are until the end of the file, because a format may put faces before
//! the vertices they name. Faults that come in numbers are counted here and reported once.

use std::collections::HashMap;

use super::error::{FilePlace, Location, ReadError};
use super::polygon::{self, Inside};
use super::{MeshFile, ReadNotes, UvDropped};
use crate::{Point2, Point3, TriMesh, UvId, UvMap};

/// Stands for the UV of a corner that has none.
pub(super) const NO_UV: usize = usize::MAX;

/// Vertices, UVs and polygons in the order of the file.
pub(super) struct Gather<'a> {
    file: &'a str,
    /// What the format calls its first vertex: 0 or 1.
    base: u8,
    pub(super) positions: Vec<Point3<f64>>,
    pub(super) uv_points: Vec<Point2<f64>>,
    pub(super) notes: ReadNotes,
    /// The vertices of all polygons, one polygon after the other.
    corners: Vec<usize>,
    /// The UV points of all polygons.
    uv_corners: Vec<usize>,
    /// For every polygon where its corners end, and its place in the file.
    polygons: Vec<(usize, FilePlace)>,
    /// The UV points by vertex and bits, for formats that store the UVs themselves per corner.
    uv_by_value: HashMap<(usize, [u64; 2]), usize>,
    not_finite: Option<Fault<()>>,
    too_few: Option<Fault<usize>>,
    bad_vertex: Option<Fault<(i64, usize)>>,
    bad_uv: Option<Fault<(i64, usize)>>,
}

/// A fault that may occur many times: where first, what is to be said of that one, how many.
struct Fault<T> {
    first: FilePlace,
    detail: T,
    count: usize,
}

impl<T> Fault<T> {
    /// Counts one more, in whatever order they are found.
    fn add(slot: &mut Option<Self>, place: FilePlace, detail: T) {
        match slot {
            None => *slot = Some(Self { first: place, detail, count: 1 }),
            Some(fault) => {
                fault.count += 1;
                if place < fault.first {
                    (fault.first, fault.detail) = (place, detail);
                }
            }
        }
    }
}

impl<'a> Gather<'a> {
    /// Nothing gathered yet. `base` is what the format calls its first vertex.
    pub(super) fn new(file: &'a str, base: u8) -> Self {
        Self {
            file,
            base,
            positions: Vec::new(),
            uv_points: Vec::new(),
            notes: ReadNotes::default(),
            corners: Vec::new(),
            uv_corners: Vec::new(),
            polygons: Vec::new(),
            uv_by_value: HashMap::new(),
            not_finite: None,
            too_few: None,
            bad_vertex: None,
            bad_uv: None,
        }
    }

    /// The next vertex.
    pub(super) fn vertex(&mut self, [x, y, z]: [f64; 3], place: FilePlace) {
        if ![x, y, z].iter().all(|c| c.is_finite()) {
            Fault::add(&mut self.not_finite, place, ());
        }
        self.positions.push(Point3::new(x, y, z));
    }

    /// The next corner of the current polygon: the vertex and the UV point it names, both counted
    /// from zero and both free to come later in the file.
    pub(super) fn corner(&mut self, vertex: usize, uv: usize) {
        self.corners.push(vertex);
        self.uv_corners.push(uv);
    }

    /// The next corner of the current polygon, with its own UV. Corners of one vertex with the
    /// same UV, to the bit, are joined in the map.
    pub(super) fn corner_with_uv(&mut self, vertex: usize, uv: Point2<f64>) {
        let points = &mut self.uv_points;
        let id = *self.uv_by_value.entry((vertex, [uv.x.to_bits(), uv.y.to_bits()])).or_insert_with(|| {
            points.push(uv);
            points.len() - 1
        });
        self.corner(vertex, id);
    }

    /// A corner whose vertex index, as written, cannot name anything. The file is not readable any
    /// more, but counting goes on.
    pub(super) fn bad_vertex(&mut self, place: FilePlace, index: i64) {
        Fault::add(&mut self.bad_vertex, place, (index, self.positions.len()));
    }

    /// A UV index that cannot name anything.
    pub(super) fn bad_uv(&mut self, place: FilePlace, index: i64) {
        Fault::add(&mut self.bad_uv, place, (index, self.uv_points.len()));
    }

    /// Ends the current polygon.
    pub(super) fn end_polygon(&mut self, place: FilePlace) {
        let start = self.polygons.last().map_or(0, |&(end, _)| end);
        let corners = self.corners.len() - start;
        if corners < 3 {
            Fault::add(&mut self.too_few, place, corners);
        }
        self.polygons.push((self.corners.len(), place));
    }

    /// The mesh.
    ///
    /// # Errors
    /// Everything that could be said only now.
    pub(super) fn finish(self) -> Result<MeshFile, ReadError> {
        self.finish_with_polygons().map(|(file, _)| file)
    }

    /// The mesh, and the polygons that are no fans.
    ///
    /// # Errors
    /// Everything that could be said only now.
    pub(super) fn finish_with_polygons(mut self) -> Result<(MeshFile, Inside), ReadError> {
        self.check_counts()?;
        self.check_indices();
        self.check_faults()?;
        let (fan, inside) = self.triangles();
        let faces: Vec<[usize; 3]> = fan.iter().map(|face| face.map(|c| self.corners[c])).collect();
        let uv = self.uv_map(&fan);
        let mesh = TriMesh::new(self.positions, &faces).expect("all indices have been checked");
        self.notes.unreferenced_vertices = mesh.unreferenced_vertices();
        Ok((MeshFile { mesh, uv, colours: None, notes: self.notes }, inside))
    }

    /// There must be something, and no more than ids can name.
    fn check_counts(&self) -> Result<(), ReadError> {
        const LARGEST: usize = u32::MAX as usize;
        let file = || self.file.to_owned();
        let vertices = self.positions.len();
        if vertices == 0 {
            return Err(ReadError::NoVertices { file: file() });
        }
        if self.polygons.is_empty() {
            return Err(ReadError::NoFaces { file: file(), vertices });
        }
        // A fan of n corners makes n − 2 triangles: never more than three times as many corners.
        let corners = 3 * self.corners.len();
        for (what, count) in [("vertices", vertices), ("UVs", self.uv_points.len()), ("corners", corners)] {
            if count > LARGEST {
                return Err(ReadError::TooLarge { file: file(), what, count });
            }
        }
        Ok(())
    }

    /// Finds the indices that name nothing at the end of the file.
    fn check_indices(&mut self) {
        let (vertices, uvs) = (self.positions.len(), self.uv_points.len());
        let written = |index: usize| i64::try_from(index).map_or(i64::MAX, |i| i.saturating_add(self.base.into()));
        let mut start = 0;
        for &(end, place) in &self.polygons {
            for &v in self.corners[start..end].iter().filter(|&&v| v >= vertices) {
                Fault::add(&mut self.bad_vertex, place, (written(v), vertices));
            }
            for &uv in self.uv_corners[start..end].iter().filter(|&&uv| uv >= uvs && uv != NO_UV) {
                Fault::add(&mut self.bad_uv, place, (written(uv), uvs));
            }
            start = end;
        }
    }

    /// Reports the faults that were counted.
    fn check_faults(&self) -> Result<(), ReadError> {
        let at = |place| Location { file: self.file.to_owned(), place };
        if let Some(Fault { first, count, .. }) = self.not_finite {
            return Err(ReadError::NotFinite { at: at(first), count });
        }
        if let Some(Fault { first, detail: corners, count }) = self.too_few {
            return Err(ReadError::TooFewCorners { at: at(first), corners, count });
        }
        for (what, fault) in [("vertex", &self.bad_vertex), ("UV", &self.bad_uv)] {
            if let &Some(Fault { first, detail: (index, available), count }) = fault {
                let base = self.base;
                return Err(ReadError::IndexOutOfRange { at: at(first), what, index, available, base, count });
            }
        }
        Ok(())
    }

    /// Every triangle as three places in `corners`, and the polygons that are no fans around their first corner.
    fn triangles(&mut self) -> (Vec<[usize; 3]>, Inside) {
        let mut out = Vec::with_capacity(self.polygons.len());
        let mut inside = Inside::new();
        let mut start = 0;
        for (number, &(end, _)) in self.polygons.iter().enumerate() {
            let triangles = end - start - 2;
            let mut own = None;
            if triangles > 1 {
                let points: Vec<_> = self.corners[start..end].iter().map(|&v| self.positions[v]).collect();
                let cut = polygon::cut(&points);
                self.notes.polygon(triangles, &cut);
                own = cut.inside;
            }
            match own {
                None => out.extend((start + 1..end - 1).map(|c| [start, c, c + 1])),
                Some(own) => {
                    out.extend(own.iter().map(|face| face.map(|c| start + c as usize)));
                    inside.insert(number, own);
                }
            }
            start = end;
        }
        (out, inside)
    }

    /// The UV map, if every corner has a finite UV. Points that no corner uses are left out.
    fn uv_map(&mut self, fan: &[[usize; 3]]) -> Option<UvMap> {
        let without = self.uv_corners.iter().filter(|&&uv| uv == NO_UV).count();
        if without == self.uv_corners.len() {
            self.notes.unreferenced_uvs = self.uv_points.len();
            return None;
        }
        if without > 0 {
            self.notes.uv_dropped = Some(UvDropped::CornersWithout { corners: without });
            return None;
        }
        let mut used = vec![false; self.uv_points.len()];
        self.uv_corners.iter().for_each(|&uv| used[uv] = true);
        let finite = |p: &Point2<f64>| p.x.is_finite() && p.y.is_finite();
        let bad = self.uv_points.iter().zip(&used).filter(|(p, used)| **used && !finite(p)).count();
        if bad > 0 {
            self.notes.uv_dropped = Some(UvDropped::NotFinite { points: bad });
            return None;
        }
        let mut points = Vec::with_capacity(self.uv_points.len());
        let mut ids = vec![0; self.uv_points.len()];
        for (uv, &point) in self.uv_points.iter().enumerate().filter(|&(uv, _)| used[uv]) {
            ids[uv] = points.len();
            points.push(point);
        }
        self.notes.unreferenced_uvs = self.uv_points.len() - points.len();
        let corners = fan.iter().flatten().map(|&c| UvId::new(ids[self.uv_corners[c]])).collect();
        Some(UvMap::new(points, corners))
    }
}
