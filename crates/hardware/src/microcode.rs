//! Microcode: registers are dealt out, ways stand one behind the other, and each way out gets the moves that it needs.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use crate::error::CoreError;
use crate::executor::Run;
use crate::graph::{Deed, Graph, Item, Value};
use crate::program::{BlockId, Compare, End, Event, Op, Program, Register};
use crate::schedule::{Ending, Schedule, Work, schedule, sources};
use crate::tables::Tables;
use crate::timing::{BUBBLE, CHOICE, LONGEST_WAIT, SUM};

/// A place in the register file.
pub(crate) type Slot = u16;
/// So many of the first slots can point at rows.
pub(crate) const POINTERS: usize = 32;
/// Registers of the core.
const SLOTS: usize = 512;
/// Words of microcode, at most: a branch has so many bits for its target.
const MOST_WORDS: usize = 1 << 13;

/// What a word does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    Nothing,
    Compute(Op),
    /// `to` becomes this number.
    Load(i64),
    Branch {
        compare: Compare,
        on: bool,
    },
    Jump,
    Call,
    Return,
    Wait(Event),
}

/// What a word reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Source {
    Slot(Slot),
    /// A column of the row at which a slot points.
    Table {
        pointer: Slot,
        column: u16,
    },
}

/// A word of microcode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word {
    pub(crate) action: Action,
    pub(crate) to: Slot,
    pub(crate) sources: [Source; 3],
    pub(crate) target: usize,
    pub(crate) wait: u32,
}

/// The columns of a group as they stand in a row, and the row's length as a power of two.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout {
    pub(crate) columns: Vec<u16>,
    pub(crate) bits: u32,
}

/// Microcode and what belongs to it.
#[derive(Clone, Debug)]
pub(crate) struct Microcode {
    pub(crate) words: Vec<Word>,
    pub(crate) layouts: Vec<Layout>,
    /// What the loaded registers hold: constants, and the numbers of parameters.
    pub(crate) header: Vec<Item>,
    /// Bits of a column's place in its row.
    pub(crate) column_bits: u32,
    pub(crate) slots: usize,
}

/// A word before addresses are known.
#[derive(Clone, Copy, Debug)]
struct Draft {
    word: Word,
    target: Option<Label>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Label {
    Way(BlockId),
    Exit(BlockId, usize),
}

struct Writer<'a> {
    program: &'a Program,
    graphs: &'a HashMap<BlockId, Graph>,
    homes: HashMap<Register, Slot>,
    loaded: BTreeMap<String, (Item, Slot)>,
    layouts: Vec<Layout>,
    drafts: Vec<Draft>,
    places: HashMap<Label, usize>,
    next_pointer: usize,
    next_slot: usize,
    most_pointers: usize,
    most_slots: usize,
}

/// The microcode of ways.
///
/// # Errors
/// [`CoreError::TooMany`] if the core has too few registers, pointers or words.
pub(crate) fn microcode(
    program: &Program,
    graphs: &HashMap<BlockId, Graph>,
    run: &Run,
) -> Result<Microcode, CoreError> {
    let order = layout(program, graphs, run);
    let mut writer = Writer {
        program,
        graphs,
        homes: HashMap::new(),
        loaded: BTreeMap::new(),
        layouts: vec![Layout::default(); Tables::groups()],
        drafts: Vec::new(),
        places: HashMap::new(),
        next_pointer: 0,
        next_slot: POINTERS,
        most_pointers: 0,
        most_slots: 0,
    };
    let schedules: Vec<_> = order
        .iter()
        .enumerate()
        .map(|(place, head)| {
            let graph = &graphs[head];
            let ending = match graph.end {
                End::Jump(to) if order.get(place + 1) == Some(&to) => Ending::FallsThrough,
                End::Wait(..) => Ending::Waits,
                _ => Ending::Leads,
            };
            (*head, ending, schedule(graph, ending, program.numbers))
        })
        .collect();
    writer.deal_homes(&schedules);
    let mut exits = Vec::new();
    for (place, (head, ending, schedule)) in schedules.iter().enumerate() {
        let next = order.get(place + 1).copied();
        writer.way(&graphs[head], *ending, schedule, next, &mut exits)?;
    }
    let mut written: HashMap<(Moves, BlockId), usize> = HashMap::new();
    for (label, moves, to) in exits {
        // Equal ways out are one.
        match written.get(&(moves.clone(), to)) {
            Some(place) => writer.places.insert(label, *place),
            None => {
                written.insert((moves.clone(), to), writer.drafts.len());
                writer.places.insert(label, writer.drafts.len());
                writer.exit(&moves, to)?;
                None
            }
        };
    }
    writer.finish()
}

/// The order of ways in memory. A way whose end the run passed most often is followed by the way that it leads to, so
/// that it needs no jump.
fn layout(program: &Program, graphs: &HashMap<BlockId, Graph>, run: &Run) -> Vec<BlockId> {
    let mut heads = reached(program, graphs);
    heads[1..].sort_by_key(|head| Reverse(run.counts.get(*head).copied().unwrap_or(0)));
    let (mut next, mut before) = (HashMap::new(), HashMap::from([(program.entry, None)]));
    for head in &heads {
        let (End::Jump(to) | End::Wait(_, to) | End::Call { then: to, .. }) = graphs[head].end else {
            continue;
        };
        let last = std::iter::successors(Some(to), |at| next.get(at).copied()).last();
        if last != Some(*head) && !before.contains_key(&to) {
            next.insert(*head, to);
            before.insert(to, Some(*head));
        }
    }
    let begins = heads.iter().filter(|head| before.get(*head).copied().flatten().is_none());
    begins.flat_map(|head| std::iter::successors(Some(*head), |at| next.get(at).copied())).collect()
}

/// The ways to which others lead, the entry's first.
fn reached(program: &Program, graphs: &HashMap<BlockId, Graph>) -> Vec<BlockId> {
    let (mut found, mut seen, mut open) = (Vec::new(), HashSet::new(), vec![program.entry]);
    while let Some(head) = open.pop() {
        let Some(graph) = graphs.get(&head).filter(|_| seen.insert(head)) else { continue };
        found.push(head);
        open.extend(graph.end.targets());
        if let End::Call { entry, .. } = graph.end {
            open.push(entry);
        }
        open.extend(graph.deeds.iter().filter_map(|deed| match deed {
            Deed::Exit { to, .. } => Some(*to),
            Deed::Output { .. } => None,
        }));
    }
    found
}

/// Moves at a way out.
type Moves = Vec<(Register, Source)>;

impl Writer<'_> {
    /// Gives every register that lives from way to way its slot; those that point at rows are among the first.
    fn deal_homes(&mut self, schedules: &[(BlockId, Ending, Schedule)]) {
        let (mut pointers, mut others) = (BTreeSet::new(), BTreeSet::new());
        for (head, _, schedule) in schedules {
            let graph = &self.graphs[head];
            let mut rows = HashSet::new();
            for item in &graph.items {
                match item {
                    Item::Column(row, _) => {
                        rows.insert(*row);
                    }
                    Item::Begin(register) => {
                        others.insert(*register);
                    }
                    _ => {}
                }
            }
            for row in rows {
                if let Item::Begin(register) = graph.items[row as usize] {
                    pointers.insert(register);
                }
                pointers.extend(schedule.homes.get(&row));
            }
            others.extend(graph.holds.iter().map(|(register, _)| *register));
            for deed in &graph.deeds {
                if let Deed::Exit { holds, .. } = deed {
                    others.extend(holds.iter().map(|(register, _)| *register));
                }
            }
        }
        for register in &pointers {
            self.homes.insert(*register, slot_of(self.next_pointer));
            self.next_pointer += 1;
        }
        for register in others.difference(&pointers) {
            self.homes.insert(*register, slot_of(self.next_slot));
            self.next_slot += 1;
        }
        self.most_pointers = self.next_pointer;
        self.most_slots = self.next_slot;
    }

    /// The slot of a constant or a parameter, which is loaded at the begin.
    fn constant(&mut self, item: Item) -> Slot {
        let name = match item {
            Item::Constant(value) => format!("constant {value}"),
            Item::Parameter(number) => format!("parameter {number:5}"),
            _ => String::new(),
        };
        // Slots of constants are counted from the last one down.
        let next = slot_of((SLOTS - 1).saturating_sub(self.loaded.len()));
        self.loaded.entry(name).or_insert((item, next)).1
    }

    /// The place of a column in its row.
    fn column(&mut self, column: u16) -> u16 {
        let layout = &mut self.layouts[self.program.tables.group_of(column)];
        let place = layout.columns.iter().position(|known| *known == column);
        let place = place.unwrap_or_else(|| {
            layout.columns.push(column);
            layout.columns.len() - 1
        });
        slot_of(place)
    }

    fn home(&self, register: Register) -> Slot {
        self.homes.get(&register).copied().unwrap_or(0)
    }

    fn way(
        &mut self,
        graph: &Graph,
        ending: Ending,
        schedule: &Schedule,
        next: Option<BlockId>,
        exits: &mut Vec<(Label, Moves, BlockId)>,
    ) -> Result<(), CoreError> {
        let slots = self.deal_temporaries(graph, schedule)?;
        self.places.insert(Label::Way(graph.head), self.drafts.len());
        let mut drafts: Vec<(u32, Draft)> = Vec::new();
        for (cycle, work) in &schedule.issues {
            let draft = match *work {
                Work::Value(value) => self.computed(graph, schedule, &slots, value),
                Work::Keep(value) | Work::Home(_, value) => {
                    let from = if matches!(work, Work::Home(..)) && schedule.kept.contains(&value) {
                        Source::Slot(slots[&value])
                    } else {
                        self.source(graph, schedule, &slots, value, true)
                    };
                    let to =
                        if let Work::Home(register, _) = work { self.home(*register) } else { slots[&value] };
                    plain(Action::Compute(Op::Move), to, [from; 3])
                }
                Work::Deed(number) => match &graph.deeds[number] {
                    Deed::Output { place, value } => {
                        let from = self.source(graph, schedule, &slots, *value, true);
                        plain(Action::Compute(Op::Output(*place)), 0, [from; 3])
                    }
                    Deed::Exit { compare, on, a, b, to, holds, .. } => {
                        let [a, b, _] = self.read(graph, schedule, &slots, &[*a, *b]);
                        let mut moves = Moves::new();
                        for (register, value) in holds {
                            let from = self.source(graph, schedule, &slots, *value, true);
                            if from != Source::Slot(self.home(*register)) {
                                moves.push((*register, from));
                            }
                        }
                        let mut target = Label::Way(*to);
                        if !moves.is_empty() {
                            target = Label::Exit(graph.head, number);
                            exits.push((target, moves, *to));
                        }
                        let word = plain(Action::Branch { compare: *compare, on: *on }, 0, [a, b, a]).word;
                        Draft { word, target: Some(target) }
                    }
                },
                Work::End => continue,
            };
            drafts.push((*cycle, draft));
        }
        let nowhere = [Source::Slot(0); 3];
        let mut behind = None;
        match (graph.end, ending) {
            (_, Ending::FallsThrough) => {}
            (End::Jump(to), _) => {
                let word = plain(Action::Jump, 0, nowhere).word;
                drafts.push((schedule.end, Draft { word, target: Some(Label::Way(to)) }));
            }
            (End::Call { entry, then }, _) => {
                let word = plain(Action::Call, 0, nowhere).word;
                drafts.push((schedule.end, Draft { word, target: Some(Label::Way(entry)) }));
                behind = (next != Some(then)).then_some(then);
            }
            (End::Wait(event, then), _) => {
                drafts.push((schedule.end, plain(Action::Wait(event), 0, nowhere)));
                behind = (next != Some(then)).then_some(then);
            }
            _ => drafts.push((schedule.end, plain(Action::Return, 0, nowhere))),
        }
        let end = if ending == Ending::FallsThrough { schedule.end } else { schedule.end + 1 };
        self.place(drafts, end);
        if let Some(then) = behind {
            let word = plain(Action::Jump, 0, nowhere).word;
            self.drafts.push(Draft { word, target: Some(Label::Way(then)) });
        }
        Ok(())
    }

    /// Puts words at their cycles behind one another: each waits until the next.
    fn place(&mut self, drafts: Vec<(u32, Draft)>, end: u32) {
        let mut at = 0;
        let cycles: Vec<u32> = drafts.iter().map(|(cycle, _)| *cycle).chain([end]).collect();
        for (index, (cycle, draft)) in drafts.into_iter().enumerate() {
            self.pause(cycle - at);
            let gap = cycles[index + 1].saturating_sub(cycle + 1);
            let wait = gap.min(LONGEST_WAIT);
            self.drafts.push(Draft { word: Word { wait, ..draft.word }, ..draft });
            at = cycle + 1 + wait;
        }
        self.pause(end.saturating_sub(at));
    }

    /// Words that do nothing for so many cycles.
    fn pause(&mut self, mut cycles: u32) {
        while cycles > 0 {
            let wait = (cycles - 1).min(LONGEST_WAIT);
            let draft = plain(Action::Nothing, 0, [Source::Slot(0); 3]);
            self.drafts.push(Draft { word: Word { wait, ..draft.word }, ..draft });
            cycles -= wait + 1;
        }
    }

    fn computed(
        &mut self,
        graph: &Graph,
        schedule: &Schedule,
        slots: &HashMap<Value, Slot>,
        value: Value,
    ) -> Draft {
        let to = match schedule.homes.get(&value) {
            Some(register) => self.home(*register),
            None => slots.get(&value).copied().unwrap_or(0),
        };
        match graph.items[value as usize] {
            Item::Operation(op, operands) => {
                let read = self.read(graph, schedule, slots, &operands[..op.operands()]);
                plain(Action::Compute(op), to, read)
            }
            _ => {
                let from = self.source(graph, schedule, slots, value, true);
                plain(Action::Compute(Op::Move), to, [from; 3])
            }
        }
    }

    /// The sources of a word: the first column stands in its place in the table, others were loaded.
    fn read(
        &mut self,
        graph: &Graph,
        schedule: &Schedule,
        slots: &HashMap<Value, Slot>,
        values: &[Value],
    ) -> [Source; 3] {
        let mut found = [Source::Slot(0); 3];
        let mut direct = None;
        for (to, value) in found.iter_mut().zip(values) {
            let is_column = matches!(graph.items[*value as usize], Item::Column(..));
            let is_direct = !is_column || *direct.get_or_insert(*value) == *value;
            *to = self.source(graph, schedule, slots, *value, is_direct);
        }
        found
    }

    fn source(
        &mut self,
        graph: &Graph,
        schedule: &Schedule,
        slots: &HashMap<Value, Slot>,
        value: Value,
        is_direct: bool,
    ) -> Source {
        match graph.items[value as usize] {
            Item::Begin(register) => Source::Slot(self.home(register)),
            item @ (Item::Constant(_) | Item::Parameter(_)) => Source::Slot(self.constant(item)),
            Item::Column(row, column) if is_direct => {
                let Source::Slot(pointer) = self.source(graph, schedule, slots, row, true) else {
                    return Source::Slot(0);
                };
                Source::Table { pointer, column: self.column(column) }
            }
            _ => Source::Slot(match schedule.homes.get(&value) {
                Some(register) => self.home(*register),
                None => slots.get(&value).copied().unwrap_or(0),
            }),
        }
    }

    /// Gives values of one way slots, each from its issue to its last use.
    fn deal_temporaries(
        &mut self,
        graph: &Graph,
        schedule: &Schedule,
    ) -> Result<HashMap<Value, Slot>, CoreError> {
        let mut last: HashMap<Value, u32> = HashMap::new();
        let mut rows = HashSet::new();
        let mut uses = |cycle: u32, values: &[Value], all_direct: bool| {
            let mut direct = None;
            for value in values {
                let used = match graph.items[*value as usize] {
                    Item::Column(row, _) if all_direct || *direct.get_or_insert(*value) == *value => {
                        rows.insert(row);
                        row
                    }
                    _ => *value,
                };
                let last = last.entry(used).or_default();
                *last = (*last).max(cycle);
            }
        };
        for (cycle, work) in &schedule.issues {
            match *work {
                Work::Value(value) => match graph.items[value as usize] {
                    Item::Operation(op, operands) => uses(*cycle, &operands[..op.operands()], false),
                    _ => uses(*cycle, &[value], true),
                },
                Work::Home(_, value) => uses(*cycle, &[value], true),
                Work::Keep(_) | Work::End => {}
                Work::Deed(number) => match &graph.deeds[number] {
                    Deed::Output { value, .. } => uses(*cycle, &[*value], true),
                    Deed::Exit { a, b, holds, .. } => {
                        uses(*cycle, &[*a, *b], false);
                        uses(*cycle, &holds.iter().map(|(_, value)| *value).collect::<Vec<_>>(), true);
                        uses(*cycle, &sources(graph, holds), true);
                    }
                },
            }
        }
        let mut slots = HashMap::new();
        let mut free: [BTreeSet<usize>; 2] =
            [(self.next_pointer..POINTERS).collect(), (self.next_slot..SLOTS).collect()];
        let mut active: Vec<(u32, usize, usize)> = Vec::new();
        for (cycle, work) in &schedule.issues {
            let (Work::Value(value) | Work::Keep(value)) = *work else { continue };
            if schedule.homes.contains_key(&value) && !matches!(work, Work::Keep(_)) {
                continue;
            }
            active.retain(|(end, class, slot)| {
                let stays = *end > *cycle;
                if !stays {
                    free[*class].insert(*slot);
                }
                stays
            });
            let class = usize::from(!rows.contains(&value));
            let Some(slot) = free[class].pop_first() else {
                let (what, most) = [("pointers", POINTERS), ("registers", SLOTS)][class];
                return Err(CoreError::TooMany { what, needed: most + 1, most });
            };
            if class == 0 {
                self.most_pointers = self.most_pointers.max(slot + 1);
            } else {
                self.most_slots = self.most_slots.max(slot + 1);
            }
            active.push((last.get(&value).copied().unwrap_or(*cycle).max(cycle + 1), class, slot));
            slots.insert(value, slot_of(slot));
        }
        Ok(slots)
    }

    /// The moves of a way out, none of which writes what another one still reads; then the way on.
    fn exit(&mut self, moves: &Moves, to: BlockId) -> Result<(), CoreError> {
        let reads = |from: &Source| match from {
            Source::Slot(slot) | Source::Table { pointer: slot, .. } => *slot,
        };
        let mut open: Vec<(Slot, Source)> =
            moves.iter().map(|(register, from)| (self.home(*register), *from)).collect();
        let mut words = Vec::new();
        while !open.is_empty() {
            let is_free = |index: &usize| {
                let (to, _) = open[*index];
                open.iter().enumerate().all(|(other, (_, from))| other == *index || reads(from) != to)
            };
            match (0..open.len()).find(is_free) {
                Some(index) => {
                    let (to, from) = open.remove(index);
                    words.push(plain(Action::Compute(Op::Move), to, [from; 3]));
                }
                None => {
                    // A circle: one register is kept in a slot of no way.
                    let (to, _) = open[0];
                    let kept = slot_of((SLOTS - 9).saturating_sub(self.loaded.len()));
                    words.push(plain(Action::Compute(Op::Move), kept, [Source::Slot(to); 3]));
                    for (_, from) in &mut open {
                        match from {
                            Source::Slot(slot) if *slot == to => *slot = kept,
                            Source::Table { .. } | Source::Slot(_) => {}
                        }
                    }
                    if open
                        .iter()
                        .any(|(_, from)| matches!(from, Source::Table { pointer, .. } if *pointer == to))
                    {
                        return Err(CoreError::TooMany {
                            what: "rows that change places",
                            needed: 1,
                            most: 0,
                        });
                    }
                    words.push(plain(Action::Nothing, 0, [Source::Slot(0); 3]));
                    words.push(plain(Action::Nothing, 0, [Source::Slot(0); 3]));
                }
            }
        }
        let mut cycle = 0;
        let mut drafts = Vec::new();
        for word in words {
            drafts.push((cycle, word));
            cycle += 1;
        }
        // The last move can be read where the way goes on.
        let jump = cycle + (SUM - 1).saturating_sub(BUBBLE);
        let word = plain(Action::Jump, 0, [Source::Slot(0); 3]).word;
        drafts.push((jump, Draft { word, target: Some(Label::Way(to)) }));
        self.place(drafts, jump + 1);
        Ok(())
    }

    /// Words that load constants, before all others; and the addresses.
    fn finish(mut self) -> Result<Microcode, CoreError> {
        for layout in &mut self.layouts {
            layout.bits = layout.columns.len().max(1).next_power_of_two().trailing_zeros();
        }
        let column_bits = self.layouts.iter().map(|layout| layout.bits).max().unwrap_or(0).max(4);
        let needed = self.most_slots + self.loaded.len() + 1;
        if needed > SLOTS - 8 {
            return Err(CoreError::TooMany { what: "registers", needed, most: SLOTS - 8 });
        }
        if self.most_pointers > POINTERS {
            return Err(CoreError::TooMany { what: "pointers", needed: self.most_pointers, most: POINTERS });
        }
        let main = std::mem::take(&mut self.drafts);
        let loaded: Vec<_> = self.loaded.values().copied().collect();
        let nowhere = [Source::Slot(0); 3];
        for (place, (_, slot)) in loaded.iter().enumerate() {
            let column = place % (1 << column_bits);
            if column == 0 {
                let word = plain(Action::Load(i64::from(slot_of(place))), 0, nowhere).word;
                self.drafts.push(Draft { word: Word { wait: CHOICE - 1, ..word }, target: None });
            }
            let from = Source::Table { pointer: 0, column: slot_of(column) };
            self.drafts.push(plain(Action::Compute(Op::Move), *slot, [from; 3]));
        }
        self.pause(SUM);
        let first = self.drafts.len();
        self.drafts.extend(main);
        if self.drafts.len() > MOST_WORDS {
            return Err(CoreError::TooMany {
                what: "words of microcode",
                needed: self.drafts.len(),
                most: MOST_WORDS,
            });
        }
        let places = &self.places;
        let words = self.drafts.iter().map(|draft| {
            let target = draft.target.and_then(|label| places.get(&label)).map_or(0, |place| place + first);
            Word { target, ..draft.word }
        });
        Ok(Microcode {
            words: words.collect(),
            layouts: self.layouts,
            header: loaded.into_iter().map(|(item, _)| item).collect(),
            column_bits,
            slots: needed,
        })
    }
}

/// A number of a slot or a column. One that is too large is refused when all are dealt out.
fn slot_of(number: usize) -> Slot {
    Slot::try_from(number).unwrap_or(Slot::MAX)
}

fn plain(action: Action, to: Slot, sources: [Source; 3]) -> Draft {
    Draft { word: Word { action, to, sources, target: 0, wait: 0 }, target: None }
}
