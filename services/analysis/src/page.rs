//! HTML pages that need nothing beside themselves.

use std::fmt::Display;

const STYLE: &str = include_str!("page/style.css");

/// Columns with a cell of more characters are broken into lines.
const LONGEST_UNBROKEN: usize = 44;

/// A page under construction.
pub(crate) struct Page {
    text: String,
}

impl Page {
    pub(crate) fn new(title: &str) -> Self {
        let title = escaped(title);
        Self {
            text: format!(
                "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
                 <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
                 <title>{title}</title>\n<style>\n{STYLE}</style>\n<main>\n<h1>{title}</h1>\n"
            ),
        }
    }

    /// Adds markup as it is.
    pub(crate) fn raw(&mut self, markup: &str) {
        self.text.push_str(markup);
        self.text.push('\n');
    }

    pub(crate) fn heading(&mut self, level: u8, text: &str) {
        self.raw(&format!("<h{level}>{}</h{level}>", escaped(text)));
    }

    pub(crate) fn paragraph(&mut self, text: &str) {
        self.raw(&format!("<p>{}</p>", escaped(text)));
    }

    /// A table; columns of numbers stand to the right, long texts are broken.
    pub(crate) fn table(
        &mut self,
        caption: &str,
        head: &[&str],
        rows: impl IntoIterator<Item = Vec<String>>,
    ) {
        let rows: Vec<Vec<String>> = rows.into_iter().collect();
        let is_numeric = |column: usize| {
            let mut cells = rows.iter().filter_map(|row| row.get(column));
            !rows.is_empty() && cells.all(|cell| is_number(cell))
        };
        let is_prose = |column: usize| {
            rows.iter().filter_map(|row| row.get(column)).any(|cell| cell.chars().count() > LONGEST_UNBROKEN)
        };
        let class = |column: usize| match (is_numeric(column), is_prose(column)) {
            (true, _) => " class=\"n\"",
            (false, true) => " class=\"t\"",
            (false, false) => "",
        };
        let class: Vec<&str> = (0..head.len()).map(class).collect();
        let cell =
            |tag: &str, (text, class): (&str, &&str)| format!("<{tag}{class}>{}</{tag}>", escaped(text));
        self.text.push_str("<div class=\"wide\"><table>\n");
        if !caption.is_empty() {
            self.raw(&format!("<caption><span>{}</span></caption>", escaped(caption)));
        }
        let names: String = head.iter().copied().zip(&class).map(|named| cell("th", named)).collect();
        self.raw(&format!("<thead><tr>{names}</tr></thead><tbody>"));
        for row in &rows {
            let cells: String =
                row.iter().map(String::as_str).zip(&class).map(|named| cell("td", named)).collect();
            self.raw(&format!("<tr>{cells}</tr>"));
        }
        self.raw("</tbody></table></div>");
    }

    /// A drawing in a box of its own.
    pub(crate) fn drawing(&mut self, svg: &str, caption: &str) {
        let caption = if caption.is_empty() {
            String::new()
        } else {
            format!("<figcaption>{}</figcaption>", escaped(caption))
        };
        self.raw(&format!("<figure>{svg}{caption}</figure>"));
    }

    /// A picture with its caption, its file within the page.
    pub(crate) fn picture(&mut self, media_type: &str, base64: &str, caption: &str) {
        let caption = escaped(caption);
        self.raw(&format!(
            "<figure><img alt=\"{caption}\" src=\"data:{media_type};base64,{base64}\"><figcaption>{caption}</figcaption></figure>"
        ));
    }

    pub(crate) fn finish(mut self) -> String {
        self.text.push_str("</main>\n</html>\n");
        self.text
    }
}

fn is_number(cell: &str) -> bool {
    cell == "–" || cell.trim_end_matches(['%', ' ']).parse::<f64>().is_ok()
}

/// Text that is safe within an element and within a quoted attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            other => safe.push(other),
        }
    }
    safe
}

/// The value, or a dash where there is none.
pub(crate) fn or_dash(value: Option<impl Display>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| value.to_string())
}

/// A figure with a sensible number of places.
pub(crate) fn rounded(value: f64) -> String {
    match value.abs() {
        size if size >= 1000.0 => format!("{value:.0}"),
        size if size >= 100.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

pub(crate) fn percent(rate: Option<f64>) -> String {
    or_dash(rate.map(|rate| format!("{:.1} %", 100.0 * rate)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_recording_becomes_markup() {
        let mut page = Page::new("<script>");
        page.table("a & b", &["x", "y"], [vec!["\"<b>\"".to_owned(), "1.5 %".to_owned()]]);
        let html = page.finish();
        assert!(!html.contains("<script>") && !html.contains("<b>"), "{html}");
        assert!(html.contains("a &amp; b") && html.contains("<td class=\"n\">1.5 %</td>"));
    }
}
