//! Addresses and their numbers: a letter or a name, followed by a number, an expression or an assignment.

use crate::gcode::command::Command;
use crate::gcode::function::is_function;
use crate::gcode::lexer::{Lexer, is_number};
use crate::gcode::unread_names::act_of_name;
use crate::gcode::word::{COMPRESSORS, Count, END_OF_SUBPROGRAM, Key, NAMES, PASSED, Word};
use crate::options::Dialect;
use crate::toml_table::nearest;

impl Lexer<'_, '_, '_> {
    /// A run of letters: an address with its number, or a word of a control's language.
    pub(super) fn address(&mut self, begin: usize) -> Option<()> {
        self.skip(|c| c.is_ascii_alphabetic() || c == b'_');
        let name = &self.line[begin..self.at];
        match name.as_bytes() {
            [b'O' | b'o'] if !self.takes_flags() => return self.o_word(begin),
            [b'R' | b'r'] if self.is_assigned_parameter() => {
                self.at = begin;
                return self.assignment(true);
            }
            [letter] => {
                let letter = letter.to_ascii_uppercase();
                let key = self.take_index(letter).unwrap_or(Key::Letter(letter));
                return self.number(begin, key);
            }
            _ => {}
        }
        match NAMES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
            Some((_, key)) if key.is_command() => {
                self.push(begin, *key, 0.0);
                Some(())
            }
            Some((_, key)) => self.number(begin, *key),
            None => match name.to_ascii_uppercase().as_str() {
                "IF" => self.condition_of_fanuc(begin),
                "GOTO" => self.goto(begin, true),
                "WHILE" => self.fanuc_loop(begin, true),
                "DO" => self.fanuc_loop(begin, false),
                "END" => {
                    let number = self.whole_number()?;
                    self.command(begin, Command::End(number), Dialect::Fanuc)
                }
                // An address with a function as its value, written without a space.
                _ if is_function(&name[1..]) && self.next_is(b'[') => {
                    self.at = begin + 1;
                    self.number(begin, Key::Letter(name.as_bytes()[0].to_ascii_uppercase()))
                }
                _ => self.unknown_name(begin),
            },
        }
    }

    /// Takes the index of an indexed address of Siemens, `I1=40`, `S1=500`, `M1=3`.
    fn take_index(&mut self, letter: u8) -> Option<Key> {
        let rest = self.line[self.at..].strip_prefix('1')?;
        if !rest.trim_start().starts_with('=') {
            return None;
        }
        let key = match letter {
            b'I' | b'J' | b'K' => Key::Middle(usize::from(letter - b'I')),
            b'S' | b'M' | b'T' | b'D' | b'H' => Key::Letter(letter),
            _ => return None,
        };
        self.at += 1;
        Some(key)
    }

    /// Takes `AC(5)` or `IC(5)`, behind `=`.
    fn counted(&mut self, begin: usize, key: Key) -> Option<Option<()>> {
        let name = self.line.get(self.at..self.at + 2)?;
        let count = match name.to_ascii_uppercase().as_str() {
            "AC" => Count::Absolute,
            "IC" => Count::Incremental,
            _ => return None,
        };
        if !self.line[self.at + 2..].trim_start().starts_with('(') {
            return None;
        }
        self.at += 2;
        let read = {
            let mut parser = self.parser(true);
            parser.bracketed().map(|value| (value.unwrap_or(0.0), parser.at))
        };
        let value = self.parsed(read);
        if let Some(value) = value {
            self.push(begin, key, value);
            if let Some(word) = self.read.words.last_mut() {
                word.count = Some(count);
            }
        }
        Some(value.map(|_| ()))
    }

    /// A tool by its name, `T="MILL"`: it has no number.
    fn named_tool(&mut self, begin: usize, key: Key) -> Option<()> {
        self.skip_text();
        let span = self.span(begin, self.at);
        if key != Key::Letter(b'T') {
            let text = self.report.source.slice(span).to_owned();
            self.report.error(span, format!("`{text}`: a text is no number")).expected("a number");
            return Some(());
        }
        let text = self.report.source.slice(span).to_owned();
        self.report.of_kind(false, span, "named tool", format!("`{text}`: the name of a tool is read as T0"));
        self.push(begin, key, 0.0);
        Some(())
    }

    /// The next byte that is not white space; it is not consumed.
    fn next_is(&self, byte: u8) -> bool {
        self.line.as_bytes()[self.at..].iter().find(|c| !c.is_ascii_whitespace()) == Some(&byte)
    }

    /// Whether an R is followed by digits, or by Siemens' brackets, and then by `=`.
    fn is_assigned_parameter(&self) -> bool {
        let rest = self.line[self.at..].trim_start();
        let behind = match rest.split_once(']') {
            Some((_, behind)) if rest.starts_with('[') && self.scope.dialect == Some(Dialect::Siemens) => {
                behind
            }
            _ => rest.trim_start_matches(|c: char| c.is_ascii_digit()),
        };
        behind.len() < rest.len() && behind.trim_start().starts_with('=')
    }

    /// The number of a word that begins at `begin`. The lexer must be behind the word's letter or name.
    pub(super) fn number(&mut self, begin: usize, key: Key) -> Option<()> {
        let name_end = self.at;
        self.skip(|c| c == b' ' || c == b'\t');
        let is_assigned = self.peek() == Some(b'=');
        if is_assigned {
            self.at += 1;
            self.skip(|c| c == b' ' || c == b'\t');
        }
        let digits = self.at;
        if is_assigned && let Some(done) = self.counted(begin, key) {
            return done;
        }
        if is_assigned && self.peek() == Some(b'"') {
            return self.named_tool(begin, key);
        }
        if is_assigned || self.is_expression() {
            return self.evaluated(begin, key, is_assigned);
        }
        self.skip(is_number);
        let spaced = self.spaced_digits(digits);
        let text = spaced.as_deref().unwrap_or(&self.line[digits..self.at]);
        let name = &self.line[begin..name_end];
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => self.push(begin, key, value),
            _ if text.is_empty() && self.takes_flags() => {
                self.skip_text();
                self.read.flags.extend(name.bytes().next().map(|letter| letter.to_ascii_uppercase()));
            }
            _ if text.is_empty() => {
                let message = format!("`{name}` has no number");
                self.report
                    .error(self.span(begin, name_end), message)
                    .expected(format!("a number, as {name}12.5"));
            }
            _ => {
                let message = format!("`{text}` is no number");
                self.report
                    .error(self.span(digits, self.at), message)
                    .expected("digits with at most one point");
            }
        }
        Some(())
    }

    /// The digits of a number with white space between them, which LinuxCNC passes over, if there is any.
    fn spaced_digits(&mut self, begin: usize) -> Option<String> {
        if self.scope.dialect != Some(Dialect::LinuxCnc) {
            return None;
        }
        let rest = &self.line[begin..];
        let length = rest.bytes().take_while(|c| is_number(*c) || matches!(c, b' ' | b'\t')).count();
        let text = rest[..length].trim_end();
        self.at = begin + text.len();
        text.contains([' ', '\t']).then(|| text.chars().filter(|c| !c.is_whitespace()).collect())
    }

    /// Whether the block begins with a word of a printer that may have letters alone: `G28 X Y`, `M84 E`.
    fn takes_flags(&self) -> bool {
        let takes = |word: &Word| match word.key {
            Key::Letter(b'G') => [28.0, 29.0].contains(&word.value),
            Key::Letter(b'M') => {
                [17.0, 18.0].contains(&word.value) || word.value > 72.0 && !is_call(word.value)
            }
            _ => false,
        };
        self.scope.dialect.is_none() && self.read.words.first().is_some_and(takes)
    }

    /// Passes a text in quotation marks.
    fn skip_text(&mut self) {
        if let Some(text) = self.line[self.at..].strip_prefix('"') {
            self.at += 1 + text.find('"').map_or(text.len(), |length| length + 1);
        }
    }

    fn push(&mut self, begin: usize, key: Key, value: f64) {
        if !matches!(key, Key::Letter(b'N' | b'O')) {
            self.read.words.push(Word { key, value, span: self.span(begin, self.at), count: None });
        }
    }

    /// Whether the next value is not a plain number.
    fn is_expression(&self) -> bool {
        let rest = self.line[self.at..].trim_start_matches(['+', '-', ' ', '\t']);
        let letters = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
        rest.starts_with(['[', '#'])
            || is_function(&rest[..letters]) && rest[letters..].trim_start().starts_with('[')
    }

    /// A word whose value is an expression, or an assignment of Siemens.
    fn evaluated(&mut self, begin: usize, key: Key, is_assigned: bool) -> Option<()> {
        let read = {
            let mut parser = self.parser(is_assigned);
            let value = if is_assigned { parser.expression() } else { parser.operand() };
            value.map(|value| (value, parser.at))
        };
        match self.parsed(read)? {
            Some(value) => self.push(begin, key, value),
            // FANUC ignores a word whose variable is vacant.
            None if self.scope.dialect == Some(Dialect::Fanuc) => {}
            None => {
                let span = self.span(begin, self.at);
                self.report
                    .warning(span, "a variable that has no value is taken as 0, as LinuxCNC does")
                    .hint("FANUC leaves its word out, as with its dialect given");
                self.push(begin, key, 0.0);
            }
        }
        Some(())
    }

    /// A run of letters that is not a name: letters without their numbers, or words of a control's language.
    fn unknown_name(&mut self, begin: usize) -> Option<()> {
        let name = self.line[begin..self.at].to_ascii_uppercase();
        if self.is_passed_name(begin) {
            return Some(());
        }
        const LANGUAGE: [&str; 11] =
            ["THEN", "ELSE", "ENDIF", "GOTOF", "GOTOB", "ENDWHILE", "FOR", "DEF", "PROC", "LOOP", "REPEAT"];
        if LANGUAGE.contains(&name.as_str()) || name.starts_with('_') {
            let end = self.line.trim_end().len().max(begin + 1);
            self.report
                .error(self.span(begin, end), format!("`{name}` is not executed"))
                .expected("a program without Siemens' jumps, loops and names of variables")
                .hint("let the control or the post-processor write the program with plain numbers");
            return None;
        }
        let known: Vec<&str> = NAMES.iter().map(|(name, _)| *name).collect();
        let near = nearest(&name, &known).filter(|_| name.len() > 2);
        if self.line[self.at..].trim_start_matches([' ', '\t']).starts_with('=') {
            return self.unknown_assignment(begin);
        }
        if name.len() <= 3 && near.is_none() {
            let message = format!("`{}` has no number", &name[..1]);
            self.report
                .error(self.span(begin, begin + 1), message)
                .expected(format!("a number, as {}12.5", &name[..1]));
            self.at = begin + 1;
            return Some(());
        }
        let span = self.span(begin, self.at);
        let message =
            format!("unknown word `{}`", self.line[begin..self.at].chars().take(40).collect::<String>());
        if self.lenient {
            self.report.of_kind(false, span, &name, message);
            self.read.unread.get_or_insert(span);
            self.note_act_of_name(begin);
            self.skip_arguments();
            return Some(());
        }
        let diagnostic = self.report.of_kind(true, span, &name, message);
        diagnostic
            .expected("a letter with a number, or a word of Siemens that is read, as BSPLINE, PW= or CR=");
        if let Some(near) = near {
            diagnostic.hint(format!("did you mean `{near}`?"));
        }
        None
    }

    /// Takes a name of Siemens that leaves the path as it is, or as it is but for a tolerance.
    fn is_passed_name(&mut self, begin: usize) -> bool {
        if !matches!(self.scope.dialect, None | Some(Dialect::Siemens)) {
            return false;
        }
        let rest = &self.line[begin..];
        let length = rest.bytes().take_while(|c| c.is_ascii_alphanumeric() || *c == b'_').count();
        let name = rest[..length].to_ascii_uppercase();
        if name == "RET" {
            self.at = begin + length;
            self.read.dialect = Some(Dialect::Siemens);
            self.push(begin, Key::Letter(b'M'), END_OF_SUBPROGRAM);
            return true;
        }
        // A program that is called with numbers has names for them.
        if name == "PROC" && rest.contains('(') {
            return false;
        }
        let is_compressor = COMPRESSORS.contains(&name.as_str());
        if !is_compressor && !PASSED.contains(&name.as_str()) {
            return false;
        }
        self.note_act_of_name(begin);
        self.at = begin + length;
        let span = self.span(begin, self.at);
        if is_compressor {
            let message =
                format!("`{name}` lets the path be another within a tolerance: it is taken as commanded");
            self.report.of_kind(false, span, &name, message);
        }
        if name == "PROC" {
            self.at = self.line.len();
        }
        self.skip_arguments();
        true
    }

    /// Keeps what a name at `begin` does to the blocks behind its own, if it does anything.
    fn note_act_of_name(&mut self, begin: usize) {
        let rest = &self.line[begin..];
        let length = rest.bytes().take_while(|c| c.is_ascii_alphanumeric() || *c == b'_').count();
        let (name, behind) = rest.split_at(length);
        let behind: String = behind.chars().filter(|c| !c.is_whitespace()).take(3).collect();
        let is_bare = behind.is_empty() || behind.starts_with("()") || behind.starts_with(';');
        self.read.name_acts.extend(act_of_name(&name.to_ascii_uppercase(), is_bare));
    }

    /// Passes `=` and a number, a text or a list in brackets behind an unknown name.
    fn skip_arguments(&mut self) {
        self.skip(|c| c == b' ' || c == b'\t' || c == b'=');
        self.skip(is_number);
        self.skip_text();
        if self.peek() == Some(b'(') {
            // A bracket in a text closes nothing.
            let mut in_text = false;
            let closes = |c: u8| {
                in_text ^= c == b'"';
                c == b')' && !in_text
            };
            let rest = &self.line.as_bytes()[self.at..];
            self.at += rest.iter().copied().position(closes).map_or(rest.len(), |length| length + 1);
        }
    }

    /// An unknown name with `=` and its number. The lexer must be behind the name.
    fn unknown_assignment(&mut self, begin: usize) -> Option<()> {
        let message =
            format!("unknown word `{}=`", self.line[begin..self.at].chars().take(40).collect::<String>());
        self.skip_arguments();
        let span = self.span(begin, self.at);
        if self.lenient {
            let name = self.line[begin..self.at].split('=').next().unwrap_or("").to_ascii_uppercase();
            self.report.of_kind(false, span, name, message);
            self.read.unread.get_or_insert(span);
        } else {
            self.report.error(span, message).expected("a letter with a number, or SD=, PW=, PL=, CR=");
        }
        Some(())
    }
}

/// Whether an M word calls a subprogram or ends it.
fn is_call(value: f64) -> bool {
    [98.0, 99.0, 198.0].contains(&value)
}
