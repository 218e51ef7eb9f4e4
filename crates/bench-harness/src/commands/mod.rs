//! What the program does, command by command.

pub(crate) mod compare;
pub(crate) mod fixtures;
pub(crate) mod flatten;
pub(crate) mod metrics;
pub(crate) mod pack;
pub(crate) mod sparsity;
pub(crate) mod survey;
