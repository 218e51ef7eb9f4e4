//! Meshes and files that several tests use.

use abf_mesh::io::{MeshFile, MeshFormat, parse, write_obj, write_ply};
use abf_mesh::{Point2, Point3, TriMesh, UvId, UvMap};

/// A fan of four triangles over a square, whose vertices appear in the order of their indices.
/// All numbers are exact in 32 bits.
pub(crate) fn pyramid() -> TriMesh {
    let p =
        [[0.0, 0.0, 0.0], [1.0, 0.0, -0.25], [0.5, 0.5, 2.0], [1.0, 1.0, 1e-3_f32.into()], [0.0, 1.0, 3e20_f32.into()]];
    TriMesh::new(p.map(Point3::from).to_vec(), &[[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]]).expect("indices in range")
}

/// One UV per vertex.
pub(crate) fn flat_map(mesh: &TriMesh) -> UvMap {
    let uv: Vec<Point2<f64>> = mesh.positions().iter().map(|p| Point2::new(p.x / 3.0, p.y / 7.0)).collect();
    UvMap::per_vertex(mesh, &uv)
}

/// A map with a seam: vertices 0 and 2 have two UVs.
pub(crate) fn seam_map() -> UvMap {
    let p = [[0.1, -0.0], [0.2, 0.3], [1.0 / 3.0, 1e-300], [0.7, 0.5], [0.4, 0.9], [-0.5, 0.0], [0.25, 0.75]];
    let corners = [0, 1, 2, 1, 3, 2, 3, 4, 6, 4, 5, 6];
    UvMap::new(p.map(Point2::from).to_vec(), corners.map(UvId::new).to_vec())
}

/// The mesh as OFF.
pub(crate) fn off(mesh: &TriMesh) -> Vec<u8> {
    let mut out = format!("OFF\n{} {} 0\n", mesh.vertex_count(), mesh.face_count());
    for p in mesh.positions() {
        out += &format!("{:?} {:?} {:?}\n", p.x, p.y, p.z);
    }
    for f in mesh.faces() {
        out += &format!("3 {} {} {}\n", f[0], f[1], f[2]);
    }
    out.into_bytes()
}

/// The mesh as a text PLY.
pub(crate) fn ply_text(mesh: &TriMesh) -> Vec<u8> {
    let mut out = format!("ply\nformat ascii 1.0\nelement vertex {}\n", mesh.vertex_count());
    out += "property float x\nproperty float y\nproperty float z\n";
    out += &format!("element face {}\nproperty list uchar int vertex_index\nend_header\n", mesh.face_count());
    for p in mesh.positions() {
        out += &format!("{:?} {:?} {:?}\n", p.x, p.y, p.z);
    }
    for f in mesh.faces() {
        out += &format!("3 {} {} {}\n", f[0], f[1], f[2]);
    }
    out.into_bytes()
}

/// The mesh as a PLY of 32-bit numbers, the highest byte first.
pub(crate) fn ply_big_endian(mesh: &TriMesh) -> Vec<u8> {
    let mut out = format!(
        "ply\nformat binary_big_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar short vertex_indices\nend_header\n",
        mesh.vertex_count(),
        mesh.face_count()
    )
    .into_bytes();
    for p in mesh.positions() {
        p.iter().for_each(|&x| out.extend((x as f32).to_be_bytes()));
    }
    for f in mesh.faces() {
        out.push(3);
        f.iter().for_each(|v| out.extend((v.index() as i16).to_be_bytes()));
    }
    out
}

/// The mesh as a text STL.
pub(crate) fn stl_text(mesh: &TriMesh) -> Vec<u8> {
    let mut out = "solid pyramid\n".to_owned();
    for corners in mesh.triangles() {
        out += "facet normal 0 0 0\nouter loop\n";
        for p in corners {
            out += &format!("vertex {:?} {:?} {:?}\n", p.x, p.y, p.z);
        }
        out += "endloop\nendfacet\n";
    }
    out += "endsolid pyramid\n";
    out.into_bytes()
}

/// The mesh as a binary STL whose comment begins like a text.
pub(crate) fn stl_binary(mesh: &TriMesh) -> Vec<u8> {
    let mut out = b"solid".to_vec();
    out.resize(80, b' ');
    out.extend((mesh.face_count() as u32).to_le_bytes());
    for corners in mesh.triangles() {
        out.extend([0; 12]);
        corners.iter().flat_map(|p| p.iter()).for_each(|&x| out.extend((x as f32).to_le_bytes()));
        out.extend([0, 0]);
    }
    out
}

/// The mesh as OBJ, as written here.
pub(crate) fn obj(mesh: &TriMesh, uv: Option<&UvMap>) -> Vec<u8> {
    let mut out = Vec::new();
    write_obj(&mut out, mesh, uv).expect("written");
    out
}

/// The mesh as PLY, as written here.
pub(crate) fn ply(mesh: &TriMesh, uv: Option<&UvMap>) -> Vec<u8> {
    let mut out = Vec::new();
    write_ply(&mut out, mesh, uv).expect("written");
    out
}

/// One file of every kind, all of the same mesh.
pub(crate) fn all_kinds() -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    let mesh = pyramid();
    let map = seam_map();
    vec![
        ("OBJ", MeshFormat::Obj, obj(&mesh, None)),
        ("OBJ with seams", MeshFormat::Obj, obj(&mesh, Some(&map))),
        ("OFF", MeshFormat::Off, off(&mesh)),
        ("text PLY", MeshFormat::Ply, ply_text(&mesh)),
        ("little-endian PLY with seams", MeshFormat::Ply, ply(&mesh, Some(&map))),
        ("little-endian PLY with UVs per vertex", MeshFormat::Ply, ply(&mesh, Some(&flat_map(&mesh)))),
        ("big-endian PLY", MeshFormat::Ply, ply_big_endian(&mesh)),
        ("text STL", MeshFormat::Stl, stl_text(&mesh)),
        ("binary STL", MeshFormat::Stl, stl_binary(&mesh)),
    ]
}

/// Reads bytes that must be readable.
pub(crate) fn read_bytes(format: MeshFormat, bytes: &[u8]) -> MeshFile {
    parse(format, "test", bytes).unwrap_or_else(|e| panic!("{format:?} should be readable: {e}"))
}

/// The bits of all coordinates, so that −0 and 0 differ.
pub(crate) fn position_bits(mesh: &TriMesh) -> Vec<[u64; 3]> {
    mesh.positions().iter().map(|p| [p.x, p.y, p.z].map(f64::to_bits)).collect()
}

/// The bits of the UVs of all corners.
pub(crate) fn uv_bits(map: &UvMap) -> Vec<[u64; 2]> {
    map.triangles().flatten().map(|p| [p.x, p.y].map(f64::to_bits)).collect()
}
