//! Meshes that are no disks become charts in an atlas.

use crate::support::{Folder, Ran, fixture, run_on};
use crate::surfaces;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn judged(file: &Path) -> Value {
    run_on("metrics --json -", &[file]).result()
}

#[test]
fn a_closed_surface_is_cut_packed_and_written() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let (out, lines) = (folder.path("out.obj"), folder.path("seams.obj"));
    let options = format!("-o {} --seam-lines {} --json -", out.display(), lines.display());
    let ran = run_on(&options, &[&torus]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let result = ran.result();
    assert_eq!((&result["valid"], &result["injective"]), (&true.into(), &true.into()));
    let atlas = &result["atlas"];
    // A coarse torus is made of developable rings.
    let charts = atlas["charts"].as_array().expect("charts");
    assert!(charts.iter().all(|chart| chart["stretch_l2"].as_f64() <= Some(1.15)), "{atlas}");
    assert!(atlas["seam_edges"].as_u64() > Some(4), "two loops that cross: {atlas}");
    let written = judged(&out);
    assert_eq!((&written["injective"], &written["f"]), (&true.into(), &result["f"]));
    let text = fs::read_to_string(lines).expect("written");
    let count = |keyword: &str| text.lines().filter(|line| line.starts_with(keyword)).count() as u64;
    assert_eq!(Some(count("l ")), atlas["seam_edges"].as_u64());
    assert!(count("v ") > 2);
}

#[test]
fn kept_seams_are_the_seams_again() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let first = folder.path("first.obj");
    let cut = run_on(&format!("-o {} --json -", first.display()), &[&torus]).result();
    let kept = run_on("--seams keep --json -", &[&first]).result();
    for figure in ["seam_edges", "seam_length"] {
        assert_eq!(kept["atlas"][figure], cut["atlas"][figure], "{figure}");
    }
    // A PLY has a UV for every corner: those of one vertex in one place are one.
    let ply = folder.path("first.ply");
    run_on(&format!("-o {} --seams auto", ply.display()), &[&torus]);
    assert_eq!(run_on("--seams keep --json -", &[&ply]).result()["atlas"]["seam_edges"], cut["atlas"]["seam_edges"]);
    let none = run_on("--seams keep", &[&torus]);
    assert_eq!(none.code, 2);
    assert!(none.stderr.contains("it has no seams to keep"), "{}", none.stderr);
}

#[test]
fn components_get_charts_and_pages_of_their_own_if_asked() {
    let folder = Folder::new();
    let two = folder.file("two.obj", surfaces::two_components());
    let pages = |options: &str| run_on(&format!("{options} --json -"), &[&two]).result()["atlas"]["pages"].clone();
    assert_eq!((pages(""), pages("--atlas per-component")), (1.into(), 2.into()));
    let tight = run_on("--resolution 2 --margin 0 --json -", &[&two]).result();
    assert_eq!(tight["injective"], true);
    let refused =
        run_on("--atlas per-material", &[&folder.file("plain.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")]);
    assert!(refused.code == 2 && refused.stderr.contains("no materials"), "{}", refused.stderr);
}

#[test]
fn what_is_broken_is_repaired_and_said_or_refused_if_strict() {
    let folder = Folder::new();
    for (text, said) in [
        (surfaces::non_manifold_edge(), "1 edge of three or more faces split"),
        (surfaces::non_manifold_vertex(), "1 vertex split"),
        (surfaces::inconsistent(), "face turned around"),
        (surfaces::moebius_band(), "one side only"),
    ] {
        let mesh = folder.file("mesh.obj", text);
        let ran = run_on("--json -", &[&mesh]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        assert_eq!(ran.result()["valid"], true);
        assert!(ran.stderr.contains(said), "{said}: {}", ran.stderr);
        let strict = run_on("--strict --json -", &[&mesh]);
        assert_eq!((strict.code, &strict.result()["error"]["kind"]), (2, &"not-clean".into()));
        assert!(strict.stderr.contains(said), "{said}: {}", strict.stderr);
    }
}

#[test]
fn a_component_without_area_does_not_cost_the_others_their_charts() {
    let folder = Folder::new();
    let stray = "v 9 9 9\nv 9 9 10\nv 9 9 11\n";
    let torus = surfaces::torus();
    let vertices = torus.lines().filter(|line| line.starts_with("v ")).count();
    let text = format!("{torus}{stray}f {} {} {}\n", vertices + 1, vertices + 2, vertices + 3);
    let ran = run_on("--json -", &[&folder.file("mesh.obj", text)]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("1 face of components without any area put into one point"), "{}", ran.stderr);
    let charts = |ran: &Ran| ran.result()["atlas"]["charts"].as_array().map(Vec::len);
    assert_eq!(charts(&ran), charts(&run_on("--json -", &[&folder.file("torus.obj", &torus)])));
}

#[test]
fn limits_and_histories_of_charts_are_said() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let late = run_on("--time-limit 0 --json -", &[&torus]);
    assert_eq!(
        (late.code, &late.result()["atlas"]["charts"][0]["termination"]),
        (1, &"time-limit".into()),
        "{}",
        late.stderr
    );
    assert!(late.result()["hint"].as_str().is_some_and(|hint| hint.contains("--time-limit")), "{}", late.stderr);
    let small = run_on("--max-memory 5K --json -", &[&torus]);
    assert_eq!((small.code, &small.result()["error"]["kind"]), (2, &"memory".into()), "{}", small.stderr);
    let history = folder.path("history.json");
    let ran = run_on(&format!("--history {}", history.display()), &[&torus]);
    assert!(ran.stderr.contains("no iterations are kept"), "{}", ran.stderr);
}

#[test]
fn charts_are_the_same_for_any_number_of_threads() {
    let folder = Folder::new();
    let two = folder.file("torus.obj", surfaces::torus());
    let written = |threads: usize| {
        let out = folder.path("out.obj");
        run_on(&format!("--threads {threads} -o {}", out.display()), &[&two]);
        fs::read(out).expect("written")
    };
    assert_eq!(written(1), written(3));
}

#[test]
fn an_obj_keeps_its_quads_materials_and_normals() {
    let folder = Folder::new();
    let text = "# a cube\nmtllib cube.mtl\no Cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                vn 0 0 -1\nvn 0 0 1\nusemtl red\nf 4//1 3//1 2//1 1//1\nusemtl blue\nf 5//2 6//2 7//2 8//2\n\
                g sides\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let (cube, out) = (folder.file("cube.obj", text), folder.path("out.obj"));
    let ran = run_on(&format!("-o {} --json -", out.display()), &[&cube]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let written = fs::read_to_string(&out).expect("written");
    for line in ["# a cube", "mtllib cube.mtl", "o Cube", "usemtl red", "usemtl blue", "g sides", "vn 0 0 -1"] {
        assert!(written.lines().any(|l| l == line), "{line}: {written}");
    }
    let faces: Vec<&str> = written.lines().filter(|line| line.starts_with("f ")).collect();
    assert!(faces.iter().all(|face| face.split(' ').count() == 5), "no seam crosses a quad: {written}");
    assert_eq!(faces.len(), 6);
    assert_eq!(judged(&out)["injective"], true);
    let sides = run_on("--seams file --json -", &[&cube]).result();
    assert_eq!(sides["valid"], true);
    assert!(sides["atlas"]["charts"].as_array().map(Vec::len) >= Some(3), "{}", sides["atlas"]);
}

#[test]
fn comments_of_a_plain_obj_are_kept_and_another_format_says_what_stays_behind() {
    let folder = Folder::new();
    let text = "# mine\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n# faces\nf 1 2 3\nf 2 4 3 # last\n";
    let (mesh, out) = (folder.file("mesh.obj", text), folder.path("out.obj"));
    assert_eq!(run_on(&format!("-o {}", out.display()), &[&mesh]).code, 0);
    let written = fs::read_to_string(&out).expect("written");
    assert!(["# mine", "# faces", "# last"].iter().all(|comment| written.contains(comment)), "{written}");
    let normals = folder.file("normals.obj", format!("vn 0 0 1\n{text}"));
    let ran = run_on(&format!("-o {}", folder.path("out.glb").display()), &[&normals]);
    assert!(ran.stderr.contains("only vertices, faces and UVs are written"), "{}", ran.stderr);
    let far = folder.file("far.obj", "v 4e7 0 0\nv 40000000.5 0 0\nv 4e7 0.5 0\nf 1 2 3\n");
    let ran = run_on(&format!("-o {}", folder.path("far.glb").display()), &[&far]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stdout.contains("1 triangle loses its area or a corner in the 32-bit numbers"), "{}", ran.stdout);
}

#[test]
fn a_gltf_goes_in_and_comes_out_with_uvs() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let (plain, out, remap) = (folder.path("plain.glb"), folder.path("out.glb"), folder.path("remap.json"));
    assert_eq!(run_on(&format!("-o {}", plain.display()), &[&torus]).code, 0);
    let options = format!("-o {} --overwrite --remap {} --json -", out.display(), remap.display());
    let ran = run_on(&options, &[&plain]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    assert!(ran.stderr.contains("the UVs are TEXCOORD_0"), "{}", ran.stderr);
    let result = ran.result();
    assert_eq!((&result["injective"], &result["uv_precision"]), (&true.into(), &"single".into()));
    let written = judged(&out);
    assert_eq!((&written["injective"], &written["f"]), (&true.into(), &result["f"]));
    let remap: Value = serde_json::from_slice(&fs::read(remap).expect("written")).expect("JSON");
    assert!(remap["primitives"][0]["vertices"].as_array().map(Vec::len) > Some(20), "{remap}");
    let second = run_on(&format!("-o {}", out.display()), &[&plain]);
    assert!(second.stderr.contains("the UVs are TEXCOORD_1"), "{}", second.stderr);
}

#[test]
fn a_disk_is_one_chart_in_the_unit_square_when_charts_are_asked_for() {
    let asked = run_on("--margin 8 --json -", &[&fixture("roll")]).result();
    assert_eq!((&asked["atlas"]["seam_edges"], &asked["valid"]), (&0.into(), &true.into()));
    assert!(asked["uv_area"].as_f64() < Some(1.0));
    let not_asked = run_on("--json -", &[&fixture("roll")]).result();
    assert!(not_asked.get("atlas").is_none());
}

#[test]
fn options_that_contradict_each_other_or_are_out_of_range_are_named() {
    for (options, part) in [
        ("--disks-only --seams auto", "--disks-only makes no charts"),
        ("--disks-only -o out.glb", "a glTF takes an atlas"),
        ("--remap r.json", "--remap concerns a glTF"),
        ("--overwrite", "--overwrite concerns a glTF"),
        ("--max-stretch 0.5", "--max-stretch must be at least 1, got 0.5"),
        ("--resolution 64 --margin 32", "--margin must be at most a quarter of --resolution 64, got 32"),
        ("--seam-lines seams.txt", "must end in .obj"),
    ] {
        let ran = run_on(options, &[&fixture("pyramid")]);
        assert_eq!(ran.code, 2, "{options}");
        assert!(ran.stderr.contains(part), "{options}: {}", ran.stderr);
    }
}

#[test]
fn what_was_repaired_is_said_once_of_one_mesh_and_beside_its_row_of_several() {
    let folder = Folder::new();
    let twice = folder.file("twice.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\nf 1 2 3\n");
    let said = |ran: &Ran| ran.stdout.matches("on another").count() + ran.stderr.matches("on another").count();
    let one = run_on("", &[&twice]);
    assert_eq!(said(&one), 1, "{}{}", one.stdout, one.stderr);
    let several = run_on("", &[&twice, &fixture("pyramid")]);
    assert_eq!(said(&several), 1, "{}{}", several.stdout, several.stderr);
}
