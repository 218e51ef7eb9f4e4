use abf_constraints::*;
use abf_mesh::Topology;
use abf_solve_core::*;
use abf_solve_minres::*;
#[allow(dead_code)]
struct Fresh(IterativeSettings);
impl KktStep for Fresh {
    fn step(&mut self, kkt: &KktSystem<'_>, tolerance: f64, watch: &mut Watch<'_>, out: &mut KktVector) -> Result<StepReport, StepError> {
        let t = std::time::Instant::now();
        let mut s = MinresStep::new(kkt.topology, kkt.rows, self.0)?;
        let t1 = t.elapsed();
        let r = s.step(kkt, tolerance, watch, out);
        let t2 = t.elapsed();
        println!("   {:?} {:?} {:?}", t1, t2 - t1, r);
        r
    }
}
fn show(what: &str, s: &AngleSolution, t: std::time::Duration) {
    println!("{what}: {:?} it {} inner {:?} fb {:?} neg {:?} res {:.1e} rr {:?} steps {:?} len {:?} {t:?}", s.termination(), s.iterations(), s.history().iter().map(|r| r.inner_iterations).collect::<Vec<_>>(), s.history().iter().map(|r| r.fallback).collect::<Vec<_>>(), s.history().iter().map(|r| r.negative_curvature).collect::<Vec<_>>(), s.constraint_residual(), s.history().last().unwrap().inner_residual, s.history().iter().map(|r| format!("{:.1e}", r.step)).collect::<Vec<_>>(), s.history().iter().map(|r| r.step_length).collect::<Vec<_>>());
}
#[test]
fn go() {
    for name in ["disks/camelhead.obj", "disks/camel_b.obj", "paper/cow.obj"] {
        let mesh = abf_mesh::io::read(&std::path::Path::new("/work/shared/models").join(name)).unwrap().mesh;
        let topology = Topology::build(mesh.vertex_count(), mesh.faces()).expect("a manifold");
        println!("{name} {}", mesh.face_count());
        let problem = match AngleProblem::new(&topology, mesh.corner_angles(), EstimateSettings::default()) { Ok(p) => p, Err(e) => { println!("{e}"); continue; } };

        let newton = NewtonSettings { hessian: Hessian::Exact, ..Default::default() };
        let mut d = DirectStep::new(problem.topology(), problem.rows()).unwrap();
        let direct = newton.solve(&problem, &StopCriteria::default(), &mut Silent, &mut d).unwrap();
        for max in [1000, 20000] {
            let t = std::time::Instant::now();
            match (Minres { newton, iterative: IterativeSettings { max_inner_iterations: max, ..IterativeSettings::as_published() } }).solve(&problem, &StopCriteria::default(), &mut Silent) {
                Ok(s) => { show(&format!("{name} published {max}"), &s, t.elapsed());
                println!("apart {:.1e}", direct.angles().iter().zip(s.angles()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)); }
                Err(e) => println!("{e} {:?}", t.elapsed()),
            }
        }
    }
}
