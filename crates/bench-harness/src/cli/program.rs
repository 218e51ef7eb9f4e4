//! The program by the name it was called by: its help, its usage errors, and what it generates of itself.

use super::args::{Args, Generated};
use super::typed::Typed;
use clap::{Command, CommandFactory, FromArgMatches};
use clap_complete::Shell;
use clap_mangen::Man;
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
  130  interrupted twice
Of several meshes or solvers the worst counts. A reader of stdout that goes away is no error.
An overlap makes the code 1 in an atlas, unless --overlap allow; of a lone disk it is said only.";

/// Reads the command line. A usage error, and a call for help, end the program.
pub(crate) fn parse() -> (Args, Typed) {
    let mut command = command(name());
    command.build();
    let matches = command.get_matches_mut();
    let args = Args::from_arg_matches(&matches).unwrap_or_else(|error| error.format(&mut command).exit());
    (args, Typed::new(&command, &matches))
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
        Generated::Man => manual(command, &mut script)?,
    }
    out.write_all(&script)
}

/// One manual of everything: the page of flattening, then for each subcommand a section with its synopsis and its options.
fn manual(mut command: Command, out: &mut dyn io::Write) -> io::Result<()> {
    command.build();
    Man::new(command.clone()).render(out)?;
    for subcommand in command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help") {
        let page = Man::new(subcommand.clone());
        let mut sections = Vec::new();
        page.render_synopsis_section(&mut sections)?;
        page.render_description_section(&mut sections)?;
        page.render_options_section(&mut sections)?;
        page.render_extra_section(&mut sections)?;
        let title = subcommand.get_bin_name().unwrap_or(subcommand.get_name()).to_uppercase();
        // Sections of a subcommand are subsections of the whole.
        let sections = String::from_utf8_lossy(&sections).replace("\n.SH ", "\n.SS ");
        let sections = sections.strip_prefix(".SH ").map_or_else(|| sections.clone(), |rest| format!(".SS {rest}"));
        writeln!(out, ".SH \"{title}\"\n{sections}")?;
    }
    Ok(())
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
  {name} pack model.glb -o out.glb          lay out anew the UVs that a file has
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
    fn every_subcommand_has_a_help_of_its_own_and_a_section_of_the_manual_with_all_its_options() {
        let mut out = Vec::new();
        generate(Generated::Man, &mut out).expect("written");
        let manual = String::from_utf8(out).expect("text").replace("\\-", "-");
        assert_eq!(manual.lines().filter(|line| line.starts_with(".TH ")).count(), 1, "one page: {manual}");
        let mut command = command("abf");
        command.build();
        for subcommand in command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help") {
            let title = format!("\n.SH \"ABF {}\"\n", subcommand.get_name().to_uppercase());
            let (_, section) = manual.split_once(&title).unwrap_or_else(|| panic!("{title} in {manual}"));
            let section = section.split("\n.SH ").next().unwrap_or_default();
            let help = subcommand.clone().render_long_help().to_string();
            assert!(help.contains(&format!("Usage: abf {}", subcommand.get_name())), "{help}");
            assert_eq!(help.lines().find(|line| line.chars().count() > 100), None);
            for argument in subcommand.get_arguments().filter(|argument| !argument.is_hide_set()) {
                let Some(option) = argument.get_long().map(|long| format!("--{long}")) else { continue };
                assert!(help.contains(&option), "{option}: {help}");
                assert!(section.contains(&option), "{option}: {section}");
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
