//! Text that people write by hand: a list with a line for each thing, and comments.

/// The lines that say something, counted from 1, without spaces at their ends and without the comment that `#` begins.
///
/// A byte-order mark is skipped, which some editors put first.
///
/// ```
/// let lines: Vec<_> = abf_mesh::text::lines("\u{feff}# corners\n3 1.5 # here\n\n").collect();
/// assert_eq!(lines, [(2, "3 1.5")]);
/// ```
pub fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = without_mark(text).lines().enumerate();
    numbered
        .map(|(k, line)| (k + 1, line.split('#').next().unwrap_or_default().trim()))
        .filter(|(_, line)| !line.is_empty())
}

/// A text without its byte-order mark.
#[must_use]
pub fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}
