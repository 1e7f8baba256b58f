//! Transitions of any family under one type, as the look-ahead takes them.

use real::Real;

use crate::{CubicProfile, FeedPiece, Profile, ProfileKind, SCurveProfile, TrigonometricProfile};

/// A transition of the family that a plan is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Transition<R> {
    Cubic(CubicProfile<R>),
    SCurve(SCurveProfile<R>),
    Trigonometric(TrigonometricProfile<R>),
}

impl<R: Real> Transition<R> {
    pub(crate) fn fastest(kind: ProfileKind, feeds: [R; 2], acceleration: R, jerk: R) -> Self {
        let [from, to] = feeds;
        match kind {
            ProfileKind::Cubic => Self::Cubic(Profile::fastest(from, to, acceleration, jerk)),
            ProfileKind::Trigonometric => Self::Trigonometric(Profile::fastest(from, to, acceleration, jerk)),
            ProfileKind::SCurve | ProfileKind::Flexible => {
                Self::SCurve(Profile::fastest(from, to, acceleration, jerk))
            }
        }
    }

    pub(crate) fn duration(&self) -> R {
        match self {
            Self::Cubic(profile) => profile.duration(),
            Self::SCurve(profile) => profile.duration(),
            Self::Trigonometric(profile) => profile.duration(),
        }
    }

    pub(crate) fn length(&self) -> R {
        match self {
            Self::Cubic(profile) => profile.length(),
            Self::SCurve(profile) => profile.length(),
            Self::Trigonometric(profile) => profile.length(),
        }
    }

    pub(crate) fn pieces(&self) -> [FeedPiece<R>; 3] {
        match self {
            Self::Cubic(profile) => profile.pieces(),
            Self::SCurve(profile) => profile.pieces(),
            Self::Trigonometric(profile) => profile.pieces(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// What the look-ahead rests on when it refuses a ramp as too long.
        #[test]
        fn no_chain_of_transitions_is_shorter_than_one(
            feeds in prop::array::uniform3(0.0..1.0_f64), acceleration in 1e-4..0.5_f64, jerk in 1e-6..0.5_f64,
        ) {
            let mut feeds = feeds;
            feeds.sort_by(f64::total_cmp);
            let [low, middle, high] = feeds;
            for kind in ProfileKind::ALL {
                let length = |from, to| Transition::fastest(kind, [from, to], acceleration, jerk).length();
                let chain = length(low, middle) + length(middle, high);
                prop_assert!(length(low, high) <= chain * (1.0 + 1e-12), "{kind:?}");
            }
        }
    }
}
