//! The most that a period of a compiled part takes, from the linked code: see docs/step-bound.md.

use serde::Deserialize;

/// What a period may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// K: evaluations that its pieces share.
    pub evaluations: u64,
    /// J: joints of pieces, the end of the path among them.
    pub joints: u64,
    /// S: stages of the plan.
    pub stages: u64,
}

/// Instructions, or cycles: of a period while the plan lasts, and of a landing step behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Most {
    /// A period of the plan, be it the last one.
    pub period: u64,
    /// A landing step.
    pub landing: u64,
}

/// The bound on a core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PeriodBound {
    /// The target's name: `cortex-m3`.
    pub target: String,
    /// Instructions.
    pub instructions: Most,
    /// Cycles by the manual's table, the most that it allows; memory that never waits.
    pub cycles: Most,
}

/// The bounds that are known for pieces of this dimension and degree without weights, in this format, and without corners within a
/// section. None are known for others.
///
/// # Panics
/// Never: a test reads the file that is built in.
#[must_use]
pub fn period_bounds(format: &str, (dimension, degree): (usize, usize), limits: Limits) -> Vec<PeriodBound> {
    let file: File = toml::from_str(include_str!("../../../data/step-bounds.toml")).unwrap_or_default();
    let is_known =
        |row: &Row| (row.format.as_str(), row.dimension, row.degree) == (format, dimension, degree);
    file.target
        .into_iter()
        .filter(is_known)
        .map(|row| PeriodBound {
            instructions: row.most(limits, |kind| kind.instructions),
            cycles: row.most(limits, |kind| kind.cycles),
            target: row.name,
        })
        .collect()
}

#[derive(Default, Deserialize)]
struct File {
    target: Vec<Row>,
}

#[derive(Deserialize)]
struct Row {
    name: String,
    format: String,
    dimension: usize,
    degree: usize,
    plan: Kind,
    last: Kind,
    landing: Kind,
}

/// The bound of a kind of periods.
#[derive(Deserialize)]
struct Kind {
    instructions: Formula,
    cycles: Formula,
}

/// `base + K k + J j + S s`; the base of a bound that is steep may be below 0.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Formula {
    #[serde(rename = "base")]
    base: i64,
    k: i64,
    j: i64,
    s: i64,
}

impl Row {
    fn most(&self, limits: Limits, of: impl Fn(&Kind) -> Formula) -> Most {
        let value = |kind| of(kind).value(limits);
        Most { period: value(&self.plan).max(value(&self.last)), landing: value(&self.landing) }
    }
}

impl Formula {
    /// Saturates, as its limits do.
    fn value(&self, limits: Limits) -> u64 {
        let of = |count| i64::try_from(count).unwrap_or(i64::MAX);
        let (k, j, s) = (of(limits.evaluations), of(limits.joints), of(limits.stages));
        let terms = [(self.k, k), (self.j, j), (self.s, s)];
        let sum = terms.iter().fold(self.base, |sum, (a, b)| sum.saturating_add(a.saturating_mul(*b)));
        u64::try_from(sum).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONCE: Limits = Limits { evaluations: 5, joints: 1, stages: 1 };

    #[test]
    fn a_formula_is_a_sum_of_products() {
        let formula = Formula { base: -10, k: 7, j: 20, s: 3 };
        let limits = Limits { evaluations: 5, joints: 4, stages: 6 };
        assert_eq!(formula.value(limits), 35 + 80 + 18 - 10);
        assert_eq!(formula.value(Limits { joints: u64::MAX, ..limits }), i64::MAX.cast_unsigned());
    }

    #[test]
    fn the_file_has_the_cores_that_are_promised() {
        let names =
            |format| period_bounds(format, (2, 3), ONCE).into_iter().map(|b| b.target).collect::<Vec<_>>();
        assert_eq!(names("I4F28"), ["cortex-m0plus", "cortex-m3"]);
        assert_eq!(names("f32"), ["cortex-m4f"]);
        assert!(
            period_bounds("f64", (2, 3), ONCE).is_empty() && period_bounds("f32", (3, 3), ONCE).is_empty()
        );
        assert!(period_bounds("f32", (2, 1), ONCE).is_empty());
    }

    #[test]
    fn a_bound_grows_with_what_a_period_may_take() {
        let value = |limits| period_bounds("I4F28", (2, 3), limits).remove(1);
        let (least, more) = (value(ONCE), value(Limits { joints: 2, ..ONCE }));
        assert!(least.instructions.period < more.instructions.period);
        assert!(
            least.instructions.period < least.cycles.period && least.cycles.period < least.cycles.landing
        );
        assert!(value(Limits { stages: 3, ..ONCE }).cycles.period > least.cycles.period);
    }
}
