//! PLY, text and binary of both byte orders.
//!
//! Read are `x`, `y`, `z` of the element `vertex` in whatever scalar type, its UVs if they have one
//! of the usual pairs of names, and of the element `face` the list `vertex_indices` (or
//! `vertex_index`) and the list `texcoord` of two values per corner. The colours of the vertices are kept for writing. All
//! other properties and elements are skipped and counted. UVs per corner go before UVs per vertex.

mod colours;
mod header;
mod rows;
mod write;

pub use colours::VertexColours;
use header::{Element, Encoding, Header, Property, Scalar};
use rows::{BinaryRows, Rows, TextRows, whole};
pub use write::write_ply;
pub(super) use write::{write, write_coloured};

use super::MeshFile;
use super::error::{FilePlace, Location, ReadError};
use super::gather::{Gather, NO_UV};
use crate::Point2;

/// PLY counts from 0.
const BASE: u8 = 0;

/// What programs call the UV of a vertex.
const UV_NAMES: [[&str; 2]; 4] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// What programs call the list of the vertices of a face.
const INDEX_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The list of the UVs of a face, two values per corner.
const TEXCOORD: &str = "texcoord";

/// Reads a PLY file.
pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<MeshFile, ReadError> {
    let header = Header::parse(file, bytes)?;
    let mut ply = Ply { gather: Gather::new(file, BASE), uv: UvPlace::find(&header.elements), colours: None };
    match header.encoding {
        Encoding::Ascii => ply.elements(file, &header, TextRows::new(file, bytes, &header))?,
        Encoding::LittleEndian | Encoding::BigEndian => {
            ply.elements(file, &header, BinaryRows::new(file, bytes, &header))?;
        }
    }
    ply.gather.notes.uv_single = ply.uv.is_single(&header.elements);
    let (gather, colours) = (ply.gather, ply.colours);
    Ok(MeshFile { colours, ..gather.finish()? })
}

/// Where the UVs are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum UvPlace {
    Nowhere,
    Vertex([&'static str; 2]),
    Corner,
}

impl UvPlace {
    /// Looks for UVs in the header, because faces may come before vertices.
    fn find(elements: &[Element]) -> Self {
        let properties = |name| elements.iter().filter(move |e| e.name == name).flat_map(|e| &e.properties);
        if properties("face").any(|p| p.length.is_some() && p.name == TEXCOORD) {
            return Self::Corner;
        }
        let has = |name: &str| properties("vertex").any(|p| p.length.is_none() && p.name == name);
        UV_NAMES.into_iter().find(|pair| pair.iter().all(|name| has(name))).map_or(Self::Nowhere, Self::Vertex)
    }
}

impl UvPlace {
    /// Whether all that is stored there has 24 bits.
    fn is_single(self, elements: &[Element]) -> bool {
        let (element, names) = match self {
            Self::Nowhere => return false,
            Self::Vertex(pair) => ("vertex", pair.to_vec()),
            Self::Corner => ("face", vec![TEXCOORD]),
        };
        let mut stored = elements.iter().filter(|e| e.name == element).flat_map(|e| &e.properties);
        stored.all(|p| !names.contains(&p.name.as_str()) || p.value == Scalar::F32)
    }
}

struct Ply<'a> {
    gather: Gather<'a>,
    uv: UvPlace,
    colours: Option<VertexColours>,
}

/// What a property of a face is to the reader.
#[derive(Clone, Copy, PartialEq, Eq)]
enum FaceRole {
    Indices,
    Texcoord,
    Other,
}

impl Ply<'_> {
    fn elements(&mut self, file: &str, header: &Header, mut rows: impl Rows) -> Result<(), ReadError> {
        let has_faces = header.elements.iter().any(|e| e.name == "face");
        for element in &header.elements {
            let at = || Location { file: file.to_owned(), place: FilePlace::Line(element.line) };
            match element.name.as_str() {
                "vertex" => self.vertices(element, &at, &mut rows)?,
                "face" => self.faces(element, &at, &mut rows)?,
                "tristrips" if !has_faces => {
                    return Err(ReadError::Unsupported { at: at(), feature: "a mesh of triangle strips".to_owned() });
                }
                _ => self.other(element, &mut rows)?,
            }
        }
        for (what, count) in rows.left_over() {
            self.gather.notes.ignore_many(what, count);
        }
        Ok(())
    }

    fn vertices(
        &mut self,
        element: &Element,
        at: &dyn Fn() -> Location,
        rows: &mut impl Rows,
    ) -> Result<(), ReadError> {
        let mut names = vec!["x", "y", "z"];
        if let UvPlace::Vertex(pair) = self.uv {
            names.extend(pair);
        }
        let first_colour = names.len();
        let mut colours = VertexColours::declared(element);
        names.extend(colours.iter().flat_map(VertexColours::channels));
        // For every property the place of its value among x, y, z, u, v and the colours.
        let slot = |p: &Property| names.iter().position(|&name| p.length.is_none() && p.name == name);
        let slots: Vec<Option<usize>> = element.properties.iter().map(slot).collect();
        if let Some(missing) = (0..3).find(|&i| !slots.contains(&Some(i))) {
            let reason = format!("`vertex` has no property `{}`", names[missing]);
            return Err(ReadError::BadHeader { at: at(), reason });
        }
        let mut values = vec![0.0; names.len()];
        for row in 0..element.rows {
            rows.begin(element, row)?;
            for (property, slot) in element.properties.iter().zip(&slots) {
                match slot {
                    Some(i) => values[*i] = rows.value(property.value, &property.name)?,
                    None => skip(property, rows)?,
                }
            }
            self.gather.vertex([values[0], values[1], values[2]], rows.place());
            if let UvPlace::Vertex(_) = self.uv {
                self.gather.uv_points.push(Point2::new(values[3], values[4]));
            }
            if let Some(colours) = &mut colours {
                colours.push(&values[first_colour..]);
            }
        }
        self.colours = colours;
        self.note_skipped(element, |i| slots[i].is_none());
        Ok(())
    }

    fn faces(&mut self, element: &Element, at: &dyn Fn() -> Location, rows: &mut impl Rows) -> Result<(), ReadError> {
        let role = |p: &Property| match p.name.as_str() {
            name if p.length.is_some() && INDEX_NAMES.contains(&name) => FaceRole::Indices,
            TEXCOORD if p.length.is_some() => FaceRole::Texcoord,
            _ => FaceRole::Other,
        };
        let roles: Vec<FaceRole> = element.properties.iter().map(role).collect();
        if roles.iter().filter(|&&role| role == FaceRole::Indices).count() != 1 {
            let reason = format!("`face` needs one list `{}`", INDEX_NAMES.join("` or `"));
            return Err(ReadError::BadHeader { at: at(), reason });
        }
        let (mut indices, mut texcoord) = (Vec::new(), Vec::new());
        for row in 0..element.rows {
            rows.begin(element, row)?;
            texcoord.clear();
            for (property, role) in element.properties.iter().zip(&roles) {
                match role {
                    FaceRole::Indices => list(property, rows, &mut indices)?,
                    FaceRole::Texcoord => list(property, rows, &mut texcoord)?,
                    FaceRole::Other => skip(property, rows)?,
                }
            }
            self.face(&indices, &texcoord, rows)?;
        }
        self.note_skipped(element, |i| roles[i] == FaceRole::Other);
        Ok(())
    }

    fn face(&mut self, indices: &[f64], texcoord: &[f64], rows: &impl Rows) -> Result<(), ReadError> {
        let place = rows.place();
        let length = texcoord.len();
        if length != 0 && length != 2 * indices.len() {
            let expected = format!("two values for each of {} corners, or none", indices.len());
            let (list, length) = (TEXCOORD.to_owned(), length as f64);
            return Err(ReadError::BadListLength { at: rows.at(), list, length, expected });
        }
        for (corner, &index) in indices.iter().enumerate() {
            let bad_index = || ReadError::BadIndex { at: rows.at(), text: index.to_string() };
            let index = whole(index).ok_or_else(bad_index)?;
            let vertex = usize::try_from(index).unwrap_or_else(|_| {
                self.gather.bad_vertex(place, index);
                0
            });
            match (self.uv, texcoord.get(2 * corner..2 * corner + 2)) {
                (UvPlace::Corner, Some(uv)) => self.gather.corner_with_uv(vertex, Point2::new(uv[0], uv[1])),
                (UvPlace::Vertex(_), _) => self.gather.corner(vertex, vertex),
                _ => self.gather.corner(vertex, NO_UV),
            }
        }
        self.gather.end_polygon(place);
        Ok(())
    }

    /// Skips an element that says nothing to this reader.
    fn other(&mut self, element: &Element, rows: &mut impl Rows) -> Result<(), ReadError> {
        self.gather.notes.ignore_many(&format!("element `{}`", element.name), element.rows);
        // Rows without properties take no place, however many are claimed.
        let rows_present = if element.properties.is_empty() { 0 } else { element.rows };
        for row in 0..rows_present {
            rows.begin(element, row)?;
            element.properties.iter().try_for_each(|property| skip(property, rows))?;
        }
        Ok(())
    }

    fn note_skipped(&mut self, element: &Element, skipped: impl Fn(usize) -> bool) {
        for (_, property) in element.properties.iter().enumerate().filter(|&(i, _)| skipped(i)) {
            let what = format!("property `{}` of `{}`", property.name, element.name);
            self.gather.notes.ignore_many(&what, element.rows);
        }
    }
}

/// Skips one property of the current row.
fn skip(property: &Property, rows: &mut impl Rows) -> Result<(), ReadError> {
    let count = property.length.map_or(Ok(1), |length| rows.length(length, &property.name))?;
    rows.skip(property.value, count, &property.name)
}

/// Reads one list of the current row.
fn list(property: &Property, rows: &mut impl Rows, values: &mut Vec<f64>) -> Result<(), ReadError> {
    values.clear();
    // Roles are given to lists only.
    let count = property.length.map_or(Ok(0), |length| rows.length(length, &property.name))?;
    for _ in 0..count {
        values.push(rows.value(property.value, &property.name)?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FaceId;

    fn read(text: &str) -> MeshFile {
        parse("test.ply", text.as_bytes()).expect("a readable file")
    }

    const MIXED: &str = "ply\r
format ascii 1.0\r
comment the faces come first\r
element face 1\r
property uchar flags\r
property list uchar int vertex_index\r
element nothing 99999999999\r
element edge 1\r
property list uint8 float32 weights\r
element vertex 4\r
property uchar red\r
property short z\r
property double x\r
property float64 y\r
property float u\r
property float v\r
end_header\r
7 4 0 1 2 3 9\r
2 0.5 0.5\r
1 0 0 0 0 0\r
1 0 1 0 1 0\r
1 5 1 1 1 1\r
1 0 0 1 0 1\r
";

    #[test]
    fn elements_and_properties_may_come_in_any_order() {
        let file = read(MIXED);
        assert_eq!((file.mesh.vertex_count(), file.mesh.face_count()), (4, 2));
        assert_eq!(file.mesh.positions()[2], crate::Point3::new(1.0, 1.0, 5.0));
        let uv = file.uv.expect("a map");
        assert_eq!(uv.triangle(FaceId::new(1)), [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Point2::from));
        let ignored: Vec<(&str, usize)> = file.notes.ignored.iter().map(|(k, &n)| (k.as_str(), n)).collect();
        assert_eq!(
            ignored,
            [
                ("element `edge`", 1),
                ("element `nothing`", 99_999_999_999),
                ("property `flags` of `face`", 1),
                ("property `red` of `vertex`", 4),
                ("values at the end of a line", 1)
            ]
        );
    }

    #[test]
    fn the_colours_of_vertices_come_back_in_their_own_types_and_those_of_another_mesh_are_refused() {
        for (kind, values) in
            [("uchar", ["255", "0", "17"]), ("float", ["0.25", "1", "0.5"]), ("ushort", ["65535", "0", "9"])]
        {
            let declared: String =
                ["blue", "red", "green"].iter().map(|name| format!("property {kind} {name}\n")).collect();
            let [b, r, g] = values;
            let text = format!(
                "ply\nformat ascii 1.0\nelement vertex 3\n{declared}property float x\nproperty float y\nproperty float z\n\
                 element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                 {b} {r} {g} 0 0 0\n{b} {r} {g} 1 0 0\n{r} {r} {r} 0 1 0\n3 0 1 2\n"
            );
            let file = read(&text);
            let colours = file.colours.as_ref().expect("colours");
            assert_eq!(colours.channels().collect::<Vec<_>>(), ["red", "green", "blue"]);
            let expected = [r, g, b].map(|x| x.parse().expect("a number"));
            assert_eq!((colours.vertex_count(), colours.of_vertex(1)), (3, Some(&expected[..])));
            assert!(file.notes.ignored.is_empty(), "{:?}", file.notes);
            let mut bytes = Vec::new();
            write_coloured(&mut bytes, &file.mesh, None, Some(colours)).expect("written");
            assert!(String::from_utf8_lossy(&bytes).contains(&format!("property {kind} red\n")));
            assert_eq!(parse("again.ply", &bytes).expect("a readable file").colours.as_ref(), Some(colours));
            let other = read(MIXED).mesh;
            let refused = super::super::write_coloured(std::path::Path::new("a.ply"), &other, None, Some(colours));
            let refused = refused.expect_err("another mesh").to_string();
            assert_eq!(refused, "there are 3 vertex colours, but the mesh has 4 vertices");
        }
    }

    #[test]
    fn binary_values_of_all_types_are_skipped_by_their_size() {
        let types = ["char", "uint8", "short", "ushort", "int", "uint32", "float", "double"];
        let sizes = [1, 1, 2, 2, 4, 4, 4, 8];
        let declared: String =
            types.iter().map(|t| format!("property {t} a_{t}\nproperty list ushort {t} l_{t}\n")).collect();
        let head = format!(
            "ply\nformat binary_big_endian 1.0\nelement vertex 3\n{declared}property float x\nproperty short y\nproperty char z\n\
             element face 1\nproperty list short uint vertex_indices\nend_header\n"
        );
        let mut bytes = head.into_bytes();
        for (x, y, z) in [(0.5_f32, -300_i16, -7_i8), (1.5, 0, 0), (2.5, 1, 0)] {
            for size in sizes {
                bytes.extend(vec![0xaa; size]);
                bytes.extend([0, 3]);
                bytes.extend(vec![0xbb; 3 * size]);
            }
            bytes.extend(x.to_be_bytes());
            bytes.extend(y.to_be_bytes());
            bytes.extend(z.to_be_bytes());
        }
        bytes.extend([0, 3, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1]);
        let file = parse("test.ply", &bytes).expect("a readable file");
        assert_eq!(file.mesh.positions()[0], crate::Point3::new(0.5, -300.0, -7.0));
        assert_eq!(file.mesh.faces()[0].map(crate::VertexId::index), [2, 0, 1]);
        assert_eq!(file.notes.ignored["property `l_double` of `vertex`"], 3);
    }
}
