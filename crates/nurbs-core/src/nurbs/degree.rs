//! The highest degree of a curve, the size of the scratch memory that follows from it, and the degree that is compiled
//! apart.

/// The highest degree of a curve.
///
/// It sizes the scratch arrays of every evaluation: 10 numbers. Controls accept degree 3 and sometimes 5,
/// modelling systems write up to 9.
pub const MAX_DEGREE: usize = 9;

/// The length of a scratch array with one number per basis function that is not zero.
pub(crate) const SCRATCH: usize = MAX_DEGREE + 1;

/// The degree of most curves. With the feature `cubic` its evaluation is compiled apart, without loops: at half or less
/// of the instructions in floats.
pub(crate) const CUBIC: usize = 3;
