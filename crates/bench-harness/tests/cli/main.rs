//! The program as it is used: the real binary, real files, exit codes and streams.

mod fixtures;
mod flatten;
#[cfg(target_os = "linux")]
mod interrupt;
mod metrics;
mod models;
mod refusals;
mod support;
mod surfaces;
