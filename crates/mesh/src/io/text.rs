//! Lines and words of text formats, as bytes: no line is copied, and none need be UTF-8.

use super::error::{FilePlace, Location, ReadError};

/// The longest piece of a file that a message repeats, in characters.
const LONGEST_QUOTE: usize = 40;

/// The lines of a text, which end with LF, CR LF or CR; a byte-order mark is skipped.
pub(super) struct Lines<'a> {
    file: &'a str,
    bytes: &'a [u8],
    /// How many bytes have been taken.
    taken: usize,
    /// How many lines have been taken.
    number: usize,
}

/// One line, without its end.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    file: &'a str,
    /// Counted from 1.
    number: usize,
    text: &'a [u8],
}

/// The words of a line; a word that begins with `#` ends them.
#[derive(Clone)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Lines<'a> {
    /// The lines of a file.
    pub(super) fn new(file: &'a str, bytes: &'a [u8]) -> Self {
        Self::after(file, without_mark(bytes), 0)
    }

    /// The lines of what follows the first `number` lines of a file.
    pub(super) fn after(file: &'a str, bytes: &'a [u8], number: usize) -> Self {
        Self { file, bytes, taken: 0, number }
    }

    /// How many bytes are left.
    pub(super) fn bytes_left(&self) -> usize {
        self.bytes.len() - self.taken
    }

    /// How many bytes have been taken, with the ends of their lines.
    pub(super) fn taken(&self) -> usize {
        self.taken
    }

    /// The next line with at least one word.
    pub(super) fn next_with_words(&mut self) -> Option<Line<'a>> {
        self.find(|line| line.words().next().is_some())
    }

    /// The next line together with those that continue it: all but the last end with `\`.
    /// Comments are not continued, so that a path in a comment swallows nothing.
    pub(super) fn next_joined(&mut self) -> Option<Line<'a>> {
        let start = self.taken;
        let mut line = self.next()?;
        let mut last = line.text;
        while last.ends_with(b"\\") && !has_comment(last) {
            let before = self.taken;
            let Some(more) = self.next() else { break };
            last = more.text;
            line.text = &self.bytes[start..before + last.len()];
        }
        Some(line)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let rest = &self.bytes[self.taken..];
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        let (text, end) = rest.split_at(length);
        let end = if end.starts_with(b"\r\n") { 2 } else { end.len().min(1) };
        self.taken += length + end;
        self.number += 1;
        Some(Line { file: self.file, number: self.number, text })
    }
}

impl<'a> Line<'a> {
    /// A line without words, before the first line is read.
    pub(super) fn empty(file: &'a str) -> Self {
        Self { file, number: 0, text: &[] }
    }

    /// The line itself.
    pub(super) fn text(&self) -> &'a [u8] {
        self.text
    }

    /// The words of this line.
    pub(super) fn words(&self) -> Words<'a> {
        Words::of(self.text)
    }

    /// Where this line is.
    pub(super) fn place(&self) -> FilePlace {
        FilePlace::Line(self.number)
    }

    /// Where this line is, with the name of the file.
    pub(super) fn at(&self) -> Location {
        Location { file: self.file.to_owned(), place: self.place() }
    }

    /// The number that a word stands for, finite or not.
    pub(super) fn number(&self, word: &[u8]) -> Result<f64, ReadError> {
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| ReadError::BadNumber { at: self.at(), text: quote(word) })
    }

    /// The next `N` words as numbers.
    pub(super) fn numbers<const N: usize>(&self, words: &mut Words<'_>) -> Result<[f64; N], ReadError> {
        let mut numbers = [0.0; N];
        for (found, number) in numbers.iter_mut().enumerate() {
            let missing = || ReadError::MissingCoordinate { at: self.at(), found, expected: N };
            *number = self.number(words.next().ok_or_else(missing)?)?;
        }
        Ok(numbers)
    }

    /// The whole number that a word stands for.
    pub(super) fn index(&self, word: &[u8]) -> Result<i64, ReadError> {
        integer(word).ok_or_else(|| ReadError::BadIndex { at: self.at(), text: quote(word) })
    }
}

impl<'a> Words<'a> {
    /// The words of a line without its end.
    pub(super) fn of(line: &'a [u8]) -> Self {
        Self { rest: line }
    }

    /// How many bytes are behind the last word that was taken.
    pub(super) fn bytes_left(&self) -> usize {
        self.rest.len()
    }

    /// What is left of the line, as text without blanks around it.
    pub(super) fn remainder(&self) -> String {
        String::from_utf8_lossy(self.rest.trim_ascii()).into_owned()
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let text = self.rest;
        let start = (0..text.len()).find(|&i| !separates(text, i))?;
        if text[start] == b'#' {
            self.rest = &[];
            return None;
        }
        let end = (start..text.len()).find(|&i| separates(text, i)).unwrap_or(text.len());
        self.rest = &text[end..];
        Some(&text[start..end])
    }
}

/// The text without a byte-order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    const UTF_8_MARK: &[u8] = b"\xef\xbb\xbf";
    bytes.strip_prefix(UTF_8_MARK).unwrap_or(bytes)
}

/// A whole number in decimal digits, perhaps with a sign.
pub(super) fn integer<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A piece of a file as a message repeats it: printable and not too long.
pub(super) fn quote(bytes: &[u8]) -> String {
    // A character has at most four bytes: what lies beyond need not be decoded.
    let head = &bytes[..bytes.len().min(4 * LONGEST_QUOTE)];
    let text: String = String::from_utf8_lossy(head).chars().take(LONGEST_QUOTE).collect();
    if text.chars().any(char::is_control) { text.escape_debug().to_string() } else { text }
}

/// Whether the byte at `i` is no part of a word: a blank, or the `\` of a continued line.
fn separates(text: &[u8], i: usize) -> bool {
    match text[i] {
        b'\\' => matches!(text.get(i + 1), None | Some(b'\r' | b'\n')),
        byte => is_blank(byte),
    }
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | 0x0b | 0x0c)
}

/// Whether a word of this line begins with `#`.
fn has_comment(text: &[u8]) -> bool {
    text.iter().enumerate().any(|(i, &b)| b == b'#' && (i == 0 || is_blank(text[i - 1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &Line<'_>) -> Vec<String> {
        line.words().map(quote).collect()
    }

    #[test]
    fn lines_end_with_any_of_the_three_ends_and_are_numbered() {
        let lines: Vec<Line<'_>> = Lines::new("t", b"\xef\xbb\xbfa\r\nb\n\rc\r\n\nd").collect();
        let texts: Vec<&[u8]> = lines.iter().map(|l| l.text).collect();
        assert_eq!(texts, [b"a" as &[u8], b"b", b"", b"c", b"", b"d"]);
        assert_eq!(lines[5].place(), FilePlace::Line(6));
    }

    #[test]
    fn a_backslash_joins_lines_but_not_comments() {
        let text = b"f 1 \\\r\n 2\\\n3 # x \\\nv 1 # C:\\\nv 2\\";
        let mut lines = Lines::new("t", text);
        let joined: Vec<Line<'_>> = std::iter::from_fn(|| lines.next_joined()).collect();
        assert_eq!(
            joined.iter().map(words).collect::<Vec<_>>(),
            [vec!["f", "1", "2", "3"], vec!["v", "1"], vec!["v", "2"]]
        );
        assert_eq!(joined.iter().map(|l| l.number).collect::<Vec<_>>(), [1, 4, 5]);
    }

    #[test]
    fn a_number_sign_inside_a_word_is_no_comment() {
        let line = Lines::new("t", b"\tusemtl\x0b red#2  #3").next().expect("a line");
        assert_eq!(words(&line), ["usemtl", "red#2"]);
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b"a\x00b"), "a\\0b");
        assert_eq!(quote(&[b'x'; 9999]).len(), LONGEST_QUOTE);
    }
}
