//! Knots and weights with the few digits that a control accepts.
//!
//! They are ratios: a curve is the same with the knots `a (u - u_0)` and the weights `b w`, for any positive a and b.
//! So they are scaled to the range that the digits resolve best before they are rounded.
//!
//! # Source
//! FANUC Series 15i, B-63324EN/03, section 4.17: a knot or weight has nine digits, in the least unit of the reference axis; at
//! most 999999.999 for millimetres and IS-B. Mitsubishi M700V: at most 99.9999.

use std::fmt;
use std::str::FromStr;

use crate::bezier;
use crate::curve::{Curve, Nurbs};
use crate::curve_fault::Element;
use crate::part::Part;
use crate::rounding::rounded;

/// Decimal digits that an f64 always keeps.
const MAX_DIGITS: usize = 15;
/// The largest change of a number by scaling that is not reported, over the greatest number.
const SCALING: f64 = 4.0 * f64::EPSILON;

/// The knots and weights that a control accepts: at most the largest number, with at most its decimals. It is parsed
/// from that number, as in `999999.999`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioWords {
    largest: f64,
    decimals: usize,
}

/// The text is not a largest number: it is below 1, has signs or an exponent, or more digits than the 15 that f64
/// keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoLargestRatio;

impl fmt::Display for NoLargestRatio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "expected the largest knot that a control takes, with all its decimals, as 999999.999: from 1 on, \
             of at most {MAX_DIGITS} digits"
        )
    }
}

impl std::error::Error for NoLargestRatio {}

/// Numbers that are no longer those of a valid curve once they are rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RatioLost {
    /// Line of the move that the curve belongs to.
    pub line: usize,
    /// A weight that becomes 0, or a knot that becomes the one before it.
    pub element: Element,
}

impl fmt::Display for RatioLost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line;
        match self.element {
            Element::Weight(index) => write!(f, "weight {index} of the curve of line {line} rounds to 0"),
            Element::Knot(index) if index > 0 => {
                write!(f, "knots {} and {index} of the curve of line {line} round to one", index - 1)
            }
            element => write!(f, "{element:?} of the curve of line {line} is lost"),
        }
    }
}

impl std::error::Error for RatioLost {}

impl FromStr for RatioWords {
    type Err = NoLargestRatio;

    fn from_str(text: &str) -> Result<Self, NoLargestRatio> {
        let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
        let are_digits = [whole, decimals].iter().all(|part| part.bytes().all(|c| c.is_ascii_digit()));
        let largest: f64 = text.parse().map_err(|_| NoLargestRatio)?;
        let is_right = are_digits && largest >= 1.0 && whole.len() + decimals.len() <= MAX_DIGITS;
        is_right.then_some(Self { largest, decimals: decimals.len() }).ok_or(NoLargestRatio)
    }
}

impl RatioWords {
    /// The word nearest to a number.
    fn word(&self, x: f64) -> f64 {
        rounded(x, self.decimals).min(self.largest)
    }

    fn is_word(&self, x: f64) -> bool {
        x.abs() <= self.largest && self.word(x) == x
    }

    /// Ratios as words. If they are words already, they stay the same. Otherwise `ratio - origin` is multiplied by the
    /// least power of ten with which rounding to words changes nothing beyond [`SCALING`]. If there is none, the factor
    /// makes the greatest ratio the largest word.
    fn fit(&self, ratios: &[f64], origin: f64) -> Vec<f64> {
        if ratios.iter().all(|x| self.is_word(*x)) {
            return ratios.to_vec();
        }
        let from_origin = || ratios.iter().map(|x| x - origin);
        let greatest = from_origin().fold(0.0, f64::max);
        let leaves_nothing = |factor: &f64| {
            from_origin().all(|x| (self.word(x * factor) / factor - x).abs() <= SCALING * greatest)
        };
        let powers = (0..).map(|power| 10.0_f64.powi(power));
        let factor = powers.take_while(|power| greatest * power <= self.largest).find(leaves_nothing);
        let factor = factor.unwrap_or(self.largest / greatest);
        from_origin().map(|x| self.word(x * factor)).collect()
    }

    /// The curve with its knots and weights fitted to words; control points stay as they are.
    fn fit_curve(&self, curve: &Curve) -> Result<Curve, Element> {
        let origin = curve.knots().first().copied().unwrap_or(0.0);
        let (knots, weights) = (self.fit(curve.knots(), origin), self.fit(curve.weights(), 0.0));
        let meet = |i: &usize| knots[i - 1] == knots[*i] && curve.knots()[i - 1] < curve.knots()[*i];
        if let Some(index) = (1..knots.len()).find(meet) {
            return Err(Element::Knot(index));
        }
        match weights.iter().position(|w| *w <= 0.0) {
            Some(index) => Err(Element::Weight(index)),
            None => Ok(Nurbs { knots, weights, ..curve.to_nurbs() }.into()),
        }
    }
}

impl Part {
    /// The part with knots and weights that a control accepts, and a bound of how far that moves a point of a curve, in
    /// mm, at the same share of its knot span. Coordinates and feedrates are kept bit by bit; joints inside a curve
    /// stay as smooth as they are.
    ///
    /// # Errors
    /// [`RatioLost`] for the first curve with so narrow a knot span, or so small a weight, that rounding leaves nothing of it.
    pub fn in_ratio_words(&self, words: &RatioWords) -> Result<(Self, f64), RatioLost> {
        let mut part = Self { curves: Vec::with_capacity(self.curves.len()), ..self.clone() };
        let mut moved_mm = 0.0_f64;
        for (curve, one) in self.curves.iter().zip(&self.moves) {
            let fitted = words.fit_curve(curve).map_err(|element| RatioLost { line: one.line, element })?;
            if fitted != *curve {
                let pieces = bezier::pieces(curve).into_iter().zip(bezier::pieces(&fitted));
                moved_mm = pieces.map(|(from, to)| from.distance_mm(&to)).fold(moved_mm, f64::max);
            }
            part.curves.push(fitted);
        }
        Ok((part, moved_mm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_part;

    fn words(text: &str) -> RatioWords {
        text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn the_largest_number_says_range_and_decimals() {
        assert_eq!(words("999999.999"), RatioWords { largest: 999_999.999, decimals: 3 });
        assert_eq!(words("99.9999"), RatioWords { largest: 99.9999, decimals: 4 });
        assert_eq!(words("1"), RatioWords { largest: 1.0, decimals: 0 });
        for text in ["", ".", "0.999", "-9", "+9", "1e3", "9.9.9", "inf", "nan", "9999999999.999999", "9,9"] {
            assert_eq!(text.parse::<RatioWords>(), Err(NoLargestRatio), "{text}");
        }
    }

    #[test]
    fn what_fits_is_kept_and_what_a_power_of_ten_makes_fit_is_not_rounded() {
        let nine = words("999999.999");
        for (ratios, expected) in [
            (vec![-1.0, 0.0, 0.125, 7.5], vec![-1.0, 0.0, 0.125, 7.5]),
            (vec![0.0, 0.0001, 0.3], vec![0.0, 0.001, 3.0]),
            (vec![-0.5, -0.4999, 1.0], vec![0.0, 0.001, 15.0]),
            (vec![0.0, 1.0 / 3.0, 1.0], vec![0.0, 333_333.333, 999_999.999]),
            (vec![0.0, 1e12], vec![0.0, 999_999.999]),
        ] {
            assert_eq!(nine.fit(&ratios, ratios[0]), expected, "{ratios:?}");
        }
    }

    #[test]
    fn what_would_be_lost_is_named() {
        let program =
            "G0 X0 Y0\nG06.2 P3 K0 X0 Y0\nK0 X1\nK0 X2 R0.001\nK0.3333333 X3 Y1\nK0.3333334 X4\nK1\nK1\nK1\n";
        let lost = |largest: &str| {
            let part = read_part("p.nc", program).unwrap_or_else(|errors| panic!("{errors}"));
            part.in_ratio_words(&words(largest)).map(|_| ()).map_err(|lost| lost.to_string())
        };
        assert_eq!(lost("999999.999"), Ok(()));
        assert_eq!(lost("99.9999"), Err("knots 3 and 4 of the curve of line 2 round to one".into()));
        let program = program.replace("K0.3333334", "K0.5");
        let part = read_part("p.nc", &program).unwrap_or_else(|errors| panic!("{errors}"));
        let lost = part.in_ratio_words(&words("9.9")).unwrap_err();
        assert_eq!(lost.to_string(), "weight 2 of the curve of line 2 rounds to 0");
    }
}
