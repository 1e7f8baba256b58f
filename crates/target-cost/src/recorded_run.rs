//! The operations of every step of a run, from which the run is priced on targets.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use real::Graph;

use crate::task::Step;

/// The steps of a run: each sequence of operations, and how often it occurs. Most steps make the same sequence.
#[derive(Clone, Debug, Default)]
pub struct RecordedRun {
    /// Each sequence, with the number of steps that made it.
    pub steps: Vec<(Step, u32)>,
    /// Where a sequence is in `steps`.
    places: HashMap<Step, usize>,
}

impl RecordedRun {
    /// Adds a step.
    pub fn add(&mut self, graph: &Graph) {
        match self.places.entry(Step::of(graph)) {
            Entry::Occupied(known) => self.steps[*known.get()].1 += 1,
            Entry::Vacant(new) => {
                self.steps.push((new.key().clone(), 1));
                new.insert(self.steps.len() - 1);
            }
        }
    }
}
