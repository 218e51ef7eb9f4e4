//! Settings are written and read back, and a name that does not exist is answered with those that do.

#![cfg(feature = "serde")]

use abf::{
    ArrayUnwrapper, Atlas, Barrier, Hessian, HoleRule, InnerTolerance, LayoutKind, LinAbf, LineSearch, Passes,
    Pipeline, Precision, PreconditionerKind, Reduction, SeamRule, Solver, SolverKind, StopCriteria, Unwrap, WheelForm,
    ZeroArea,
};
use abf::{AtlasPages, Weld, cut::HoleFilling};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::{Debug, Display};
use std::str::FromStr;
use std::time::Duration;

fn assert_reads_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: &T) {
    let text = serde_json::to_string(value).expect("plain data");
    assert_eq!(&serde_json::from_str::<T>(&text).expect("what was written"), value, "{text}");
}

#[test]
fn settings_of_every_solver_read_back() {
    for mut solver in Solver::all() {
        let parts = solver.parts_mut();
        if let Some(linabf) = parts.linabf {
            linabf.passes = Passes::Exactly(3.try_into().expect("not zero"));
        }
        if let Some(newton) = parts.newton {
            newton.inner_tolerance = InnerTolerance::Fixed(0.1);
            newton.line_search = LineSearch::Full;
        }
        if let Some(iterative) = parts.iterative {
            iterative.reduction = Reduction::None;
        }
        let stop = StopCriteria { time_limit: Some(Duration::from_millis(1500)), ..StopCriteria::default() };
        let pipeline = Pipeline { solver, stop, precision: Precision::Single, ..Pipeline::default() };
        assert_reads_back(&pipeline.solver.kind());
        assert_reads_back(&Unwrap { pipeline, holes: HoleRule::Cut, ..Unwrap::default() });
    }
    assert_reads_back(&Unwrap { holes: HoleRule::Fill(HoleFilling::Fan), ..Unwrap::default() });
    assert_reads_back(&Atlas { pages: AtlasPages::PerMaterial, ..Atlas::default() });
    assert_reads_back(&Unwrap { weld: Weld::Within(0.25), ..Unwrap::default() });
    assert_reads_back(&ArrayUnwrapper::default());
}

#[test]
fn what_is_left_out_is_the_default_and_what_is_not_known_is_refused() {
    let text = r#"{"solver": {"barrier": {"barrier_floor": 1e-6}}, "layout": {"kind": "least-squares"}}"#;
    let pipeline: Pipeline = serde_json::from_str(text).expect("settings");
    let barrier = Barrier { barrier_floor: 1e-6, ..Barrier::default() };
    assert_eq!((pipeline.solver, pipeline.layout.kind), (barrier.into(), LayoutKind::LeastSquares));
    let error = serde_json::from_str::<Pipeline>(r#"{"solvr": "lscm"}"#).unwrap_err().to_string();
    assert!(error.contains("unknown field `solvr`"), "{error}");
}

#[test]
fn passes_are_a_number_or_auto() {
    for (passes, text) in [(Passes::Auto, "\"auto\""), (Passes::Exactly(2.try_into().expect("not zero")), "2")] {
        assert_eq!(serde_json::to_string(&passes).expect("plain data"), text);
        assert_reads_back(&LinAbf { passes, error_bound: Some(0.25) });
    }
    assert!(serde_json::from_str::<Passes>("0").is_err());
}

#[test]
fn a_solver_of_a_user_is_written_by_its_name_and_not_read_back() {
    let own = Solver::custom(LinAbf::default());
    let text = serde_json::to_string(&own).expect("plain data");
    assert_eq!(text, r#"{"custom":"linabf"}"#);
    assert!(serde_json::from_str::<Solver>(&text).is_err());
    assert_eq!(serde_json::to_string(&SolverKind::Custom("mine")).expect("plain data"), r#""mine""#);
    assert!(serde_json::from_str::<SolverKind>(r#""mine""#).is_err());
}

/// Every name of a type leads back to it, is its text in JSON, and is listed where another is not known.
fn assert_named<T>(values: &[T])
where
    T: Display + FromStr<Err = abf::UnknownName> + PartialEq + Debug + Serialize,
{
    let error = "no-such".parse::<T>().unwrap_err();
    let names: Vec<String> = values.iter().map(ToString::to_string).collect();
    assert_eq!(error.known, names);
    let said = format!("there is no {} 'no-such'; there are: {}", error.what, names.join(", "));
    assert_eq!(error.to_string(), said);
    for (value, name) in values.iter().zip(&names) {
        assert_eq!(&name.parse::<T>().expect("a name"), value);
        assert_eq!(serde_json::to_value(value).expect("plain data"), name.as_str());
    }
}

#[test]
fn names_are_one_thing_everywhere() {
    assert_named(&SolverKind::ALL);
    assert_named(&LayoutKind::ALL);
    assert_named(&AtlasPages::ALL);
    assert_named(&[WheelForm::Log, WheelForm::Product]);
    assert_named(&[Hessian::GaussNewton, Hessian::Exact]);
    assert_named(&[LineSearch::Full, LineSearch::Merit]);
    assert_named(&[Reduction::None, Reduction::Triangles]);
    assert_named(&[PreconditionerKind::None, PreconditionerKind::Jacobi, PreconditionerKind::Block]);
    assert_named(&[Precision::Single, Precision::Double]);
    assert_named(&[HoleFilling::Fan, HoleFilling::Ears]);
    assert_named(&[ZeroArea::Carry, ZeroArea::Refuse]);
    assert_named(&[SeamRule::Auto, SeamRule::Keep]);
}
