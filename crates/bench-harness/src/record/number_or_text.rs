//! Settings that are a number, or a word where the program chooses.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::fmt::Display;
use std::str::FromStr;

/// As it is in the JSON.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum NumberOrText {
    Count(u64),
    Number(f64),
    Text(String),
}

/// A number where the text is one.
pub(super) fn serialize<S: Serializer>(value: &Option<impl Display>, serializer: S) -> Result<S::Ok, S::Error> {
    let shown = value.as_ref().map(|value| {
        let text = value.to_string();
        let count = text.parse().map(NumberOrText::Count);
        count.or_else(|_| text.parse().map(NumberOrText::Number)).unwrap_or(NumberOrText::Text(text))
    });
    shown.serialize(serializer)
}

pub(super) fn deserialize<'de, T, D>(deserializer: D) -> Result<Option<T>, D::Error>
where
    T: FromStr<Err: Display>,
    D: Deserializer<'de>,
{
    let read = Option::<NumberOrText>::deserialize(deserializer)?;
    let text = read.map(|read| match read {
        NumberOrText::Count(n) => n.to_string(),
        NumberOrText::Number(x) => x.to_string(),
        NumberOrText::Text(text) => text,
    });
    text.map(|text| text.parse()).transpose().map_err(de::Error::custom)
}
