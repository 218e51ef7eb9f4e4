//! Many meshes, one solver.

use crate::support::{Folder, Ran, fixture, program, run_on};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A folder of meshes: two good ones, one inside another folder, a closed one and a file that is no mesh.
fn meshes(folder: &Folder) -> std::path::PathBuf {
    let meshes = folder.path("meshes");
    fs::create_dir_all(meshes.join("inner")).expect("a folder");
    for (name, from) in [("b.obj", "obtuse"), ("a.obj", "pyramid"), ("inner/c.obj", "roll")] {
        fs::copy(fixture(from), meshes.join(name)).expect("copied");
    }
    let tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(meshes.join("closed.obj"), tetrahedron).expect("written");
    fs::write(meshes.join("damaged.obj"), "v 0 0 0\nf 1 2 3\n").expect("written");
    meshes
}

fn read(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).expect("written")).expect("whole")
}

fn names(json: &Value) -> Vec<String> {
    let results = json["results"].as_array().expect("a list");
    let name = |result: &Value| {
        let path = Path::new(result["mesh"].as_str().expect("a name"));
        path.file_name().and_then(|name| name.to_str()).expect("a name").to_owned()
    };
    results.iter().map(name).collect()
}

#[test]
fn every_mesh_is_a_row_and_every_refusal_has_its_reason() {
    let folder = Folder::new();
    let meshes = meshes(&folder);
    let json = folder.path("out.json");
    let ran = run_on(&format!("survey --solver linabf --disks-only --jobs 3 --json {}", json.display()), &[&meshes]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stdout.contains("5 meshes: 3 valid, 0 not valid, 2 refused"), "{}", ran.stdout);
    assert!(ran.stdout.contains("refused: 1 not a disk, 1 unreadable"), "{}", ran.stdout);
    assert!(ran.stdout.contains("the worst 3:"), "{}", ran.stdout);
    let json = read(&json);
    assert_eq!(names(&json), ["a.obj", "b.obj", "closed.obj", "damaged.obj", "c.obj"]);
    let survey = &json["survey"];
    assert_eq!((&survey["valid"], &survey["done"], &survey["solver"]), (&3.into(), &5.into(), &"linabf".into()));
    assert_eq!(survey["refused"], serde_json::json!({"not a disk": 1, "unreadable": 1}));
    let good = &json["results"][0];
    assert!(good["f"].is_number() && good["stretch_l2"].is_number() && good["timings_s"]["total"].is_number());
    assert_eq!((&good["converged"], &good["result"]), (&true.into(), &"converged".into()));
    assert_eq!(json["results"][2]["refused"], "not a disk");
    // The log has done its duty.
    assert_eq!(folder.count(), 2);
}

#[test]
fn the_results_are_the_same_for_any_number_of_jobs() {
    let folder = Folder::new();
    let meshes = meshes(&folder);
    let figures = |jobs: usize| {
        let json = run_on(&format!("survey --jobs {jobs} --json -"), &[&meshes]).json();
        let results = json["results"].as_array().expect("a list").clone();
        let figures = |result: &Value| ["mesh", "f", "stretch_l2", "iterations", "uv_area"].map(|k| result[k].clone());
        results.iter().map(figures).collect::<Vec<_>>()
    };
    assert_eq!(figures(1), figures(4));
}

#[test]
fn all_valid_is_exit_code_0_and_folders_inside_can_be_left_out() {
    let folder = Folder::new();
    let meshes = meshes(&folder);
    for name in ["closed.obj", "damaged.obj"] {
        fs::remove_file(meshes.join(name)).expect("removed");
    }
    let ran = run_on("survey", &[&meshes]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stdout.contains("3 meshes: 3 valid"), "{}", ran.stdout);
    let ran = run_on("survey --flat --solver lscm", &[&meshes]);
    assert!(ran.stdout.contains("2 meshes: ") && ran.stdout.contains("lscm"), "{}", ran.stdout);
}

#[test]
fn a_time_limit_is_one_for_every_mesh_and_what_it_ends_is_not_converged() {
    let ran = run_on("survey --time-limit 0 --max-iterations 3", &[&fixture("mask-coarse"), &fixture("spike")]);
    assert!(ran.stdout.contains("2 not converged"), "{}", ran.stdout);
    assert!(ran.stdout.contains("time-limit"), "{}", ran.stdout);
}

#[test]
fn unusable_usage_is_exit_code_2() {
    let folder = Folder::new();
    fs::create_dir(folder.path("empty")).expect("a folder");
    let meshes = meshes(&folder);
    let mesh = meshes.join("a.obj");
    for (options, said) in [
        (format!("survey {}", folder.path("empty").display()), "there is no mesh below it"),
        (format!("survey {}", folder.path("nodir").display()), "nodir: cannot be read: No such file"),
        ("survey".to_owned(), "required"),
        (format!("survey --solver all {}", mesh.display()), "there is no solver 'all'"),
        (format!("survey --jobs 0 {}", mesh.display()), "1..=1024"),
        (format!("survey --resume {}", mesh.display()), "name it with --json FILE"),
        (format!("survey --resume --json - {}", mesh.display()), "name it with --json FILE"),
        (format!("survey {0} --json {0}", mesh.display()), "would replace the file that is read"),
        (format!("survey {} --json {}", mesh.display(), folder.path("no/out.json").display()), "make the folder first"),
    ] {
        let ran = run_on(&options, &[]);
        assert_eq!(ran.code, 2, "{options}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{options}: {}", ran.stderr);
    }
}

#[test]
fn a_survey_resumes_with_what_has_not_changed() {
    let folder = Folder::new();
    let (meshes, json) = (meshes(&folder), folder.path("out.json"));
    let survey = |options: &str| run_on(&format!("survey --json {} {options}", json.display()), &[&meshes]);
    survey("");
    let before = read(&json);
    fs::write(meshes.join("closed.obj"), fs::read(fixture("spike")).expect("read")).expect("written");
    fs::copy(fixture("letter-v"), meshes.join("new.obj")).expect("copied");
    fs::remove_file(meshes.join("damaged.obj")).expect("removed");
    let ran = survey("--resume --jobs 1");
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("resumed: 3 of 5 meshes done already"), "{}", ran.stderr);
    let after = read(&json);
    assert_eq!(names(&after), ["a.obj", "b.obj", "closed.obj", "c.obj", "new.obj"]);
    // Not merely the same figures: the same run, with its times.
    assert_eq!(after["results"][0], before["results"][0]);
    assert_eq!(after["results"][3], before["results"][4]);

    // With other settings it would be another survey, and this one lost.
    for (options, said) in [
        ("--resume --passes 1", "made with linabf.passes auto, and asked for is 1"),
        ("--resume --solver linabf", "made with solver auto, and asked for is linabf"),
    ] {
        let ran = survey(options);
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        assert!(ran.stderr.contains(said) && ran.stderr.contains("hint: go on with the settings"), "{}", ran.stderr);
        assert_eq!(read(&json), after);
    }

    fs::write(&json, "{}").expect("written");
    let ran = survey("--resume");
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("no earlier survey"), "{}", ran.stderr);
}

#[test]
fn a_log_that_was_cut_short_is_resumed_and_never_lost_unasked() {
    let folder = Folder::new();
    let (meshes, json, log) = (meshes(&folder), folder.path("out.json"), folder.path("out.json.partial"));
    let survey = |options: &str| run_on(&format!("survey --json {} {options}", json.display()), &[&meshes]);
    survey("");
    // As a survey leaves it that ends in the middle of its third line.
    let done = read(&json);
    let head = serde_json::json!({"schema": "bench-harness/3", "made_with": done["survey"]["made_with"]});
    let entries: Vec<String> = (0..3).map(|k| done["results"][k].to_string()).collect();
    let half = &entries[2][..entries[2].len() / 2];
    fs::write(&log, format!("{head}\n{}\n{}\n{half}", entries[0], entries[1])).expect("written");
    fs::remove_file(&json).expect("removed");

    let ran = survey("");
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(ran.stderr.contains("--resume") && log.exists() && !json.exists(), "{}", ran.stderr);
    let ran = survey("--resume");
    assert!(ran.stderr.contains("resumed: 2 of 5 meshes done already"), "{}", ran.stderr);
    assert!(!log.exists());
    assert_eq!(read(&json)["results"][1], done["results"][1]);
    assert_eq!(names(&read(&json)), names(&done));
}

#[cfg(target_os = "linux")]
mod interrupted {
    use super::*;
    use crate::interrupt::{MOMENT, interrupt, pipe, wait_until, wait_until_it_listens};
    use std::process::{Child, Stdio};

    /// A survey whose second mesh is a pipe, waiting there with the first one done.
    fn survey_at_the_pipe(folder: &Folder, pipe: &Path) -> Child {
        let mut command = program();
        command.args(["survey", "--jobs", "1", "--json"]).arg(folder.path("a.json"));
        command.args([&fixture("obtuse"), pipe, &fixture("roll")]);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts");
        let log = folder.path("a.json.partial");
        wait_until(|| fs::read_to_string(&log).is_ok_and(|text| text.lines().count() == 2), "the first mesh is done");
        wait_until_it_listens(&child);
        child
    }

    #[test]
    fn a_survey_that_is_cancelled_writes_what_is_done_and_resumes() {
        let folder = Folder::new();
        let (pipe, json) = (pipe(&folder), folder.path("a.json"));
        let child = survey_at_the_pipe(&folder, &pipe);
        interrupt(&child);
        std::thread::sleep(MOMENT);
        // What it waits for comes after all, but nobody wants the result any more.
        fs::copy(fixture("pyramid"), &pipe).expect("written");
        let ran = Ran::new(child.wait_with_output().expect("it ends"));
        assert_eq!(ran.code, 1, "{}", ran.stderr);
        assert!(ran.stderr.contains("cancelled: 1 of 3 meshes done"), "{}", ran.stderr);
        assert!(ran.stdout.contains("1 of 3 meshes: 1 valid"), "{}", ran.stdout);
        assert_eq!(names(&read(&json)), ["obtuse.obj"]);
        assert_eq!(folder.count(), 2, "the pipe and one whole file");

        let options = format!("survey --resume --json {}", json.display());
        let ran = run_on(&options, &[&fixture("obtuse"), &fixture("roll")]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains("resumed: 1 of 2"), "{}", ran.stderr);
        assert_eq!(names(&read(&json)), ["obtuse.obj", "roll.obj"]);
    }

    #[test]
    fn a_survey_that_is_killed_resumes_from_its_log() {
        let folder = Folder::new();
        let (pipe, json) = (pipe(&folder), folder.path("a.json"));
        let mut child = survey_at_the_pipe(&folder, &pipe);
        child.kill().expect("it runs");
        child.wait().expect("it ends");
        assert!(!json.exists());
        let options = format!("survey --resume --json {}", json.display());
        let ran = run_on(&options, &[&fixture("obtuse"), &fixture("roll")]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert!(ran.stderr.contains("resumed: 1 of 2"), "{}", ran.stderr);
    }
}
