//! Which of the tolerances that a part states holds for each move.
//!
//! The rounding of a corner lies on the moves on both sides of it, and the move before it says how far it may be off. So the first move
//! behind a change is judged by the wider of both tolerances, that before the change and that behind it.

use std::collections::BTreeMap;

use part_program::{PathTolerance, ToleranceFrom};

/// The tolerances of a part, each once. Their numbers begin with 1, and 0 is none.
#[derive(Debug)]
pub(crate) struct Tolerances {
    pub(crate) stated: Vec<PathTolerance>,
    /// From which move on each holds, in order, none before the first.
    from: Vec<(usize, usize)>,
}

impl Tolerances {
    pub(crate) fn new(changes: &[ToleranceFrom]) -> Self {
        let mut own = Self { stated: Vec::new(), from: Vec::new() };
        let (mut before, mut numbers) = (0, BTreeMap::new());
        for change in changes {
            let behind = change.tolerance.map_or(0, |tolerance| {
                let PathTolerance { rounding_mm, merging_mm } = tolerance;
                *numbers.entry([rounding_mm, merging_mm].map(f64::to_bits)).or_insert_with(|| {
                    own.stated.push(tolerance);
                    own.stated.len()
                })
            });
            if own.from.last().is_some_and(|(first, _)| *first == change.first_move) {
                own.from.pop();
            }
            if change.first_move > 0 {
                own.from.push((change.first_move, own.wider(before, behind)));
                own.from.push((change.first_move + 1, behind));
            } else {
                own.from.push((0, behind));
            }
            before = behind;
        }
        own
    }

    /// The number of the wider of two; none is the widest.
    fn wider(&self, one: usize, other: usize) -> usize {
        let most_mm = |number: usize| self.of(number).map_or(f64::INFINITY, PathTolerance::most_mm);
        if most_mm(other) > most_mm(one) { other } else { one }
    }

    fn of(&self, number: usize) -> Option<&PathTolerance> {
        number.checked_sub(1).and_then(|index| self.stated.get(index))
    }

    /// The number of the tolerance that holds for a move.
    pub(crate) fn at(&self, of_move: usize) -> usize {
        let behind = self.from.partition_point(|(first, _)| *first <= of_move);
        behind.checked_sub(1).map_or(0, |index| self.from[index].1)
    }

    /// How many numbers there are.
    pub(crate) fn count(&self) -> usize {
        self.stated.len() + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_holds_from_its_first_move_on_and_the_wider_one_for_that() {
        let of = |mm: f64| PathTolerance { rounding_mm: mm, merging_mm: mm };
        let changes =
            [(0, Some(0.05)), (3, Some(0.1)), (5, Some(0.05)), (6, None), (9, Some(0.1)), (10, Some(0.2))];
        let changes = changes.map(|(first_move, mm)| ToleranceFrom { first_move, tolerance: mm.map(of) });
        let tolerances = Tolerances::new(&changes);
        assert_eq!(tolerances.stated, [of(0.05), of(0.1), of(0.2)]);
        let held: Vec<usize> = (0..13).map(|index| tolerances.at(index)).collect();
        assert_eq!(held, [1, 1, 1, 2, 2, 2, 0, 0, 0, 0, 3, 3, 3]);
        assert_eq!([0, 7].map(|index| Tolerances::new(&[]).at(index)), [0; 2]);
    }
}
