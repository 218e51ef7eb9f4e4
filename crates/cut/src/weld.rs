//! Vertices that stand in one place and are not shared: a soup of triangles, a sphere whose last column meets its first.
//!
//! Vertices are joined along boundary edges only, where both ends of one edge are at the ends of another: a vertex that
//! touches a surface elsewhere is left alone. Positions stay; of the joined vertices the faces use the lowest.

use crate::repair::Found;
use abf_control::SettingError;
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{DisjointSets, Point3, Topology, TriMesh, VertexId};
use std::collections::HashMap;
use std::fmt;
use std::str::FromStr;

/// How many units in the last place may lie between coordinates that are meant to be one.
const ULPS: f64 = 4.0;

/// Cells of the search are this many tolerances wide, so that most places are in one cell.
const CELL: f64 = 64.0;

/// Which vertices are joined before anything else is done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Weld {
    /// Those within 4 units in the last place at the size of their component, but none in a mesh that is one disk. The
    /// units are those of 32-bit numbers where all coordinates are such, else of 64-bit numbers.
    #[default]
    Auto,
    /// None.
    Off,
    /// Those at most so far apart, in units of the mesh, in any mesh.
    #[cfg_attr(feature = "serde", serde(untagged))]
    Within(f64),
}

impl Weld {
    /// The same rule for a mesh whose coordinates were multiplied by `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Within(distance) => Self::Within(distance * factor),
            rule => rule,
        }
    }
}

/// A mesh with shared vertices.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Welded {
    /// The same vertices and faces; the faces use the lowest of joined vertices.
    pub mesh: TriMesh,
    /// The vertices that were joined with a lower one.
    pub joined: Found,
}

/// Joins vertices in one place; `None` where there are none.
///
/// Takes time `O(n log n)` where no more than a few vertices are within a tolerance of each other.
#[must_use]
pub fn weld(mesh: &TriMesh, rule: Weld) -> Option<Welded> {
    weld_within(mesh, rule, None)
}

/// The same within objects: vertices of faces with different labels are not joined. There is a label for every face.
#[must_use]
pub fn weld_within(mesh: &TriMesh, rule: Weld, objects: Option<&[u32]>) -> Option<Welded> {
    weld_asking(mesh, rule, objects, &mut || Ok(())).expect("nobody ends it")
}

/// [`weld_within`] that asks between its parts whether to go on.
///
/// # Errors
/// [`Cancelled`].
pub fn weld_asking(
    mesh: &TriMesh,
    rule: Weld,
    objects: Option<&[u32]>,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Option<Welded>, Cancelled> {
    let object = |edge: Edge| objects.map_or(0, |objects| objects[edge.face]);
    if rule == Weld::Off || (rule == Weld::Auto && is_disk(mesh, checkpoint)?) {
        return Ok(None);
    }
    let edges = boundary_edges(mesh, checkpoint)?;
    if edges.len() < 2 {
        return Ok(None);
    }
    let tolerances = tolerances(mesh, rule);
    checkpoint()?;
    let places = Places::find(mesh, &edges, &tolerances);
    checkpoint()?;
    let mut joined = DisjointSets::new(mesh.vertex_count());
    let mut by_place: Vec<([usize; 2], Edge)> = edges.iter().map(|&edge| places.along(edge)).collect();
    by_place.sort_by_key(|&(ends, edge)| (ends, object(edge), edge.face));
    checkpoint()?;
    let tip_place = |edge: Edge| mesh.positions()[edge.tip.index()];
    for group in by_place.chunk_by(|a, b| a.0 == b.0 && object(a.1) == object(b.1)) {
        // The two sides of a card meet all around, and stay two.
        let is_card = matches!(group, [(_, a), (_, b)] if tip_place(*a) == tip_place(*b));
        if group.len() < 2 || group[0].0[0] == group[0].0[1] || is_card {
            continue;
        }
        let [from, to] = group[0].1.ends;
        for (_, edge) in &group[1..] {
            joined.unite(from.index(), edge.ends[0].index());
            joined.unite(to.index(), edge.ends[1].index());
        }
    }
    let lowest: Vec<usize> = (0..mesh.vertex_count()).map(|v| joined.find(v)).collect();
    checkpoint()?;
    let found = Found::of((0..lowest.len()).filter(|&v| lowest[v] != v));
    Ok((found.count > 0).then(|| {
        let faces: Vec<[usize; 3]> = mesh.faces().iter().map(|face| face.map(|v| lowest[v.index()])).collect();
        let mesh = TriMesh::new(mesh.positions().to_vec(), &faces).expect("vertices of the mesh");
        Welded { mesh, joined: found }
    }))
}

fn is_disk(mesh: &TriMesh, checkpoint: &mut Checkpoint<'_>) -> Result<bool, Cancelled> {
    let topology = Topology::build_asking(mesh.vertex_count(), mesh.faces(), checkpoint)?;
    Ok(topology.is_ok_and(|topology| topology.require_disk().is_ok()))
}

/// An edge of one face.
#[derive(Clone, Copy)]
struct Edge {
    ends: [VertexId; 2],
    /// The third vertex of its face.
    tip: VertexId,
    face: usize,
}

fn boundary_edges(mesh: &TriMesh, checkpoint: &mut Checkpoint<'_>) -> Result<Vec<Edge>, Cancelled> {
    let of_face = |(face, &[a, b, c]): (usize, &[VertexId; 3])| {
        [(a, b, c), (b, c, a), (c, a, b)].map(|(from, to, tip)| Edge { ends: [from, to], tip, face })
    };
    let all: Vec<Edge> = mesh.faces().iter().enumerate().flat_map(of_face).collect();
    let key = |edge: &Edge| [edge.ends[0].min(edge.ends[1]), edge.ends[0].max(edge.ends[1])];
    // Numbers are sorted faster than edges. An edge and its number are found in one order.
    let mut order: Vec<([VertexId; 2], u32)> = all.iter().zip(0..).map(|(edge, i)| (key(edge), i)).collect();
    checkpoint()?;
    order.sort_unstable();
    checkpoint()?;
    let single = order.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1);
    Ok(single.map(|same| all[same[0].1 as usize]).collect())
}

/// For every vertex how far one that is meant to be the same may be.
fn tolerances(mesh: &TriMesh, rule: Weld) -> Vec<f64> {
    if let Weld::Within(distance) = rule {
        return vec![distance; mesh.vertex_count()];
    }
    let is_single = |x: &f64| f64::from(*x as f32) == *x;
    let is_single = mesh.positions().iter().all(|p| p.iter().all(is_single));
    let epsilon = if is_single { f64::from(f32::EPSILON) } else { f64::EPSILON };
    let mut components = DisjointSets::new(mesh.vertex_count());
    for [a, b, c] in mesh.faces() {
        components.unite(a.index(), b.index());
        components.unite(b.index(), c.index());
    }
    let root: Vec<usize> = (0..mesh.vertex_count()).map(|v| components.find(v)).collect();
    let mut boxes: Vec<Option<(Point3<f64>, Point3<f64>)>> = vec![None; mesh.vertex_count()];
    for (&root, p) in root.iter().zip(mesh.positions()) {
        let (low, high) = boxes[root].unwrap_or((*p, *p));
        boxes[root] = Some((low.inf(p), high.sup(p)));
    }
    let sizes: Vec<f64> = boxes.iter().map(|b| b.map_or(0.0, |(low, high)| (high - low).amax())).collect();
    let ulp = |size: f64| if size > 0.0 { epsilon * size.log2().floor().exp2() } else { 0.0 };
    root.iter().map(|&root| ULPS * ulp(sizes[root])).collect()
}

/// The cell of a coordinate along one axis, [`CELL`] tolerances wide. A coordinate whose neighbouring numbers are farther away
/// than the tolerance is a cell of its own.
fn cell(x: f64, tolerance: f64) -> u64 {
    /// From here on, one step from a number to the next is more than [`CELL`] tolerances.
    const FAR: f64 = 1.0 / f64::EPSILON;
    let place = x / (CELL * tolerance);
    // Adding +0 makes the zeros of either sign one.
    (if place.abs() < FAR { place.floor() } else { x } + 0.0).to_bits()
}

/// Which vertices at the boundary are in one place.
struct Places {
    of_vertex: HashMap<VertexId, usize>,
}

impl Places {
    /// Joins the places of vertices that are within the smaller of their tolerances in every coordinate.
    fn find(mesh: &TriMesh, edges: &[Edge], tolerances: &[f64]) -> Self {
        let mut vertices: Vec<VertexId> = edges.iter().flat_map(|edge| edge.ends).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let at = |v: VertexId| mesh.positions()[v.index()];
        let order = |a: &VertexId, b: &VertexId| {
            let (p, q) = (at(*a), at(*b));
            p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)).then(a.cmp(b))
        };
        vertices.sort_by(order);
        // One for every position, with the largest tolerance there. Zeros of either sign are found as neighbours.
        let same: Vec<&[VertexId]> =
            vertices.chunk_by(|a, b| at(*a).coords.map(f64::to_bits) == at(*b).coords.map(f64::to_bits)).collect();
        let tolerance: Vec<f64> =
            same.iter().map(|list| list.iter().map(|v| tolerances[v.index()]).fold(0.0, f64::max)).collect();
        let largest = tolerance.iter().copied().fold(0.0, f64::max);
        let cells_of = |x: f64| {
            let [low, high] = [x - largest, x + largest].map(|x| cell(x, largest));
            [Some(low), Some(high).filter(|high| *high != low)].into_iter().flatten()
        };
        let mut cells: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
        let mut joined = DisjointSets::new(same.len());
        for (i, list) in same.iter().enumerate() {
            let p = at(list[0]);
            for cell in cells_of(p.x)
                .flat_map(|x| cells_of(p.y).map(move |y| [x, y]))
                .flat_map(|[x, y]| cells_of(p.z).map(move |z| [x, y, z]))
            {
                let near = cells.entry(cell).or_default();
                for &j in near.iter() {
                    if (at(same[j][0]) - p).amax() <= tolerance[i].min(tolerance[j]) {
                        joined.unite(i, j);
                    }
                }
                near.push(i);
            }
        }
        let mut of_vertex = HashMap::with_capacity(vertices.len());
        for (i, list) in same.iter().enumerate() {
            let place = joined.find(i);
            of_vertex.extend(list.iter().map(|&v| (v, place)));
        }
        Self { of_vertex }
    }

    /// The places of the ends of an edge, the lower first, and the edge in that direction.
    fn along(&self, edge: Edge) -> ([usize; 2], Edge) {
        let [a, b] = edge.ends.map(|v| self.of_vertex[&v]);
        if a <= b { ([a, b], edge) } else { ([b, a], Edge { ends: [edge.ends[1], edge.ends[0]], ..edge }) }
    }
}

impl fmt::Display for Weld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Off => f.write_str("off"),
            Self::Within(distance) => write!(f, "{distance}"),
        }
    }
}

impl FromStr for Weld {
    type Err = SettingError;

    fn from_str(s: &str) -> Result<Self, SettingError> {
        match s {
            "auto" => Ok(Self::Auto),
            "off" => Ok(Self::Off),
            _ => match s.parse() {
                Ok(distance) if (0.0..f64::INFINITY).contains(&distance) => Ok(Self::Within(distance)),
                _ => Err(SettingError::new("weld", "auto, off or a distance of at least 0", format_args!("'{s}'"))),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{mesh, octahedron, sheet, tetrahedron, torus};
    use crate::{DoubleSided, RepairError, Seams, repair, repair_asking, split_asking};

    /// Ends work at each of its questions: it ends at once, and asks nothing more.
    fn ends_at_every_question(work: impl Fn(&mut Checkpoint<'_>) -> Result<(), Cancelled>) {
        let mut all = 0;
        work(&mut || {
            all += 1;
            Ok(())
        })
        .expect("nobody ends it");
        assert!(all > 3, "{all} questions");
        for question in 1..=all {
            let mut asked = 0;
            let end = work(&mut || {
                asked += 1;
                if asked == question { Err(Cancelled) } else { Ok(()) }
            });
            assert_eq!((end, asked), (Err(Cancelled), question));
        }
    }

    #[test]
    fn welding_repair_and_splitting_end_at_every_question() {
        let soup = soup(&torus(6, 8));
        ends_at_every_question(|checkpoint| weld_asking(&soup, Weld::Auto, None, checkpoint).map(drop));
        let joined = weld(&soup, Weld::Auto).expect("vertices in one place").mesh;
        let [mut faces, doubled] =
            [0, 1].map(|_| joined.faces().iter().map(|f| f.map(VertexId::index)).collect::<Vec<_>>());
        // A sheet upon it, and one face the wrong way around.
        faces.extend(doubled);
        faces[3].swap(0, 1);
        let broken = TriMesh::new(joined.positions().to_vec(), &faces).expect("indices in range");
        ends_at_every_question(|checkpoint| match repair_asking(&broken, DoubleSided::Own, checkpoint) {
            Ok(repaired) => {
                assert_eq!(repaired.faces.len(), broken.face_count());
                Ok(())
            }
            Err(RepairError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => panic!("{error}"),
        });
        let topology = Topology::build(joined.vertex_count(), joined.faces()).expect("a torus");
        let seams = Seams::none(&topology);
        ends_at_every_question(|checkpoint| {
            split_asking(&joined, &topology, &seams, checkpoint)
                .map(|charts| assert_eq!(charts.expect("a chart").len(), 1))
        });
    }

    /// The same triangles with vertices of their own.
    fn soup(input: &TriMesh) -> TriMesh {
        let points: Vec<[f64; 3]> = input.triangles().flatten().map(|p| [p.x, p.y, p.z]).collect();
        let faces: Vec<[usize; 3]> = (0..input.face_count()).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        mesh(&points, &faces)
    }

    #[test]
    fn coordinates_far_above_the_tolerance_have_cells_of_their_own() {
        for tolerance in [0.0, 1e-300, 1e-30] {
            let cells: std::collections::HashSet<u64> = (1..=1000).map(|i| cell(f64::from(i), tolerance)).collect();
            assert_eq!(cells.len(), 1000, "{tolerance}");
        }
        assert_eq!(cell(0.0, 0.0), cell(-0.0, 0.0));
        assert_eq!(cell(1.0, 1.0), cell(2.0, 1.0));
        let soup = soup(&torus(20, 20));
        assert_eq!(weld(&soup, Weld::Within(0.0)), weld(&soup, Weld::Auto), "zeros of either sign are one place");
    }

    #[test]
    fn a_soup_becomes_what_it_was() {
        for input in [octahedron(), tetrahedron(), torus(7, 5), sheet(3, 4)] {
            let soup = soup(&input);
            let welded = weld(&soup, Weld::Auto).expect("something to join");
            let (was, is) = (repair(&input).expect("a mesh"), repair(&welded.mesh).expect("a mesh"));
            assert!(is.report.is_clean());
            assert_eq!(is.topology.euler_characteristic(), was.topology.euler_characteristic());
            assert_eq!(is.topology.boundary_edge_count(), was.topology.boundary_edge_count());
            assert_eq!(welded.joined.count, soup.vertex_count() - input.vertex_count());
            assert_eq!(weld(&soup, Weld::Off), None);
        }
    }

    #[test]
    fn a_seam_that_is_off_by_rounding_is_joined_and_one_that_is_off_by_more_is_not() {
        // A sphere without its caps, whose last column is the first a turn later: sin 2π is no zero.
        let (columns, rows) = (16, 6);
        let point = |i: usize| {
            let (turn, tilt) = ((i % (columns + 1)) as f64 / columns as f64, (i / (columns + 1)) as f64 - 2.5);
            let angle = turn * std::f64::consts::TAU;
            [angle.cos() * (0.4 * tilt).cos(), angle.sin() * (0.4 * tilt).cos(), 0.4 * tilt]
        };
        let points: Vec<[f64; 3]> = (0..(columns + 1) * rows).map(point).collect();
        let square = |i: usize| {
            let a = i / columns * (columns + 1) + i % columns;
            [[a, a + 1, a + columns + 2], [a, a + columns + 2, a + columns + 1]]
        };
        let mut faces: Vec<[usize; 3]> = (0..columns * (rows - 1)).flat_map(square).collect();
        // The strip is a disk as it stands, and stays one; with a triangle beside it there is no disk any more.
        assert_eq!(weld(&mesh(&points, &faces), Weld::Auto), None);
        let mut more = points.clone();
        more.extend([[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [5.0, 1.0, 0.0]]);
        faces.push([points.len(), points.len() + 1, points.len() + 2]);
        let welded = weld(&mesh(&more, &faces), Weld::Auto).expect("a seam");
        assert_eq!(welded.joined, Found { count: rows, first: Some(columns) });
        let mut off = more.clone();
        (0..rows).for_each(|row| off[row * (columns + 1)][1] += 1e-9);
        assert_eq!(weld(&mesh(&off, &faces), Weld::Auto), None);
        assert_eq!(weld(&mesh(&off, &faces), Weld::Within(1e-8)).map(|w| w.joined.count), Some(rows));
    }

    #[test]
    fn coordinates_of_32_bits_have_larger_units() {
        let pair = |gap: f64| {
            let points =
                [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, gap, 0.0], [0.0, -1.0, 0.0]];
            weld(&mesh(&points, &[[0, 1, 2], [4, 3, 5]]), Weld::Auto).map(|w| w.joined.count)
        };
        assert_eq!(pair(f64::from(f32::EPSILON)), Some(2));
        assert_eq!(pair(f64::from(f32::EPSILON) * 16.0), None);
        // No 32-bit number.
        assert_eq!(pair(1e-10), None);
    }

    #[test]
    fn vertices_that_only_touch_and_the_two_sides_of_a_card_are_left_alone() {
        // Two triangles with one corner in one place, and a card with a back of its own.
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let touching: Vec<[f64; 3]> = points.into_iter().chain(points.map(|p| p.map(|x| -x))).collect();
        assert_eq!(weld(&mesh(&touching, &[[0, 1, 2], [3, 4, 5]]), Weld::Auto), None);
        let card: Vec<[f64; 3]> = points.into_iter().chain(points).collect();
        assert_eq!(weld(&mesh(&card, &[[0, 1, 2], [5, 4, 3]]), Weld::Auto), None);
    }

    #[test]
    fn edges_of_different_objects_are_not_joined() {
        let points =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let two = mesh(&points, &[[0, 1, 2], [4, 3, 5]]);
        assert_eq!(weld_within(&two, Weld::Auto, Some(&[3, 3])).map(|w| w.joined.count), Some(2));
        assert_eq!(weld_within(&two, Weld::Auto, Some(&[3, 4])), None);
    }

    #[test]
    fn rules_are_read_as_they_are_written() {
        for rule in [Weld::Auto, Weld::Off, Weld::Within(0.25), Weld::Within(0.0)] {
            assert_eq!(rule.to_string().parse(), Ok(rule));
        }
        for bad in ["", "-1", "nan", "inf", "on"] {
            assert!(bad.parse::<Weld>().is_err(), "{bad}");
        }
    }
}
