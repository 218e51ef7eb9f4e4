//! What cannot be used is refused with a name, a place and a hint.

use crate::support::{Folder, Ran, fixture, run, run_on};
use crate::surfaces;
use std::path::Path;

/// Flattens a file that cannot be flattened and returns its error.
fn refusal(file: &Path) -> (String, String) {
    let ran = run([file.as_os_str(), "--disks-only".as_ref(), "--json".as_ref(), "-".as_ref()]);
    assert_eq!(ran.code, 2, "{}: {}", file.display(), ran.stderr);
    let result = ran.result();
    assert_eq!(result["mesh"], file.display().to_string());
    let text = |name: &str| result["error"][name].as_str().expect("text").to_owned();
    let (kind, message, hint) = (text("kind"), text("message"), text("hint"));
    assert!(message.contains(&file.display().to_string()), "{message}");
    assert!(!hint.is_empty(), "{kind}");
    assert!(ran.stderr.contains(&format!("error: {message}\n  hint: {hint}\n")), "{}", ran.stderr);
    (kind, message)
}

#[test]
fn surfaces_that_are_no_disks_are_named() {
    let folder = Folder::new();
    for (text, kind, part) in [
        (surfaces::tetrahedron(), "closed", "genus 0"),
        (surfaces::torus(), "closed", "genus 1"),
        (surfaces::torus_with_a_hole(), "handles", "1 handle"),
        (surfaces::tube(), "several-boundaries", "2 boundary loops"),
        (surfaces::two_components(), "several-components", "starts at face 1 (counted from 0)"),
        (surfaces::moebius_band(), "non-orientable", "one side only"),
        (surfaces::non_manifold_edge(), "non-manifold-edge", "vertices 0 and 1 has 3 faces (1 in all; counted from 0)"),
        (surfaces::non_manifold_vertex(), "non-manifold-vertex", "vertex 0 form 2 separate fans"),
        (surfaces::inconsistent(), "inconsistent-orientation", "oriented against each other"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n".to_owned(), "repeated-vertex", "uses vertex 1 twice"),
    ] {
        let (found, message) = refusal(&folder.file("mesh.obj", text));
        assert_eq!(found, kind, "{message}");
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn broken_files_are_named_with_the_place() {
    let folder = Folder::new();
    for (name, bytes, kind, part) in [
        ("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "not-finite", "line 2"),
        ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\nf 1 9 2\n", "index-out-of-range", "(2 in all)"),
        ("zero.obj", "v 0 0 0\nf 0 1 2\n", "index-zero", "line 2"),
        ("word.obj", "v 0 zero 0\n", "bad-number", "`zero`"),
        ("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "too-few-corners", "2 corners"),
        ("points.obj", "v 0 0 0\nv 1 0 0\n", "no-faces", "vertices: 2"),
        ("comment.obj", "# nothing\n", "no-vertices", "no vertices"),
        ("empty.obj", "", "empty-file", "empty"),
        ("empty.stl", "", "empty-file", "empty"),
        ("mesh.fbx", "anything", "unknown-extension", "obj, off, ply, stl"),
        ("noise.off", "hello\n", "bad-header", "line 1"),
        ("noise.ply", "hello\n", "bad-header", "line 1"),
    ] {
        let (found, message) = refusal(&folder.file(name, bytes));
        assert_eq!(found, kind, "{message}");
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn a_truncated_binary_file_is_named() {
    let folder = Folder::new();
    let whole = folder.path("whole.ply");
    assert_eq!(run_on(&format!("-o {}", whole.display()), &[&fixture("pyramid")]).code, 0);
    let bytes = std::fs::read(&whole).expect("written");
    for keep in [bytes.len() - 1, bytes.len() / 2] {
        let (kind, message) = refusal(&folder.file("half.ply", &bytes[..keep]));
        assert!(kind == "truncated" || kind == "claim-too-large", "{kind}: {message}");
    }
}

#[test]
fn files_that_cannot_be_opened_are_named() {
    let folder = Folder::new();
    assert_eq!(refusal(&folder.path("missing.obj")).0, "not-found");
    let directory = folder.path("folder.obj");
    std::fs::create_dir(&directory).expect("a folder");
    assert_eq!(refusal(&directory).0, "directory");
    let (kind, message) = refusal(&folder.path(""));
    assert_eq!(kind, "directory");
    assert!(message.ends_with(": cannot be read: is a directory"), "{message}");
}

#[test]
fn a_face_without_area_among_polygons_says_what_is_counted() {
    let folder = Folder::new();
    let mesh = folder.file("quad.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!(run_on("", &[&mesh]).code, 0, "it gets a place");
    let result = run_on("--zero-area refuse --json -", &[&mesh]).result();
    let (kind, message) = (&result["error"]["kind"], result["error"]["message"].as_str().expect("text"));
    assert_eq!(kind, "zero-area");
    assert!(message.contains("face 0 has no area"), "{message}");
    assert!(message.contains("after polygons are cut"), "{message}");
}

fn assert_usage_error(ran: &Ran, part: &str) {
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    assert!(ran.stderr.contains(part), "{}", ran.stderr);
    assert_eq!(ran.stdout, "");
}

#[test]
fn solvers_that_do_not_exist_are_refused_with_those_that_do() {
    assert_usage_error(&run(["--solver", "slim"]), "auto, linabf, abf, abf++, abf-newton, abf-fixed-target");
    assert_usage_error(&run(["--solver", "lscm,slim"]), "minres, barrier, descent, habf++, hlinabf, lscm, all");
    assert_usage_error(&run(["--solver", "lscm,lscm"]), "named twice");
}

#[test]
fn settings_out_of_range_are_refused_before_any_file_is_read() {
    for (options, part) in [
        ("--passes 0", "auto"),
        ("--layout greedy", "least-squares-weighted"),
        ("--ring-switch=-1", "--ring-switch must be at least 0"),
        ("--ring-switch big", "'off'"),
        ("--angle-bound 2", "--angle-bound must be in (0, π/3)"),
        ("--tolerance 0", "--tolerance must be positive"),
        ("--max-iterations 0", "--max-iterations must be at least 1"),
        ("--time-limit nan", "--time-limit must be"),
        ("--threads 0", "--threads"),
        ("--threads 100000", "1024"),
        ("--solver lscm --layout tree", "cannot use the layout 'tree'"),
        ("--solver uzawa --wheel product", "the exact Hessian of the product wheel is not diagonal"),
        ("--solver abf --wheel sum", "product, log"),
        ("--solver uzawa --max-inner-iterations 0", "--max-inner-iterations must be at least 1"),
        ("--solver uzawa --inner-tolerance 2", "--inner-tolerance must be in (0, 1)"),
        ("--solver minres --inner-tolerance tight", "'auto'"),
        ("--frobnicate", "--frobnicate"),
    ] {
        assert_usage_error(&run_on(options, &[Path::new("missing.obj")]), part);
    }
}

#[test]
fn options_that_mean_nothing_to_the_solver_are_refused_with_those_they_concern() {
    for (options, part) in [
        ("--solver abf++ --passes 3", "--passes means nothing to abf++: leave it out, or choose from auto, linabf"),
        ("--wheel log", "--wheel means nothing to auto"),
        ("--solver descent --tolerance 1e-6", "--tolerance means nothing to descent"),
        ("--solver descent --layout tree", "it cannot use the layout 'tree'"),
        ("--barrier-floor 0", "error: --barrier-floor must be positive and finite, got 0"),
        ("--barrier-floor=-1", "error: --barrier-floor must be positive and finite, got -1"),
        ("--solver barrier --barrier-floor 2", "error: --barrier-floor must be at most 0.1, got 2"),
        ("--solver descent --barrier-floor 2", "error: --barrier-floor must be at most 1, got 2"),
        ("--solver descent --max-iterations 0", "error: --max-iterations must be at least 1, got 0"),
        ("--solver lscm --tolerance 1e-6", "--tolerance means nothing to lscm"),
        ("--solver abf-newton --preconditioner none", "choose from uzawa, minres"),
        ("--solver linabf,lscm --hessian exact", "--hessian means nothing to linabf, lscm"),
        ("compare --solver abf++ --reduction none", "--reduction means nothing to abf++"),
    ] {
        assert_usage_error(&run_on(options, &[Path::new("missing.obj")]), part);
    }
}

#[test]
fn outputs_that_make_no_sense_are_refused_before_any_file_is_read() {
    let folder = Folder::new();
    let mesh = folder.file("pyramid.obj", surfaces::pyramid());
    let shown = mesh.display();
    assert_usage_error(&run_on("-o out.stl", &[&mesh]), ".obj or .ply");
    assert_usage_error(&run_on("-o out.obj", &[&mesh, &mesh]), "takes one mesh");
    assert_usage_error(&run_on("--png out.png", &[&mesh, &mesh]), "takes one mesh");
    assert_usage_error(&run_on(&format!("-o {shown}"), &[&mesh]), "would replace the file");
    assert_usage_error(&run_on(&format!("--json {shown}"), &[&mesh]), "would replace the file");
    assert_usage_error(&run_on("--json a.png --png a.png", &[&mesh]), "the same file");
    assert_usage_error(&run_on("--json a --history a", &[&mesh]), "the same file");
    for option in ["-o out.obj", "--png out.png"] {
        assert_usage_error(&run_on(&format!("--solver all {option}"), &[&mesh]), "takes one solver, and there are 13");
    }
    assert_eq!(std::fs::read_to_string(&mesh).expect("still there"), surfaces::pyramid());
}

#[test]
fn an_output_that_cannot_be_written_is_named_before_anything_is_read() {
    let folder = Folder::new();
    for (option, name) in
        [("-o", "out.obj"), ("--png", "out.png"), ("--svg", "a.svg"), ("--json", "a"), ("--history", "a")]
    {
        let target = folder.path("missing").join(name);
        let ran = run(["missing.obj".as_ref(), option.as_ref(), target.as_os_str()]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{option}: {}", ran.stderr);
        assert!(ran.stderr.contains(&format!("error: {}: cannot be written: ", target.display())), "{}", ran.stderr);
        assert!(ran.stderr.contains("hint: make the folder first"), "{}", ran.stderr);
        assert!(!ran.stderr.contains(".abf-"), "nobody asked for a temporary file: {}", ran.stderr);
        assert!(!ran.stderr.contains("missing.obj: cannot be read"), "{}", ran.stderr);
    }
    for option in ["--json", "--csv", "--markdown", "--report"] {
        let target = folder.path("missing/out");
        let ran = run(["compare".as_ref(), "missing.obj".as_ref(), option.as_ref(), target.as_os_str()]);
        assert_eq!(ran.code, 2, "{option}: {}", ran.stderr);
        assert!(ran.stderr.contains(&format!("error: {}: cannot be written: ", target.display())), "{}", ran.stderr);
        assert!(!ran.stderr.contains("missing.obj"), "{}", ran.stderr);
    }
}

#[test]
fn pictures_of_another_format_are_refused() {
    assert_usage_error(&run_on("--png b.jpg", &[Path::new("missing.obj")]), "--png b.jpg: the name must end in .png");
    assert_usage_error(&run_on("--svg b.pdf", &[Path::new("missing.obj")]), "--svg b.pdf: the name must end in .svg");
}

#[test]
fn a_mistyped_command_is_hinted_at() {
    assert_usage_error(&run(["metric", "a.obj"]), "no command 'metric': did you mean 'metrics'?");
    assert_usage_error(&run(["a.obj", "comapre"]), "did you mean 'compare'?");
    assert_usage_error(&run(["frobnicate"]), "the commands are compare, survey, metrics, pack, sparsity, fixtures");
    // With an extension or a folder it is a file that is not there.
    assert_eq!(refusal(Path::new("metric.obj")).0, "not-found");
}

#[test]
fn a_folder_of_the_name_of_the_output_is_left_alone() {
    let folder = Folder::new();
    let mesh = folder.file("pyramid.obj", surfaces::pyramid());
    let taken = folder.path("taken.obj");
    std::fs::create_dir(&taken).expect("a folder");
    let ran = run([mesh.as_os_str(), "-o".as_ref(), taken.as_os_str()]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("choose another name"), "{}", ran.stderr);
    assert!(taken.is_dir());
    assert_eq!(folder.count(), 2, "no temporary file is left");
}
