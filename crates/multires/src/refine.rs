//! The way back: removed vertices are put into a drawing, round by round.

use crate::coarsen::{BLOCK, PER_TASK};
use crate::hierarchy::Hierarchy;
use crate::kernel;
use crate::relax::Sweep;
use crate::star::{Spoke, angles_in_space, improved};
use crate::working::MOST_FACES;
use abf_control::{Cancelled, Checkpoint};
use abf_mesh::{Point2, Point3, Topology, TriMesh, Vector2, VertexId};
use abf_parallel::prelude::*;
use std::f64::consts::{PI, TAU};

/// A triangle with less than this part of the area that it should have is not good enough.
const LEAST_SHARE: f64 = 1e-3;

/// Angles at the vertex that are nearer to 0 or π, rad, do not say where it should be.
const LEAST_ANGLE: f64 = 0.01;

/// How often the way to a place that is not good enough is halved.
const MOST_HALVED: usize = 20;

/// Why a drawing could not be carried to the finer mesh.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// There is always a place for a vertex among its neighbours, but doubles do not hold one.
    #[error("no double is a place for vertex {vertex} between its neighbours ({triangles} triangles are drawn)")]
    EmptyKernel {
        /// The vertex.
        vertex: VertexId,
        /// How many triangles the drawing has without it and the other vertices of its round.
        triangles: usize,
    },
    /// The neighbours go around a vertex more than once.
    #[error("the drawing winds twice around vertex {vertex} ({triangles} triangles are drawn)")]
    Wound {
        /// The vertex.
        vertex: VertexId,
        /// How many triangles the drawing has without it and the other vertices of its round.
        triangles: usize,
    },
    /// The checkpoint ended it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What was done on the way to a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LevelReport {
    /// How many triangles it has.
    pub triangles: usize,
    /// How many vertices were put back on the way from the next coarser level; 0 for the coarsest.
    pub inserted: usize,
    /// How many of these had to be moved, because their triangles would have been turned over or tiny.
    pub moved: usize,
}

impl Hierarchy {
    /// Carries a drawing of the coarsest version to the mesh itself. In, out and in between no triangle is turned over.
    ///
    /// Vertices come back in rounds, those of one at once. Each is put where the triangles around it ask for, or into the
    /// kernel of its ring, and makes a step towards the least `Σ ((x − a) / a)²` of its own triangles. On every level
    /// `sweeps` sweeps follow, in which every vertex makes such a step. `target` has the target angles of the mesh, rad, one
    /// per corner; on the levels below they are those of the surface, scaled to 2π around a vertex. Same input, same bits.
    ///
    /// `uv` has a point for every vertex of the mesh, of which only those of the coarsest version count.
    ///
    /// # Errors
    /// [`RefineError`], where there is no place for a vertex or the checkpoint ends it.
    ///
    /// # Panics
    /// If mesh, topology, targets or points are not those of the mesh that was coarsened.
    pub fn refine(
        &self,
        (mesh, topology): (&TriMesh, &Topology),
        target: &[f64],
        uv: &mut [Point2<f64>],
        sweeps: usize,
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<Vec<LevelReport>, RefineError> {
        assert!(target.len() == topology.corner_count(), "a target for every corner");
        let coarsest = self.levels.last().expect("never empty");
        let mut reports = vec![LevelReport { triangles: coarsest.faces.len(), ..LevelReport::default() }];
        for level in (0..self.levels.len()).rev() {
            let report = self.refine_level(level, mesh, uv, checkpoint)?;
            if report.inserted > 0 {
                match level.checked_sub(1).map(|level| &self.levels[level]) {
                    None => relax(mesh.faces(), target, sweeps, uv, checkpoint)?,
                    Some(above) => {
                        let target = targets(mesh, topology, &above.faces);
                        relax(&above.faces, &target, sweeps, uv, checkpoint)?;
                    }
                }
                reports.push(report);
            }
        }
        Ok(reports)
    }

    /// Carries a drawing of a level, counted from 0, to the next finer one, or from the finest to the mesh itself, without
    /// any sweeps.
    ///
    /// # Errors
    /// [`RefineError`], where there is no place for a vertex or the checkpoint ends it.
    ///
    /// # Panics
    /// If mesh or points are not those of the mesh that was coarsened, or there is no such level.
    pub fn refine_level(
        &self,
        level: usize,
        mesh: &TriMesh,
        uv: &mut [Point2<f64>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<LevelReport, RefineError> {
        assert!(mesh.vertex_count() == self.vertices && uv.len() == self.vertices, "a point for every vertex");
        let below = &self.levels[level];
        let above = level.checked_sub(1).map(|level| &self.levels[level]);
        let mut report = LevelReport::default();
        let mut triangles = below.faces.len();
        for round in (above.map_or(0, |above| above.rounds)..below.rounds).rev() {
            report.moved += self.put_back(round, triangles, mesh, uv, checkpoint)?;
            report.inserted += self.round(round).len();
            triangles += self.removals[self.round(round)].iter().map(|r| 1 + usize::from(r.is_closed)).sum::<usize>();
        }
        report.triangles = above.map_or(mesh.face_count(), |above| above.faces.len());
        Ok(report)
    }

    /// Puts the vertices of a round back, and says how many had to be moved.
    fn put_back(
        &self,
        round: usize,
        triangles: usize,
        mesh: &TriMesh,
        uv: &mut [Point2<f64>],
        checkpoint: &mut Checkpoint<'_>,
    ) -> Result<usize, RefineError> {
        let mut moved = 0;
        let removals = self.round(round);
        for start in removals.clone().step_by(BLOCK) {
            checkpoint()?;
            let at: &[Point2<f64>] = uv;
            let block = start..removals.end.min(start + BLOCK);
            let place = |removal: usize| Insertion::new(self, removal, mesh, at).place();
            let places: Vec<Result<(Point2<f64>, bool), Fault>> =
                block.clone().into_par_iter().with_min_len(PER_TASK).map(place).collect();
            for (removal, place) in block.zip(places) {
                let vertex = self.removals[removal].vertex;
                let (point, was_moved) = place.map_err(|fault| match fault {
                    Fault::Empty => RefineError::EmptyKernel { vertex, triangles },
                    Fault::Wound => RefineError::Wound { vertex, triangles },
                })?;
                uv[vertex.index()] = point;
                moved += usize::from(was_moved);
            }
        }
        Ok(moved)
    }
}

fn relax(
    faces: &[[VertexId; 3]],
    target: &[f64],
    sweeps: usize,
    uv: &mut [Point2<f64>],
    checkpoint: &mut Checkpoint<'_>,
) -> Result<(), Cancelled> {
    if sweeps > 0 {
        let sweep = Sweep::new(faces, target, uv.len());
        for _ in 0..sweeps {
            sweep.run(uv, checkpoint)?;
        }
    }
    Ok(())
}

/// The target angles of a level: those of the surface, scaled to 2π around the vertices of the interior.
fn targets(mesh: &TriMesh, topology: &Topology, faces: &[[VertexId; 3]]) -> Vec<f64> {
    let of_face = |face: &[VertexId; 3]| angles_in_space(face.map(|v| mesh.positions()[v.index()])).0;
    let angles: Vec<[f64; 3]> = faces.par_iter().with_min_len(PER_TASK).map(of_face).collect();
    let mut angles = angles.into_flattened();
    let mut sums = vec![0.0; mesh.vertex_count()];
    for (v, angle) in faces.iter().flatten().zip(&angles) {
        sums[v.index()] += angle;
    }
    for (v, angle) in faces.iter().flatten().zip(&mut angles) {
        if topology.is_interior(*v) {
            *angle *= TAU / sums[v.index()];
        }
    }
    angles
}

/// The complex number that turns and scales the outer edge of a triangle of the surface into the edge from its first end to
/// the vertex, times the sine of the angle at the vertex: `sin c · e^{ib}`, `b` and `c` the angles at the ends. Zero where two
/// corners are in one place.
fn wish([vertex, first, second]: [Point3<f64>; 3], double_area: f64) -> Vector2<f64> {
    let (inwards, edge, back) = (vertex - first, second - first, vertex - second);
    let lengths = (inwards.norm_squared() * back.norm_squared()).sqrt() * edge.norm_squared();
    if lengths > 0.0 {
        Vector2::new(inwards.dot(&edge), double_area) * (double_area / lengths)
    } else {
        Vector2::zeros()
    }
}

/// Why a vertex has no place.
enum Fault {
    Empty,
    Wound,
}

/// A vertex that comes back.
struct Insertion {
    spokes: [Spoke; MOST_FACES],
    /// What turns and scales the outer edges into those from their first ends to where the triangles ask the vertex to be;
    /// complex numbers.
    wishes: [Vector2<f64>; MOST_FACES],
    /// The parts that the triangles have of the area around the vertex, on the surface.
    shares: [f64; MOST_FACES],
    count: usize,
    is_closed: bool,
}

impl Insertion {
    fn new(hierarchy: &Hierarchy, removal: usize, mesh: &TriMesh, uv: &[Point2<f64>]) -> Self {
        let (ring, removed) = (hierarchy.ring(removal), hierarchy.removals[removal]);
        let count = if removed.is_closed { ring.len() } else { ring.len() - 1 };
        let nothing = Spoke { ends: [Point2::origin(); 2], target: [0.0; 3] };
        let (mut spokes, mut shares) = ([nothing; MOST_FACES], [0.0; MOST_FACES]);
        let mut wishes = [Vector2::zeros(); MOST_FACES];
        let (mut sum, mut area) = (0.0, 0.0);
        for i in 0..count {
            let ends = [ring[i], ring[(i + 1) % ring.len()]];
            let corners = [removed.vertex, ends[0], ends[1]].map(|v| mesh.positions()[v.index()]);
            let (target, double_area) = angles_in_space(corners);
            spokes[i] = Spoke { ends: ends.map(|v| uv[v.index()]), target };
            wishes[i] = wish(corners, double_area);
            shares[i] = double_area;
            sum += target[0];
            area += double_area;
        }
        shares[..count].iter_mut().for_each(|share| *share /= area);
        if removed.is_closed {
            spokes[..count].iter_mut().for_each(|spoke| spoke.target[0] *= TAU / sum);
        }
        for (spoke, wish) in spokes[..count].iter().zip(&mut wishes) {
            *wish /= spoke.target[0].clamp(LEAST_ANGLE, PI - LEAST_ANGLE).sin();
        }
        Self { spokes, wishes, shares, count, is_closed: removed.is_closed }
    }

    fn spokes(&self) -> &[Spoke] {
        &self.spokes[..self.count]
    }

    /// Where the vertex goes, and whether it had to be moved there.
    fn place(&self) -> Result<(Point2<f64>, bool), Fault> {
        let wanted = self.wanted();
        let is_good = self.is_good(wanted);
        let start = if is_good { wanted } else { self.towards(wanted)? };
        let place = improved(start, &self.spokes().iter().copied());
        if self.is_closed && self.turns(place) != 1 { Err(Fault::Wound) } else { Ok((place, !is_good)) }
    }

    /// Where the triangles ask the vertex to be, the longer their outer edge, the less they count.
    fn wanted(&self) -> Point2<f64> {
        let (mut sum, mut weights) = (Point2::origin(), 0.0);
        for (spoke, wish) in self.spokes().iter().zip(&self.wishes) {
            let [first, second] = spoke.ends;
            let edge = second - first;
            let weight = 1.0 / edge.norm_squared();
            let turned = Vector2::new(wish.x * edge.x - wish.y * edge.y, wish.y * edge.x + wish.x * edge.y);
            sum += (first.coords + turned) * weight;
            weights += weight;
        }
        sum / weights
    }

    /// Whether every triangle is counter-clockwise, and not tiny beside the others.
    fn is_good(&self, place: Point2<f64>) -> bool {
        let double_area = |spoke: &Spoke| (spoke.ends[0] - place).perp(&(spoke.ends[1] - place));
        let total: f64 = self.spokes().iter().map(double_area).sum();
        let is_large = |(spoke, share): (&Spoke, &f64)| double_area(spoke) > LEAST_SHARE * share * total;
        total > 0.0
            && self.spokes().iter().zip(&self.shares).all(is_large)
            && self.spokes().iter().all(|spoke| spoke.is_positive(place))
    }

    /// The furthest good place from inside of the kernel on the way to a place that is not good.
    fn towards(&self, wanted: Point2<f64>) -> Result<Point2<f64>, Fault> {
        let mut edges = [[Point2::origin(); 2]; MOST_FACES];
        edges.iter_mut().zip(self.spokes()).for_each(|(edge, spoke)| *edge = spoke.ends);
        let inside = kernel::inside(&edges[..self.count], self.is_closed).ok_or(Fault::Empty)?;
        let way = wanted - inside;
        let mut share = 0.5;
        for _ in 0..MOST_HALVED {
            let place = inside + way * share;
            if self.is_good(place) {
                return Ok(place);
            }
            share *= 0.5;
        }
        Ok(inside)
    }

    /// How often the ring goes around a place that has it on its left all the way: how often it comes up past the height
    /// of the place.
    fn turns(&self, place: Point2<f64>) -> usize {
        let comes_up = |spoke: &&Spoke| spoke.ends[0].y < place.y && spoke.ends[1].y >= place.y;
        self.spokes().iter().filter(comes_up).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_with_corners_in_one_place_ask_for_a_finite_place() {
        let [a, b, c] = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 2.0, 0.0)];
        for corners in [[a, a, b], [a, b, a], [a, b, b], [a, a, a]] {
            assert_eq!(wish(corners, 0.0), Vector2::zeros());
        }
        // The vertex is where a right angle at the first end and the sides 1 and 2 have it.
        let asked = wish([c, a, b], 2.0) / angles_in_space([c, a, b]).0[0].sin();
        assert!((asked - Vector2::new(0.0, 2.0)).norm() < 1e-12, "{asked}");
    }
}
