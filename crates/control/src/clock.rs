//! The clock of time limits.

use std::sync::OnceLock;
use std::time::Duration;

static HANDED: OnceLock<fn() -> Duration> = OnceLock::new();

/// Hands in a clock, for targets without one of their own: the time since some moment, which never goes back.
///
/// The first one stays; `false` for every other. With a clock of its own (all targets but `wasm32-unknown-unknown`, and that, too,
/// with the feature `web-time`) the library reads that until it is handed another.
pub fn set_clock(clock: fn() -> Duration) -> bool {
    HANDED.set(clock).is_ok()
}

/// The time since some moment; `None` without a clock.
pub(crate) fn now() -> Option<Duration> {
    HANDED.get().map_or_else(own, |clock| Some(clock()))
}

#[cfg(any(feature = "web-time", not(all(target_family = "wasm", target_os = "unknown"))))]
fn own() -> Option<Duration> {
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    use std::time::Instant;
    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    use web_time::Instant;

    static START: OnceLock<Instant> = OnceLock::new();
    Some(START.get_or_init(Instant::now).elapsed())
}

#[cfg(not(any(feature = "web-time", not(all(target_family = "wasm", target_os = "unknown")))))]
fn own() -> Option<Duration> {
    None
}
