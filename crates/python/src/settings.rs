//! From keywords to the settings of the library. Names, ranges and defaults are those of the command line.

use crate::errors::SettingError;
use abf::{
    Atlas, AtlasPages, Boundary, BoundaryAngle, DoubleSided, Effort, Energy, GuessSettings, HoleRule, InnerTolerance,
    LayoutKind, LayoutSettings, Parting, Passes, Pin, PinWeight, Pins, Pipeline, Relax, SeamRule, Solver, SolverKind,
    SolverSettings, StopCriteria, Unwrap, Weld,
};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::str::FromStr;
use std::time::Duration;

/// Keywords; `None` is the default.
pub(crate) struct Keywords<'py>(pub(crate) Bound<'py, PyDict>);

impl<'py> Keywords<'py> {
    /// What was given, if it is not `None`.
    fn given(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(self.0.get_item(name)?.filter(|value| !value.is_none()))
    }

    /// A number, or a truth value.
    pub(crate) fn value<T>(&self, name: &str) -> PyResult<Option<T>>
    where
        T: for<'a> FromPyObject<'a, 'py>,
    {
        let Some(given) = self.given(name)? else { return Ok(None) };
        match given.extract::<T>().map_err(Into::<PyErr>::into) {
            Ok(value) => Ok(Some(value)),
            Err(error) if error.is_instance_of::<PyOverflowError>(given.py()) => {
                Err(out_of_range(name, "a whole number that is not negative and not too large", &given))
            }
            Err(error) if error.is_instance_of::<PyTypeError>(given.py()) => {
                Err(PyTypeError::new_err(format!("{name}: {}", error.value(given.py()))))
            }
            Err(error) => Err(error),
        }
    }

    /// One of several names.
    fn choice<T: FromStr<Err: Display>>(&self, name: &str) -> PyResult<Option<T>> {
        let Some(given) = self.given(name)? else { return Ok(None) };
        let Ok(text) = given.cast::<PyString>() else {
            return Err(PyTypeError::new_err(format!("{name} must be a str, got {}", given.get_type())));
        };
        let parsed = text.to_str()?.parse().map_err(|error| SettingError::new_err(format!("{name}: {error}")));
        parsed.map(Some)
    }

    /// A number, or a word that stands for something else than a number.
    fn word_or<T>(&self, name: &str, word: &str) -> PyResult<Option<Option<T>>>
    where
        T: for<'a> FromPyObject<'a, 'py>,
    {
        let Some(given) = self.given(name)? else { return Ok(None) };
        match given.cast::<PyString>() {
            Ok(text) if text.to_str()? == word => Ok(Some(None)),
            Ok(_) => Err(out_of_range(name, &format!("a number or '{word}'"), &given)),
            Err(_) => Ok(self.value(name)?.map(Some)),
        }
    }

    /// Whether a word is this one, and not the `other` one, which is the default.
    pub(crate) fn is(&self, name: &str, word: &str, other: &str) -> PyResult<bool> {
        match self.value::<String>(name)? {
            Some(given) if given == word => Ok(true),
            None => Ok(false),
            Some(given) if given == other => Ok(false),
            Some(given) => Err(SettingError::new_err(format!("{name} must be '{word}' or '{other}', got '{given}'"))),
        }
    }

    /// How many threads work: `None` is one per processor.
    pub(crate) fn threads(&self) -> PyResult<Option<usize>> {
        self.value("threads")
    }

    /// How a disk or a chart is flattened.
    pub(crate) fn pipeline(&self) -> PyResult<Pipeline> {
        let (estimate, stop, plain) = (GuessSettings::default(), StopCriteria::default(), Pipeline::default());
        let solver = self.solver()?;
        let kind = solver.kind();
        let concerns = [
            ("ring_switch", kind.keeps_constraints()),
            ("angle_bound", kind.keeps_constraints()),
            ("tolerance", kind.keeps_constraints()),
            ("max_iterations", kind.finds_angles()),
            ("time_limit", kind.finds_angles()),
            ("boundary", kind.keeps_boundary()),
        ];
        self.refuse_what_means_nothing(kind, &concerns)?;
        Ok(Pipeline {
            solver,
            zero_area: self.choice("zero_area")?.unwrap_or(plain.zero_area),
            boundary: self.boundary()?,
            initial_guess: GuessSettings {
                ring_switch: self.word_or("ring_switch", "off")?.unwrap_or(estimate.ring_switch),
                angle_bound: self.value("angle_bound")?.unwrap_or(estimate.angle_bound),
                ..estimate
            },
            stop: StopCriteria {
                tolerance: self.value("tolerance")?.unwrap_or(stop.tolerance),
                max_iterations: self.value("max_iterations")?.unwrap_or(stop.max_iterations),
                time_limit: self.time_limit()?,
                ..stop
            },
            relax: self.relax()?,
            pins: self.pins()?,
            injective: self.choice("injective")?.unwrap_or_default(),
            boundary_gap: self.value("boundary_gap")?.unwrap_or_default(),
            layout: LayoutSettings {
                kind: self.choice::<LayoutKind>("layout")?.unwrap_or_default(),
                ..LayoutSettings::default()
            },
            normalize: self.value("normalize")?.unwrap_or(false),
            max_memory: self.value("max_memory")?,
            ..plain
        })
    }

    /// How a map that is there is relaxed: nothing is said of a solver.
    pub(crate) fn relaxing(&self) -> PyResult<Pipeline> {
        let plain = Pipeline::default();
        Ok(Pipeline {
            relax: self.relax()?,
            pins: self.pins()?,
            stop: StopCriteria { time_limit: self.time_limit()?, ..plain.stop },
            max_memory: self.value("max_memory")?,
            ..plain
        })
    }

    fn time_limit(&self) -> PyResult<Option<Duration>> {
        let seconds = |limit| {
            let wrong =
                |_| SettingError::new_err(format!("time_limit must be a number of seconds, at least 0, got {limit}"));
            Duration::try_from_secs_f64(limit).map_err(wrong)
        };
        self.value::<f64>("time_limit")?.map(seconds).transpose()
    }

    /// What is to be little in the map: a name, or the weight of areas.
    fn relax(&self) -> PyResult<Option<Relax>> {
        let Some(given) = self.given("energy")? else { return Ok(None) };
        let energy = match given.cast::<PyString>() {
            Ok(_) => self.choice::<Energy>("energy")?,
            Err(_) => self.value("energy")?.map(Energy::Slider),
        };
        let energy = energy.unwrap_or_default();
        energy.check().map_err(|error| SettingError::new_err(error.to_string()))?;
        Ok(Some(Relax { energy, ..Relax::default() }))
    }

    /// Vertices with their places, and the weights of soft ones.
    fn pins(&self) -> PyResult<Option<Pins>> {
        let Some(given) = self.value::<Vec<(u32, [f64; 2], Option<f64>)>>("pins")? else { return Ok(None) };
        let pin = |(vertex, uv, weight): (u32, [f64; 2], Option<f64>)| Pin {
            vertex,
            uv,
            weight: weight.map_or(PinWeight::Hard, PinWeight::Soft),
        };
        Ok(Some(Pins { pins: given.into_iter().map(pin).collect() }))
    }

    fn solver(&self) -> PyResult<Solver> {
        let mut solver = self.choice::<Solver>("solver")?.unwrap_or_default();
        let passes = |passes: usize| {
            passes.to_string().parse::<Passes>().map_err(|e| SettingError::new_err(format!("passes: {e}")))
        };
        let settings = SolverSettings {
            passes: self.word_or::<usize>("passes", "auto")?.flatten().map(passes).transpose()?,
            error_bound: self.value("error_bound")?,
            barrier_floor: self.value("barrier_floor")?,
            wheel: self.choice("wheel")?,
            hessian: self.choice("hessian")?,
            line_search: self.choice("line_search")?,
            reduction: self.choice("reduction")?,
            preconditioner: self.choice("preconditioner")?,
            max_inner_iterations: self.value("max_inner_iterations")?,
            inner_tolerance: self.word_or("inner_tolerance", "auto")?.flatten().map(InnerTolerance::Fixed),
        };
        settings.give(&mut solver).map_err(|error| SettingError::new_err(error.to_string()))?;
        Ok(solver)
    }

    /// What the boundary is to look like: a rule by its name, or the angles of vertices.
    fn boundary(&self) -> PyResult<Boundary> {
        let Some(given) = self.given("boundary")? else { return Ok(Boundary::default()) };
        if given.is_instance_of::<PyString>() {
            return Ok(self.choice("boundary")?.unwrap_or_default());
        }
        let angles = self.value::<BTreeMap<u32, f64>>("boundary")?.unwrap_or_default();
        let angle = |(vertex, angle)| BoundaryAngle { vertex, angle, line: None };
        Ok(Boundary::Angles(angles.into_iter().map(angle).collect()))
    }

    fn refuse_what_means_nothing(&self, kind: SolverKind, concerns: &[(&str, bool)]) -> PyResult<()> {
        for &(name, is_read) in concerns {
            if !is_read && self.given(name)?.is_some() {
                return Err(SettingError::new_err(format!(
                    "{name} means nothing to the solver '{kind}': leave it out"
                )));
            }
        }
        Ok(())
    }

    /// How a mesh becomes charts; `keeps` says whether seams are given.
    pub(crate) fn unwrap(&self, keeps: bool) -> PyResult<Unwrap> {
        let plain = Unwrap::default();
        let crease_angle = self.value::<f64>("crease_angle")?;
        if let Some(angle) = crease_angle.filter(|angle| !(0.0..=180.0).contains(angle)) {
            return Err(SettingError::new_err(format!("crease_angle must be in 0..=180 degrees, got {angle}")));
        }
        let length = self.value::<f64>("max_chart_length")?;
        Ok(Unwrap {
            pipeline: self.pipeline()?,
            seams: if keeps { SeamRule::Keep } else { SeamRule::Auto },
            holes: self.choice::<HoleRule>("holes")?.unwrap_or(plain.holes),
            max_stretch: self.value("max_stretch")?.unwrap_or(plain.max_stretch),
            max_seam: self.value("max_seam")?,
            crease_angle: crease_angle.map_or(plain.crease_angle, f64::to_radians),
            max_chart_length: length
                .map_or(plain.max_chart_length, |length| (length != f64::INFINITY).then_some(length)),
            // In an atlas a disk is a chart like all others, unless something else is said.
            cut_disks: self.value("cut_disks")?.unwrap_or(true),
            weld: self.weld()?,
            double_sided: self.choice::<DoubleSided>("double_sided")?.unwrap_or(plain.double_sided),
            strict: self.value("strict")?.unwrap_or(plain.strict),
            ..plain
        })
    }

    /// Why charts are parted when they are packed, if they may be.
    pub(crate) fn parting(&self, max_stretch: f64) -> PyResult<Option<Parting>> {
        let coverage = self.value::<f64>("coverage")?;
        let seam_budget = self.value::<f64>("seam_budget")?;
        if coverage.is_none() && seam_budget.is_some() {
            return Err(SettingError::new_err("seam_budget is what coverage may cost: give coverage, too"));
        }
        let keeps_inner_margin = self.is("inner_margin", "keep", "count")?;
        let seam_budget = seam_budget.unwrap_or(Parting::default().seam_budget);
        let parting = Parting { coverage, seam_budget, keeps_inner_margin, max_stretch };
        Ok((coverage.is_some() || keeps_inner_margin).then_some(parting))
    }

    /// Which vertices in one place are joined: `"auto"`, `"off"` or a distance.
    pub(crate) fn weld(&self) -> PyResult<Weld> {
        let Some(given) = self.given("weld")? else { return Ok(Weld::default()) };
        let weld = match given.cast::<PyString>() {
            Ok(_) => self.choice("weld")?.unwrap_or_default(),
            Err(_) => self.value("weld")?.map_or(Weld::Auto, Weld::Within),
        };
        match weld {
            Weld::Within(distance) if !(distance >= 0.0 && distance.is_finite()) => Err(SettingError::new_err(
                format!("weld must be 'auto', 'off' or a distance of at least 0, got {distance}"),
            )),
            weld => Ok(weld),
        }
    }

    /// How charts become an atlas.
    pub(crate) fn atlas(&self) -> PyResult<Atlas> {
        let plain = Atlas::default();
        let page = match (self.value::<[u32; 2]>("page")?, self.value::<u32>("resolution")?) {
            (Some(_), Some(_)) => {
                return Err(SettingError::new_err("page and resolution are both given: leave one out"));
            }
            (Some(page), None) => page,
            (None, side) => side.map_or(plain.page, |side| [side; 2]),
        };
        let shorter = page[0].min(page[1]);
        let margin = match (self.word_or::<u32>("margin", "auto")?, self.value::<u32>("mip_levels")?) {
            (Some(_), Some(_)) => {
                return Err(SettingError::new_err("mip_levels sets the margin: leave out margin, or it"));
            }
            (Some(Some(margin)), None) => margin,
            (Some(None), None) => Atlas::margin_for_mip_levels(0),
            (None, Some(levels)) => Atlas::margin_for_mip_levels(levels),
            (None, None) => plain.margin.min(shorter / 4),
        };
        Ok(Atlas {
            pages: self.choice::<AtlasPages>("atlas")?.unwrap_or(plain.pages),
            page,
            margin,
            effort: self.choice("pack")?.unwrap_or(Effort::Good),
            max_pages: self.value("max_pages")?.unwrap_or(plain.max_pages),
            texels_per_unit: self.value("texels_per_unit")?,
        })
    }
}

fn out_of_range(name: &str, allowed: &str, given: &Bound<'_, PyAny>) -> PyErr {
    let given = given.repr().map_or_else(|_| "another value".to_owned(), |text| text.to_string());
    SettingError::new_err(format!("{name} must be {allowed}, got {given}"))
}
