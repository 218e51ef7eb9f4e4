//! Cutting along seams.

use crate::Seams;
use abf_control::{Cancelled, Checkpoint, at_block};
use abf_mesh::{CornerId, DisjointSets, FaceId, Point3, Topology, TopologyError, TriMesh, VertexId};

/// A connected piece of a mesh, with the way back to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The piece as a mesh of its own. Vertices on a seam are there once for each side.
    pub mesh: TriMesh,
    /// Its corner table.
    pub topology: Topology,
    /// For each of its faces the face of the mesh it was cut from, in ascending order; corner `k` is corner `k` there.
    pub faces: Vec<FaceId>,
    /// For each of its vertices the vertex of the mesh it was cut from, in ascending order.
    pub vertices: Vec<VertexId>,
}

/// Cuts a mesh along its seams. Without seams this takes it apart into its components.
///
/// Charts are in the order of their lowest faces. A vertex is there once for each sector between seams, and not at all
/// where no face uses it. A seam of one edge both of whose ends lie inside cuts nothing.
///
/// # Errors
/// [`TopologyError`] never, for a topology of this mesh; it is checked again.
pub fn split(mesh: &TriMesh, topology: &Topology, seams: &Seams) -> Result<Vec<Chart>, TopologyError> {
    split_asking(mesh, topology, seams, &mut || Ok(())).expect("nobody ends it")
}

/// [`split`] that asks between its parts and blocks whether to go on.
///
/// # Errors
/// [`Cancelled`]; inside of what comes out otherwise, as for `split`.
pub fn split_asking(
    mesh: &TriMesh,
    topology: &Topology,
    seams: &Seams,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Result<Vec<Chart>, TopologyError>, Cancelled> {
    checkpoint()?;
    let (chart_of_face, count) = pieces(topology, seams);
    checkpoint()?;
    let mut faces: Vec<Vec<FaceId>> = vec![Vec::new(); count];
    topology.faces().for_each(|f| faces[chart_of_face[f.index()]].push(f));
    let mut positions: Vec<Vec<Point3<f64>>> = vec![Vec::new(); count];
    let mut vertices: Vec<Vec<VertexId>> = vec![Vec::new(); count];
    let mut local = vec![0_usize; topology.corner_count()];
    for v in topology.vertices() {
        at_block(v.index(), checkpoint)?;
        for sector in sectors(topology, seams, v) {
            let chart = chart_of_face[sector[0].face().index()];
            sector.iter().for_each(|c| local[c.index()] = vertices[chart].len());
            vertices[chart].push(v);
            positions[chart].push(mesh.positions()[v.index()]);
        }
    }
    let mut charts = Vec::with_capacity(count);
    for ((faces, positions), vertices) in faces.into_iter().zip(positions).zip(vertices) {
        let corners: Vec<[usize; 3]> = faces.iter().map(|f| f.corners().map(|c| local[c.index()])).collect();
        let mesh = TriMesh::new(positions, &corners).expect("corners name the vertices made for them");
        match Topology::build_asking(mesh.vertex_count(), mesh.faces(), checkpoint)? {
            Ok(topology) => charts.push(Chart { mesh, topology, faces, vertices }),
            Err(error) => return Ok(Err(error)),
        }
    }
    Ok(Ok(charts))
}

/// The piece of every face, numbered by their lowest faces, and how many there are.
fn pieces(topology: &Topology, seams: &Seams) -> (Vec<usize>, usize) {
    let mut joined = DisjointSets::new(topology.face_count());
    for c in topology.corners().filter(|&c| !seams.contains(c)) {
        if let Some(o) = topology.opposite(c) {
            joined.unite(c.face().index(), o.face().index());
        }
    }
    let mut number = vec![0; topology.face_count()];
    let mut count = 0;
    for f in 0..number.len() {
        let lowest = joined.find(f);
        if lowest == f {
            number[f] = count;
            count += 1;
        } else {
            number[f] = number[lowest];
        }
    }
    (number, count)
}

/// The corners at a vertex, in runs between seams.
fn sectors(topology: &Topology, seams: &Seams, v: VertexId) -> Vec<Vec<CornerId>> {
    // From a corner to the next, counter-clockwise, the edge that `next` faces is crossed.
    let mut runs: Vec<Vec<CornerId>> = Vec::new();
    let mut is_cut = true;
    for c in topology.fan(v) {
        match runs.last_mut() {
            Some(run) if !is_cut => run.push(c),
            _ => runs.push(vec![c]),
        }
        is_cut = seams.contains(c.next());
    }
    // All around an interior vertex the last run goes on in the first.
    if topology.is_interior(v) && !is_cut && runs.len() > 1 {
        let last = runs.pop().unwrap_or_default();
        runs[0].splice(0..0, last);
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{cut_row, sheet, topology, torus};

    #[test]
    fn a_mesh_without_seams_comes_back_as_it_is() {
        let mesh = sheet(3, 5);
        let topology = topology(&mesh);
        let charts = split(&mesh, &topology, &Seams::none(&topology)).expect("a chart");
        assert_eq!(charts.len(), 1);
        assert_eq!(charts[0].mesh, mesh);
        assert_eq!(charts[0].topology, topology);
        assert!(charts[0].faces.iter().enumerate().all(|(i, f)| i == f.index()));
    }

    #[test]
    fn a_torus_cut_around_once_is_a_tube() {
        let mesh = torus(6, 8);
        let topology = topology(&mesh);
        let seams = cut_row(&mesh, &topology, 8);
        let charts = split(&mesh, &topology, &seams).expect("a chart");
        assert_eq!(charts.len(), 1);
        let tube = &charts[0];
        tube.topology.check().expect("lawful");
        assert_eq!(tube.topology.boundary_loops().len(), 2);
        assert_eq!(tube.topology.euler_characteristic(), 0);
        for (f, face) in tube.faces.iter().zip(tube.mesh.faces()) {
            assert_eq!(face.map(|v| tube.vertices[v.index()]), mesh.faces()[f.index()]);
        }
        for (v, p) in tube.vertices.iter().zip(tube.mesh.positions()) {
            assert_eq!(*p, mesh.positions()[v.index()]);
        }
    }
}
