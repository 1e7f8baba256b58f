//! Tables of text.

/// A number in three digits.
pub(crate) fn short(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || (1e-2..1e5).contains(&size) {
        let text = format!("{x:.4}");
        let text = text.trim_end_matches('0').trim_end_matches('.');
        text.to_string()
    } else {
        format!("{x:.2e}")
    }
}

/// A number in all its digits.
pub(crate) fn exact(x: f64) -> String {
    if x == 0.0 || (1e-3..1e15).contains(&x.abs()) { x.to_string() } else { format!("{x:e}") }
}

/// A table with a line of headings, its columns as wide as they need be.
pub(crate) fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let cells =
        |column: usize| rows.iter().filter_map(move |row| row.get(column)).map(|cell| cell.chars().count());
    let widths: Vec<usize> = header
        .iter()
        .enumerate()
        .map(|(column, name)| cells(column).max().unwrap_or(0).max(name.chars().count()))
        .collect();
    let line = |cells: Vec<&str>| {
        let padded = cells.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        padded.collect::<Vec<_>>().join("  ").trim_end().to_string() + "\n"
    };
    let head = line(header.to_vec());
    rows.iter().fold(head, |text, row| text + &line(row.iter().map(String::as_str).collect()))
}
