//! Values in brackets that are evaluated when their line is executed: conditions and arguments of commands.

use crate::diagnostic::Report;
use crate::gcode::expression::Parser;
use crate::gcode::scope::Scope;

/// The value in brackets at byte `at` of a line that begins at byte `start`: the condition of a command.
pub(crate) fn condition(
    report: &mut Report<'_>,
    scope: Scope<'_>,
    start: usize,
    line: &str,
    at: usize,
) -> Option<f64> {
    let mut parser = Parser::new(line, at, scope, false);
    match parser.bracketed() {
        Ok(value) => Some(value.unwrap_or(0.0)),
        Err(fault) => {
            fault.say(report, start);
            None
        }
    }
}

/// The values in brackets from byte `at` of a line on: the arguments of a call.
pub(crate) fn arguments(
    report: &mut Report<'_>,
    scope: Scope<'_>,
    start: usize,
    line: &str,
    at: usize,
) -> Option<Vec<f64>> {
    let mut parser = Parser::new(line, at, scope, false);
    let mut values = Vec::new();
    while parser.peek() == Some(b'[') {
        match parser.bracketed() {
            Ok(value) => values.push(value.unwrap_or(0.0)),
            Err(fault) => {
                fault.say(report, start);
                return None;
            }
        }
    }
    Some(values)
}
