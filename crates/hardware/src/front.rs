//! The front end's state: what names stand for, and the blocks so far.
//!
//! Structs and arrays are taken apart into registers. A pointer to one is bound when the text is read, so that no register holds it;
//! only a pointer to a row of a table is a value.

use std::collections::{HashMap, HashSet};

use crate::error::CoreError;
use crate::parser::Unit;
use crate::program::{Block, BlockId, End, Numbers, Op, Operand, Operation, Program, Register};
use crate::syntax::{Expression, Kind, Statement, Type, What};
use crate::tables::{Column, Tables};

/// The place of a node in the front end's memory.
pub(crate) type NodeId = usize;

/// A piece of memory.
#[derive(Clone, Debug)]
pub(crate) enum Node {
    Number(Register, Kind),
    Struct(Vec<(String, NodeId)>),
    Array(Vec<NodeId>),
    /// A pointer that is bound in the text: by the last assignment before the present place.
    Bound(Option<Target>),
    /// A pointer to a row of the tables of this struct.
    Row(Register, String),
}

/// Something that has a place.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Target {
    Node(NodeId),
    /// In the row at which a register points: from this column on.
    Row {
        row: Register,
        group: usize,
        place: usize,
        of: Type,
    },
    /// A table of rows.
    Table(String),
    /// A short list of constants.
    List(String),
}

/// What an expression gives.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Number(Operand, Kind),
    /// A struct, an array, or what a pointer points at.
    Place(Target),
    Nothing,
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub(crate) enum Meaning {
    Node(NodeId),
    Constant(i64, Kind),
    /// A pointer parameter, bound to what it points at.
    Bound(Target),
}

/// Where a `return` leads.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ReturnTo {
    Join {
        result: Option<(Register, Kind)>,
        block: BlockId,
    },
    /// The value of a function of which only the truth is asked.
    Condition {
        then: BlockId,
        other: BlockId,
    },
    Routine {
        result: Option<Register>,
    },
}

/// Statements of a block that are still to be read, which says which memory is still in use.
#[derive(Clone, Debug, Default)]
pub(crate) struct Level {
    pub(crate) names: HashMap<String, Meaning>,
    pub(crate) rest: Vec<Statement>,
}

/// A function that is being read.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) levels: Vec<Level>,
    pub(crate) return_to: ReturnTo,
    pub(crate) breaks: Vec<BlockId>,
}

/// A function as a routine, for certain bound pointers.
#[derive(Clone, Debug)]
pub(crate) struct Routine {
    pub(crate) key: (String, Vec<Target>),
    pub(crate) entry: BlockId,
    /// The memory of its own variables.
    pub(crate) memory: HashSet<NodeId>,
    /// For each parameter the register that it comes in; none for a bound pointer.
    pub(crate) parameters: Vec<Option<Register>>,
    pub(crate) result: Option<Register>,
}

/// The front end.
pub(crate) struct Front<'a> {
    pub(crate) unit: &'a Unit,
    pub(crate) program: Program,
    pub(crate) nodes: Vec<Node>,
    pub(crate) frames: Vec<Frame>,
    /// Where operations go; none behind a `return`.
    pub(crate) current: Option<BlockId>,
    pub(crate) routines: Vec<Routine>,
    /// Memory of structs and arrays, shared by those that are not in use together.
    pub(crate) pool: HashMap<Type, Vec<NodeId>>,
    /// What was taken from the pool since each routine under way began.
    pub(crate) taken: Vec<HashSet<NodeId>>,
    pub(crate) calls: HashMap<String, usize>,
}

impl<'a> Front<'a> {
    pub(crate) fn new(unit: &'a Unit, numbers: Numbers) -> Result<Self, CoreError> {
        let mut tables = Tables::of(unit, numbers)?;
        let mut parameters: Vec<_> =
            (0..Tables::groups()).map(|group| (format!("begin of group {group}"), 0)).collect();
        parameters.extend((0..Tables::groups()).map(|group| (format!("row of group {group}"), 1)));
        let mut names: Vec<_> = unit.parameters.iter().map(|(name, value)| (name.clone(), *value)).collect();
        names.sort();
        parameters.extend(names);
        tables.parameters = parameters.iter().map(|(_, value)| *value).collect();
        let program = Program {
            numbers,
            blocks: Vec::new(),
            entry: 0,
            registers: 0,
            tables,
            parameters,
            outputs: Vec::new(),
        };
        Ok(Self {
            unit,
            program,
            nodes: Vec::new(),
            frames: Vec::new(),
            current: None,
            routines: Vec::new(),
            pool: HashMap::new(),
            taken: vec![HashSet::new()],
            calls: HashMap::new(),
        })
    }

    pub(crate) fn register(&mut self) -> Register {
        self.program.registers += 1;
        self.program.registers - 1
    }

    pub(crate) fn node(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    /// A block that is reached only by what names it.
    pub(crate) fn block(&mut self) -> BlockId {
        self.program.blocks.push(Block { operations: Vec::new(), end: End::Return });
        self.program.blocks.len() - 1
    }

    /// Ends the present block, and goes on in another one.
    pub(crate) fn end(&mut self, end: End, next: Option<BlockId>) {
        if let Some(block) = self.current.and_then(|current| self.program.blocks.get_mut(current)) {
            block.end = end;
        }
        self.current = next;
    }

    /// Adds an operation into a register.
    pub(crate) fn emit(&mut self, op: Op, to: Register, operands: [Operand; 3]) {
        if let Some(block) = self.current.and_then(|current| self.program.blocks.get_mut(current)) {
            block.operations.push(Operation { op, to, operands });
        }
    }

    /// What an operation gives, at once if its operands are constants.
    pub(crate) fn op(&mut self, op: Op, operands: &[Operand]) -> Operand {
        let mut padded = [Operand::Constant(0); 3];
        for (to, operand) in padded.iter_mut().zip(operands) {
            *to = *operand;
        }
        if let [Operand::Constant(a), Operand::Constant(b), Operand::Constant(c)] = padded
            && op.is_pure()
            && op != Op::Row
        {
            return Operand::Constant(self.program.numbers.value(op, [a, b, c]));
        }
        let to = self.register();
        self.emit(op, to, padded);
        Operand::Register(to)
    }

    /// The present function.
    pub(crate) fn frame(&mut self, line: u32) -> Result<&mut Frame, CoreError> {
        self.frames.last_mut().ok_or_else(|| CoreError::subset(line, "statement outside a function"))
    }

    /// Gives a name its meaning in the present block.
    pub(crate) fn name(&mut self, name: &str, meaning: Meaning) {
        if let Some(level) = self.frames.last_mut().and_then(|frame| frame.levels.last_mut()) {
            level.names.insert(name.to_owned(), meaning);
        }
    }

    pub(crate) fn meaning(&self, name: &str) -> Option<&Meaning> {
        self.frames.last()?.levels.iter().rev().find_map(|level| level.names.get(name))
    }

    /// Whether rows of this struct are those of a table.
    pub(crate) fn is_row(&self, of: &Type) -> bool {
        matches!(of, Type::Struct(name) if self.program.tables.place_of_rows(name).is_some())
    }

    /// Memory for a variable: numbers in registers of their own, structs and arrays where nothing in use lies.
    pub(crate) fn memory(&mut self, of: &Type, line: u32) -> Result<NodeId, CoreError> {
        if !matches!(of, Type::Struct(_) | Type::Array(..)) {
            return self.new_memory(of, line);
        }
        let in_use = self.in_use();
        let free =
            self.pool.get(of).and_then(|nodes| nodes.iter().find(|node| !in_use.contains(node))).copied();
        let node = match free {
            Some(node) => node,
            None => {
                let node = self.new_memory(of, line)?;
                self.pool.entry(of.clone()).or_default().push(node);
                node
            }
        };
        self.taken.iter_mut().for_each(|taken| {
            taken.insert(node);
        });
        Ok(node)
    }

    fn new_memory(&mut self, of: &Type, line: u32) -> Result<NodeId, CoreError> {
        let node = match of {
            Type::Number(kind) => Node::Number(self.register(), *kind),
            Type::Struct(name) => {
                let Some(members) = self.unit.structs.get(name) else {
                    return Err(CoreError::subset(line, format!("struct {name}")));
                };
                let members = members.iter().map(|(of, name)| Ok((name.clone(), self.new_memory(of, line)?)));
                Node::Struct(members.collect::<Result<_, _>>()?)
            }
            Type::Array(inner, Some(count)) => {
                let parts = (0..*count).map(|_| self.new_memory(inner, line));
                Node::Array(parts.collect::<Result<_, _>>()?)
            }
            Type::Pointer(to) => match &**to {
                Type::Struct(name) if self.is_row(to) => Node::Row(self.register(), name.clone()),
                _ => Node::Bound(None),
            },
            _ => return Err(CoreError::subset(line, "variable of this type")),
        };
        Ok(self.node(node))
    }

    /// Memory of the pool that what is still to be read names, or that it reaches by bound pointers.
    pub(crate) fn in_use(&self) -> HashSet<NodeId> {
        let mut found = HashSet::new();
        for frame in &self.frames {
            let mut named = HashSet::new();
            for level in frame.levels.iter().rev() {
                for statement in &level.rest {
                    statement.each(&mut |expression| {
                        if let What::Name(name) = &expression.what {
                            named.insert(name.clone());
                        }
                    });
                }
                for (_, meaning) in level.names.iter().filter(|(name, _)| named.contains(*name)) {
                    if let Meaning::Node(node) | Meaning::Bound(Target::Node(node)) = meaning {
                        self.reach(*node, &mut found);
                    }
                }
            }
        }
        found
    }

    /// Adds a node and all that lies in it or is pointed at from it.
    pub(crate) fn reach(&self, node: NodeId, found: &mut HashSet<NodeId>) {
        if !found.insert(node) {
            return;
        }
        match self.nodes.get(node) {
            Some(Node::Struct(members)) => members.iter().for_each(|(_, member)| self.reach(*member, found)),
            Some(Node::Array(parts)) => parts.iter().for_each(|part| self.reach(*part, found)),
            Some(Node::Bound(Some(Target::Node(to)))) => self.reach(*to, found),
            _ => {}
        }
    }

    /// A member of a struct.
    pub(crate) fn member(&self, of: &Target, name: &str, line: u32) -> Result<Target, CoreError> {
        let unknown = || CoreError::subset(line, format!("member {name} here"));
        match of {
            Target::Node(node) => match self.nodes.get(*node) {
                Some(Node::Struct(members)) => {
                    let found = members.iter().find(|(member, _)| member == name);
                    found.map(|(_, node)| Target::Node(*node)).ok_or_else(unknown)
                }
                _ => Err(unknown()),
            },
            Target::Row { row, group, place, of: Type::Struct(of) } => {
                let mut place = *place;
                for (of, member) in self.unit.structs.get(of).into_iter().flatten() {
                    if member == name {
                        return Ok(Target::Row { row: *row, group: *group, place, of: of.clone() });
                    }
                    place += self.words(of);
                }
                Err(unknown())
            }
            _ => Err(unknown()),
        }
    }

    /// Words of a type in a table.
    fn words(&self, of: &Type) -> usize {
        match of {
            Type::Array(inner, count) => count.unwrap_or(0) * self.words(inner),
            Type::Struct(name) => {
                self.unit.structs.get(name).into_iter().flatten().map(|(of, _)| self.words(of)).sum()
            }
            _ => 1,
        }
    }

    /// An element of an array or a table.
    pub(crate) fn element(&mut self, of: &Target, index: Operand, line: u32) -> Result<Value, CoreError> {
        let constant = |index| match index {
            Operand::Constant(index) => {
                usize::try_from(index).map_err(|_| CoreError::subset(line, "negative index"))
            }
            _ => Err(CoreError::subset(line, "index that is known only at run time, but of a table")),
        };
        match of {
            Target::Table(name) => {
                let Some(place) = self.program.tables.place(name).cloned() else {
                    return Err(CoreError::subset(line, format!("table {name}")));
                };
                let [base, length] = [place.group, place.group + Tables::groups()]
                    .map(|number| Operand::Parameter(u16::try_from(number).unwrap_or(0)));
                let Operand::Register(row) = self.op(Op::Row, &[index, length, base]) else {
                    return Err(CoreError::subset(line, "address that is a constant"));
                };
                Ok(Value::Place(Target::Row { row, group: place.group, place: place.first, of: place.row }))
            }
            Target::Row { row, group, place, of: Type::Array(inner, _) } => {
                let place = place + constant(index)? * self.words(inner);
                Ok(Value::Place(Target::Row { row: *row, group: *group, place, of: (**inner).clone() }))
            }
            Target::Node(node) => match self.nodes.get(*node) {
                Some(Node::Array(parts)) => {
                    let part = parts.get(constant(index)?).copied();
                    part.map(|part| Value::Place(Target::Node(part)))
                        .ok_or_else(|| CoreError::subset(line, "index beyond the end"))
                }
                _ => Err(CoreError::subset(line, "index of what is no array")),
            },
            Target::List(name) => {
                let values = self.unit.constants.get(name).map(|list| &list.values.what);
                let Some(What::List(values)) = values else {
                    return Err(CoreError::subset(line, format!("list {name}")));
                };
                let value = values.get(constant(index)?).and_then(crate::parser::constant);
                let value = value.ok_or_else(|| CoreError::subset(line, "index beyond the end"))?;
                Ok(Value::Number(Operand::Constant(value), Kind::Short))
            }
            // A pointer to a word of a row, as to the second of an array.
            Target::Row { row, group, place, of: of @ Type::Number(_) } => {
                let place = place + constant(index)?;
                Ok(Value::Place(Target::Row { row: *row, group: *group, place, of: of.clone() }))
            }
            Target::Row { .. } => Err(CoreError::subset(line, "index of what is no array")),
        }
    }

    /// What lies in a place.
    pub(crate) fn load(&mut self, of: Target) -> Value {
        match of {
            Target::Node(node) => match self.nodes.get(node) {
                Some(Node::Number(register, kind)) => Value::Number(Operand::Register(*register), *kind),
                Some(Node::Bound(Some(to))) => Value::Place(to.clone()),
                Some(Node::Row(row, name)) => {
                    let place = self.program.tables.place_of_rows(name);
                    let (group, first) = place.map_or((0, 0), |place| (place.group, place.first));
                    Value::Place(Target::Row {
                        row: *row,
                        group,
                        place: first,
                        of: Type::Struct(name.clone()),
                    })
                }
                _ => Value::Place(Target::Node(node)),
            },
            Target::Row { row, group, place, of: Type::Number(kind) } => {
                let column = self.program.tables.column(Column::Given { group, place });
                Value::Number(Operand::Column(row, column), kind)
            }
            other => Value::Place(other),
        }
    }

    /// Writes a value to a place.
    pub(crate) fn store(&mut self, to: &Target, value: Value, line: u32) -> Result<(), CoreError> {
        let Target::Node(node) = to else { return Err(CoreError::subset(line, "assignment to a table")) };
        match (self.nodes.get(*node).cloned(), value) {
            (Some(Node::Number(register, _)), Value::Number(operand, _)) => {
                self.emit(Op::Move, register, [operand, Operand::Constant(0), Operand::Constant(0)]);
                Ok(())
            }
            (Some(Node::Row(register, _)), Value::Place(Target::Row { row, .. })) => {
                let from = Operand::Register(row);
                self.emit(Op::Move, register, [from, Operand::Constant(0), Operand::Constant(0)]);
                Ok(())
            }
            (Some(Node::Bound(_)), Value::Place(target)) => {
                if let Some(bound) = self.nodes.get_mut(*node) {
                    *bound = Node::Bound(Some(target));
                }
                Ok(())
            }
            _ => Err(CoreError::subset(line, "assignment of this kind")),
        }
    }

    /// How often each function is called in the text of these and all that they call.
    pub(crate) fn count_calls(&mut self, roots: &[String]) {
        let mut open: Vec<String> = roots.to_vec();
        let mut seen = HashSet::new();
        while let Some(name) = open.pop() {
            if !seen.insert(name.clone()) {
                continue;
            }
            let Some(function) = self.unit.functions.get(&name) else { continue };
            let mut called = Vec::new();
            for statement in &function.body {
                statement.each(&mut |expression: &Expression| {
                    if let What::Call(name, _) = &expression.what {
                        called.push(name.clone());
                    }
                });
            }
            for name in called {
                *self.calls.entry(name.clone()).or_default() += 1;
                open.push(name);
            }
        }
    }
}
