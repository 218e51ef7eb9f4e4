//! One condition for each boundary vertex that has one.

use super::circle::angles_on_a_circle;
use super::error::{BadAngle, BadAngleCause, BoundaryError};
use abf_mesh::{Topology, VertexId};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Marks a vertex without a condition.
const NONE: u32 = u32::MAX;

/// Sums of all angles of a boundary may be off by this much, rad; it is shared among them.
const SUM_TOLERANCE: f64 = 1e-6;

/// A polygon that is cut off has at least this much left for its two other angles, rad.
const ROOM: f64 = 1e-9;

/// The angle sum of one boundary vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoundaryAngle {
    /// The vertex, counted from 0.
    pub vertex: u32,
    /// Its angle sum, rad.
    pub angle: f64,
    /// In which line of a file it stands, counted from 1; `None` where there is no file.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub line: Option<usize>,
}

/// The conditions on the angle sums of boundary vertices: row `j` is `Σ x ≤ b` or `Σ x = b` at [`vertices`](Self::vertices)`[j]`.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundaryConditions {
    vertices: Vec<VertexId>,
    /// By vertex.
    place: Vec<u32>,
    bounds: Vec<f64>,
    are_equations: bool,
    dropped: Option<usize>,
}

impl BoundaryConditions {
    /// Every boundary vertex has a sum of at most `bound`, rad.
    #[must_use]
    pub fn at_most(topology: &Topology, bound: f64) -> Self {
        let vertices = boundary_loop(topology);
        let bounds = vec![bound; vertices.len()];
        Self::new(topology, vertices, bounds, false)
    }

    /// π/2 at four vertices and π at all others.
    ///
    /// # Errors
    /// [`BoundaryError`] when these are not four different boundary vertices, or the surface does not allow it.
    pub fn rectangle(topology: &Topology, corners: [u32; 4]) -> Result<Self, BoundaryError> {
        let vertices = boundary_loop(topology);
        if vertices.len() < corners.len() {
            return Err(BoundaryError::TooFew(vertices.len()));
        }
        for (k, &vertex) in corners.iter().enumerate() {
            let is_twice = corners[..k].contains(&vertex);
            if is_twice || !vertices.iter().any(|v| v.index() == vertex as usize) {
                return Err(BoundaryError::Corner { vertex, is_twice });
            }
        }
        let is_corner = |v: &VertexId| corners.iter().any(|&corner| corner as usize == v.index());
        let bounds = vertices.iter().map(|v| if is_corner(v) { FRAC_PI_2 } else { PI }).collect();
        Self::of_polygon(topology, vertices, bounds)
    }

    /// The angles of a polygon on a circle, where `lengths[j]` is that of the boundary edge from the `j`-th vertex of
    /// [`boundary_loop`] to the next: `π − (θ + θ′)/2` with `θ = 2 asin(ℓ / 2R)` for the two edges at a vertex, and `Σθ = 2π`.
    /// Of many short edges that is `π − 2π ℓ/Σℓ`, with `ℓ` the mean of the two.
    ///
    /// # Errors
    /// [`BoundaryError`] when the surface does not allow it.
    ///
    /// # Panics
    /// If there is not one length for every boundary edge.
    pub fn circle(topology: &Topology, lengths: &[f64]) -> Result<Self, BoundaryError> {
        let vertices = boundary_loop(topology);
        assert_eq!(lengths.len(), vertices.len(), "one length for every boundary edge");
        Self::of_polygon(topology, vertices, angles_on_a_circle(lengths))
    }

    /// These sums, the other boundary vertices free.
    ///
    /// # Errors
    /// [`BoundaryError::Angles`] with every entry that means nothing on this surface, or why it does not allow them.
    pub fn given(topology: &Topology, angles: &[BoundaryAngle]) -> Result<Self, BoundaryError> {
        let (mut vertices, mut bounds, mut bad) = (Vec::new(), Vec::new(), Vec::new());
        let mut is_taken = vec![false; topology.vertex_count()];
        for &BoundaryAngle { vertex, angle, line } in angles {
            match cause(topology, &is_taken, vertex, angle) {
                Some(cause) => bad.push(BadAngle { vertex: Some(vertex), line, cause }),
                None => {
                    is_taken[vertex as usize] = true;
                    vertices.push(VertexId::new(vertex as usize));
                    bounds.push(angle);
                }
            }
        }
        if bad.is_empty() { Self::of_polygon(topology, vertices, bounds) } else { Err(BoundaryError::Angles(bad)) }
    }

    fn new(topology: &Topology, vertices: Vec<VertexId>, bounds: Vec<f64>, are_equations: bool) -> Self {
        let mut place = vec![NONE; topology.vertex_count()];
        for (j, v) in vertices.iter().enumerate() {
            place[v.index()] = j as u32;
        }
        Self { vertices, place, bounds, are_equations, dropped: None }
    }

    /// Equations, if they allow a map.
    fn of_polygon(topology: &Topology, vertices: Vec<VertexId>, bounds: Vec<f64>) -> Result<Self, BoundaryError> {
        let mut conditions = Self::new(topology, vertices, bounds, true);
        let all = boundary_loop(topology);
        conditions.check_sum(topology, &all)?;
        conditions.check_polygons(topology, &all)?;
        if conditions.len() == all.len() {
            conditions.share_rounding(topology);
        }
        // What is left follows from the triangles, the interior vertices and the others.
        conditions.dropped = (conditions.len() == all.len()).then(|| conditions.len() - 1);
        Ok(conditions)
    }

    fn check_sum(&self, topology: &Topology, all: &[VertexId]) -> Result<(), BoundaryError> {
        let (given, count) = (self.len(), all.len());
        let sum: f64 = self.bounds.iter().sum();
        let needed = (count as f64 - 2.0) * PI;
        if given == count {
            let is_met = (self.turn() - TAU).abs() <= SUM_TOLERANCE;
            return if is_met { Ok(()) } else { Err(BoundaryError::Sum { count, sum, needed }) };
        }
        let others = all.iter().filter(|&&v| self.place(v).is_none());
        let room: f64 = others.map(|&v| most(topology, v)).sum();
        let left = needed - sum;
        let is_met = left > 0.0 && left < room;
        if is_met { Ok(()) } else { Err(BoundaryError::Rest { given, count, sum, left, room }) }
    }

    /// Brings the sum to that of a polygon. Angles that were written with a few digits miss it, and no iteration would come nearer than
    /// that to all of them. Each takes a share as large as the smaller of its distances from 0 and from the most that it can be.
    fn share_rounding(&mut self, topology: &Topology) {
        let missing = self.turn() - TAU;
        let room = |(&v, &bound): (&VertexId, &f64)| bound.min(most(topology, v) - bound);
        let rooms: Vec<f64> = self.vertices.iter().zip(&self.bounds).map(room).collect();
        let all: f64 = rooms.iter().sum();
        self.bounds.iter_mut().zip(rooms).for_each(|(bound, room)| *bound += missing * (room / all));
    }

    /// By how much the boundary turns at the vertices that have a row, rad: small where the sum of the angles is large, so that no
    /// digits are lost.
    fn turn(&self) -> f64 {
        self.bounds.iter().map(|bound| PI - bound).sum()
    }

    /// Every polygon that an edge between boundary vertices cuts off has `m + 2` angles: where `m` of them are given, the
    /// other two need some.
    fn check_polygons(&self, topology: &Topology, all: &[VertexId]) -> Result<(), BoundaryError> {
        let n = all.len();
        // What is given up to each vertex of the loop, and how many are not.
        let mut before = vec![(0.0, 0_usize); n + 1];
        for (j, &v) in all.iter().enumerate() {
            let (sum, free) = before[j];
            before[j + 1] = match self.place(v) {
                Some(row) => (sum + PI - self.bounds[row], free),
                None => (sum, free + 1),
            };
        }
        let mut order = vec![NONE; topology.vertex_count()];
        all.iter().enumerate().for_each(|(j, v)| order[v.index()] = j as u32);
        let at = |v: VertexId| (order[v.index()] != NONE).then_some(order[v.index()] as usize);
        for c in topology.corners().filter(|&c| topology.opposite(c).is_some_and(|o| c < o)) {
            let ends = [c.next(), c.prev()].map(|c| topology.vertex(c));
            let (Some(a), Some(b)) = (at(ends[0]), at(ends[1])) else { continue };
            let (a, b) = (a.min(b), a.max(b));
            let inside = (before[b].0 - before[a + 1].0, before[b].1 - before[a + 1].1);
            let outside = (before[n].0 - before[b + 1].0 + before[a].0, before[n].1 - before[b + 1].1 + before[a].1);
            for ((turn, free), between, ear) in [(inside, b - a - 1, a + 1), (outside, n - (b - a) - 1, (b + 1) % n)] {
                if free > 0 || turn > ROOM {
                    continue;
                }
                if between == 1 && topology.fan(all[ear]).count() == 1 {
                    return Err(BoundaryError::Ear { vertex: all[ear].index() as u32, angle: PI - turn });
                }
                let (a, b) = (all[a].index() as u32, all[b].index() as u32);
                return Err(BoundaryError::Chord { a, b, between });
            }
        }
        Ok(())
    }

    /// How many rows there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.vertices.is_empty()
    }

    /// The vertices, in the order of the rows.
    #[must_use]
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// The row of a vertex.
    #[inline]
    #[must_use]
    pub fn place(&self, vertex: VertexId) -> Option<usize> {
        match self.place[vertex.index()] {
            NONE => None,
            j => Some(j as usize),
        }
    }

    /// b, rad. Where a whole boundary was given and its sum was off by 1e-6 or less, that is shared among the vertices.
    #[must_use]
    pub fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// Whether the rows are equations; else they are upper bounds.
    #[must_use]
    pub fn are_equations(&self) -> bool {
        self.are_equations
    }

    /// The row that follows from all others, where the sums of the whole boundary are given.
    #[must_use]
    pub fn dropped(&self) -> Option<usize> {
        self.dropped
    }

    /// `Σ x − b` of every row, rad.
    #[must_use]
    pub fn residual(&self, topology: &Topology, angles: &[f64]) -> Vec<f64> {
        let sum = |v: VertexId| topology.fan(v).map(|c| angles[c.index()]).sum::<f64>();
        self.vertices.iter().zip(&self.bounds).map(|(&v, b)| sum(v) - b).collect()
    }

    /// By how much the row that is off most is off, rad: `max |Σ x − b|`, of upper bounds `max (Σ x − b)` or 0.
    /// Infinite when an angle is NaN.
    #[must_use]
    pub fn violation(&self, topology: &Topology, angles: &[f64]) -> f64 {
        let of = |r: f64| if self.are_equations { r.abs() } else { r.max(0.0) };
        let residual = self.residual(topology, angles);
        if residual.iter().any(|r| r.is_nan()) {
            return f64::INFINITY;
        }
        residual.into_iter().fold(0.0, |most: f64, r| most.max(of(r)))
    }
}

/// The boundary vertices of a disk, counter-clockwise; each with the next one along the boundary after it.
#[must_use]
pub fn boundary_loop(topology: &Topology) -> Vec<VertexId> {
    let Some(first) = topology.vertices().find(|&v| topology.is_boundary(v)) else { return Vec::new() };
    let next = |v: VertexId| topology.fan_start(v).map(|c| topology.vertex(c.next()));
    std::iter::successors(Some(first), |&v| next(v).filter(|&next| next != first)).collect()
}

/// π for each triangle at a vertex.
fn most(topology: &Topology, vertex: VertexId) -> f64 {
    topology.fan(vertex).count() as f64 * PI
}

/// Why a vertex cannot have this angle.
fn cause(topology: &Topology, is_taken: &[bool], vertex: u32, angle: f64) -> Option<BadAngleCause> {
    let Some(&is_taken) = is_taken.get(vertex as usize) else {
        return Some(BadAngleCause::Unknown(topology.vertex_count()));
    };
    let vertex = VertexId::new(vertex as usize);
    if !topology.is_boundary(vertex) {
        return Some(BadAngleCause::NotOnTheBoundary);
    }
    if is_taken {
        return Some(BadAngleCause::Twice);
    }
    let most = most(topology, vertex);
    (!(angle > 0.0 && angle < most)).then_some(BadAngleCause::Angle { angle, most })
}

#[cfg(test)]
mod tests {
    use super::super::Boundary;
    use super::*;
    use abf_mesh::{Point3, TriMesh};
    use abf_shapes::Shape;

    fn topology(mesh: &TriMesh) -> Topology {
        Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold")
    }

    /// A fan of triangles around vertex 0, which is on the boundary too: 0, 1, …, n.
    fn fan(n: usize) -> Topology {
        let points = (0..=n).map(|k| Point3::from([k as f64, (k * k) as f64, 0.0])).collect();
        let faces: Vec<[usize; 3]> = (1..n).map(|k| [0, k, k + 1]).collect();
        topology(&TriMesh::new(points, &faces).expect("indices in range"))
    }

    fn angle(vertex: u32, angle: f64) -> BoundaryAngle {
        BoundaryAngle { vertex, angle, line: Some(vertex as usize + 1) }
    }

    #[test]
    fn the_loop_passes_every_boundary_vertex_once_and_counter_clockwise() {
        let topology = topology(&Shape::BumpySheet.mesh(300));
        let all = boundary_loop(&topology);
        assert_eq!(all.len(), topology.boundary_edge_count());
        for (j, &v) in all.iter().enumerate() {
            let start = topology.fan_start(v).expect("on the boundary");
            assert_eq!(topology.vertex(start.next()), all[(j + 1) % all.len()]);
        }
    }

    #[test]
    fn a_straight_ear_is_named() {
        // Vertices 1 and 4 are in one triangle each.
        let error = BoundaryConditions::given(&fan(4), &[angle(1, PI - 1e-12)]).unwrap_err();
        assert!(matches!(error, BoundaryError::Ear { vertex: 1, .. }), "{error}");
        let error = BoundaryConditions::rectangle(&fan(5), [0, 2, 3, 5]).unwrap_err();
        assert!(matches!(error, BoundaryError::Ear { vertex: 1, .. }), "{error}");
    }

    #[test]
    fn a_chord_across_a_straight_side_is_named() {
        // A fan of 6: the edge 0–3 cuts off 1 and 2, the first an ear; with 1 free below π, the pair is what is asked for.
        let error = BoundaryConditions::given(&fan(6), &[angle(1, 3.0), angle(2, TAU - 3.0)]).unwrap_err();
        assert_eq!(error, BoundaryError::Chord { a: 0, b: 3, between: 2 });
        assert!(error.to_string().contains("between the vertices 0 and 3"), "{error}");
    }

    #[test]
    fn sums_that_no_polygon_has_are_refused_and_one_of_all_rows_is_dropped() {
        let square = fan(3);
        let all = |last: f64| [0, 1, 2, 3].map(|v| angle(v, if v == 3 { last } else { FRAC_PI_2 }));
        let conditions = BoundaryConditions::given(&square, &all(FRAC_PI_2)).expect("a square");
        assert_eq!((conditions.len(), conditions.dropped()), (4, Some(3)));
        let error = BoundaryConditions::given(&square, &all(FRAC_PI_2 + 1e-5)).unwrap_err();
        assert!(matches!(error, BoundaryError::Sum { count: 4, .. }), "{error}");
        // What few digits leave of the sum is shared.
        let rounded = BoundaryConditions::given(&square, &all(FRAC_PI_2 + 8e-7)).expect("a square");
        let sum: f64 = rounded.bounds().iter().sum();
        assert!((sum - TAU).abs() < 1e-14 && (rounded.bounds()[0] - FRAC_PI_2 + 2e-7).abs() < 3e-7, "{rounded:?}");
        let tiny = |v: u32| match v {
            1 => 1e-8,
            3 => 3.0,
            _ => 0.5 * (TAU - 3.0) + 4.5e-7,
        };
        let rounded = BoundaryConditions::given(&square, &[0, 1, 2, 3].map(|v| angle(v, tiny(v)))).expect("a kite");
        assert!(rounded.bounds().iter().all(|&bound| bound > 0.0 && bound < TAU), "{rounded:?}");
        let error = BoundaryConditions::given(&square, &[angle(0, 6.0), angle(2, 0.3)]).unwrap_err();
        assert!(matches!(error, BoundaryError::Rest { given: 2, .. }), "{error}");
        let some = BoundaryConditions::given(&square, &all(FRAC_PI_2)[..3]).expect("three of a square");
        assert_eq!(some.dropped(), None);
    }

    #[test]
    fn every_bad_entry_is_named() {
        let mesh = Shape::BumpySheet.mesh(200);
        let topology = topology(&mesh);
        let inside = topology.vertices().find(|&v| topology.is_interior(v)).expect("one").index() as u32;
        let (a, b) = (boundary_loop(&topology)[3].index() as u32, boundary_loop(&topology)[4].index() as u32);
        let entries = [angle(a, 3.0), angle(1 << 20, 3.0), angle(inside, 3.0), angle(a, 3.0), angle(b, f64::NAN)];
        let BoundaryError::Angles(bad) = BoundaryConditions::given(&topology, &entries).unwrap_err() else {
            panic!("entries")
        };
        let causes: Vec<BadAngleCause> = bad.iter().map(|bad| bad.cause).collect();
        assert_eq!(
            causes[..3],
            [BadAngleCause::Unknown(mesh.vertex_count()), BadAngleCause::NotOnTheBoundary, BadAngleCause::Twice]
        );
        assert!(matches!(causes[3], BadAngleCause::Angle { .. }) && causes.len() == 4);
    }

    #[test]
    fn upper_bounds_are_violated_above_only_and_equations_on_both_sides() {
        let mesh = Shape::BumpySheet.mesh(200);
        let topology = topology(&mesh);
        let angles = mesh.corner_angles();
        assert_eq!(BoundaryConditions::at_most(&topology, 2.0 * TAU).violation(&topology, &angles), 0.0);
        let convex = BoundaryConditions::at_most(&topology, PI);
        let most = convex.residual(&topology, &angles).into_iter().fold(0.0, f64::max);
        assert_eq!(convex.violation(&topology, &angles), most);
        let lengths = vec![1.0; convex.len()];
        let circle = BoundaryConditions::circle(&topology, &lengths).expect("a circle");
        let sum: f64 = circle.bounds().iter().sum();
        assert!((sum - (circle.len() as f64 - 2.0) * PI).abs() < 1e-9 && circle.are_equations());
        let largest = circle.residual(&topology, &angles).into_iter().fold(0.0, |most: f64, r| most.max(r.abs()));
        assert_eq!(circle.violation(&topology, &angles), largest);
    }

    #[test]
    fn angles_that_may_not_be_as_large_as_those_of_a_polygon_are_refused() {
        let topology = fan(6);
        let error = Boundary::Below2Pi(6.0).conditions(&topology).unwrap_err();
        assert!(matches!(error, BoundaryError::TooSmall { count: 7, .. }), "{error}");
        assert!(Boundary::Below2Pi(0.5).conditions(&topology).is_ok());
    }

    #[test]
    fn a_rectangle_with_hundreds_of_thousands_of_vertices_has_the_sum_of_a_polygon() {
        let columns = 200_000_u32;
        let at = |x: u32, y: u32| (2 * x + y) as usize;
        let square = |x| [[at(x, 0), at(x + 1, 0), at(x + 1, 1)], [at(x, 0), at(x + 1, 1), at(x, 1)]];
        let faces: Vec<[VertexId; 3]> = (0..columns).flat_map(square).map(|face| face.map(VertexId::new)).collect();
        let topology = Topology::build(2 * columns as usize + 2, &faces).expect("a strip");
        let corners = [0, 1, 2 * columns, 2 * columns + 1];
        let result = BoundaryConditions::rectangle(&topology, corners);
        assert!(!matches!(result, Err(BoundaryError::Sum { .. })), "{result:?}");
    }
}
