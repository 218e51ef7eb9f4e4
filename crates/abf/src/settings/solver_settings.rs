//! Settings of solvers as users give them: by their names, whichever solver has them.

use crate::settings::{Passes, Solver, SolverKind, SolverParts};
use abf_constraints::WheelForm;
use abf_solve_core::{Hessian, InnerTolerance, LineSearch, PreconditionerKind, Reduction};

/// Settings that some solvers have and others have not, by the names of the command line. `None` is the solver's own default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverSettings {
    /// How many passes are made.
    pub passes: Option<Passes>,
    /// By which part of its way to 0 or π an angle moves in a pass at most; in (0, 1).
    pub error_bound: Option<f64>,
    /// The last weight of the barrier, in units of energy per corner.
    pub barrier_floor: Option<f64>,
    /// The form of the wheel condition.
    pub wheel: Option<WheelForm>,
    /// The second derivatives.
    pub hessian: Option<Hessian>,
    /// How long steps are.
    pub line_search: Option<LineSearch>,
    /// Which unknowns are eliminated first.
    pub reduction: Option<Reduction>,
    /// The preconditioner.
    pub preconditioner: Option<PreconditionerKind>,
    /// How many inner iterations there are in an outer one, at most.
    pub max_inner_iterations: Option<usize>,
    /// The relative residual of the inner method.
    pub inner_tolerance: Option<InnerTolerance>,
}

/// A setting that was given, and that the solver does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{setting} means nothing to the solver '{solver}': leave it out")]
#[non_exhaustive]
pub struct VoidSetting {
    /// Its name.
    pub setting: &'static str,
    /// The solver.
    pub solver: SolverKind,
}

impl SolverSettings {
    /// Gives a solver its settings. [`Pipeline::check`](crate::Pipeline::check) looks at their values.
    ///
    /// # Errors
    /// [`VoidSetting`] names the first that the solver does not have; the solver stays as it was then.
    pub fn give(&self, solver: &mut Solver) -> Result<(), VoidSetting> {
        self.refuse_void(solver.kind())?;
        self.give_what_it_has(solver);
        Ok(())
    }

    /// Gives a solver those that it has, and leaves out the others: for several solvers with one set of settings.
    pub fn give_what_it_has(&self, solver: &mut Solver) {
        let bounds_errors = solver.kind().bounds_errors();
        let SolverParts { linabf, newton, iterative, barrier, descent } = solver.parts_mut();
        if let Some(linabf) = linabf {
            linabf.passes = self.passes.unwrap_or(linabf.passes);
            linabf.error_bound = self.error_bound.filter(|_| bounds_errors).or(linabf.error_bound);
        }
        if let Some(newton) = newton {
            newton.wheel = self.wheel.unwrap_or(newton.wheel);
            newton.hessian = self.hessian.unwrap_or(newton.hessian);
            newton.line_search = self.line_search.unwrap_or(newton.line_search);
            newton.inner_tolerance = self.inner_tolerance.unwrap_or(newton.inner_tolerance);
        }
        if let Some(iterative) = iterative {
            iterative.reduction = self.reduction.unwrap_or(iterative.reduction);
            iterative.preconditioner = self.preconditioner.unwrap_or(iterative.preconditioner);
            iterative.max_inner_iterations = self.max_inner_iterations.unwrap_or(iterative.max_inner_iterations);
        }
        if let Some(barrier) = barrier {
            barrier.barrier_floor = self.barrier_floor.unwrap_or(barrier.barrier_floor);
        }
        if let Some(descent) = descent {
            descent.barrier_floor = self.barrier_floor.unwrap_or(descent.barrier_floor);
        }
    }

    fn refuse_void(&self, solver: SolverKind) -> Result<(), VoidSetting> {
        let (fixed_target, inner) = (solver.has_a_fixed_target(), solver.iterates_inside());
        let given = [
            ("passes", self.passes.is_some(), solver.makes_passes()),
            ("error_bound", self.error_bound.is_some(), solver.bounds_errors()),
            ("barrier_floor", self.barrier_floor.is_some(), solver.has_a_barrier()),
            ("wheel", self.wheel.is_some(), fixed_target),
            ("hessian", self.hessian.is_some(), fixed_target),
            ("line_search", self.line_search.is_some(), fixed_target),
            ("reduction", self.reduction.is_some(), inner),
            ("preconditioner", self.preconditioner.is_some(), inner),
            ("max_inner_iterations", self.max_inner_iterations.is_some(), inner),
            ("inner_tolerance", self.inner_tolerance.is_some(), inner),
        ];
        match given.into_iter().find(|&(_, is_given, is_read)| is_given && !is_read) {
            Some((setting, ..)) => Err(VoidSetting { setting, solver }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One setting each.
    fn each() -> [SolverSettings; 10] {
        let none = SolverSettings::default();
        [
            SolverSettings { passes: Some(Passes::Exactly(std::num::NonZeroUsize::MIN)), ..none },
            SolverSettings { error_bound: Some(0.5), ..none },
            SolverSettings { barrier_floor: Some(1e-7), ..none },
            SolverSettings { wheel: Some(WheelForm::Product), ..none },
            SolverSettings { hessian: Some(Hessian::Exact), ..none },
            SolverSettings { line_search: Some(LineSearch::Full), ..none },
            SolverSettings { reduction: Some(Reduction::None), ..none },
            SolverSettings { preconditioner: Some(PreconditionerKind::None), ..none },
            SolverSettings { max_inner_iterations: Some(7), ..none },
            SolverSettings { inner_tolerance: Some(InnerTolerance::Fixed(0.125)), ..none },
        ]
    }

    #[test]
    fn a_setting_changes_the_solvers_that_have_it_and_is_refused_by_all_others() {
        for settings in each() {
            let mut changed = 0;
            for plain in Solver::all() {
                let mut solver = plain.clone();
                match settings.give(&mut solver) {
                    Ok(()) => changed += usize::from(solver != plain),
                    Err(VoidSetting { setting, solver: kind }) => {
                        assert_eq!((kind, &solver), (plain.kind(), &plain), "{setting}");
                    }
                }
            }
            assert!(changed > 0, "{settings:?}");
            let error = settings.give(&mut Solver::Lscm).unwrap_err();
            assert!(error.to_string().ends_with("means nothing to the solver 'lscm': leave it out"), "{error}");
        }
    }

    #[test]
    fn without_settings_every_solver_keeps_its_own() {
        for plain in Solver::all() {
            let mut solver = plain.clone();
            assert_eq!(SolverSettings::default().give(&mut solver), Ok(()));
            assert_eq!(solver, plain);
        }
    }
}
