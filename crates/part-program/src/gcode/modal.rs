//! Modal state of a program: settings that hold until another word changes them.

use crate::arc::Plane;
use crate::exact_stops::PathMode;
use crate::gcode::cycle::Cycle;
use crate::gcode::word::Key;
use crate::unit::INCH;

/// Work offsets: G54 to G59, G59.1 to G59.3.
pub(crate) const WORK_OFFSETS: usize = 9;

/// The share of a coordinate that turning it may round.
const ROUNDING: f64 = 1e-14;

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
    /// CIP.
    ThroughPoint,
    /// CT.
    Tangent,
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
    /// Another motion that is not read, and was skipped.
    Unread,
    /// A motion whose first block is wrong, which has been reported. The blocks that continue it are skipped.
    Broken,
}

impl Motion {
    /// Whether it makes splines.
    pub(crate) fn is_spline(self) -> bool {
        matches!(self, Self::FanucNurbs | Self::Cubic | Self::Quadratic | Self::LinuxCncNurbs | Self::Bspline)
    }

    /// Its curve, in messages.
    pub(crate) fn kind(self) -> &'static str {
        if self.is_spline() { "spline" } else { "curve" }
    }

    /// Its name in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None | Self::Broken => "a block without a motion",
            Self::Rapid => "G0",
            Self::Line => "G1",
            Self::Arc { clockwise: true } => "G2",
            Self::Arc { clockwise: false } => "G3",
            Self::ThroughPoint => "CIP",
            Self::Tangent => "CT",
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

    /// Whether a letter, or a name, that this motion does not know may be passed over without another path: corners,
    /// angles and turns are written in words of blocks.
    pub(crate) fn may_lack(self, key: Key) -> bool {
        match self {
            Self::Rapid | Self::Line => matches!(key, Key::Letter(b'P' | b'Q' | b'L' | b'H' | b'D')),
            Self::Arc { .. }
            | Self::ThroughPoint
            | Self::Tangent
            | Self::Cycle(_)
            | Self::WithSpindle { .. } => false,
            _ => true,
        }
    }

    /// Whether it knows a word.
    pub(crate) fn takes(self, key: Key) -> bool {
        let letters: &[u8] = match self {
            Self::Arc { .. } => b"IJKRP",
            Self::Cycle(_) => b"RQPLKIJ",
            Self::WithSpindle { .. } => b"K",
            _ => b"",
        };
        match key {
            Key::Letter(letter) => b"XYZ@^".contains(&letter) || letters.contains(&letter),
            Key::CornerRadius | Key::CornerDistance | Key::Chamfer => self == Self::Line,
            Key::CircleRadius | Key::Turns | Key::ArcAngle => matches!(self, Self::Arc { .. }),
            Key::Middle(_) => self == Self::ThroughPoint,
            _ => false,
        }
    }

    /// The words that its blocks may have.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::None | Self::Unread | Self::Broken => "G, F, M, S, T, D or H",
            Self::Rapid | Self::Line => "X, Y, Z or F",
            Self::Arc { .. } => "X, Y, Z, I, J, K, R or F",
            Self::ThroughPoint => "X, Y, Z, I1=, J1=, K1= or F",
            Self::Tangent => "X, Y, Z or F",
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

/// The meaning of F.
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

/// Settings that hold until another word changes them.
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
    /// Whether F counts inches. G70 and G71 change the unit of lengths alone.
    pub(crate) feed_in_inches: bool,
    pub(crate) feed_mode: FeedMode,
    pub(crate) path_mode: PathMode,
    /// Feedrate of G94, in mm/s.
    pub(crate) feedrate_mm_per_s: Option<f64>,
    /// Feed of G95, in mm a revolution.
    pub(crate) feed_mm_per_revolution: Option<f64>,
    /// G96: S is no number of revolutions.
    pub(crate) keeps_cut_speed: bool,
    /// S, in revolutions a minute.
    pub(crate) spindle_per_minute: Option<f64>,
    /// The place of the tool, in mm of the part. It is unknown for an axis that was never named, and for one that was
    /// moved by a word that is not read.
    pub(crate) position: [Option<f64>; 3],
    /// The work offset in force, from 0 for G54.
    pub(crate) work_offset: u8,
    /// Origins of the work offsets in the part, in mm; 0 for those that no G10 has set.
    pub(crate) work_origins: [[f64; 3]; WORK_OFFSETS],
    /// The angle by which each work offset turns X and Y about its origin, in rad.
    pub(crate) work_turns: [f64; WORK_OFFSETS],
    /// The part's zero in the coordinates that no offset has shifted, in mm, and the angle by which the part is turned
    /// there, in rad.
    base: ([f64; 3], f64),
    /// Whether a move has been made, so that the part has its coordinates.
    is_settled: bool,
    /// The shift that G92 and G52 add to the coordinates, in mm.
    pub(crate) shift: [f64; 3],
    /// The assumed place of an axis that is unknown; 0 if it was never known.
    last_known: [f64; 3],
    /// Axes that incremental words moved from their assumed places.
    pub(crate) from_unknown: [bool; 3],
    /// Axes whose place a block that was left out has changed: nothing moves until all of them are named.
    pub(crate) lost: [bool; 3],
    /// The first places of axes that were unknown and have been named since this was last read.
    pub(crate) begun: [Option<f64>; 3],
}

impl Modal {
    /// Millimetres of a length word.
    pub(crate) fn mm(&self, length: f64) -> f64 {
        if self.inches { length * INCH } else { length }
    }

    /// Millimetres of the unit of F.
    pub(crate) fn feed_unit_mm(&self) -> f64 {
        if self.feed_in_inches { INCH } else { 1.0 }
    }

    /// The position in numbers; coordinates that were never known are 0.
    pub(crate) fn here(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.position[axis].unwrap_or(self.last_known[axis]))
    }

    /// Gives the part the coordinates in which its first move is written. Later shifts and turns are made in these
    /// coordinates.
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

    /// The zero of the program's coordinate of an axis, in mm of the part, if the axes of both are parallel.
    pub(crate) fn origin(&self, axis: usize) -> f64 {
        let (base, angle) = self.base;
        if angle == 0.0 {
            return self.work_origin(axis) + self.shift[axis] - base[axis];
        }
        let off = std::array::from_fn(|axis| self.work_origin(axis) - base[axis]);
        turned_by(-angle, off)[axis] + self.shift[axis]
    }

    /// Whether the program's axes are turned against those of the part.
    fn is_turned(&self) -> bool {
        self.turn() != self.base.1
    }

    /// The angle by which the work offset in force turns X and Y, in rad.
    fn turn(&self) -> f64 {
        self.work_turns.get(usize::from(self.work_offset)).copied().unwrap_or(0.0)
    }

    /// Turns a distance along the axes of the program, in mm, to the axes of the part.
    pub(crate) fn turned(&self, distance: [f64; 3]) -> [f64; 3] {
        turned_by(self.turn() - self.base.1, distance)
    }

    /// The place in the part of a place in the program, both in mm.
    pub(crate) fn in_part(&self, place: [f64; 3]) -> [f64; 3] {
        if !self.is_turned() {
            return std::array::from_fn(|axis| self.origin(axis) + place[axis]);
        }
        let turned = turned_by(self.turn(), std::array::from_fn(|axis| place[axis] + self.shift[axis]));
        let (base, angle) = self.base;
        turned_by(-angle, std::array::from_fn(|axis| self.work_origin(axis) - base[axis] + turned[axis]))
    }

    /// The place in the program of a place in the part, both in mm.
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

    /// The tool's place on an axis, in the program's coordinates and unit.
    pub(crate) fn programmed(&self, axis: usize) -> f64 {
        self.in_program(self.here())[axis] / self.mm(1.0)
    }

    /// The end of a move from `from` with these coordinates; missing ones are kept.
    pub(crate) fn target(&self, from: [f64; 3], written: [Option<f64>; 3]) -> [f64; 3] {
        if self.is_turned() && written != [None; 3] {
            let here = self.in_program(from);
            let there: [f64; 3] = std::array::from_fn(|axis| match written[axis] {
                Some(value) if self.incremental => here[axis] + self.mm(value),
                Some(value) => self.mm(value),
                None => here[axis],
            });
            // What is turned forth and back is off by its rounding, which is no move.
            let stays =
                |axis: usize| (there[axis] - here[axis]).abs() <= ROUNDING * here[axis].abs().max(1.0);
            return if (0..3).all(stays) { from } else { self.in_part(there) };
        }
        std::array::from_fn(|axis| match written[axis] {
            Some(value) if self.incremental => from[axis] + self.mm(value),
            Some(value) => self.origin(axis) + self.mm(value),
            None => from[axis],
        })
    }

    /// Start of a move to `target`. An axis whose position is unknown starts where it is sent. In G91 it moves by the
    /// written distance, wherever it starts.
    pub(crate) fn start(&self, target: [f64; 3]) -> [f64; 3] {
        let unknown = |axis: usize| if self.incremental { self.last_known[axis] } else { target[axis] };
        std::array::from_fn(|axis| self.position[axis].unwrap_or_else(|| unknown(axis)))
    }

    /// Moves the axes with a coordinate to `target`.
    pub(crate) fn arrive(&mut self, mut written: [Option<f64>; 3], target: [f64; 3]) {
        let named = [written[0].is_some(), written[1].is_some()];
        if self.is_turned() {
            let either = written[0].or(written[1]);
            (written[0], written[1]) = (either, either);
        }
        for axis in (0..3).filter(|axis| written[*axis].is_some()) {
            if self.lost[axis] {
                if self.incremental || self.is_half_known(axis, named) {
                    continue;
                }
                self.lost[axis] = false;
            } else if self.position[axis].is_none() {
                self.from_unknown[axis] = self.incremental;
                self.begun[axis] = Some(target[axis]).filter(|_| !self.incremental);
            }
            self.position[axis] = Some(target[axis]);
        }
    }

    /// Whether the place of an axis in the part depends on a coordinate that is lost and not named.
    fn is_half_known(&self, axis: usize, named: [bool; 2]) -> bool {
        axis < 2 && self.is_turned() && named != [true; 2]
    }

    /// Whether where the tool is is not known, because a block was left out.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost != [false; 3]
    }

    /// Forgets the place of an axis that a block which is left out may have moved.
    pub(crate) fn lose_track(&mut self, axis: usize) {
        self.forget(axis);
        self.lost[axis] = true;
    }

    /// Forgets the place of an axis.
    pub(crate) fn forget(&mut self, axis: usize) {
        self.last_known[axis] = self.here()[axis];
        (self.position[axis], self.from_unknown[axis], self.lost[axis]) = (None, false, false);
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
