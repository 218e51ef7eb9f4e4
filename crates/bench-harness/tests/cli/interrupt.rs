//! Ctrl-C.

use crate::support::{Folder, Ran, fixture, program};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// How long a test waits for what cannot be seen from outside.
pub(crate) const MOMENT: Duration = Duration::from_millis(500);

pub(crate) fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.expect("kill is there").success());
}

/// Waits until the program listens to Ctrl-C, which the kernel shows as a bit for every signal.
pub(crate) fn wait_until_it_listens(child: &Child) {
    const SIGINT_BIT: u64 = 1 << 1;
    let listens = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?.trim().to_owned();
        Some(u64::from_str_radix(&caught, 16).ok()? & SIGINT_BIT != 0)
    };
    wait_until(|| listens() == Some(true), "the program listens to Ctrl-C");
}

pub(crate) fn wait_until(is_so: impl Fn() -> bool, what: &str) {
    let is_so_in_time = (0..100).any(|_| {
        thread::sleep(MOMENT / 10);
        is_so()
    });
    assert!(is_so_in_time, "{what}");
}

/// A pipe that nobody writes to: the program that reads it waits in a place that cannot be cancelled.
pub(crate) fn pipe(folder: &Folder) -> PathBuf {
    let pipe = folder.path("pipe.obj");
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo is there").success());
    pipe
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
    let pipe = pipe(&folder);
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

/// A comparison whose second mesh is a pipe, waiting there with the first one done.
fn comparison_at_the_pipe(folder: &Folder, pipe: &Path) -> Child {
    let mut command = program();
    command.args(["compare", "--solver", "linabf,lscm", "--repeats", "2"]);
    for (option, name) in [("--json", "a.json"), ("--csv", "a.csv"), ("--markdown", "a.md")] {
        command.arg(option).arg(folder.path(name));
    }
    command.args([&fixture("obtuse"), pipe, &fixture("roll")]);
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    wait_until(|| folder.path("a.md").exists(), "the first mesh is done");
    child
}

fn assert_the_first_mesh_is_kept(folder: &Folder) {
    let text = std::fs::read_to_string(folder.path("a.json")).expect("written");
    let json: Value = serde_json::from_str(&text).expect("whole");
    let results = json["results"].as_array().expect("a list");
    assert_eq!(results.len(), 2, "{text}");
    assert!(results.iter().all(|result| result["f"].is_number() && result["mesh"] != "pipe.obj"), "{text}");
    assert_eq!(std::fs::read_to_string(folder.path("a.csv")).expect("written").lines().count(), 3);
    assert_eq!(folder.count(), 4, "the pipe and three whole files");
}

#[test]
fn a_comparison_that_is_killed_keeps_the_meshes_that_were_done() {
    let folder = Folder::new();
    let pipe = pipe(&folder);
    let mut child = comparison_at_the_pipe(&folder, &pipe);
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    assert_the_first_mesh_is_kept(&folder);
}

#[test]
fn a_comparison_that_is_cancelled_keeps_the_meshes_that_were_done() {
    let folder = Folder::new();
    let pipe = pipe(&folder);
    let child = comparison_at_the_pipe(&folder, &pipe);
    interrupt(&child);
    thread::sleep(MOMENT);
    // What it waits for comes after all, but nobody wants the result any more.
    std::fs::copy(fixture("pyramid"), &pipe).expect("written");
    let ran = Ran::new(child.wait_with_output().expect("it ends"));
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("cancelled: 1 of 3 meshes done"), "{}", ran.stderr);
    assert_the_first_mesh_is_kept(&folder);
}

/// Squares on top of each other, each a part of its own, a little apart: a picture paints every one of them in full.
fn stack(folder: &Folder, count: usize) -> PathBuf {
    let mut obj = String::new();
    for k in 0..count {
        let (height, first) = (k as f64 * 1e-3, 4 * k + 1);
        for [x, y] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
            obj += &format!("v {x} {y} {height}\n");
        }
        obj += &format!("f {first} {} {}\nf {first} {} {}\n", first + 1, first + 2, first + 2, first + 3);
    }
    folder.file("stack.obj", obj)
}

#[test]
fn one_ctrl_c_ends_a_picture_that_takes_long_and_leaves_no_part_of_it() {
    let folder = Folder::new();
    let (mesh, out) = (stack(&folder, 40), folder.path("out.obj"));
    let mut command = program();
    command.arg(mesh).arg("-o").arg(&out).arg("--png").arg(folder.path("picture.png"));
    let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
    // The picture is drawn after the mesh is written.
    let begin = Instant::now();
    while !out.is_file() {
        assert!(begin.elapsed() < 240 * MOMENT, "the mesh is written");
        thread::sleep(MOMENT / 100);
    }
    let asked = Instant::now();
    interrupt(&child);
    let ran = Ran::new(child.wait_with_output().expect("it ends"));
    assert!(asked.elapsed() < 4 * MOMENT, "{:?}", asked.elapsed());
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("picture.png") && ran.stderr.contains("cancelled"), "{}", ran.stderr);
    assert_eq!(folder.count(), 2, "the mesh as it was and with its UVs");
}
