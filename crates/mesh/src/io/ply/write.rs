//! Writing PLY: binary, little endian, in doubles.

use std::io::{self, Write};

use super::super::WriteError;
use super::super::blocks::{in_blocks, to_stream};
use super::VertexColours;
use crate::{FaceId, TriMesh, UvMap};

/// Writes a binary little-endian PLY of doubles.
///
/// UVs are the properties `s` and `t` of the vertices if no vertex has several (vertices that no
/// face uses get zeros), and otherwise the list `texcoord` of the faces, two values per corner.
///
/// # Errors
/// A [`WriteError`].
pub fn write_ply(out: impl Write, mesh: &TriMesh, uv: Option<&UvMap>) -> Result<(), WriteError> {
    to_stream(out, mesh, uv, write)
}

/// Writes a checked mesh.
pub(crate) fn write(out: &mut dyn Write, mesh: &TriMesh, uv: Option<&UvMap>) -> io::Result<()> {
    write_coloured(out, mesh, uv, None)
}

/// Writes a checked mesh with a colour for each of its vertices, if there are some.
pub(crate) fn write_coloured(
    out: &mut dyn Write,
    mesh: &TriMesh,
    uv: Option<&UvMap>,
    colours: Option<&VertexColours>,
) -> io::Result<()> {
    let per_vertex = uv.and_then(|map| map.one_per_vertex(mesh));
    let per_corner = uv.filter(|_| per_vertex.is_none());
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.vertex_count())?;
    out.write_all(b"property double x\nproperty double y\nproperty double z\n")?;
    if per_vertex.is_some() {
        out.write_all(b"property double s\nproperty double t\n")?;
    }
    if let Some(colours) = colours {
        out.write_all(colours.header().as_bytes())?;
    }
    write!(out, "element face {}\nproperty list uchar uint vertex_indices\n", mesh.face_count())?;
    if per_corner.is_some() {
        out.write_all(b"property list uchar double texcoord\n")?;
    }
    out.write_all(b"end_header\n")?;
    in_blocks(out, mesh.vertex_count(), |block, v| {
        doubles(block, &mesh.positions()[v].coords);
        if let Some(uv) = &per_vertex {
            doubles(block, &uv[v].coords);
        }
        if let Some(colours) = colours {
            colours.append(block, v);
        }
    })?;
    in_blocks(out, mesh.face_count(), |block, f| {
        block.push(3);
        // Ids are made of 32 bits.
        mesh.faces()[f].iter().for_each(|v| block.extend_from_slice(&(v.index() as u32).to_le_bytes()));
        if let Some(map) = per_corner {
            block.push(6);
            map.triangle(FaceId::new(f)).iter().for_each(|p| doubles(block, &p.coords));
        }
    })
}

fn doubles<'a>(block: &mut Vec<u8>, numbers: impl IntoIterator<Item = &'a f64>) {
    numbers.into_iter().for_each(|x| block.extend_from_slice(&x.to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Point2, Point3, UvId};

    fn triangle() -> TriMesh {
        let p = [[0.0, -0.0, 1e300], [1e-300, 1.0, 0.1], [123_456_789.0, 1.0 / 3.0, -2.5]];
        TriMesh::new(p.map(Point3::from).to_vec(), &[[0, 1, 2]]).expect("indices in range")
    }

    #[test]
    fn a_foreign_map_is_refused() {
        let map = UvMap::new(vec![Point2::origin()], vec![UvId::new(0); 6]);
        let e = write_ply(io::sink(), &triangle(), Some(&map)).unwrap_err();
        assert!(matches!(e, WriteError::UvMismatch { map: 6, mesh: 3 }), "{e}");
    }
}
