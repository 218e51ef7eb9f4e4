//! Flattening: figures, settings, outputs, exit codes.

use crate::support::{Folder, Ran, fixture, fixtures_folder, program, run, run_on};
use crate::surfaces;
use serde_json::Value;
use std::process::Stdio;

const FIELDS: [&str; 41] = [
    "mesh",
    "triangles",
    "vertices",
    "interior_vertices",
    "boundary_loops",
    "solver",
    "settings",
    "termination",
    "valid",
    "flips",
    "collapsed",
    "near_collapsed",
    "angles_out_of_range",
    "f",
    "f_weighted",
    "stretch_l2",
    "stretch_linf",
    "area_l2",
    "max_angle_error",
    "constraint_residual",
    "iterations",
    "inner_iterations",
    "inner_residual",
    "inner_estimate",
    "negative_curvature",
    "fallbacks",
    "energy",
    "kkt",
    "inner_unconverged",
    "clamped_angles",
    "switched_rings",
    "layout",
    "closing_error",
    "notes",
    "peak_memory_bytes",
    "solved_by",
    "shapeless_faces",
    "rungs",
    "pinned",
    "scaled",
    "precision_limits",
];
const SETTINGS: [&str; 9] =
    ["solver", "zero_area", "initial_guess", "stop", "layout", "normalize", "precision", "max_memory", "threads"];
const TIMINGS: [&str; 7] = ["read", "topology", "solve", "layout", "metrics", "write", "total"];

fn assert_has(object: &Value, names: &[&str]) {
    let object = object.as_object().expect("an object");
    let missing: Vec<_> = names.iter().filter(|name| !object.contains_key(**name)).collect();
    assert!(missing.is_empty(), "missing {missing:?} in {object:?}");
}

#[test]
fn without_arguments_the_builtin_fixture_is_flattened() {
    let folder = Folder::new();
    // An installed program has no fixtures folder around it.
    let ran = Ran::new(program().current_dir(folder.path("")).output().expect("the program starts"));
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stdout.starts_with("fixtures/mask.obj (builtin)\n"), "{}", ran.stdout);
    assert!(ran.stdout.contains("yes: no flipped and no collapsed triangle"), "{}", ran.stdout);
    assert!(ran.stdout.contains("converged after"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "no words where there is nothing to say");
}

#[test]
fn the_builtin_fixture_is_the_committed_one() {
    let builtin = run(["--json", "-"]).result();
    let committed = run_on("--json -", &[&fixture("mask")]).result();
    for name in ["triangles", "vertices", "f", "stretch_l2", "stretch_linf", "constraint_residual"] {
        assert_eq!(builtin[name], committed[name], "{name}");
    }
}

#[test]
fn the_json_has_every_field_and_the_table_makes_way() {
    let ran = run_on("--json -", &[&fixture("bumpy-sheet")]);
    let result = ran.result();
    assert_has(&result, &FIELDS);
    assert_has(&result["settings"], &SETTINGS);
    assert_has(&result["timings_s"], &TIMINGS);
    assert_eq!((&result["solver"], &result["layout"]), (&"auto".into(), &"tree".into()));
    assert_eq!(result["solved_by"], "linabf");
    assert_eq!(result["settings"]["solver"]["auto"]["linabf"]["passes"], "auto");
    assert_eq!(result["valid"], true);
    assert!(ran.stderr.contains("stretch"), "the table is on stderr: {}", ran.stderr);
}

#[test]
fn timings_add_up_and_memory_is_counted_per_row() {
    let meshes = [fixture("mask"), fixture("obtuse")];
    let json = run_on("--json -", &[&meshes[0], &meshes[1]]).json();
    for result in json["results"].as_array().expect("a list") {
        let timings = &result["timings_s"];
        let parts: f64 = TIMINGS[..6].iter().map(|name| timings[name].as_f64().expect("seconds")).sum();
        assert!(parts <= timings["total"].as_f64().expect("seconds"), "{timings}");
    }
    let bytes = |k: usize| json["results"][k]["peak_memory_bytes"].as_u64().expect("bytes");
    // 20 000 triangles take megabytes, and leave nothing to the row of three.
    assert!((1_000_000..100_000_000).contains(&bytes(0)), "{}", bytes(0));
    assert!(bytes(1) < 1_000_000, "{}", bytes(1));
}

#[test]
fn one_pass_with_the_ring_switch_keeps_obtuse_valid() {
    let ran = run_on("--passes 1 --layout least-squares --json -", &[&fixture("obtuse")]);
    let result = ran.result();
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!((result["f"].as_f64().expect("a number") - 1.2670).abs() < 5e-5, "{}", result["f"]);
    // With three triangles the one pass is exact.
    assert_eq!((&result["flips"], &result["termination"]), (&0.into(), &"converged".into()));
    assert_eq!(result["settings"]["solver"]["auto"]["linabf"]["passes"], 1);
}

#[test]
fn a_flipped_triangle_gives_exit_code_1_and_an_option_to_try() {
    // Unweighted least squares depends on which corner of a triangle its equation is about; about
    // that of the largest sine, two small triangles turn over instead of the large one.
    for (options, flips, advice) in [
        ("--solver lscm", 1, "--solver auto"),
        ("--solver lscm --layout least-squares", 2, "--solver auto"),
        ("--solver linabf --passes 1 --ring-switch off --layout least-squares", 1, "--ring-switch 1"),
    ] {
        let ran = run_on(&format!("{options} --json -"), &[&fixture("obtuse")]);
        let result = ran.result();
        assert_eq!((ran.code, &result["flips"], &result["valid"]), (1, &flips.into(), &false.into()), "{options}");
        assert!(result["hint"].as_str().expect("a hint").contains(advice), "{options}: {}", result["hint"]);
        assert!(ran.stderr.contains(advice), "{options}: {}", ran.stderr);
    }
}

#[test]
fn a_result_that_is_not_converged_gives_exit_code_1_and_is_written_all_the_same() {
    let folder = Folder::new();
    let out = folder.path("out.obj");
    for (options, termination) in
        [("--solver linabf --passes 2 --tolerance 1e-300", "max-iterations"), ("--time-limit 0", "time-limit")]
    {
        let options = format!("{options} --json - -o {}", out.display());
        let ran = run_on(&options, &[&fixture("spiky-field")]);
        assert_eq!((ran.code, ran.result()["termination"].as_str()), (1, Some(termination)), "{}", ran.stderr);
        assert!(ran.stderr.contains("try "), "{}", ran.stderr);
        std::fs::remove_file(&out).expect("it was written");
    }
}

#[test]
fn what_an_obj_keeps_is_not_said_to_be_left_out_and_what_it_does_not_draw_is() {
    let folder = Folder::new();
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\ns 1\nusemtl red\no one\nf 1 2 3\nl 1 2\n";
    let out = folder.path("out.obj");
    let ran = run_on(&format!("-o {}", out.display()), &[&folder.file("a.obj", text)]);
    let not_read: Vec<&str> = ran.stderr.lines().filter(|line| line.contains("not read")).collect();
    assert!(matches!(not_read.as_slice(), [line] if line.ends_with("not read: l (1)")), "{}", ran.stderr);
    let written = std::fs::read_to_string(out).expect("written");
    assert!(["vn 0 0 1", "s 1", "usemtl red", "o one"].iter().all(|line| written.contains(line)), "{written}");
}

#[test]
fn the_colours_of_a_ply_are_kept_in_a_ply_and_said_to_be_missing_elsewhere() {
    let folder = Folder::new();
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                property float quality\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let mesh = folder.file("a.ply", format!("{head}0 0 0 1 255 0 7 9\n1 0 0 1 1 2 3 4\n0 1 0 1 0 0 0 255\n3 0 1 2\n"));
    let (ply, obj) = (folder.path("out.ply"), folder.path("out.obj"));
    let kept = run_on(&format!("-o {}", ply.display()), &[&mesh]);
    assert!(!kept.stderr.contains("colours") && kept.stderr.contains("property `quality`"), "{}", kept.stderr);
    let colours = |path: &std::path::Path| abf_mesh::io::read(path).expect("a mesh").colours;
    assert_eq!(colours(&ply).expect("kept").of_vertex(0), Some(&[255.0, 0.0, 7.0, 9.0][..]));
    assert_eq!(colours(&ply), colours(&mesh));
    let dropped = run_on(&format!("-o {}", obj.display()), &[&mesh]);
    assert!(
        dropped.stderr.contains("the colours of the vertices are not written: a ply keeps them"),
        "{}",
        dropped.stderr
    );
}

#[test]
fn lscm_has_no_angles_to_speak_of() {
    let result = run_on("--solver lscm --json -", &[&fixture("hemisphere")]).result();
    assert_eq!(result["layout"], "least-squares-weighted");
    assert_eq!(result["constraint_residual"], Value::Null);
    assert_eq!((&result["iterations"], &result["termination"]), (&0.into(), &"one-pass".into()));
}

#[test]
fn the_settings_reach_the_json() {
    let options = "--passes 3 --layout poisson --ring-switch off --angle-bound 0.01 --tolerance 1e-6 \
                   --max-iterations 7 --time-limit 90 --normalize --threads 2 --json -";
    let settings = run_on(options, &[&fixture("pyramid")]).result()["settings"].clone();
    let auto = &settings["solver"]["auto"];
    assert_eq!((&auto["linabf"]["passes"], &auto["descent"]["barrier_floor"]), (&3.into(), &1e-3.into()), "{settings}");
    assert_eq!(settings["layout"]["kind"], "poisson");
    assert_eq!(
        (&settings["initial_guess"]["ring_switch"], &settings["initial_guess"]["angle_bound"]),
        (&Value::Null, &0.01.into())
    );
    let stop = serde_json::json!({
        "tolerance": 1e-6, "step_tolerance": 1e-7, "max_iterations": 7, "time_limit": {"secs": 90, "nanos": 0}
    });
    assert_eq!(settings["stop"], stop);
    let rest = [&settings["zero_area"], &settings["normalize"], &settings["threads"]];
    assert_eq!(rest, [&Value::from("carry"), &true.into(), &2.into()]);
}

#[test]
fn the_output_keeps_every_vertex_to_the_bit_and_adds_uvs() {
    let folder = Folder::new();
    let text = "# odd numbers, an unused vertex, a polygon, normals\nvn 0 0 1\n\
                v 1e-3 +.5 -0.0\nv 1.0000000000000002 0 0\nv 9 9 9\nv 1 1 .1\nv 0 1 0.30000000000000004\nf 1 2 4 5\n";
    let mesh = folder.file("odd.obj", text);
    let out = folder.path("out.obj");
    let ran = run([mesh.as_os_str(), "-o".as_ref(), out.as_os_str()]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for note in ["1 polygon cut into 2 triangles", "1 vertex that no face uses kept"] {
        assert!(ran.stderr.contains(&format!("note: {}: {note}\n", mesh.display())), "{}", ran.stderr);
    }
    assert!(ran.stdout.contains(&out.display().to_string()), "{}", ran.stdout);
    let written = std::fs::read_to_string(&out).expect("written");
    let bits = |text: &str| -> Vec<u64> {
        let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
        lines.flat_map(str::split_whitespace).map(|x| x.parse::<f64>().expect("a number").to_bits()).collect()
    };
    assert_eq!(bits(&written), bits(text));
    assert_eq!(written.lines().filter(|line| line.starts_with("vt ")).count(), 4);
    assert_eq!(written.lines().filter(|line| line.starts_with("f ")).collect::<Vec<_>>(), ["f 1/1 2/2 4/3 5/4"]);
    assert!(written.starts_with("# odd numbers, an unused vertex, a polygon, normals\nvn 0 0 1\n"), "{written}");
    assert_eq!(folder.count(), 2, "no temporary file is left");
}

#[test]
fn the_result_is_the_same_for_any_number_of_threads() {
    let folder = Folder::new();
    let bytes = |threads: usize| {
        let out = folder.path(&format!("{threads}.obj"));
        let ran = run_on(&format!("--threads {threads} -o {}", out.display()), &[&fixture("mask-coarse")]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        std::fs::read(&out).expect("written")
    };
    assert!(bytes(1) == bytes(2) && bytes(1) == bytes(5));
}

#[test]
fn normalized_uvs_are_in_the_unit_square() {
    let folder = Folder::new();
    let out = folder.path("out.obj");
    run_on(&format!("--normalize -o {}", out.display()), &[&fixture("letter-2")]);
    let text = std::fs::read_to_string(&out).expect("written");
    let uvs = text.lines().filter_map(|line| line.strip_prefix("vt ")).flat_map(str::split_whitespace);
    assert!(uvs.map(|x| x.parse::<f64>().expect("a number")).all(|x| (0.0..=1.0).contains(&x)));
}

#[test]
fn json_and_picture_are_written_to_files() {
    let folder = Folder::new();
    let (json, png) = (folder.path("a.json"), folder.path("a.png"));
    let ran = run_on(&format!("--json {} --png {}", json.display(), png.display()), &[&fixture("letter-x")]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stdout.contains("stretch"), "the table stays on stdout: {}", ran.stdout);
    let json: Value = serde_json::from_slice(&std::fs::read(json).expect("written")).expect("JSON");
    assert_eq!(json["results"][0]["written"][0], png.display().to_string());
    assert_eq!(&std::fs::read(png).expect("written")[1..4], b"PNG");
    let svg = folder.path("a.svg");
    run_on(&format!("--svg {}", svg.display()), &[&fixture("letter-x")]);
    assert!(std::fs::read_to_string(svg).expect("written").contains("mm\""), "in millimetres");
    assert_eq!(folder.count(), 3);
}

#[test]
fn several_meshes_get_a_row_each_and_a_broken_one_does_not_stop_the_others() {
    let folder = Folder::new();
    let broken = folder.file("torus.obj", surfaces::torus());
    let good = [fixture("pyramid"), fixture("roll")];
    let ran = run_on("--disks-only", &[&good[0], &broken, &good[1]]);
    assert_eq!(ran.code, 2);
    let rows: Vec<&str> = ran.stdout.lines().collect();
    assert_eq!(rows.len(), 4, "{}", ran.stdout);
    assert!(rows[1].contains("converged") && rows[3].contains("converged"), "{}", ran.stdout);
    assert!(rows[2].contains("error: closed"), "{}", ran.stdout);
    let json = run_on("--disks-only --json -", &[&good[0], &broken, &good[1]]).json();
    let results = json["results"].as_array().expect("a list");
    assert_eq!(results.len(), 3);
    assert_eq!(results[1]["error"]["kind"], "closed");
    assert_eq!((&results[1]["triangles"], &results[1]["boundary_loops"]), (&128.into(), &0.into()));
    assert_eq!((&results[0]["valid"], &results[2]["valid"]), (&true.into(), &true.into()));
}

#[test]
fn of_several_exit_codes_the_worst_counts() {
    let meshes = [fixture("pyramid"), fixture("obtuse")];
    assert_eq!(run_on("--solver lscm", &[&meshes[0]]).code, 0);
    assert_eq!(run_on("--solver lscm", &[&meshes[0], &meshes[1]]).code, 1);
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    for arguments in [vec!["--json", "-"], vec!["--help"], vec![]] {
        let mut child = program();
        let child = child.args(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = child.spawn().expect("the program starts");
        drop(child.stdout.take());
        let ran = Ran::new(child.wait_with_output().expect("it ends"));
        assert_eq!(ran.code, 0, "{arguments:?}: {}", ran.stderr);
    }
}

#[test]
fn every_fixture_is_flattened_without_a_flip() {
    let mut files: Vec<_> =
        std::fs::read_dir(fixtures_folder()).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "obj"));
    files.sort();
    let ran = run(&files);
    assert_eq!(ran.code, 0, "{}{}", ran.stdout, ran.stderr);
    assert_eq!(ran.stdout.lines().count(), files.len() + 1);
}
