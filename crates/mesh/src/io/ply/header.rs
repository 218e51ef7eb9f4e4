//! The header of a PLY file: text up to `end_header`, whatever follows.

use std::str::FromStr;

use crate::io::error::{FilePlace, Location, ReadError};
use crate::io::text::{integer, quote};

/// How the values are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Words, one row per line.
    Ascii,
    /// Bytes, the lowest first.
    LittleEndian,
    /// Bytes, the highest first.
    BigEndian,
}

/// The type of a value. All of them fit in an `f64` without loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// How many bytes one takes in a binary file.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Scalar {
    /// Its name in a header.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    /// Appends a value that was read as this type: its bytes, the lowest first. Of a text, what the type cannot hold is
    /// rounded to what it can.
    pub(super) fn append(self, block: &mut Vec<u8>, value: f64) {
        match self {
            Self::I8 => block.extend_from_slice(&(value as i8).to_le_bytes()),
            Self::U8 => block.push(value as u8),
            Self::I16 => block.extend_from_slice(&(value as i16).to_le_bytes()),
            Self::U16 => block.extend_from_slice(&(value as u16).to_le_bytes()),
            Self::I32 => block.extend_from_slice(&(value as i32).to_le_bytes()),
            Self::U32 => block.extend_from_slice(&(value as u32).to_le_bytes()),
            Self::F32 => block.extend_from_slice(&(value as f32).to_le_bytes()),
            Self::F64 => block.extend_from_slice(&value.to_le_bytes()),
        }
    }
}

impl FromStr for Scalar {
    type Err = ();

    fn from_str(word: &str) -> Result<Self, ()> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(()),
        })
    }
}

/// One property: one value per row, or a list of values whose length is stored before them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the length, for a list.
    pub(super) length: Option<Scalar>,
    pub(super) value: Scalar,
}

/// One table of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) rows: usize,
    pub(super) properties: Vec<Property>,
    /// The line of the header that declares it.
    pub(super) line: usize,
}

impl Element {
    /// The fewest bytes that all its rows can take.
    fn least_bytes(&self, encoding: Encoding) -> usize {
        let least = |p: &Property| match encoding {
            // A digit, and a blank or the end of the line.
            Encoding::Ascii => 2,
            _ => p.length.unwrap_or(p.value).size(),
        };
        self.rows.saturating_mul(self.properties.iter().map(least).sum())
    }
}

/// The tables of a file, in the order of their rows.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the rows begin.
    pub(super) bytes: usize,
    /// How many lines the header has.
    pub(super) lines: usize,
}

impl Header {
    /// Reads the header of a file and checks that its claims fit in the bytes that follow.
    pub(super) fn parse(file: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        let mut parser = Parser { file, line: 0, encoding: None, elements: Vec::new() };
        let line_end = line_end(bytes);
        let mut taken = 0;
        loop {
            let Some(length) = bytes[taken..].iter().position(|&byte| byte == line_end) else {
                let missing = if taken == 0 { "the end of its first line" } else { "end_header" };
                return Err(ReadError::UnexpectedEnd { file: file.to_owned(), missing: missing.to_owned() });
            };
            let line = &bytes[taken..taken + length];
            taken += length + 1;
            if parser.line(line)? {
                break;
            }
        }
        let header = parser.finish(taken)?;
        header.check_claims(file, bytes.len() - taken)?;
        Ok(header)
    }

    fn check_claims(&self, file: &str, present: usize) -> Result<(), ReadError> {
        let mut needed = 0_usize;
        for element in &self.elements {
            needed = needed.saturating_add(element.least_bytes(self.encoding));
            // The last line of a text need not have an end.
            if needed > present + usize::from(self.encoding == Encoding::Ascii) {
                let at = Location { file: file.to_owned(), place: FilePlace::Line(element.line) };
                let (what, claimed) = (element.name.clone(), element.rows);
                return Err(ReadError::ClaimTooLarge { at, what, claimed, present });
            }
        }
        Ok(())
    }
}

/// The byte that ends the lines of the header: CR if the first line ends with CR alone. Deciding
/// anew for every line would take a first data byte of 10 for a part of the last line's end.
fn line_end(bytes: &[u8]) -> u8 {
    match bytes.iter().position(|&byte| byte == b'\n' || byte == b'\r') {
        Some(i) if bytes[i] == b'\r' && bytes.get(i + 1) != Some(&b'\n') => b'\r',
        // The CR of CR LF is a blank at the end of the line.
        _ => b'\n',
    }
}

struct Parser<'a> {
    file: &'a str,
    /// The number of the current line.
    line: usize,
    encoding: Option<Encoding>,
    elements: Vec<Element>,
}

impl Parser<'_> {
    fn at(&self) -> Location {
        Location { file: self.file.to_owned(), place: FilePlace::Line(self.line) }
    }

    fn bad(&self, reason: impl Into<String>) -> ReadError {
        ReadError::BadHeader { at: self.at(), reason: reason.into() }
    }

    /// Takes one line; whether it was the last.
    fn line(&mut self, text: &[u8]) -> Result<bool, ReadError> {
        self.line += 1;
        let words: Vec<&[u8]> = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
        if self.line == 1 {
            return if words == [b"ply"] { Ok(false) } else { Err(self.bad("the first line is not `ply`")) };
        }
        match words.as_slice() {
            [b"end_header"] => return Ok(true),
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, version] => self.encoding = Some(self.encoding(name, version)?),
            [b"element", name, rows] => {
                let element = self.element(name, rows)?;
                self.elements.push(element);
            }
            [b"property", b"list", length, value, name] => {
                let length = Some(self.scalar(length)?);
                self.property(length, value, name)?;
            }
            [b"property", value, name] => self.property(None, value, name)?,
            _ => return Err(self.bad(format!("`{}` is not understood", quote(text)))),
        }
        Ok(false)
    }

    fn encoding(&self, name: &[u8], version: &[u8]) -> Result<Encoding, ReadError> {
        if version != b"1.0" {
            let feature = format!("version {} of PLY", quote(version));
            return Err(ReadError::Unsupported { at: self.at(), feature });
        }
        match name {
            b"ascii" => Ok(Encoding::Ascii),
            b"binary_little_endian" => Ok(Encoding::LittleEndian),
            b"binary_big_endian" => Ok(Encoding::BigEndian),
            _ => Err(self.bad(format!("there is no format `{}`", quote(name)))),
        }
    }

    fn element(&self, name: &[u8], rows: &[u8]) -> Result<Element, ReadError> {
        let name = String::from_utf8_lossy(name).into_owned();
        let bad_count = || self.bad(format!("the number of `{name}` is `{}`", quote(rows)));
        let rows = integer(rows).ok_or_else(bad_count)?;
        if self.elements.iter().any(|e| e.name == name) {
            return Err(self.bad(format!("a second element `{name}`")));
        }
        Ok(Element { name, rows, properties: Vec::new(), line: self.line })
    }

    fn property(&mut self, length: Option<Scalar>, value: &[u8], name: &[u8]) -> Result<(), ReadError> {
        let value = self.scalar(value)?;
        let name = String::from_utf8_lossy(name).into_owned();
        let orphan = self.bad(format!("property `{name}` before the first element"));
        self.elements.last_mut().ok_or(orphan)?.properties.push(Property { name, length, value });
        Ok(())
    }

    fn scalar(&self, word: &[u8]) -> Result<Scalar, ReadError> {
        let scalar = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        scalar.ok_or_else(|| self.bad(format!("there is no type `{}`", quote(word))))
    }

    fn finish(self, bytes: usize) -> Result<Header, ReadError> {
        let Some(encoding) = self.encoding else { return Err(self.bad("no format is named")) };
        Ok(Header { encoding, elements: self.elements, bytes, lines: self.line })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_data_byte_is_no_line_end_whatever_it_is() {
        for line_end in ["\n", "\r\n", "\r"] {
            let lines =
                ["ply", "format binary_little_endian 1.0", "element vertex 2", "property uchar x", "end_header"];
            let head: String = lines.iter().flat_map(|line| [line, line_end]).collect();
            let header = Header::parse("f", &[head.as_bytes(), b"\n\r"].concat()).expect("a header");
            assert_eq!((header.bytes, header.lines), (head.len(), 5), "{line_end:?}");
        }
    }
}
