//! How much a conformal map will shrink a surface, and where, before there is a map.
//!
//! A map to the plane that scales lengths by `e^u` and keeps angles takes the curvature away: `Δu = K`. Of all such maps the
//! one with `u = 0` at its boundary minimises `∫|∇u|²`. The angles of small triangles change by what `u` changes across
//! them, so it is also the map that changes angles least, to first order. On a mesh (Springborn, Schröder, Pinkall 2008,
//! linearised)
//!
//! ```text
//! Σ_j ½ (cot α_ij + cot β_ij) (u_i − u_j) = −K_i        K_i = 2π − Σ angles at i,        u = 0 on seams and the boundary,
//! ```
//!
//! with the angles α and β that face the edge. The surface need not be cut for it: both sides of a seam have `u = 0`. So
//! one ordering and one analysis serve all seams, however they grow.

use crate::Seams;
use crate::seams::{ends, interior_edges};
use abf_control::{Cancelled, Checkpoint};
use abf_linalg::{Graph, LinearError, Permutation, SymbolicCholesky, SymmetricMatrix, SymmetricPattern};
use abf_mesh::{CornerId, Topology, TriMesh, VertexId};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A face whose area is below this part of the square of its longest edge counts as equilateral: its cotangents say nothing.
const THINNEST: f64 = 1e-9;

/// The scale of a conformal map of one surface, for any seams.
#[derive(Debug)]
pub struct ConformalScale {
    order: Permutation,
    symbolic: Arc<SymbolicCholesky>,
    /// Every edge that is not on the boundary: its ends, where it is stored, its weight.
    edges: Vec<Edge>,
    /// K, rad.
    deficit: Vec<f64>,
    is_boundary: Vec<bool>,
}

/// Where a step of [`ConformalScale::refined`] is.
struct Scaled {
    u: Vec<f64>,
    /// Of the scaled triangles, by corner, rad.
    angles: Vec<f64>,
    /// 2π − Σ angles at every vertex, 0 where u is fixed.
    deficit: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    slot: u32,
    weight: f64,
    corners: [CornerId; 2],
}

impl ConformalScale {
    /// Orders and analyses the system of a surface.
    ///
    /// # Errors
    /// [`LinearError`] when that does not fit in memory or in 32-bit indices, or the checkpoint ends it.
    ///
    /// # Panics
    /// If `topology` is not that of `mesh`.
    pub fn new(mesh: &TriMesh, topology: &Topology, checkpoint: &mut Checkpoint<'_>) -> Result<Self, LinearError> {
        let size = topology.vertex_count();
        assert_eq!(mesh.vertex_count(), size, "the topology of this mesh");
        let of_edges: Vec<[u32; 2]> =
            interior_edges(topology).map(|(c, _)| ends(topology, c).map(|v| v.index() as u32)).collect();
        let graph = Graph::from_edges(size, of_edges.iter().map(|&[a, b]| (a, b)));
        checkpoint()?;
        let order = graph.amd()?;
        checkpoint()?;
        let pattern = Arc::new(SymmetricPattern::of_blocks(&graph, &order, 1));
        checkpoint()?;
        let cotangents = cotangents(mesh);
        let weight = |c: CornerId, o: CornerId| 0.5 * (cotangents[c.index()] + cotangents[o.index()]);
        let edge = |(ends, (c, o)): ([u32; 2], (CornerId, CornerId))| {
            let [a, b] = ends.map(|v| order.new_index(v as usize));
            let slot = pattern.slot(a.max(b), a.min(b)) as u32;
            Edge { ends, slot, weight: weight(c, o), corners: [c, o] }
        };
        let edges = of_edges.into_iter().zip(interior_edges(topology)).map(edge).collect();
        let mut deficit = vec![TAU; size];
        let mut is_boundary = vec![true; size];
        for (c, angle) in topology.corners().zip(mesh.corner_angles()) {
            deficit[topology.vertex(c).index()] -= angle;
            is_boundary[topology.vertex(c).index()] = false;
        }
        topology.vertices().filter(|&v| topology.is_boundary(v)).for_each(|v| is_boundary[v.index()] = true);
        checkpoint()?;
        let symbolic = SymbolicCholesky::analyse(pattern)?;
        Ok(Self { order, symbolic, edges, deficit, is_boundary })
    }

    /// `u` at every vertex, the logarithm of the scale of lengths, for a surface cut along these seams; 0 on seams and on the
    /// boundary.
    ///
    /// # Errors
    /// [`LinearError`]: [`NotPositiveDefinite`](LinearError::NotPositiveDefinite) where there is neither a seam nor a
    /// boundary.
    pub fn log_scale(&self, topology: &Topology, seams: &Seams) -> Result<Vec<f64>, LinearError> {
        self.solve(&self.fixed(topology, seams), |edge| edge.weight, &self.deficit)
    }

    /// `u` made better by at most so many steps of Newton's method, each with the angles of the triangles whose edges are
    /// `e^((u_i + u_j) / 2)` times as long: the scale of the discrete conformal map itself is where they sum to 2π (Springborn,
    /// Schröder, Pinkall 2008). A step that makes their sums no better is not taken, and is the last.
    ///
    /// # Errors
    /// [`Cancelled`] when the checkpoint ends it.
    pub fn refined(
        &self,
        (mesh, topology): (&TriMesh, &Topology),
        seams: &Seams,
        u: Vec<f64>,
        steps: usize,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Vec<f64>, Cancelled> {
        let is_fixed = self.fixed(topology, seams);
        let scaled = |u: Vec<f64>| {
            let angles = scaled_angles(mesh, |v| u[v.index()]);
            let deficit = deficits(topology, &angles, &is_fixed);
            Scaled { u, angles, deficit }
        };
        let squares = |here: &Scaled| here.deficit.iter().map(|k| k * k).sum::<f64>();
        let mut here = scaled(u);
        for _ in 0..steps {
            checkpoint()?;
            let weight =
                |edge: &Edge| 0.5 * edge.corners.iter().map(|c| here.angles[c.index()].tan().recip()).sum::<f64>();
            let Ok(step) = self.solve(&is_fixed, weight, &here.deficit) else { break };
            let next = scaled(here.u.iter().zip(step).map(|(u, step)| u + step).collect());
            if !(squares(&next) < squares(&here)) {
                break;
            }
            here = next;
        }
        Ok(here.u)
    }

    /// Which vertices have u = 0.
    fn fixed(&self, topology: &Topology, seams: &Seams) -> Vec<bool> {
        let mut is_fixed = self.is_boundary.clone();
        seams.edges(topology).flat_map(|c| ends(topology, c)).for_each(|v| is_fixed[v.index()] = true);
        is_fixed
    }

    /// Solves the system with these weights and angle deficits.
    fn solve(
        &self,
        is_fixed: &[bool],
        weight: impl Fn(&Edge) -> f64,
        deficit: &[f64],
    ) -> Result<Vec<f64>, LinearError> {
        let pattern = Arc::clone(self.symbolic.pattern());
        let mut matrix = SymmetricMatrix::zeros(Arc::clone(&pattern));
        let diagonal = |v: usize| pattern.column(self.order.new_index(v)).start;
        for edge in &self.edges {
            let ([a, b], slot, weight) = (edge.ends.map(|v| v as usize), edge.slot, weight(edge));
            // What is fixed is 0, so that it adds nothing to the other side.
            matrix.values[diagonal(a)] += weight;
            matrix.values[diagonal(b)] += weight;
            if !is_fixed[a] && !is_fixed[b] {
                matrix.values[slot as usize] -= weight;
            }
        }
        let mut u = vec![0.0; deficit.len()];
        for (v, &is_fixed) in is_fixed.iter().enumerate() {
            if is_fixed {
                matrix.values[diagonal(v)] = 1.0;
            } else {
                u[self.order.new_index(v)] = -deficit[v];
            }
        }
        self.symbolic.factorise(&matrix)?.apply_inverse(&mut u)?;
        if u.iter().any(|u| !u.is_finite()) {
            return Err(LinearError::NotPositiveDefinite { pivot: 0, size: u.len() });
        }
        Ok((0..u.len()).map(|v| u[self.order.new_index(v)]).collect())
    }
}

/// 2π − Σ angles at every vertex that is not fixed, rad; 0 at the others.
fn deficits(topology: &Topology, angles: &[f64], is_fixed: &[bool]) -> Vec<f64> {
    let mut deficit: Vec<f64> = is_fixed.iter().map(|is_fixed| if *is_fixed { 0.0 } else { TAU }).collect();
    for (c, angle) in topology.corners().zip(angles) {
        let v = topology.vertex(c).index();
        deficit[v] -= if is_fixed[v] { 0.0 } else { *angle };
    }
    deficit
}

/// The angles of a mesh, rad, by corner, whose edges are `e^((u_i + u_j) / 2)` times as long; where that leaves no triangle,
/// those it has.
#[must_use]
pub fn scaled_angles(mesh: &TriMesh, u: impl Fn(VertexId) -> f64) -> Vec<f64> {
    let mut angles = mesh.corner_angles();
    for (face, angles) in mesh.faces().iter().zip(angles.as_chunks_mut::<3>().0) {
        let [p, q, r] = face.map(|v| mesh.positions()[v.index()]);
        // Each edge by what faces it; one scale for all three does not matter.
        let [a, b, c] = face.map(|v| (-0.5 * u(v)).exp());
        if let Some(scaled) = angles_of_sides([(r - q).norm() * a, (p - r).norm() * b, (q - p).norm() * c]) {
            *angles = scaled;
        }
    }
    angles
}

/// The angles that face the sides of a triangle, rad; `None` if there is none.
fn angles_of_sides([a, b, c]: [f64; 3]) -> Option<[f64; 3]> {
    // s, s − a, s − b and s − c, twice each.
    let [s, x, y, z] = [a + b + c, b + c - a, c + a - b, a + b - c];
    if !(x > 0.0 && y > 0.0 && z > 0.0) {
        return None;
    }
    let angle = |near: f64, far: f64, other: f64| 2.0 * (far * other).sqrt().atan2((s * near).sqrt());
    Some([angle(x, y, z), angle(y, z, x), angle(z, x, y)])
}

/// By corner.
fn cotangents(mesh: &TriMesh) -> Vec<f64> {
    let of_face = |[a, b, c]: [abf_mesh::Point3<f64>; 3]| {
        let [ab, bc, ca] = [b - a, c - b, a - c];
        let twice_area = ab.cross(&-ca).norm();
        let longest = ab.norm_squared().max(bc.norm_squared()).max(ca.norm_squared());
        if twice_area > THINNEST * longest {
            [-ab.dot(&ca), -bc.dot(&ab), -ca.dot(&bc)].map(|dot| dot / twice_area)
        } else {
            [3.0_f64.sqrt().recip(); 3]
        }
    };
    mesh.triangles().flat_map(of_face).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{octahedron, sheet, topology, torus};
    use crate::{CostSettings, EdgeCosts, extend, open};
    use abf_mesh::Point3;

    fn scale_of(mesh: &TriMesh, topology: &Topology, seams: &Seams) -> Vec<f64> {
        let system = ConformalScale::new(mesh, topology, &mut || Ok(())).expect("fits");
        system.log_scale(topology, seams).expect("a solution")
    }

    /// A paraboloid z = h (1 − r²) of small height over the unit disk: K ≈ 4h² everywhere, u = −h² (1 − r²).
    #[test]
    fn a_shallow_dome_shrinks_as_the_continuous_solution_says() {
        const HEIGHT: f64 = 0.05;
        const RINGS: usize = 24;
        let mut positions = vec![Point3::new(0.0, 0.0, HEIGHT)];
        let mut faces: Vec<[usize; 3]> = Vec::new();
        let around = 6 * RINGS;
        let at = |ring: usize, i: usize| if ring == 0 { 0 } else { 1 + (ring - 1) * around + i % around };
        for ring in 1..=RINGS {
            let r = ring as f64 / RINGS as f64;
            for i in 0..around {
                let angle = TAU * i as f64 / around as f64;
                positions.push(Point3::new(r * angle.cos(), r * angle.sin(), HEIGHT * (1.0 - r * r)));
                faces.push([at(ring - 1, i), at(ring, i), at(ring, i + 1)]);
                if ring > 1 {
                    faces.push([at(ring - 1, i), at(ring, i + 1), at(ring - 1, i + 1)]);
                }
            }
        }
        let mesh = TriMesh::new(positions, &faces).expect("a mesh");
        let topology = topology(&mesh);
        let u = scale_of(&mesh, &topology, &Seams::none(&topology));
        let exact = |p: &Point3<f64>| -HEIGHT * HEIGHT * (1.0 - p.x * p.x - p.y * p.y);
        for (u, p) in u.iter().zip(mesh.positions()) {
            assert!((u - exact(p)).abs() < 0.03 * HEIGHT * HEIGHT, "{u} for {} at {p}", exact(p));
        }
    }

    #[test]
    fn what_is_flat_does_not_shrink_and_what_is_cut_shrinks_less() {
        let flat = sheet(9, 7);
        let of_flat = topology(&flat);
        assert!(scale_of(&flat, &of_flat, &Seams::none(&of_flat)).iter().all(|u| u.abs() < 1e-12));
        let mesh = torus(24, 16);
        let topology = topology(&mesh);
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, |_| false);
        let mut seams = open(&topology, &costs);
        let range = |u: &[f64]| u.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let before = scale_of(&mesh, &topology, &seams);
        let most = (0..before.len()).max_by(|&v, &w| before[v].abs().total_cmp(&before[w].abs())).expect("vertices");
        extend(&topology, &costs, &mut seams, &[VertexId::new(most)]);
        let after = scale_of(&mesh, &topology, &seams);
        assert!(range(&after) < range(&before), "{} after {}", range(&after), range(&before));
        assert_eq!(after[most], 0.0);
    }

    #[test]
    fn sides_have_the_angles_that_face_them() {
        let angles = angles_of_sides([3.0, 4.0, 5.0]).expect("a triangle");
        let expected = [0.6_f64.asin(), 0.8_f64.asin(), std::f64::consts::FRAC_PI_2];
        assert!(angles.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-15), "{angles:?}");
        assert!(angles_of_sides([3.0, 4.0, 7.0]).is_none() && angles_of_sides([1.0, 1.0, f64::NAN]).is_none());
    }

    #[test]
    fn a_refined_scale_makes_the_angles_around_every_vertex_a_turn() {
        let mesh = torus(24, 16);
        let topology = topology(&mesh);
        let costs = EdgeCosts::new(&mesh, &topology, &CostSettings::LENGTH, |_| false);
        let seams = open(&topology, &costs);
        let system = ConformalScale::new(&mesh, &topology, &mut || Ok(())).expect("fits");
        let first = system.log_scale(&topology, &seams).expect("a solution");
        let is_fixed = system.fixed(&topology, &seams);
        let worst = |u: &[f64]| {
            let angles = scaled_angles(&mesh, |v| u[v.index()]);
            deficits(&topology, &angles, &is_fixed).into_iter().fold(0.0, |most: f64, k| most.max(k.abs()))
        };
        let refine = |steps| system.refined((&mesh, &topology), &seams, first.clone(), steps, &mut || Ok(()));
        assert_eq!(refine(0).expect("nobody aborts"), first);
        let refined = worst(&refine(4).expect("nobody aborts"));
        assert!(refined < 1e-8 && worst(&first) > 1e-4, "{refined} after {}", worst(&first));
        let aborted = system.refined((&mesh, &topology), &seams, first, 1, &mut || Err(Cancelled));
        assert_eq!(aborted, Err(Cancelled));
    }

    #[test]
    fn a_closed_surface_without_a_seam_has_no_scale() {
        let mesh = octahedron();
        let topology = topology(&mesh);
        let system = ConformalScale::new(&mesh, &topology, &mut || Ok(())).expect("fits");
        assert!(system.log_scale(&topology, &Seams::none(&topology)).is_err());
    }
}
