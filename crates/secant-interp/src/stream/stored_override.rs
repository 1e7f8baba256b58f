//! Feed override as words of a file.

use core::num::NonZeroU64;

use crate::feed_override::feed_override::{FeedOverride, ONE, Rate, quotient};

/// What a stream says about feed override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamOverride {
    /// How fast the rate may change.
    pub feeds: FeedOverride,
    /// The rate at which the feed is the commanded one, 100 %.
    pub commanded: Rate,
}

/// How many words there are.
pub(crate) const OVERRIDE_WORDS: usize = 5;

impl StreamOverride {
    /// ρ₁, ρ₂, A, J, and the commanded rate; zeros for a plan without override.
    pub(crate) fn words(this: Option<&Self>) -> [u64; OVERRIDE_WORDS] {
        let Some(Self { feeds, commanded }) = this else { return [0; OVERRIDE_WORDS] };
        [feeds.slope, feeds.bend.get(), feeds.acceleration, feeds.jerk, commanded.0]
    }

    /// The override that these words stand for; an error if they stand for nothing.
    pub(crate) fn of_words(words: [u64; OVERRIDE_WORDS]) -> Result<Option<Self>, NoOverride> {
        let [slope, bend, acceleration, jerk, commanded] = words;
        if words == [0; OVERRIDE_WORDS] {
            return Ok(None);
        }
        let none = NoOverride { bend };
        if slope == 0 || [slope, bend, commanded].iter().any(|share| *share > ONE) {
            return Err(none);
        }
        let bend = NonZeroU64::new(bend).ok_or(none)?;
        let jerk_per_acceleration = quotient(jerk, acceleration);
        let feeds = FeedOverride { slope, bend, acceleration, jerk, jerk_per_acceleration };
        Ok(Some(Self { feeds, commanded: Rate(commanded) }))
    }
}

/// The words stand for no override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NoOverride {
    /// The word of ρ₂.
    pub(crate) bend: u64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::OverrideLimits;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_override_comes_back(
            limits in [1e-6..0.9_f64, 1e-6..0.9_f64, 0.01..0.99_f64, 0.01..0.99_f64, 0.01..4.0_f64], commanded in 0.0..1.0_f64,
        ) {
            let [acceleration, jerk, plans, jerks, planned_feed] = limits;
            let limits = OverrideLimits {
                acceleration, jerk, planned_acceleration: plans * acceleration, planned_jerk: jerks * jerk, planned_feed,
            };
            let Some(feeds) = FeedOverride::new(&limits) else { return Err(TestCaseError::reject("no override")) };
            let whole = StreamOverride { feeds, commanded: Rate::of(commanded) };
            prop_assert_eq!(StreamOverride::of_words(StreamOverride::words(Some(&whole))), Ok(Some(whole)));
        }
    }

    #[test]
    fn words_that_no_override_has_are_refused() {
        assert_eq!(StreamOverride::of_words(StreamOverride::words(None)), Ok(None));
        let good = [1 << 20, 1 << 10, 5, 3, ONE];
        assert!(StreamOverride::of_words(good).is_ok_and(|found| found.is_some()));
        for (word, value) in [(0, 0), (0, ONE + 1), (1, 0), (1, u64::MAX), (4, ONE + 1)] {
            let mut words = good;
            words[word] = value;
            assert!(StreamOverride::of_words(words).is_err(), "{words:?}");
        }
    }
}
