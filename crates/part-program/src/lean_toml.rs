//! A curve file without the numbers of its curves, in blocks that are parsed one by one.
//!
//! The parser of TOML keeps some hundred bytes of every value, and takes the whole text at once. A file may have a
//! million curves, or a curve of a million points. So each block `[[curve]]` is parsed by itself, and the arrays of
//! numbers are left out of what is parsed: they are read where they stand, by `curve_numbers`.
//!
//! Only the lexer of TOML is needed to find both. A line that begins with `[[curve]]` begins a block wherever it stands
//! outside of a text, since an array has no bare word in it. Any other header ends one, outside of brackets.

use domains::curve::{KNOTS, POINTS, WEIGHTS};
use toml_parser::Source;
use toml_parser::lexer::{Token, TokenKind};

use crate::source::Span;

/// The keys whose arrays are read where they stand.
const NUMBERS: [&str; 3] = [POINTS.name, WEIGHTS.name, KNOTS.name];

/// A text of TOML with blanks in place of numbers.
pub(crate) struct LeanToml {
    text: Vec<u8>,
    /// The blocks `[[curve]]`, in the order of the text.
    pub(crate) curves: Vec<Span>,
}

impl LeanToml {
    /// Finds blocks and arrays.
    pub(crate) fn of(text: &str) -> Self {
        let mut lean = Self { text: text.as_bytes().to_vec(), curves: Vec::new() };
        let mut scan = Scan::default();
        for token in Source::new(text).lex() {
            scan.take(text, token, &mut lean);
        }
        lean.close(text.len(), &mut scan);
        lean
    }

    /// The text of a span.
    pub(crate) fn slice(&self, span: Span) -> &str {
        self.text.get(span.start..span.end).and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// What is left without the blocks: every byte of it is where it was.
    pub(crate) fn into_rest(mut self) -> String {
        for span in std::mem::take(&mut self.curves) {
            self.blank(span);
        }
        String::from_utf8(self.text).unwrap_or_default()
    }

    fn blank(&mut self, span: Span) {
        self.text.get_mut(span.start..span.end).unwrap_or_default().fill(b' ');
    }

    fn close(&mut self, end: usize, scan: &mut Scan) {
        if let Some(start) = scan.block.take() {
            self.curves.push(Span::new(start, end));
        }
    }
}

/// The state of a scan over tokens.
#[derive(Default)]
struct Scan {
    /// Where the block began that is being scanned.
    block: Option<usize>,
    /// Brackets that are open.
    depth: usize,
    /// Whether something stands on the line already.
    is_inside_line: bool,
    /// A key of [`NUMBERS`] that begins the line.
    key: Option<bool>,
    /// The begin of an array of numbers at depth 0.
    array: Option<usize>,
}

impl Scan {
    fn take(&mut self, text: &str, token: Token, lean: &mut LeanToml) {
        let (start, end) = (token.span().start(), token.span().end());
        let is_first = !std::mem::replace(&mut self.is_inside_line, true);
        let key = self.key.take();
        match token.kind() {
            TokenKind::Newline => self.is_inside_line = false,
            TokenKind::Whitespace => (self.is_inside_line, self.key) = (!is_first, key),
            TokenKind::Comment => {}
            TokenKind::LeftSquareBracket if is_first && self.begins_block(&text[start..], start, lean) => {
                self.depth = 1;
            }
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => {
                if self.depth == 0 && key == Some(true) && token.kind() == TokenKind::LeftSquareBracket {
                    self.array = Some(end);
                }
                self.depth += 1;
            }
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                self.depth = self.depth.saturating_sub(1);
                if self.depth == 0
                    && let Some(begin) = self.array.take()
                {
                    lean.blank(Span::new(begin, start));
                }
            }
            TokenKind::Atom if is_first && self.depth == 0 => {
                self.key = NUMBERS.contains(&&text[start..end]).then_some(false);
            }
            TokenKind::Equals if key == Some(false) => self.key = Some(true),
            _ => {}
        }
    }

    /// Whether a line that begins with a bracket is a header. One of a curve begins a block, and any header ends one.
    fn begins_block(&mut self, line: &str, start: usize, lean: &mut LeanToml) -> bool {
        let is_curve = is_curve_header(line);
        if !is_curve && self.depth > 0 {
            return false;
        }
        lean.close(start, self);
        self.block = is_curve.then_some(start);
        self.array = None;
        true
    }
}

/// Whether a line is `[[curve]]`, with spaces and a comment where TOML has them.
fn is_curve_header(line: &str) -> bool {
    let blank = [' ', '\t'];
    let inner = line.strip_prefix("[[").map(|rest| rest.trim_start_matches(blank));
    let after = inner.and_then(|rest| rest.strip_prefix("curve")).map(|rest| rest.trim_start_matches(blank));
    after.is_some_and(|rest| rest.starts_with("]]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lean(text: &str) -> (Vec<&str>, String, String) {
        let found = LeanToml::of(text);
        let blocks = found.curves.iter().map(|span| &text[span.start..span.end]).collect();
        let whole = found.slice(Span::new(0, text.len())).to_owned();
        (blocks, whole, found.into_rest())
    }

    #[test]
    fn blocks_end_at_the_next_header_and_numbers_are_left_out() {
        let text = "# a file\n[machine]\njunction = \"stop\"\n[[curve]]\nknots = [0, # [\n 1]\n[ [ x ] ]\n [[ curve ]] # two\n\
                    control_points_mm=[[1, 2], [3, 4]]\n[table_1]\nrow = [1, 2]\n";
        let (blocks, whole, rest) = lean(text);
        assert_eq!(blocks.len(), 2);
        assert!(blocks[0].starts_with("[[curve]]\nknots") && blocks[0].ends_with("1]\n"), "{blocks:?}");
        assert!(blocks[1].starts_with("[[ curve ]] # two") && blocks[1].ends_with("4]]\n"), "{blocks:?}");
        assert_eq!((whole.len(), rest.len()), (text.len(), text.len()));
        assert!(whole.contains("knots = [") && whole.contains("control_points_mm=[") && !whole.contains('3'));
        assert!(
            rest.contains("junction") && rest.contains("row = [1, 2]") && !rest.contains("curve"),
            "{rest}"
        );
    }

    #[test]
    fn texts_comments_and_other_keys_are_no_headers_and_no_numbers() {
        for text in [
            "a = \"\"\"\n[[curve]]\n\"\"\"\n",
            "# [[curve]]\n",
            "weights.x = [1]\n",
            "x.weights = [1]\n",
            "a = [\n[1, 2],\n[3]]\n",
            "[[curves]]\n[[curve.x]]\n[curve]\n",
            "curve = { knots = [0, 1] }\n",
        ] {
            let (blocks, whole, rest) = lean(text);
            assert_eq!((blocks.len(), whole.as_str(), rest.as_str()), (0, text, text));
        }
    }

    /// The bracket that is never closed takes no curve but its own.
    #[test]
    fn an_open_bracket_ends_with_its_block() {
        let (blocks, whole, _) = lean("[[curve]]\nknots = [0, 1\n[[curve]]\nknots = [0]\n");
        assert_eq!(blocks.len(), 2);
        assert!(whole.contains("knots = [0, 1\n"), "{whole}");
    }
}
