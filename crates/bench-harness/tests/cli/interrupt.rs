//! Ctrl-C.

use crate::support::{Folder, Ran, fixture, program};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// How long a test waits for what cannot be seen from outside.
const MOMENT: Duration = Duration::from_millis(500);

fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.expect("kill is there").success());
}

/// Waits until the program listens to Ctrl-C, which the kernel shows as a bit for every signal.
fn wait_until_it_listens(child: &Child) {
    const SIGINT_BIT: u64 = 1 << 1;
    let listens = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?.trim().to_owned();
        Some(u64::from_str_radix(&caught, 16).ok()? & SIGINT_BIT != 0)
    };
    for _ in 0..100 {
        if listens() == Some(true) {
            return;
        }
        thread::sleep(MOMENT / 10);
    }
    panic!("the program does not listen to Ctrl-C");
}

#[test]
fn ctrl_c_keeps_the_best_angles_so_far() {
    let folder = Folder::new();
    let out = folder.path("out.obj");
    // A tolerance that no pass meets: it goes on until it is stopped.
    let mut command = program();
    command
        .args(["--passes", "100000000", "--tolerance", "1e-300", "--json", "-", "-o"])
        .arg(&out)
        .arg(fixture("mask-coarse"));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait_until_it_listens(&child);
    thread::sleep(MOMENT);
    interrupt(&child);
    let ran = Ran::new(child.wait_with_output().expect("it ends"));
    let result = ran.result();
    assert_eq!((ran.code, &result["termination"]), (1, &"cancelled".into()), "{}", ran.stderr);
    assert!(result["iterations"].as_u64().expect("a number") > 0);
    assert!(out.is_file(), "what there is is written");
    assert_eq!(folder.count(), 1);
}

#[test]
fn a_second_ctrl_c_leaves_at_once_and_leaves_no_file() {
    let folder = Folder::new();
    // A pipe that nobody writes to: the program waits in a place that cannot be cancelled.
    let pipe = folder.path("pipe.obj");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo is there").success());
    let mut command = program();
    command.arg(&pipe).arg("-o").arg(folder.path("out.obj"));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait_until_it_listens(&child);
    interrupt(&child);
    thread::sleep(MOMENT);
    interrupt(&child);
    let ran = Ran::new(child.wait_with_output().expect("it ends"));
    assert_eq!(ran.code, 130, "{}", ran.stderr);
    assert!(ran.stderr.contains("once more to leave at once"), "{}", ran.stderr);
    assert_eq!(folder.count(), 1, "the pipe only");
}
