//! The settings of a relaxation.

use crate::EmbedError;
use abf_control::SettingError;
use std::fmt;
use std::str::FromStr;

/// What is to be little in a map.
///
/// It is read from, and written as, `abf`, `isometric`, `usable` or the number θ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Energy {
    /// The errors of angles: `Σ w (x − a)²` with the barrier of the descent. Areas are free.
    Abf,
    /// The symmetric Dirichlet energy `∫ s₁² + s₂² + s₁⁻² + s₂⁻² − 4` over the surface, its area as 1; `s₁` and `s₂` are the
    /// singular values of the map: lengths are kept.
    #[default]
    Isometric,
    /// `∫ s₁/s₂ + s₂/s₁ − 2 + θ (s₁s₂ + 1/(s₁s₂) − 2)`: angles first, areas with the weight θ, in (0, ∞).
    Slider(f64),
}

impl Energy {
    /// The slider with θ = 0.01: hardly less true in angles than the least angle energy, and areas within bounds.
    pub const USABLE: Self = Self::Slider(0.01);

    /// Checks that θ is in its range.
    ///
    /// # Errors
    /// [`SettingError`] with the range.
    pub fn check(self) -> Result<(), SettingError> {
        match self {
            Self::Slider(theta) if !(theta > 0.0 && theta.is_finite()) => {
                Err(SettingError::new("energy", "abf, isometric, usable or a positive number", theta))
            }
            Self::Slider(_) | Self::Abf | Self::Isometric => Ok(()),
        }
    }
}

impl fmt::Display for Energy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Abf => f.write_str("abf"),
            Self::Isometric => f.write_str("isometric"),
            Self::Slider(theta) if Self::Slider(*theta) == Self::USABLE => f.write_str("usable"),
            Self::Slider(theta) => theta.fmt(f),
        }
    }
}

impl FromStr for Energy {
    type Err = SettingError;

    fn from_str(s: &str) -> Result<Self, SettingError> {
        let energy = match s {
            "abf" => Self::Abf,
            "isometric" => Self::Isometric,
            "usable" => Self::USABLE,
            // A word is no number, which is out of range.
            other => Self::Slider(other.parse().unwrap_or(f64::NAN)),
        };
        let wrong = |error: SettingError| SettingError::new(error.name, error.allowed, format_args!("'{s}'"));
        energy.check().map(|()| energy).map_err(wrong)
    }
}

/// The settings of a relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default, deny_unknown_fields))]
pub struct Relax {
    /// What is to be little.
    pub energy: Energy,
    /// Converged means that a full step promises to lower the energy by no more than half of this share of it; beside
    /// [`Energy::Abf`] the weight of the barrier counts for every angle.
    pub energy_tolerance: f64,
    /// At most so many steps, progressive ones included, of which there are at most 140.
    pub max_steps: usize,
    /// The weight of the barrier beside [`Energy::Abf`], as [`Descent::barrier_floor`](crate::Descent::barrier_floor).
    pub barrier: f64,
}

impl Default for Relax {
    fn default() -> Self {
        Self { energy: Energy::default(), energy_tolerance: 1e-6, max_steps: 400, barrier: 1e-3 }
    }
}

impl Relax {
    /// Checks that every setting is in its range; [`Relax::solve`] calls it first.
    ///
    /// # Errors
    /// [`EmbedError::Setting`] naming the setting and its range.
    pub fn check(&self) -> Result<(), EmbedError> {
        self.energy.check()?;
        for (name, value) in [("energy_tolerance", self.energy_tolerance), ("barrier", self.barrier)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SettingError::new(name, "positive and finite", value).into());
            }
        }
        if self.max_steps == 0 {
            return Err(SettingError::new("max_steps", "at least 1", 0).into());
        }
        Ok(())
    }
}
