//! Drilling cycles as their moves.
//!
//! | word | what it does at each place |
//! |---|---|
//! | G81 | feeds to Z, and is back as fast as the machine can |
//! | G82 | rests at Z before |
//! | G83, G73 | feeds by Q at a time; G83 comes back to R in between, G73 by [`CLEARANCE_MM`] |
//! | G84, G74 | taps: feeds to Z, and back to R at feed, of LinuxCNC to where it stays |
//! | G85, G89 | bores: as G84; G89 rests at Z |
//! | G86, G88, FANUC's G76 | bore: the spindle stops at Z; G88 rests there, too |
//!
//! If the tool is below R, it first goes to R. Then it goes to the place, and to R above it. After the cycle it goes to
//! R (G99), or to the height that it had when the first cycle began (G98). LinuxCNC begins with G99, other controls
//! with G98. L (FANUC's K) repeats the block.
//!
//! # Source
//! LinuxCNC, "Canned Cycles", and the moves that its `rs274` prints; FANUC Series 30i, B-63944EN/03, section 13.1.

use domains::shown;
use domains::words::REPEATS;

use crate::arc::Plane;
use crate::curve::MAX_COORDINATE_MM;
use crate::gcode::block::Block;
use crate::gcode::cycle::Cycle;
use crate::gcode::modal::FeedMode;
use crate::gcode::reader::Reader;
use crate::moves::MoveKind;
use crate::options::Dialect;
use crate::source::Span;

/// How far G73 retracts, and how far above the bottom G83 begins to feed again, in mm: LinuxCNC's 0.010 inch.
pub(crate) const CLEARANCE_MM: f64 = 0.254;
/// Most steps of one hole: a larger number is a typing error.
const MAX_STEPS: f64 = 10_000.0;

/// The heights of one hole, in mm.
struct Heights {
    retract: f64,
    bottom: f64,
    clear: f64,
}

impl Reader<'_, '_, '_> {
    /// Drills at each place of a block.
    pub(crate) fn drill(&mut self, block: &mut Block<'_>, cycle: Cycle) {
        let span = block.span;
        if self.modal.feed_mode == FeedMode::InverseTime {
            self.report
                .of_kind(
                    true,
                    span,
                    "G93",
                    "a drilling cycle in inverse time feed, G93: one F is no time of its moves",
                )
                .expected("G94 before the cycle");
            self.pass_over(block);
            return;
        }
        if cycle == Cycle::Tap
            && self.options.dialect == Some(Dialect::LinuxCnc)
            && self.modal.plane != Plane::Xy
        {
            let message = "LinuxCNC 2.9 takes other axes than the cycle names when it taps in G18 and G19: it is read as it is written";
            self.report.of_kind(false, span, "tap", message).hint("tap in G17, or with G33.1");
        }
        let [first, second, normal] = self.modal.plane.axes();
        let mut written = block.take_axes();
        let polar = [block.take_letter(b'@'), block.take_letter(b'^')];
        let height = written[normal].take();
        let repeats = self.repeats(block);
        block.take_letter(b'P');
        for letter in *b"IJ" {
            block.take_letter(letter);
        }
        self.holes.keep(height, block);
        let Some(heights) = self.heights(normal, span) else { return };
        let mut place = self.modal.here();
        for _ in 0..repeats {
            self.polar(polar, place, &mut written);
            let next = self.modal.target(place, written);
            (place[first], place[second]) = (next[first], next[second]);
            if place.iter().any(|x| x.abs() > MAX_COORDINATE_MM) {
                self.report
                    .error(span, "a hole is out of range")
                    .expected(format!("coordinates within ±{MAX_COORDINATE_MM:e} mm"));
                return;
            }
            if self.is_full() {
                return;
            }
            self.hole(cycle, [place[first], place[second]], &heights, span);
        }
    }

    /// The number of times that a block is executed: L, or K of FANUC.
    fn repeats(&mut self, block: &mut Block<'_>) -> u32 {
        let word = match self.options.dialect {
            Some(Dialect::LinuxCnc) => block.take_letter(b'L'),
            _ => block.take_letter(b'L').or_else(|| block.take_letter(b'K')),
        };
        let Some(word) = word else { return 1 };
        if !REPEATS.holds(word.value) {
            self.report
                .error(word.span, format!("a cycle that is repeated {} times", shown(word.value)))
                .expected(REPEATS.expected());
            return 0;
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "within the domain of a u32"
        )]
        let repeats = word.value as u32;
        repeats
    }

    /// The heights of the holes of a block. Missing and wrong numbers are reported.
    fn heights(&mut self, normal: usize, span: Span) -> Option<Heights> {
        let letter = ["X", "Y", "Z"][normal];
        let (Some(bottom), Some(retract)) = (self.holes.bottom, self.holes.retract) else {
            let missing = if self.holes.bottom.is_none() { letter } else { "R" };
            self.report
                .of_kind(true, span, missing, format!("a cycle without {missing}"))
                .expected("the bottom of the hole, and R above it");
            return None;
        };
        let here = self.modal.position[normal];
        let (bottom, retract) = (self.modal.mm(bottom), self.modal.mm(retract));
        let (retract, bottom) = if self.modal.incremental {
            // From the height at which the first cycle began.
            let retract = self.holes.begin_mm.or(here).unwrap_or(0.0) + retract;
            (retract, retract + bottom)
        } else {
            let origin = self.modal.origin(normal);
            (origin + retract, origin + bottom)
        };
        if bottom > retract || [bottom, retract].iter().any(|height| height.abs() > MAX_COORDINATE_MM) {
            let message = format!("the hole ends at {bottom:.4} mm, and begins at {retract:.4} mm");
            self.report.error(span, message).expected("a bottom below R");
            return None;
        }
        let begin = *self.holes.begin_mm.get_or_insert(here.unwrap_or(retract));
        let is_linuxcnc = self.options.dialect == Some(Dialect::LinuxCnc);
        let clear =
            if self.holes.returns_to_begin.unwrap_or(!is_linuxcnc) { begin.max(retract) } else { retract };
        Some(Heights { retract, bottom, clear })
    }

    /// One hole at a place of the plane.
    fn hole(&mut self, cycle: Cycle, place: [f64; 2], heights: &Heights, span: Span) {
        let [first, second, normal] = self.modal.plane.axes();
        let Heights { retract, bottom, clear } = *heights;
        let mut at = self.modal.here();
        if self.modal.position[normal].is_none_or(|height| height < retract) {
            at[normal] = retract;
            self.hole_move(at, MoveKind::Rapid, span);
        }
        (at[first], at[second]) = (place[0], place[1]);
        self.hole_move(at, MoveKind::Rapid, span);
        let mut go = |reader: &mut Self, height: f64, kind: MoveKind| {
            at[normal] = height;
            reader.hole_move(at, kind, span);
        };
        go(self, retract, MoveKind::Rapid);
        if let Cycle::Peck { leaves_the_hole } = cycle {
            let step = self.holes.step.map(|step| self.modal.mm(step)).filter(|step| *step > 0.0);
            let Some(step) = step.filter(|step| (retract - bottom) / step <= MAX_STEPS) else {
                self.report
                    .error(span, "a cycle in steps without their depth")
                    .expected("Q, the depth of each step");
                return;
            };
            let mut depth = retract - step;
            while depth > bottom {
                go(self, depth, MoveKind::Feed);
                if leaves_the_hole {
                    go(self, retract, MoveKind::Rapid);
                }
                let above = (depth + CLEARANCE_MM).min(retract);
                go(self, above, MoveKind::Rapid);
                depth -= step;
            }
        }
        go(self, bottom, MoveKind::Feed);
        match cycle {
            Cycle::Tap | Cycle::Bore { .. } => {
                self.rest();
                let is_linuxcnc = self.options.dialect == Some(Dialect::LinuxCnc);
                let feeds_to_the_end = is_linuxcnc && cycle != Cycle::Bore { rests: false };
                go(self, if feeds_to_the_end { clear } else { retract }, MoveKind::Feed);
            }
            Cycle::Drill | Cycle::DrillAndRest | Cycle::Peck { .. } | Cycle::BoreAndStop => self.rest(),
        }
        go(self, clear, MoveKind::Rapid);
    }

    /// A straight move of a cycle. If an axis is unknown, the move begins at the place to which it is sent.
    fn hole_move(&mut self, end: [f64; 3], kind: MoveKind, span: Span) {
        let start: [f64; 3] = std::array::from_fn(|axis| self.modal.position[axis].unwrap_or(end[axis]));
        let names = end.map(Some);
        let is_incremental = std::mem::replace(&mut self.modal.incremental, false);
        self.modal.arrive(names, end);
        self.modal.incremental = is_incremental;
        self.begin_axes();
        if start != end {
            self.push_line([start, end], kind, None, span);
        }
    }
}
