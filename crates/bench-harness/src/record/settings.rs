//! The settings of a run, as they are in the JSON.

use abf::{Pipeline, Solver};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

const SOLVER: &str = "solver";

/// The settings: those of a [`Pipeline`] in the form in which it writes and reads itself, and the threads.
///
/// They are kept in that form, because a solver of someone's own is written by its name and is not read back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Asked {
    /// The pipeline.
    #[serde(flatten)]
    pipeline: Map<String, Value>,
    /// Threads in use.
    pub(crate) threads: usize,
}

impl Asked {
    /// The settings of a pipeline.
    pub(crate) fn new(pipeline: &Pipeline) -> Self {
        Self { pipeline: written(pipeline), threads: rayon::current_num_threads() }
    }

    /// The solver with its settings; `None` for one of someone's own.
    pub(crate) fn solver(&self) -> Option<Solver> {
        Solver::deserialize(self.pipeline.get(SOLVER)?).ok()
    }

    /// All settings; the solver is the default one in place of someone's own.
    pub(crate) fn pipeline(&self) -> Option<Pipeline> {
        let mut all = self.pipeline.clone();
        if self.solver().is_none() {
            all.remove(SOLVER);
        }
        Pipeline::deserialize(Value::Object(all)).ok()
    }

    /// Every setting that has a value, but for the threads: its name after those of the parts it is in, and its value. The
    /// settings of the solver stand under their own names, without that of the solver.
    pub(crate) fn listed(&self) -> Vec<(String, String)> {
        let mut all = Vec::new();
        for (name, value) in &self.pipeline {
            match value {
                Value::Object(solver) if name == SOLVER => solver.values().for_each(|own| list("", own, &mut all)),
                Value::String(_) if name == SOLVER => {}
                other => list(name, other, &mut all),
            }
        }
        all
    }
}

/// Settings as they write themselves, without those parts that have no value of their own.
pub(super) fn written(settings: &impl Serialize) -> Map<String, Value> {
    match serde_json::to_value(settings) {
        Ok(Value::Object(fields)) => fields,
        Ok(_) | Err(_) => Map::new(),
    }
}

fn list(name: &str, value: &Value, all: &mut Vec<(String, String)>) {
    match value {
        Value::Null => {}
        Value::Object(parts) => {
            let within = |part: &str| if name.is_empty() { part.to_owned() } else { format!("{name}.{part}") };
            parts.iter().for_each(|(part, value)| list(&within(part), value, all));
        }
        Value::String(text) if !name.is_empty() => all.push((name.to_owned(), text.clone())),
        // The name of a solver of someone's own.
        Value::String(_) => {}
        other => all.push((name.to_owned(), other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abf::{LayoutKind, StopCriteria};
    use std::time::Duration;

    #[test]
    fn the_settings_of_every_solver_come_back_from_their_own_form() {
        for solver in Solver::all() {
            let stop = StopCriteria { time_limit: Some(Duration::from_millis(1500)), ..StopCriteria::default() };
            let mut pipeline = Pipeline { solver, stop, max_memory: Some(u64::MAX), ..Pipeline::default() };
            pipeline.layout.kind = LayoutKind::Poisson;
            let asked = Asked::new(&pipeline);
            assert_eq!(asked.solver().as_ref(), Some(&pipeline.solver));
            assert_eq!(asked.pipeline(), Some(pipeline));
        }
    }

    #[test]
    fn settings_are_listed_by_the_parts_they_are_in() {
        let listed = Asked::new(&Pipeline { solver: "minres".parse().expect("ours"), ..Pipeline::default() }).listed();
        for (name, value) in [("newton.wheel", "log"), ("stop.tolerance", "1e-8"), ("normalize", "false")] {
            assert!(listed.contains(&(name.to_owned(), value.to_owned())), "{name}: {listed:?}");
        }
        assert!(!listed.iter().any(|(name, _)| name.starts_with("solver") || name == "threads"), "{listed:?}");
    }
}
