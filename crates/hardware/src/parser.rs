//! The parser of the subset of C.

use std::collections::HashMap;

use crate::error::CoreError;
use crate::lexer::{Placed, Token, Tokens, is_of_part, tokens};
use crate::syntax::{Expression, Function, Kind, Statement, Type, What};

/// A constant table: its type and its values.
#[derive(Clone, Debug)]
pub(crate) struct Constant {
    pub(crate) of: Type,
    pub(crate) values: Expression,
}

/// What a header and a source declare.
#[derive(Debug, Default)]
pub(crate) struct Unit {
    pub(crate) structs: HashMap<String, Vec<(Type, String)>>,
    pub(crate) constants: HashMap<String, Constant>,
    pub(crate) functions: HashMap<String, Function>,
    /// The whole numbers of macros.
    pub(crate) numbers: HashMap<String, i64>,
    /// Those that belong to the part, which stand in the text by their names.
    pub(crate) parameters: HashMap<String, i64>,
}

/// Reads a header and a source.
///
/// # Errors
/// [`CoreError::Syntax`] and [`CoreError::NotInSubset`], with the line.
pub(crate) fn unit(header: &str, source: &str) -> Result<Unit, CoreError> {
    let Tokens { tokens, macros } = tokens(header, source)?;
    let numbers = macros.iter().filter_map(|(name, meaning)| match meaning.as_slice() {
        [Token::Number(value, _)] => Some((name.clone(), value.cast_signed())),
        _ => None,
    });
    let numbers = numbers.collect();
    let of_part = macros.iter().filter(|(name, _)| is_of_part(name)).filter_map(|(name, meaning)| {
        let size = meaning
            .iter()
            .find_map(|token| if let Token::Number(value, _) = token { Some(*value) } else { None })?;
        let sign = if meaning.contains(&Token::Mark("-")) { -1 } else { 1 };
        Some((name.clone(), sign * size.cast_signed()))
    });
    let parameters = of_part.collect();
    let mut parser = Parser {
        tokens,
        next: 0,
        types: builtin_types(),
        unit: Unit { numbers, parameters, ..Unit::default() },
    };
    while parser.peek() != &Token::End {
        parser.declaration()?;
    }
    Ok(parser.unit)
}

fn builtin_types() -> HashMap<String, Type> {
    let short = ["bool", "int", "char", "int8_t", "uint8_t", "int16_t", "uint16_t", "int32_t", "uint32_t"];
    let kinds = short.map(|name| (name, Kind::Short));
    let long = [("int64_t", Kind::Signed64), ("uint64_t", Kind::Unsigned64)];
    let numbers = kinds.into_iter().chain(long).map(|(name, kind)| (name.to_owned(), Type::Number(kind)));
    numbers.chain([("void".to_owned(), Type::Void)]).collect()
}

struct Parser {
    tokens: Vec<Placed>,
    next: usize,
    types: HashMap<String, Type>,
    unit: Unit,
}

/// Binary operators, from loosest to tightest.
const LEVELS: [&[&str]; 10] = [
    &["||"],
    &["&&"],
    &["|"],
    &["^"],
    &["&"],
    &["==", "!="],
    &["<", ">", "<=", ">="],
    &["<<", ">>"],
    &["+", "-"],
    &["*", "/"],
];

impl Parser {
    fn peek(&self) -> &Token {
        self.tokens.get(self.next).map_or(&Token::End, |placed| &placed.token)
    }

    fn peek_second(&self) -> &Token {
        self.tokens.get(self.next + 1).map_or(&Token::End, |placed| &placed.token)
    }

    fn line(&self) -> u32 {
        self.tokens.get(self.next).or(self.tokens.last()).map_or(0, |placed| placed.line)
    }

    fn take(&mut self) -> Token {
        let token = self.peek().clone();
        self.next += 1;
        token
    }

    fn takes(&mut self, mark: &str) -> bool {
        let is_next = matches!(self.peek(), Token::Mark(found) if *found == mark);
        self.next += usize::from(is_next);
        is_next
    }

    fn takes_word(&mut self, word: &str) -> bool {
        let is_next = matches!(self.peek(), Token::Word(found) if found == word);
        self.next += usize::from(is_next);
        is_next
    }

    fn wrong<T>(&self, expected: &'static str) -> Result<T, CoreError> {
        let found = match self.peek() {
            Token::Word(word) => word.clone(),
            Token::Number(value, _) => value.to_string(),
            Token::Mark(mark) => (*mark).to_owned(),
            Token::End => "the end".to_owned(),
        };
        Err(CoreError::Syntax { line: self.line(), found, expected })
    }

    fn expect(&mut self, mark: &'static str) -> Result<(), CoreError> {
        if self.takes(mark) { Ok(()) } else { self.wrong(mark) }
    }

    fn word(&mut self) -> Result<String, CoreError> {
        match self.take() {
            Token::Word(word) => Ok(word),
            _ => {
                self.next -= 1;
                self.wrong("a name")
            }
        }
    }

    fn is_type(&self) -> bool {
        matches!(self.peek(), Token::Word(word) if word == "const" || self.types.contains_key(word))
    }

    /// A declaration of the file.
    fn declaration(&mut self) -> Result<(), CoreError> {
        if self.takes_word("typedef") {
            return self.type_name();
        }
        let line = self.line();
        let (mut is_static, mut is_inline) = (false, false);
        loop {
            match self.peek() {
                Token::Word(word) if word == "static" => is_static = true,
                Token::Word(word) if word == "inline" => is_inline = true,
                _ => break,
            }
            self.next += 1;
        }
        let of = self.base_type()?;
        let of = self.pointers(of);
        let name = self.word()?;
        if !self.takes("(") {
            let of = self.dimensions(of)?;
            self.expect("=")?;
            let values = self.initial()?;
            self.expect(";")?;
            self.unit.constants.insert(name, Constant { of, values });
            return Ok(());
        }
        let parameters = self.parameters()?;
        if self.takes(";") {
            return Ok(());
        }
        let body = self.block()?;
        let function = Function { result: of, parameters, body, is_inline: is_inline && is_static, line };
        self.unit.functions.insert(name, function);
        Ok(())
    }

    fn parameters(&mut self) -> Result<Vec<(Type, String)>, CoreError> {
        let mut found = Vec::new();
        if self.takes_word("void") {
            self.expect(")")?;
            return Ok(found);
        }
        loop {
            let of = self.base_type()?;
            let of = self.pointers(of);
            let name = self.word()?;
            found.push((self.dimensions(of)?, name));
            if !self.takes(",") {
                break;
            }
        }
        self.expect(")")?;
        Ok(found)
    }

    fn type_name(&mut self) -> Result<(), CoreError> {
        if self.takes_word("struct") {
            let members = self.members()?;
            let name = self.word()?;
            self.unit.structs.insert(name.clone(), members);
            self.types.insert(name.clone(), Type::Struct(name));
            return self.expect(";");
        }
        if self.takes_word("enum") {
            while !self.takes("}") {
                self.next += 1;
                if self.peek() == &Token::End {
                    return self.wrong("}");
                }
            }
            let name = self.word()?;
            self.types.insert(name, Type::Number(Kind::Short));
            return self.expect(";");
        }
        let of = self.base_type()?;
        let name = self.word()?;
        // `typedef char NAME[condition ? 1 : -1]` is a check that the compiler makes.
        if self.takes("[") {
            while !self.takes("]") {
                self.next += 1;
                if self.peek() == &Token::End {
                    return self.wrong("]");
                }
            }
        } else {
            self.types.insert(name, of);
        }
        self.expect(";")
    }

    fn members(&mut self) -> Result<Vec<(Type, String)>, CoreError> {
        let mut found = Vec::new();
        self.expect("{")?;
        while !self.takes("}") {
            let of = self.base_type()?;
            let of = self.pointers(of);
            let name = self.word()?;
            found.push((self.dimensions(of)?, name));
            self.expect(";")?;
        }
        Ok(found)
    }

    fn base_type(&mut self) -> Result<Type, CoreError> {
        while self.takes_word("const") {}
        let Token::Word(name) = self.peek() else { return self.wrong("a type") };
        let Some(of) = self.types.get(name).cloned() else { return self.wrong("a type") };
        self.next += 1;
        while self.takes_word("const") {}
        Ok(of)
    }

    fn pointers(&mut self, mut of: Type) -> Type {
        while self.takes("*") {
            of = Type::Pointer(Box::new(of));
            while self.takes_word("const") {}
        }
        of
    }

    /// `[n][m]` behind a name.
    fn dimensions(&mut self, of: Type) -> Result<Type, CoreError> {
        let mut sizes = Vec::new();
        while self.takes("[") {
            if self.takes("]") {
                sizes.push(None);
                continue;
            }
            let size = self.expression()?;
            let Some(size) = constant(&size).and_then(|size| usize::try_from(size).ok()) else {
                return self.wrong("a constant size");
            };
            sizes.push(Some(size));
            self.expect("]")?;
        }
        Ok(sizes.into_iter().rev().fold(of, |of, size| Type::Array(Box::new(of), size)))
    }

    fn block(&mut self) -> Result<Vec<Statement>, CoreError> {
        self.expect("{")?;
        let mut found = Vec::new();
        while !self.takes("}") {
            found.push(self.statement()?);
        }
        Ok(found)
    }

    fn statement(&mut self) -> Result<Statement, CoreError> {
        let line = self.line();
        if matches!(self.peek(), Token::Mark("{")) {
            return Ok(Statement::Block(self.block()?));
        }
        if self.takes_word("if") {
            return self.choice();
        }
        if self.takes_word("while") {
            self.expect("(")?;
            let condition = self.expression()?;
            self.expect(")")?;
            return Ok(Statement::Loop(None, Some(condition), None, Box::new(self.statement()?)));
        }
        if self.takes_word("for") {
            return self.counted();
        }
        if self.takes_word("break") {
            self.expect(";")?;
            return Ok(Statement::Break(line));
        }
        if self.takes_word("return") {
            let value =
                if self.takes(";") { return Ok(Statement::Return(None, line)) } else { self.expression()? };
            self.expect(";")?;
            return Ok(Statement::Return(Some(value), line));
        }
        self.simple()
    }

    fn choice(&mut self) -> Result<Statement, CoreError> {
        self.expect("(")?;
        let condition = self.expression()?;
        self.expect(")")?;
        let then = Box::new(self.statement()?);
        let other = if self.takes_word("else") { Some(Box::new(self.statement()?)) } else { None };
        Ok(Statement::If(condition, then, other))
    }

    fn counted(&mut self) -> Result<Statement, CoreError> {
        self.expect("(")?;
        let begin = if self.takes(";") { None } else { Some(Box::new(self.simple()?)) };
        let condition = if matches!(self.peek(), Token::Mark(";")) { None } else { Some(self.expression()?) };
        self.expect(";")?;
        let step = if matches!(self.peek(), Token::Mark(")")) { None } else { Some(self.expression()?) };
        self.expect(")")?;
        Ok(Statement::Loop(begin, condition, step, Box::new(self.statement()?)))
    }

    /// A declaration or an expression, with its semicolon.
    fn simple(&mut self) -> Result<Statement, CoreError> {
        let line = self.line();
        if !self.is_type() {
            let expression = self.expression()?;
            self.expect(";")?;
            return Ok(Statement::Do(expression));
        }
        let of = self.base_type()?;
        let of = self.pointers(of);
        let name = self.word()?;
        let of = self.dimensions(of)?;
        let value = if self.takes("=") { Some(self.initial()?) } else { None };
        self.expect(";")?;
        Ok(Statement::Declare { of, name, value, line })
    }

    /// An expression, or a list of them between braces.
    fn initial(&mut self) -> Result<Expression, CoreError> {
        let line = self.line();
        if !self.takes("{") {
            return self.expression();
        }
        let mut values = Vec::new();
        while !self.takes("}") {
            values.push(self.initial()?);
            if !self.takes(",") {
                self.expect("}")?;
                break;
            }
        }
        Ok(Expression { what: What::List(values), line })
    }

    fn expression(&mut self) -> Result<Expression, CoreError> {
        let line = self.line();
        let left = self.choice_expression()?;
        for (mark, operator) in [
            ("=", ""),
            ("+=", "+"),
            ("-=", "-"),
            ("*=", "*"),
            ("<<=", "<<"),
            (">>=", ">>"),
            ("|=", "|"),
            ("&=", "&"),
            ("^=", "^"),
        ] {
            if self.takes(mark) {
                let right = self.expression()?;
                return Ok(Expression {
                    what: What::Assign(operator, Box::new(left), Box::new(right)),
                    line,
                });
            }
        }
        Ok(left)
    }

    fn choice_expression(&mut self) -> Result<Expression, CoreError> {
        let line = self.line();
        let condition = self.binary(0)?;
        if !self.takes("?") {
            return Ok(condition);
        }
        let then = self.expression()?;
        self.expect(":")?;
        let other = self.choice_expression()?;
        Ok(Expression { what: What::Choice(Box::new(condition), Box::new(then), Box::new(other)), line })
    }

    fn binary(&mut self, level: usize) -> Result<Expression, CoreError> {
        let Some(operators) = LEVELS.get(level) else { return self.unary() };
        let mut left = self.binary(level + 1)?;
        loop {
            let line = self.line();
            let Some(operator) = operators.iter().find(|operator| self.takes(operator)) else {
                return Ok(left);
            };
            let right = self.binary(level + 1)?;
            left = Expression { what: What::Binary(operator, Box::new(left), Box::new(right)), line };
        }
    }

    fn unary(&mut self) -> Result<Expression, CoreError> {
        let line = self.line();
        for operator in ["-", "~", "!", "&", "*"] {
            if self.takes(operator) {
                let inner = self.unary()?;
                return Ok(Expression { what: What::Unary(operator, Box::new(inner)), line });
            }
        }
        let is_cast = matches!(self.peek(), Token::Mark("("))
            && matches!(self.peek_second(), Token::Word(word) if word == "const" || self.types.contains_key(word));
        if is_cast {
            self.next += 1;
            let of = self.base_type()?;
            let of = self.pointers(of);
            self.expect(")")?;
            return Ok(Expression { what: What::Cast(of, Box::new(self.unary()?)), line });
        }
        self.postfix()
    }

    fn postfix(&mut self) -> Result<Expression, CoreError> {
        let mut found = self.primary()?;
        loop {
            let line = self.line();
            let boxed = |inner: &Expression| Box::new(inner.clone());
            let what = if self.takes("->") || self.takes(".") {
                What::Member(boxed(&found), self.word()?)
            } else if self.takes("[") {
                let index = self.expression()?;
                self.expect("]")?;
                What::Index(boxed(&found), Box::new(index))
            } else if self.takes("++") || self.takes("--") {
                let is_up =
                    matches!(self.tokens.get(self.next - 1), Some(Placed { token: Token::Mark("++"), .. }));
                let one = Expression { what: What::Number(1, Kind::Short), line };
                What::Assign(if is_up { "+" } else { "-" }, boxed(&found), Box::new(one))
            } else {
                return Ok(found);
            };
            found = Expression { what, line };
        }
    }

    fn primary(&mut self) -> Result<Expression, CoreError> {
        let line = self.line();
        let what = match self.take() {
            Token::Number(value, is_long) => {
                What::Number(value.cast_signed(), if is_long { Kind::Unsigned64 } else { Kind::Short })
            }
            Token::Mark("(") => {
                let inner = self.expression()?;
                self.expect(")")?;
                return Ok(inner);
            }
            Token::Word(name) => match builtin(&name) {
                Some(what) => what,
                None if self.takes("(") => {
                    let mut arguments = Vec::new();
                    while !self.takes(")") {
                        arguments.push(self.expression()?);
                        if !self.takes(",") {
                            self.expect(")")?;
                            break;
                        }
                    }
                    called(name, arguments)
                }
                None => What::Name(name),
            },
            _ => {
                self.next -= 1;
                return self.wrong("an expression");
            }
        };
        Ok(Expression { what, line })
    }
}

/// Constants of the headers of C.
fn builtin(name: &str) -> Option<What> {
    let (value, kind) = match name {
        "true" => (1, Kind::Short),
        "false" => (0, Kind::Short),
        "UINT8_MAX" => (0xff, Kind::Short),
        "UINT16_MAX" => (0xffff, Kind::Short),
        "INT32_MAX" => (i64::from(i32::MAX), Kind::Short),
        "INT64_MAX" => (i64::MAX, Kind::Signed64),
        "UINT64_MAX" => (-1, Kind::Unsigned64),
        _ => return None,
    };
    Some(What::Number(value, kind))
}

/// A call, or a constant of a certain type written like one.
fn called(name: String, arguments: Vec<Expression>) -> What {
    let kind = match name.as_str() {
        "UINT32_C" | "INT32_C" => Kind::Short,
        "UINT64_C" => Kind::Unsigned64,
        "INT64_C" => Kind::Signed64,
        _ => return What::Call(name, arguments),
    };
    match arguments.first().and_then(constant) {
        Some(value) => What::Number(value, kind),
        None => What::Call(name, arguments),
    }
}

/// The value of a constant expression.
pub(crate) fn constant(expression: &Expression) -> Option<i64> {
    match &expression.what {
        What::Number(value, _) => Some(*value),
        What::Unary("-", a) => Some(constant(a)?.wrapping_neg()),
        What::Cast(_, a) => constant(a),
        What::Binary(operator, a, b) => {
            let (a, b) = (constant(a)?, constant(b)?);
            match *operator {
                "+" => Some(a.wrapping_add(b)),
                "-" => Some(a.wrapping_sub(b)),
                "*" => Some(a.wrapping_mul(b)),
                _ => None,
            }
        }
        _ => None,
    }
}
