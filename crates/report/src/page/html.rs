//! Writing HTML: escaping, and the few forms that occur all over the page.

use std::borrow::Cow;

/// What stands in a cell without content: a dash to see, a word to hear.
pub(crate) const NOTHING: &str = "<span aria-hidden=\"true\">–</span><span class=\"unseen\">none</span>";

/// Text as HTML, in an element or in a quoted attribute. Control characters, which HTML does not
/// allow, become the replacement character.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() => out.push(char::REPLACEMENT_CHARACTER),
            c => out.push(c),
        }
    }
    out
}

/// HTML under construction. What comes in as text is escaped; markup goes through [`raw`](Self::raw).
#[derive(Clone, Debug, Default)]
pub(crate) struct Html(String);

impl Html {
    /// Appends markup as it is.
    pub(crate) fn raw(&mut self, markup: &str) {
        self.0.push_str(markup);
    }

    /// Appends text.
    pub(crate) fn text(&mut self, text: &str) {
        self.0.push_str(&escape(text));
    }

    /// Appends an element with escaped text; `attributes` is markup.
    pub(crate) fn element(&mut self, tag: &str, attributes: &str, text: &str) {
        let space = if attributes.is_empty() { "" } else { " " };
        self.raw(&format!("<{tag}{space}{attributes}>{}</{tag}>", escape(text)));
    }

    /// Appends a table in a container of its own that scrolls where the page is too narrow.
    ///
    /// `heads` are the columns; every column but the first has numbers if its flag says so.
    pub(crate) fn table(&mut self, caption: &str, heads: &[(Cow<'_, str>, bool)], rows: &str) {
        self.raw(&format!(
            "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n",
            escape(caption)
        ));
        self.raw("<table class=\"sortable\">\n");
        self.element("caption", "", caption);
        self.raw("\n<thead><tr>");
        for (head, is_number) in heads {
            self.element("th", if *is_number { "scope=\"col\" class=\"number\"" } else { "scope=\"col\"" }, head);
        }
        self.raw("</tr></thead>\n<tbody>\n");
        self.raw(rows);
        self.raw("</tbody>\n</table>\n</div>\n");
    }

    /// The markup.
    pub(crate) fn finish(self) -> String {
        self.0
    }
}

/// The attribute by which a cell is sorted: its number, or that it has none.
pub(crate) fn sort_attribute(value: f64) -> String {
    if value.is_nan() {
        return "data-missing".to_owned();
    }
    // JavaScript writes infinity in full.
    let number = if value.is_infinite() {
        format!("{}Infinity", if value < 0.0 { "-" } else { "" })
    } else {
        format!("{value:e}")
    };
    format!("data-number=\"{number}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_text_is_harmless() {
        assert_eq!(
            escape("<script>alert('\"&')</script>"),
            "&lt;script&gt;alert(&#39;&quot;&amp;&#39;)&lt;/script&gt;"
        );
        assert_eq!(escape("a\0b\u{7f}c\nd é"), "a\u{fffd}b\u{fffd}c\nd é");
    }

    #[test]
    fn a_cell_is_sorted_by_a_number_that_javascript_reads() {
        assert_eq!(sort_attribute(5.042e-3), "data-number=\"5.042e-3\"");
        assert_eq!(sort_attribute(f64::NEG_INFINITY), "data-number=\"-Infinity\"");
        assert_eq!(sort_attribute(f64::NAN), "data-missing");
    }
}
