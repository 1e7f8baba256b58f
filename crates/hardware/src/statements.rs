//! Statements.

use crate::error::CoreError;
use crate::front::{Front, Level, Meaning, ReturnTo, Value};
use crate::parser::constant;
use crate::program::{End, Op, Operand};
use crate::syntax::{Expression, Kind, Statement, Type, What};

/// The most rounds of a loop that are written out.
const MOST_ROUNDS: usize = 64;

/// A loop over a counter that is known when the text is read.
struct Counter {
    name: String,
    begin: i64,
    by: i64,
}

impl Front<'_> {
    /// Reads statements as a block of their own.
    pub(crate) fn block_of(&mut self, statements: &[Statement], line: u32) -> Result<(), CoreError> {
        self.frame(line)?.levels.push(Level::default());
        for (index, statement) in statements.iter().enumerate() {
            // A value is stored when all calls in it are over; a call alone leaves nothing to do.
            let is_simple =
                matches!(statement, Statement::Do(_) | Statement::Return(..) | Statement::Declare { .. });
            let is_over =
                !is_simple || matches!(statement, Statement::Do(Expression { what: What::Call(..), .. }));
            let rest = statements.get(index + usize::from(is_over)..).unwrap_or(&[]).to_vec();
            if let Some(level) = self.frame(line)?.levels.last_mut() {
                level.rest = rest;
            }
            if self.current.is_none() {
                break;
            }
            self.statement(statement)?;
        }
        self.frame(line)?.levels.pop();
        Ok(())
    }

    pub(crate) fn statement(&mut self, statement: &Statement) -> Result<(), CoreError> {
        match statement {
            Statement::Declare { of, name, value, line } => self.declare(of, name, value.as_ref(), *line),
            Statement::Do(expression) => self.value(expression).map(|_| ()),
            Statement::Block(inner) => self.block_of(inner, 0),
            Statement::If(condition, then, other) => self.choose(condition, then, other.as_deref()),
            Statement::Loop(begin, condition, step, body) => {
                let whole = Level { rest: vec![statement.clone()], ..Level::default() };
                self.frame(0)?.levels.push(whole);
                self.repeat(begin.as_deref(), condition.as_ref(), step.as_ref(), body)?;
                self.frame(0)?.levels.pop();
                Ok(())
            }
            Statement::Break(line) => {
                let to = self.frame(*line)?.breaks.last().copied();
                let Some(to) = to else { return Err(CoreError::subset(*line, "break here")) };
                self.end(End::Jump(to), None);
                Ok(())
            }
            Statement::Return(value, line) => self.give_back(value.as_ref(), *line),
        }
    }

    fn declare(
        &mut self,
        of: &Type,
        name: &str,
        value: Option<&Expression>,
        line: u32,
    ) -> Result<(), CoreError> {
        let Some(value) = value else {
            let node = self.memory(of, line)?;
            self.name(name, Meaning::Node(node));
            return Ok(());
        };
        if let What::List(values) = &value.what {
            let node = self.memory(of, line)?;
            for (index, value) in (0..).zip(values) {
                let value = self.value(value)?;
                if let Value::Place(part) =
                    self.element(&crate::front::Target::Node(node), Operand::Constant(index), line)?
                {
                    self.store(&part, value, line)?;
                }
            }
            self.name(name, Meaning::Node(node));
            return Ok(());
        }
        let value = self.value(value)?;
        match (of, value) {
            // A struct that a function returns is new memory.
            (Type::Struct(_), Value::Place(crate::front::Target::Node(node))) => {
                self.name(name, Meaning::Node(node))
            }
            (_, value) => {
                let node = self.memory(of, line)?;
                self.store(&crate::front::Target::Node(node), value, line)?;
                self.name(name, Meaning::Node(node));
            }
        }
        Ok(())
    }

    fn choose(
        &mut self,
        condition: &Expression,
        then: &Statement,
        other: Option<&Statement>,
    ) -> Result<(), CoreError> {
        let bodies = std::iter::once(then).chain(other).cloned().collect();
        self.frame(condition.line)?.levels.push(Level { rest: bodies, ..Level::default() });
        let [yes, no, join] = [self.block(), self.block(), self.block()];
        self.condition(condition, yes, no)?;
        self.frame(condition.line)?.levels.pop();
        let is_reached = |block, front: &Self| {
            front.program.blocks.iter().any(|from| from.end.targets().any(|to| to == block))
        };
        let mut goes_on = false;
        for (block, body) in [(yes, Some(then)), (no, other)] {
            if !is_reached(block, self) {
                continue;
            }
            self.current = Some(block);
            if let Some(body) = body {
                self.statement(body)?;
            }
            goes_on |= self.current.is_some();
            self.end(End::Jump(join), None);
        }
        self.current = goes_on.then_some(join);
        Ok(())
    }

    fn repeat(
        &mut self,
        begin: Option<&Statement>,
        condition: Option<&Expression>,
        step: Option<&Expression>,
        body: &Statement,
    ) -> Result<(), CoreError> {
        if let (Some(condition), Some(counter)) = (condition, self.counter(begin, step, body)) {
            return self.write_out(&counter, condition, body);
        }
        if let Some(begin) = begin {
            self.statement(begin)?;
        }
        let [head, inside, after] = [self.block(), self.block(), self.block()];
        self.end(End::Jump(head), Some(head));
        match condition {
            Some(condition) => self.condition(condition, inside, after)?,
            None => self.end(End::Jump(inside), None),
        }
        self.current = Some(inside);
        self.frame(0)?.breaks.push(after);
        self.statement(body)?;
        self.frame(0)?.breaks.pop();
        if self.current.is_some()
            && let Some(step) = step
        {
            self.value(step)?;
        }
        self.end(End::Jump(head), Some(after));
        Ok(())
    }

    /// The counter of a loop that begins at a constant and whose rounds take other numbers of an array.
    fn counter(
        &mut self,
        begin: Option<&Statement>,
        step: Option<&Expression>,
        body: &Statement,
    ) -> Option<Counter> {
        let Some(Statement::Declare { name, value: Some(value), .. }) = begin else { return None };
        let What::Assign(operator, _, _) = &step?.what else { return None };
        let by = match *operator {
            "+" => 1,
            "-" => -1,
            _ => return None,
        };
        let mut is_index = false;
        body.each(&mut |expression| {
            if let What::Index(_, index) = &expression.what {
                index.each(&mut |inner| is_index |= matches!(&inner.what, What::Name(used) if used == name));
            }
        });
        // The rounds of an outer loop count inner ones.
        let mut counts = false;
        if let Statement::Block(inner) = body {
            counts = inner.iter().any(|inner| matches!(inner, Statement::Loop(..)));
        }
        if !is_index && !counts {
            return None;
        }
        Some(Counter { name: name.clone(), begin: self.known(value)?, by })
    }

    /// The value of an expression that takes no operation.
    fn known(&self, expression: &Expression) -> Option<i64> {
        match &expression.what {
            What::Name(name) => match self.meaning(name) {
                Some(Meaning::Constant(value, _)) => Some(*value),
                _ => None,
            },
            What::Binary(operator @ ("+" | "-" | "<" | ">" | "<=" | ">=" | "*"), a, b) => {
                let (a, b) = (self.known(a)?, self.known(b)?);
                Some(match *operator {
                    "+" => a + b,
                    "-" => a - b,
                    "*" => a * b,
                    "<" => i64::from(a < b),
                    ">" => i64::from(a > b),
                    "<=" => i64::from(a <= b),
                    _ => i64::from(a >= b),
                })
            }
            _ => constant(expression),
        }
    }

    fn write_out(
        &mut self,
        counter: &Counter,
        condition: &Expression,
        body: &Statement,
    ) -> Result<(), CoreError> {
        let mut value = counter.begin;
        for round in 0.. {
            if round > MOST_ROUNDS {
                return Err(CoreError::subset(
                    condition.line,
                    format!("loop of more than {MOST_ROUNDS} rounds"),
                ));
            }
            self.frame(condition.line)?.levels.push(Level::default());
            self.name(&counter.name, Meaning::Constant(value, Kind::Short));
            let goes_on = self.known(condition);
            let goes_on = goes_on.ok_or_else(|| {
                CoreError::subset(condition.line, "loop over numbers whose end is not constant")
            })?;
            if goes_on != 0 {
                self.statement(body)?;
            }
            self.frame(condition.line)?.levels.pop();
            if goes_on == 0 {
                break;
            }
            value += counter.by;
        }
        Ok(())
    }

    fn give_back(&mut self, value: Option<&Expression>, line: u32) -> Result<(), CoreError> {
        let to = self.frame(line)?.return_to;
        let zero = Operand::Constant(0);
        match (to, value) {
            (ReturnTo::Condition { then, other }, Some(value)) => self.condition(value, then, other),
            (ReturnTo::Join { result: Some((register, _)), block }, Some(value)) => {
                let (operand, _) = self.number(value)?;
                self.emit(Op::Move, register, [operand, zero, zero]);
                self.end(End::Jump(block), None);
                Ok(())
            }
            (ReturnTo::Join { block, .. }, _) => {
                self.end(End::Jump(block), None);
                Ok(())
            }
            (ReturnTo::Routine { result }, value) => {
                if let (Some(result), Some(value)) = (result, value) {
                    let (operand, _) = self.number(value)?;
                    self.emit(Op::Move, result, [operand, zero, zero]);
                }
                self.end(End::Return, None);
                Ok(())
            }
            (ReturnTo::Condition { .. }, None) => Err(CoreError::subset(line, "return without a value here")),
        }
    }
}
