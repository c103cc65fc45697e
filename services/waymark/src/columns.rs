//! Tables for people: columns as wide as their widest cell, numbers to the right.

use std::fmt::Write;

/// A table under construction; the first row is its header.
#[derive(Debug)]
pub(crate) struct Columns {
    rows: Vec<Vec<String>>,
}

impl Columns {
    /// A table with these column names.
    pub(crate) fn new<const N: usize>(names: [&str; N]) -> Self {
        Self { rows: vec![names.map(str::to_owned).to_vec()] }
    }

    /// Adds a row.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The table, a line for each row.
    pub(crate) fn text(&self) -> String {
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (column, cell) in row.iter().enumerate() {
                let (width, padding) = (self.width(column), "  ");
                // A String takes every write.
                let _ = match self.is_numeric(column) {
                    true => write!(line, "{cell:>width$}{padding}"),
                    false => write!(line, "{cell:<width$}{padding}"),
                };
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }

    fn cells(&self, column: usize) -> impl Iterator<Item = &String> {
        self.rows.iter().filter_map(move |row| row.get(column))
    }

    fn width(&self, column: usize) -> usize {
        self.cells(column).map(|cell| cell.chars().count()).max().unwrap_or(0)
    }

    fn is_numeric(&self, column: usize) -> bool {
        let is_number = |cell: &String| {
            cell.is_empty() || cell == "–" || cell.trim_end_matches('%').trim().parse::<f64>().is_ok()
        };
        self.rows.len() > 1 && self.cells(column).skip(1).all(is_number)
    }
}

#[cfg(test)]
mod tests {
    use super::Columns;

    #[test]
    fn names_to_the_left_and_numbers_to_the_right() {
        let mut table = Columns::new(["name", "area"]);
        table.row(["red".to_owned(), "12.5".to_owned()]);
        table.row(["stop-sign".to_owned(), "–".to_owned()]);
        table.row(["blue".to_owned(), "103.25".to_owned()]);
        assert_eq!(
            table.text(),
            "name         area\nred          12.5\nstop-sign       –\nblue       103.25\n"
        );
    }
}
