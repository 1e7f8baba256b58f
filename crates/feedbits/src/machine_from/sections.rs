//! Files of sections: `[name]`, and below it keys with values, as LinuxCNC and Klipper have them.

use super::settings::Setting;

/// How a file of sections is written.
pub(crate) struct Style {
    /// What is between a key and its value.
    pub(crate) separators: &'static [char],
    /// Whether a line that begins with a space goes on with the value before, as code of a macro does.
    pub(crate) has_continued_lines: bool,
}

/// The settings of a text, each named by its section, a dot and its key. Comments begin with `#` or `;`: on a line of their own, or behind a
/// value and a space.
pub(crate) fn settings(text: &str, style: &Style) -> Vec<Setting> {
    let mut section = String::new();
    let mut settings = Vec::new();
    for (index, whole) in text.lines().enumerate() {
        let is_continued = style.has_continued_lines && whole.starts_with([' ', '\t']);
        let line = whole.trim();
        if line.is_empty() || line.starts_with(['#', ';']) || is_continued {
            continue;
        }
        if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            section = name.0.trim().to_string();
        } else if let Some((key, value)) = line.split_once(style.separators) {
            let name = format!("{section}.{}", key.trim());
            settings.push(Setting { line: index + 1, name, value: without_comment(value).to_string() });
        }
    }
    settings
}

/// A value without the comment behind it.
fn without_comment(value: &str) -> &str {
    let begin = value.char_indices().find(|(at, letter)| {
        matches!(letter, '#' | ';') && value[..*at].ends_with([' ', '\t']) || (*at == 0 && *letter == '#')
    });
    begin.map_or(value, |(at, _)| &value[..at]).trim()
}

/// Whether a text has one of these sections.
pub(crate) fn has_section(text: &str, names: &[&str]) -> bool {
    let section = |line: &str| {
        let (name, _) = line.trim().strip_prefix('[')?.split_once(']')?;
        Some(name.trim().to_string())
    };
    text.lines().filter_map(section).any(|name| names.iter().any(|one| name.eq_ignore_ascii_case(one)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_continued_lines_are_no_settings() {
        let text =
            "# a\n[ one ]\nkey = 1 # mm\n; key = 2\nother=a;b\n  more = 3\n[two]\nkey: 4\nempty = # none\n";
        let style = Style { separators: &['=', ':'], has_continued_lines: true };
        let found: Vec<_> = settings(text, &style).into_iter().map(|s| (s.line, s.name, s.value)).collect();
        let expected =
            [(3, "one.key", "1"), (5, "one.other", "a;b"), (8, "two.key", "4"), (9, "two.empty", "")];
        assert_eq!(found, expected.map(|(line, name, value)| (line, name.to_string(), value.to_string())));
        assert!(has_section(text, &["TWO"]) && !has_section(text, &["three"]));
    }
}
