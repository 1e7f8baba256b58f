//! Which registers are read later than the begin of each block. A routine's end leads to all places that it is called from.

use std::collections::{HashMap, HashSet};

use crate::program::{BlockId, End, Operand, Program, Register};

/// For each block the registers that it or what follows reads.
pub(crate) struct Liveness {
    begins: Vec<HashSet<Register>>,
    ends: Vec<HashSet<Register>>,
}

/// The register that an operand reads.
pub(crate) fn read_by(operand: Operand) -> Option<Register> {
    match operand {
        Operand::Register(register) | Operand::Column(register, _) => Some(register),
        Operand::Constant(_) | Operand::Parameter(_) => None,
    }
}

impl Liveness {
    pub(crate) fn of(program: &Program) -> Self {
        let successors = successors(program);
        let count = program.blocks.len();
        let mut this = Self { begins: vec![HashSet::new(); count], ends: vec![HashSet::new(); count] };
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for (id, block) in program.blocks.iter().enumerate().rev() {
                let mut live = HashSet::new();
                for next in successors.get(id).into_iter().flatten() {
                    live.extend(this.begins.get(*next).into_iter().flatten().copied());
                }
                let at_end = live.clone();
                if let End::Branch { a, b, .. } = block.end {
                    live.extend([a, b].into_iter().filter_map(read_by));
                }
                for operation in block.operations.iter().rev() {
                    live.remove(&operation.to);
                    live.extend(operation.operands.into_iter().filter_map(read_by));
                }
                if let (Some(begin), Some(end)) = (this.begins.get_mut(id), this.ends.get_mut(id)) {
                    has_changed |= begin.len() != live.len();
                    (*begin, *end) = (live, at_end);
                }
            }
        }
        this
    }

    /// Registers that are read from the begin of a block on.
    pub(crate) fn at_begin(&self, block: BlockId) -> &HashSet<Register> {
        &self.begins[block]
    }

    /// Registers that are read behind the end of a block.
    pub(crate) fn at_end(&self, block: BlockId) -> &HashSet<Register> {
        &self.ends[block]
    }
}

/// Where each block's end may lead, calls and returns included.
fn successors(program: &Program) -> Vec<Vec<BlockId>> {
    let mut found: Vec<Vec<BlockId>> =
        program.blocks.iter().map(|block| block.end.targets().collect()).collect();
    let mut back: HashMap<BlockId, Vec<BlockId>> = HashMap::new();
    for (block, to) in program.blocks.iter().zip(&mut found) {
        if let End::Call { entry, then } = block.end {
            to.push(entry);
            back.entry(entry).or_default().push(then);
        }
    }
    for (entry, places) in back {
        let (mut open, mut seen) = (vec![entry], HashSet::new());
        while let Some(at) = open.pop() {
            if !seen.insert(at) {
                continue;
            }
            let Some(block) = program.blocks.get(at) else { continue };
            open.extend(block.end.targets());
            if block.end == End::Return {
                found.get_mut(at).into_iter().for_each(|to| to.extend(&places));
            }
        }
    }
    found
}
