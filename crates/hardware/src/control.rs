//! The whole program around the functions of the C: it waits for a section, starts it, and makes setpoints until its end.

use crate::error::CoreError;
use crate::front::{Frame, Front, Level, Meaning, Node, NodeId, ReturnTo, Target, Value};
use crate::parser::unit;
use crate::program::{End, Event, Numbers, OUTPUT_DONE, OUTPUT_WHOLE, Op, Operand, Program, Register};
use crate::syntax::{Expression, Kind, Statement, Type, What};

/// Reads the files that `c-code` writes for the part of this name.
///
/// # Errors
/// [`CoreError`], with the line of the C, if the text is not of the subset.
pub(crate) fn program(
    header: &str,
    source: &str,
    name: &str,
    numbers: Numbers,
) -> Result<Program, CoreError> {
    let unit = unit(header, source)?;
    let mut front = Front::new(&unit, numbers)?;
    front.count_calls(&[format!("{name}_start"), format!("{name}_step")]);
    front.whole(name)?;
    Ok(front.program)
}

/// What gives the position of a setpoint: a program, the registers of the setpoint's words, and those of the position.
pub(crate) struct Positions {
    pub(crate) program: Program,
    pub(crate) words: Vec<Register>,
    pub(crate) position: Vec<Register>,
}

/// Reads the function that gives a setpoint's position, in 2⁻³⁹ mm.
///
/// # Errors
/// As [`program`].
pub(crate) fn positions(
    header: &str,
    source: &str,
    name: &str,
    numbers: Numbers,
) -> Result<Positions, CoreError> {
    let unit = unit(header, source)?;
    let mut front = Front::new(&unit, numbers)?;
    let function = format!("{name}_position");
    front.count_calls(std::slice::from_ref(&function));
    let entry = front.block();
    (front.program.entry, front.current) = (entry, Some(entry));
    front.frames.push(Frame {
        levels: vec![Level::default()],
        return_to: ReturnTo::Routine { result: None },
        breaks: Vec::new(),
    });
    let of = Type::Struct(format!("{name}_setpoint"));
    let axes = unit.numbers.iter().find(|(name, _)| name.ends_with("_AXES")).map_or(2, |(_, axes)| *axes);
    let position = Type::Array(Box::new(Type::Number(Kind::Signed64)), usize::try_from(axes).ok());
    let [setpoint, position] = [front.memory(&of, 0)?, front.memory(&position, 0)?];
    for (name, node) in [("the setpoint", setpoint), ("the position", position)] {
        front.name(name, Meaning::Node(node));
    }
    front.keep_in_use(&["the setpoint", "the position"]);
    let named = |name: &str| Expression { what: What::Name(name.to_owned()), line: 0 };
    front.call(&function, &[named("the setpoint"), named("the position")], 0, None)?;
    front.end(End::Return, None);
    let registers = |node| {
        let mut found = Vec::new();
        front.registers_in(node, &mut found);
        found
    };
    let (words, position) = (registers(setpoint), registers(position));
    Ok(Positions { program: front.program, words, position })
}

impl Front<'_> {
    /// The registers of all numbers in a node, in their order.
    fn registers_in(&self, node: NodeId, found: &mut Vec<Register>) {
        match self.nodes.get(node) {
            Some(Node::Number(register, _)) => found.push(*register),
            Some(Node::Struct(members)) => {
                members.iter().for_each(|(_, member)| self.registers_in(*member, found))
            }
            Some(Node::Array(parts)) => parts.iter().for_each(|part| self.registers_in(*part, found)),
            _ => {}
        }
    }

    fn whole(&mut self, name: &str) -> Result<(), CoreError> {
        let level = Level::default();
        let [idle, begin, head, out, done] = [(); 5].map(|()| self.block());
        self.program.entry = idle;
        let return_to = ReturnTo::Routine { result: None };
        self.frames.push(Frame { levels: vec![level], return_to, breaks: Vec::new() });
        let state = self.memory(&Type::Struct(format!("{name}_state")), 0)?;
        let setpoint = self.memory(&Type::Struct(format!("{name}_setpoint")), 0)?;
        for (name, node) in [("the state", state), ("the setpoint", setpoint)] {
            self.name(name, Meaning::Node(node));
        }
        self.keep_in_use(&["the state", "the setpoint"]);
        self.current = Some(idle);
        self.end(End::Wait(Event::Start, begin), Some(begin));
        let section = self.register();
        self.emit(Op::Input, section, [Operand::Constant(0); 3]);
        let section = self.node(Node::Number(section, Kind::Short));
        self.name("the section", Meaning::Node(section));
        let named = |name: &str| Expression { what: What::Name(name.to_owned()), line: 0 };
        self.call(&format!("{name}_start"), &[named("the state"), named("the section")], 0, None)?;
        self.end(End::Jump(head), Some(head));
        self.step(name, state, setpoint, ReturnTo::Condition { then: out, other: done })?;
        self.current = Some(out);
        self.give_out(setpoint)?;
        self.end(End::Jump(head), Some(done));
        self.emit(
            Op::Output(OUTPUT_DONE),
            0,
            [Operand::Constant(1), Operand::Constant(0), Operand::Constant(0)],
        );
        self.end(End::Jump(idle), None);
        self.frames.pop();
        Ok(())
    }

    /// Memory of these names is in use throughout.
    fn keep_in_use(&mut self, names: &[&str]) {
        let mention =
            |name: &&str| Statement::Do(Expression { what: What::Name((*name).to_owned()), line: 0 });
        if let Some(level) = self.frames.last_mut().and_then(|frame| frame.levels.last_mut()) {
            level.rest = names.iter().map(mention).collect();
        }
    }

    /// The step. Its first statements, up to the distance of the period, come before the last setpoint is taken.
    fn step(
        &mut self,
        name: &str,
        state: NodeId,
        setpoint: NodeId,
        return_to: ReturnTo,
    ) -> Result<(), CoreError> {
        let Some(function) = self.unit.functions.get(&format!("{name}_step")) else {
            return Err(CoreError::subset(0, format!("function {name}_step")));
        };
        let nodes = [state, setpoint].map(|node| Meaning::Bound(Target::Node(node)));
        let names = function.parameters.iter().map(|(_, name)| name.clone()).zip(nodes).collect();
        let level = Level { names, rest: function.body.clone() };
        self.frames.push(Frame { levels: vec![level, Level::default()], return_to, breaks: Vec::new() });
        for statement in &function.body {
            if self.current.is_none() {
                break;
            }
            self.statement(statement)?;
            let is_distance = matches!(
                statement,
                Statement::Declare { value: Some(Expression { what: What::Call(called, _), .. }), .. } if called == "advance"
            );
            if is_distance {
                let after = self.block();
                self.end(End::Wait(Event::Taken, after), Some(after));
            }
        }
        self.frames.pop();
        Ok(())
    }

    /// Writes the setpoint to the output, in the order of the struct's members.
    fn give_out(&mut self, setpoint: NodeId) -> Result<(), CoreError> {
        let zero = Operand::Constant(0);
        let Some(Node::Struct(members)) = self.nodes.get(setpoint).cloned() else {
            return Err(CoreError::subset(0, "setpoint that is no struct"));
        };
        let mut words = Vec::new();
        for (name, node) in members {
            match self.nodes.get(node).cloned() {
                Some(Node::Array(parts)) => {
                    words.extend(
                        parts
                            .into_iter()
                            .zip(["x", "y", "z"])
                            .map(|(part, axis)| (format!("{name}_{axis}"), part)),
                    );
                }
                _ => words.push((name, node)),
            }
        }
        if words.len() > usize::from(OUTPUT_WHOLE) {
            return Err(CoreError::TooMany {
                what: "words of a setpoint",
                needed: words.len(),
                most: usize::from(OUTPUT_WHOLE),
            });
        }
        for (place, (name, node)) in (0..).zip(words) {
            let Value::Number(operand, _) = self.load(Target::Node(node)) else { continue };
            let bits = match name.as_str() {
                "phase" => 64,
                "piece" => 32,
                "evaluations" => 8,
                _ => self.program.numbers.bits,
            };
            self.program.outputs.push((name, bits));
            self.emit(Op::Output(place), 0, [operand, zero, zero]);
        }
        self.emit(Op::Output(OUTPUT_WHOLE), 0, [Operand::Constant(1), zero, zero]);
        Ok(())
    }
}
