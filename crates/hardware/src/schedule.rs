//! The order in which a way's operations are issued, one a cycle: a list schedule by the longest way to the end.

use std::collections::{HashMap, HashSet};

use crate::graph::{Deed, Graph, Holds, Item, Value};
use crate::program::{End, Numbers, Op, Register};
use crate::timing::{BUBBLE, SUM, latency};

/// Something that is issued.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Work {
    /// An operation, or the load of a column.
    Value(Value),
    /// The deed of this number.
    Deed(usize),
    /// A register takes the value that it holds at the end.
    Home(Register, Value),
    /// What a register held at the begin is kept, because it is written before it is read last.
    Keep(Value),
    End,
}

/// How a way's end is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    /// What follows stands behind it.
    FallsThrough,
    /// A word that leads elsewhere.
    Leads,
    /// A word that waits.
    Waits,
}

/// A way with the cycle of each piece of work.
pub(crate) struct Schedule {
    pub(crate) issues: Vec<(u32, Work)>,
    /// Registers in which values are computed at once.
    pub(crate) homes: HashMap<Value, Register>,
    /// Begins that are kept.
    pub(crate) kept: HashSet<Value>,
    pub(crate) end: u32,
}

struct Task {
    work: Work,
    latency: u32,
    /// Tasks that wait for this one, and how long after its issue.
    next: Vec<(usize, u32)>,
    waits_for: usize,
    urgency: u64,
}

struct Builder<'a> {
    graph: &'a Graph,
    numbers: Numbers,
    tasks: Vec<Task>,
    of_value: HashMap<Value, usize>,
    of_deed: Vec<usize>,
    homes: HashMap<Value, Register>,
    kept: HashSet<Value>,
}

/// Schedules a way.
pub(crate) fn schedule(graph: &Graph, ending: Ending, numbers: Numbers) -> Schedule {
    let mut builder = Builder {
        graph,
        numbers,
        tasks: Vec::new(),
        of_value: HashMap::new(),
        of_deed: Vec::new(),
        homes: HashMap::new(),
        kept: HashSet::new(),
    };
    builder.values();
    builder.deeds();
    builder.homes();
    builder.end(ending);
    builder.rank();
    builder.issue()
}

impl Builder<'_> {
    fn item(&self, value: Value) -> Item {
        self.graph.items[value as usize]
    }

    fn task(&mut self, work: Work, latency: u32) -> usize {
        self.tasks.push(Task { work, latency, next: Vec::new(), waits_for: 0, urgency: 0 });
        self.tasks.len() - 1
    }

    /// `later` is issued at least `distance` cycles behind `first`.
    fn order(&mut self, first: usize, later: usize, distance: u32) {
        if let Some(task) = self.tasks.get_mut(first) {
            task.next.push((later, distance));
        }
        if let Some(task) = self.tasks.get_mut(later) {
            task.waits_for += 1;
        }
    }

    /// What a task reads to have this value: the value's task, or a load, or the row of a column.
    fn needs(&mut self, value: Value, by: usize, is_direct: bool) {
        match self.item(value) {
            Item::Operation(..) => {}
            // A second column is loaded before.
            Item::Column(..) if !is_direct => {}
            Item::Column(row, _) => return self.needs(row, by, true),
            _ => return,
        }
        let first = self.produce(value);
        let distance = self.tasks[first].latency;
        self.order(first, by, distance);
    }

    /// The task that makes a value.
    fn produce(&mut self, value: Value) -> usize {
        if let Some(task) = self.of_value.get(&value) {
            return *task;
        }
        let (op, operands) = match self.item(value) {
            Item::Operation(op, operands) => (op, operands.iter().copied().take(op.operands()).collect()),
            _ => (Op::Move, vec![value]),
        };
        let task = self.task(Work::Value(value), latency(op, self.numbers));
        self.of_value.insert(value, task);
        self.reads(&operands, task);
        task
    }

    /// A task reads these values: one column at most at its place in the table, the others loaded before.
    fn reads(&mut self, values: &[Value], by: usize) {
        let mut direct = None;
        for value in values {
            let is_direct = match self.item(*value) {
                Item::Column(..) => *direct.get_or_insert(*value) == *value,
                _ => true,
            };
            self.needs(*value, by, is_direct);
        }
    }

    /// Everything that deeds and the end need.
    fn values(&mut self) {
        for deed in 0..self.graph.deeds.len() {
            // An output is seen when its operand has been read; an exit stands where it is.
            let is_output = matches!(self.graph.deeds[deed], Deed::Output { .. });
            let task = self.task(Work::Deed(deed), if is_output { SUM } else { 1 });
            self.of_deed.push(task);
        }
    }

    fn deeds(&mut self) {
        let graph = self.graph;
        for (index, deed) in graph.deeds.iter().enumerate() {
            let task = self.of_deed[index];
            match deed {
                Deed::Output { value, .. } => self.reads(&[*value], task),
                Deed::Exit { a, b, .. } => self.reads(&[*a, *b], task),
            }
            if let Some(before) = index.checked_sub(1) {
                self.order(self.of_deed[before], task, 1);
            }
        }
        for (index, deed) in graph.deeds.iter().enumerate() {
            if let Deed::Exit { holds, .. } = deed {
                for value in sources(graph, holds) {
                    if let Item::Operation(..) = self.item(value) {
                        let first = self.produce(value);
                        self.before_exit(first, index);
                    }
                }
            }
        }
        for (_, value) in &graph.holds {
            if let Item::Operation(..) = self.item(*value) {
                self.produce(*value);
            }
        }
        // What takes many cycles is over where the way is left, or has not begun.
        for value in (0..).take(graph.items.len()) {
            let Some(task) = self.of_value.get(&value).copied() else { continue };
            if self.tasks[task].latency <= BUBBLE + SUM {
                continue;
            }
            for (index, deed) in graph.deeds.iter().enumerate() {
                let Deed::Exit { .. } = deed else { continue };
                if graph.after[value as usize] <= index {
                    self.before_exit(task, index);
                } else {
                    self.order(self.of_deed[index], task, 1);
                }
            }
        }
    }

    /// A result can be read where an exit leads.
    fn before_exit(&mut self, first: usize, exit: usize) {
        let distance = self.tasks[first].latency.saturating_sub(BUBBLE + 1).max(1);
        self.order(first, self.of_deed[exit], distance);
    }

    /// Whether one task is before another one, whatever the schedule.
    fn is_before(&self, first: usize, later: usize) -> bool {
        let (mut open, mut seen) = (vec![first], HashSet::new());
        while let Some(at) = open.pop() {
            if at == later {
                return true;
            }
            if seen.insert(at) {
                open.extend(self.tasks[at].next.iter().map(|(next, _)| *next));
            }
        }
        false
    }

    /// Tasks that read what a register held at the begin, or leave the way to where it is read.
    fn readers(&self, register: Register) -> Vec<usize> {
        let graph = self.graph;
        let mut found = Vec::new();
        let reads = |value: Value| match graph.items[value as usize] {
            Item::Begin(of) => of == register,
            Item::Column(row, _) => graph.items[row as usize] == Item::Begin(register),
            _ => false,
        };
        for (value, task) in &self.of_value {
            let is_reader = match self.item(*value) {
                Item::Operation(op, operands) => {
                    operands.iter().take(op.operands()).any(|operand| reads(*operand))
                }
                _ => reads(*value),
            };
            if is_reader {
                found.push(*task);
            }
        }
        for (deed, task) in graph.deeds.iter().zip(&self.of_deed) {
            let is_reader = match deed {
                Deed::Output { value, .. } => reads(*value),
                Deed::Exit { a, b, holds, live, .. } => {
                    let is_kept = live.contains(&register) && !holds.iter().any(|(of, _)| *of == register);
                    is_kept || reads(*a) || reads(*b) || holds.iter().any(|(_, value)| reads(*value))
                }
            };
            if is_reader {
                found.push(*task);
            }
        }
        found.sort_unstable();
        found
    }

    /// Values go into the registers that hold them at the end: at once where nothing reads the old one later.
    fn homes(&mut self) {
        let graph = self.graph;
        let written: HashSet<Register> = graph.holds.iter().map(|(register, _)| *register).collect();
        let mut moves = Vec::new();
        for (register, value) in &graph.holds {
            // What is moved from a register that is written too is kept first.
            if let Item::Begin(from) = self.item(*value)
                && written.contains(&from)
                && !self.kept.contains(value)
            {
                let task = self.task(Work::Keep(*value), SUM);
                self.of_value.insert(*value, task);
                self.kept.insert(*value);
            }
            let is_taken = self.homes.contains_key(value);
            let is_operation = matches!(self.item(*value), Item::Operation(..));
            let readers = self.readers(*register);
            match self.of_value.get(value).copied() {
                Some(task)
                    if is_operation
                        && !is_taken
                        && !readers.iter().any(|reader| self.is_before(task, *reader)) =>
                {
                    self.homes.insert(*value, *register);
                    for reader in readers {
                        self.order(reader, task, 1);
                    }
                }
                _ => moves.push((*register, *value)),
            }
        }
        self.homes_at_exits(&written);
        for (register, value) in moves {
            let task = self.task(Work::Home(register, value), SUM);
            if self.kept.contains(&value) {
                let first = self.of_value[&value];
                self.order(first, task, SUM);
            } else {
                self.reads(&[value], task);
            }
            for reader in self.readers(register) {
                self.order(reader, task, 1);
            }
            for (index, deed) in graph.deeds.iter().enumerate() {
                // A move stays behind every exit: the way out has moves of its own.
                if let Deed::Exit { .. } = deed {
                    self.order(self.of_deed[index], task, 1);
                }
            }
        }
        // A row that is read by a late move may be a register that is written early.
        let homes: Vec<_> = self.homes.iter().map(|(value, register)| (*value, *register)).collect();
        for (value, register) in homes {
            let task = self.of_value[&value];
            for index in 0..self.tasks.len() {
                if let Work::Home(_, moved) = self.tasks[index].work
                    && let Item::Column(row, _) = self.item(moved)
                    && self.item(row) == Item::Begin(register)
                {
                    self.order(index, task, 1);
                }
            }
        }
    }

    /// A value that exits leave in a register, which nothing else here asks for, goes there at once: those exits need no move.
    fn homes_at_exits(&mut self, written: &HashSet<Register>) {
        let graph = self.graph;
        let mut used: HashSet<Register> = self.homes.values().copied().collect();
        for deed in &graph.deeds {
            let Deed::Exit { holds, .. } = deed else { continue };
            for (register, value) in holds {
                let is_free =
                    !written.contains(register) && !graph.live.contains(register) && !used.contains(register);
                let is_operation = matches!(self.item(*value), Item::Operation(..));
                if is_free
                    && is_operation
                    && !self.homes.contains_key(value)
                    && self.readers(*register).is_empty()
                {
                    self.homes.insert(*value, *register);
                    used.insert(*register);
                }
            }
        }
    }

    fn end(&mut self, ending: Ending) {
        let graph = self.graph;
        let end = self.task(Work::End, 0);
        for index in 0..end {
            let latency = self.tasks[index].latency;
            let distance = match (self.tasks[index].work, ending) {
                (Work::Deed(_), _) => latency,
                (_, Ending::FallsThrough) => latency,
                (_, Ending::Waits) => latency.saturating_sub(1).max(1),
                (_, Ending::Leads) => latency.saturating_sub(BUBBLE + 1).max(1),
            };
            self.order(index, end, distance);
        }
        debug_assert!(graph.end != End::Return || ending == Ending::Leads, "a return leads elsewhere");
    }

    /// How long before the end each task must be issued; what the output waits for comes first.
    fn rank(&mut self) {
        let mut order = Vec::new();
        let mut waits: Vec<usize> = self.tasks.iter().map(|task| task.waits_for).collect();
        let mut open: Vec<usize> = (0..self.tasks.len()).filter(|task| waits[*task] == 0).collect();
        while let Some(task) = open.pop() {
            order.push(task);
            for (next, _) in &self.tasks[task].next {
                waits[*next] -= 1;
                if waits[*next] == 0 {
                    open.push(*next);
                }
            }
        }
        assert_eq!(order.len(), self.tasks.len(), "no task waits for itself");
        let last_output = self.graph.deeds.iter().rposition(|deed| matches!(deed, Deed::Output { .. }));
        for task in order.into_iter().rev() {
            let longest = self.tasks[task].next.iter().map(|(next, distance)| {
                let urgency = self.tasks[*next].urgency;
                urgency + u64::from(*distance)
            });
            let longest = longest.max().unwrap_or(0);
            let bonus = match self.tasks[task].work {
                Work::Deed(deed) if Some(deed) == last_output => 1 << 20,
                _ => 0,
            };
            self.tasks[task].urgency = longest + bonus;
        }
    }

    fn issue(mut self) -> Schedule {
        let mut earliest = vec![0_u32; self.tasks.len()];
        let mut ready: Vec<usize> =
            (0..self.tasks.len()).filter(|task| self.tasks[*task].waits_for == 0).collect();
        let (mut landing, mut issues) = (HashSet::new(), Vec::new());
        let (mut cycle, mut free_again, mut end) = (0, 0, 0);
        while !ready.is_empty() {
            let can = |task: &usize| {
                let of = &self.tasks[*task];
                let is_long = of.latency > BUBBLE + SUM;
                let writes = matches!(of.work, Work::Value(_) | Work::Home(..) | Work::Keep(_));
                earliest[*task] <= cycle
                    && (!writes || !landing.contains(&(cycle + of.latency)))
                    && (!is_long || cycle >= free_again)
            };
            let best = ready
                .iter()
                .copied()
                .filter(|task| can(task))
                .max_by_key(|task| (self.tasks[*task].urgency, std::cmp::Reverse(*task)));
            if let Some(task) = best {
                ready.retain(|other| *other != task);
                let latency = self.tasks[task].latency;
                if !matches!(self.tasks[task].work, Work::Deed(_) | Work::End) {
                    landing.insert(cycle + latency);
                }
                if latency > BUBBLE + SUM {
                    free_again = cycle + latency;
                }
                if self.tasks[task].work == Work::End {
                    end = cycle;
                } else {
                    issues.push((cycle, self.tasks[task].work));
                }
                for (next, distance) in std::mem::take(&mut self.tasks[task].next) {
                    earliest[next] = earliest[next].max(cycle + distance);
                    self.tasks[next].waits_for -= 1;
                    if self.tasks[next].waits_for == 0 {
                        ready.push(next);
                    }
                }
            }
            cycle += 1;
        }
        Schedule { issues, homes: self.homes, kept: self.kept, end }
    }
}

/// The values that registers hold at an exit, and the rows of columns among them.
pub(crate) fn sources(graph: &Graph, holds: &Holds) -> Vec<Value> {
    let row = |value: Value| match graph.items[value as usize] {
        Item::Column(row, _) => row,
        _ => value,
    };
    holds.iter().map(|(_, value)| row(*value)).collect()
}
