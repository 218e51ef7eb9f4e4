//! Judging UVs that files already have.

use crate::support::{Folder, fixture, run, run_on};
use crate::surfaces;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Everything that judging says about the mesh and its UVs.
const JUDGED: [&str; 20] = [
    "triangles",
    "vertices",
    "interior_vertices",
    "boundary_loops",
    "valid",
    "flips",
    "collapsed",
    "near_collapsed",
    "wound",
    "injective",
    "overlaps",
    "touches",
    "uv_angle_min",
    "uv_angle_max",
    "uv_precision",
    "f",
    "f_weighted",
    "stretch_l2",
    "stretch_linf",
    "area_l2",
];

/// A square cut into four triangles around a centre, which is put somewhere.
fn square_around(centre: &str) -> String {
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    format!("{vertices}vt {centre}\nf 1/1 2/2 5/5\nf 2/2 3/3 5/5\nf 3/3 4/4 5/5\nf 4/4 1/1 5/5\n")
}

/// A grid of 4 × 3 squares that is bent, with a back that is the same faces turned around, and one face of the front turned.
fn leaf() -> String {
    let points: Vec<[f64; 3]> =
        (0..20).map(|i| [f64::from(i % 5), f64::from(i / 5), 0.1 * f64::from(i % 5).powi(2)]).collect();
    let square = |i: usize| {
        let a = i / 4 * 5 + i % 4;
        [[a, a + 1, a + 6], [a, a + 6, a + 5]]
    };
    let mut faces: Vec<[usize; 3]> = (0..12).flat_map(square).collect();
    faces.extend(faces.clone().into_iter().map(|[a, b, c]| [c, b, a]));
    faces[4].swap(1, 2);
    surfaces::obj(&points, &faces)
}

/// What `metrics` says of the file that a run wrote, beside what the run said.
fn run_and_judge(input: &Path, options: &str, folder: &Folder) -> (Value, Value) {
    let out = folder.path("out.obj");
    let of_run = run_on(&format!("--json - {options} -o {}", out.display()), &[input]).result();
    let of_file = run_on("metrics --json -", &[&out]).result();
    (of_run, of_file)
}

/// The figures that do not need a manifold.
fn assert_same_judgement(name: &str, of_run: &Value, of_file: &Value) {
    let of_uvs = JUDGED.iter().filter(|field| !["interior_vertices", "boundary_loops"].contains(field));
    for field in of_uvs.chain(&["turned", "shared", "overlapping_faces"]) {
        assert_eq!(of_file[field], of_run[field], "{name}: {field}");
    }
}

#[test]
fn the_sides_of_a_leaf_have_texels_of_their_own_or_share_them_and_the_file_says_the_same() {
    let folder = Folder::new();
    let leaf = folder.file("leaf.obj", leaf());
    for (options, shared) in [("", 0), ("--double-sided shared", 24)] {
        let (of_run, of_file) = run_and_judge(&leaf, options, &folder);
        assert_same_judgement(options, &of_run, &of_file);
        assert_eq!((&of_file["shared"], &of_file["turned"]), (&shared.into(), &1.into()), "{options}");
        assert_eq!(of_file["injective"], true, "{options}");
    }
    // As the file has them, the sides that share lie on each other.
    let out = folder.path("out.obj");
    let as_stored = run_on("metrics --as-stored --json -", &[&out]).result();
    assert_eq!((&as_stored["injective"], &as_stored["shared"]), (&false.into(), &0.into()));
}

#[test]
#[allow(clippy::print_stdout, reason = "what is skipped is said")]
fn what_a_run_says_of_double_sided_and_one_sided_models_is_what_the_file_says() {
    let Some(models) = std::env::var_os("ABF_MODELS").map(PathBuf::from) else {
        println!("ABF_MODELS is not set: 3 models skipped");
        return;
    };
    for file in ["../cases/doublesided.obj", "../assets/chair.obj", "raw/gc-moebius.obj"] {
        let input = models.join(file);
        if !input.exists() {
            println!("{} is not there: skipped", input.display());
            continue;
        }
        let folder = Folder::new();
        for options in ["--double-sided own", "--double-sided shared"] {
            let (of_run, of_file) = run_and_judge(&input, options, &folder);
            assert_same_judgement(&format!("{file} {options}"), &of_run, &of_file);
            assert_eq!(of_file["injective"], true, "{file} {options}");
        }
    }
}

#[test]
fn what_was_written_is_judged_as_the_run_judged_it() {
    let folder = Folder::new();
    for (name, out) in [("mask", "out.obj"), ("spiky-field", "out.ply"), ("obtuse", "flipped.obj")] {
        let out = folder.path(out);
        let options = if name == "obtuse" { "--solver lscm" } else { "" };
        let run_code = run_on(
            &format!("{options} --json {} -o {}", folder.path("run.json").display(), out.display()),
            &[&fixture(name)],
        )
        .code;
        let text = std::fs::read_to_string(folder.path("run.json")).expect("written");
        let of_run: Value = serde_json::from_str(&text).expect("JSON");
        let judged = run_on("metrics --json -", &[&out]);
        assert_eq!(judged.code, run_code, "{name}");
        let judged = judged.result();
        for field in
            JUDGED.iter().chain(&["max_angle_error", "qc_max", "flipped_faces", "collapsed_faces", "overlapping_faces"])
        {
            assert_eq!(judged[field], of_run["results"][0][field], "{name}: {field}");
        }
    }
}

#[test]
fn good_uvs_of_a_foreign_file_are_valid_and_have_no_solver() {
    let folder = Folder::new();
    let ran = run_on("metrics --json -", &[&folder.file("square.obj", square_around(".5 .5"))]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let result = ran.result();
    assert!(JUDGED.iter().all(|field| !result[field].is_null()), "{result}");
    assert!(result["f"].as_f64().expect("a number") < 1e-30);
    assert!(["solver", "settings", "termination", "error"].iter().all(|field| result.get(field).is_none()), "{result}");
}

#[test]
fn a_flipped_triangle_is_found_by_hand() {
    let folder = Folder::new();
    let ran = run_on("metrics --json -", &[&folder.file("square.obj", square_around(".5 -.1"))]);
    let result = ran.result();
    assert_eq!((ran.code, &result["flips"], &result["collapsed"]), (1, &1.into(), &0.into()));
    assert_eq!((&result["valid"], &result["flipped_faces"]), (&false.into(), &serde_json::json!([0])));
}

#[test]
fn a_collapsed_triangle_is_found_and_infinity_is_null() {
    let folder = Folder::new();
    let mesh = folder.file("square.obj", square_around(".5 0"));
    let ran = run_on("metrics --json -", &[&mesh]);
    let result = ran.result();
    assert_eq!((ran.code, &result["flips"], &result["collapsed"]), (1, &0.into(), &1.into()));
    assert_eq!(result["stretch_l2"], Value::Null);
    let table = run_on("metrics", &[&mesh]).stdout;
    assert!(table.contains("no: 0 flipped, 1 collapsed (triangles 0, counted from 0)"), "{table}");
    assert!(table.contains("stretch      L2 infinite"), "{table}");
}

#[test]
fn a_chart_pushed_over_another_by_hand_is_an_overlap_and_still_valid() {
    let folder = Folder::new();
    // Two triangles apart, and the second pushed over the first, into it, and around it.
    let text = |second: &str| {
        let vertices = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 9\nv 1 0 9\nv 0 1 9\n";
        format!("{vertices}vt 0 0\nvt 4 0\nvt 0 4\n{second}f 1/1 2/2 3/3\nf 4/4 5/5 6/6\n")
    };
    for (name, second, counts) in [
        ("apart.obj", "vt 8 0\nvt 9 0\nvt 8 1\n", [0, 0, 0, 0]),
        ("across.obj", "vt -1 1\nvt 2 1\nvt -1 2\n", [2, 0, 0, 0]),
        ("into.obj", "vt 1 1\nvt 2 1\nvt 1 2\n", [0, 0, 1, 0]),
        ("around.obj", "vt -9 -9\nvt 30 -9\nvt -9 30\n", [0, 0, 1, 0]),
        ("onto.obj", "vt 0 0\nvt 4 0\nvt 0 4\n", [0, 3, 0, 0]),
        ("beside.obj", "vt 4 0\nvt 4 4\nvt 0 4\n", [0, 0, 0, 2]),
    ] {
        let mesh = folder.file(name, text(second));
        let ran = run_on("metrics --json -", &[&mesh]);
        let result = ran.result();
        let found =
            ["crossings", "meetings", "nested", "touches"].map(|field| result[field].as_u64().expect("a count"));
        assert_eq!((ran.code, &result["valid"], found), (0, &true.into(), counts), "{name}: {}", ran.stderr);
        let overlaps = counts[..3].iter().sum::<u64>();
        assert_eq!((&result["overlaps"], &result["injective"]), (&overlaps.into(), &(overlaps == 0).into()), "{name}");
        assert_eq!(ran.stderr.contains("triangles 0 and 1 (counted from 0)"), overlaps > 0, "{name}: {}", ran.stderr);
        let table = run_on("metrics", &[&mesh]).stdout;
        let said = if overlaps > 0 { "(triangles 0 over 1" } else { "injective    yes: no overlap" };
        assert!(table.contains(said), "{name}: {table}");
    }
}

#[test]
fn a_vertex_wound_around_twice_by_hand_makes_a_map_that_is_not_valid_without_a_flip() {
    let folder = Folder::new();
    let mut text = "v 0 0 0\nvt 0 0\n".to_owned();
    for k in 0..6 {
        let (rim, twice) = (f64::from(k) * 60_f64.to_radians(), f64::from(k) * 120_f64.to_radians());
        text += &format!("v {} {} 0\nvt {} {}\n", rim.cos(), rim.sin(), twice.cos(), twice.sin());
        let (a, b) = (k + 2, (k + 1) % 6 + 2);
        text += &format!("f 1/1 {a}/{a} {b}/{b}\n");
    }
    let mesh = folder.file("screw.obj", text);
    let ran = run_on("metrics --json -", &[&mesh]);
    let result = ran.result();
    assert_eq!((ran.code, &result["flips"], &result["wound"]), (1, &0.into(), &1.into()));
    assert_eq!((&result["valid"], &result["wound_vertices"]), (&false.into(), &serde_json::json!([0])));
    let table = run_on("metrics", &[&mesh]).stdout;
    assert!(table.contains("no: 0 flipped, 0 collapsed, 1 wound around twice (vertices 0, counted from 0)"), "{table}");
}

#[test]
fn a_mesh_that_is_no_manifold_can_be_judged() {
    let folder = Folder::new();
    let text = format!("{}v .5 .5 1\nvt 7 7\nf 1/1 2/2 6/6\n", square_around(".5 .5"));
    let ran = run_on("metrics --json -", &[&folder.file("fin.obj", text)]);
    let result = ran.result();
    assert_eq!((&result["interior_vertices"], &result["triangles"]), (&Value::Null, &5.into()), "{}", ran.stderr);
}

#[test]
fn a_file_without_uvs_is_a_named_error_and_the_others_are_judged() {
    let folder = Folder::new();
    let bare = folder.file("bare.obj", surfaces::pyramid());
    let good = folder.file("square.obj", square_around(".5 .5"));
    let gaps = folder.file("gaps.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3\n");
    let missing = folder.path("missing.obj");
    let ran = run_on("metrics --json -", &[&bare, &good, &gaps, &missing]);
    assert_eq!(ran.code, 2);
    let json = ran.json();
    let kinds: Vec<&Value> = (0..4).map(|k| &json["results"][k]["error"]["kind"]).collect();
    assert_eq!(kinds, [&"no-uv".into(), &Value::Null, &"no-uv".into(), &"not-found".into()]);
    assert!(json["results"][2]["error"]["message"].as_str().expect("text").contains("1 corner has none"), "{json}");
    assert_eq!(json["results"][1]["valid"], true);
    let table = run_on("metrics", &[&bare, &good]).stdout;
    assert!(!table.contains("passes") && table.contains("error: no-uv"), "{table}");
}

#[test]
fn metrics_needs_a_file() {
    let ran = run(["metrics"]);
    assert_eq!((ran.code, ran.stdout.as_str()), (2, ""));
    assert!(ran.stderr.contains("<FILE>"), "{}", ran.stderr);
}

#[test]
fn uvs_are_certified_with_the_bits_that_the_file_stores() {
    let folder = Folder::new();
    // Its third UV is beside the line of the other two by less than a single can tell.
    let ply = |kind: &str| {
        let properties: String = ["x", "y", "z"].iter().map(|name| format!("property double {name}\n")).collect();
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\n{properties}property {kind} u\nproperty {kind} v\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0 1\n1 0 0 1 1\n0 1 0 0.5 1.00000001\n3 0 1 2\n"
        )
    };
    for (kind, precision, code, collapsed) in [("double", "double", 0, 0), ("float", "single", 1, 1)] {
        let ran = run_on("metrics --json -", &[&folder.file("a.ply", ply(kind))]);
        let result = ran.result();
        assert_eq!((ran.code, &result["uv_precision"]), (code, &precision.into()), "{kind}: {}", ran.stderr);
        assert_eq!(result["collapsed"], collapsed, "{kind}");
    }
    let ran = run_on("metrics", &[&folder.file("a.ply", ply("float"))]);
    assert!(ran.stdout.contains("single"), "{}", ran.stdout);
}

#[test]
fn a_folder_is_refused_with_the_commands_that_take_one() {
    let folder = Folder::new();
    let folder = folder.path("");
    for command in ["metrics", ""] {
        let ran = run_on(command, &[&folder]);
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        assert!(ran.stderr.contains("survey DIR") && ran.stderr.contains("compare DIR"), "{}", ran.stderr);
    }
}

#[test]
fn a_gltf_is_judged_by_the_uvs_that_were_written_last_or_by_those_asked_for() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let (first, second, packed) = (folder.path("a.glb"), folder.path("b.glb"), folder.path("c.glb"));
    assert_eq!(run_on(&format!("--max-stretch 2 -o {}", first.display()), &[&torus]).code, 0);
    let of_run = run_on(&format!("--json - -o {}", second.display()), &[&first]).result();
    let of_file = run_on("metrics --json -", &[&second]).result();
    assert_same_judgement("the second set", &of_run, &of_file);
    let of_first = run_on("metrics --json -", &[&first]).result();
    assert_ne!(of_first["f"], of_file["f"]);
    assert_same_judgement("the first set", &of_first, &run_on("metrics --uv-set 0 --json -", &[&second]).result());
    // Packing takes the same UVs, and puts them where they were.
    let of_pack = run_on(&format!("pack --margin 5 --json - -o {}", packed.display()), &[&second]).result();
    assert!(of_pack["notes"].to_string().contains("the UVs are TEXCOORD_1"), "{}", of_pack["notes"]);
    assert_same_judgement("packed", &of_pack, &run_on("metrics --json -", &[&packed]).result());
    assert_same_judgement("kept", &of_first, &run_on("metrics --uv-set 0 --json -", &[&packed]).result());
    let missing = run_on("metrics --uv-set 7", &[&second]);
    assert_eq!(missing.code, 2);
    assert!(missing.stderr.contains("TEXCOORD_7") && missing.stderr.contains("take --uv-set 0"), "{}", missing.stderr);
    let of_obj = run_on("metrics --uv-set 0", &[&torus]);
    assert!(of_obj.code == 2 && of_obj.stderr.contains("--uv-set 0 concerns a glTF"), "{}", of_obj.stderr);
}

/// A bent grid of 6 × 6 squares with sides of `side` beginning at `begin`.
fn grid(begin: f64, side: f64) -> String {
    let point = |i: usize| {
        let (x, y) = ((i % 7) as f64, (i / 7) as f64);
        [begin + side * x, begin + side * y, side * 0.1 * (x - 3.0).powi(2)]
    };
    let square = |i: usize| {
        let a = i / 6 * 7 + i % 6;
        [[a, a + 1, a + 8], [a, a + 8, a + 7]]
    };
    surfaces::obj(&(0..49).map(point).collect::<Vec<_>>(), &(0..36).flat_map(square).collect::<Vec<_>>())
}

#[test]
fn what_32_bits_make_of_a_mesh_is_judged_and_triangles_that_they_lose_are_told() {
    let folder = Folder::new();
    let out = folder.path("out.glb");
    // Coordinates near a million have steps of a sixteenth.
    for (begin, side, code, lost) in
        [(0.0, 0.1, 0, false), (1e6, 0.2, 0, false), (1e6, 0.01, 1, true), (0.0, 1e-50, 1, true)]
    {
        let mesh = folder.file("grid.obj", grid(begin, side));
        let ran = run_on(&format!("--json - -o {}", out.display()), &[&mesh]);
        assert_eq!(ran.code, code, "{begin} {side}: {}", ran.stderr);
        let of_run = ran.result();
        assert_eq!(of_run["lost"].as_u64().expect("a number") > 0, lost, "{begin} {side}");
        if lost {
            let hint = of_run["hint"].as_str().expect("a hint");
            assert!(hint.contains("32-bit numbers of glTF: try an obj or ply"), "{hint}");
        }
        let of_file = run_on("metrics --json -", &[&out]);
        let judged = of_file.result();
        match of_file.code {
            2 => assert_eq!(of_run["lost"], 72),
            // Vertices in one place are one there.
            _ if lost => assert_eq!((&of_run["valid"], &of_run["f"]), (&judged["valid"], &judged["f"])),
            _ => assert_same_judgement("in 32 bits", &of_run, &judged),
        }
    }
    let huge = folder.file("huge.obj", grid(0.0, 1e39));
    let ran = run_on(&format!("-o {}", out.display()), &[&huge]);
    assert!(ran.code == 2 && ran.stderr.contains("write an obj or ply, which hold doubles"), "{}", ran.stderr);
}

#[test]
fn a_page_that_is_no_square_is_judged_in_texels_if_its_size_is_told() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let (of_run, _) = run_and_judge(&torus, "--page 1024x256", &folder);
    let out = folder.path("out.obj");
    let of_page = |options: &str| run_on(&format!("metrics --json - {options}"), &[&out]).result();
    for options in ["--page 1024x256", "--page 4x1", "--page 1024x256 --as-stored"] {
        assert_same_judgement(options, &of_run, &of_page(options));
    }
    assert_ne!(of_page("")["f"], of_run["f"]);
    let ran = run_on("metrics --page 0x4", &[&out]);
    assert!(ran.code == 2 && ran.stderr.contains("must be in 1..=65536, got 0x4"), "{}", ran.stderr);
}
