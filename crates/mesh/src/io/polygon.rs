//! A polygon cut into triangles that lie inside its outline.
//!
//! The polygon is looked at along the axis nearest to its normal: that drops one coordinate and rounds nothing, so that
//! corners on one line stay on one line. A fan around the first corner is kept for a convex polygon, and wherever each
//! of its triangles runs counter-clockwise and has an area. Any other polygon gets the constrained Delaunay triangulation of its outline. Both are
//! decided by exact signs.

use std::collections::HashMap;

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Triangulation};

use crate::predicates::orient2d;
use crate::tri_mesh::has_no_area;
use crate::{Point2, Point3, Vector3};

/// How far from its plane a corner may lie, as a part of the largest extent, before the polygon is said not to be planar.
const PLANAR: f64 = 1e-3;

/// The largest coordinate is brought near to 1; smaller ones than this count as 0.
const TINY: f64 = 1e-100;

/// The polygons of a file that are no fans, by their number among all faces: their triangles as places in the polygon.
pub(super) type Inside = HashMap<usize, Vec<[u32; 3]>>;

/// A polygon in triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Cut {
    /// The triangles as places in the polygon, as many as a fan has; `None` for a fan around the first corner.
    pub(super) inside: Option<Vec<[u32; 3]>>,
    /// Whether no triangles fit inside, because the outline crosses or touches itself; the fan has faces turned over then.
    pub(super) is_crossing: bool,
    /// Whether corners lie off the plane.
    pub(super) is_bent: bool,
}

/// Cuts a polygon of at least three corners.
pub(super) fn cut(corners: &[Point3<f64>]) -> Cut {
    let largest = corners.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    if corners.len() < 4 || largest == 0.0 || !largest.is_finite() {
        return Cut::default();
    }
    // In two steps, as the power itself may be out of range. Powers of two round nothing.
    let half = (-largest.log2() / 2.0).round().exp2();
    let points: Vec<Point3<f64>> = corners.iter().map(|p| p * half * half).collect();
    let normal = newell(&points);
    let flat = flatten(&points, &normal);
    let turn = |a: usize, b: usize, c: usize| orient2d(flat[a], flat[b], flat[c]);
    let fan = || (1..points.len() - 1).map(|i| (i, i + 1));
    let has_area = |&(i, j): &(usize, usize)| !has_no_area(&[points[0], points[i], points[j]]);
    let is_bent = is_bent(&points, &normal);
    let count = points.len();
    let is_convex = || (0..count).all(|i| turn(i, (i + 1) % count, (i + 2) % count) >= 0.0);
    let is_unfolded = fan().all(|(i, j)| turn(0, i, j) >= 0.0);
    if is_unfolded && (fan().all(|pair| has_area(&pair)) || is_convex()) {
        return Cut { is_bent, ..Cut::default() };
    }
    let inside = triangulate(&flat);
    let is_crossing = inside.is_none() && fan().any(|(i, j)| turn(0, i, j) < 0.0 && has_area(&(i, j)));
    Cut { inside, is_crossing, is_bent }
}

/// Twice the area vector of the polygon (Newell's normal).
fn newell(points: &[Point3<f64>]) -> Vector3<f64> {
    let arms = |i: usize| [points[i] - points[0], points[i + 1] - points[0]];
    (1..points.len() - 1).map(arms).map(|[a, b]| a.cross(&b)).sum()
}

/// The coordinates that are left when the one along the normal is dropped, counter-clockwise.
fn flatten(points: &[Point3<f64>], normal: &Vector3<f64>) -> Vec<Point2<f64>> {
    let axis = normal.iamax();
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (u, v) = (v, u);
    }
    let kept = |x: f64| if x.abs() < TINY { 0.0 } else { x };
    points.iter().map(|p| Point2::new(kept(p[u]), kept(p[v]))).collect()
}

fn is_bent(points: &[Point3<f64>], normal: &Vector3<f64>) -> bool {
    let Some(normal) = normal.try_normalize(0.0) else { return false };
    let arms = || points.iter().map(|p| p - points[0]);
    let extent = arms().map(|arm| arm.amax()).fold(0.0, f64::max);
    let heights = || arms().map(|arm| arm.dot(&normal));
    let spread = heights().fold(0.0, f64::max) - heights().fold(0.0, f64::min);
    spread > PLANAR * extent
}

/// The triangles of the constrained Delaunay triangulation inside an outline, each from its lowest corner, in ascending
/// order. `None` where the outline crosses or touches itself so that they are not two fewer than its corners.
fn triangulate(flat: &[Point2<f64>]) -> Option<Vec<[u32; 3]>> {
    let mut plane = ConstrainedDelaunayTriangulation::<spade::Point2<f64>>::new();
    let mut handles = Vec::with_capacity(flat.len());
    for p in flat {
        handles.push(plane.insert(spade::Point2::new(p.x, p.y)).ok()?);
    }
    // How many sides of the outline run along an edge: a bridge to a hole has two.
    let mut sides = HashMap::new();
    for (i, &from) in handles.iter().enumerate() {
        let edges = plane.try_add_constraint(from, handles[(i + 1) % handles.len()]);
        if edges.is_empty() {
            return None;
        }
        edges.iter().for_each(|edge| *sides.entry(edge.as_undirected()).or_insert(0_usize) += 1);
    }
    let mut corners_at: HashMap<FixedVertexHandle, Vec<usize>> = HashMap::new();
    handles.iter().enumerate().for_each(|(i, &handle)| corners_at.entry(handle).or_default().push(i));
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    for face in inner_faces(&plane, &sides) {
        let around = plane.face(face).vertices().map(|v| v.fix());
        let corner = |k: usize| {
            let toward = handles_position(&plane, around[(k + 1) % 3]);
            corners_at
                .get(&around[k])?
                .iter()
                .copied()
                .find(|&c| corners_at[&around[k]].len() == 1 || opens_toward(flat, c, toward))
        };
        let mut triangle = [corner(0)? as u32, corner(1)? as u32, corner(2)? as u32];
        let lowest = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
        triangle.rotate_left(lowest);
        triangles.push(triangle);
    }
    triangles.sort_unstable();
    (triangles.len() == flat.len() - 2).then_some(triangles)
}

type Plane = ConstrainedDelaunayTriangulation<spade::Point2<f64>>;
type FaceHandle = spade::handles::FixedFaceHandle<spade::handles::InnerTag>;
type EdgeHandle = spade::handles::FixedUndirectedEdgeHandle;

fn handles_position(plane: &Plane, vertex: FixedVertexHandle) -> Point2<f64> {
    let p = plane.vertex(vertex).position();
    Point2::new(p.x, p.y)
}

/// The faces that an odd number of sides parts from the outside.
fn inner_faces(plane: &Plane, sides: &HashMap<EdgeHandle, usize>) -> Vec<FaceHandle> {
    let crosses = |edge: EdgeHandle| sides.get(&edge).is_some_and(|count| count % 2 == 1);
    let mut is_inside: HashMap<FaceHandle, bool> = HashMap::new();
    let mut open = Vec::new();
    for edge in plane.convex_hull() {
        if let Some(face) = edge.rev().face().as_inner() {
            open.push((face.fix(), crosses(edge.as_undirected().fix())));
        }
    }
    while let Some((face, inside)) = open.pop() {
        if is_inside.insert(face, inside).is_some() {
            continue;
        }
        for edge in plane.face(face).adjacent_edges() {
            if let Some(next) = edge.rev().face().as_inner()
                && !is_inside.contains_key(&next.fix())
            {
                open.push((next.fix(), inside != crosses(edge.as_undirected().fix())));
            }
        }
    }
    is_inside.into_iter().filter_map(|(face, inside)| inside.then_some(face)).collect()
}

/// Whether the inside of the outline at a corner begins at this direction, or has it within: counter-clockwise from the next
/// corner up to, and without, the previous.
fn opens_toward(flat: &[Point2<f64>], corner: usize, toward: Point2<f64>) -> bool {
    let here = flat[corner];
    let next = flat[(corner + 1) % flat.len()];
    let previous = flat[(corner + flat.len() - 1) % flat.len()];
    let is_left = |a: Point2<f64>, b: Point2<f64>| orient2d(here, a, b) > 0.0;
    let is_same = |a: Point2<f64>, b: Point2<f64>| {
        let before = |x: f64, y: f64| x.partial_cmp(&y);
        orient2d(here, a, b) == 0.0
            && before(a.x, here.x) == before(b.x, here.x)
            && before(a.y, here.y) == before(b.y, here.y)
    };
    if is_same(toward, next) {
        return true;
    }
    if is_left(next, previous) {
        is_left(next, toward) && is_left(toward, previous)
    } else {
        !(is_same(toward, previous) || (is_left(previous, toward) && is_left(toward, next)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polygon of the plane z = 0.
    fn polygon(points: &[[f64; 2]]) -> Vec<Point3<f64>> {
        points.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect()
    }

    fn area(points: &[Point3<f64>], [a, b, c]: [u32; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
        0.5 * (b - a).cross(&(c - a)).z
    }

    const LETTER_E: [[f64; 2]; 12] = [
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [3.0, 2.0],
        [3.0, 3.0],
        [1.0, 3.0],
        [1.0, 4.0],
        [3.0, 4.0],
        [3.0, 5.0],
        [0.0, 5.0],
    ];

    #[test]
    fn a_letter_is_cut_inside_its_outline_wherever_it_begins() {
        for first in 0..LETTER_E.len() {
            let mut outline = LETTER_E;
            outline.rotate_left(first);
            let points = polygon(&outline);
            let triangles = cut(&points).inside.expect("no fan");
            assert_eq!(triangles.len(), 10);
            assert!(triangles.iter().all(|&t| area(&points, t) > 0.0));
            assert_eq!(triangles.iter().map(|&t| area(&points, t)).sum::<f64>(), 11.0);
        }
    }

    #[test]
    fn a_convex_polygon_keeps_its_fan() {
        for n in [4, 5, 17, 1000] {
            let at = |i: i32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
            let points: Vec<Point3<f64>> =
                (0..n).map(at).map(|t| Point3::new(t.cos(), t.sin() + 3.0, 0.2 * t.cos() - 0.3 * t.sin())).collect();
            assert_eq!(cut(&points), Cut::default(), "{n}");
        }
    }

    #[test]
    fn a_frame_with_a_bridge_to_its_hole_keeps_the_hole() {
        let (outer, inner) =
            ([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]], [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]]);
        let mut outline = outer.to_vec();
        outline.push(outer[0]);
        outline.extend(inner);
        outline.push(inner[0]);
        let points = polygon(&outline);
        let triangles = cut(&points).inside.expect("no fan");
        assert_eq!(triangles.len(), 8);
        assert_eq!(triangles.iter().map(|&t| area(&points, t)).sum::<f64>(), 8.0);
        // Every side is the side of one triangle, in its direction.
        for side in 0..10 {
            let ends = [side, (side + 1) % 10];
            let has = |t: &&[u32; 3]| (0..3).any(|k| [t[k], t[(k + 1) % 3]] == ends);
            assert_eq!(triangles.iter().filter(has).count(), 1, "{side}");
        }
    }

    #[test]
    fn corners_on_one_line_leave_a_convex_polygon_its_fan_and_make_no_flat_triangle_in_another() {
        let wall = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        assert_eq!(cut(&polygon(&wall)), Cut::default());
        let notched = polygon(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 1.0], [0.0, 2.0]]);
        let triangles = cut(&notched).inside.expect("no fan");
        assert!(triangles.iter().all(|&t| area(&notched, t) > 0.0), "{triangles:?}");
    }

    #[test]
    fn a_polygon_that_crosses_itself_is_said_and_stays_a_fan() {
        let bow = polygon(&[[0.0, 0.0], [4.0, 0.0], [1.0, 2.0], [3.0, 2.0], [3.0, 1.0]]);
        assert_eq!(cut(&bow), Cut { is_crossing: true, ..Cut::default() });
        let pole = polygon(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        assert_eq!(cut(&pole), Cut::default());
    }

    #[test]
    fn the_cut_depends_on_neither_size_nor_place() {
        let of = |scale: f64| cut(&polygon(&LETTER_E.map(|p| p.map(|x| x * scale))));
        for exponent in [-1000, -400, 400, 1000] {
            assert_eq!(of(2.0_f64.powi(exponent)), of(1.0), "2^{exponent}");
        }
    }

    #[test]
    fn a_bent_polygon_is_said() {
        let mut points = polygon(&LETTER_E);
        points[6].z = 0.5;
        let cut = cut(&points);
        assert!(cut.is_bent && cut.inside.is_some());
    }
}
