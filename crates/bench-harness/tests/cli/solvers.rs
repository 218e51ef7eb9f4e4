//! Every solver by name and by its settings, all of them side by side, and their histories.

use crate::support::{Folder, fixture, run_on};
use crate::surfaces;
use serde_json::Value;

const SOLVERS: [&str; 13] = [
    "auto",
    "linabf",
    "abf",
    "abf++",
    "abf-newton",
    "abf-fixed-target",
    "uzawa",
    "minres",
    "barrier",
    "descent",
    "habf++",
    "hlinabf",
    "lscm",
];
const LETTERS: [&str; 3] = ["letter-2", "letter-v", "letter-x"];
const AS_PUBLISHED: &str = "--reduction none --preconditioner none";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn whole(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no whole number"))
}

#[test]
fn every_solver_flattens_by_name_and_says_which_point_of_the_grid_it_is() {
    for (solver, wheel, hessian, is_iterative) in [
        ("auto", None, None, false),
        ("linabf", None, None, false),
        ("abf", Some("product"), Some("exact"), false),
        ("abf++", Some("product"), Some("gauss-newton"), false),
        ("abf-newton", Some("log"), Some("exact"), false),
        ("abf-fixed-target", Some("log"), Some("gauss-newton"), false),
        ("uzawa", Some("log"), Some("exact"), true),
        ("minres", Some("log"), Some("exact"), true),
        ("descent", None, None, false),
        ("habf++", None, None, false),
        ("hlinabf", None, None, false),
        ("lscm", None, None, false),
    ] {
        let ran = run_on(&format!("--solver {solver} --json -"), &[&fixture("hemisphere")]);
        let result = ran.result();
        assert_eq!((ran.code, &result["solver"]), (0, &solver.into()), "{}", ran.stderr);
        let settings = &result["settings"];
        // The settings of a solver stand under its name, those of the family of Newton's method under `newton`.
        let own = settings["solver"].as_object().and_then(|solver| solver.values().next()).unwrap_or(&Value::Null);
        let newton = &own["newton"];
        assert_eq!((newton["wheel"].as_str(), newton["hessian"].as_str()), (wheel, hessian), "{solver}: {settings}");
        assert_eq!(newton["line_search"].as_str(), wheel.map(|_| "merit"), "{solver}");
        assert_eq!(own["iterative"]["max_inner_iterations"].is_number(), is_iterative, "{solver}");
        assert_eq!(
            result["energy"].is_number(),
            wheel.is_some() || ["descent", "habf++"].contains(&solver),
            "{solver}"
        );
        let has_diagonal_hessian = !["abf", "lscm"].contains(&solver);
        assert_eq!(result["negative_curvature"].is_number(), has_diagonal_hessian, "{solver}");
    }
}

#[test]
fn solvers_with_a_fixed_target_reach_the_same_distortion() {
    let json = run_on("--solver all --json -", &[&fixture("mask-coarse")]).json();
    let results = json["results"].as_array().expect("a list");
    let of = |solver: &str| results.iter().find(|result| result["solver"] == solver).expect("a row");
    let reference = of("abf-fixed-target");
    for solver in ["abf", "abf++", "abf-newton", "uzawa", "minres"] {
        for field in ["f", "stretch_l2", "energy"] {
            let (found, expected) = (number(&of(solver)[field]), number(&reference[field]));
            assert!((found / expected - 1.0).abs() < 1e-6, "{solver}: {field} {found} {expected}");
        }
    }
}

#[test]
fn the_settings_of_the_family_reach_the_json() {
    let options = "--solver minres --wheel product --hessian gauss-newton --line-search full --reduction none \
                   --preconditioner jacobi --max-inner-iterations 700 --inner-tolerance 1e-9 --json -";
    let settings = run_on(options, &[&fixture("pyramid")]).result()["settings"].clone();
    let newton = serde_json::json!({
        "wheel": "product", "hessian": "gauss-newton", "line_search": "full", "bounds": settings["solver"]["minres"]["newton"]["bounds"],
        "inner_tolerance": {"fixed": 1e-9}
    });
    let iterative = serde_json::json!({"reduction": "none", "preconditioner": "jacobi", "max_inner_iterations": 700});
    assert_eq!(settings["solver"]["minres"], serde_json::json!({"newton": newton, "iterative": iterative}));
}

#[test]
fn as_published_uzawa_and_minres_converge_on_the_letters_and_print_their_inner_iterations() {
    for solver in ["uzawa", "minres"] {
        for letter in LETTERS {
            let ran = run_on(&format!("--solver {solver} {AS_PUBLISHED} --json -"), &[&fixture(letter)]);
            let result = ran.result();
            assert_eq!((ran.code, &result["termination"]), (0, &"converged".into()), "{}", ran.stderr);
            let inner = whole(&result["inner_iterations"]);
            assert!((100..2000).contains(&inner), "{solver} on {letter}: {inner}");
            assert!(ran.stderr.contains(&format!("iterations ({inner} inner)")), "{}", ran.stderr);
            let (residual, estimate) = (number(&result["inner_residual"]), number(&result["inner_estimate"]));
            assert!(residual < 1e-6 && estimate > 0.0, "{solver} on {letter}: {residual} {estimate}");
        }
    }
}

#[test]
fn too_few_inner_iterations_end_unconverged_and_say_so() {
    for solver in ["uzawa", "minres"] {
        let options = format!("--solver {solver} {AS_PUBLISHED} --max-inner-iterations 5");
        let result = run_on(&format!("{options} --json -"), &[&fixture("letter-x")]).result();
        assert_eq!(whole(&result["inner_unconverged"]), whole(&result["iterations"]), "{solver}");
        assert!(result["hint"].as_str().expect("a hint").contains("--preconditioner block"), "{result}");
        let ran = run_on(&options, &[&fixture("letter-x")]);
        assert_eq!(ran.code, 1, "{solver}: {}", ran.stderr);
        assert!(ran.stdout.contains("not converged"), "{}", ran.stdout);
        assert!(ran.stdout.contains("short of"), "{}", ran.stdout);
        assert!(ran.stderr.contains("--max-inner-iterations 50"), "{}", ran.stderr);
    }
}

#[test]
fn a_limit_of_one_iteration_is_a_limit_and_one_pass_is_a_method() {
    for solver in ["abf++", "linabf", "abf-newton", "barrier", "descent"] {
        let ran = run_on(&format!("--solver {solver} --max-iterations 1 --json -"), &[&fixture("letter-v")]);
        let result = ran.result();
        assert_eq!((ran.code, &result["termination"]), (1, &"max-iterations".into()), "{solver}: {}", ran.stderr);
        assert!(ran.stderr.contains("try --max-iterations 2"), "{}", ran.stderr);
    }
    let ran = run_on("--solver linabf --passes 1 --json -", &[&fixture("letter-v")]);
    let result = ran.result();
    assert_eq!((ran.code, &result["termination"]), (0, &"one-pass".into()), "{}", ran.stderr);
    assert!(number(&result["constraint_residual"]) > 1e-8);
}

#[test]
fn a_pass_that_has_nothing_to_solve_has_no_residual_of_it() {
    // Flat to rounding: the initial guess meets the constraints as it stands.
    let result = run_on("--solver linabf --json -", &[&fixture("roll")]).result();
    assert_eq!((&result["inner_iterations"], &result["iterations"]), (&0.into(), &1.into()));
    assert!(result["inner_residual"].is_null() && result["inner_residual_worst"].is_null(), "{result}");
    let result = run_on("--solver abf++ --json -", &[&fixture("roll")]).result();
    assert!(number(&result["inner_residual"]) < 1e-6, "{result}");
}

#[test]
fn the_kkt_matrix_of_both_wheel_forms_is_counted() {
    let ran = run_on("--solver abf++ --json -", &[&fixture("bumpy-sheet")]);
    let result = ran.result();
    let (kkt, triangles) = (&result["kkt"], whole(&result["triangles"]));
    assert_eq!(whole(&kkt["unknowns"]), 4 * triangles + 2 * whole(&result["interior_vertices"]));
    let (log, product) = (number(&kkt["nonzeros_log"]), number(&kkt["nonzeros_product"]));
    assert!((1.9..2.3).contains(&(product / log)), "{product} / {log}: VMV04 fig. 2 has 100 044 / 47 607");
    assert!(ran.stderr.contains(&format!("log wheel {log}, product wheel {product}")), "{}", ran.stderr);
    let lscm = run_on("--solver lscm --json -", &[&fixture("bumpy-sheet")]).result();
    assert_eq!(lscm.get("kkt"), None, "lscm has no constraints");
}

#[test]
fn all_solvers_are_compared_in_one_table_the_worst_first_and_explained() {
    let ran = run_on("--solver all", &[&fixture("obtuse")]);
    assert_eq!(ran.code, 1, "lscm flips a triangle: {}", ran.stderr);
    let lines: Vec<&str> = ran.stdout.lines().collect();
    assert_eq!(lines.len(), 2 + SOLVERS.len() + 1, "{}", ran.stdout);
    assert!(lines[0].contains("obtuse.obj: 3 triangles"), "{}", ran.stdout);
    for head in ["solver", "outer", "inner", "residual", "negative", "fallbacks", "flips", "F/3nt", "time", "MB"] {
        assert!(lines[1].contains(head), "{head}: {}", lines[1]);
    }
    assert!(lines[2].starts_with("lscm") && lines[2].contains("one-pass, not valid"), "{}", ran.stdout);
    let last = 2 + SOLVERS.len();
    assert!(lines[3..last].iter().all(|line| line.contains(" converged ")), "{}", ran.stdout);
    assert!(lines[last].starts_with("lscm: 1 flipped and 0 collapsed triangles: try "), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "it is all in the table");
    let json = run_on("--solver all --json -", &[&fixture("obtuse")]).json();
    let named: Vec<&Value> = json["results"].as_array().expect("a list").iter().map(|r| &r["solver"]).collect();
    assert_eq!(named, SOLVERS, "in the order of the documentation");
}

#[test]
fn some_solvers_are_compared_in_the_order_they_are_named() {
    let json = run_on("--solver minres,linabf --json -", &[&fixture("roll")]).json();
    assert_eq!((&json["results"][0]["solver"], &json["results"][1]["solver"]), (&"minres".into(), &"linabf".into()));
    assert_eq!(json["results"].as_array().map(Vec::len), Some(2));
}

#[test]
fn several_meshes_get_a_table_each_and_a_broken_one_gets_one_row() {
    let folder = Folder::new();
    let broken = folder.file("torus.obj", surfaces::torus());
    let missing = folder.path("missing.obj");
    let (first, last) = (fixture("pyramid"), fixture("roll"));
    let meshes = [first.as_path(), &broken, &missing, &last];
    let ran = run_on("--solver uzawa,abf++ --disks-only", &meshes);
    assert_eq!(ran.code, 2);
    let tables: Vec<&str> = ran.stdout.split("\n\n").collect();
    assert_eq!(tables.len(), 4, "{}", ran.stdout);
    assert!(tables[1].contains("error: closed") && tables[2].contains("error: not-found"), "{}", ran.stdout);
    assert_eq!(ran.stderr.matches("error: ").count(), 2, "{}", ran.stderr);
    let json = run_on("--solver uzawa,abf++ --disks-only --json -", &meshes).json();
    let results = json["results"].as_array().expect("a list");
    assert_eq!(results.len(), 6);
    assert_eq!((&results[2]["error"]["kind"], results[2].get("solver")), (&"closed".into(), None));
}

#[test]
fn settings_that_go_with_some_solvers_only_leave_the_others_out_and_say_so() {
    let ran = run_on("--solver all --wheel product", &[&fixture("pyramid")]);
    assert_eq!(ran.code, 0, "{}", ran.stderr);
    for solver in ["uzawa", "minres"] {
        let expected = format!("{solver}: not run: the exact Hessian of the product wheel is not diagonal");
        assert!(ran.stdout.contains(&expected), "{}", ran.stdout);
    }
    assert_eq!(ran.stdout.matches("not run: settings").count(), 2, "{}", ran.stdout);
}

#[test]
fn abf_is_not_run_on_a_large_mesh_unless_it_is_named() {
    let ran = run_on("--solver all --max-iterations 1", &[]);
    assert!(ran.stdout.contains("not run: too large"), "{}", ran.stdout);
    assert!(ran.stdout.contains("--solver abf\n"), "{}", ran.stdout);
}

#[test]
fn the_history_has_every_outer_and_inner_iteration() {
    let folder = Folder::new();
    let file = folder.path("history.json");
    let options = format!("--solver all --json - --history {}", file.display());
    let results = run_on(&options, &[&fixture("letter-x")]).json()["results"].clone();
    let history: Value = serde_json::from_slice(&std::fs::read(&file).expect("written")).expect("JSON");
    assert_eq!(history["schema"], "bench-harness-history/3");
    let runs = history["runs"].as_array().expect("a list");
    assert_eq!(runs.len(), SOLVERS.len());
    for (run, result) in runs.iter().zip(results.as_array().expect("a list")) {
        let solver = run["solver"].as_str().expect("a name");
        assert_eq!((&run["mesh"], &run["solver"]), (&result["mesh"], &result["solver"]));
        assert_eq!(run["settings"], result["settings"], "{solver}");
        assert_eq!((&run["f"], &run["flips"]), (&result["f"], &result["flips"]), "{solver}");
        let rows = run["iterations"].as_array().expect("a list");
        check_rows(rows, solver);
        let iterations: Vec<&Value> = rows.iter().filter(|row| row["iteration"] != 0).collect();
        assert_eq!(iterations.len() as u64, whole(&result["iterations"]), "{solver}");
        let Some(last) = iterations.last() else { continue };
        assert_eq!(last["constraint_residual"], result["constraint_residual"], "{solver}");
        assert_eq!((&last["energy"], &last["inner_residual"]), (&result["energy"], &result["inner_residual"]));
        for iteration in iterations {
            let inner = iteration["inner"].as_array().expect("a list");
            if ["uzawa", "minres"].contains(&solver) {
                assert_eq!(inner.len() as u64, whole(&iteration["inner_iterations"]), "{solver}");
                assert_eq!(inner.last(), Some(&iteration["inner_estimate"]), "{solver}");
            } else if !["auto", "linabf", "hlinabf", "abf-fixed-target"].contains(&solver) {
                assert!(inner.is_empty(), "{solver} is direct");
            }
        }
    }
}

/// Every start has its iteration 0, time goes on, and only solvers that move vertices have a drawing.
fn check_rows(rows: &[Value], solver: &str) {
    let starts = rows.iter().filter(|row| row["iteration"] == 0).count() as u64;
    assert_eq!(rows.last().map_or(0, |row| whole(&row["start"])), starts, "{solver}");
    assert!(rows.first().is_none_or(|row| row["iteration"] == 0), "{solver}");
    let times: Vec<f64> = rows.iter().map(|row| row["time_s"].as_f64().expect("seconds")).collect();
    assert!(times.is_sorted() && times.iter().all(|&s| s >= 0.0), "{solver}: {times:?}");
    for row in rows {
        assert_eq!(row["f"].is_number(), solver == "descent", "{solver}: {row}");
        assert_eq!(row["flips"].is_number(), solver == "descent", "{solver}: {row}");
        assert_eq!(row["energy"].is_number(), row["energy_of"] == "abf", "{solver}: {row}");
    }
}

#[test]
fn the_history_of_a_drawing_ends_with_the_figures_of_the_result_and_goes_on_while_it_is_relaxed() {
    let mesh = fixture("letter-x");
    let descent = run_on("--solver descent --history -", &[&mesh]).json()["runs"][0].clone();
    let last = descent["iterations"].as_array().and_then(|rows| rows.last()).expect("rows").clone();
    let (f, end) = (last["f"].as_f64().expect("F"), descent["f"].as_f64().expect("F"));
    assert!((f - end).abs() < 1e-9 * end, "{f} {end}");
    assert_eq!((&last["flips"], &descent["flips"]), (&0.into(), &0.into()));

    let relaxed = run_on("--energy isometric --history -", &[&mesh]).json()["runs"][0].clone();
    let rows = relaxed["iterations"].as_array().expect("rows");
    let relaxing: Vec<&Value> = rows.iter().filter(|row| row["stage"] == "relax").collect();
    assert_eq!(relaxing[0]["iteration"], 0);
    assert!(relaxing.iter().all(|row| row["energy_of"] == "isometric" && row["constraint_residual"].is_null()));
    let energies: Vec<f64> = relaxing.iter().map(|row| row["energy"].as_f64().expect("an energy")).collect();
    assert!(energies.len() > 2 && energies.windows(2).all(|pair| pair[1] <= pair[0]), "{energies:?}");
    assert!(relaxed["notes"].to_string().contains("no f and no flips of linabf"), "{}", relaxed["notes"]);
}

#[test]
fn a_history_that_cannot_be_written_is_named() {
    let folder = Folder::new();
    let ran = run_on(&format!("--history {}", folder.path("missing/h.json").display()), &[&fixture("pyramid")]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("h.json: cannot be written"), "{}", ran.stderr);
    assert_eq!(ran.stdout, "", "it is found before the work");
}
