//! The fewest bits that are enough for several parts.
//!
//! Let G_p be the formats, each a width and its division into integer and fraction bits, that are good for part p: see
//! [`fewest_bits`](crate::fewest_bits()). The answer for a set of parts is the format of least width in the intersection of all G_p; of its
//! width, it is the one with the most fraction bits. It may be wider than every part's own answer: one part needs integer bits, and
//! another fraction bits.
//!
//! Each part's own answer is known before. So no narrower width than the widest of them is good for all, and where a part's own answer has
//! the width that is tried, no format with more fraction bits is good for that part: its own is the first good one of that width. Every
//! other format is tried on the parts until one of them breaks a requirement.

use real::{Datapath, FormatName, RuntimeFormat};

use crate::judge::judged_run::JudgedRun;
use crate::plan::exact_plan::ExactPlan;
use crate::problem::problem::Problem;
use crate::refusal::Refusal;
use crate::run::formats::{Dimension, Space};
use crate::run::job::Job;
use crate::run::options::Options;
use crate::size::trial::{FEWEST_INTEGER_BITS, Trial, Tried, WIDTHS, search_options};

/// Every format of this width that a search tries, the one with the most fraction bits first.
#[must_use]
pub fn splits(width: u32, datapath: Datapath) -> Vec<FormatName> {
    let split =
        |integer_bits| FormatName::Fixed { integer_bits, fraction_bits: width - integer_bits, datapath };
    (FEWEST_INTEGER_BITS..=width).map(split).collect()
}

/// The narrowest format that is good for all parts of a set; of its width, the one with the most fraction bits. `None` if none of up to
/// 48 bits is. `own` are the answers for each part alone, all of this datapath, and `is_good_for_all` says whether a format is good for
/// every part.
///
/// # Errors
/// Those of `is_good_for_all`.
pub fn common_format<E>(
    own: &[FormatName],
    datapath: Datapath,
    mut is_good_for_all: impl FnMut(FormatName) -> Result<bool, E>,
) -> Result<Option<FormatName>, E> {
    let Some(least) = own.iter().map(|format| format.bits()).max() else { return Ok(None) };
    for width in least..=*WIDTHS.end() {
        for format in splits(width, datapath) {
            let is_known_to_be_bad =
                own.iter().any(|own| own.bits() == width && fraction_bits(*own) < fraction_bits(format));
            if !is_known_to_be_bad && is_good_for_all(format)? {
                return Ok(Some(format));
            }
        }
    }
    Ok(None)
}

fn fraction_bits(format: FormatName) -> u32 {
    match format {
        FormatName::Fixed { fraction_bits, .. } => fraction_bits,
        _ => 0,
    }
}

/// The run of `problem` on pieces in each of `formats`, which are fixed-point formats of one datapath; `None` where the run breaks a
/// requirement, or the path cannot be run. `runs` are other runs of the path, by which its hardest sections are known, and `plan` is
/// the plan that they followed.
///
/// # Errors
/// [`Refusal`] when the reference cannot be made.
pub fn runs_in<const D: usize>(
    problem: &Problem<D>,
    plan: &ExactPlan,
    runs: &[JudgedRun],
    options: &Options,
    formats: &[FormatName],
) -> Result<Vec<Option<JudgedRun>>, Refusal>
where
    Space: Dimension<D>,
{
    let Some(FormatName::Fixed { datapath, .. }) = formats.first() else { return Ok(Vec::new()) };
    let options = search_options(options);
    let job = Job::new(problem, plan, &options);
    let trial = Trial::new(&job, *datapath)?;
    trial.watch_hardest(runs);
    let run = |format: &FormatName| match trial.tried(RuntimeFormat::of(*format)?) {
        Tried::Good(run) => Some(*run),
        Tried::Broken | Tried::Refused => None,
    };
    Ok(formats.iter().map(run).collect())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::convert::Infallible;

    use proptest::prelude::*;

    use super::*;

    /// The formats that are good for a part, each as its integer and its fraction bits.
    type Good = BTreeSet<(u32, u32)>;

    fn pair(format: FormatName) -> (u32, u32) {
        (format.bits() - fraction_bits(format), fraction_bits(format))
    }

    /// The first of these formats in order of width, and in each width of falling fraction bits.
    fn first(formats: &Good) -> Option<(u32, u32)> {
        formats.iter().copied().min_by_key(|(integer, fraction)| (integer + fraction, *integer))
    }

    /// The answer, and how many formats were asked for.
    fn answer(parts: &[Good]) -> (Option<(u32, u32)>, usize) {
        let own: Vec<_> = parts.iter().filter_map(first).map(|(i, f)| FormatName::fixed(i, f)).collect();
        let mut asked = 0;
        let found = common_format(&own, Datapath::default(), |format| {
            asked += 1;
            Ok::<_, Infallible>(parts.iter().all(|part| part.contains(&pair(format))))
        });
        let Ok(found) = found;
        (found.map(pair), asked)
    }

    #[test]
    fn one_part_needs_integer_bits_and_another_fraction_bits() {
        let range: Good = (6..20).flat_map(|i| (10..20).map(move |f| (i, f))).collect();
        let fine: Good = (2..20).flat_map(|i| (22..28).map(move |f| (i, f))).collect();
        assert_eq!((first(&range), first(&fine)), (Some((6, 10)), Some((2, 22))));
        assert_eq!(answer(&[range.clone(), fine.clone()]), (None, (24..=48).map(|w| w - 1).sum::<usize>()));
        let wide: Good = (6..20).flat_map(|i| (10..30).map(move |f| (i, f))).collect();
        assert_eq!(answer(&[wide, fine]).0, Some((6, 22)));
    }

    proptest! {
        /// Good sets without any order in them: a wider format may be bad.
        #[test]
        fn the_answer_is_the_first_of_the_intersection(
            parts in prop::collection::vec(prop::collection::btree_set((2_u32..9, 10_u32..20), 20..60), 1..6)
        ) {
            let common = parts.iter().skip(1).fold(parts[0].clone(), |all, part| &all & part);
            prop_assert_eq!(answer(&parts).0, first(&common));
        }
    }
}
