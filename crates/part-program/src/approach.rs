//! Approaches: moves from where nobody knows to where curves begin. They are no curves, but words that do not move the tool have
//! their place before or behind them: a spindle that starts behind the approach is not to run on the way.

use crate::curve::Curve;
use crate::part::{Auxiliary, MoveKind, Part};

/// A straight move that says where axes are, after which they are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Whether it brings X, Y and Z: those that it names and that were unknown.
    pub axes: [bool; 3],
    /// At the commanded feedrate, or as fast as the machine can.
    pub kind: MoveKind,
    /// The feedrate in force, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// Line of the block that commands it, from 1.
    pub line: usize,
    /// Number of that block in the order of execution, from 1.
    pub block: u32,
}

impl Part {
    /// Whether the part says where its Z is: in a word Z, or with a third coordinate.
    pub(crate) fn names_z(&self) -> bool {
        let in_space = |curve: &Curve| curve.dimension == 3 || curve.leaves_z_0();
        self.approaches.iter().any(|approach| approach.axes[2]) || self.curves.iter().any(in_space)
    }

    /// Whether this block is an approach.
    pub(crate) fn approaches_in(&self, block: u32) -> bool {
        self.approaches.binary_search_by_key(&block, |approach| approach.block).is_ok()
    }

    /// The approaches, with the axes that none of them brings to the first curve.
    pub(crate) fn whole_approaches(&self) -> Vec<Approach> {
        let mut approaches = self.approaches.clone();
        let Some(first) = self.moves.first() else { return approaches };
        let own = approaches.partition_point(|approach| approach.block <= first.block);
        let is_needed = [true, true, self.names_z()];
        let missing = std::array::from_fn(|axis| {
            is_needed[axis] && !approaches[..own].iter().any(|approach| approach.axes[axis])
        });
        let rapid = |axes, (line, block)| Approach {
            axes,
            kind: MoveKind::Rapid,
            feedrate_mm_per_s: None,
            line,
            block,
        };
        let begin = (first.line, first.block);
        if own == 0 {
            let switch = self.first_switch().filter(|word| word.block < first.block);
            approaches
                .insert(0, rapid(missing, switch.map_or(begin, |word| (word.line as usize, word.block))));
            return approaches;
        }
        // The plane is reached before a word is obeyed that stands behind the first approach, and so is a height above it. The way
        // down comes last.
        let goes_up = self.curves[0].control_points_mm.first().is_some_and(|point| point[2] > 0.0);
        approaches[0].axes[0] |= missing[0];
        approaches[0].axes[1] |= missing[1];
        approaches[0].axes[2] |= missing[2] && goes_up;
        if missing[2] && !goes_up {
            let down = Approach { kind: MoveKind::Feed, ..rapid([false, false, true], begin) };
            approaches.insert(own, down);
        }
        approaches
    }

    /// The first word that may switch the tool on: an M other than the tool change, which needs none.
    fn first_switch(&self) -> Option<&Auxiliary> {
        self.auxiliary.iter().find(|word| word.letter == 'M' && word.value != 6.0)
    }
}
