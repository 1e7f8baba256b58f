//! A way as a graph of values: each operation once, with what later ones and the ways out need.

use std::collections::{HashMap, HashSet};

use crate::liveness::Liveness;
use crate::paths::Way;
use crate::program::{BlockId, Compare, End, Op, Operand, Program, Register};
use crate::tables::Tables;

/// The place of a value in its graph.
pub(crate) type Value = u32;

/// A value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Item {
    /// What a register holds at the begin of the way.
    Begin(Register),
    Constant(i64),
    Parameter(u16),
    /// A column of the row that a value points at.
    Column(Value, u16),
    Operation(Op, [Value; 3]),
}

/// What registers hold where a way is left, if it is not what they held at its begin.
pub(crate) type Holds = Vec<(Register, Value)>;

/// What is done in order.
#[derive(Clone, Debug)]
pub(crate) enum Deed {
    /// Leaves the way if the comparison gives `on`.
    Exit {
        compare: Compare,
        on: bool,
        a: Value,
        b: Value,
        to: BlockId,
        holds: Holds,
        live: HashSet<Register>,
    },
    Output {
        place: u8,
        value: Value,
    },
}

/// A way as a graph.
pub(crate) struct Graph {
    pub(crate) head: BlockId,
    pub(crate) items: Vec<Item>,
    /// For each value how many deeds came before it.
    pub(crate) after: Vec<usize>,
    pub(crate) deeds: Vec<Deed>,
    pub(crate) end: End,
    pub(crate) holds: Holds,
    pub(crate) live: HashSet<Register>,
    known: HashMap<Item, Value>,
}

/// The graph of a way.
pub(crate) fn graph(program: &mut Program, way: &Way, liveness: &Liveness) -> Graph {
    let head = way.blocks[0];
    let mut graph = Graph {
        head,
        items: Vec::new(),
        after: Vec::new(),
        deeds: Vec::new(),
        end: End::Return,
        holds: Vec::new(),
        live: HashSet::new(),
        known: HashMap::new(),
    };
    let mut holds: HashMap<Register, Value> = HashMap::new();
    for (index, id) in way.blocks.iter().enumerate() {
        let block = program.blocks[*id].clone();
        for operation in &block.operations {
            let operands = operation.operands.map(|operand| graph.read(operand, &holds));
            match operation.op {
                Op::Output(place) => graph.deeds.push(Deed::Output { place, value: operands[0] }),
                op => {
                    let value = graph.operation(op, operands, program);
                    holds.insert(operation.to, value);
                }
            }
        }
        let next = way.blocks.get(index + 1).copied();
        match (block.end, next) {
            (End::Branch { compare, a, b, then, other }, next) => {
                let [a, b] = [a, b].map(|operand| graph.read(operand, &holds));
                let stays = next.unwrap_or(other);
                let (on, to) = if stays == then { (false, other) } else { (true, then) };
                if let (Item::Constant(x), Item::Constant(y)) =
                    (graph.items[a as usize], graph.items[b as usize])
                {
                    if compare.holds(x, y) == on {
                        graph.finish(End::Jump(to), liveness.at_begin(to), &holds);
                        return graph;
                    }
                } else {
                    let (kept, live) = graph.kept(liveness.at_begin(to), &holds);
                    graph.deeds.push(Deed::Exit { compare, on, a, b, to, holds: kept, live });
                }
                if next.is_none() {
                    graph.finish(End::Jump(stays), liveness.at_begin(stays), &holds);
                }
            }
            (_, Some(_)) => {}
            (end @ (End::Jump(to) | End::Wait(_, to)), None) => {
                graph.finish(end, liveness.at_begin(to), &holds)
            }
            (end, None) => graph.finish(end, liveness.at_end(*id), &holds),
        }
    }
    graph
}

impl Graph {
    /// What of the registers that are read later differs from the begin.
    fn kept(
        &mut self,
        live: &HashSet<Register>,
        holds: &HashMap<Register, Value>,
    ) -> (Holds, HashSet<Register>) {
        let mut found: Holds =
            holds.iter().filter(|(register, _)| live.contains(register)).map(|(r, v)| (*r, *v)).collect();
        found.retain(|(register, value)| self.items[*value as usize] != Item::Begin(*register));
        found.sort_unstable();
        (found, live.clone())
    }

    fn finish(&mut self, end: End, live: &HashSet<Register>, holds: &HashMap<Register, Value>) {
        self.end = end;
        (self.holds, self.live) = self.kept(live, holds);
    }

    fn read(&mut self, operand: Operand, holds: &HashMap<Register, Value>) -> Value {
        let mut register = |register: Register| {
            holds.get(&register).copied().unwrap_or_else(|| self.item(Item::Begin(register)))
        };
        match operand {
            Operand::Register(of) => register(of),
            Operand::Column(row, column) => {
                let row = register(row);
                self.item(Item::Column(row, column))
            }
            Operand::Constant(value) => self.item(Item::Constant(value)),
            Operand::Parameter(number) => self.item(Item::Parameter(number)),
        }
    }

    /// The value of an item, which is new or known.
    pub(crate) fn item(&mut self, item: Item) -> Value {
        if let Some(value) = self.known.get(&item) {
            return *value;
        }
        let value = Value::try_from(self.items.len()).unwrap_or(Value::MAX);
        self.items.push(item);
        self.after.push(self.deeds.len());
        if item != Item::Operation(Op::Input, [0; 3]) {
            self.known.insert(item, value);
        }
        value
    }

    fn constant(&self, value: Value) -> Option<i64> {
        match self.items.get(value as usize) {
            Some(Item::Constant(constant)) => Some(*constant),
            _ => None,
        }
    }

    fn as_operation(&self, value: Value) -> Option<(Op, [Value; 3])> {
        match self.items.get(value as usize) {
            Some(Item::Operation(op, operands)) => Some((*op, *operands)),
            _ => None,
        }
    }

    /// The value of an operation, in its simplest form.
    fn operation(&mut self, op: Op, operands: [Value; 3], program: &mut Program) -> Value {
        let [a, b, c] = operands;
        if op == Op::Move {
            return a;
        }
        let constants = operands.map(|operand| self.constant(operand));
        if let [Some(x), Some(y), Some(z)] = constants
            && op.is_pure()
            && op != Op::Row
        {
            let value = program.numbers.value(op, [x, y, z]);
            return self.item(Item::Constant(value));
        }
        if let Some(column) = self.made(op, operands, &mut program.tables) {
            return column;
        }
        match (op, constants) {
            (Op::Add | Op::AddNumbers | Op::Or, [Some(0), ..]) => return b,
            (
                Op::Add
                | Op::Sub
                | Op::AddNumbers
                | Op::SubNumbers
                | Op::Or
                | Op::ShiftLeft
                | Op::ShiftRight
                | Op::Scale,
                [_, Some(0), _],
            ) => return a,
            (Op::Sum | Op::Limbs(..), [Some(0), ..] | [_, Some(0), _]) => return c,
            _ => {}
        }
        let zero = self.item(Item::Constant(0));
        match op {
            // A sum takes the product before it into one operation.
            Op::AddNumbers | Op::Add => {
                let fused = if op == Op::Add { Op::Sum } else { Op::Product };
                for (product, other) in [(b, a), (a, b)] {
                    if let Some((of, [x, y, z])) = self.as_operation(product)
                        && of == fused
                        && z == zero
                    {
                        return self.operation(fused, [x, y, other], program);
                    }
                }
            }
            Op::RoundedSum => {
                if let (Some((Op::Sum, [x, y, z])), true) = (self.as_operation(c), a == zero || b == zero) {
                    return self.operation(Op::RoundedSum, [x, y, z], program);
                }
            }
            Op::SubNumbers => {
                if let (Some((Op::RoundedSum, [x, y, z])), Some(k)) = (self.as_operation(a), self.constant(b))
                {
                    let less = k.wrapping_neg().wrapping_shl(program.numbers.fraction_bits);
                    if let Some(z) = self.with_added(z, less) {
                        return self.operation(Op::RoundedSum, [x, y, z], program);
                    }
                }
            }
            _ => {}
        }
        let mut operands = operands;
        if op.commutes() && operands[0] > operands[1] {
            operands.swap(0, 1);
        }
        for unused in operands.iter_mut().skip(op.operands()) {
            *unused = zero;
        }
        self.item(Item::Operation(op, operands))
    }

    /// A wide sum that begins at another constant, if it begins at one.
    fn with_added(&mut self, sum: Value, more: i64) -> Option<Value> {
        if let Some(constant) = self.constant(sum) {
            return Some(self.item(Item::Constant(constant.wrapping_add(more))));
        }
        let (Op::Sum, [x, y, z]) = self.as_operation(sum)? else { return None };
        let z = self.with_added(z, more)?;
        Some(self.item(Item::Operation(Op::Sum, [x, y, z])))
    }

    /// The column that an operation on columns of one row makes.
    fn made(&mut self, op: Op, operands: [Value; 3], tables: &mut Tables) -> Option<Value> {
        if !op.is_pure() || op == Op::Row {
            return None;
        }
        let mut taken = [Operand::Constant(0); 3];
        for (taken, operand) in taken.iter_mut().zip(operands).take(op.operands()) {
            *taken = match self.items.get(operand as usize)? {
                Item::Constant(value) => Operand::Constant(*value),
                Item::Parameter(number) => Operand::Parameter(*number),
                Item::Column(row, column) => Operand::Column(*row, *column),
                _ => return None,
            };
        }
        let Operand::Column(row, column) = tables.made(op, &taken)? else { return None };
        Some(self.item(Item::Column(row, column)))
    }
}
