//! The command line: what was typed, and what was meant.

pub(crate) mod args;
pub(crate) mod charts;
pub(crate) mod methods;
pub(crate) mod mistyped;
pub(crate) mod packing;
pub(crate) mod program;
pub(crate) mod sheet;
pub(crate) mod targets;
pub(crate) mod typed;
pub(crate) mod usage;
