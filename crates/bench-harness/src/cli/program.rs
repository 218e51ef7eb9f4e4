//! The program by the name it was called by: its help, its usage errors, and what it generates of itself.

use super::args::{Args, Generated};
use clap::{Command, CommandFactory, FromArgMatches};
use clap_complete::Shell;
use std::ffi::OsString;
use std::io;
use std::path::Path;

/// The names of the program, the first for whoever calls it by another one.
const NAMES: [&str; 2] = ["abf", "bench-harness"];

const EXIT_CODES: &str = "\
Exit codes:
  0  finished as asked and valid: no triangle flipped or collapsed, no vertex wound around twice
  1  finished, but not converged, or not valid, or cancelled
  2  unusable input or usage, or a file that cannot be written
Of several meshes or solvers the worst counts. A reader of stdout that goes away is no error.
A map that overlaps itself is said to, and does not change the code.";

/// Reads the command line. A usage error, and a call for help, end the program.
pub(crate) fn parse() -> Args {
    let matches = command(name()).get_matches();
    Args::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command(name())).exit())
}

/// Ends the program with a usage error, which shows the usage of this command; `None` is flattening.
pub(crate) fn exit(error: clap::Error, subcommand: Option<&str>) -> ! {
    let mut command = command(name());
    command.build();
    let of = subcommand.and_then(|subcommand| command.find_subcommand(subcommand)).cloned();
    error.format(&mut of.unwrap_or(command)).exit()
}

/// A completion script, or a manual page.
///
/// # Errors
/// When it cannot be written.
pub(crate) fn generate(what: Generated, out: &mut dyn io::Write) -> io::Result<()> {
    let (name, mut command) = (name(), command(name()));
    let mut script = Vec::new();
    match what {
        Generated::CompleteBash => clap_complete::generate(Shell::Bash, &mut command, name, &mut script),
        Generated::CompleteZsh => clap_complete::generate(Shell::Zsh, &mut command, name, &mut script),
        Generated::CompleteFish => clap_complete::generate(Shell::Fish, &mut command, name, &mut script),
        Generated::Man => clap_mangen::Man::new(command).render(&mut script)?,
    }
    out.write_all(&script)
}

/// The command line of the program of that name.
fn command(name: &'static str) -> Command {
    let examples = examples(name);
    Args::command()
        .name(name)
        .bin_name(name)
        .display_name(name)
        .after_help(format!("{examples}\n\nEvery option and the exit codes: {name} --help"))
        .after_long_help(format!("{examples}\n\n{EXIT_CODES}"))
}

fn examples(name: &str) -> String {
    format!(
        "\
Examples:
  {name} mesh.obj -o out.obj                any mesh: charts and an atlas, or one chart of a disk
  {name} mesh.obj --png out.png             draw the checkered surface beside its layout
  {name} model.glb -o out.glb               a glTF stays as it is but for its UVs
  {name} disk.obj --solver all              every method, side by side
  {name} metrics out.obj                    judge the UVs that a file has
  {name} survey DIR --json out.json         every mesh of a folder"
    )
}

/// The name that the program was called by.
fn name() -> &'static str {
    let called: OsString = std::env::args_os().next().unwrap_or_default();
    let stem = Path::new(&called).file_stem().and_then(|stem| stem.to_str());
    NAMES.into_iter().find(|&name| stem == Some(name)).unwrap_or(NAMES[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_help_is_short_and_the_long_one_whole() {
        let options = |help: &str| help.lines().filter(|line| line.trim_start().starts_with('-')).count();
        for name in NAMES {
            let [short, long] = [command(name).render_help(), command(name).render_long_help()].map(|h| h.to_string());
            assert!((12..=20).contains(&options(&short)), "{}: {short}", options(&short));
            assert!(options(&long) > 40, "{long}");
            for help in [short, long] {
                assert!(
                    help.contains(&format!("Usage: {name} ")) && help.contains(&format!("  {name} mesh.obj")),
                    "{help}"
                );
                assert_eq!(help.lines().find(|line| line.chars().count() > 100), None);
            }
        }
    }

    #[test]
    fn every_script_names_the_program_and_an_option() {
        use Generated::{CompleteBash, CompleteFish, CompleteZsh, Man};
        for what in [CompleteBash, CompleteZsh, CompleteFish, Man] {
            let mut out = Vec::new();
            generate(what, &mut out).expect("written");
            let text = String::from_utf8(out).expect("text");
            assert!(text.contains("abf") && text.contains("seam"), "{text}");
        }
    }
}
