//! Hard surfaces: planar and developable parts, unfolded and joined along their creases.
//!
//! 1. Faces in one plane are a facet.
//! 2. Facets that meet at small angles are a smooth region. If it unfolds in one piece, it is developable; otherwise it is
//!    curved in two directions, and left to a flattening.
//! 3. Developable regions are joined along creases, the longest shared crease first, as long as nothing meets in the plane.
//! 4. What is left over is joined by way of a facet of a neighbour, where that saves a chart for little more seam.
//!
//! Equal creases are taken in the order of their places, so the order of vertices and faces decides nothing.

mod facets;
mod net;

use crate::Seams;
use crate::seams::interior_edges;
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{CornerId, DisjointSets, FaceId, Point2, Topology, TriMesh};
use facets::{Facets, Fold, compare, folds, normals, quantised};
use net::Nets;
use net::rejoin::Creases;
use std::collections::HashMap;

/// A region that unfolds only with more than this part of its smooth edges cut, by length, is no developable one.
const MOST_CUT: f64 = 0.2;

/// A surface is a hard one when at least this part of its area is in planar facets of developable regions.
const HARD: f64 = 0.5;

/// After so many folds it is asked whether to go on: one may have many sides to try.
const FOLDS: usize = 64;

/// How a hard surface comes apart.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct HardSurface {
    /// The edges between nets, and around regions that are not developable.
    pub seams: Seams,
    /// How much of the area is in planar facets of several faces, in developable regions.
    pub share: f64,
    /// How many planar facets there are.
    pub facets: usize,
}

/// Takes a hard surface apart; `None` where less than half of it is planar or developable.
///
/// Edges where the surface turns by no more than `crease_angle`, rad, are smooth. Edges that are forbidden, by the corners
/// that face them, are joined before all others.
#[must_use]
pub fn hard_surface(
    mesh: &TriMesh,
    topology: &Topology,
    crease_angle: f64,
    is_forbidden: impl Fn(CornerId) -> bool,
) -> Option<HardSurface> {
    hard_surface_asking(mesh, topology, crease_angle, is_forbidden, &mut || Ok(())).ok().flatten()
}

/// [`hard_surface`] that asks between its blocks whether to go on.
///
/// # Errors
/// [`Cancelled`].
pub fn hard_surface_asking(
    mesh: &TriMesh,
    topology: &Topology,
    crease_angle: f64,
    is_forbidden: impl Fn(CornerId) -> bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<Option<HardSurface>, Cancelled> {
    let diagonal = mesh.diagonal();
    if !(diagonal > 0.0) {
        return Ok(None);
    }
    let normals = normals(mesh);
    checkpoint()?;
    let facets = Facets::grow(mesh, topology, diagonal, checkpoint)?;
    let planar = |f: FaceId| facets.sizes[facets.of_face[f.index()] as usize] > 1;
    let area = |f: FaceId| {
        let [a, b, c] = mesh.triangle(f);
        0.5 * (b - a).cross(&(c - a)).norm()
    };
    let total: f64 = topology.faces().map(area).sum();
    let share_of = |keep: &dyn Fn(FaceId) -> bool| topology.faces().filter(|&f| keep(f)).map(area).sum::<f64>() / total;
    if !(share_of(&planar) >= HARD) {
        return Ok(None);
    }
    checkpoint()?;
    let mut folds = folds(mesh, topology, &facets, &normals);
    for fold in folds.iter_mut().filter(|fold| is_forbidden(fold.corner)) {
        (fold.is_forbidden, fold.turn) = (true, 0.0);
    }
    let folds = in_order(mesh, topology, &facets, folds, crease_angle, diagonal);
    checkpoint()?;
    let mut nets = Nets::new(topology, &facets, diagonal);
    checkpoint()?;
    let smooth = folds.partition_point(|fold| fold.turn <= crease_angle);
    join(&mut nets, &folds[..smooth], |_| true, checkpoint)?;
    let region_of = regions(topology, &facets, &folds[..smooth]);
    let is_developable = developable(&folds[..smooth], &region_of, &nets);
    let developable = |f: FaceId| is_developable[region_of[f.index()]];
    let share = share_of(&|f| planar(f) && developable(f));
    if !(share >= HARD) {
        return Ok(None);
    }
    let is_between = |fold: &Fold| developable(fold.corner.face()) && developable(fold.opposite.face());
    join(&mut nets, &folds[smooth..], is_between, checkpoint)?;
    nets.rejoin(&Creases::new(&folds, smooth, &facets, &is_between), checkpoint)?;
    let mut seams = Seams::none(topology);
    for (c, o) in interior_edges(topology) {
        let (one, other) = (c.face(), o.face());
        let is_inside = match (developable(one), developable(other)) {
            (true, true) => nets.is_welded(c),
            (false, false) => region_of[one.index()] == region_of[other.index()],
            _ => false,
        };
        if !is_inside {
            seams.insert(topology, c);
        }
    }
    Ok(Some(HardSurface { seams, share, facets: facets.sizes.len() }))
}

/// Joins nets along some folds, in their order.
fn join(
    nets: &mut Nets<'_>,
    folds: &[Fold],
    is_wanted: impl Fn(&Fold) -> bool,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<(), Cancelled> {
    for (i, fold) in folds.iter().enumerate() {
        if i.is_multiple_of(FOLDS) {
            checkpoint()?;
        }
        if is_wanted(fold) {
            nets.join(fold);
        }
    }
    Ok(())
}

/// The planar parts of a surface.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PlanarFacets {
    /// The edges between them.
    pub seams: Seams,
    /// Every corner in the plane of its facet, in units of the mesh.
    pub layout: Vec<Point2<f64>>,
}

/// Faces in one plane, connected: a map of any surface in parts that are isometric, without solving for anything.
#[must_use]
pub fn planar_facets(mesh: &TriMesh, topology: &Topology) -> PlanarFacets {
    let facets = Facets::grow(mesh, topology, mesh.diagonal(), &mut || Ok(())).expect("nobody ends it");
    let facet = |c: CornerId| facets.of_face[c.face().index()];
    let seams = Seams::where_edges(topology, |c, o| facet(c) != facet(o));
    PlanarFacets { seams, layout: facets.layout }
}

/// Forbidden edges, smooth ones, then creases, each from the longest shared one to the shortest.
fn in_order(
    mesh: &TriMesh,
    topology: &Topology,
    facets: &Facets,
    mut folds: Vec<Fold>,
    crease_angle: f64,
    diagonal: f64,
) -> Vec<Fold> {
    let pair = |fold: &Fold| {
        let [a, b] = [fold.corner, fold.opposite].map(|c| facets.of_face[c.face().index()]);
        [a.min(b), a.max(b)]
    };
    let mut shared: HashMap<[u32; 2], f64> = HashMap::new();
    folds.iter().for_each(|fold| *shared.entry(pair(fold)).or_default() += fold.length);
    let middle = |fold: &Fold| {
        let [a, b] = crate::seams::ends(topology, fold.corner).map(|v| mesh.positions()[v.index()]);
        let sum = a.coords + b.coords;
        [sum.x, sum.y, sum.z]
    };
    let key = |fold: &Fold| {
        let of_whole = |length: f64| -quantised(length / diagonal);
        (!fold.is_forbidden, fold.turn > crease_angle, of_whole(shared[&pair(fold)]), of_whole(fold.length))
    };
    folds.sort_by_cached_key(|fold| {
        let [x, y, z] = middle(fold);
        (key(fold), OrderedPoint([x, y, z]), fold.corner)
    });
    folds
}

/// A point in the order of its coordinates.
#[derive(PartialEq)]
struct OrderedPoint([f64; 3]);

impl Eq for OrderedPoint {}

impl PartialOrd for OrderedPoint {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OrderedPoint {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        compare(&self.0, &other.0)
    }
}

/// The smooth region of every face, by its lowest face.
fn regions(topology: &Topology, facets: &Facets, smooth: &[Fold]) -> Vec<usize> {
    let mut joined = DisjointSets::new(topology.face_count());
    for (c, o) in interior_edges(topology) {
        if facets.of_face[c.face().index()] == facets.of_face[o.face().index()] {
            joined.unite(c.face().index(), o.face().index());
        }
    }
    smooth.iter().for_each(|fold| {
        joined.unite(fold.corner.face().index(), fold.opposite.face().index());
    });
    (0..topology.face_count()).map(|f| joined.find(f)).collect()
}

/// For every region, by its lowest face, whether it unfolds in one piece without many cuts.
fn developable(smooth: &[Fold], region_of: &[usize], nets: &Nets<'_>) -> Vec<bool> {
    let mut lengths = vec![(0.0, 0.0); region_of.len()];
    let mut is_one = vec![true; region_of.len()];
    for fold in smooth {
        let region = region_of[fold.corner.face().index()];
        let (cut, all) = &mut lengths[region];
        *all += fold.length;
        if !nets.is_welded(fold.corner) {
            *cut += fold.length;
            is_one[region] &= nets.net_of(fold.corner.face()) == nets.net_of(fold.opposite.face());
        }
    }
    lengths.iter().zip(is_one).map(|(&(cut, all), is_one)| is_one && cut <= MOST_CUT * all).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::split;
    use crate::test_support::{octahedron, sheet, topology, torus};
    use abf_mesh::Point3;

    fn hard(mesh: &TriMesh) -> Option<usize> {
        let topology = topology(mesh);
        let hard = hard_surface(mesh, &topology, std::f64::consts::FRAC_PI_6, |_| false)?;
        Some(split(mesh, &topology, &hard.seams).expect("charts").len())
    }

    /// A box of these sides, two triangles each.
    fn cuboid(x: f64, y: f64, z: f64) -> TriMesh {
        let points =
            (0..8).map(|i| Point3::new(f64::from(i & 1) * x, f64::from(i >> 1 & 1) * y, f64::from(i >> 2) * z));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces: Vec<_> = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh::new(points.collect(), &faces).expect("indices in range")
    }

    #[test]
    fn boxes_of_any_sides_are_one_net() {
        for [x, y, z] in [[1.0, 1.0, 1.0], [1.0, 2.0, 3.0], [10.0, 1.0, 0.1], [1.0, 1.0, 50.0]] {
            assert_eq!(hard(&cuboid(x, y, z)), Some(1), "{x} {y} {z}");
        }
    }

    #[test]
    fn a_flat_sheet_is_one_facet_and_round_surfaces_are_no_hard_ones() {
        assert_eq!(hard(&sheet(6, 5)), Some(1));
        assert_eq!(hard(&torus(48, 32)), None);
        assert_eq!(hard(&octahedron()), None, "faces without a neighbour in their plane");
    }

    /// An upright prism over a polygon, with both ends as the triangles given.
    fn prism(outline: &[[f64; 2]], ends: &[[usize; 3]], height: f64) -> TriMesh {
        let n = outline.len();
        let points = (0..2 * n).map(|i| Point3::new(outline[i % n][0], outline[i % n][1], height * (i / n) as f64));
        let mut faces: Vec<[usize; 3]> =
            ends.iter().flat_map(|&[a, b, c]| [[c, b, a], [a + n, b + n, c + n]]).collect();
        for i in 0..n {
            let j = (i + 1) % n;
            faces.extend([[i, j, j + n], [i, j + n, i + n]]);
        }
        TriMesh::new(points.collect(), &faces).expect("indices in range")
    }

    #[test]
    fn the_sides_of_a_notch_that_bar_each_other_the_way_are_joined_in_a_row() {
        // A U: the sides inside would touch if each hung on an end of the prism.
        let outline = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let ends = [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4], [0, 5, 6], [0, 6, 7]];
        let thin = prism(&outline, &ends, 0.2);
        assert_eq!(hard(&thin), Some(1));
        let topology = topology(&thin);
        let found = hard_surface(&thin, &topology, std::f64::consts::FRAC_PI_6, |_| false).expect("a hard surface");
        // Of 33.6 in all: twice the outline of 16, and eight uprights of 0.2.
        assert!(found.seams.length(&thin, &topology) < 22.0, "{}", found.seams.length(&thin, &topology));
    }

    #[test]
    fn facets_keep_every_length() {
        let mesh = cuboid(1.0, 2.0, 3.0);
        let topology = topology(&mesh);
        let facets = planar_facets(&mesh, &topology);
        assert_eq!(facets.seams.len(), 12);
        for c in topology.corners() {
            let at = |c: CornerId| mesh.positions()[topology.vertex(c).index()];
            let flat = (facets.layout[c.next().index()] - facets.layout[c.index()]).norm();
            assert!((flat - (at(c.next()) - at(c)).norm()).abs() < 1e-12);
        }
    }
}
