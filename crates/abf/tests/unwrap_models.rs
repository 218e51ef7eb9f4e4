//! Whole models: closed, with handles and holes, broken. `docs/seams.md` cites what is printed here.
//!
//! `ABF_MODELS` as in `support`; the tests look into `raw/` and `paper/`.

#![allow(clippy::print_stdout, reason = "the numbers are the point")]

mod support;

use abf::cut::{HoleFilling, outer_loop};
use abf::mesh::{CornerId, Topology, TriMesh, UvMap, VertexId, io};
use abf::metrics::{measure, per_face};
use abf::{
    Atlas, HoleRule, Precision, Silent, Stored, SurfaceHints, Unwrap, UnwrapError, Unwrapped, UnwrappedChart, Weld,
};
use std::cmp::Reverse;
use std::collections::VecDeque;
use std::time::Instant;
use support::{models, read};

fn unwrap(settings: &Unwrap, mesh: &TriMesh) -> Unwrapped {
    settings.run(mesh, &SurfaceHints::default(), &mut Silent).expect("charts")
}

/// Every file of `raw/`, and whether a strict run refuses it.
const RAW: [(&str, bool); 18] = [
    ("3holes", false),
    ("bff-inverted_triangles", true),
    ("bunny-stanford", false),
    ("cgal-elephant-with-holes", false),
    ("cow", true),
    ("double-torus", false),
    ("fandisk", false),
    ("foot", false),
    ("gargoyle", false),
    ("gc-bob_small", false),
    ("gc-moebius", true),
    ("horse", false),
    ("oc-multiComp", false),
    ("oc-nonman-toy", true),
    ("oc-zeroarea48", true),
    ("spot", false),
    ("suzanne", true),
    ("teapot-utah", true),
];

#[test]
fn every_raw_model_comes_out_in_certified_charts() {
    let Some(folder) = models(RAW.len()) else { return };
    println!("model | faces | charts | seam / diagonal | F | L2 | overlaps | holes filled | seconds | repairs");
    let mut misses = Vec::new();
    for (name, is_refused) in RAW {
        let mesh = read(&folder, &format!("raw/{name}.obj"));
        let start = Instant::now();
        let unwrapped = unwrap(&Unwrap::default(), &mesh);
        let seconds = start.elapsed().as_secs_f64();
        let metrics = measure(&mesh, &unwrapped.uv()).expect("metrics");
        let sum = |of: &dyn Fn(&UnwrappedChart) -> usize| unwrapped.charts.iter().map(of).sum::<usize>();
        // Parts of one chart have its holes in common.
        let mut components: Vec<_> = unwrapped.charts.iter().map(|c| (c.component, c.holes_filled)).collect();
        components.dedup_by_key(|c| c.0);
        println!(
            "{name} | {} | {} | {:.2} | {:.3e} | {:.3} | {} | {} | {seconds:.1} | {}",
            mesh.face_count(),
            unwrapped.charts.len(),
            unwrapped.seam_length / unwrapped.diagonal,
            metrics.f,
            metrics.stretch_l2,
            sum(&|c| c.metrics.certificate.overlaps()),
            components.iter().map(|c| c.1).sum::<usize>(),
            unwrapped.repairs.sentences().join("; ")
        );
        // The atlas as two kinds of files store it.
        let formats = [Stored::default(), Stored::converted(io::stored_uv, Precision::Single)];
        for stored in formats {
            let packed = Atlas::default().pack(&mesh, &unwrapped, None, stored).expect("an atlas");
            if !packed.metrics.injective() {
                misses.push(format!("{name}: the atlas of {} is not one to one", stored.precision()));
            }
        }
        if !unwrapped.is_certified() {
            misses.push(format!("{name}: a chart without certificate"));
        }
        let faces = sum(&|c| c.faces.len());
        if faces + unwrapped.followers.len() / 3 != mesh.face_count() {
            misses.push(format!("{name}: {faces} faces in charts"));
        }
        if is_refused {
            let strict = Unwrap { strict: true, ..Unwrap::default() };
            match strict.run(&mesh, &SurfaceHints::default(), &mut Silent) {
                Err(error @ UnwrapError::NotClean { .. }) => println!("  strict: {error}"),
                other => misses.push(format!("{name}: strict run came to {:?}", other.map(|u| u.charts.len()))),
            }
        } else if !(unwrapped.repairs.is_clean() && unwrapped.repairs.zero_area_faces.count == 0) {
            misses.push(format!("{name}: repaired, and not refused by a strict run"));
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

/// Closed models, with F/3nt and, where it is printed, the L2 stretch of LinABF on the cuts of the paper (Seamster).
const PUBLISHED: [(&str, f64, Option<f64>); 3] =
    [("foot", 1.921e-4, None), ("gargoyle", 1.604e-3, None), ("horse", 2.906e-4, Some(1.11))];

#[test]
fn our_cuts_of_closed_models_stand_beside_the_papers() {
    let Some(folder) = models(3 * PUBLISHED.len()) else { return };
    println!(
        "model | max_stretch | charts | rounds | seam / diagonal | F | of the paper's | L2 | paper's L2 | seconds"
    );
    for (name, paper, paper_stretch) in PUBLISHED {
        let mesh = read(&folder, &format!("raw/{name}.obj"));
        for max_stretch in [1.2, 1.15, 1.05] {
            let start = Instant::now();
            let unwrapped = unwrap(&Unwrap { max_stretch, ..Unwrap::default() }, &mesh);
            let seconds = start.elapsed().as_secs_f64();
            let metrics = measure(&mesh, &unwrapped.uv()).expect("metrics");
            println!(
                "{name} | {max_stretch} | {} | {} | {:.2} | {:.3e} | {:.2} | {:.3} | {} | {seconds:.1}",
                unwrapped.charts.len(),
                unwrapped.charts[0].rounds,
                unwrapped.seam_length / unwrapped.diagonal,
                metrics.f,
                metrics.f / paper,
                metrics.stretch_l2,
                paper_stretch.map_or("-".to_owned(), |l2| l2.to_string())
            );
            assert!(unwrapped.is_certified(), "{name}");
            assert!(metrics.stretch_l2 <= max_stretch, "{name}: L2 {}", metrics.stretch_l2);
            // Where the aim is missed by little, one more cut brings F far below: only a tight aim tells.
            if max_stretch == 1.05 {
                assert!(metrics.f <= paper, "{name}: F {} above the paper's {paper}", metrics.f);
            }
        }
    }
}

/// Cuts a hole of `rings` rings of faces around each of `count` vertices far from the boundary and from each other.
fn with_holes(mesh: &TriMesh, count: usize, rings: usize) -> TriMesh {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    // Distance in edges from the boundary and the holes so far.
    let spread = |sources: Vec<VertexId>| {
        let mut distance = vec![usize::MAX; mesh.vertex_count()];
        sources.iter().for_each(|v| distance[v.index()] = 0);
        let mut queue: VecDeque<VertexId> = sources.into();
        while let Some(v) = queue.pop_front() {
            for c in topology.fan(v) {
                for w in [c.next(), c.prev()].map(|e| topology.vertex(e)) {
                    if distance[w.index()] == usize::MAX {
                        distance[w.index()] = distance[v.index()] + 1;
                        queue.push_back(w);
                    }
                }
            }
        }
        distance
    };
    let mut sources: Vec<VertexId> = topology.vertices().filter(|&v| topology.is_boundary(v)).collect();
    let mut middles = Vec::new();
    for _ in 0..count {
        let distance = spread(sources.clone());
        let far = topology.vertices().max_by_key(|v| (distance[v.index()], Reverse(*v))).expect("vertices");
        sources.push(far);
        middles.push(far);
    }
    let distance = spread(middles);
    let kept = mesh.faces().iter().filter(|face| face.iter().any(|v| distance[v.index()] >= rings));
    let faces: Vec<_> = kept.map(|face| face.map(VertexId::index)).collect();
    TriMesh::new(mesh.positions().to_vec(), &faces).expect("indices in range")
}

/// How far the rims of all holes are from their shape: root mean squares of `ln(length in UV / length)` over their edges,
/// less its mean over the rim, and of the difference between the angle of the surface at their vertices and in UV, rad.
fn rims(mesh: &TriMesh, uv: &UvMap) -> (f64, f64) {
    let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
    let mut loops = topology.boundary_loops();
    let outer = outer_loop(mesh, &loops).expect("a boundary");
    loops.remove(outer);
    let faces = per_face(mesh, uv).expect("metrics");
    let (mut lengths, mut angles, mut count) = (0.0, 0.0, 0.0);
    for rim in &loops {
        let ratio = |v: &VertexId| {
            let first = topology.fan_start(*v).expect("a fan");
            let at = |c: CornerId| mesh.positions()[topology.vertex(c).index()];
            ((uv.corner(first.next()) - uv.corner(first)).norm() / (at(first.next()) - at(first)).norm()).ln()
        };
        let ratios: Vec<f64> = rim.vertices.iter().map(ratio).collect();
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        lengths += ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>();
        let turned = |v: &VertexId| topology.fan(*v).map(|c| faces[c.face().index()].angle_errors()[c.place()]).sum();
        angles += rim.vertices.iter().map(turned).map(|t: f64| t * t).sum::<f64>();
        count += rim.vertices.len() as f64;
    }
    ((lengths / count).sqrt(), (angles / count).sqrt())
}

#[test]
fn holes_in_bull_close_when_they_are_filled() {
    let Some(folder) = models(4) else { return };
    let bull = read(&folder, "paper/bull.obj");
    println!("holes | rings | rule | F | L2 | flips | layout error | rim lengths | rim angles");
    for (count, rings) in [(3, 2), (6, 2), (3, 4), (6, 4)] {
        let mesh = with_holes(&bull, count, rings);
        for holes in [HoleRule::Fill(HoleFilling::Fan), HoleRule::Fill(HoleFilling::Ears), HoleRule::Free] {
            // With holes it is no disk any more, and would be sewn up along the seam that it was cut open at.
            let (weld, max_stretch, part_overlaps) = (Weld::Off, f64::INFINITY, false);
            let settings = Unwrap { holes, weld, max_stretch, part_overlaps, ..Unwrap::default() };
            let unwrapped = unwrap(&settings, &mesh);
            let [chart] = &unwrapped.charts[..] else { panic!("one chart") };
            let (lengths, angles) = rims(&mesh, &unwrapped.uv());
            let (metrics, error) = (&chart.metrics, chart.layout_error.expect("angles"));
            println!(
                "{count} | {rings} | {holes} | {:.3e} | {:.3} | {} | {error:.1e} | {lengths:.4} | {angles:.4}",
                metrics.f, metrics.stretch_l2, metrics.certificate.flips
            );
            if holes != HoleRule::Free {
                assert!(chart.is_certified() && unwrapped.seams.is_empty());
                assert!(error <= 1e-6, "{count} holes: laid-out angles {error} from the solved ones");
                assert_eq!(chart.holes_filled, count);
            }
        }
    }
}
