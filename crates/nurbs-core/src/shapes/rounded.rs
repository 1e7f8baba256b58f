//! From f64 to another format; an error names the number that does not fit.

use real::Backend;

use crate::ShapeError;

/// Every number rounded to the nearest of another format.
pub(crate) fn round_all<Q: Backend, const N: usize>(
    numbers: &[f64; N],
    what: &'static str,
) -> Result<[Q; N], ShapeError> {
    let mut rounded = [Q::zero(); N];
    for (to, from) in rounded.iter_mut().zip(numbers) {
        *to = Q::from_f64(*from).ok_or(ShapeError::OutOfRange { what })?;
    }
    Ok(rounded)
}
