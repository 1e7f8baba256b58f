//! Words and marks of the C that `c-code` writes, its macros replaced.

use std::collections::HashMap;

use crate::error::CoreError;

/// A word or mark of C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Token {
    Word(String),
    /// A number, and whether its suffix asks for 64 bits.
    Number(u64, bool),
    Mark(&'static str),
    End,
}

/// A token and its line.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub(crate) token: Token,
    pub(crate) line: u32,
}

/// Marks, the longer ones first.
const MARKS: [&str; 43] = [
    "<<=", ">>=", "->", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&", "||", "+=", "-=", "*=", "/=",
    "&=", "|=", "^=", "(", ")", "{", "}", "[", "]", ";", ",", ".", "?", ":", "=", "<", ">", "+", "-", "*",
    "/", "&", "|", "^", "~", "!",
];

/// The tokens of a header and a source, and the macros.
pub(crate) struct Tokens {
    pub(crate) tokens: Vec<Placed>,
    pub(crate) macros: HashMap<String, Vec<Token>>,
}

/// Reads both texts. Of conditions it takes what a compiler without extensions takes: nothing is defined but by the texts, so the
/// part behind `#if` is left out and the one behind `#ifndef` or `#else` is read.
pub(crate) fn tokens(header: &str, source: &str) -> Result<Tokens, CoreError> {
    let mut result = Tokens { tokens: Vec::new(), macros: HashMap::new() };
    for text in [header, source] {
        read(text, &mut result)?;
    }
    let line = result.tokens.last().map_or(0, |last| last.line);
    result.tokens.push(Placed { token: Token::End, line });
    Ok(result)
}

fn read(text: &str, into: &mut Tokens) -> Result<(), CoreError> {
    let plain = without_comments(text);
    // For each open condition, whether its present part is read.
    let mut conditions: Vec<bool> = Vec::new();
    for (number, line) in (1..).zip(plain.lines()) {
        let trimmed = line.trim();
        if let Some(directive) = trimmed.strip_prefix('#') {
            let (word, rest) =
                directive.trim().split_once(char::is_whitespace).unwrap_or((directive.trim(), ""));
            match word {
                "if" | "ifdef" => conditions.push(false),
                "ifndef" => conditions.push(true),
                "else" => {
                    if let Some(last) = conditions.last_mut() {
                        *last = !*last;
                    }
                }
                "endif" => {
                    conditions.pop();
                }
                "define" if conditions.iter().all(|is_read| *is_read) => {
                    define(rest, number, &mut into.macros)?
                }
                _ => {}
            }
        } else if conditions.iter().all(|is_read| *is_read) {
            for token in of_line(trimmed, number)? {
                expand(token, number, 0, into)?;
            }
        }
    }
    Ok(())
}

/// Whether a macro's value belongs to the part and not to its kind: such a name stays, and becomes a register that is loaded.
pub(crate) fn is_of_part(name: &str) -> bool {
    let whole = ["RESIDUAL", "GROWTH", "FLUCTUATION", "MAX_EVALUATIONS", "LANDING_STEP"];
    let ends = ["_SECTIONS", "_CHORD_EXPONENT", "_COORDINATE_EXPONENT"];
    whole.contains(&name) || ends.iter().any(|end| name.ends_with(end))
}

/// Comments become blanks; lines stay.
fn without_comments(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, comment)) = rest.split_once("/*") {
        plain.push_str(before);
        let (inside, after) = comment.split_once("*/").unwrap_or((comment, ""));
        plain.push(' ');
        plain.extend(inside.chars().filter(|c| *c == '\n'));
        rest = after;
    }
    plain.push_str(rest);
    plain
}

fn define(rest: &str, line: u32, macros: &mut HashMap<String, Vec<Token>>) -> Result<(), CoreError> {
    let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
    let (name, value) = rest.split_at(end);
    if !value.starts_with('(') {
        macros.insert(name.to_owned(), of_line(value, line)?);
    }
    Ok(())
}

/// A token, or what the macro of its name stands for.
fn expand(token: Token, line: u32, depth: u32, into: &mut Tokens) -> Result<(), CoreError> {
    if let Token::Word(word) = &token
        && !is_of_part(word)
        && let Some(meaning) = into.macros.get(word)
    {
        if depth > 16 {
            return Err(CoreError::subset(line, format!("macro {word} in itself")));
        }
        for token in meaning.clone() {
            expand(token, line, depth + 1, into)?;
        }
        return Ok(());
    }
    into.tokens.push(Placed { token, line });
    Ok(())
}

fn of_line(text: &str, line: u32) -> Result<Vec<Token>, CoreError> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let of_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if of_word(first) {
            let end = rest.find(|c| !of_word(c)).unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            found.push(if first.is_ascii_digit() {
                number(word, line)?
            } else {
                Token::Word(word.to_owned())
            });
            rest = after;
        } else if first == '"' {
            let end = rest.get(1..).and_then(|inner| inner.find('"')).map_or(rest.len(), |end| end + 2);
            rest = rest.get(end..).unwrap_or("");
        } else if let Some(mark) = MARKS.iter().find(|mark| rest.starts_with(**mark)) {
            found.push(Token::Mark(mark));
            rest = rest.get(mark.len()..).unwrap_or("");
        } else {
            return Err(CoreError::Syntax {
                line,
                found: first.to_string(),
                expected: "a word or mark of C",
            });
        }
        rest = rest.trim_start();
    }
    Ok(found)
}

fn number(word: &str, line: u32) -> Result<Token, CoreError> {
    let digits = word.trim_end_matches(['u', 'U', 'l', 'L']);
    let value = match digits.strip_prefix("0x") {
        Some(hexadecimal) => u64::from_str_radix(hexadecimal, 16),
        None => digits.parse(),
    };
    let is_long = word.len() - digits.len() > 1;
    value
        .map(|value| Token::Number(value, is_long || value > u64::from(u32::MAX)))
        .map_err(|_| CoreError::Syntax { line, found: word.to_owned(), expected: "a whole number" })
}
