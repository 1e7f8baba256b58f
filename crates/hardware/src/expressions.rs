//! Expressions: values, places and conditions.

use crate::error::CoreError;
use crate::front::{Front, Meaning, Target, Value};
use crate::program::{BlockId, Compare, End, Op, Operand, Register};
use crate::syntax::{Expression, Kind, Type, What};

/// The shift that a product with a power of two is.
fn shift_of(factor: Operand) -> Option<i64> {
    match factor {
        Operand::Constant(value) if value > 0 && value.count_ones() == 1 => {
            Some(i64::from(value.trailing_zeros()))
        }
        _ => None,
    }
}

impl Front<'_> {
    /// The value of an expression.
    pub(crate) fn value(&mut self, expression: &Expression) -> Result<Value, CoreError> {
        let line = expression.line;
        match &expression.what {
            What::Number(value, kind) => Ok(Value::Number(Operand::Constant(*value), *kind)),
            What::Name(name) => self.named(name, line),
            What::Unary("&", inner) => Ok(Value::Place(self.place(inner)?)),
            What::Unary("*", inner) => {
                let target = self.target(inner)?;
                Ok(self.load(target))
            }
            What::Unary("!", _) | What::Binary("&&" | "||" | "==" | "!=" | "<" | ">" | "<=" | ">=", ..) => {
                self.truth(expression)
            }
            What::Unary(operator, inner) => {
                let (operand, kind) = self.number(inner)?;
                let least = Operand::Constant(if *operator == "~" { -1 } else { 0 });
                Ok(Value::Number(self.op(Op::Sub, &[least, operand]), kind))
            }
            What::Binary(operator, a, b) => {
                let a = self.number(a)?;
                let b = self.number(b)?;
                let (operand, kind) = self.binary(operator, a, b, line)?;
                Ok(Value::Number(operand, kind))
            }
            What::Choice(condition, then, other) => self.choice(condition, then, other),
            What::Assign(operator, to, value) => {
                self.assign(operator, to, value)?;
                Ok(Value::Nothing)
            }
            What::Call(name, arguments) => self.call(name, arguments, line, None),
            What::Member(of, name) => {
                let of = self.target(of)?;
                let target = self.member(&of, name, line)?;
                Ok(self.load(target))
            }
            What::Index(of, index) => {
                let of = self.target(of)?;
                let (index, _) = self.number(index)?;
                match self.element(&of, index, line)? {
                    Value::Place(target) => Ok(self.load(target)),
                    value => Ok(value),
                }
            }
            What::Cast(Type::Void, inner) => {
                if !matches!(inner.what, What::Name(_)) {
                    self.value(inner)?;
                }
                Ok(Value::Nothing)
            }
            What::Cast(Type::Number(kind), inner) => {
                let (operand, _) = self.number(inner)?;
                Ok(Value::Number(operand, *kind))
            }
            What::Cast(..) => Err(CoreError::subset(line, "cast to this type")),
            What::List(_) => Err(CoreError::subset(line, "list of values here")),
        }
    }

    /// A number and its kind.
    pub(crate) fn number(&mut self, expression: &Expression) -> Result<(Operand, Kind), CoreError> {
        match self.value(expression)? {
            Value::Number(operand, kind) => Ok((operand, kind)),
            _ => Err(CoreError::subset(expression.line, "anything but a number here")),
        }
    }

    /// What a pointer points at, or where a struct or an array lies.
    pub(crate) fn target(&mut self, expression: &Expression) -> Result<Target, CoreError> {
        match self.value(expression)? {
            Value::Place(target) => Ok(target),
            _ => Err(CoreError::subset(expression.line, "anything but a pointer here")),
        }
    }

    /// The place that an expression names.
    pub(crate) fn place(&mut self, expression: &Expression) -> Result<Target, CoreError> {
        let line = expression.line;
        match &expression.what {
            What::Name(name) => match self.meaning(name) {
                Some(Meaning::Node(node)) => Ok(Target::Node(*node)),
                Some(Meaning::Bound(target)) => Ok(target.clone()),
                _ => Err(CoreError::subset(line, format!("place of {name}"))),
            },
            What::Unary("*", inner) => self.target(inner),
            What::Member(of, name) => {
                let of = self.target(of)?;
                self.member(&of, name, line)
            }
            What::Index(of, index) => {
                let of = self.target(of)?;
                let (index, _) = self.number(index)?;
                match self.element(&of, index, line)? {
                    Value::Place(target) => Ok(target),
                    _ => Err(CoreError::subset(line, "place of a constant")),
                }
            }
            _ => Err(CoreError::subset(line, "place of this expression")),
        }
    }

    fn named(&mut self, name: &str, line: u32) -> Result<Value, CoreError> {
        match self.meaning(name).cloned() {
            Some(Meaning::Node(node)) => return Ok(self.load(Target::Node(node))),
            Some(Meaning::Constant(value, kind)) => return Ok(Value::Number(Operand::Constant(value), kind)),
            Some(Meaning::Bound(target)) => return Ok(Value::Place(target)),
            None => {}
        }
        if let Some(number) = self.program.parameters.iter().position(|(parameter, _)| parameter == name) {
            return Ok(Value::Number(Operand::Parameter(u16::try_from(number).unwrap_or(0)), Kind::Short));
        }
        if self.program.tables.place(name).is_some() {
            return Ok(Value::Place(Target::Table(name.to_owned())));
        }
        if self.unit.constants.contains_key(name) {
            return Ok(Value::Place(Target::List(name.to_owned())));
        }
        Err(CoreError::subset(line, format!("name {name} here")))
    }

    fn binary(
        &mut self,
        operator: &str,
        (a, kind_a): (Operand, Kind),
        (b, kind_b): (Operand, Kind),
        line: u32,
    ) -> Result<(Operand, Kind), CoreError> {
        let kind = kind_a.with(kind_b);
        let op = match operator {
            "+" => Op::Add,
            "-" => Op::Sub,
            "&" => Op::And,
            "|" => Op::Or,
            "<<" => return Ok((self.op(Op::ShiftLeft, &[a, b]), kind_a)),
            ">>" if kind_a != Kind::Signed64 => return Ok((self.op(Op::ShiftRight, &[a, b]), kind_a)),
            "*" => {
                if let Some(shift) = shift_of(a) {
                    return Ok((self.op(Op::ShiftLeft, &[b, Operand::Constant(shift)]), kind));
                }
                if let Some(shift) = shift_of(b) {
                    return Ok((self.op(Op::ShiftLeft, &[a, Operand::Constant(shift)]), kind));
                }
                if kind != Kind::Short {
                    return Err(CoreError::subset(line, "product of words of 64 bits"));
                }
                Op::Sum
            }
            _ => return Err(CoreError::subset(line, format!("operator {operator}"))),
        };
        Ok((self.op(op, &[a, b]), kind))
    }

    pub(crate) fn assign(
        &mut self,
        operator: &'static str,
        to: &Expression,
        value: &Expression,
    ) -> Result<(), CoreError> {
        let line = to.line;
        let value = if operator.is_empty() {
            self.value(value)?
        } else {
            let before = self.number(to)?;
            let by = self.number(value)?;
            let (operand, kind) = self.binary(operator, before, by, line)?;
            Value::Number(operand, kind)
        };
        let to = self.place(to)?;
        self.store(&to, value, line)
    }

    /// A condition as 1 or 0.
    fn truth(&mut self, expression: &Expression) -> Result<Value, CoreError> {
        let [then, other, join] = [self.block(), self.block(), self.block()];
        let to = self.register();
        self.condition(expression, then, other)?;
        for (block, value) in [(then, 1), (other, 0)] {
            self.current = Some(block);
            self.emit(Op::Move, to, [Operand::Constant(value), Operand::Constant(0), Operand::Constant(0)]);
            self.end(End::Jump(join), Some(join));
        }
        Ok(Value::Number(Operand::Register(to), Kind::Short))
    }

    fn choice(
        &mut self,
        condition: &Expression,
        then: &Expression,
        other: &Expression,
    ) -> Result<Value, CoreError> {
        let [yes, no, join] = [self.block(), self.block(), self.block()];
        let to: Register = self.register();
        let mut kinds = Kind::Short;
        self.condition(condition, yes, no)?;
        for (block, expression) in [(yes, then), (no, other)] {
            self.current = Some(block);
            let (operand, kind) = self.number(expression)?;
            kinds = kinds.with(kind);
            self.emit(Op::Move, to, [operand, Operand::Constant(0), Operand::Constant(0)]);
            self.end(End::Jump(join), Some(join));
        }
        Ok(Value::Number(Operand::Register(to), kinds))
    }

    /// Goes to one of two blocks by a condition. Nothing is read after it but in blocks.
    pub(crate) fn condition(
        &mut self,
        expression: &Expression,
        then: BlockId,
        other: BlockId,
    ) -> Result<(), CoreError> {
        let line = expression.line;
        match &expression.what {
            What::Unary("!", inner) => self.condition(inner, other, then),
            What::Binary("&&", a, b) => {
                let second = self.block();
                self.condition(a, second, other)?;
                self.current = Some(second);
                self.condition(b, then, other)
            }
            What::Binary("||", a, b) => {
                let second = self.block();
                self.condition(a, then, second)?;
                self.current = Some(second);
                self.condition(b, then, other)
            }
            What::Binary(operator @ ("==" | "!=" | "<" | ">" | "<=" | ">="), a, b) => {
                let (a, kind_a) = self.number(a)?;
                let (b, kind_b) = self.number(b)?;
                let is_unsigned = kind_a.with(kind_b) == Kind::Unsigned64;
                let less = if is_unsigned { Compare::LessUnsigned } else { Compare::Less };
                let at_most = if is_unsigned { Compare::AtMostUnsigned } else { Compare::AtMost };
                match *operator {
                    "==" => self.branch(Compare::Equal, a, b, then, other),
                    "!=" => self.branch(Compare::Equal, a, b, other, then),
                    "<" => self.branch(less, a, b, then, other),
                    ">" => self.branch(less, b, a, then, other),
                    "<=" => self.branch(at_most, a, b, then, other),
                    _ => self.branch(at_most, b, a, then, other),
                }
                Ok(())
            }
            What::Call(name, arguments) if name == "is_at_most" => {
                let [a, b] = self.numbers(arguments, line)?;
                self.branch(Compare::WithinMagnitude, a, b, then, other);
                Ok(())
            }
            What::Call(name, arguments) => match self.call(name, arguments, line, Some((then, other)))? {
                Value::Number(operand, _) => {
                    self.branch(Compare::Equal, operand, Operand::Constant(0), other, then);
                    Ok(())
                }
                _ => Ok(()),
            },
            _ => {
                let (operand, _) = self.number(expression)?;
                self.branch(Compare::Equal, operand, Operand::Constant(0), other, then);
                Ok(())
            }
        }
    }

    fn branch(&mut self, compare: Compare, a: Operand, b: Operand, then: BlockId, other: BlockId) {
        let end = match (a, b) {
            (Operand::Constant(a), Operand::Constant(b)) => {
                End::Jump(if compare.holds(a, b) { then } else { other })
            }
            _ => End::Branch { compare, a, b, then, other },
        };
        self.end(end, None);
    }

    /// So many numbers as arguments.
    pub(crate) fn numbers<const N: usize>(
        &mut self,
        arguments: &[Expression],
        line: u32,
    ) -> Result<[Operand; N], CoreError> {
        let found =
            arguments.iter().map(|argument| Ok(self.number(argument)?.0)).collect::<Result<Vec<_>, _>>()?;
        found.try_into().map_err(|_| CoreError::subset(line, "call with so many arguments"))
    }
}
