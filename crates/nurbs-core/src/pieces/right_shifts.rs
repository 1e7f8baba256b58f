//! The scalings of a step on one piece, as shifts to the right.

use real::Real;

use crate::pieces::shift::fill;

/// The powers of two by which a step on one piece scales its numbers, each as the number of places to the right. In fixed point this
/// takes no question of its direction, which nearly every piece answers in the same way; in floats nothing is scaled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(align(4))] // Read as one word.
pub struct RightShifts {
    /// From a step to x: r.
    variable: u8,
    /// From n_1, in units of 2^e mm, to the first coefficient of the chord.
    first: u8,
    /// The same for each further coefficient, and for the weights, by so much more: s - r.
    per_power: u8,
    /// From the piece's units to those of the path.
    to_path: u8,
}

impl RightShifts {
    /// The shifts for these exponents of two, on a piece of degree p; `None` if one of them goes to the left, that of the chord by no
    /// place, or one by more than [`Real::MOST_LOWERED`] places.
    #[inline]
    pub(crate) fn of<R: Real>(
        [variable, first, per_power, to_path]: [i32; 4],
        degree: usize,
    ) -> Option<Self> {
        if R::IS_FLOATING {
            return Some(Self::default());
        }
        let degree = i32::try_from(degree).ok()?;
        // Neither wraps where the two that it is made of are right shifts themselves.
        let weight = per_power.wrapping_mul(degree);
        let last = first.wrapping_add(weight.wrapping_sub(per_power));
        let least = -i32::try_from(R::MOST_LOWERED).ok()?;
        let is_right = |exponent: i32| (least..=0).contains(&exponent);
        if R::MOST_LOWERED == 0
            || first == 0
            || ![variable, first, per_power, last, weight, to_path].into_iter().all(is_right)
        {
            return None;
        }
        let places = |exponent: i32| u8::try_from(-exponent).ok();
        Some(Self {
            variable: places(variable)?,
            first: places(first)?,
            per_power: places(per_power)?,
            to_path: places(to_path)?,
        })
    }

    /// x of a step.
    #[inline(always)]
    #[must_use]
    pub fn to_variable<R: Real>(self, step: R) -> R {
        lowered_or_kept(step, self.variable)
    }

    /// The places of the chord's coefficients, from the first on.
    #[inline(always)]
    pub(crate) fn of_chord(self) -> impl Iterator<Item = u8> {
        core::iter::successors(Some(self.first), move |places| Some(places.wrapping_add(self.per_power)))
    }

    /// The places of the weights, from the first on.
    #[inline(always)]
    pub(crate) fn of_weights(self) -> impl Iterator<Item = u8> {
        core::iter::successors(Some(self.per_power), move |places| Some(places.wrapping_add(self.per_power)))
    }

    /// An offset in the units of the path.
    #[inline(always)]
    pub(crate) fn in_units_of_path<R: Real, const D: usize>(self, offset: &[R; D]) -> [R; D] {
        if R::IS_FLOATING || self.to_path == 0 {
            return *offset;
        }
        let mut lowered = [R::zero(); D];
        fill(&mut lowered, offset.iter().map(|x| x.lowered(self.to_path)));
        lowered
    }
}

/// `x` lowered by places that may be none.
#[inline(always)]
pub(crate) fn lowered_or_kept<R: Real>(x: R, places: u8) -> R {
    if R::IS_FLOATING || places == 0 { x } else { x.lowered(places) }
}
