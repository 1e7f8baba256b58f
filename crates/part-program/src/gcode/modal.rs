//! Modal state of a program: what holds until another word changes it.

use crate::arc::Plane;
use crate::exact_stops::PathMode;
use crate::gcode::cycle::Cycle;
use crate::unit::INCH;

/// Work offsets: G54 to G59, G59.1 to G59.3.
pub(crate) const WORK_OFFSETS: usize = 9;

/// The motion in force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Motion {
    /// None yet, or cancelled.
    #[default]
    None,
    /// G0.
    Rapid,
    /// G1.
    Line,
    /// G2, G3.
    Arc { clockwise: bool },
    /// G06.2.
    FanucNurbs,
    /// G5.
    Cubic,
    /// G5.1.
    Quadratic,
    /// G5.2.
    LinuxCncNurbs,
    /// BSPLINE.
    Bspline,
    /// G73 to G89.
    Cycle(Cycle),
    /// G33, and G33.1, which comes back: along an axis with the spindle.
    WithSpindle { comes_back: bool },
    /// Another motion that is not read, and was read over.
    Unread,
    /// A motion whose first block is wrong, as has been said: the blocks that go on with it are passed over.
    Broken,
}

impl Motion {
    /// Whether it makes splines.
    pub(crate) fn is_spline(self) -> bool {
        matches!(self, Self::FanucNurbs | Self::Cubic | Self::Quadratic | Self::LinuxCncNurbs | Self::Bspline)
    }

    /// What messages call it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None | Self::Broken => "a block without a motion",
            Self::Rapid => "G0",
            Self::Line => "G1",
            Self::Arc { clockwise: true } => "G2",
            Self::Arc { clockwise: false } => "G3",
            Self::FanucNurbs => "G06.2",
            Self::Cubic => "G5",
            Self::Quadratic => "G5.1",
            Self::LinuxCncNurbs => "G5.2",
            Self::Bspline => "BSPLINE",
            Self::Cycle(_) => "a drilling cycle",
            Self::WithSpindle { .. } => "G33",
            Self::Unread => "a motion that is not read",
        }
    }

    /// The words that its blocks may have.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::None | Self::Unread | Self::Broken => "G, F, M, S, T, D or H",
            Self::Rapid | Self::Line => "X, Y, Z or F",
            Self::Arc { .. } => "X, Y, Z, I, J, K, R or F",
            Self::FanucNurbs => "K, X, Y, Z, R, P or F",
            Self::Cubic => "X, Y, I, J, P, Q or F",
            Self::Quadratic => "X, Y, I, J or F",
            Self::LinuxCncNurbs => "X, Y, P, L or F",
            Self::Bspline => "X, Y, Z, SD=, PW=, PL= or F",
            Self::Cycle(_) => "X, Y, Z, R, Q, P, L or F",
            Self::WithSpindle { .. } => "X, Y, Z or K",
        }
    }
}

/// What F means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum FeedMode {
    /// G94: length a minute.
    #[default]
    PerMinute,
    /// G93: 1/F minutes a move.
    InverseTime,
    /// G95: length a revolution of the spindle.
    PerRevolution,
}

/// What holds until another word changes it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Modal {
    pub(crate) motion: Motion,
    pub(crate) plane: Plane,
    /// G91: coordinates count from the current position.
    pub(crate) incremental: bool,
    /// G90.1: arc centres are coordinates, not distances from the start.
    pub(crate) absolute_centres: bool,
    /// G20.
    pub(crate) inches: bool,
    pub(crate) feed_mode: FeedMode,
    pub(crate) path_mode: PathMode,
    /// Feedrate of G94, in mm/s.
    pub(crate) feedrate_mm_per_s: Option<f64>,
    /// Feed of G95, in mm a revolution.
    pub(crate) feed_mm_per_revolution: Option<f64>,
    /// S, in revolutions a minute.
    pub(crate) spindle_per_minute: Option<f64>,
    /// Where the tool is, in mm of the part; an axis that was never named is unknown, and one that a word moved that is not read.
    pub(crate) position: [Option<f64>; 3],
    /// The work offset in force, from 0 for G54.
    pub(crate) work_offset: u8,
    /// Origins of the work offsets in the part, in mm; 0 for those that no G10 has set.
    pub(crate) work_origins: [[f64; 3]; WORK_OFFSETS],
    /// By which angle each work offset turns X and Y about its origin, in rad.
    pub(crate) work_turns: [f64; WORK_OFFSETS],
    /// Where 0 of the part is, by the coordinates that no offset has shifted, in mm, and by which angle the part is turned there, in rad.
    base: ([f64; 3], f64),
    /// Whether a move has been made, so that the part has its coordinates.
    is_settled: bool,
    /// What G92 and G52 add to them, in mm.
    pub(crate) shift: [f64; 3],
    /// Where an axis that is unknown is taken to be; 0 if it was never known.
    last_known: [f64; 3],
    /// Axes that incremental words moved from where they were taken to be.
    pub(crate) from_unknown: [bool; 3],
    /// Where axes begin that have been named since this was last asked, and were unknown before.
    pub(crate) begun: [Option<f64>; 3],
}

impl Modal {
    /// Millimetres of a length word.
    pub(crate) fn mm(&self, length: f64) -> f64 {
        if self.inches { length * INCH } else { length }
    }

    /// The position in numbers; coordinates that were never known are 0.
    pub(crate) fn here(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.position[axis].unwrap_or(self.last_known[axis]))
    }

    /// Gives the part the coordinates in which its first move is written: what shifts and turns them later, does so in these.
    pub(crate) fn settle(&mut self) {
        if std::mem::replace(&mut self.is_settled, true) {
            return;
        }
        let here = self.in_program(self.here());
        for (known, here) in self.position.iter_mut().zip(here) {
            *known = known.map(|_| here);
        }
        let shift = turned_by(self.turn(), self.shift);
        self.base = (std::array::from_fn(|axis| self.work_origin(axis) + shift[axis]), self.turn());
    }

    fn work_origin(&self, axis: usize) -> f64 {
        self.work_origins.get(usize::from(self.work_offset)).map_or(0.0, |origin| origin[axis])
    }

    /// Where 0 of an axis, as the program counts, is in the part, in mm, while nothing is turned.
    pub(crate) fn origin(&self, axis: usize) -> f64 {
        self.work_origin(axis) + self.shift[axis] - self.base.0[axis]
    }

    /// Whether the axes of the program are turned against those of the part, or the part's own are.
    fn is_turned(&self) -> bool {
        self.turn() != 0.0 || self.base.1 != 0.0
    }

    /// By which angle the work offset in force turns X and Y, in rad.
    fn turn(&self) -> f64 {
        self.work_turns.get(usize::from(self.work_offset)).copied().unwrap_or(0.0)
    }

    /// A distance along the axes of the program, in mm, along those of the part.
    pub(crate) fn turned(&self, distance: [f64; 3]) -> [f64; 3] {
        turned_by(self.turn() - self.base.1, distance)
    }

    /// Where a place of the program is in the part, both in mm.
    pub(crate) fn in_part(&self, place: [f64; 3]) -> [f64; 3] {
        if !self.is_turned() {
            return std::array::from_fn(|axis| self.origin(axis) + place[axis]);
        }
        let turned = turned_by(self.turn(), std::array::from_fn(|axis| place[axis] + self.shift[axis]));
        let (base, angle) = self.base;
        turned_by(-angle, std::array::from_fn(|axis| self.work_origin(axis) - base[axis] + turned[axis]))
    }

    /// Where a place of the part is in the program, both in mm.
    pub(crate) fn in_program(&self, place: [f64; 3]) -> [f64; 3] {
        if !self.is_turned() {
            return std::array::from_fn(|axis| place[axis] - self.origin(axis));
        }
        let (base, angle) = self.base;
        let turned = turned_by(angle, place);
        let off = std::array::from_fn(|axis| turned[axis] + base[axis] - self.work_origin(axis));
        let straight = turned_by(-self.turn(), off);
        std::array::from_fn(|axis| straight[axis] - self.shift[axis])
    }

    /// Where the tool is on an axis, as the program counts and in its unit.
    pub(crate) fn programmed(&self, axis: usize) -> f64 {
        self.in_program(self.here())[axis] / self.mm(1.0)
    }

    /// Where coordinates as written lead from `from`: those not written are kept.
    pub(crate) fn target(&self, from: [f64; 3], written: [Option<f64>; 3]) -> [f64; 3] {
        if self.is_turned() && written != [None; 3] {
            let here = self.in_program(from);
            return self.in_part(std::array::from_fn(|axis| match written[axis] {
                Some(value) if self.incremental => here[axis] + self.mm(value),
                Some(value) => self.mm(value),
                None => here[axis],
            }));
        }
        std::array::from_fn(|axis| match written[axis] {
            Some(value) if self.incremental => from[axis] + self.mm(value),
            Some(value) => self.origin(axis) + self.mm(value),
            None => from[axis],
        })
    }

    /// Start of a move to `target`: an axis whose position is unknown starts where it is sent; in G91 it moves by what is
    /// written wherever it starts.
    pub(crate) fn start(&self, target: [f64; 3]) -> [f64; 3] {
        let unknown = |axis: usize| if self.incremental { self.last_known[axis] } else { target[axis] };
        std::array::from_fn(|axis| self.position[axis].unwrap_or_else(|| unknown(axis)))
    }

    /// Brings the axes that are written to `target`.
    pub(crate) fn arrive(&mut self, mut written: [Option<f64>; 3], target: [f64; 3]) {
        if self.is_turned() {
            let either = written[0].or(written[1]);
            (written[0], written[1]) = (either, either);
        }
        for axis in (0..3).filter(|axis| written[*axis].is_some()) {
            if self.position[axis].is_none() {
                self.from_unknown[axis] = self.incremental;
                self.begun[axis] = Some(target[axis]).filter(|_| !self.incremental);
            }
            self.position[axis] = Some(target[axis]);
        }
    }

    /// Forgets where an axis is.
    pub(crate) fn forget(&mut self, axis: usize) {
        self.last_known[axis] = self.here()[axis];
        (self.position[axis], self.from_unknown[axis]) = (None, false);
    }
}

/// A distance, turned about Z.
fn turned_by(angle: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    if angle == 0.0 {
        return [x, y, z];
    }
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos, z]
}
