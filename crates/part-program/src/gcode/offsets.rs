//! The zero of coordinates: work offsets, shifts of coordinates, and moves in the coordinates of the machine.
//!
//! | words | meaning |
//! |---|---|
//! | G54 to G59, G59.1 to G59.3 | the work offset in force |
//! | G10 L2, G10 L20 | where the origin of a work offset is, and by how many degrees (R) it turns X and Y; with L20 by the coordinates that the tool has there |
//! | G92, G52 | a shift of the coordinates: G92 gives the tool these coordinates, G52 puts the origin at them |
//! | G92.1, G92.2, G92.3 | the shift forgotten, put aside; the last one that was written and not forgotten |
//! | G28, G30 | a rapid move over a point to a place of the machine's own |
//! | G53 | a move by the coordinates of the machine |
//!
//! A part is in the coordinates in which its first move is written. A program does not give the machine's own zero:
//! after G28, G30 and G53 the places of the axes are unknown until a move names them.
//!
//! # Source
//! LinuxCNC, "G Codes"; FANUC Series 30i, B-63944EN/03, sections 7.2 and 7.4.

use crate::gcode::block::Block;
use crate::gcode::modal::{Motion, WORK_OFFSETS};
use crate::gcode::placing::Placing;
use crate::gcode::preparatory::code;
use crate::gcode::reader::Reader;
use crate::gcode::word::{Key, Word};
use crate::moves::MoveKind;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// The work offset of G54 to G59.3, `index` from 0.
    pub(crate) fn choose_work_offset(&mut self, index: u8, span: Span) {
        if self.is_barred(span, "another work offset") {
            return;
        }
        if index > 0 && !self.known_origins[usize::from(index)] {
            self.report.warning(span, "another work offset: its origin is taken as the first one's");
        }
        self.modal.work_offset = index;
    }

    /// Executes a block whose coordinates are not the end of a move.
    pub(crate) fn place_coordinates(&mut self, block: &mut Block<'_>, placing: Placing, span: Span) {
        let is_of_tools = placing == Placing::SetOffset
            && block
                .words()
                .iter()
                .any(|word| word.key == Key::Letter(b'L') && ![2.0, 20.0].contains(&word.value));
        if placing != Placing::Ignored && !is_of_tools {
            let text = self.report.source.slice(span).to_owned();
            if self.is_barred(span, &format!("`{text}`")) {
                block.clear();
                return;
            }
        }
        match placing {
            Placing::Home => self.home(block, span),
            Placing::MachineCoordinates => self.move_by_machine(block, span),
            Placing::SetOffset => self.set_offset(block, span),
            Placing::SetPosition => {
                self.set_position(block);
                self.kept_shift = self.modal.shift;
            }
            Placing::Shift { adds } => self.shift(block, adds),
            Placing::MoveOrigin => {
                for (axis, value) in block.take_axes().into_iter().enumerate() {
                    self.modal.shift[axis] =
                        value.map_or(self.modal.shift[axis], |value| self.modal.mm(value));
                }
                self.kept_shift = self.modal.shift;
            }
            Placing::Ignored => drop(block.take_axes()),
        }
    }

    /// TRANS and ATRANS: where the zero of the coordinates is, and by how much it is moved on.
    fn shift(&mut self, block: &mut Block<'_>, adds: bool) {
        let written = block.take_axes().map(|value| self.modal.mm(value.unwrap_or(0.0)));
        for (shift, written) in self.modal.shift.iter_mut().zip(written) {
            *shift = if adds { *shift + written } else { written };
        }
    }

    /// Goes to the written point, as fast as the machine can, and from there to an unknown place.
    fn home(&mut self, block: &mut Block<'_>, span: Span) {
        block.take_letter(b'P');
        if self.options.dialect.is_none() {
            // How high a printer raises its tool before.
            block.take_letter(b'R');
        }
        self.modal.settle();
        let written = block.take_axes();
        let is_named = |axis: usize| written[axis].is_some() || self.flags.contains(&b"XYZ"[axis]);
        let names_none = !(0..3).any(is_named);
        let axes: Vec<usize> = (0..3).filter(|axis| names_none || is_named(*axis)).collect();
        let over = self.modal.target(self.modal.here(), written);
        if self.modal.is_lost() {
            self.modal.arrive(written, over);
        } else {
            self.traverse(over, span);
        }
        for axis in axes {
            self.lose(axis);
        }
    }

    /// G53: the places of the axes are then unknown.
    fn move_by_machine(&mut self, block: &mut Block<'_>, span: Span) {
        let written = block.take_axes();
        if self.modal.motion != Motion::Rapid && written != [None; 3] {
            self.report
                .warning(span, "a move at feed by the coordinates of the machine is left out")
                .hint("where the machine's own 0 is, a program does not say");
        }
        for axis in (0..3).filter(|axis| written[*axis].is_some()) {
            self.lose(axis);
        }
    }

    /// From here on the place of an axis is unknown.
    pub(crate) fn lose(&mut self, axis: usize) {
        if self.modal.position[axis].is_some() || self.modal.lost[axis] {
            self.unknown_from[axis] = self.part.curves.len();
        }
        self.modal.forget(axis);
        (self.goes_on, self.off_contour) = (false, None);
    }

    /// A rapid move. An unknown axis takes no part in it, since it begins where it is sent.
    pub(crate) fn traverse(&mut self, end: [f64; 3], span: Span) {
        let start: [f64; 3] = std::array::from_fn(|axis| self.modal.position[axis].unwrap_or(end[axis]));
        for (known, end) in self.modal.position.iter_mut().zip(end) {
            *known = known.map(|_| end);
        }
        if start != end || self.off_contour.is_some() {
            self.push_line([start, end], MoveKind::Rapid, None, span);
        }
    }

    /// G10.
    fn set_offset(&mut self, block: &mut Block<'_>, span: Span) {
        let what = block.take_letter(b'L').map(|word| word.value);
        let number = block.take_letter(b'P').map_or(0.0, |word| word.value);
        let rotation = block.take_letter(b'R');
        match what {
            Some(what @ (2.0 | 20.0)) => {
                let index = if number == 0.0 { Some(self.modal.work_offset) } else { offset_index(number) };
                let Some(index) = index else {
                    self.report
                        .error(span, format!("there is no work offset P{number}"))
                        .expected("P0 to P9");
                    return;
                };
                if let Some(rotation) = rotation {
                    self.modal.work_turns[usize::from(index)] = rotation.value.to_radians();
                }
                self.set_origin(block, index, what == 20.0);
            }
            // Tables of tools.
            Some(what @ (1.0 | 10.0 | 11.0 | 12.0 | 13.0)) => {
                if [1.0, 10.0, 11.0].contains(&what) {
                    self.set_tool_radius(number, rotation);
                }
                block.take_axes();
                for letter in *b"IJQ" {
                    block.take_letter(letter);
                }
            }
            _ => {
                self.report
                    .error(span, "G10 without L2 or L20 sets what is not read")
                    .expected("G10 L2 P1 X0 Y0 Z0");
                block.clear();
            }
        }
    }

    /// Puts the origin of a work offset at the written place, or at the place at which the tool has the written
    /// coordinates.
    fn set_origin(&mut self, block: &mut Block<'_>, index: u8, by_tool: bool) {
        if by_tool && !self.place_is_kept(block) {
            return;
        }
        let index = usize::from(index);
        self.known_origins[index] = true;
        let written = block.take_axes().map(|value| value.map(|value| self.modal.mm(value)));
        let in_force = std::mem::replace(&mut self.modal.work_offset, u8::try_from(index).unwrap_or(0));
        let here = self.modal.here();
        let mut place = self.modal.in_program(here);
        for axis in (0..3).filter(|_| by_tool) {
            place[axis] = written[axis].unwrap_or(place[axis]);
        }
        let off = self.modal.in_part(place);
        for axis in 0..3 {
            let origin = &mut self.modal.work_origins[index][axis];
            match written[axis] {
                _ if by_tool => *origin += here[axis] - off[axis],
                Some(value) if self.modal.incremental => *origin += value,
                Some(value) => *origin = value,
                None => {}
            }
        }
        self.modal.work_offset = in_force;
    }

    /// Whether the place of the tool is known as far as the program gives it: a block that was left out may have moved it.
    fn place_is_kept(&mut self, block: &mut Block<'_>) -> bool {
        let is_lost = (0..3).any(|axis| self.modal.lost[axis] && block.has(b"XYZ"[axis]));
        if is_lost {
            self.report
                .error(
                    block.span,
                    "coordinates are given to a place that is not known, since a block was left out",
                )
                .expected("a move that names these axes before");
            block.clear();
        }
        !is_lost
    }

    /// G92: gives the tool these coordinates at its place.
    fn set_position(&mut self, block: &mut Block<'_>) {
        if !self.place_is_kept(block) {
            return;
        }
        let here = self.modal.in_program(self.modal.here());
        for (axis, value) in block.take_axes().into_iter().enumerate() {
            let Some(value) = value.map(|value| self.modal.mm(value)) else { continue };
            match self.modal.position[axis] {
                Some(_) => self.modal.shift[axis] += here[axis] - value,
                // The first number of an axis gives its place.
                None => {
                    let here = self.modal.origin(axis) + value;
                    self.modal.position[axis] = Some(here);
                    self.modal.begun[axis] = Some(here);
                }
            }
        }
    }

    /// G92.1, G92.2 and G92.3.
    pub(crate) fn change_shift(&mut self, tenths: u16) {
        match tenths {
            921 => (self.modal.shift, self.kept_shift) = ([0.0; 3], [0.0; 3]),
            922 => self.modal.shift = [0.0; 3],
            _ => self.modal.shift = self.kept_shift,
        }
    }

    /// How a G word uses the coordinates of its block, if they are not the end of a move.
    pub(crate) fn placing(&self, block: &Block<'_>, word: Word) -> Option<Placing> {
        match code(word.value)? {
            280 | 300 => Some(Placing::Home),
            530 => Some(Placing::MachineCoordinates),
            100 if block.has(b'L') => Some(Placing::SetOffset),
            920 => Some(Placing::SetPosition),
            520 => Some(Placing::MoveOrigin),
            281 | 301 | 431 | 432 => Some(Placing::Ignored),
            _ => None,
        }
    }
}

/// Index of the work offset that G10 calls P1 to P9.
fn offset_index(number: f64) -> Option<u8> {
    #[allow(clippy::cast_possible_truncation, reason = "9")]
    (1..=WORK_OFFSETS as u8).find(|index| f64::from(*index) == number).map(|index| index - 1)
}
