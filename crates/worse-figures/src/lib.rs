//! `worse-figures`: which figures of a run are worse than those of an earlier one.
//!
//! Of each figure less is better. A word, as a verdict, is a figure too: its place among words that stand from the best to the
//! worst. Figures are known by their names.
//!
//! ```
//! use worse_figures::Figures;
//!
//! const VERDICTS: [&str; 2] = ["good", "bad"];
//! let figures = |error: f64, verdict| {
//!     let mut figures = Figures::default();
//!     figures.add("error in mm".to_string(), error, 0.01);
//!     figures.add_word("verdict".to_string(), verdict, &VERDICTS);
//!     figures
//! };
//! let (before, now) = (figures(0.004, "good"), figures(0.005, "bad"));
//! assert_eq!(
//!     now.worse_than(&before, 0.01),
//!     ["error in mm was 0.004, and is 0.005", "verdict was good, and is bad"]
//! );
//! assert!(before.worse_than(&now, 0.01).is_empty());
//! ```

use std::collections::BTreeMap;

/// A figure may grow by a share of itself, and at least by that share of this part of its limit.
const NEGLIGIBLE: f64 = 1e-3;

/// Figures of a run, by their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures(BTreeMap<String, Figure>);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Figure {
    value: f64,
    /// The largest value that is good, or 0 if there is none.
    limit: f64,
    /// What a value counts as that is less.
    least: f64,
    /// The words of which the value is a place; none for a number.
    words: &'static [&'static str],
}

impl Figures {
    /// Adds a number, with the largest that is good, or 0 if there is none.
    pub fn add(&mut self, name: String, value: f64, limit: f64) {
        self.0.insert(name, Figure { value, limit, least: f64::NEG_INFINITY, words: &[] });
    }

    /// Adds a number that may grow by the share of `least` where it is less than that.
    pub fn add_from(&mut self, name: String, value: f64, least: f64) {
        self.0.insert(name, Figure { value, limit: 0.0, least, words: &[] });
    }

    /// Adds a word of these, which stand from the best to the worst; any other word is left out.
    #[allow(clippy::cast_precision_loss, reason = "a place among a few words")]
    pub fn add_word(&mut self, name: String, word: &str, words: &'static [&'static str]) {
        if let Some(place) = words.iter().position(|one| *one == word) {
            self.0.insert(name, Figure { value: place as f64, limit: 0.0, least: 0.0, words });
        }
    }

    /// Number of figures.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The names of the figures that earlier ones have not.
    #[must_use]
    pub fn new_since(&self, before: &Self) -> Vec<String> {
        self.0.keys().filter(|name| !before.0.contains_key(*name)).cloned().collect()
    }

    /// The figures that are worse by more than this share than they were, or are missing now, each in words. A figure that is
    /// new is not among them.
    #[must_use]
    pub fn worse_than(&self, before: &Self, share: f64) -> Vec<String> {
        let compared = |(name, old): (&String, &Figure)| match self.0.get(name) {
            None => Some(format!("{name} was {}, and is missing", old.shown())),
            Some(new) if new.is_worse_than(*old, share) => {
                Some(format!("{name} was {}, and is {}", old.shown(), new.shown()))
            }
            Some(_) => None,
        };
        before.0.iter().filter_map(compared).collect()
    }
}

impl Figure {
    fn is_worse_than(self, before: Self, share: f64) -> bool {
        let (now, then) = (self.counted(), before.counted());
        now > then + share * then.max(NEGLIGIBLE * before.limit)
    }

    /// The value that is compared: what is no number is worse than any.
    fn counted(self) -> f64 {
        if self.value.is_nan() { f64::INFINITY } else { self.value.max(self.least) }
    }

    /// The figure for a person.
    fn shown(self) -> String {
        let of_place = |(place, word): (usize, &&str)| {
            (u32::try_from(place).map(f64::from) == Ok(self.value)).then(|| (*word).to_string())
        };
        self.words.iter().enumerate().find_map(of_place).unwrap_or_else(|| match self.value {
            0.0 => "0".to_string(),
            value if (1e-3..1e6).contains(&value.abs()) => format!("{value}"),
            value => format!("{value:.3e}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(value: f64, limit: f64) -> Figures {
        let mut figures = Figures::default();
        figures.add("x".to_string(), value, limit);
        figures
    }

    #[test]
    fn a_share_is_allowed_and_more_is_not() {
        assert!(one(1.01, 0.0).worse_than(&one(1.0, 0.0), 0.01).is_empty());
        assert_eq!(one(1.02, 0.0).worse_than(&one(1.0, 0.0), 0.01), ["x was 1, and is 1.02"]);
        // From 0 a figure may grow by the share of a thousandth of its limit.
        assert!(one(1e-5, 1.0).worse_than(&one(0.0, 1.0), 0.01).is_empty());
        assert_eq!(one(2e-5, 1.0).worse_than(&one(0.0, 1.0), 0.01), ["x was 0, and is 2.000e-5"]);
        let above = |value| {
            let mut figures = Figures::default();
            figures.add_from("x".to_string(), value, 0.1);
            figures
        };
        assert!(above(0.101).worse_than(&above(0.0), 0.01).is_empty());
        assert_eq!(above(0.102).worse_than(&above(0.03), 0.01), ["x was 0.03, and is 0.102"]);
        assert!(above(0.09).worse_than(&above(0.01), 0.01).is_empty());
    }

    #[test]
    fn what_is_no_number_is_worse_than_any() {
        assert_eq!(one(f64::NAN, 1.0).worse_than(&one(1e300, 1.0), 0.01).len(), 1);
        assert!(one(f64::NAN, 1.0).worse_than(&one(f64::NAN, 1.0), 0.01).is_empty());
        assert!(one(2.0, 1.0).worse_than(&one(f64::NAN, 1.0), 0.01).is_empty());
    }

    #[test]
    fn a_figure_that_is_missing_is_worse_and_a_new_one_is_not() {
        assert_eq!(Figures::default().worse_than(&one(2.0, 0.0), 1.0), ["x was 2, and is missing"]);
        assert!(one(2.0, 0.0).worse_than(&Figures::default(), 0.0).is_empty());
        assert_eq!(one(2.0, 0.0).new_since(&Figures::default()), ["x"]);
        assert!(one(2.0, 0.0).new_since(&one(3.0, 0.0)).is_empty());
    }

    #[test]
    fn an_unknown_word_is_no_figure() {
        let mut figures = Figures::default();
        figures.add_word("verdict".to_string(), "fine", &["good", "bad"]);
        assert!(figures.is_empty());
    }
}
