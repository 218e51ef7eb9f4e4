//! The rows of a PLY file, value by value, from words or from bytes.

use super::header::{Element, Encoding, Header, Scalar};
use crate::io::error::{FilePlace, Location, ReadError};
use crate::io::text::{Line, Lines, Words};

/// Where values come from: a row is begun, then its values are taken in their order.
pub(super) trait Rows {
    /// Begins the next row, which is the `row`-th of its element.
    fn begin(&mut self, element: &Element, row: usize) -> Result<(), ReadError>;

    /// The next value of the row; `name` is its property.
    fn value(&mut self, scalar: Scalar, name: &str) -> Result<f64, ReadError>;

    /// Skips `count` values of one type.
    fn skip(&mut self, scalar: Scalar, count: usize, name: &str) -> Result<(), ReadError>;

    /// Where the row begins.
    fn place(&self) -> FilePlace;

    /// Where the row begins, with the name of the file.
    fn at(&self) -> Location;

    /// What is left when all rows are taken: of what, and how much.
    fn left_over(&mut self) -> Vec<(&'static str, usize)>;

    /// The length of a list, whose values are still to be taken.
    fn length(&mut self, scalar: Scalar, name: &str) -> Result<usize, ReadError> {
        let length = self.value(scalar, name)?;
        let bad = || ReadError::BadListLength {
            at: self.at(),
            list: name.to_owned(),
            length,
            expected: "a whole number that is not negative".to_owned(),
        };
        whole(length).and_then(|n| usize::try_from(n).ok()).ok_or_else(bad)
    }
}

/// The whole number that a value is, if it is one.
pub(super) fn whole(value: f64) -> Option<i64> {
    // Below 2⁵³: every whole number up to here is exact, and it is far beyond all 32-bit types.
    const LARGEST: f64 = 9e15;
    (value.fract() == 0.0 && value.abs() <= LARGEST).then_some(value as i64)
}

/// Rows as lines; lines without a word are skipped.
pub(super) struct TextRows<'a> {
    file: &'a str,
    lines: Lines<'a>,
    line: Line<'a>,
    /// What is left of the line.
    words: Words<'a>,
    /// How many rows had more words than values.
    overlong: usize,
}

impl<'a> TextRows<'a> {
    /// The rows after the header.
    pub(super) fn new(file: &'a str, bytes: &'a [u8], header: &Header) -> Self {
        let lines = Lines::after(file, &bytes[header.bytes..], header.lines);
        let line = Line::empty(file);
        Self { file, lines, line, words: line.words(), overlong: 0 }
    }

    fn end_line(&mut self) {
        self.overlong += usize::from(self.words.next().is_some());
    }
}

impl Rows for TextRows<'_> {
    fn begin(&mut self, element: &Element, row: usize) -> Result<(), ReadError> {
        self.end_line();
        let missing = || format!("`{}` {row} of {}", element.name, element.rows);
        let end = || ReadError::UnexpectedEnd { file: self.file.to_owned(), missing: missing() };
        self.line = self.lines.next_with_words().ok_or_else(end)?;
        self.words = self.line.words();
        Ok(())
    }

    fn value(&mut self, _: Scalar, name: &str) -> Result<f64, ReadError> {
        let missing = || ReadError::MissingValue { at: self.line.at(), what: format!("a value of `{name}`") };
        let word = self.words.next().ok_or_else(missing)?;
        self.line.number(word)
    }

    fn skip(&mut self, scalar: Scalar, count: usize, name: &str) -> Result<(), ReadError> {
        // However large a false count is, the words of the line end before.
        (0..count).try_for_each(|_| self.value(scalar, name).map(drop))
    }

    fn place(&self) -> FilePlace {
        self.line.place()
    }

    fn at(&self) -> Location {
        self.line.at()
    }

    fn left_over(&mut self) -> Vec<(&'static str, usize)> {
        self.end_line();
        let lines = std::iter::from_fn(|| self.lines.next_with_words()).count();
        vec![("values at the end of a line", self.overlong), ("line after the last row", lines)]
    }
}

/// Rows as bytes without gaps.
pub(super) struct BinaryRows<'a> {
    file: &'a str,
    bytes: &'a [u8],
    /// The byte that is next.
    next: usize,
    /// The first byte of the current row.
    start: usize,
    big_endian: bool,
}

impl<'a> BinaryRows<'a> {
    /// The rows after the header.
    pub(super) fn new(file: &'a str, bytes: &'a [u8], header: &Header) -> Self {
        let big_endian = header.encoding == Encoding::BigEndian;
        Self { file, bytes, next: header.bytes, start: header.bytes, big_endian }
    }

    /// The next `count` bytes.
    fn take(&mut self, count: usize) -> Result<&'a [u8], ReadError> {
        let end = self.next.saturating_add(count);
        let present = self.bytes.len();
        let truncated = || ReadError::Truncated { file: self.file.to_owned(), expected: end, present };
        let taken = self.bytes.get(self.next..end).ok_or_else(truncated)?;
        self.next = end;
        Ok(taken)
    }

    /// The next `N` bytes, the lowest first.
    fn array<const N: usize>(&mut self) -> Result<[u8; N], ReadError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        if self.big_endian {
            array.reverse();
        }
        Ok(array)
    }
}

impl Rows for BinaryRows<'_> {
    fn begin(&mut self, _: &Element, _: usize) -> Result<(), ReadError> {
        self.start = self.next;
        Ok(())
    }

    fn value(&mut self, scalar: Scalar, _: &str) -> Result<f64, ReadError> {
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes(self.array()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.array()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.array()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.array()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.array()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.array()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.array()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.array()?),
        })
    }

    fn skip(&mut self, scalar: Scalar, count: usize, _: &str) -> Result<(), ReadError> {
        self.take(scalar.size().saturating_mul(count)).map(drop)
    }

    fn place(&self) -> FilePlace {
        FilePlace::Byte(self.start)
    }

    fn at(&self) -> Location {
        Location { file: self.file.to_owned(), place: self.place() }
    }

    fn left_over(&mut self) -> Vec<(&'static str, usize)> {
        vec![("byte after the last row", self.bytes.len() - self.next)]
    }
}
