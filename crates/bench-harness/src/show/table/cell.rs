//! One value of a table, before it is text.

use crate::record::number::{megabytes, seconds, significant};

/// Where there is nothing to show, for people.
const NOTHING: &str = "-";

/// A value with what it means, so that people get its digits and programs all of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// No value.
    Nothing,
    /// Words.
    Text(String),
    /// How many.
    Count(usize),
    /// How many more or fewer.
    Change(i64),
    /// A number, and how many of its digits matter.
    Figure(f64, usize),
    /// New divided by old.
    Ratio(f64),
    /// Seconds.
    Seconds(f64),
    /// Bytes.
    Bytes(usize),
}

impl Cell {
    /// As people read it.
    pub(crate) fn for_people(&self) -> String {
        const RATIO_DIGITS: usize = 4;
        match self {
            Self::Nothing => NOTHING.to_owned(),
            Self::Text(text) => text.clone(),
            Self::Count(n) => n.to_string(),
            Self::Change(0) => "same".to_owned(),
            Self::Change(n) => format!("{n:+}"),
            Self::Figure(x, digits) => significant(*x, *digits),
            Self::Ratio(1.0) => "same".to_owned(),
            Self::Ratio(x) => format!("×{}", significant(*x, RATIO_DIGITS)),
            Self::Seconds(s) => seconds(*s),
            Self::Bytes(bytes) => megabytes(*bytes),
        }
    }

    /// As a page sorts and shows it.
    pub(crate) fn for_page(&self) -> abf_report::page::Cell {
        use abf_report::page::Cell as PageCell;
        let shown = self.for_people();
        match self {
            Self::Nothing => PageCell::Missing,
            Self::Text(_) => PageCell::Text(shown),
            Self::Count(n) | Self::Bytes(n) => PageCell::Number { value: *n as f64, shown },
            Self::Change(n) => PageCell::Number { value: *n as f64, shown },
            Self::Figure(x, _) | Self::Ratio(x) | Self::Seconds(x) => PageCell::Number { value: *x, shown },
        }
    }

    /// As programs read it: all digits, base units, nothing where there is nothing or no finite number.
    pub(crate) fn for_programs(&self) -> String {
        match self {
            Self::Nothing => String::new(),
            Self::Text(text) => text.clone(),
            Self::Count(n) | Self::Bytes(n) => n.to_string(),
            Self::Change(n) => n.to_string(),
            Self::Figure(x, _) | Self::Ratio(x) | Self::Seconds(x) if x.is_finite() => format!("{x:e}"),
            Self::Figure(..) | Self::Ratio(_) | Self::Seconds(_) => String::new(),
        }
    }
}

impl From<Option<Self>> for Cell {
    fn from(cell: Option<Self>) -> Self {
        cell.unwrap_or(Self::Nothing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_get_the_digits_that_matter_and_programs_all() {
        for (cell, people, programs) in [
            (Cell::Nothing, "-", ""),
            (Cell::Figure(1.0 / 3.0, 2), "0.33", "3.333333333333333e-1"),
            (Cell::Figure(f64::INFINITY, 2), "infinite", ""),
            (Cell::Change(-3), "-3", "-3"),
            (Cell::Change(2), "+2", "2"),
            (Cell::Ratio(1.0), "same", "1e0"),
            (Cell::Ratio(1.25), "×1.250", "1.25e0"),
            (Cell::Seconds(0.5), "0.500 s", "5e-1"),
            (Cell::Bytes(2_000_000), "2.0", "2000000"),
        ] {
            assert_eq!((cell.for_people().as_str(), cell.for_programs().as_str()), (people, programs), "{cell:?}");
        }
    }
}
