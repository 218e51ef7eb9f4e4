//! Maps that lie over themselves, from the command line to the record.

use crate::support::{Folder, run_on};
use crate::surfaces::obj;

/// A flat strip that winds around an axis one and a half times, as a ramp.
fn ramp() -> String {
    let steps = 72;
    let at = |k: usize, j: usize| {
        let angle = 3.0 * std::f64::consts::PI * k as f64 / steps as f64;
        let radius = 1.0 + 0.25 * j as f64;
        [radius * angle.cos(), radius * angle.sin(), 0.0005 * k as f64]
    };
    let points: Vec<[f64; 3]> = (0..=steps).flat_map(|k| (0..3).map(move |j| at(k, j))).collect();
    let cell = |k: usize, j: usize| {
        let [a, b, c, d] = [3 * k + j, 3 * k + j + 1, 3 * k + j + 3, 3 * k + j + 4];
        [[a, b, d], [a, d, c]]
    };
    let faces: Vec<[usize; 3]> = (0..steps).flat_map(|k| (0..2).flat_map(move |j| cell(k, j))).collect();
    obj(&points, &faces)
}

#[test]
fn a_map_that_lies_over_itself_is_hinted_at_parted_or_deformed() {
    let folder = Folder::new();
    let mesh = folder.file("ramp.obj", ramp());
    let run = |options: &str| run_on(&format!("--disks-only --json - {options}"), &[&mesh]);
    let free = run("");
    assert!(free.stderr.contains("try --injective deform"), "{}", free.stderr);
    assert_eq!(free.result()["injective"], false);
    for rule in ["split", "deform"] {
        let out = folder.path(&format!("{rule}.obj"));
        let ran = run(&format!("--injective {rule} -o {}", out.display()));
        let result = ran.result();
        assert_eq!((&result["injective"], &result["made_injective"]["rule"]), (&true.into(), &rule.into()), "{result}");
        assert!(!ran.stderr.contains("--injective"), "the hint is not the option given: {}", ran.stderr);
        let judged = run_on("metrics --json -", &[&out]).result();
        assert_eq!((&judged["injective"], &judged["valid"]), (&true.into(), &true.into()), "{judged}");
    }
    let large = run("--injective deform --boundary-gap 5");
    assert!(large.code == 2 && large.stderr.contains("is too large for this mesh: at most"), "{}", large.stderr);
    for refused in
        ["--injective deform --boundary convex", "--boundary-gap 0.1", "--injective deform --boundary-gap -1"]
    {
        let ran = run(refused);
        assert_eq!(ran.code, 2, "{refused}: {}", ran.stderr);
    }
}
