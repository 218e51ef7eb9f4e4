//! An aborted run has no result, and asks nothing after the answer.

use abf::mesh::TriMesh;
use abf::{
    Cancelled, Event, FlattenError, Observer, Pipeline, Solver, SurfaceHints, Unwrap, UnwrapError, UnwrapProgress,
    Verdict,
};
use abf_shapes::Shape;

/// Aborts at the question of this number, counted from 1, and counts the questions.
struct AbortAt {
    question: usize,
    asked: usize,
    last: Option<UnwrapProgress>,
    /// The largest round there was.
    round: usize,
}

impl AbortAt {
    fn new(question: usize) -> Self {
        Self { question, asked: 0, last: None, round: 0 }
    }
}

impl Observer for AbortAt {
    fn observe(&mut self, _: Event<'_>) -> Verdict {
        self.asked += 1;
        if self.asked >= self.question { Verdict::Abort } else { Verdict::Continue }
    }

    fn observe_at(&mut self, place: UnwrapProgress, event: Event<'_>) -> Verdict {
        self.last = Some(place);
        self.round = self.round.max(place.round);
        self.observe(event)
    }
}

/// Aborts at questions from the first to the last of a whole run.
fn aborts_everywhere<E: std::fmt::Debug>(run: impl Fn(&mut AbortAt) -> Result<(), E>, is_abort: impl Fn(&E) -> bool) {
    let mut whole = AbortAt::new(usize::MAX);
    run(&mut whole).expect("a result");
    let questions = whole.asked;
    assert!(questions > 3, "{questions} questions");
    let stride = (questions / 40).max(1);
    for question in (1..=questions).step_by(stride).chain([questions]) {
        let mut observer = AbortAt::new(question);
        let error = run(&mut observer).expect_err("aborted");
        assert!(is_abort(&error), "question {question} of {questions}: {error:?}");
        assert_eq!(observer.asked, question, "something was asked after the abort");
    }
}

fn pipeline_aborts_everywhere(solver: Solver, mesh: &TriMesh) {
    let pipeline = Pipeline { solver, ..Pipeline::default() };
    aborts_everywhere(
        |observer| pipeline.run(mesh, observer).map(|_| ()),
        |error| *error == FlattenError::Cancelled(Cancelled),
    );
}

#[test]
fn every_solver_aborts_at_every_question() {
    let mesh = Shape::BumpySheet.mesh(300);
    for solver in Solver::all() {
        pipeline_aborts_everywhere(solver, &mesh);
    }
}

#[test]
fn a_ladder_of_several_rungs_aborts_at_every_question() {
    pipeline_aborts_everywhere(Solver::default(), &Shape::SpikyField.mesh(900));
}

#[test]
fn an_unwrapping_aborts_at_every_question_and_says_where_it_is() {
    let mesh = Shape::BumpySheet.mesh(300);
    // Less stretch than the sheet has uncut.
    let unwrap = Unwrap { cut_disks: true, max_stretch: 1.001, ..Unwrap::default() };
    let run = |observer: &mut AbortAt| unwrap.run(&mesh, &SurfaceHints::default(), observer).map(|_| ());
    aborts_everywhere(run, |error| *error == UnwrapError::Cancelled(Cancelled));
    let mut whole = AbortAt::new(usize::MAX);
    run(&mut whole).expect("charts");
    let place = whole.last.expect("events of a component say where");
    // The last questions are of putting together what is done.
    assert_eq!((place.component, place.components, place.components_done), (0, 1, 1));
    assert!(whole.round >= 1);
}
