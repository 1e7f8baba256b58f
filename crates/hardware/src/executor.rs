//! The reference executor: it runs the blocks as they stand, one operation after the other.

use crate::error::CoreError;
use crate::program::{BlockId, End, Event, OUTPUT_DONE, OUTPUT_WHOLE, Op, Operand, Program};

/// What a run has made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Run {
    /// For each setpoint the output words.
    pub(crate) setpoints: Vec<Vec<i64>>,
    /// How often each block was run, and how often its branch held.
    pub(crate) counts: Vec<u64>,
    pub(crate) held: Vec<u64>,
}

/// Runs these sections.
///
/// # Errors
/// [`CoreError::Endless`] after `most` operations.
pub(crate) fn run(program: &Program, sections: u32, most: u64) -> Result<Run, CoreError> {
    let mut registers = vec![0_i64; program.registers as usize];
    run_with(program, &mut registers, sections, most)
}

/// The same from these registers, which it changes.
///
/// # Errors
/// As [`run`].
pub(crate) fn run_with(
    program: &Program,
    registers: &mut [i64],
    sections: u32,
    most: u64,
) -> Result<Run, CoreError> {
    let mut result = Run {
        setpoints: Vec::new(),
        counts: vec![0; program.blocks.len()],
        held: vec![0; program.blocks.len()],
    };
    let mut words = vec![0; program.outputs.len()];
    let (mut at, mut calls, mut begun): (BlockId, Vec<BlockId>, u32) = (program.entry, Vec::new(), 0);
    let mut steps = 0;
    loop {
        let Some(block) = program.blocks.get(at) else { return Ok(result) };
        if let Some(count) = result.counts.get_mut(at) {
            *count += 1;
        }
        for operation in &block.operations {
            let [a, b, c] = operation.operands.map(|operand| value(program, registers, operand));
            match operation.op {
                Op::Output(OUTPUT_WHOLE) => result.setpoints.push(words.clone()),
                Op::Output(OUTPUT_DONE) => {}
                Op::Output(place) => words.iter_mut().skip(place.into()).take(1).for_each(|word| *word = a),
                op => {
                    let value = if op == Op::Input {
                        i64::from(begun) - 1
                    } else {
                        program.numbers.value(op, [a, b, c])
                    };
                    registers
                        .iter_mut()
                        .skip(operation.to as usize)
                        .take(1)
                        .for_each(|register| *register = value);
                }
            }
        }
        steps += 1 + block.operations.len() as u64;
        if steps > most {
            return Err(CoreError::Endless { steps: most });
        }
        at = match block.end {
            End::Jump(to) => to,
            End::Branch { compare, a, b, then, other } => {
                let [a, b] = [a, b].map(|operand| value(program, registers, operand));
                if compare.holds(a, b) {
                    result.held.iter_mut().skip(at).take(1).for_each(|count| *count += 1);
                    then
                } else {
                    other
                }
            }
            End::Call { entry, then } => {
                calls.push(then);
                entry
            }
            End::Return => match calls.pop() {
                Some(to) => to,
                None => return Ok(result),
            },
            End::Wait(Event::Start, _) if begun == sections => return Ok(result),
            End::Wait(Event::Start, to) => {
                begun += 1;
                to
            }
            End::Wait(Event::Taken, to) => to,
        };
    }
}

/// What an operand is. The address of a row is its number.
fn value(program: &Program, registers: &[i64], operand: Operand) -> i64 {
    let register = |register: u32| registers.get(register as usize).copied().unwrap_or(0);
    match operand {
        Operand::Register(of) => register(of),
        Operand::Constant(value) => value,
        Operand::Parameter(number) => {
            program.parameters.get(usize::from(number)).map_or(0, |(_, value)| *value)
        }
        Operand::Column(row, column) => program.tables.word(column, register(row)),
    }
}
