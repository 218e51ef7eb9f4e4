//! UVs that a mesh has, judged as a run of [`Unwrap`](crate::Unwrap) judges what it makes.

use crate::Atlas;
use crate::atlas::{Parts, Selected, in_input};
use abf_cut::{RepairError, Weld};
use abf_mesh::{TriMesh, UvMap};
use abf_metrics::{Metrics, MetricsError, Precision, certify_stored, measure_certified};

/// What is known of the UVs of a mesh that may need repair.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Judgement {
    /// Distortion and certificate of the faces that repair keeps, each the way around that repair gives it, without those
    /// that are [`shared`](Self::shared).
    pub metrics: Metrics,
    /// How many of the faces that are not shared repair turned around.
    pub turned: usize,
    /// How many faces have the vertices of an earlier face, and its UVs too: the two sides of a leaf with one picture.
    pub shared: usize,
    /// How many faces were not judged: those that use a vertex twice, and those without area in one point.
    pub dropped: usize,
}

/// Why UVs cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JudgeError {
    /// There is nothing left after the repair.
    #[error(transparent)]
    Repair(#[from] RepairError),
    /// The UVs cannot be measured.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
}

/// How a mesh is repaired before its UVs are judged, and what these are stored in. The default is that of
/// [`Unwrap`](crate::Unwrap), and doubles.
#[derive(Clone, Copy, Debug, Default)]
pub struct JudgeSettings<'a> {
    /// Which vertices in one place are joined.
    pub weld: Weld,
    /// [`SurfaceHints::objects`](crate::SurfaceHints::objects).
    pub objects: Option<&'a [u32]>,
    /// What the UVs are stored in.
    pub precision: Precision,
    /// Texels of the page along x and y, where the distortion is to be that of texels; without it a unit is as long along
    /// both.
    pub page: Option<[u32; 2]>,
}

/// Judges the UVs of a mesh after the repair that [`Unwrap`](crate::Unwrap) makes.
///
/// What [`Atlas::pack`](crate::Atlas::pack) says of one page is what this says of it, in the numbers of the mesh.
///
/// # Errors
/// [`JudgeError`].
pub fn judge(mesh: &TriMesh, uv: &UvMap, settings: &JudgeSettings<'_>) -> Result<Judgement, JudgeError> {
    let JudgeSettings { weld, objects, precision, page } = *settings;
    let objects = objects.filter(|objects| objects.len() == mesh.face_count());
    let selected = Selected::of(mesh, uv, weld, objects)?;
    let (shared, Selected { faces, turned, .. }) = (selected.shared(), selected);
    let dropped = mesh.face_count() - faces.len() - shared;
    let page = page.unwrap_or([1; 2]);
    if turned.is_empty() && faces.len() == mesh.face_count() {
        let metrics = measure_certified(mesh, &Atlas::in_proportions(uv, page), certify_stored(mesh, uv, precision)?)?;
        return Ok(Judgement { metrics, turned: 0, shared, dropped });
    }
    let (part, map, vertices) = Parts::new(mesh, &turned, uv).of(&faces);
    let certificate = in_input(certify_stored(&part, &map, precision)?, &faces, &vertices);
    let metrics = measure_certified(&part, &Atlas::in_proportions(&map, page), certificate)?;
    Ok(Judgement { metrics, turned: turned.len(), shared, dropped })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Atlas, SurfaceHints, Unwrap};
    use abf_control::Silent;
    use abf_cut::DoubleSided;
    use abf_mesh::{Point2, Point3};

    /// A sheet of 4 × 4 squares in space with its back, one face of the front turned around.
    fn leaf() -> TriMesh {
        let bent = |i: usize| {
            let (x, y) = ((i % 5) as f64, (i / 5) as f64);
            Point3::new(x, y, 0.1 * x * x)
        };
        let square = |i: usize| {
            let a = i / 4 * 5 + i % 4;
            [[a, a + 1, a + 6], [a, a + 6, a + 5]]
        };
        let mut faces: Vec<[usize; 3]> = (0..16).flat_map(square).collect();
        faces.extend(faces.clone().into_iter().map(|[a, b, c]| [c, b, a]));
        faces[5].swap(0, 1);
        TriMesh::new((0..25).map(bent).collect(), &faces).expect("indices in range")
    }

    #[test]
    fn what_a_run_says_of_an_atlas_is_what_the_judge_says_of_its_uvs() {
        let mesh = leaf();
        for (double_sided, shared, judged) in [(DoubleSided::Own, 0, 64), (DoubleSided::Shared, 32, 32)] {
            let unwrap = Unwrap { double_sided, ..Unwrap::default() };
            let unwrapped = unwrap.run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
            let packed = Atlas::default().pack(&mesh, &unwrapped, None, crate::Stored::default()).expect("an atlas");
            let of_file = judge(&mesh, &packed.uv, &JudgeSettings::default()).expect("a judgement");
            assert_eq!(of_file.metrics, packed.metrics, "{double_sided}");
            assert!(of_file.metrics.injective());
            assert_eq!((of_file.turned, of_file.shared, of_file.metrics.triangles), (1, shared, judged));
            assert_eq!((unwrapped.turned.len(), unwrapped.shared, of_file.dropped), (1, shared, 0));
        }
    }

    #[test]
    fn faces_in_one_place_share_their_uvs_whatever_their_vertices_and_others_on_the_same_uvs_overlap() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
        for (height, shared) in [(0.0, 1), (1.0, 0)] {
            let above = points.map(|p| Point3::new(p.x, p.y, height));
            let mesh = TriMesh::new([points, above].concat(), &[[0, 1, 2], [3, 4, 5]]).expect("indices in range");
            let flat: Vec<Point2<f64>> = mesh.positions().iter().map(|p| Point2::new(p.x, p.y)).collect();
            let uv = UvMap::per_vertex(&mesh, &flat);
            let judged = judge(&mesh, &uv, &JudgeSettings::default()).expect("a judgement");
            assert_eq!((judged.shared, judged.metrics.injective()), (shared, shared == 1));
        }
    }

    #[test]
    fn sides_of_a_leaf_with_vertices_of_their_own_share_texels_if_asked() {
        let leaf = leaf();
        let faces: Vec<[usize; 3]> = leaf
            .faces()
            .iter()
            .enumerate()
            .map(|(f, face)| face.map(|v| if f < 32 { v.index() } else { 25 + v.index() }))
            .collect();
        let mesh = TriMesh::new([leaf.positions(), leaf.positions()].concat(), &faces).expect("indices in range");
        for weld in [Weld::Auto, Weld::Off] {
            let unwrap = Unwrap { double_sided: DoubleSided::Shared, weld, ..Unwrap::default() };
            let unwrapped = unwrap.run(&mesh, &SurfaceHints::default(), &mut Silent).expect("charts");
            let packed = Atlas::default().pack(&mesh, &unwrapped, None, crate::Stored::default()).expect("an atlas");
            let settings = JudgeSettings { weld, ..JudgeSettings::default() };
            let of_file = judge(&mesh, &packed.uv, &settings).expect("a judgement");
            assert_eq!((unwrapped.shared, of_file.shared, of_file.metrics.triangles), (32, 32, 32));
            assert!(of_file.metrics.injective());
        }
    }
}
