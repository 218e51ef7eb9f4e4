//! Run control: what happens is told to an [`Observer`], which may stop a run or abort it.
//!
//! There are two ways to stop. [`Verdict::Stop`] asks for a result: the solver ends with the best angles so far and
//! [`Termination::Cancelled`], and they are laid out and certified. [`Verdict::Abort`] asks for no result: whatever runs
//! returns [`Cancelled`] at once, and asks nothing more.
//!
//! A solver asks through a [`Watch`], which knows the time limit, too. Code without a time limit uses [`ask`].

mod clock;
mod error;
mod observe;
mod record;
mod stop;

pub use clock::set_clock;
pub use error::{Cancelled, SettingError, UnknownName};
pub use observe::{Checkpoint, Drawing, Event, Observer, Silent, Stage, UnwrapProgress, Verdict, Watch, ask, at_block};
pub use record::{Fallback, IterationRecord, Termination};
pub use stop::{StopCriteria, TimeBudget};
