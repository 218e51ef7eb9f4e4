//! A map that is there, relaxed chart by chart.

use super::relax::{pinned, relaxed};
use super::task::{Given, Single, Task, begin};
use crate::settings::{Injective, Pipeline, SolverKind, ZeroArea};
use crate::{Elsewhere, FlattenError, Flattening, LayoutReport, PinReport, RelaxReport, RelaxedMap};
use abf_constraints::AngleProblem;
use abf_control::{Event, Observer, Stage, StopCriteria, Termination, TimeBudget, ask};
use abf_embed::vertex_points;
use abf_mesh::{CornerId, DisjointSets, FaceId, Point2, Topology, TriMesh, UvId, UvMap, Vector2, VertexId};
use abf_metrics::{MetricsError, certify_asking, certify_connected_asking};
use std::collections::HashMap;

impl Pipeline {
    /// Relaxes a map that anybody made, each chart by itself, with [`Pipeline::relax`] or its default settings, and brings
    /// it to [`Pipeline::pins`] then. The settings of solver, layout and initial guess mean nothing to it.
    ///
    /// A chart that is not valid starts from Tutte's embedding, if it is a disk. The area of the whole map stays, as charts
    /// get the shares that they have of the surface; each keeps its centre, and is turned as little as can be. They may
    /// come to lie over each other. Pins, which are for one chart without seams, say where it is instead.
    ///
    /// A chart that cannot be relaxed, as it is no manifold for example, stays as it was. [`RelaxedMap::refused`] says why.
    ///
    /// # Errors
    /// [`FlattenError`] for settings out of range, coordinates that are not finite, and where no chart at all can be relaxed.
    pub fn relax_map(
        &self,
        mesh: &TriMesh,
        uv: &UvMap,
        observer: &mut dyn Observer,
    ) -> Result<RelaxedMap, FlattenError> {
        let asked = Self { relax: Some(self.relax.unwrap_or_default()), ..self.clone() };
        asked.check()?;
        if self.injective != Injective::Off {
            return Err(FlattenError::InjectiveElsewhere(self.injective, Elsewhere::Map));
        }
        asked.check_memory(mesh)?;
        let budget = TimeBudget::start(&self.stop);
        begin(observer, Stage::Topology)?;
        check(mesh, uv)?;
        if self.zero_area == ZeroArea::Refuse {
            mesh.check_geometry()?;
        }
        let cut = Cut::new(mesh, uv);
        if asked.pins.is_some() && !cut.is_whole {
            return Err(FlattenError::PinsElsewhere(Elsewhere::Seams));
        }
        // Charts keep to the scale of the whole map.
        let (area, surface) = (uv.area(), mesh.area());
        let ratio = if area > 0.0 && area.is_finite() && surface > 0.0 { area / surface } else { 1.0 };
        let inner = Self { normalize: false, ..asked };
        let mut points = cut.places.clone();
        let (mut charts, mut refused, mut pins, mut termination) =
            (Vec::new(), Vec::new(), None, Termination::Converged);
        let mut is_over = false;
        for chart in cut.charts(mesh) {
            // Stopped, or out of time: what is left stays as it is.
            if is_over {
                charts.push(None);
                continue;
            }
            let job = Job { pipeline: &inner, mesh: &chart.mesh, ratio };
            let start: Vec<Point2<f64>> =
                chart.locals.iter().map(|local| local.map_or(Point2::origin(), |l| points[l])).collect();
            let done = match job.run(start, &budget.left(), observer) {
                Ok(done) => done,
                Err(error) => {
                    refused.push(chart.refusal(error)?);
                    charts.push(None);
                    if termination.is_as_asked() {
                        termination = Termination::Stalled;
                    }
                    continue;
                }
            };
            is_over = done.termination.is_interruption();
            if termination.is_as_asked() {
                termination = done.termination;
            }
            for (local, point) in chart.locals.iter().zip(done.points) {
                local.iter().for_each(|&l| points[l] = point);
            }
            charts.push(done.report);
            pins = pins.or(done.pinned);
        }
        if refused.len() == charts.len() {
            return Err(refused.swap_remove(0));
        }
        let uv = UvMap::new(points, cut.corners);
        let uv = if self.normalize { uv.normalized() } else { uv };
        let uv = uv.mapped(|p| p.map(|x| self.precision.round(x)));
        let certificate = certify_asking(mesh, &uv, self.precision, &mut || ask(observer, Event::Working))?;
        Ok(RelaxedMap { uv, certificate, termination, chart_of_face: cut.chart_of_face, charts, refused, pinned: pins })
    }
}

fn check(mesh: &TriMesh, uv: &UvMap) -> Result<(), FlattenError> {
    mesh.check_finite()?;
    let (corners, faces) = (uv.corners().len(), mesh.face_count());
    if corners != 3 * faces {
        return Err(MetricsError::CornerCount { corners, faces }.into());
    }
    let is_bad = |f: &usize| uv.triangle(FaceId::new(*f)).iter().any(|p| !p.iter().all(|x| x.is_finite()));
    if let Some(first) = (0..faces).find(is_bad) {
        return Err(
            MetricsError::UvNotFinite { first: FaceId::new(first), count: (0..faces).filter(is_bad).count() }.into()
        );
    }
    if faces == 0 {
        // It says so.
        Topology::build(mesh.vertex_count(), mesh.faces())?;
    }
    Ok(())
}

/// A mesh cut where its map is: a vertex is another one for each of its places.
struct Cut {
    /// The cut vertex of every corner.
    corners: Vec<UvId>,
    /// Of every cut vertex the vertex, and its place.
    vertices: Vec<VertexId>,
    places: Vec<Point2<f64>>,
    /// The chart of every face, numbered by first appearance.
    chart_of_face: Vec<usize>,
    count: usize,
    /// Whether there is one chart, without seams.
    is_whole: bool,
}

/// A chart as a mesh of its own.
struct Chart {
    mesh: TriMesh,
    /// The cut vertex of every vertex; none where no face uses it.
    locals: Vec<Option<usize>>,
    /// Its first face, where the mesh is not that of the whole.
    first: Option<FaceId>,
}

impl Chart {
    /// Why it stays as it was; an error where that ends the others, too.
    fn refusal(&self, error: FlattenError) -> Result<FlattenError, FlattenError> {
        let is_of_all =
            matches!(error, FlattenError::Cancelled(_) | FlattenError::Memory { .. }) || error.is_of_settings();
        match self.first {
            Some(face) if !is_of_all => Ok(FlattenError::RelaxChart { face, source: Box::new(error) }),
            _ => Err(error),
        }
    }
}

impl Cut {
    fn new(mesh: &TriMesh, uv: &UvMap) -> Self {
        let (mut vertices, mut places) = (Vec::new(), Vec::new());
        let mut known = HashMap::new();
        let local = |(c, &vertex): (usize, &VertexId)| {
            let place = uv.corner(CornerId::new(c));
            // One zero has two signs.
            let key = (vertex, (place.x + 0.0).to_bits(), (place.y + 0.0).to_bits());
            UvId::new(*known.entry(key).or_insert_with(|| {
                vertices.push(vertex);
                places.push(place);
                places.len() - 1
            }))
        };
        let corners: Vec<UvId> = mesh.faces().as_flattened().iter().enumerate().map(local).collect();
        let mut sets = DisjointSets::new(places.len());
        for [a, b, c] in corners.as_chunks::<3>().0 {
            sets.unite(a.index(), b.index());
            sets.unite(b.index(), c.index());
        }
        let mut number = HashMap::new();
        let chart = |face: &[UvId; 3]| {
            let next = number.len();
            *number.entry(sets.find(face[0].index())).or_insert(next)
        };
        let chart_of_face: Vec<usize> = corners.as_chunks::<3>().0.iter().map(chart).collect();
        let count = number.len();
        let mut is_used = vec![false; mesh.vertex_count()];
        vertices.iter().for_each(|v| is_used[v.index()] = true);
        let is_whole = count == 1 && vertices.len() == is_used.iter().filter(|&&used| used).count();
        Self { corners, vertices, places, chart_of_face, count, is_whole }
    }

    /// The charts, in their order. One without seams is the mesh itself, so that its vertices keep their numbers.
    fn charts(&self, mesh: &TriMesh) -> Vec<Chart> {
        if self.is_whole {
            let mut locals = vec![None; mesh.vertex_count()];
            self.vertices.iter().enumerate().for_each(|(local, v)| locals[v.index()] = Some(local));
            return vec![Chart { mesh: mesh.clone(), locals, first: None }];
        }
        let mut faces = vec![Vec::new(); self.count];
        self.chart_of_face.iter().enumerate().for_each(|(f, &chart)| faces[chart].push(f));
        let mut number = vec![usize::MAX; self.places.len()];
        let mut chart = |faces: &Vec<usize>| {
            let mut locals = Vec::new();
            let mut triangle = |&f: &usize| {
                [0, 1, 2].map(|k| {
                    let local = self.corners[3 * f + k].index();
                    if number[local] == usize::MAX {
                        number[local] = locals.len();
                        locals.push(Some(local));
                    }
                    number[local]
                })
            };
            let triangles: Vec<[usize; 3]> = faces.iter().map(&mut triangle).collect();
            let at = |local: &usize| mesh.positions()[self.vertices[*local].index()];
            let positions = locals.iter().flatten().map(at).collect();
            let mesh = TriMesh::new(positions, &triangles).expect("indices of its own vertices");
            Chart { mesh, locals, first: Some(FaceId::new(faces[0])) }
        };
        faces.iter().map(&mut chart).collect()
    }
}

/// One chart to be relaxed.
struct Job<'j> {
    pipeline: &'j Pipeline,
    mesh: &'j TriMesh,
    /// The area of the whole map over that of the surface.
    ratio: f64,
}

/// What became of a chart.
struct Done {
    /// One per vertex.
    points: Vec<Point2<f64>>,
    report: Option<RelaxReport>,
    pinned: Option<PinReport>,
    termination: Termination,
}

impl Job<'_> {
    fn run(
        &self,
        start: Vec<Point2<f64>>,
        stop: &StopCriteria,
        observer: &mut dyn Observer,
    ) -> Result<Done, FlattenError> {
        let in_range = self.mesh.in_range();
        let (working, scale) = in_range.as_ref().map_or((self.mesh, 1.0), |(scaled, scale)| (scaled, *scale));
        let topology = Topology::build(self.mesh.vertex_count(), self.mesh.faces())?;
        self.pipeline.pins.as_ref().map_or(Ok(()), |pins| pins.check(&topology)).map_err(FlattenError::Pins)?;
        let problem = AngleProblem::unclosed(&topology, working.corner_angles(), self.pipeline.initial_guess)?;
        let given = Given { pipeline: self.pipeline, original: self.mesh, mesh: working, scale, problem: &problem };
        // A map that is mirrored as a whole is worked on from behind.
        let side = if UvMap::per_vertex(self.mesh, &start).signed_area() < 0.0 { -1.0 } else { 1.0 };
        let upright: Vec<Point2<f64>> = start.iter().map(|p| Point2::new(side * p.x, p.y)).collect();
        let flat = as_flattening(given, &upright, observer)?;
        let was_valid = flat.certificate.valid();
        let relax = self.pipeline.relax.as_ref().expect("it is always asked for");
        let flat = relaxed(given, relax, flat, stop, observer)?;
        let flat = match &self.pipeline.pins {
            Some(pins) => pinned(given, pins, flat, stop, observer)?,
            None => flat,
        };
        let has_moved = flat.relaxed.is_some() || flat.pinned.is_some();
        let termination = match flat.termination {
            // That of a map nobody has moved.
            Termination::OnePass => Termination::Stalled,
            ended => ended,
        };
        let stays = |points| Done { points, report: None, pinned: None, termination };
        if !has_moved {
            return Ok(stays(start));
        }
        let points = vertex_points(&topology, &flat.uv).expect("one point per vertex");
        if flat.pinned.is_some() {
            return Ok(Done { points, report: flat.relaxed, pinned: flat.pinned, termination });
        }
        let area = flat.uv.area();
        let scale = if area > 0.0 { (self.ratio * self.mesh.area() / area).sqrt() } else { 1.0 };
        let points: Vec<Point2<f64>> =
            back(&topology, &points, &upright, scale).into_iter().map(|p| Point2::new(side * p.x, p.y)).collect();
        let precision = self.pipeline.precision;
        let uv = UvMap::per_vertex(self.mesh, &points).mapped(|p| p.map(|x| precision.round(x)));
        let checkpoint = &mut || ask(observer, Event::Working);
        let is_valid = certify_connected_asking(self.mesh, &topology, &uv, precision, checkpoint)?.valid();
        // The digits there may not hold the relaxed map.
        if was_valid && !is_valid {
            return Ok(Done { termination: Termination::Stalled, ..stays(start) });
        }
        Ok(Done { points, report: flat.relaxed, pinned: None, termination })
    }
}

/// A map of one point per vertex as if a solver had made it.
fn as_flattening(
    given: Given<'_>,
    points: &[Point2<f64>],
    observer: &mut dyn Observer,
) -> Result<Flattening, FlattenError> {
    let task = Task::new(given, SolverKind::Lscm, Single::SurfaceAngles);
    let scaled: Vec<Point2<f64>> = points.iter().map(|p| p * given.scale).collect();
    let certified = task.certified(UvMap::per_vertex(given.mesh, &scaled), observer)?;
    let layout = LayoutReport::placed(false, false);
    Ok(task.flattening(certified, None, layout, &[]))
}

/// Points scaled, moved and turned so that they are nearest to where they were.
fn back(topology: &Topology, points: &[Point2<f64>], before: &[Point2<f64>], scale: f64) -> Vec<Point2<f64>> {
    let used: Vec<usize> =
        topology.vertices().filter(|&v| topology.fan_start(v).is_some()).map(VertexId::index).collect();
    let share = 1.0 / used.len() as f64;
    let centre = |all: &[Point2<f64>]| used.iter().fold(Vector2::zeros(), |sum, &v| sum + all[v].coords * share);
    let (from, to) = (centre(points), centre(before));
    let (mut cosine, mut sine) = (0.0, 0.0);
    for &v in &used {
        let (a, b) = (points[v].coords - from, before[v].coords - to);
        cosine += a.dot(&b);
        sine += a.perp(&b);
    }
    let length = cosine.hypot(sine);
    let (cosine, sine) = if length > 0.0 && length.is_finite() { (cosine / length, sine / length) } else { (1.0, 0.0) };
    let turned = |p: Vector2<f64>| Vector2::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y);
    points.iter().map(|p| Point2::from(to + turned(p.coords - from) * scale)).collect()
}
