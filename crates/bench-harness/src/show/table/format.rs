//! The formats of a table.

use super::cell::Cell;
use super::columns::{Column, Columns};
use crate::record::Record;

/// The columns and their cells; columns that are optional and empty are left out.
struct Table<R: 'static> {
    columns: Vec<&'static Column<R>>,
    rows: Vec<Vec<Cell>>,
}

impl<R> Table<R> {
    fn new(columns: Columns<R>, records: &[&R]) -> Self {
        let is_shown = |column: &&Column<R>| {
            !column.is_optional || records.iter().any(|record| (column.cell)(record) != Cell::Nothing)
        };
        let columns: Vec<&'static Column<R>> = columns.iter().copied().flatten().filter(is_shown).collect();
        let rows = records.iter().map(|record| columns.iter().map(|column| (column.cell)(record)).collect()).collect();
        Self { columns, rows }
    }

    /// Heads and cells as people read them.
    fn for_people(&self) -> Vec<Vec<String>> {
        let heads = self.columns.iter().map(|column| column.head.to_owned()).collect();
        let rows = self.rows.iter().map(|row| row.iter().map(Cell::for_people).collect());
        std::iter::once(heads).chain(rows).collect()
    }
}

/// For the terminal: words to the left, numbers to the right.
pub(crate) fn aligned<R>(columns: Columns<R>, records: &[&R]) -> String {
    let table = Table::new(columns, records);
    let rows = table.for_people();
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).zip(&table.columns).map(|((cell, &width), column)| {
            if column.is_text { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// For documents.
pub(crate) fn markdown(columns: Columns, records: &[&Record]) -> String {
    let table = Table::new(columns, records);
    let mut rows: Vec<Vec<String>> = table.for_people();
    for cell in rows.iter_mut().flatten() {
        *cell = cell.replace('\\', "\\\\").replace('|', "\\|").replace('\n', " ");
    }
    let rule = table.columns.iter().map(|column| if column.is_text { "---" } else { "---:" }.to_owned()).collect();
    rows.insert(1, rule);
    rows.iter().map(|row| format!("| {} |\n", row.join(" | "))).collect()
}

/// For spreadsheets and programs, as in RFC 4180 but for the line ends.
pub(crate) fn csv<R>(columns: Columns<R>, records: &[&R]) -> String {
    let table = Table::new(columns, records);
    let heads = table.columns.iter().map(|column| column.name.to_owned()).collect::<Vec<_>>();
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| quoted(cell.for_programs())).collect());
    std::iter::once(heads).chain(rows).map(|row: Vec<String>| row.join(",") + "\n").collect()
}

fn quoted(cell: String) -> String {
    let is_plain = !cell.contains([',', '"', '\n', '\r']);
    if is_plain { cell } else { format!("\"{}\"", cell.replace('"', "\"\"")) }
}
