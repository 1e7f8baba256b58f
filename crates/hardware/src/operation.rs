//! Operations on registers.

/// A register of 64 bits, before registers are dealt out.
pub(crate) type Register = u32;

/// What an operation does with its operands a, b and c. Numbers have W bits with F behind the point and stand with their sign in
/// registers of 64 bits; a wide sum has 64 bits, in units of 2⁻²ᶠ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Op {
    /// a.
    Move,
    /// a + b and a − b, in 64 bits.
    Add,
    Sub,
    /// The same, cut to W bits.
    AddNumbers,
    SubNumbers,
    Min,
    Max,
    And,
    Or,
    /// a shifted by b from 0 to 63, without sign.
    ShiftLeft,
    ShiftRight,
    /// a 2ᵇ in W bits, to nearest, ties up.
    Scale,
    /// a 2ᵇ of a number as a phase: 0 for a negative one; saturates.
    ToPhase,
    /// 2ᵃ as a number, or the greatest number.
    PowerOfTwo,
    /// a b, rounded, + c: numbers.
    Product,
    /// a b + c for a wide c.
    Sum,
    /// The same, rounded to a number.
    RoundedSum,
    /// Limb i of a times limb j of b, both unsigned, + c.
    Limbs(u8, u8),
    /// a/b as numbers, rounded to nearest, ties away from zero; saturates.
    Divide,
    /// The root of a wide sum of squares, to nearest; saturates.
    Root,
    /// The address of row a of a group of tables: a b + c, of rows of b words from c on.
    Row,
    /// What the caller gives: the section.
    Input,
    /// a becomes this word of the output.
    Output(u8),
}

/// The output words: setpoint by setpoint those of the setpoint, then one that says that it is whole.
pub(crate) const OUTPUT_WHOLE: u8 = 14;
/// The output word that says that a section is over.
pub(crate) const OUTPUT_DONE: u8 = 15;

impl Op {
    /// How many operands it reads.
    pub(crate) fn operands(self) -> usize {
        match self {
            Self::Input => 0,
            Self::Move | Self::PowerOfTwo | Self::Root | Self::Output(_) => 1,
            Self::Product | Self::Sum | Self::RoundedSum | Self::Limbs(..) | Self::Row => 3,
            _ => 2,
        }
    }

    /// Whether the result depends on the operands alone.
    pub(crate) fn is_pure(self) -> bool {
        !matches!(self, Self::Input | Self::Output(_))
    }

    /// Whether the operands a and b may change places.
    pub(crate) fn commutes(self) -> bool {
        use Op::{Add, AddNumbers, And, Max, Min, Or, Product, RoundedSum, Sum};
        matches!(self, Add | AddNumbers | Min | Max | And | Or | Product | Sum | RoundedSum)
    }
}

/// What an operation reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Operand {
    Register(Register),
    Constant(i64),
    /// A constant that belongs to the part, by its number.
    Parameter(u16),
    /// A column of the table's row at which a register points.
    Column(Register, u16),
}

/// An operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Operation {
    pub(crate) op: Op,
    /// Where the result goes; an output has none.
    pub(crate) to: Register,
    pub(crate) operands: [Operand; 3],
}

/// The format of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Numbers {
    pub(crate) bits: u32,
    pub(crate) fraction_bits: u32,
}
