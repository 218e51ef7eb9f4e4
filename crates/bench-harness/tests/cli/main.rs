//! The program as it is used: the real binary, real files, exit codes and streams.

mod boundary;
mod charts;
mod compare;
mod fixtures;
mod flatten;
#[cfg(target_os = "linux")]
mod hostile;
mod injective;
#[cfg(target_os = "linux")]
mod interrupt;
mod memory;
mod metrics;
mod models;
mod names;
mod packing;
mod refusals;
mod research;
mod rows;
mod sheet;
mod solvers;
mod support;
mod surfaces;
mod survey;
