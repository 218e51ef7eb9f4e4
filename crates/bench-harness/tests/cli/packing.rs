//! Pages, and what is said of charts on them.

use crate::support::{Folder, run_on};
use crate::surfaces;

/// A flat U of two by one, its legs a hundredth apart.
const U: &str = "\
v 0 0 0\nv 2 0 0\nv 0 0.2 0\nv 0.995 0.2 0\nv 1.005 0.2 0\nv 2 0.2 0\nv 0 1 0\nv 0.995 1 0\nv 1.005 1 0\nv 2 1 0
f 1 4 3\nf 1 5 4\nf 1 2 5\nf 2 6 5\nf 3 4 8\nf 3 8 7\nf 5 6 10\nf 5 10 9\n";

#[test]
fn a_page_of_another_shape_is_measured_in_texels() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    let on = |options: &str| run_on(&format!("{options} --json -"), &[&torus]).result();
    let (square, wide) = (on("--page 512x512"), on("--page 1024x512"));
    assert_eq!(wide["atlas"]["page"], serde_json::json!([1024, 512]));
    assert_eq!(wide["injective"], true);
    let figure = |result: &serde_json::Value, name: &str| result[name].as_f64().expect("a number");
    for name in ["stretch_l2", "f", "qc_max"] {
        let (a, b) = (figure(&square, name), figure(&wide, name));
        assert!((a - b).abs() <= 1e-3 * b.abs() + 1e-9, "{name}: {a} {b}");
    }
    // The area counts the longer side as 1.
    let covered = figure(&wide["atlas"], "coverage");
    assert!((figure(&wide, "uv_area") / 0.5 - covered).abs() < 1e-9 && covered > 0.1, "{covered}");
    for (options, part) in [
        ("--page 2048", "must be WIDTHxHEIGHT in texels, as 2048x1024, got '2048'"),
        ("--page 0x64", "the sides of --page must be in 1..=65536, got 0x64"),
        ("--page 256x64 --margin 17", "at most a quarter of the shorter side of --page 256x64, got 17"),
        ("--page 64x64 --resolution 64", "cannot be used with"),
        ("--page 4096x16 --margin 0", "page aspect"),
        ("--margin wide", "must be a number of texels or auto, got 'wide'"),
        ("--margin 3 --mip-levels 2", "--mip-levels 2 sets the margin: leave out --margin 3, or it"),
        ("--mip-levels 8", "--mip-levels 8 needs a margin of 512 texels"),
        ("--mip-levels 99", "--mip-levels 99 needs a margin of 4294967295 texels"),
    ] {
        let ran = run_on(options, &[&torus]);
        assert!(ran.code == 2 && ran.stderr.contains(part), "{options}: {}", ran.stderr);
    }
}

#[test]
fn the_margin_follows_the_mip_levels_asked_for() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    for (options, margin) in [("--margin auto", 2), ("--mip-levels 0", 2), ("--margin auto --mip-levels 3", 16)] {
        let result = run_on(&format!("{options} --json -"), &[&torus]).result();
        assert_eq!(result["atlas"]["margin"], margin, "{options}");
    }
}

#[test]
fn places_narrower_than_the_margin_are_counted() {
    let folder = Folder::new();
    let mesh = folder.file("u.obj", U);
    let ran = run_on("--resolution 64 --json -", &[&mesh]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let atlas = &ran.result()["atlas"];
    let narrow = &atlas["narrow"];
    assert_eq!((&narrow["places"], &narrow["charts"]), (&1.into(), &1.into()), "{atlas}");
    let expected = 0.01 * atlas["texels_per_unit"].as_f64().expect("a number");
    let least = narrow["least"].as_f64().expect("a number");
    assert!((least / expected - 1.0).abs() < 1e-6, "{least} {expected}");
    assert!(
        run_on("--resolution 64", &[&mesh]).stdout.contains("1 place of 1 chart nearer to themselves than the margin")
    );
    let wide = run_on("--resolution 64 --margin 0 --json -", &[&mesh]).result();
    assert_eq!(wide["atlas"]["narrow"], serde_json::json!({"places": 0, "charts": 0}));
}

/// Two squares in space whose UVs are far apart and small, with more in the file than the mesh.
const SQUARES: &str = "\
# a comment
mtllib wood.mtl
v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5
vt 0 0\nvt 0.1 0\nvt 0.1 0.1\nvt 0 0.1\nvt 0.9 0.9\nvt 0.9 1\nvt 0.8 1\nvt 0.8 0.9
vn 0 0 1
g lower\nusemtl wood
f 1/1/1 2/2/1 3/3/1 4/4/1
g upper\nusemtl iron
f 5/5/1 6/6/1 7/7/1 8/8/1
";

#[test]
fn islands_are_packed_anew_and_everything_else_in_the_file_stays() {
    let folder = Folder::new();
    let (mesh, out) = (folder.file("in.obj", SQUARES), folder.path("out.obj"));
    let ran = run_on(&format!("pack --resolution 256 -o {} --json -", out.display()), &[&mesh]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let result = ran.result();
    let repacked = &result["repacked"];
    assert_eq!((&repacked["islands"], &repacked["pieces"], &repacked["stacked"]), (&2.into(), &2.into(), &0.into()));
    assert!(repacked["coverage"].as_f64() > Some(0.45), "{repacked}");
    let text = std::fs::read_to_string(&out).expect("written");
    let others = |text: &str| {
        let lines = text.lines().filter(|line| !line.starts_with("vt ") && !line.starts_with("f "));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(others(&text), others(SQUARES));
    let judged = run_on("metrics --json -", &[&out]).result();
    assert_eq!((&judged["injective"], &judged["charts"]), (&true.into(), &2.into()));
    assert_eq!(judged["uv_area"], result["uv_area"]);

    let stacked = run_on("pack --stack --json -", &[&mesh]);
    let repacked = &stacked.result()["repacked"];
    assert_eq!((&repacked["pieces"], &repacked["stacked"]), (&1.into(), &1.into()));
    assert!(repacked["coverage"].as_f64() > Some(0.98), "{repacked}");
    assert!(run_on("pack --stack", &[&mesh]).stdout.contains("1 upon others of their shape, each shape judged once"));
    let pages = run_on("pack --stack --atlas per-material --json -", &[&mesh]).result();
    assert_eq!(pages["repacked"]["page_of_island"], serde_json::json!([0, 1]));
    // With the side of its page an island keeps its size.
    let kept = run_on("pack --texels-per-unit 1024 --json -", &[&mesh]).result();
    assert!((kept["uv_area"].as_f64().expect("a number") - 0.02).abs() < 1e-9, "{kept}");
}

#[test]
fn a_gltf_and_a_ply_are_packed_anew() {
    let folder = Folder::new();
    let torus = folder.file("torus.obj", surfaces::torus());
    for extension in ["glb", "ply"] {
        let (first, again) = (folder.path(&format!("first.{extension}")), folder.path(&format!("again.{extension}")));
        assert_eq!(run_on(&format!("-o {}", first.display()), &[&torus]).code, 0);
        let ran = run_on(&format!("pack --page 1024x512 --margin 4 -o {} --json -", again.display()), &[&first]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        let [before, after] = [&first, &again].map(|file| run_on("metrics --json -", &[file]).result());
        for figure in ["triangles", "vertices", "charts", "injective", "surface_area"] {
            assert_eq!(before[figure], after[figure], "{extension}: {figure}");
        }
        // In texels, as it was; in UVs of a page twice as wide as high it is not.
        let [was, is] = [&before, &ran.result()].map(|result| result["stretch_l2"].as_f64().expect("a number"));
        assert!((was - is).abs() < 1e-3, "{extension}: {was} {is}");
    }
}

#[test]
fn help_of_pack_speaks_of_islands() {
    let help = run_on("pack --help", &[]).stdout;
    assert!(help.contains("Islands:") && help.contains("Texels per unit of the UVs as they are"), "{help}");
    assert!(!help.contains("Charts:") && !help.contains("charts"), "{help}");
    assert!(run_on("--help", &[]).stdout.contains("Texels per unit of the mesh"));
}

#[test]
fn overlapping_islands_stay_together_and_stretched_ones_keep_their_shape() {
    let folder = Folder::new();
    // The second square lies over the first, and is twice as long as wide.
    let text = SQUARES
        .replace("vt 0.9 0.9\nvt 0.9 1\nvt 0.8 1\nvt 0.8 0.9\n", "vt 0.05 0\nvt 0.25 0\nvt 0.25 0.1\nvt 0.05 0.1\n");
    let (mesh, out) = (folder.file("in.obj", &text), folder.path("out.obj"));
    let ran = run_on(&format!("pack -o {} --json -", out.display()), &[&mesh]);
    let repacked = ran.result()["repacked"].clone();
    assert_eq!(
        (&repacked["islands"], &repacked["pieces"], &repacked["overlapping"]),
        (&2.into(), &1.into(), &2.into())
    );
    assert!(ran.stderr.contains("overlap") || ran.result()["overlaps"].as_u64() > Some(0), "{}", ran.stderr);
    let corners: Vec<[f64; 2]> = std::fs::read_to_string(&out)
        .expect("written")
        .lines()
        .filter_map(|line| line.strip_prefix("vt "))
        .map(|line| line.split(' ').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>())
        .map(|pair| [pair[0], pair[1]])
        .collect();
    let length = |a: usize, b: usize| (corners[a][0] - corners[b][0]).hypot(corners[a][1] - corners[b][1]);
    let (square, stretched) = (length(0, 1), [length(4, 5), length(5, 6)]);
    assert!((length(1, 2) / square - 1.0).abs() < 1e-9);
    assert!((stretched[0] / square - 2.0).abs() < 1e-9 && (stretched[1] / square - 1.0).abs() < 1e-9, "{corners:?}");
    // Where they lie over each other, they do so as before.
    assert!((length(0, 4) / square - 0.5).abs() < 1e-9, "{corners:?}");
}

#[test]
fn what_cannot_be_packed_anew_is_refused_with_the_next_step() {
    let folder = Folder::new();
    let bare = folder.file("bare.obj", surfaces::torus());
    let nan = folder.file("nan.obj", SQUARES.replace("vt 0.9 1\n", "vt nan 1\n"));
    let mesh = folder.file("in.obj", SQUARES);
    for (options, file, kind, said) in [
        ("", &bare, "no-uv", "and pack what that writes"),
        ("", &nan, "no-uv", "1 of them is not finite"),
        ("--texels-per-unit 20000", &mesh, "chart-too-large", "only at"),
        ("--resolution 64 --texels-per-unit 500", &mesh, "too-many-pages", "more --max-pages"),
        ("--resolution 8 --texels-per-unit 60", &mesh, "chart-too-large", "a larger --resolution or --page"),
    ] {
        let ran = run_on(&format!("pack {options} --json -"), &[file]);
        assert_eq!((ran.code, &ran.result()["error"]["kind"]), (2, &kind.into()), "{options}: {}", ran.stderr);
        assert!(ran.stderr.contains(said), "{options}: {}", ran.stderr);
    }
    for (options, said) in [
        ("--resolution 6 --margin 3", "--margin must be at most a quarter of --resolution 6, got 3"),
        ("--remap r.json", "--remap concerns a glTF"),
        ("--max-pages 0", "--max-pages must be at least 1"),
        ("--resolution 64 --margin 33", "--margin must be at most a quarter of --resolution 64, got 33"),
        ("--texels-per-unit 0", "--texels-per-unit must be positive, got 0"),
    ] {
        let ran = run_on(&format!("pack {options}"), &[&mesh]);
        assert!(ran.code == 2 && ran.stderr.contains(said), "{options}: {}", ran.stderr);
    }
    let same = run_on(&format!("pack -o {}", mesh.display()), &[&mesh]);
    assert!(same.code == 2 && same.stderr.contains("would replace the file that is read"), "{}", same.stderr);
}

#[test]
fn the_largest_chart_is_parted_where_that_covers_more() {
    let folder = Folder::new();
    let mesh = folder.file("ring.obj", ring());
    let out = folder.path("out.obj");
    let on = |options: &str| {
        let ran = run_on(&format!("--cut-disks --resolution 256 {options} --json - -o {}", out.display()), &[&mesh]);
        assert_eq!(ran.code, 0, "{}", ran.stderr);
        ran.result()
    };
    let figure = |result: &serde_json::Value, name: &str| result["atlas"][name].as_f64().expect("a number");
    let (before, after) = (on(""), on("--coverage 0.6 --seam-budget 0.5"));
    assert!(figure(&before, "coverage") < 0.5 && figure(&after, "coverage") > 1.2 * figure(&before, "coverage"));
    assert_eq!(after["injective"], true);
    let said = after["atlas"]["repairs"].to_string();
    assert!(said.contains("parted to cover more (--coverage)"), "{said}");
    let charts = |result: &serde_json::Value| result["atlas"]["charts"].as_array().map(Vec::len);
    assert!(charts(&after) > charts(&before));
    // Without a seam the half of the boundary counts as one: that of an arch of radii 4 and 5.
    let boundary = 0.5 * (std::f64::consts::PI * 9.0 + 2.0);
    assert!(figure(&after, "seam_length") <= 0.5 * boundary, "{}", after["atlas"]);
    let written = run_on("metrics --json -", &[&out]).result();
    assert_eq!((&written["injective"], &written["charts"]), (&true.into(), &charts(&after).into()));
    assert_eq!(on("--coverage 0.6 --seam-budget 0")["atlas"]["seam_length"], before["atlas"]["seam_length"]);
    for (options, part) in [
        ("--coverage 0", "--coverage must be in (0, 1], got 0"),
        ("--coverage 0.5 --seam-budget -1", "--seam-budget must be at least 0, got -1"),
        ("--seam-budget 1", "--coverage"),
    ] {
        let ran = run_on(options, &[&mesh]);
        assert!(ran.code == 2 && ran.stderr.contains(part), "{options}: {}", ran.stderr);
    }
}

/// A flat half of a ring with radii 4 and 5.
fn ring() -> String {
    let (steps, rows) = (60, 4);
    let mut points = Vec::new();
    for i in 0..=steps {
        let angle = std::f64::consts::PI * f64::from(i) / f64::from(steps);
        points.extend(
            (0..=rows).map(|k| 4.0 + f64::from(k) / f64::from(rows)).map(|r| [r * angle.cos(), r * angle.sin(), 0.0]),
        );
    }
    let at = |i: i32, k: i32| (i * (rows + 1) + k) as usize;
    let squares = (0..steps).flat_map(|i| (0..rows).map(move |k| (i, k)));
    let faces: Vec<[usize; 3]> = squares
        .flat_map(|(i, k)| [[at(i, k), at(i, k + 1), at(i + 1, k + 1)], [at(i, k), at(i + 1, k + 1), at(i + 1, k)]])
        .collect();
    surfaces::obj(&points, &faces)
}

/// Seven vertices: a square and, far from it, a corner.
const PLACES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 5 5 5\nv 6 5 5\nv 5 6 5\n";

#[test]
fn islands_that_are_no_maps_are_packed_and_judged_as_metrics_judges_them() {
    let folder = Folder::new();
    let square = "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\n";
    let faces = "f 1/1 2/2 3/3\nf 2/2 4/4 3/3\n";
    let in_space = PLACES.to_owned();
    let on_a_line = PLACES.replace("v 6 5 5\nv 5 6 5", "v 6 6 6\nv 7 7 7");
    let cases = [
        ("a point", &in_space, "vt .5 .5\n", "f 5/5 6/5 7/5\n", 1, ""),
        ("a line across", &in_space, "vt 2 2\nvt 3 3\nvt 4 4\n", "f 5/5 6/6 7/7\n", 1, ""),
        ("a vertex twice", &in_space, "", "f 1/1 1/2 2/4\n", 0, ""),
        ("alone with a vertex twice", &in_space, "vt 3 3\nvt 4 3\nvt 3 4\n", "f 5/5 5/6 6/7\n", 0, ""),
        ("no area in space", &on_a_line, "vt 3 3\nvt 4 3\nvt 3 4\n", "f 5/5 6/6 7/7\n", 0, ""),
        ("no area beside an overlap", &on_a_line, "vt 3 3\nvt 4 3\nvt 3 4\n", "f 5/5 6/6 7/7\nf 1/1 4/2 3/3\n", 1, ""),
        ("a page without area", &on_a_line, "vt 3 3\nvt 4 3\nvt 3 4\n", "f 5/5 6/6 7/7\n", 0, "--atlas per-component"),
        (
            "a page that is a line",
            &on_a_line,
            "vt 2 2\nvt 3 3\nvt 4 4\n",
            "f 5/5 6/6 7/7\n",
            0,
            "--atlas per-component",
        ),
    ];
    for (name, places, uvs, more, code, options) in cases {
        let mesh = folder.file("a.obj", format!("{places}{square}{uvs}{faces}{more}"));
        let out = folder.path("out.obj");
        let ran = run_on(&format!("pack --json - {options} -o {}", out.display()), &[&mesh]);
        assert_eq!(ran.code, code, "{name}: {}", ran.stderr);
        let (of_pack, of_file) = (ran.result(), run_on("metrics --json -", &[&out]).result());
        for field in ["valid", "flips", "collapsed", "wound", "triangles", "turned", "shared", "uv_area"] {
            assert_eq!(of_pack[field], of_file[field], "{name}: {field}");
        }
        // The pages of one file lie on each other there.
        if options.is_empty() {
            assert_eq!(of_pack["overlaps"], of_file["overlaps"], "{name}");
        }
    }
}

#[test]
fn uvs_of_any_size_are_packed() {
    let folder = Folder::new();
    for size in ["1e308", "1e160", "1e-160", "1e-300"] {
        let uvs = format!("vt -{size} 0\nvt {size} 0\nvt 0 {size}\nvt {size} {size}\n");
        let mesh = folder.file("a.obj", format!("{PLACES}{uvs}f 1/1 2/2 3/3\nf 2/2 4/4 3/3\n"));
        let out = folder.path("out.obj");
        let result = run_on(&format!("pack --json - -o {}", out.display()), &[&mesh]).result();
        assert_eq!(result["injective"], true, "{size}: {}", result["error"]);
        assert_eq!(run_on("metrics --json -", &[&out]).result()["f"], result["f"], "{size}");
        let texels = result["repacked"]["texels_per_unit"].as_f64().expect("a number");
        let given = run_on(&format!("pack --json - --texels-per-unit {:e}", 0.5 * texels), &[&mesh]).result();
        assert_eq!(given["repacked"]["texels_per_unit"].as_f64(), Some(0.5 * texels), "{size}");
        let refused = run_on(&format!("pack --texels-per-unit {:e}", 4.0 * texels), &[&mesh]);
        assert!(refused.code == 2 && refused.stderr.contains("use a lower --texels-per-unit"), "{}", refused.stderr);
    }
}
