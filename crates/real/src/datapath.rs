//! What a fixed-point datapath does with what its registers cannot hold.

/// What happens to the bits that a result has too many of, in products, quotients, roots and shifts.
///
/// Conversions always go to nearest, as the [`Real`](crate::Real) table says: constants and inputs are not made by the datapath.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Rounding {
    /// To the nearest number; ties up in products and shifts, away from zero in quotients, as `FixedPoint` does.
    #[default]
    Nearest,
    /// To the nearest number, ties to even.
    NearestEven,
    /// Toward -∞: dropping the bits, which takes no adder.
    Floor,
    /// Toward zero.
    TowardZero,
}

impl Rounding {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Nearest, Self::NearestEven, Self::Floor, Self::TowardZero];

    /// The word for it in a format's name; none for the common one.
    pub(crate) fn word(self) -> Option<&'static str> {
        match self {
            Self::Nearest => None,
            Self::NearestEven => Some("even"),
            Self::Floor => Some("floor"),
            Self::TowardZero => Some("zero"),
        }
    }
}

/// What happens to a sum or product that does not fit. Quotients, roots and norms saturate in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Overflow {
    /// The high bits are lost.
    #[default]
    Wrap,
    /// The nearest extreme is taken.
    Saturate,
}

impl Overflow {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Wrap, Self::Saturate];

    /// The word for it in a format's name; none for the common one.
    pub(crate) fn word(self) -> Option<&'static str> {
        match self {
            Self::Wrap => None,
            Self::Saturate => Some("sat"),
        }
    }
}

/// Both. The default is what [`FixedPoint`](crate::FixedPoint) does: to nearest, and wrapping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Datapath {
    /// What happens to the bits below the last.
    pub rounding: Rounding,
    /// What happens to the bits above the first.
    pub overflow: Overflow,
}
