//! Calls: a function is read in its place, or becomes a routine for the pointers that it is called with.

use std::collections::{HashMap, HashSet};

use crate::error::CoreError;
use crate::front::{Frame, Front, Level, Meaning, Node, ReturnTo, Routine, Target, Value};
use crate::program::{BlockId, End, Op, Operand, Register};
use crate::syntax::{Expression, Function, Kind, Statement, Type, What};

/// A function of at most so many calls, operators and branches is read in its place. Larger ones would copy rare work many times.
const SMALL: usize = 4;
/// Calls in calls, at most: C of this kind has no recursion.
const DEEPEST: usize = 64;

impl Front<'_> {
    /// What a call gives. If only its truth is asked, a function that is read in its place goes to one of two blocks by itself.
    pub(crate) fn call(
        &mut self,
        name: &str,
        arguments: &[Expression],
        line: u32,
        truth: Option<(BlockId, BlockId)>,
    ) -> Result<Value, CoreError> {
        if let Some(value) = self.intrinsic(name, arguments, line)? {
            return Ok(value);
        }
        let Some(function) = self.unit.functions.get(name) else {
            return Err(CoreError::subset(line, format!("function {name}")));
        };
        if self.frames.len() > DEEPEST {
            return Err(CoreError::subset(line, format!("recursion, as of {name}")));
        }
        let values = arguments.iter().map(|argument| self.value(argument)).collect::<Result<Vec<_>, _>>()?;
        if values.len() != function.parameters.len() {
            return Err(CoreError::subset(line, format!("call of {name} with so many arguments")));
        }
        if self.is_in_place(name, function, &values) {
            self.in_place(function, values, truth)
        } else {
            self.routine_call(name, function, values, line)
        }
    }

    fn is_in_place(&self, name: &str, function: &Function, values: &[Value]) -> bool {
        let is_small = weight(function) <= SMALL;
        let called = self.calls.get(name).copied().unwrap_or(0);
        let takes_table = values.iter().zip(&function.parameters).any(|(value, (of, _))| match value {
            Value::Place(Target::Node(_)) => false,
            Value::Place(Target::Row { .. }) => !matches!(of, Type::Pointer(to) if self.is_row(to)),
            Value::Place(_) => true,
            _ => false,
        });
        function.is_inline || is_small || called <= 1 || takes_table || self.binds_pointers(function)
    }

    /// Whether a function binds a pointer that is a member of a struct: that holds beyond the call, and is known in the text alone.
    fn binds_pointers(&self, function: &Function) -> bool {
        let members = self.unit.structs.values().flatten().filter(|(of, _)| match of {
            Type::Pointer(to) => !self.is_row(to),
            _ => false,
        });
        let names: HashSet<&String> = members.map(|(_, name)| name).collect();
        let mut found = false;
        for statement in &function.body {
            statement.each(&mut |expression| {
                if let What::Assign(_, to, _) = &expression.what
                    && let What::Member(_, name) = &to.what
                {
                    found |= names.contains(name);
                }
            });
        }
        found
    }

    fn in_place(
        &mut self,
        function: &Function,
        values: Vec<Value>,
        truth: Option<(BlockId, BlockId)>,
    ) -> Result<Value, CoreError> {
        let mut names = HashMap::new();
        for (value, (_, name)) in values.into_iter().zip(&function.parameters) {
            let meaning = match value {
                Value::Number(Operand::Constant(value), kind) => Meaning::Constant(value, kind),
                Value::Number(operand, kind) => {
                    let register = self.copied(operand);
                    Meaning::Node(self.node(Node::Number(register, kind)))
                }
                Value::Place(target) => Meaning::Bound(target),
                Value::Nothing => return Err(CoreError::subset(function.line, "argument without a value")),
            };
            names.insert(name.clone(), meaning);
        }
        let join = self.block();
        let result = match function.result {
            Type::Number(kind) => Some((self.register(), kind)),
            _ => None,
        };
        let return_to = match (truth, result) {
            (Some((then, other)), Some(_)) => ReturnTo::Condition { then, other },
            _ => ReturnTo::Join { result, block: join },
        };
        self.read(function, names, return_to)?;
        self.end(End::Jump(join), None);
        if let ReturnTo::Condition { .. } = return_to {
            return Ok(Value::Nothing);
        }
        self.current = Some(join);
        Ok(result.map_or(Value::Nothing, |(register, kind)| Value::Number(Operand::Register(register), kind)))
    }

    /// Reads a function's body with these names.
    fn read(
        &mut self,
        function: &Function,
        names: HashMap<String, Meaning>,
        return_to: ReturnTo,
    ) -> Result<(), CoreError> {
        let level = Level { names, rest: Vec::new() };
        self.frames.push(Frame { levels: vec![level], return_to, breaks: Vec::new() });
        self.block_of(&function.body, function.line)?;
        self.frames.pop();
        Ok(())
    }

    /// The operand in a register of its own.
    pub(crate) fn copied(&mut self, operand: Operand) -> Register {
        let to = self.register();
        self.emit(Op::Move, to, [operand, Operand::Constant(0), Operand::Constant(0)]);
        to
    }

    fn routine_call(
        &mut self,
        name: &str,
        function: &Function,
        values: Vec<Value>,
        line: u32,
    ) -> Result<Value, CoreError> {
        let routine = self.routine(name, function, &values)?;
        let mut back = Vec::new();
        for (value, parameter) in values.iter().zip(&routine.parameters) {
            let Some(parameter) = *parameter else { continue };
            let operand = match value {
                Value::Number(operand, _) => *operand,
                Value::Place(Target::Row { row, .. }) => Operand::Register(*row),
                Value::Place(Target::Node(node)) => match self.nodes.get(*node) {
                    Some(Node::Number(register, _)) => {
                        back.push((*register, parameter));
                        Operand::Register(*register)
                    }
                    _ => return Err(CoreError::subset(line, "argument of this kind")),
                },
                _ => return Err(CoreError::subset(line, "argument of this kind")),
            };
            self.emit(Op::Move, parameter, [operand, Operand::Constant(0), Operand::Constant(0)]);
        }
        let then = self.block();
        self.end(End::Call { entry: routine.entry, then }, Some(then));
        for (register, parameter) in back {
            let from = Operand::Register(parameter);
            self.emit(Op::Move, register, [from, Operand::Constant(0), Operand::Constant(0)]);
        }
        let Some(result) = routine.result else { return Ok(Value::Nothing) };
        let kind = if let Type::Number(kind) = function.result { kind } else { Kind::Short };
        // A second call would write over it.
        let register = self.copied(Operand::Register(result));
        Ok(Value::Number(Operand::Register(register), kind))
    }

    /// The routine of a function for these pointers, read now if there is none whose memory is free.
    fn routine(&mut self, name: &str, function: &Function, values: &[Value]) -> Result<Routine, CoreError> {
        let key = (name.to_owned(), self.bound(values, function));
        let in_use = self.in_use();
        let known =
            self.routines.iter().find(|routine| routine.key == key && routine.memory.is_disjoint(&in_use));
        if let Some(routine) = known.cloned() {
            self.taken.iter_mut().for_each(|taken| taken.extend(&routine.memory));
            return Ok(routine);
        }
        let (mut names, mut parameters) = (HashMap::new(), Vec::new());
        for (value, (of, name)) in values.iter().zip(&function.parameters) {
            let meaning = match (value, of) {
                (Value::Place(Target::Row { .. }), Type::Pointer(to)) => {
                    let Type::Struct(row) = &**to else { continue };
                    let register = self.register();
                    parameters.push(Some(register));
                    Meaning::Node(self.node(Node::Row(register, row.clone())))
                }
                (Value::Place(Target::Node(node)), _) => match self.nodes.get(*node).cloned() {
                    Some(Node::Number(_, kind)) => {
                        let register = self.register();
                        parameters.push(Some(register));
                        Meaning::Bound(Target::Node(self.node(Node::Number(register, kind))))
                    }
                    _ => {
                        parameters.push(None);
                        Meaning::Bound(Target::Node(*node))
                    }
                },
                (Value::Number(_, kind), _) => {
                    let register = self.register();
                    parameters.push(Some(register));
                    Meaning::Node(self.node(Node::Number(register, *kind)))
                }
                _ => return Err(CoreError::subset(function.line, "argument of this kind")),
            };
            names.insert(name.clone(), meaning);
        }
        let result = matches!(function.result, Type::Number(_)).then(|| self.register());
        let (entry, before) = (self.block(), self.current);
        self.current = Some(entry);
        self.taken.push(HashSet::new());
        self.read(function, names, ReturnTo::Routine { result })?;
        self.end(End::Return, before);
        let memory = self.taken.pop().unwrap_or_default();
        let routine = Routine { key, entry, memory, parameters, result };
        self.routines.push(routine.clone());
        Ok(routine)
    }

    /// What the arguments point at, and what is bound in it.
    fn bound(&self, values: &[Value], function: &Function) -> Vec<Target> {
        let mut found = Vec::new();
        for (value, _) in values.iter().zip(&function.parameters) {
            let Value::Place(Target::Node(node)) = value else { continue };
            if matches!(self.nodes.get(*node), Some(Node::Number(..))) {
                continue;
            }
            found.push(Target::Node(*node));
            let mut reached = HashSet::new();
            self.reach(*node, &mut reached);
            let mut inner: Vec<_> = reached.into_iter().collect();
            inner.sort_unstable();
            found.extend(inner.into_iter().filter_map(|node| match self.nodes.get(node) {
                Some(Node::Bound(Some(target))) => Some(target.clone()),
                _ => None,
            }));
        }
        found
    }
}

/// Calls, operators and branches of a function; a loop counts as many.
fn weight(function: &Function) -> usize {
    fn of(statement: &Statement) -> usize {
        let mut count = 0;
        match statement {
            Statement::If(_, then, other) => count += 1 + of(then) + other.as_deref().map_or(0, of),
            Statement::Loop(..) => count += 100,
            Statement::Block(inner) => count += inner.iter().map(of).sum::<usize>(),
            _ => {}
        }
        count
    }
    let mut count: usize = function.body.iter().map(of).sum();
    for statement in &function.body {
        statement.each(&mut |expression| {
            count +=
                usize::from(matches!(expression.what, What::Call(..) | What::Binary(..) | What::Choice(..)));
        });
    }
    count
}
