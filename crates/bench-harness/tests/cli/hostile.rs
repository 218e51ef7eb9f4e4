//! Disks that are full, pipes that close, memory that ends, a program that is killed.

use crate::support::{Folder, Ran, fixture, program, run, run_on};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

const FULL: &str = "/dev/full";

/// SIGABRT.
const ABORT: i32 = 6;

#[test]
fn a_full_disk_is_named_and_the_result_is_shown_all_the_same() {
    let folder = Folder::new();
    let full = folder.path("full.obj");
    std::os::unix::fs::symlink(FULL, &full).expect("a link");
    for (option, target) in [("-o", full.as_path()), ("--json", Path::new(FULL)), ("--history", Path::new(FULL))] {
        let ran = run([fixture("pyramid").as_os_str(), option.as_ref(), target.as_os_str()]);
        assert_eq!(ran.code, 2, "{option}: {}", ran.stderr);
        assert!(ran.stderr.contains("cannot be written: No space left"), "{option}: {}", ran.stderr);
        assert!(ran.stderr.contains("hint: free some space"), "{option}: {}", ran.stderr);
        assert!(ran.stdout.contains("yes: no flipped"), "{option}: {}", ran.stdout);
    }
    assert!(full.is_symlink() && folder.count() == 1, "no temporary file is left");
    let ran = run_on(&format!("--json - -o {}", full.display()), &[&fixture("pyramid")]);
    let result = ran.result();
    assert_eq!((&result["valid"], &result["error"]["kind"]), (&true.into(), &"unwritable".into()));
}

#[test]
fn a_full_stdout_is_an_error_and_a_closed_one_is_none() {
    let to = |out: Stdio| {
        let mut command = program();
        command.arg(fixture("pyramid")).stdout(out).stderr(Stdio::piped());
        Ran::new(command.spawn().expect("the program starts").wait_with_output().expect("it ends"))
    };
    let full = to(std::fs::OpenOptions::new().write(true).open(FULL).expect("a device").into());
    assert_eq!(full.code, 2, "{}", full.stderr);
    assert!(full.stderr.contains("stdout: cannot be written"), "{}", full.stderr);
    let (reader, writer) = std::io::pipe().expect("a pipe");
    drop(reader);
    let closed = to(writer.into());
    assert_eq!((closed.code, closed.stderr.as_str()), (0, ""), "nobody is left to tell");
}

#[test]
fn a_folder_that_may_not_be_written_to_is_named_before_the_work() {
    // Below /proc nobody may make files, not even the superuser.
    let ran = run([fixture("pyramid").as_os_str(), "-o".as_ref(), "/proc/out.obj".as_ref()]);
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{}", ran.stderr);
    assert!(ran.stderr.contains("error: /proc/out.obj: cannot be written"), "{}", ran.stderr);
    // That folder exists: to make it would not help.
    assert!(ran.stderr.contains("hint: no file can be made in that folder"), "{}", ran.stderr);
    let folder = Folder::new();
    let link = folder.path("link.obj");
    std::os::unix::fs::symlink("missing/out.obj", &link).expect("a link");
    let file = folder.file("file", "");
    for (target, hint) in [(link, "the link leads into a folder that is not there"), (file.join("a.obj"), "is a file")]
    {
        let ran = run([fixture("pyramid").as_os_str(), "-o".as_ref(), target.as_os_str()]);
        assert!(ran.code == 2 && ran.stderr.contains(hint), "{}", ran.stderr);
    }
}

#[test]
fn an_output_through_a_link_goes_where_the_link_points() {
    let folder = Folder::new();
    let (link, real) = (folder.path("link.obj"), folder.path("real.obj"));
    std::os::unix::fs::symlink("real.obj", &link).expect("a link");
    for _ in 0..2 {
        assert_eq!(run([fixture("pyramid").as_os_str(), "-o".as_ref(), link.as_os_str()]).code, 0);
        assert!(link.is_symlink() && real.is_file());
    }
    assert_eq!(run_on("metrics", &[&real]).code, 0);
    assert_eq!(folder.count(), 2);
}

#[test]
fn a_minus_is_stdout_for_everything_that_programs_read() {
    let pyramid = fixture("pyramid");
    let history = run_on("--history -", &[&pyramid]);
    assert_eq!(history.json()["schema"], "bench-harness-history/3");
    assert!(history.stderr.contains("yes: no flipped"), "the table makes way: {}", history.stderr);
    let compare =
        |option: &str| run_on(&format!("compare --solver lscm --warmup 0 --repeats 1 {option} -"), &[&pyramid]);
    let csv = compare("--csv");
    assert!(csv.code == 0 && csv.stdout.starts_with("mesh,triangles,solver,"), "{}", csv.stdout);
    assert!(compare("--markdown").stdout.starts_with("| mesh |"));
    for options in ["--json - --history -", "compare --json - --csv -"] {
        let ran = run_on(options, &[&pyramid]);
        assert!(ran.code == 2 && ran.stderr.contains("cannot both go to stdout"), "{}", ran.stderr);
    }
    assert!(!Path::new("-").exists());
}

#[test]
fn a_killed_program_leaves_a_whole_file_or_none() {
    for moments in 0..8 {
        let folder = Folder::new();
        let out = folder.path("out.obj");
        let mut command = program();
        command.arg("-o").arg(&out).arg(fixture("mask")).stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = command.spawn().expect("the program starts");
        thread::sleep(Duration::from_millis(40 * moments));
        child.kill().expect("it can be killed");
        child.wait().expect("it ends");
        assert!(!out.exists() || run_on("metrics", &[&out]).code == 0, "after {moments}: half a file");
    }
}

/// Runs on the mask within so much address space; the shell becomes the program, so its end is seen as it is.
fn within_address_space(kilobytes: u32, out: &Path) -> Output {
    let script = format!("ulimit -v {kilobytes}; exec \"$0\" --threads 1 \"$1\" -o \"$2\"");
    let mut shell = Command::new("sh");
    shell.args(["-c", &script, env!("CARGO_BIN_EXE_bench-harness")]).arg(fixture("mask")).arg(out);
    shell.output().expect("a shell")
}

#[test]
fn a_program_without_memory_says_so_and_leaves_no_file() {
    let (mut failed, mut finished) = (0, 0);
    for kilobytes in [30_000, 60_000, 120_000, 4_000_000] {
        let folder = Folder::new();
        let out = folder.path("out.obj");
        let ran = within_address_space(kilobytes, &out);
        let said = String::from_utf8_lossy(&ran.stderr).into_owned();
        if ran.status.success() {
            finished += 1;
            assert!(out.is_file());
        } else {
            failed += 1;
            // Rust ends a program whose allocation fails: its allocator says so, and nobody can do anything after it.
            let is_named = ran.status.code() == Some(2) && said.starts_with("error: ") && said.contains("hint: ");
            let is_abort = ran.status.signal() == Some(ABORT) && said.starts_with("memory allocation of ");
            assert!(is_named || is_abort, "{kilobytes}: {} {said}", ran.status);
            assert!(!out.exists(), "{kilobytes}");
        }
        assert_eq!(folder.count(), usize::from(out.exists()), "no temporary file is left");
    }
    assert!(failed > 0 && finished > 0, "{failed} failed, {finished} finished");
}

#[test]
fn who_names_the_limit_is_refused_by_name_before_memory_is_taken() {
    for kilobytes in [30_000, 60_000, 120_000] {
        let folder = Folder::new();
        let out = folder.path("out.obj");
        let options = format!("--solver abf --max-memory {kilobytes}k -o {}", out.display());
        let ran = run_on(&options, &[&fixture("mask")]);
        assert_eq!(ran.code, 2, "{kilobytes}: {}", ran.stderr);
        assert!(ran.stderr.contains("the solver 'abf' would take about"), "{}", ran.stderr);
        assert!(ran.stderr.contains(&format!("the limit is {} MB", kilobytes / 1000)), "{}", ran.stderr);
        assert_eq!(folder.count(), 0, "no file is left");
    }
}

#[test]
fn counts_that_no_file_can_hold_are_refused_before_memory_is_taken() {
    let folder = Folder::new();
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty double x\n\
        property double y\nproperty double z\nelement face 4000000000\n\
        property list uchar uint vertex_indices\nend_header\n0123456789";
    let mut stl = vec![0; 84];
    stl[80..84].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
    for file in [
        folder.file("a.ply", ply),
        folder.file("a.stl", stl),
        folder.file("a.off", "OFF\n4000000000 4000000000 0\n0 0 0\n"),
    ] {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -v 4000000; exec \"$0\" metrics \"$1\"", env!("CARGO_BIN_EXE_bench-harness")]);
        let ran = Ran::new(shell.arg(&file).output().expect("a shell"));
        assert_eq!(ran.code, 2, "{}: {}", file.display(), ran.stderr);
        assert!(ran.stderr.starts_with(&format!("error: {}", file.display())), "{}", ran.stderr);
    }
}
