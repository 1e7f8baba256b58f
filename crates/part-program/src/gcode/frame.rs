//! Frames of coordinates, and meanings of moves, that are not read.

use crate::gcode::unread_names::Ender;

/// What ends a frame of coordinates, or another meaning of moves, that is not read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Frame {
    /// Ten times the numbers of these G words.
    Until(&'static [u16]),
    /// What ends the meaning that a name of Siemens gave.
    UntilName(Ender),
    /// A frame of Siemens, which replaces it.
    UntilReplaced,
    /// Coordinates on a cylinder: its own word with no angle, or 0.
    UntilNoCylinder,
    /// Nothing: where the zero of the coordinates is cannot be told.
    ForEver,
}

/// The frames that are in force and are not read. Each lasts until its own end, whatever ends another.
#[derive(Clone, Debug, Default)]
pub(crate) struct Frames(Vec<Frame>);

impl Frames {
    pub(crate) fn are_in_force(&self) -> bool {
        !self.0.is_empty()
    }

    /// A frame begins. One that is in force already begins no second time: one end is enough for it.
    pub(crate) fn open(&mut self, frame: Frame) {
        if !self.0.contains(&frame) {
            self.0.push(frame);
        }
    }

    /// Ends the frames for which this holds.
    pub(crate) fn end(&mut self, ends: impl Fn(Frame) -> bool) {
        self.0.retain(|frame| !ends(*frame));
    }
}
