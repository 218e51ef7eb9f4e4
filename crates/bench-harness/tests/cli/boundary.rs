//! What is asked of the boundary, from the command line to the record.

use crate::support::{Folder, fixture, run, run_on};

#[test]
fn the_record_says_what_became_of_the_boundary() {
    let folder = Folder::new();
    let ran = run_on("--boundary convex --solver linabf --json -", &[&fixture("mask-coarse")]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    let result = ran.result();
    assert_eq!(result["settings"]["boundary"], "convex");
    assert_eq!(result["boundary"]["injective_by_convexity"], true);
    assert!(ran.stderr.contains("injective by convexity"), "{}", ran.stderr);
    let free = run_on("--solver linabf --json -", &[&fixture("mask-coarse")]).result();
    assert!(free.get("boundary").is_none() && free["settings"].get("boundary").is_none());
    assert_eq!(folder.count(), 0);
}

#[test]
fn each_bad_line_of_a_file_of_angles_is_named() {
    let folder = Folder::new();
    let refused = |text: &str| {
        let file = folder.file("angles.txt", text);
        let ran = run_on(&format!("--boundary angles={}", file.display()), &[&fixture("mask-coarse")]);
        assert_eq!(ran.code, 2, "{}", ran.stderr);
        ran.stderr
    };
    let said = refused("0 1.5\nx 2\n3\n");
    assert!(said.contains("line 2") && said.contains("line 3") && said.contains("angles.txt"), "{said}");
    let said = refused("# many\n1000000 1.5\n");
    assert!(said.contains("line 2: vertex 1000000") && said.contains("angles.txt, for "), "{said}");
    assert!(said.contains("angles.txt, or leave out the vertices that it cannot have"), "{said}");
    let ran = run(["--boundary", "angles=/no/such/file"]);
    assert!(ran.code == 2 && ran.stderr.contains("/no/such/file"), "{}", ran.stderr);
}

#[test]
fn what_is_next_after_a_bound_on_the_error_is_another_bound() {
    let ran = run_on("--error-bound 0.01 --solver linabf", &[&fixture("spike")]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("try a larger --error-bound, or to leave out --error-bound"), "{}", ran.stderr);
    let ran = run_on("--error-bound 0.5 --boundary convex --solver linabf", &[&fixture("spike")]);
    assert!(ran.code == 2 && ran.stderr.contains("do not go together: leave out one of them"), "{}", ran.stderr);
}

#[test]
fn a_boundary_is_refused_where_it_means_nothing() {
    let refused = |options: &str| {
        let ran = run_on(options, &[&fixture("mask-coarse")]);
        assert_eq!(ran.code, 2, "{options}: {}", ran.stderr);
        ran.stderr
    };
    let said = refused("--boundary convex --solver descent");
    assert!(said.contains("means nothing to descent") && said.contains("auto, linabf, barrier"), "{said}");
    assert!(refused("--boundary oval").contains("rectangle[=v0,v1,v2,v3]"));
    let folder = Folder::new();
    let tube = folder.file("tube.obj", crate::surfaces::tube());
    let ran = run_on("--boundary circle", &[&tube]);
    assert!(ran.code == 2 && ran.stderr.contains("'circle' is for one disk"), "{}", ran.stderr);
}
