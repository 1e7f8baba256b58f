//! An interval of numbers, and how it is said.

use std::fmt;

/// The numbers that may be written in a place: an interval with both of its ends, or one of a ratio, whose upper end 1 is
/// left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    least: f64,
    most: f64,
    unit: &'static str,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// From `least` to `most`.
    Plain,
    /// 0 is allowed too, as "none".
    OrZero,
    /// From `least` to below `most`.
    Ratio,
}

impl Domain {
    /// From `least` to `most`, both included. The unit may be empty.
    #[must_use]
    pub const fn of(least: f64, most: f64, unit: &'static str) -> Self {
        Self { least, most, unit, kind: Kind::Plain }
    }

    /// A ratio from `least` to below 1.
    #[must_use]
    pub const fn ratio(least: f64) -> Self {
        Self { least, most: 1.0, unit: "", kind: Kind::Ratio }
    }

    /// The same, and 0.
    #[must_use]
    pub const fn or_zero(self) -> Self {
        Self { kind: Kind::OrZero, ..self }
    }

    /// Whether a number is within. NaN is not.
    #[must_use]
    pub fn holds(&self, x: f64) -> bool {
        let within = self.least <= x && x <= self.most;
        match self.kind {
            Kind::Plain => within,
            Kind::OrZero => within || x == 0.0,
            Kind::Ratio => within && x < self.most,
        }
    }

    /// The least number above 0 that is within, or the least of all where it is 0 or below.
    #[must_use]
    pub const fn least(&self) -> f64 {
        self.least
    }

    /// The upper end.
    #[must_use]
    pub const fn most(&self) -> f64 {
        self.most
    }

    /// The unit; empty if there is none.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        self.unit
    }

    /// Numbers just inside of each end, and numbers just outside.
    #[must_use]
    pub fn ends(&self) -> ([f64; 2], [f64; 2]) {
        let most = if self.kind == Kind::Ratio { self.most.next_down() } else { self.most };
        ([self.least, most], [self.least.next_down(), most.next_up()])
    }

    /// The ends alone, as a table has them.
    #[must_use]
    pub fn range(&self) -> String {
        let [least, most] = [self.least, self.most].map(end);
        match self.kind {
            Kind::Plain if self.least == -self.most => format!("-{most} to {most}"),
            Kind::Plain => format!("{least} to {most}"),
            Kind::OrZero => format!("0, {least} to {most}"),
            Kind::Ratio => format!("{least} to below {most}"),
        }
    }
}

/// The words for what is expected.
impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [least, most] = [self.least, self.most].map(end);
        match self.kind {
            Kind::Plain if self.least == -self.most => write!(f, "a number within ±{most}")?,
            Kind::Plain => write!(f, "a number of {least} to {most}")?,
            Kind::OrZero => write!(f, "0, or a number of {least} to {most}")?,
            Kind::Ratio => write!(f, "a ratio of {least} to below {most}")?,
        }
        if self.unit.is_empty() { Ok(()) } else { write!(f, " {}", self.unit) }
    }
}

/// An end of an interval, with a power of ten where it is large or small.
pub(crate) fn end(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

/// A number as it is shown in a message: digit by digit if that is short, else with a power of ten. The longest double has
/// more than a thousand digits.
///
/// ```
/// assert_eq!(domains::shown(0.25), "0.25");
/// assert_eq!(domains::shown(1e300), "1e300");
/// assert_eq!(domains::shown(5e-324), "5e-324");
/// ```
#[must_use]
pub fn shown(x: f64) -> String {
    const LONGEST: usize = 20;
    let digits = if x == 0.0 || (1e-9..1e21).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") };
    if digits.len() <= LONGEST { digits } else { format!("{x:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_domain_holds_its_ends_and_says_them() {
        let plain = Domain::of(1e-6, 1e5, "mm/s");
        assert!(plain.holds(1e-6) && plain.holds(1e5));
        assert!(!plain.holds(0.0) && !plain.holds(1e-6_f64.next_down()) && !plain.holds(f64::NAN));
        assert_eq!(plain.to_string(), "a number of 1e-6 to 1e5 mm/s");
        let zero = Domain::of(0.01, 10.0, "mm").or_zero();
        assert!(zero.holds(0.0) && !zero.holds(0.005) && !zero.holds(-0.01));
        assert_eq!(zero.to_string(), "0, or a number of 0.01 to 10 mm");
        let ratio = Domain::ratio(1e-16);
        assert!(ratio.holds(0.5) && !ratio.holds(1.0));
        assert_eq!(ratio.to_string(), "a ratio of 1e-16 to below 1");
        let both = Domain::of(-1e7, 1e7, "mm");
        assert_eq!(
            (both.to_string(), both.range()),
            ("a number within ±1e7 mm".into(), "-1e7 to 1e7".into())
        );
    }

    #[test]
    fn the_ends_are_just_inside_and_just_outside() {
        for domain in [Domain::of(1e-6, 1e5, ""), Domain::ratio(1e-16), Domain::of(-2.0, 2.0, "")] {
            let (inside, outside) = domain.ends();
            assert!(inside.iter().all(|x| domain.holds(*x)), "{domain}");
            assert!(outside.iter().all(|x| !domain.holds(*x)), "{domain}");
        }
    }

    #[test]
    fn numbers_are_shown_short() {
        assert_eq!([-1.0, 0.1, 2e7, 1e20].map(shown), ["-1", "0.1", "20000000", "1e20"].map(String::from));
        let longest = [f64::MAX, f64::MIN_POSITIVE, 5e-324, 0.1 + 0.2, -1.234_567_890_123_456_7e-300];
        assert!(longest.map(shown).iter().all(|text| text.len() <= 25), "{:?}", longest.map(shown));
        assert!(longest.iter().all(|x| shown(*x).parse::<f64>() == Ok(*x)));
        assert_eq!([f64::NAN, f64::NEG_INFINITY].map(shown), ["NaN", "-inf"].map(String::from));
    }
}
