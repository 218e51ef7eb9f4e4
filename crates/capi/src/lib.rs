//! The C interface of `abf`: `include/abf.h`, which is written from here, documents it for its users.
//!
//! `entry` takes pointers and has all the `unsafe` code. Everything below it is safe: `options` reads settings,
//! `known` what is known of a mesh, `run` calls the library, `status` says what an error means, `view` shows a result.
//!
//! **Invariant.** Every entry point catches panics. Status codes are never renumbered. Structs that both sides
//! know begin with their size and only grow at the end.

pub mod entry;
pub mod event;
mod known;
pub mod options;
mod run;
pub mod status;
pub mod view;
