//! How to read a text if its content does not tell.

use std::fmt;
use std::str::FromStr;

/// Options of a reader. By default it finds out the dialect and refuses unknown words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The control that a program is for. `None`: told by its splines, its O-words, macros and variables, where it has such.
    pub dialect: Option<Dialect>,
    /// Skip unknown words, with a warning each. A block with a word that is not read is left out. The places of its axes, and behind
    /// a name, a call or a G word that no table has those of all axes, are then unknown, and nothing moves until words in G90 have
    /// named them again. After a motion that is not read, no axes are moved until a motion that is read; after a word that turns or
    /// scales coordinates, or changes what moves mean, none is until it ends. Other G words of the block, F, M, S, T, D and H hold.
    /// What moves is so a part of what the control moves.
    pub lenient: bool,
    /// The place of the tool when a program begins, in mm. `None`: an axis begins where it is first sent.
    pub start_mm: Option<[f64; 3]>,
    /// The unit of a program's lengths until a word names one, and of a drawing that names none. `None`: millimetres, and if no word names one,
    /// [`Part::assumed_unit`](crate::Part::assumed_unit) says so.
    pub unit: Option<Unit>,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// The millimetre.
    Millimetre,
    /// The inch, 25.4 mm.
    Inch,
}

impl Unit {
    /// Every unit.
    pub const ALL: [Self; 2] = [Self::Millimetre, Self::Inch];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Inch => "inch",
        }
    }
}

/// A control, by the words of its splines, or by what its interpreter prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// `G06.2 P K X Y Z R`.
    Fanuc,
    /// `G5.2 X Y P L` … `G5.3`, and `G5`, `G5.1`.
    LinuxCnc,
    /// `BSPLINE` with `SD=`, `PW=` and `PL=`.
    Siemens,
    /// What LinuxCNC's interpreter `rs274` prints of a program: `STRAIGHT_FEED(…)`, `ARC_FEED(…)`. It is read, and never written.
    Canon,
}

impl Dialect {
    /// Every dialect.
    pub const ALL: [Self; 4] = [Self::Fanuc, Self::LinuxCnc, Self::Siemens, Self::Canon];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fanuc => "fanuc",
            Self::LinuxCnc => "linuxcnc",
            Self::Siemens => "siemens",
            Self::Canon => "canon",
        }
    }

    /// The dialect in which the program of a part is written that was read in this one.
    #[must_use]
    pub fn written(self) -> Self {
        if self == Self::Canon { Self::LinuxCnc } else { self }
    }
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Dialect {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|dialect| dialect.name().eq_ignore_ascii_case(name));
        named.ok_or_else(|| format!("`{name}` is no dialect: expected fanuc, linuxcnc, siemens or canon"))
    }
}

impl FromStr for Unit {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|unit| unit.name().eq_ignore_ascii_case(name));
        named.ok_or_else(|| format!("`{name}` is no unit of a program: expected mm or inch"))
    }
}
