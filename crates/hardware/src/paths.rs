//! Straight ways through the blocks. A way goes on into the block that a run took most often, also if others lead there: what is
//! often run then stands in one piece, and its rare ways out leave it for good.

use std::collections::{HashMap, HashSet};

use crate::executor::Run;
use crate::program::{BlockId, End, Program};

/// Operations of a way, at most.
const LONGEST: usize = 500;
/// A block is copied into a way if it is run at least once in so many setpoints.
const OFTEN: u64 = 20;

/// Blocks one after the other.
pub(crate) struct Way {
    pub(crate) blocks: Vec<BlockId>,
}

/// Takes out blocks that do nothing, and those that nothing leads to.
pub(crate) fn tidy(program: &mut Program) {
    let ends: Vec<End> = program.blocks.iter().map(|block| block.end).collect();
    let is_empty: Vec<bool> = program.blocks.iter().map(|block| block.operations.is_empty()).collect();
    let through = |mut to: BlockId| {
        for _ in 0..ends.len() {
            match ends.get(to) {
                Some(End::Jump(next)) if is_empty.get(to) == Some(&true) => to = *next,
                _ => break,
            }
        }
        to
    };
    for block in &mut program.blocks {
        block.end = block.end.with_targets(through);
        if let End::Branch { then, other, .. } = block.end
            && then == other
        {
            block.end = End::Jump(then);
        }
    }
}

/// All ways, the first of them from the entry. Each place to which one leads is the begin of another.
pub(crate) fn ways(program: &Program, run: &Run) -> Vec<Way> {
    let leading = leading(program);
    let often = (run.setpoints.len() as u64 / OFTEN).max(1);
    let mut open = vec![program.entry];
    let (mut seen, mut found) = (HashSet::new(), Vec::new());
    while let Some(head) = open.pop() {
        if !seen.insert(head) {
            continue;
        }
        let way = grown(program, run, head, often, &leading);
        for pair in way.blocks.windows(2) {
            if let [block, next] = pair {
                open.extend(program.blocks[*block].end.targets().filter(|to| to != next));
            }
        }
        if let Some(last) = way.blocks.last() {
            let end = program.blocks[*last].end;
            open.extend(end.targets());
            if let End::Call { entry, .. } = end {
                open.push(entry);
            }
        }
        found.push(way);
    }
    found
}

/// How many ends lead to each block.
fn leading(program: &Program) -> HashMap<BlockId, usize> {
    let (mut open, mut seen, mut counts) = (vec![program.entry], HashSet::new(), HashMap::new());
    while let Some(at) = open.pop() {
        if !seen.insert(at) {
            continue;
        }
        let end = program.blocks[at].end;
        if let End::Call { entry, .. } = end {
            open.push(entry);
        }
        for to in end.targets() {
            *counts.entry(to).or_default() += 1;
            open.push(to);
        }
    }
    counts
}

fn grown(program: &Program, run: &Run, head: BlockId, often: u64, leading: &HashMap<BlockId, usize>) -> Way {
    let (mut blocks, mut length, mut at) = (vec![head], 0, head);
    // The least count on the way so far: what is behind it is not run more often than that from here.
    let mut count = run.counts.get(head).copied().unwrap_or(0);
    loop {
        let block = &program.blocks[at];
        length += block.operations.len();
        let held = run.held.get(at).copied().unwrap_or(0);
        let all = run.counts.get(at).copied().unwrap_or(0);
        let (next, share) = match block.end {
            End::Jump(to) => (to, all),
            End::Branch { then, other, .. } => {
                let is_alone = |to: BlockId| leading.get(&to) == Some(&1);
                let takes_then = if all == 0 { is_alone(then) && !is_alone(other) } else { held * 2 > all };
                if takes_then { (then, held) } else { (other, all - held) }
            }
            _ => return Way { blocks },
        };
        count = (count * share).checked_div(all).unwrap_or(count);
        let is_alone = leading.get(&next) == Some(&1);
        if blocks.contains(&next) || length > LONGEST || !(is_alone || count >= often) {
            return Way { blocks };
        }
        blocks.push(next);
        at = next;
    }
}
