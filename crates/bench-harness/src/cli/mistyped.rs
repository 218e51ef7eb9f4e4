//! Commands that were mistyped.

use super::args::COMMANDS;
use super::usage::usage;
use clap::error::ErrorKind;
use std::path::Path;

/// Checks that a mesh is not a mistyped command: a bare word of no file.
pub(crate) fn check_is_no_command(mesh: &Path) -> Result<(), clap::Error> {
    let is_word = mesh.extension().is_none() && mesh.components().count() == 1 && !mesh.exists();
    let Some(word) = mesh.to_str().filter(|word| is_word && !word.is_empty()) else { return Ok(()) };
    let commands = COMMANDS.join(", ");
    let message = match COMMANDS.iter().find(|command| is_like(word, command)) {
        Some(command) => format!("there is no file and no command '{word}': did you mean '{command}'?"),
        None => format!("there is no file and no command '{word}'; the commands are {commands}"),
    };
    Err(usage(ErrorKind::InvalidSubcommand, message))
}

/// Whether one word may be the other mistyped: the one begins the other, or at most two letters differ.
fn is_like(word: &str, command: &str) -> bool {
    /// The most letters that are added, left out or exchanged.
    const SLIPS: usize = 2;
    /// Beginnings shorter than this mean nothing.
    const BEGINNING: usize = 3;
    let (a, b): (Vec<char>, Vec<char>) = (word.to_lowercase().chars().collect(), command.chars().collect());
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()] <= SLIPS || (a.len() >= BEGINNING && b.starts_with(&a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_taken_for_the_commands_they_resemble() {
        for (word, command) in
            [("metric", "metrics"), ("mertics", "metrics"), ("comp", "compare"), ("Fixture", "fixtures")]
        {
            assert!(is_like(word, command), "{word}");
            assert_eq!(COMMANDS.iter().filter(|command| is_like(word, command)).count(), 1, "{word}");
        }
        assert!(!COMMANDS.iter().any(|command| is_like("cow", command) || is_like("mesh", command)));
    }
}
