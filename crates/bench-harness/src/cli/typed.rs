//! What a command takes, and what was typed: hints name neither options that it rejects nor what has just been tried.

use crate::record::Record;
use crate::record::failure::Failure;
use crate::record::hints::{NOTHING_ELSE, OR, TRY};
use clap::parser::ValueSource;
use clap::{ArgMatches, Command};
use std::collections::BTreeSet;

/// The options of a command, and those that were given to it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Typed {
    /// Every option with its dashes.
    takes: BTreeSet<String>,
    /// Options with their values; a flag has none.
    given: Vec<(String, Option<String>)>,
}

impl Typed {
    /// What was typed after the subcommand, or after the program where there is none.
    pub(crate) fn new(program: &Command, matches: &ArgMatches) -> Self {
        let of_subcommand = matches.subcommand().and_then(|(name, own)| Some((program.find_subcommand(name)?, own)));
        let (command, matches) = of_subcommand.unwrap_or((program, matches));
        let mut typed = Self::default();
        for argument in command.get_arguments() {
            let names = argument.get_long().map(|long| format!("--{long}"));
            let names: Vec<String> = names.into_iter().chain(argument.get_short().map(|s| format!("-{s}"))).collect();
            let id = argument.get_id().as_str();
            if matches.try_contains_id(id).is_ok() && matches.value_source(id) == Some(ValueSource::CommandLine) {
                let value = match argument.get_action().takes_values() {
                    true => matches
                        .get_raw(id)
                        .map(|all| all.map(|value| value.to_string_lossy().into_owned()).collect::<Vec<_>>().join(",")),
                    false => None,
                };
                typed.given.extend(names.iter().map(|name| (name.clone(), value.clone())));
            }
            typed.takes.extend(names);
        }
        typed
    }

    /// Leaves in the hints of a record what fits this command.
    pub(crate) fn fit(&self, record: &mut Record) {
        if let Some(failure) = &mut record.error {
            self.fit_failure(failure);
        }
        if let Some((what, tries)) = record.hint.as_deref().and_then(|hint| hint.split_once(TRY)) {
            let left = self.fitting(tries);
            let hint = if left.is_empty() { what.to_owned() } else { format!("{what}{TRY}{}", left.join(OR)) };
            record.hint = Some(hint);
        }
    }

    /// Leaves in the hint of a failure what fits this command.
    pub(crate) fn fit_failure(&self, failure: &mut Failure) {
        let left = self.fitting(&failure.hint);
        failure.hint = if left.is_empty() { NOTHING_ELSE.to_owned() } else { left.join(OR) };
    }

    /// Those of several things to try that this command takes, and that were not just tried.
    fn fitting<'t>(&self, tries: &'t str) -> Vec<&'t str> {
        tries.split(OR).filter(|attempt| self.fits(attempt)).collect()
    }

    fn fits(&self, attempt: &str) -> bool {
        // Another call of the program, with options of its own.
        if attempt.contains("abf ") {
            return true;
        }
        let words: Vec<&str> = attempt.split_whitespace().map(|word| word.trim_end_matches([',', ':', ';'])).collect();
        let options = words.iter().enumerate().filter(|(_, word)| word.starts_with('-') && word.len() > 1);
        options.into_iter().all(|(at, option)| {
            let is_left_out = words[..at].ends_with(&["leave", "out"]);
            let value = words.get(at + 1).copied();
            let is_same = |(name, given): &(String, Option<String>)| {
                name == option && given.as_deref().is_none_or(|given| Some(given) == value)
            };
            self.takes.contains(*option) && (is_left_out || !self.given.iter().any(is_same))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::Args;
    use clap::CommandFactory;

    fn typed(line: &str) -> Result<Typed, clap::Error> {
        let mut program = Args::command();
        program.build();
        let matches = program.try_get_matches_from_mut(line.split_whitespace())?;
        Ok(Typed::new(&program, &matches))
    }

    /// The texts that are hints, of the source of hints and of the one of failures.
    fn hints() -> [Vec<&'static str>; 2] {
        [include_str!("../record/hints.rs"), include_str!("../record/failure.rs")].map(|source| {
            let code = source.split("#[cfg(test)]").next().unwrap_or_default();
            let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
            let texts = code.flat_map(|line| line.split('"').skip(1).step_by(2));
            texts.filter(|text| text.contains(' ') && !text.contains('{')).collect()
        })
    }

    fn without_sign(word: &str) -> &str {
        word.trim_end_matches([',', ':', ';'])
    }

    #[test]
    fn no_command_names_an_option_that_it_rejects() {
        let all = hints().concat();
        assert!(all.len() > 60 && all.iter().filter(|hint| hint.contains("--")).count() > 15, "{all:?}");
        for line in ["abf a.obj", "abf compare a.obj", "abf survey a", "abf metrics a.obj", "abf pack a.obj"] {
            let typed = typed(line).expect("a command line");
            for hint in &all {
                let mut failure = Failure::panicked("a.obj");
                failure.hint = (*hint).to_owned();
                typed.fit_failure(&mut failure);
                assert!(!failure.hint.is_empty());
                for attempt in failure.hint.split(OR).filter(|attempt| !attempt.contains("abf ")) {
                    let words = attempt.split_whitespace().map(without_sign);
                    let foreign = words.filter(|word| word.starts_with("--")).find(|&word| !typed.takes.contains(word));
                    assert_eq!(foreign, None, "{line}: {hint}");
                }
            }
        }
        // Whoever flattens may take every option that an error of a mesh can name.
        let flatten = typed("abf a.obj").expect("a command line");
        assert!(hints()[0].iter().all(|hint| flatten.fitting(hint) == hint.split(OR).collect::<Vec<_>>()));
    }

    #[test]
    fn no_hint_names_what_was_just_tried() {
        for hint in hints().concat() {
            let words: Vec<&str> = hint.split_whitespace().map(without_sign).collect();
            for pair in words.windows(2).filter(|pair| pair[0].starts_with("--") && !pair[1].starts_with("--")) {
                let again = pair.join(" ");
                // Not every word after an option is a value of it.
                let Ok(typed) = typed(&format!("abf a.obj {again}")) else { continue };
                let left = typed.fitting(hint);
                let is_again = |attempt: &&&str| {
                    let words: Vec<&str> = attempt.split_whitespace().map(without_sign).collect();
                    let is_other = attempt.contains("abf ") || attempt.contains("leave out");
                    words.windows(2).any(|two| two == pair) && !is_other
                };
                assert_eq!(left.iter().find(is_again), None, "{hint}");
                assert!(!left.is_empty(), "{hint}: there should be something else than {again}");
            }
        }
    }

    #[test]
    fn a_flag_that_was_given_is_not_tried_again_and_another_value_may_be() {
        let typed = typed("abf a.obj --cut-disks --max-iterations 9 -o a.glb").expect("a command line");
        assert_eq!(typed.fitting("--cut-disks, or --max-iterations 18"), ["--max-iterations 18"]);
        assert_eq!(typed.fitting("--max-iterations 9, or leave out --cut-disks"), ["leave out --cut-disks"]);
        assert_eq!(typed.fitting("more --max-iterations"), ["more --max-iterations"]);
        let mut record = Record { hint: Some("not valid: try --cut-disks".to_owned()), ..Record::default() };
        typed.fit(&mut record);
        assert_eq!(record.hint.as_deref(), Some("not valid"));
    }
}
