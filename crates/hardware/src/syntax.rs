//! Types, expressions, statements and functions of the subset of C.

/// A type.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Type {
    Void,
    Number(Kind),
    Struct(String),
    Pointer(Box<Type>),
    /// So many of a type; no number where C counts them itself.
    Array(Box<Type>, Option<usize>),
}

/// How whole numbers are compared and shifted. Those of up to 32 bits are taken as integers that never wrap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Kind {
    Short,
    Unsigned64,
    Signed64,
}

impl Kind {
    /// The kind of a sum of both.
    pub(crate) fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unsigned64, _) | (_, Self::Unsigned64) => Self::Unsigned64,
            (Self::Signed64, _) | (_, Self::Signed64) => Self::Signed64,
            _ => Self::Short,
        }
    }
}

/// An expression and its line.
#[derive(Clone, Debug)]
pub(crate) struct Expression {
    pub(crate) what: What,
    pub(crate) line: u32,
}

#[derive(Clone, Debug)]
pub(crate) enum What {
    Number(i64, Kind),
    Name(String),
    /// `-`, `~`, `!`, `&` and `*`.
    Unary(&'static str, Box<Expression>),
    Binary(&'static str, Box<Expression>, Box<Expression>),
    Choice(Box<Expression>, Box<Expression>, Box<Expression>),
    /// The mark before `=`, empty for a plain assignment.
    Assign(&'static str, Box<Expression>, Box<Expression>),
    Call(String, Vec<Expression>),
    Member(Box<Expression>, String),
    Index(Box<Expression>, Box<Expression>),
    Cast(Type, Box<Expression>),
    /// The values between braces.
    List(Vec<Expression>),
}

#[derive(Clone, Debug)]
pub(crate) enum Statement {
    Declare {
        of: Type,
        name: String,
        value: Option<Expression>,
        line: u32,
    },
    Do(Expression),
    If(Expression, Box<Statement>, Option<Box<Statement>>),
    /// `for` and `while`: begin, condition, step and body.
    Loop(Option<Box<Statement>>, Option<Expression>, Option<Expression>, Box<Statement>),
    Break(u32),
    Return(Option<Expression>, u32),
    Block(Vec<Statement>),
}

/// A function.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) result: Type,
    pub(crate) parameters: Vec<(Type, String)>,
    pub(crate) body: Vec<Statement>,
    /// The text asks for it in place.
    pub(crate) is_inline: bool,
    pub(crate) line: u32,
}

impl Statement {
    /// Calls `see` with every expression in the statement.
    pub(crate) fn each(&self, see: &mut dyn FnMut(&Expression)) {
        match self {
            Self::Declare { value, .. } => value.iter().for_each(|value| value.each(see)),
            Self::Do(expression) => expression.each(see),
            Self::If(condition, then, other) => {
                condition.each(see);
                then.each(see);
                other.iter().for_each(|other| other.each(see));
            }
            Self::Loop(begin, condition, step, body) => {
                begin.iter().for_each(|begin| begin.each(see));
                condition.iter().chain(step).for_each(|expression| expression.each(see));
                body.each(see);
            }
            Self::Break(_) => {}
            Self::Return(value, _) => value.iter().for_each(|value| value.each(see)),
            Self::Block(inner) => inner.iter().for_each(|statement| statement.each(see)),
        }
    }
}

impl Expression {
    /// Calls `see` with the expression and every one in it.
    pub(crate) fn each(&self, see: &mut dyn FnMut(&Self)) {
        see(self);
        match &self.what {
            What::Number(..) | What::Name(_) => {}
            What::Unary(_, a) | What::Member(a, _) | What::Cast(_, a) => a.each(see),
            What::Binary(_, a, b) | What::Assign(_, a, b) | What::Index(a, b) => {
                a.each(see);
                b.each(see);
            }
            What::Choice(a, b, c) => [a, b, c].into_iter().for_each(|part| part.each(see)),
            What::Call(_, parts) | What::List(parts) => parts.iter().for_each(|part| part.each(see)),
        }
    }
}
