//! Copy coalescing: two registers that a copy connects become one, if they never hold different values at the same
//! time. The copy then takes no word of microcode, neither within a way nor where a way is left.

use std::cmp::Reverse;
use std::collections::HashSet;

use crate::executor::Run;
use crate::liveness::{Liveness, read_by, written_by};
use crate::program::{BlockId, End, Op, Operand, Program, Register};

/// Joins the registers of each copy where that is allowed, and takes these copies out. The copies that the run made
/// most often come first: a join may forbid a later one.
pub(crate) fn coalesce(program: &mut Program, run: &Run) {
    let mut classes = Classes::of(program);
    for (to, from) in copies(program, run) {
        classes.join(to, from);
    }
    for block in &mut program.blocks {
        for operation in &mut block.operations {
            operation.to = classes.first(operation.to);
            operation.operands = operation.operands.map(|operand| classes.renamed(operand));
        }
        block.operations.retain(|operation| {
            operation.op != Op::Move || operation.operands[0] != Operand::Register(operation.to)
        });
        if let End::Branch { a, b, .. } = &mut block.end {
            (*a, *b) = (classes.renamed(*a), classes.renamed(*b));
        }
    }
}

/// Copies from register to register, the most frequent first.
fn copies(program: &Program, run: &Run) -> Vec<(Register, Register)> {
    let count = |block: BlockId| run.counts.get(block).copied().unwrap_or(0);
    let mut found = Vec::new();
    for (id, block) in program.blocks.iter().enumerate() {
        for operation in &block.operations {
            if let (Op::Move, Operand::Register(from)) = (operation.op, operation.operands[0]) {
                found.push((Reverse(count(id)), operation.to, from));
            }
        }
    }
    found.sort_unstable();
    found.into_iter().map(|(_, to, from)| (to, from)).collect()
}

/// Classes of registers that have become one, and the pairs that must stay apart.
struct Classes {
    /// For each register another one of its class, one link nearer to the register that stands for the class; that one
    /// links to itself.
    nearer: Vec<Register>,
    /// For the register that stands for a class: the registers that it must stay apart from, since one is written while
    /// the value of the other is still needed. The set may hold, besides the register that stands for another class,
    /// members of that class.
    conflicts: Vec<HashSet<Register>>,
}

impl Classes {
    fn of(program: &Program) -> Self {
        let count = program.registers as usize;
        let mut this =
            Self { nearer: (0..program.registers).collect(), conflicts: vec![HashSet::new(); count] };
        let liveness = Liveness::of(program);
        for (id, block) in program.blocks.iter().enumerate() {
            let mut live = liveness.at_end(id).clone();
            if let End::Call { entry, then } = block.end {
                // A register whose value is needed after the routine, and that the routine does not write, must not
                // become one with a register that the routine writes.
                let writes = liveness.writes_of(entry);
                for passing in liveness.at_begin(then).iter().filter(|register| !writes.contains(register)) {
                    writes.iter().for_each(|written| this.forbid(*written, *passing));
                }
            }
            if let End::Branch { a, b, .. } = block.end {
                live.extend([a, b].into_iter().filter_map(read_by));
            }
            for operation in block.operations.iter().rev() {
                if let Some(written) = written_by(operation) {
                    live.remove(&written);
                    // A copy and its source hold the same.
                    let source = (operation.op == Op::Move).then_some(operation.operands[0]);
                    for other in live.iter().filter(|other| source != Some(Operand::Register(**other))) {
                        this.forbid(written, *other);
                    }
                }
                live.extend(operation.operands.into_iter().filter_map(read_by));
            }
        }
        this
    }

    fn forbid(&mut self, a: Register, b: Register) {
        self.conflicts[a as usize].insert(b);
        self.conflicts[b as usize].insert(a);
    }

    /// The register that stands for a class.
    fn first(&self, mut register: Register) -> Register {
        while self.nearer[register as usize] != register {
            register = self.nearer[register as usize];
        }
        register
    }

    /// Makes one class of two, unless they conflict.
    fn join(&mut self, a: Register, b: Register) {
        let (a, b) = (self.first(a), self.first(b));
        if a == b || self.conflicts[a as usize].contains(&b) {
            return;
        }
        self.nearer[b as usize] = a;
        for other in std::mem::take(&mut self.conflicts[b as usize]) {
            self.forbid(a, other);
        }
    }

    fn renamed(&self, operand: Operand) -> Operand {
        match operand {
            Operand::Register(register) => Operand::Register(self.first(register)),
            Operand::Column(row, column) => Operand::Column(self.first(row), column),
            other => other,
        }
    }
}
