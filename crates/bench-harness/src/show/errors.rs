//! The errors of every triangle and of its corners, for programs: rows, or a mesh with them as properties of its faces.

use abf_mesh::{TriMesh, VertexId};
use abf_metrics::{FaceDistortion, Orientation};
use std::fmt::Write;

/// What a file of errors holds, by the ending of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ErrorFormat {
    /// A row for every face.
    Csv,
    /// The surface, the errors being properties of its faces.
    Ply,
    /// The layout, coloured.
    Svg,
}

impl ErrorFormat {
    /// Every ending there is.
    pub(crate) const ENDINGS: [&str; 3] = ["csv", "ply", "svg"];

    /// The format of an ending.
    pub(crate) fn of(ending: &str) -> Option<Self> {
        let formats = [Self::Csv, Self::Ply, Self::Svg];
        let at = Self::ENDINGS.iter().position(|known| ending.eq_ignore_ascii_case(known))?;
        Some(formats[at])
    }
}

/// A figure of a face, and its name.
type Figure = (&'static str, fn(&FaceDistortion) -> f64);

/// What is known of a face besides its angles, in the order of columns and properties.
const OF_FACE: [Figure; 5] = [
    ("surface_share", |face| face.surface_share),
    ("area_ratio", |face| face.area_ratio),
    ("stretch_l2", |face| face.stretch_l2),
    ("stretch_linf", |face| face.stretch_linf),
    ("quasi_conformal", |face| face.quasi_conformal),
];

/// A row for every face: its vertices, and at its three corners the angle of the surface, that of the map and their difference,
/// rad; then what is known of the face. Faces and vertices are counted from 0. A figure that is not finite is left out.
pub(crate) fn to_csv(mesh: &TriMesh, faces: &[FaceDistortion]) -> String {
    let mut out = "face,vertex_0,vertex_1,vertex_2".to_owned();
    for what in ["mesh_angle", "uv_angle", "angle_error"] {
        (0..3).for_each(|k| push(&mut out, format_args!(",{what}_{k}")));
    }
    OF_FACE.iter().for_each(|(name, _)| push(&mut out, format_args!(",{name}")));
    out.push_str(",orientation,degenerate_3d\n");
    for (k, (face, corners)) in faces.iter().zip(mesh.faces()).enumerate() {
        let [a, b, c] = corners.map(VertexId::index);
        push(&mut out, format_args!("{k},{a},{b},{c}"));
        let angles = [face.mesh_angles, face.uv_angles, face.angle_errors()].concat();
        for x in angles.into_iter().chain(OF_FACE.iter().map(|(_, of)| of(face))) {
            if x.is_finite() { push(&mut out, format_args!(",{x:?}")) } else { out.push(',') }
        }
        push(&mut out, format_args!(",{},{}\n", word(face.orientation), face.degenerate_3d));
    }
    out
}

/// A binary PLY: the surface, and as properties of every face the errors at its corners (rad), the largest of them without its
/// sign, and what is known of the face. `orientation` is 1 for kept, −1 for flipped, 0 for collapsed.
pub(crate) fn to_ply(mesh: &TriMesh, faces: &[FaceDistortion]) -> Vec<u8> {
    let mut head = "ply\nformat binary_little_endian 1.0\ncomment errors of a map: angles in rad\n".to_owned();
    push(&mut head, format_args!("element vertex {}\n", mesh.vertex_count()));
    ["x", "y", "z"].iter().for_each(|axis| push(&mut head, format_args!("property double {axis}\n")));
    push(&mut head, format_args!("element face {}\nproperty list uchar uint vertex_indices\n", mesh.face_count()));
    let errors = ["angle_error_0", "angle_error_1", "angle_error_2", "angle_error"];
    let names = errors.into_iter().chain(OF_FACE.iter().map(|(name, _)| *name));
    names.for_each(|name| push(&mut head, format_args!("property double {name}\n")));
    head.push_str("property char orientation\nproperty uchar degenerate_3d\nend_header\n");

    let mut out = head.into_bytes();
    let mut put = |bytes: &[u8]| out.extend_from_slice(bytes);
    mesh.positions().iter().flat_map(|p| [p.x, p.y, p.z]).for_each(|x| put(&x.to_le_bytes()));
    for (face, corners) in faces.iter().zip(mesh.faces()) {
        put(&[corners.len() as u8]);
        corners.iter().for_each(|v| put(&(v.index() as u32).to_le_bytes()));
        let errors = face.angle_errors();
        let largest = errors.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let all = errors.into_iter().chain([largest]).chain(OF_FACE.iter().map(|(_, of)| of(face)));
        all.for_each(|x| put(&x.to_le_bytes()));
        put(&face.orientation.sign().to_le_bytes());
        put(&[u8::from(face.degenerate_3d)]);
    }
    out
}

fn word(orientation: Orientation) -> &'static str {
    match orientation {
        Orientation::Kept => "kept",
        Orientation::Flipped => "flipped",
        Orientation::Collapsed => "collapsed",
    }
}

fn push(out: &mut String, text: std::fmt::Arguments<'_>) {
    out.write_fmt(text).expect("a string takes everything");
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_mesh::io::MeshFormat;
    use abf_mesh::{Point2, UvMap};
    use abf_metrics::per_face;

    fn flattened() -> (TriMesh, Vec<FaceDistortion>) {
        let mesh = abf_shapes::Shape::Hemisphere.mesh(100);
        let uv: Vec<_> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
        let faces = per_face(&mesh, &UvMap::per_vertex(&mesh, &uv)).expect("judged");
        (mesh, faces)
    }

    #[test]
    fn the_rows_add_up_to_f() {
        let (mesh, faces) = flattened();
        let text = to_csv(&mesh, &faces);
        let heads: Vec<&str> = text.lines().next().expect("a head").split(',').collect();
        let at = |name: &str| heads.iter().position(|head| *head == name).expect(name);
        let mut sum = 0.0;
        for (k, line) in text.lines().skip(1).enumerate() {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!((cells.len(), cells[0].parse().ok()), (heads.len(), Some(k)));
            let number = |name: &str| cells[at(name)].parse::<f64>().expect(name);
            for corner in 0..3 {
                let error = number(&format!("angle_error_{corner}"));
                let both = ["uv", "mesh"].map(|of| number(&format!("{of}_angle_{corner}")));
                assert_eq!(error, both[0] - both[1]);
                sum += error * error;
            }
            assert_eq!(cells[at("orientation")], "kept");
        }
        assert_eq!(text.lines().count(), 1 + mesh.face_count());
        let f = faces.iter().flat_map(FaceDistortion::angle_errors).map(|e| e * e).sum::<f64>();
        assert!((sum - f).abs() <= 1e-14 * f, "{sum} {f}");
    }

    #[test]
    fn the_surface_reads_back_and_its_faces_have_so_many_bytes_each() {
        let (mesh, faces) = flattened();
        let bytes = to_ply(&mesh, &faces);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("errors.ply");
        std::fs::write(&path, &bytes).expect("written");
        assert_eq!(MeshFormat::from_path(&path), Some(MeshFormat::Ply));
        assert_eq!(abf_mesh::io::read(&path).expect("a mesh").mesh, mesh);
        let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
        assert_eq!(bytes.len() - end, mesh.vertex_count() * 24 + mesh.face_count() * (1 + 12 + 9 * 8 + 2));
    }
}
