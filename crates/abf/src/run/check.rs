//! Settings, checked before anything is done.

use crate::settings::{Injective, Ladder, LinAbf, Method, Pipeline, Solver};
use crate::{Elsewhere, FlattenError};
use abf_constraints::ProblemError;
use abf_embed::{Descent, EmbedError, check_gap};
use abf_reconstruct::LayoutKind;
use abf_solve_core::AngleSolver;

impl Pipeline {
    /// Checks every setting. [`Pipeline::run`] does so first, with the same error.
    ///
    /// # Errors
    /// [`FlattenError`] that names the setting and what it may be, or settings that do not go together.
    pub fn check(&self) -> Result<(), FlattenError> {
        self.check_layout()?;
        self.initial_guess.check()?;
        self.check_boundary()?;
        self.check_relax()?;
        self.check_injective()?;
        match self.solver.method() {
            Method::Ladder(Ladder { linabf, newton, barrier, descent }) => {
                self.check_angles(&(*linabf).into(), linabf)?;
                self.check_angles(&(*newton).into(), newton)?;
                self.check_angles(&(*barrier).into(), barrier)?;
                self.check_descent(descent)
            }
            Method::Angles(angles) => self.check_angles(&self.solver, angles),
            Method::Positions(descent) => self.check_descent(descent),
            Method::Hierarchy(hierarchical) => {
                let settings = self.stop.check().map_err(Into::into).and_then(|()| hierarchical.check());
                settings.map_err(|source| FlattenError::of_solver(self.solver.kind(), source))
            }
            // It is one linear solve: there is nothing to stop.
            Method::SurfaceAngles => Ok(()),
        }
    }

    fn check_boundary(&self) -> Result<(), FlattenError> {
        self.boundary.check().map_err(ProblemError::from)?;
        let keeps = match self.solver.method() {
            // It leaves out the solvers that do not.
            Method::Ladder(_) => true,
            Method::Angles(angles) => angles.keeps_boundary(),
            Method::Positions(_) | Method::Hierarchy(_) | Method::SurfaceAngles => false,
        };
        match (self.boundary.is_free() || keeps, &self.solver) {
            (true, _) => Ok(()),
            (false, Solver::LinAbf(LinAbf { error_bound: Some(_), .. })) => {
                Err(FlattenError::of_solver(self.solver.kind(), LinAbf::BOUND_AND_BOUNDARY))
            }
            (false, _) => Err(FlattenError::BoundarySolver(self.solver.kind())),
        }
    }

    fn check_relax(&self) -> Result<(), FlattenError> {
        if self.pins.is_some() && (self.normalize || !self.boundary.is_free()) {
            return Err(FlattenError::PinsElsewhere(if self.normalize {
                Elsewhere::Normalize
            } else {
                Elsewhere::Boundary
            }));
        }
        let Some(relax) = &self.relax else { return Ok(()) };
        if !self.boundary.is_free() {
            return Err(FlattenError::RelaxBoundary(relax.energy.to_string()));
        }
        self.stop.check().map_err(EmbedError::from).and_then(|()| relax.check()).map_err(FlattenError::Relax)
    }

    fn check_injective(&self) -> Result<(), FlattenError> {
        let Self { injective, boundary_gap, normalize, .. } = *self;
        check_gap(boundary_gap).map_err(|error| FlattenError::Injective(error.into()))?;
        if boundary_gap > 0.0 && (injective != Injective::Deform || normalize) {
            return Err(FlattenError::GapElsewhere);
        }
        let other = [(self.pins.is_some(), Elsewhere::Pins), (!self.boundary.is_free(), Elsewhere::Boundary)];
        match other.into_iter().find(|&(is_asked, _)| is_asked && injective != Injective::Off) {
            Some((_, other)) => Err(FlattenError::InjectiveElsewhere(injective, other)),
            None => Ok(()),
        }
    }

    fn check_angles(&self, solver: &Solver, angles: &dyn AngleSolver) -> Result<(), FlattenError> {
        let settings = self.stop.check().map_err(Into::into).and_then(|()| angles.check());
        settings.map_err(|source| FlattenError::of_solver(solver.kind(), source))
    }

    fn check_descent(&self, descent: &Descent) -> Result<(), FlattenError> {
        Ok(self.stop.check().map_err(Into::into).and_then(|()| descent.check())?)
    }

    fn check_layout(&self) -> Result<(), FlattenError> {
        let kind = self.layout.kind;
        match self.solver.method() {
            Method::Positions(_) if kind != LayoutKind::Auto => Err(FlattenError::DescentLayout(kind)),
            Method::SurfaceAngles if matches!(kind, LayoutKind::Tree | LayoutKind::Poisson) => {
                Err(FlattenError::LscmLayout(kind))
            }
            Method::Ladder(_)
            | Method::Angles(_)
            | Method::Positions(_)
            | Method::Hierarchy(_)
            | Method::SurfaceAngles => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf_constraints::GuessSettings;
    use abf_control::{Event, Observer, StopCriteria, Verdict};
    use abf_reconstruct::LayoutSettings;
    use abf_shapes::Shape;
    use abf_solve_core::InnerTolerance;

    /// An observer that hears nothing, for nothing is begun.
    struct Deaf;

    impl Observer for Deaf {
        fn observe(&mut self, event: Event<'_>) -> Verdict {
            panic!("{event:?}")
        }
    }

    /// The message, which a run gives, too, before it begins.
    fn refused(pipeline: &Pipeline) -> String {
        let error = pipeline.check().expect_err("a setting out of range");
        assert_eq!(pipeline.run(&Shape::BumpySheet.mesh(20), &mut Deaf).expect_err("the same"), error);
        let source = std::error::Error::source(&error).map_or_else(String::new, ToString::to_string);
        format!("{error}: {source}")
    }

    /// Puts a setting out of range, where a solver has it.
    type Spoil = dyn Fn(&mut Solver) -> Option<()>;

    #[test]
    fn the_defaults_of_every_solver_are_in_range() {
        for solver in Solver::all() {
            assert_eq!(Pipeline { solver, ..Pipeline::default() }.check(), Ok(()));
        }
    }

    #[test]
    fn settings_of_every_solver_are_refused_as_a_run_refuses_them() {
        let mut checked = 0;
        for solver in Solver::all() {
            let spoils: [&Spoil; 4] = [
                &|s| s.parts_mut().newton.map(|newton| newton.inner_tolerance = InnerTolerance::Fixed(2.0)),
                &|s| s.parts_mut().iterative.map(|iterative| iterative.max_inner_iterations = 0),
                &|s| s.parts_mut().barrier.map(|barrier| barrier.barrier_floor = -1.0),
                &|s| s.parts_mut().descent.map(|descent| descent.barrier_floor = -1.0),
            ];
            for (spoil, name) in
                spoils.iter().zip(["inner_tolerance", "max_inner_iterations", "barrier_floor", "barrier_floor"])
            {
                let mut solver = solver.clone();
                if spoil(&mut solver).is_some() {
                    let said = refused(&Pipeline { solver, ..Pipeline::default() });
                    assert!(said.contains(name), "{said}");
                    checked += 1;
                }
            }
        }
        assert!(checked >= 10, "{checked}");
    }

    #[test]
    fn settings_of_all_solvers_are_refused_as_a_run_refuses_them() {
        for solver in Solver::all() {
            let initial_guess = GuessSettings { angle_bound: 2.0, ..GuessSettings::default() };
            let pipeline = Pipeline { solver, ..Pipeline::default() };
            assert!(refused(&Pipeline { initial_guess, ..pipeline.clone() }).contains("angle_bound"));
            let stop = StopCriteria { max_iterations: 0, ..StopCriteria::default() };
            let pipeline = Pipeline { stop, ..pipeline };
            match pipeline.solver.method() {
                Method::SurfaceAngles => assert_eq!(pipeline.check(), Ok(())),
                _ => assert!(refused(&pipeline).contains("max_iterations"), "{}", pipeline.solver),
            }
        }
    }

    #[test]
    fn what_does_not_go_with_a_rule_for_overlaps_is_refused_by_name() {
        use abf_constraints::Boundary;
        for injective in [Injective::Split, Injective::Deform] {
            let pipeline = Pipeline { injective, ..Pipeline::default() };
            assert_eq!(pipeline.check(), Ok(()));
            let pinned = Pipeline { pins: Some(abf_embed::Pins::default()), ..pipeline.clone() };
            assert!(refused(&pinned).contains("does not go with pins"));
            let bounded = Pipeline { boundary: Boundary::Convex, ..pipeline };
            assert!(refused(&bounded).contains("does not go with a boundary rule"));
        }
        let gap = |injective, boundary_gap| Pipeline { injective, boundary_gap, ..Pipeline::default() };
        assert_eq!(gap(Injective::Deform, 0.1).check(), Ok(()));
        assert!(refused(&gap(Injective::Split, 0.1)).contains("deform"));
        assert!(refused(&gap(Injective::Deform, -0.1)).contains("boundary_gap"));
        assert!(refused(&Pipeline { normalize: true, ..gap(Injective::Deform, 0.1) }).contains("normalized"));
    }

    #[test]
    fn a_layout_that_a_solver_cannot_use_is_refused() {
        let layout = LayoutSettings { kind: LayoutKind::Poisson, ..LayoutSettings::default() };
        for solver in [Solver::Lscm, Descent::default().into()] {
            assert!(refused(&Pipeline { solver, layout, ..Pipeline::default() }).contains("poisson"));
        }
    }
}
