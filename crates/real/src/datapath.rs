//! How a fixed-point datapath rounds, and what it does on overflow.

/// How the datapath drops the bits below the last place, in products, quotients, roots and shifts.
///
/// Conversions always round to nearest, as the [`Real`](crate::Real) table says: the datapath does not make constants
/// and inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Rounding {
    /// To the nearest number; ties up in products and shifts, away from zero in quotients, as `FixedPoint` does.
    #[default]
    Nearest,
    /// To the nearest number, ties to even.
    NearestEven,
    /// Toward -∞: the datapath drops the bits, which takes no adder.
    Floor,
    /// Toward zero.
    TowardZero,
}

impl Rounding {
    /// All four ways of rounding.
    pub const ALL: [Self; 4] = [Self::Nearest, Self::NearestEven, Self::Floor, Self::TowardZero];

    /// The word for it in a format's name; `None` for the default, which a name leaves out.
    pub(crate) fn word(self) -> Option<&'static str> {
        match self {
            Self::Nearest => None,
            Self::NearestEven => Some("even"),
            Self::Floor => Some("floor"),
            Self::TowardZero => Some("zero"),
        }
    }
}

/// Whether a sum or product that does not fit wraps or saturates. Quotients, roots and norms always saturate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Overflow {
    /// The high bits are lost.
    #[default]
    Wrap,
    /// The nearest extreme is taken.
    Saturate,
}

impl Overflow {
    /// Both ways.
    pub const ALL: [Self; 2] = [Self::Wrap, Self::Saturate];

    /// The word for it in a format's name; `None` for the default, which a name leaves out.
    pub(crate) fn word(self) -> Option<&'static str> {
        match self {
            Self::Wrap => None,
            Self::Saturate => Some("sat"),
        }
    }
}

/// How a datapath rounds and what it does on overflow. The default is that of [`FixedPoint`](crate::FixedPoint): it
/// rounds to nearest and wraps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Datapath {
    /// How bits below the last place are dropped.
    pub rounding: Rounding,
    /// What happens to bits above the first place.
    pub overflow: Overflow,
}
