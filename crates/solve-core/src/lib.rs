//! The solver trait, stopping, observing and the solution that measures itself
