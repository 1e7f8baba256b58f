//! Text for a terminal of 80 columns: folded lines, tables that fit, and figures for people. Names and other text from outside that a
//! terminal would act on becomes a `?` here.

use std::borrow::Cow;

use anstyle::{AnsiColor, Style};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets};
use foreign_text::{in_a_line, in_lines};
use textwrap::{Options, WordSplitter};

/// Columns of the screen.
pub(crate) const COLUMNS: usize = 80;

pub(crate) const STRONG: Style = Style::new().bold();
pub(crate) const GOOD: Style = AnsiColor::Green.on_default();
pub(crate) const BAD: Style = AnsiColor::Red.on_default();

/// Words are not cut, since options, formats and paths are copied from the screen.
fn whole_words<'i>() -> Options<'i> {
    Options::new(COLUMNS).word_splitter(WordSplitter::NoHyphenation).break_words(false)
}

/// The lines of a text, none longer than the screen.
pub(crate) fn folded(text: &str) -> Vec<String> {
    textwrap::wrap(&in_lines(text), whole_words()).into_iter().map(Into::into).collect()
}

/// A text in lines of the screen, each with its end; an empty text has no line.
pub(crate) fn paragraph(text: &str) -> String {
    if text.is_empty() { String::new() } else { folded(text).join("\n") + "\n" }
}

/// A text in lines of the screen. The first line, which has the answer, is bold.
pub(crate) fn answer(text: &str) -> String {
    let lines = paragraph(text);
    match lines.split_once('\n') {
        Some((first, more)) => format!("{STRONG}{first}{STRONG:#}\n{more}"),
        None => lines,
    }
}

/// A text behind a label. Further lines begin below the text.
pub(crate) fn labelled(label: &str, text: &str) -> String {
    let below = " ".repeat(label.chars().count());
    textwrap::fill(&in_lines(text), whole_words().initial_indent(label).subsequent_indent(&below)) + "\n"
}

/// Bytes of a message, at most, with the end of its last line.
pub(crate) const MOST_BYTES: usize = 2000;

/// Characters of a word in a message, at most: of a longer one, as a name or a number may be, the begin and the end are
/// shown.
const LONGEST_WORD: usize = 240;

/// A message of one line or more, of [`MOST_BYTES`] at most: of a longer one the middle is left out, and so is that of a
/// long word. Lines that show a file, each behind a bar, and the line with the place are not folded.
pub(crate) fn message(text: &str) -> String {
    let is_shown = |line: &str| {
        let line = line.trim_start().trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
        line.starts_with('|') || line.starts_with("-->")
    };
    let lines = text.split('\n').map(|line| {
        let line: &str = &line.split_inclusive(' ').map(shortened).collect::<String>();
        if is_shown(line) {
            return line.to_string();
        }
        let text = line.trim_start_matches([' ', '=']);
        let below = (line.len() - text.len()).min(COLUMNS / 4);
        textwrap::fill(line, whole_words().subsequent_indent(&" ".repeat(below)))
    });
    let text = lines.collect::<Vec<_>>().join("\n");
    if text.len() < MOST_BYTES { text } else { without_middle(&text, MOST_BYTES - 1 - "…".len()) }
}

/// A word of a message.
fn shortened(word: &str) -> Cow<'_, str> {
    let count = word.chars().count();
    if count <= LONGEST_WORD {
        return word.into();
    }
    let (begin, end) = (LONGEST_WORD * 2 / 3, LONGEST_WORD / 3);
    let at = |place: usize| word.char_indices().nth(place).map_or(word.len(), |(at, _)| at);
    format!("{}…{}", &word[..at(begin)], &word[at(count - end)..]).into()
}

/// A text with `most` bytes of its begin and end.
fn without_middle(text: &str, most: usize) -> String {
    let begin = text.floor_char_boundary(most * 2 / 3);
    let end = text.ceil_char_boundary(text.len() - most / 3);
    format!("{}…{}", &text[..begin], &text[end..])
}

/// A table no wider than the screen; an empty text without rows. Figures are aligned to the right, words to the left.
pub(crate) fn table(header: &[&str], rows: Vec<Vec<String>>) -> String {
    const GAP: u16 = 2;
    if rows.is_empty() {
        return String::new();
    }
    let is_figure = |cell: &String| {
        cell.is_empty()
            || cell.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '±' | '<' | '>'))
    };
    let has_figures = |column: usize| rows.iter().filter_map(|row| row.get(column)).all(is_figure);
    let figures: Vec<bool> = (0..header.len()).map(has_figures).collect();
    let mut table = Table::new();
    // The gap behind the last column is removed.
    table
        .load_preset(presets::NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(u16::try_from(COLUMNS).unwrap_or(u16::MAX).saturating_add(GAP))
        .set_header(header.to_vec());
    table.add_rows(printable(rows));
    for (column, has_figures) in table.column_iter_mut().zip(figures) {
        column.set_padding((0, GAP));
        if has_figures {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.lines().map(|line| line.trim_end().to_string() + "\n").collect()
}

/// A table of all columns in their full width; the columns of `words` are aligned to the left. An empty text without
/// rows.
pub(crate) fn wide_table(header: &[&str], rows: Vec<Vec<String>>, words: &[usize]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_header(header.to_vec());
    table.add_rows(printable(rows));
    for (index, column) in table.column_iter_mut().enumerate() {
        if !words.contains(&index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    format!("{table}\n")
}

/// Rows whose cells a terminal does not act on.
fn printable(rows: Vec<Vec<String>>) -> impl Iterator<Item = Vec<String>> {
    rows.into_iter().map(|row| row.iter().map(|cell| in_lines(cell)).collect())
}

/// A list of names, as in "A, B and C".
pub(crate) fn list(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_string(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// Joins the names that have the same words after them. The groups are in the order of their first names.
pub(crate) fn by_what_is_said(said: impl IntoIterator<Item = (String, String)>) -> Vec<(String, String)> {
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for (name, words) in said {
        match groups.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(name),
            None => groups.push((words, vec![name])),
        }
    }
    let joined = |names: &[String]| list(&names.iter().map(String::as_str).collect::<Vec<_>>());
    groups.into_iter().map(|(words, names)| (joined(&names), words)).collect()
}

/// The name of a part without the folders of its file, in a line.
pub(crate) fn file_name(name: &str) -> String {
    let last = std::path::Path::new(name).file_name();
    in_a_line(&last.map_or(name.into(), |last| last.to_string_lossy()))
}

/// For a margin above this, no figure is printed.
const MANY: f64 = 1e6;

/// A ratio in words, with two digits, as in "41 times". Above a million, only that is said.
pub(crate) fn times(margin: f64) -> String {
    if margin > MANY {
        "more than a million times".to_string()
    } else {
        format!("{} times", two_digits(margin))
    }
}

/// A ratio in short form, for a cell of a table.
pub(crate) fn times_short(margin: f64) -> String {
    if margin > MANY { "> 1e6".to_string() } else { format!("{}×", two_digits(margin)) }
}

fn two_digits(x: f64) -> String {
    if x < 10.0 { format!("{x:.1}") } else { format!("{x:.0}") }
}

/// A figure of at most six or seven digits; larger ones have three digits and an exponent.
pub(crate) fn short(x: f64) -> String {
    if x.abs() >= 1e7 {
        return if x.is_finite() { format!("{x:.2e}") } else { "no bound".to_string() };
    }
    let before_point = (0..6).take_while(|power| x.abs() >= 10.0_f64.powi(*power)).count();
    let text = format!("{x:.*}", 6 - before_point);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// A time in units that people use.
pub(crate) fn duration(seconds: f64) -> String {
    let whole = seconds.round();
    if seconds < 100.0 {
        format!("{seconds:.2} s")
    } else if whole < 3600.0 {
        format!("{:.0} min {:02.0} s", (whole / 60.0).floor(), whole % 60.0)
    } else {
        format!("{:.0} h {:02.0} min", (whole / 3600.0).floor(), (whole % 3600.0 / 60.0).floor())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short() {
        assert_eq!(
            [834.706_9, 200.0, 0.0005, 1e-3, 16_000.0, 22_368.358, 1.25e7].map(short),
            ["834.707", "200", "0.0005", "0.001", "16000", "22368.4", "1.25e7"]
        );
        assert_eq!(short(7.000_000_000_000_001), "7");
        assert_eq!([4.887, 487.231, 16_742.0].map(duration), ["4.89 s", "8 min 07 s", "4 h 39 min"]);
        assert_eq!([3.02, 41.0, 9e8].map(times), ["3.0 times", "41 times", "more than a million times"]);
    }

    #[test]
    fn no_line_is_longer_than_the_screen() {
        let text = "It is not a question of the format: f64 pieces fails too, with a chord error of 2.5 µm in line 17.";
        assert!(folded(text).iter().all(|line| line.chars().count() <= COLUMNS));
        assert_eq!(folded(text).join(" "), text);
        let words = "a verdict of many words ".repeat(9);
        let cells = ["I8F24", "26", &words].map(String::from).to_vec();
        let table = table(&["format", "bits", "verdict"], vec![cells]);
        assert!(table.lines().all(|line| line.chars().count() <= COLUMNS), "{table}");
    }

    /// A line of a file is shown unchanged, and an option is not cut at its hyphens.
    #[test]
    fn what_is_copied_from_the_screen_stays_whole() {
        let excerpt = format!("  --> {}:3:1\n   |\n 3 | {}\n   | ^", "p".repeat(90), "G1 X1 ".repeat(20));
        let text = format!("error: {}\n{excerpt}", "--piece-length-of-a-part ".repeat(6).trim_end());
        let shown = message(&text);
        assert!(shown.ends_with(&excerpt), "{shown}");
        let words = shown.lines().take_while(|line| !line.contains("-->")).flat_map(str::split_whitespace);
        assert!(words.skip(1).all(|word| word == "--piece-length-of-a-part"), "{shown}");
    }

    /// Of a long message the middle is left out, at the borders of characters. A word, as a name or a number, keeps its
    /// begin and end, so that the place behind a name stays.
    #[test]
    fn a_message_has_an_end() {
        let long = "ä".repeat(5000);
        let place = format!("error: {long} is no number\n  --> {long}.nc:17:3\n   = expected: a number");
        let shown = message(&place);
        assert!(shown.len() < MOST_BYTES, "{}", shown.len());
        let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
        for kept in ["error: ääää", "… ", "is no number", "äää.nc:17:3", "= expected: a number"] {
            assert!(shown.contains(kept.trim_end()), "{kept} in {shown}");
        }
        for count in [60, 200, 400, 401, 402, 1000, 100_000] {
            let shown = message(&format!("begin {}end", "äöü ".repeat(count)));
            assert!(shown.len() < MOST_BYTES, "{count}: {}", shown.len());
            assert!(shown.starts_with("begin ä") && shown.ends_with("end"), "{shown}");
            assert_eq!(shown.contains('…'), count > 282, "{count}: {shown}");
        }
    }
}
