//! Drilling cycles: their kinds, and the values that they keep from block to block.

use crate::gcode::block::Block;

/// A cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cycle {
    Drill,
    DrillAndRest,
    Peck { leaves_the_hole: bool },
    Tap,
    Bore { rests: bool },
    BoreAndStop,
}

impl Cycle {
    /// The cycle whose G number times ten is given.
    pub(crate) fn of(tenths: u16) -> Option<Self> {
        Some(match tenths {
            810 => Self::Drill,
            820 => Self::DrillAndRest,
            830 => Self::Peck { leaves_the_hole: true },
            730 => Self::Peck { leaves_the_hole: false },
            840 | 740 => Self::Tap,
            850 => Self::Bore { rests: false },
            890 => Self::Bore { rests: true },
            760 | 860 | 880 => Self::BoreAndStop,
            _ => return None,
        })
    }
}

/// The values that cycles keep from block to block.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Holes {
    /// Z as the program writes it, R and Q.
    pub(crate) bottom: Option<f64>,
    pub(crate) retract: Option<f64>,
    pub(crate) step: Option<f64>,
    /// The height at which the first cycle began, in mm.
    pub(crate) begin_mm: Option<f64>,
    /// G98 or G99, if one was written.
    pub(crate) returns_to_begin: Option<bool>,
}

impl Holes {
    /// Keeps the values that a block gives; the bottom as the program writes it.
    pub(crate) fn keep(&mut self, bottom: Option<f64>, block: &mut Block<'_>) {
        self.bottom = bottom.or(self.bottom);
        self.retract = block.take_letter(b'R').map(|word| word.value).or(self.retract);
        self.step = block.take_letter(b'Q').map(|word| word.value).or(self.step);
    }

    /// Forgets all values but G98 and G99, when a cycle ends.
    pub(crate) fn end(&mut self) {
        *self = Self { returns_to_begin: self.returns_to_begin, ..Self::default() };
    }
}
