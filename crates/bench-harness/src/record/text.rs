//! Values that are names in JSON.

use abf::Termination;
use serde::{Deserialize, Deserializer, Serializer, de};
use std::borrow::Cow;
use std::fmt::Display;
use std::str::FromStr;

pub(crate) fn serialize<S: Serializer>(value: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

pub(crate) fn deserialize<'de, T, D>(deserializer: D) -> Result<T, D::Error>
where
    T: FromStr<Err: Display>,
    D: Deserializer<'de>,
{
    Cow::<'de, str>::deserialize(deserializer)?.parse().map_err(de::Error::custom)
}

/// The same of values that may be absent.
pub(super) mod optional {
    use super::{Cow, Deserialize, Deserializer, Display, FromStr, Serializer, de};

    pub(crate) fn serialize<S: Serializer>(value: &Option<impl Display>, serializer: S) -> Result<S::Ok, S::Error> {
        match value {
            Some(value) => serializer.collect_str(value),
            None => serializer.serialize_none(),
        }
    }

    pub(crate) fn deserialize<'de, T, D>(deserializer: D) -> Result<Option<T>, D::Error>
    where
        T: FromStr<Err: Display>,
        D: Deserializer<'de>,
    {
        let name = Option::<Cow<'de, str>>::deserialize(deserializer)?;
        name.map(|name| name.parse()).transpose().map_err(de::Error::custom)
    }
}

/// How a solver ended.
pub(super) mod ending {
    pub(crate) use super::serialize;
    use super::{Cow, Deserialize, Deserializer, Termination, de};

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Termination, D::Error> {
        let name = Cow::<'de, str>::deserialize(deserializer)?;
        super::termination(&name).ok_or_else(|| de::Error::unknown_variant(&name, &[]))
    }

    /// The same of rungs that may have found nothing.
    pub(crate) mod optional {
        pub(crate) use super::super::optional::serialize;
        use super::{Cow, Deserialize, Deserializer, Termination, de};

        pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Termination>, D::Error> {
            let Some(name) = Option::<Cow<'de, str>>::deserialize(deserializer)? else { return Ok(None) };
            let termination = super::super::termination(&name);
            termination.map(Some).ok_or_else(|| de::Error::unknown_variant(&name, &[]))
        }
    }
}

/// The ways a solver can end, by name.
fn termination(name: &str) -> Option<Termination> {
    use Termination::{Cancelled, Converged, MaxIterations, OnePass, Stalled, TimeLimit};
    let all = [Converged, OnePass, MaxIterations, TimeLimit, Stalled, Cancelled];
    all.into_iter().find(|termination| termination.to_string() == name)
}
