//! Many meshes, many solvers, several runs: tables, files, baselines.

use crate::support::{Folder, Ran, fixture, run_on};
use crate::surfaces;
use serde_json::Value;
use std::path::{Path, PathBuf};

const MESHES: [&str; 3] = ["obtuse", "pyramid", "letter-v"];
const SOLVERS: [&str; 3] = ["linabf", "minres", "lscm"];
const DISTORTION: [&str; 9] =
    ["f", "f_weighted", "stretch_l2", "stretch_linf", "area_l2", "qc_max", "flips", "collapsed", "max_angle_error"];

/// Compares three solvers on three meshes, or on others.
fn compare(options: &str, meshes: &[&Path]) -> Ran {
    run_on(&format!("compare --solver {} {options}", SOLVERS.join(",")), meshes)
}

fn three_meshes() -> Vec<PathBuf> {
    MESHES.iter().map(|name| fixture(name)).collect()
}

fn refs(paths: &[PathBuf]) -> Vec<&Path> {
    paths.iter().map(PathBuf::as_path).collect()
}

fn results(file: &Path) -> Vec<Value> {
    let json: Value = serde_json::from_slice(&std::fs::read(file).expect("written")).expect("JSON");
    assert_eq!(json["schema"], "bench-harness/3");
    json["results"].as_array().expect("a list").clone()
}

/// The cells of a line of comma-separated values without quotes inside quotes.
fn cells(line: &str) -> Vec<String> {
    let parts = line.split('"').enumerate();
    let separated: String =
        parts.map(|(k, part)| if k % 2 == 0 { part.replace(',', "\t") } else { part.into() }).collect();
    separated.split('\t').map(str::to_owned).collect()
}

#[test]
fn every_mesh_and_solver_is_a_row_of_every_file_with_the_same_numbers() {
    let folder = Folder::new();
    let [json, markdown, csv] = ["a.json", "a.md", "a.csv"].map(|name| folder.path(name));
    let options = format!(
        "--warmup 1 --repeats 4 --json {} --markdown {} --csv {}",
        json.display(),
        markdown.display(),
        csv.display()
    );
    let ran = compare(&options, &refs(&three_meshes()));
    assert_eq!(ran.code, 0, "that lscm flips a triangle is a result: {}", ran.stderr);
    assert_eq!(ran.stdout.split("\n\n").count(), MESHES.len(), "a table for each mesh: {}", ran.stdout);

    let results = results(&json);
    let read = |path: &Path| std::fs::read_to_string(path).expect("written");
    let (markdown, csv) = (read(&markdown), read(&csv));
    let heads = cells(csv.lines().next().expect("a head"));
    let at = |name: &str| heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("{name}: {heads:?}"));
    assert_eq!((results.len(), csv.lines().count(), markdown.lines().count()), (9, 10, 11));
    for (k, (result, row)) in results.iter().zip(csv.lines().skip(1).map(cells)).enumerate() {
        let (mesh, solver) = (MESHES[k / 3], SOLVERS[k % 3]);
        assert!(result["mesh"].as_str().expect("text").ends_with(&format!("{mesh}.obj")), "{result}");
        assert_eq!((&result["solver"], row[at("solver")].as_str()), (&solver.into(), solver));
        for (field, name) in [("f", "f_rad2"), ("stretch_l2", "stretch_l2"), ("flips", "flips")] {
            assert_eq!(row[at(name)].parse::<f64>().ok(), result[field].as_f64(), "{mesh} {solver} {field}");
        }
        let line = markdown.lines().nth(k + 2).expect("a row");
        assert!(line.starts_with("| ") && line.contains(&format!(" | {solver} | ")), "{line}");
    }
    let is_invalid = |line: &&str| line.contains("one-pass, not valid") && line.contains("try --solver auto");
    assert_eq!(markdown.lines().filter(is_invalid).count(), 1, "{markdown}");
}

#[test]
fn times_are_medians_with_their_spread_and_repeats_give_the_same_bits() {
    let folder = Folder::new();
    let json = folder.path("a.json");
    let ran = compare(&format!("--warmup 2 --repeats 5 --json {}", json.display()), &[&fixture("pyramid")]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for result in results(&json) {
        let repeats = &result["repeats"];
        assert_eq!((&repeats["count"], &repeats["warmup"]), (&5.into(), &2.into()));
        assert_eq!(repeats["identical"], true);
        for stage in ["topology", "solve", "layout", "flatten"] {
            let [least, median, greatest] = [&repeats["min_s"], &result["timings_s"], &repeats["max_s"]]
                .map(|t| t[stage].as_f64().expect("seconds"));
            assert!(least <= median && median <= greatest, "{stage}: {result}");
        }
    }
}

#[test]
fn two_comparisons_have_identical_distortion_and_the_baseline_says_so() {
    let folder = Folder::new();
    let [old, new, csv] = ["old.json", "new.json", "new.csv"].map(|name| folder.path(name));
    let meshes = three_meshes();
    compare(&format!("--repeats 1 --json {}", old.display()), &refs(&meshes));
    let options = format!("--repeats 2 --json {} --csv {} --baseline {}", new.display(), csv.display(), old.display());
    let ran = compare(&options, &refs(&meshes));
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("9 results as they were, 0 changed, 0 new, 0 not made now"), "{}", ran.stderr);
    for (old, new) in results(&old).iter().zip(results(&new)) {
        for field in DISTORTION {
            assert_eq!(old[field], new[field], "{field}");
        }
        let change = &new["baseline"];
        assert_eq!((&change["f_ratio"], &change["stretch_l2_ratio"]), (&1.0.into(), &1.0.into()), "{new}");
        assert_eq!(change["flips_change"], 0);
        assert!(change["time_ratio"].as_f64().expect("a ratio") > 0.0);
    }
    assert!(ran.stdout.contains("F new/old"), "{}", ran.stdout);
    assert!(std::fs::read_to_string(&csv).expect("written").contains("baseline_time_ratio"));
}

#[test]
fn the_baseline_shows_what_changed_what_is_new_and_what_is_gone() {
    let folder = Folder::new();
    let [old, edited, new] = ["old.json", "edited.json", "new.json"].map(|name| folder.path(name));
    let (obtuse, pyramid, roll) = (fixture("obtuse"), fixture("pyramid"), fixture("roll"));
    compare(&format!("--repeats 1 --json {}", old.display()), &[&obtuse, &pyramid]);
    let mut json: Value = serde_json::from_slice(&std::fs::read(&old).expect("written")).expect("JSON");
    let first = &mut json["results"][0];
    first["f"] = (first["f"].as_f64().expect("a number") / 2.0).into();
    first["flips"] = 3.into();
    first["termination"] = "stalled".into();
    std::fs::write(&edited, json.to_string()).expect("written");

    let options = format!("--repeats 1 --json {} --baseline {}", new.display(), edited.display());
    let ran = compare(&options, &[&obtuse, &roll]);
    assert!(ran.stderr.contains("2 results as they were, 1 changed, 3 new, 3 not made now"), "{}", ran.stderr);
    let results = results(&new);
    let change = &results[0]["baseline"];
    assert_eq!((&change["f_ratio"], &change["flips_change"]), (&2.0.into(), &(-3).into()), "{change}");
    assert_eq!((&change["result"], &results[3]["baseline"]["result"]), (&"stalled".into(), &"new".into()));
    assert!(ran.stdout.contains("×2.000") && ran.stdout.contains("stalled"), "{}", ran.stdout);
}

#[test]
fn a_mesh_that_fails_is_a_row_with_its_reason_and_the_others_are_compared() {
    let folder = Folder::new();
    let [json, markdown] = ["a.json", "a.md"].map(|name| folder.path(name));
    let torus = folder.file("torus.obj", surfaces::torus());
    let noise = folder.file("noise.ply", "hello\n");
    let (first, last) = (fixture("pyramid"), fixture("roll"));
    let options = format!("--repeats 1 --json {} --markdown {}", json.display(), markdown.display());
    let ran = compare(&options, &[&first, &torus, &noise, &last]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    let results = results(&json);
    let kinds: Vec<Option<&str>> = results.iter().map(|result| result["error"]["kind"].as_str()).collect();
    assert_eq!(kinds, [None, None, None, Some("closed"), Some("bad-header"), None, None, None]);
    let markdown = std::fs::read_to_string(&markdown).expect("written");
    assert!(markdown.contains("cut it into charts first"), "{markdown}");
    assert!(ran.stdout.contains("error: closed") && ran.stdout.contains("error: bad-header"), "{}", ran.stdout);
}

#[test]
fn a_folder_stands_for_its_meshes_in_order() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("below")).expect("a folder");
    for (name, source) in [("c.obj", "pyramid"), ("a.obj", "roll"), ("below/b.obj", "obtuse")] {
        std::fs::copy(fixture(source), folder.path(name)).expect("copied");
    }
    folder.file("notes.txt", "no mesh");
    let json = run_on("compare --solver lscm --repeats 1 --warmup 0 --json -", &[&folder.path("")]).json();
    let meshes: Vec<&str> =
        json["results"].as_array().expect("a list").iter().map(|r| r["mesh"].as_str().expect("text")).collect();
    let expected = ["a.obj", "below/b.obj", "c.obj"];
    assert!(meshes.iter().zip(expected).all(|(mesh, end)| mesh.ends_with(end)) && meshes.len() == 3, "{meshes:?}");
}

#[test]
fn the_report_is_one_page_about_every_mesh() {
    let folder = Folder::new();
    let page = folder.path("a.html");
    let torus = folder.file("torus.obj", surfaces::torus());
    let options = format!("--repeats 1 --report {}", page.display());
    assert_eq!(compare(&options, &[&fixture("pyramid"), &torus, &fixture("obtuse")]).code, 2);
    let html = std::fs::read_to_string(&page).expect("written");
    assert!(html.starts_with("<!DOCTYPE html>"), "{html:.100}");
    for text in
        ["pyramid.obj", "torus.obj", "obtuse.obj", "minres", "preconditioner", "cut it into charts first", "not valid"]
    {
        assert!(html.contains(text), "{text}");
    }
    assert!(!html.contains("src=\"http"), "it needs no network");
}

#[test]
fn comparisons_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    let mesh = folder.file("pyramid.obj", surfaces::pyramid());
    let old = folder.file("old.json", r#"{"schema": "other"}"#);
    let broken = folder.file("broken.json", "{");
    std::fs::create_dir(folder.path("empty")).expect("a folder");
    let empty = folder.path("empty");
    for (options, mesh, part) in [
        (format!("--baseline {}", old.display()), &mesh, "is not \"bench-harness/3\"".to_owned()),
        (format!("--baseline {}", broken.display()), &mesh, "no earlier comparison".to_owned()),
        (format!("--baseline {}", folder.path("no.json").display()), &mesh, "no.json: cannot be read".to_owned()),
        (format!("--baseline {0} --json {0}", old.display()), &mesh, "would replace the file that is read".to_owned()),
        ("--json a --csv a".to_owned(), &mesh, "are the same file: a".to_owned()),
        ("--repeats 0".to_owned(), &mesh, "at least 1".to_owned()),
        (String::new(), &empty, format!("{}: there is no mesh below it", empty.display())),
        (format!("--csv {}", folder.path("missing/a.csv").display()), &mesh, "cannot be written".to_owned()),
    ] {
        let ran = compare(&options, &[mesh]);
        assert_eq!(ran.code, 2, "{options}: {}", ran.stderr);
        assert!(ran.stderr.contains(&part), "{options}: {}", ran.stderr);
    }
    assert_eq!(run_on("compare", &[]).code, 2, "it needs a mesh or a folder");
}

#[test]
fn the_histories_of_all_solvers_are_in_one_file_as_json_or_as_rows() {
    let folder = Folder::new();
    let [json, csv] = ["h.json", "h.csv"].map(|name| folder.path(name));
    for file in [&json, &csv] {
        let ran = compare(&format!("--repeats 1 --history {}", file.display()), &refs(&three_meshes()));
        assert_eq!(ran.code, 0, "{}", ran.stderr);
    }
    let read = |path: &Path| std::fs::read_to_string(path).expect("written");
    let history: Value = serde_json::from_str(&read(&json)).expect("JSON");
    let runs = history["runs"].as_array().expect("a list");
    assert_eq!(runs.len(), MESHES.len() * SOLVERS.len());
    let written = read(&csv);
    let heads = cells(written.lines().next().expect("a head"));
    let at = |name: &str| heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("{name}: {heads:?}"));
    let rows: Vec<Vec<String>> = written.lines().skip(1).map(cells).collect();
    let iterations = || {
        let of_run = |run: &Value| run["iterations"].as_array().expect("a list").clone();
        runs.iter().flat_map(move |run| of_run(run).into_iter().map(move |done| (run, done)))
    };
    assert_eq!(rows.len(), iterations().count());
    for ((run, done), row) in iterations().zip(&rows) {
        assert_eq!((&run["solver"], &done["by"]), (&row[at("solver")].as_str().into(), &row[at("by")].as_str().into()));
        assert_eq!(row[at("iteration")].parse::<u64>().ok(), done["iteration"].as_u64());
        assert_eq!(row[at("constraint_residual")].parse::<f64>().ok(), done["constraint_residual"].as_f64());
        assert!(row[at("settings")].contains("stop.tolerance=1e-8"), "{row:?}");
    }
    let page = folder.path("page.html");
    let ran = compare(&format!("--repeats 1 --lowest injective --report {}", page.display()), &refs(&three_meshes()));
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(read(&page).contains("of the injective layouts") && read(&page).contains("Against time"));
    assert_eq!(compare("--lowest injective", &refs(&three_meshes())).code, 2, "there is no page to name it on");
}
