//! What stands at the top of every document: what made it, where and when.

use serde::{Deserialize, Serialize};
use std::thread::available_parallelism;
use std::time::SystemTime;

/// The top of a document.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Head {
    /// The name of the format; the number goes up when a field changes its meaning.
    pub(crate) schema: String,
    /// What made it.
    pub(crate) program: Program,
    /// What that ran on.
    pub(crate) machine: Machine,
    /// When the document was made: RFC 3339, UTC, to the second.
    pub(crate) date: String,
}

/// A program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Program {
    /// Its name.
    pub(crate) name: String,
    /// Its version.
    pub(crate) version: String,
}

/// A machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Machine {
    /// The system, such as `linux`.
    pub(crate) os: String,
    /// The processor's family, such as `x86_64`.
    pub(crate) arch: String,
    /// How many threads run at a time; absent where that is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) cores: Option<usize>,
    /// The name of the processor, where the system tells it in a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) cpu: Option<String>,
}

impl Head {
    /// The top of a document that is made now, here.
    pub(crate) fn new(schema: &str) -> Self {
        let date = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        Self { schema: schema.to_owned(), program: Program::this(), machine: Machine::this(), date }
    }
}

impl Program {
    /// This one.
    pub(crate) fn this() -> Self {
        Self { name: "abf".to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() }
    }
}

impl Machine {
    /// This one.
    pub(crate) fn this() -> Self {
        Self {
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
            cores: available_parallelism().ok().map(Into::into),
            cpu: processor(),
        }
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
