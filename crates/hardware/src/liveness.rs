//! Which registers are read later than the begin of each block. A routine's end leads to all places that it is called from.

use std::collections::{HashMap, HashSet};

use crate::program::{BlockId, End, Op, Operand, Operation, Program, Register};

/// For each block the registers that it or what follows reads.
pub(crate) struct Liveness {
    begins: Vec<HashSet<Register>>,
    ends: Vec<HashSet<Register>>,
    routines: HashMap<BlockId, Routine>,
}

/// The register that an operand reads.
pub(crate) fn read_by(operand: Operand) -> Option<Register> {
    match operand {
        Operand::Register(register) | Operand::Column(register, _) => Some(register),
        Operand::Constant(_) | Operand::Parameter(_) => None,
    }
}

/// The register that an operation writes; an output writes none.
pub(crate) fn written_by(operation: &Operation) -> Option<Register> {
    (!matches!(operation.op, Op::Output(_))).then_some(operation.to)
}

/// A routine: its blocks, where it is called from, and the registers that it writes.
struct Routine {
    blocks: HashSet<BlockId>,
    back: Vec<BlockId>,
    writes: HashSet<Register>,
}

impl Liveness {
    pub(crate) fn of(program: &Program) -> Self {
        let routines = routines(program);
        let count = program.blocks.len();
        let mut this =
            Self { begins: vec![HashSet::new(); count], ends: vec![HashSet::new(); count], routines };
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for (id, block) in program.blocks.iter().enumerate().rev() {
                let at_end = this.behind(id, block.end);
                let mut live = at_end.clone();
                if let End::Branch { a, b, .. } = block.end {
                    live.extend([a, b].into_iter().filter_map(read_by));
                }
                for operation in block.operations.iter().rev() {
                    if let Some(written) = written_by(operation) {
                        live.remove(&written);
                    }
                    live.extend(operation.operands.into_iter().filter_map(read_by));
                }
                if let (Some(begin), Some(end)) = (this.begins.get_mut(id), this.ends.get_mut(id)) {
                    has_changed |= begin.len() != live.len() || end.len() != at_end.len();
                    (*begin, *end) = (live, at_end);
                }
            }
        }
        this
    }

    /// Registers that are read behind an end. What a routine does not write passes it by; of what it writes its own begin says
    /// what must be there.
    fn behind(&self, id: BlockId, end: End) -> HashSet<Register> {
        let begins = |block: BlockId| self.begins.get(block).into_iter().flatten().copied();
        match end {
            End::Call { entry, then } => {
                let writes = self.writes_of(entry);
                let passes = begins(then).filter(|register| !writes.contains(register));
                begins(entry).chain(passes).collect()
            }
            End::Return => {
                let own = self.routines.values().filter(|routine| routine.blocks.contains(&id));
                own.flat_map(|routine| {
                    let read = routine.back.iter().flat_map(|then| begins(*then));
                    read.filter(|register| routine.writes.contains(register)).collect::<Vec<_>>()
                })
                .collect()
            }
            _ => end.targets().flat_map(begins).collect(),
        }
    }

    /// Registers that are read from the begin of a block on.
    pub(crate) fn at_begin(&self, block: BlockId) -> &HashSet<Register> {
        &self.begins[block]
    }

    /// Registers that a routine and those that it calls write, by its entry.
    pub(crate) fn writes_of(&self, entry: BlockId) -> &HashSet<Register> {
        &self.routines[&entry].writes
    }

    /// Registers that are read behind the end of a block.
    pub(crate) fn at_end(&self, block: BlockId) -> &HashSet<Register> {
        &self.ends[block]
    }
}

/// All routines by their entries.
fn routines(program: &Program) -> HashMap<BlockId, Routine> {
    let mut found: HashMap<BlockId, Routine> = HashMap::new();
    for block in &program.blocks {
        if let End::Call { entry, then } = block.end {
            let routine = found.entry(entry).or_insert_with(|| Routine {
                blocks: blocks_from(program, entry),
                back: Vec::new(),
                writes: HashSet::new(),
            });
            routine.back.push(then);
        }
    }
    let mut has_changed = true;
    while has_changed {
        has_changed = false;
        for entry in found.keys().copied().collect::<Vec<_>>() {
            let mut writes = HashSet::new();
            for block in found[&entry].blocks.iter().filter_map(|block| program.blocks.get(*block)) {
                writes.extend(block.operations.iter().filter_map(written_by));
                if let End::Call { entry, .. } = block.end {
                    writes.extend(found.get(&entry).into_iter().flat_map(|inner| &inner.writes));
                }
            }
            if let Some(routine) = found.get_mut(&entry) {
                has_changed |= routine.writes.len() != writes.len();
                routine.writes = writes;
            }
        }
    }
    found
}

/// The blocks of a routine, without those of the routines that it calls.
fn blocks_from(program: &Program, entry: BlockId) -> HashSet<BlockId> {
    let (mut open, mut seen) = (vec![entry], HashSet::new());
    while let Some(at) = open.pop() {
        if seen.insert(at) {
            open.extend(program.blocks.get(at).into_iter().flat_map(|block| block.end.targets()));
        }
    }
    seen
}
