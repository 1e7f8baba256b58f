//! The functions of the C that are operations of the core: those of its section *Numbers*, and long products.

use crate::error::CoreError;
use crate::front::{Front, Target, Value};
use crate::program::{Op, Operand};
use crate::syntax::{Expression, Kind, Type};

/// An operation of one number, two or three, or something that takes several.
enum Meant {
    Op(Op),
    Negative,
    Absolute,
    Half,
    Plus,
    Rounded,
    Norm,
    PartOf,
    LongProduct,
}

fn meant(name: &str) -> Option<Meant> {
    Some(match name {
        "add" => Meant::Op(Op::AddNumbers),
        "sub" => Meant::Op(Op::SubNumbers),
        "minimum" => Meant::Op(Op::Min),
        "maximum" => Meant::Op(Op::Max),
        "absolute" => Meant::Absolute,
        "half" => Meant::Half,
        "mul" | "mul_by" | "mul_add" => Meant::Op(Op::Product),
        "product" => Meant::Op(Op::Sum),
        "times_power_of_two" | "raised" | "lowered" | "lowered_or_kept" => Meant::Op(Op::Scale),
        "divide" => Meant::Op(Op::Divide),
        "power_of_two" => Meant::Op(Op::PowerOfTwo),
        "negative" => Meant::Negative,
        "plus" => Meant::Plus,
        "rounded" => Meant::Rounded,
        "norm" => Meant::Norm,
        "part_of" => Meant::PartOf,
        "product_of_words" => Meant::LongProduct,
        _ => return None,
    })
}

impl Front<'_> {
    /// What a call gives if the core has its function; `None` for one that is read from the text.
    pub(crate) fn intrinsic(
        &mut self,
        name: &str,
        arguments: &[Expression],
        line: u32,
    ) -> Result<Option<Value>, CoreError> {
        let zero = Operand::Constant(0);
        let operand = match meant(name) {
            None => return Ok(None),
            Some(Meant::Op(op)) => {
                let operands = arguments.iter().map(|argument| Ok(self.number(argument)?.0));
                let operands = operands.collect::<Result<Vec<_>, CoreError>>()?;
                self.op(op, &operands)
            }
            Some(Meant::Negative) => {
                let [a] = self.numbers(arguments, line)?;
                self.op(Op::SubNumbers, &[zero, a])
            }
            Some(Meant::Absolute) => {
                let [a] = self.numbers(arguments, line)?;
                let negative = self.op(Op::SubNumbers, &[zero, a]);
                self.op(Op::Max, &[a, negative])
            }
            Some(Meant::Half) => {
                let [a] = self.numbers(arguments, line)?;
                self.op(Op::Scale, &[a, Operand::Constant(-1)])
            }
            Some(Meant::Plus) => {
                let [a, b] = self.numbers(arguments, line)?;
                self.op(Op::Add, &[a, b])
            }
            Some(Meant::Rounded) => {
                let [a] = self.numbers(arguments, line)?;
                self.op(Op::RoundedSum, &[zero, zero, a])
            }
            Some(Meant::Norm) => {
                let [vector] = arguments else { return Err(CoreError::subset(line, "norm of this")) };
                self.norm(vector)?
            }
            Some(Meant::PartOf) => {
                let [row, step] = arguments else { return Err(CoreError::subset(line, "part_of this")) };
                let row = self.target(row)?;
                let (step, _) = self.number(step)?;
                let exponent = self.member(&row, "step_exponent", line)?;
                let Value::Number(exponent, _) = self.load(exponent) else {
                    return Err(CoreError::subset(line, "part_of this"));
                };
                let places = Operand::Constant(64 - i64::from(self.program.numbers.fraction_bits));
                let places = self.op(Op::Sub, &[places, exponent]);
                return Ok(Some(Value::Number(self.op(Op::ToPhase, &[step, places]), Kind::Unsigned64)));
            }
            Some(Meant::LongProduct) => return Ok(Some(self.long_product(arguments, line)?)),
        };
        let is_wide = matches!(meant(name), Some(Meant::Plus | Meant::Op(Op::Sum)));
        Ok(Some(Value::Number(operand, if is_wide { Kind::Unsigned64 } else { Kind::Short })))
    }

    fn norm(&mut self, vector: &Expression) -> Result<Operand, CoreError> {
        let target = self.target(vector)?;
        let mut sum = Operand::Constant(0);
        for index in 0.. {
            let Ok(value) = self.element(&target, Operand::Constant(index), vector.line) else { break };
            let Value::Place(target) = value else { break };
            let Value::Number(part, _) = self.load(target) else { break };
            sum = self.op(Op::Sum, &[part, part, sum]);
        }
        Ok(self.op(Op::Root, &[sum]))
    }

    /// Both words of a product of 64 bits by 64, limb by limb, into new memory of the struct that C returns.
    fn long_product(&mut self, arguments: &[Expression], line: u32) -> Result<Value, CoreError> {
        let [a, b] = self.numbers(arguments, line)?;
        let bits = self.program.numbers.limb_bits();
        let limbs = u8::try_from(64 / bits).unwrap_or(2);
        let (width, mask) = (Operand::Constant(i64::from(bits)), Operand::Constant((1 << bits) - 1));
        let mut carry = Operand::Constant(0);
        let mut words = [Operand::Constant(0); 2];
        for place in 0..2 * limbs {
            let mut column = [carry, Operand::Constant(0)];
            let products = (0..limbs).filter(|i| (0..limbs).contains(&place.wrapping_sub(*i)));
            for (i, part) in products.zip([0, 1].into_iter().cycle()) {
                // Two limbs of 32 bits fill a word: a second product takes the part of the first that is above the limb.
                if bits == 32 && part == 1 {
                    let low = self.op(Op::And, &[column[0], mask]);
                    column[1] = self.op(Op::ShiftRight, &[column[0], width]);
                    column[0] = self.op(Op::Limbs(i, place - i), &[a, b, low]);
                } else {
                    column[0] = self.op(Op::Limbs(i, place - i), &[a, b, column[0]]);
                }
            }
            let digit = self.op(Op::And, &[column[0], mask]);
            let above = self.op(Op::ShiftRight, &[column[0], width]);
            carry =
                if column[1] == Operand::Constant(0) { above } else { self.op(Op::Add, &[above, column[1]]) };
            let shift = Operand::Constant(i64::from(place % limbs) * i64::from(bits));
            let shifted = self.op(Op::ShiftLeft, &[digit, shift]);
            if let Some(word) = words.get_mut(usize::from(place / limbs)) {
                *word = if place % limbs == 0 { digit } else { self.op(Op::Or, &[*word, shifted]) };
            }
        }
        let node = self.memory(&Type::Struct("two_words".to_owned()), line)?;
        let [low, high] = words;
        for (member, word) in [("high", high), ("low", low)] {
            let target = self.member(&Target::Node(node), member, line)?;
            self.store(&target, Value::Number(word, Kind::Unsigned64), line)?;
        }
        Ok(Value::Place(Target::Node(node)))
    }
}
