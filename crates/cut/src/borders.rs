//! Seams that are there already: of a UV map, of groups and materials.

use crate::Seams;
use abf_mesh::{CornerId, Topology, UvId};

/// The edges whose two sides have different UV points at an end. `uv` holds the point of every corner.
///
/// # Panics
/// If there are not as many points as corners.
#[must_use]
pub fn uv_borders(topology: &Topology, uv: &[UvId]) -> Seams {
    assert_eq!(uv.len(), topology.corner_count(), "one UV point per corner");
    // The sides run along their edge in opposite directions.
    Seams::where_edges(topology, |c, o| {
        let at = |corner: CornerId| uv[corner.index()];
        at(c.next()) != at(o.prev()) || at(c.prev()) != at(o.next())
    })
}

/// The edges between faces of different labels: groups, materials. `labels` holds the label of every face.
///
/// # Panics
/// If there are not as many labels as faces.
#[must_use]
pub fn label_borders(topology: &Topology, labels: &[u32]) -> Seams {
    assert_eq!(labels.len(), topology.face_count(), "one label per face");
    Seams::where_edges(topology, |c, o| labels[c.face().index()] != labels[o.face().index()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::split;
    use crate::test_support::{sheet, topology};

    #[test]
    fn two_labels_make_two_charts_and_their_uvs_the_same_seams() {
        let mesh = sheet(4, 4);
        let topology = topology(&mesh);
        let labels: Vec<u32> = (0..mesh.face_count()).map(|f| u32::from(f >= 16)).collect();
        let seams = label_borders(&topology, &labels);
        assert_eq!(seams.len(), 4);
        let charts = split(&mesh, &topology, &seams).expect("charts");
        assert_eq!(charts.len(), 2);
        // One UV point for every vertex of every chart.
        let mut uv = vec![UvId::new(0); topology.corner_count()];
        let mut first = 0;
        for chart in &charts {
            for (f, face) in chart.faces.iter().zip(chart.mesh.faces()) {
                f.corners().iter().zip(face).for_each(|(c, v)| uv[c.index()] = UvId::new(first + v.index()));
            }
            first += chart.vertices.len();
        }
        assert_eq!(uv_borders(&topology, &uv), seams);
    }
}
