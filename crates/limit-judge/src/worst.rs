//! The greatest figure of a run, and the step that has it.

/// A step of a run, by which a figure is found again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepPlace {
    /// Number of the step, from 0.
    pub index: u64,
    /// Its row in a log, from 1; 0 in a run that is no log.
    pub row: u64,
    /// The curve on which it ends, or the line of the program.
    pub curve: usize,
    /// The commanded point, in mm.
    pub point_mm: [f64; 3],
}

impl StepPlace {
    /// The place, so many steps later.
    #[must_use]
    pub fn later(self, by: u64) -> Self {
        Self { index: self.index + by, ..self }
    }
}

/// Whether one figure is less than another; NaN is greater than any number.
#[must_use]
pub fn is_less(one: f64, other: f64) -> bool {
    !one.is_nan() && (other.is_nan() || one < other)
}

/// The greatest figure of a run, and the first step that has it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// The figure, 0 if none was added.
    pub figure: f64,
    /// Where it is.
    pub at: Option<StepPlace>,
}

impl Worst {
    /// Adds the figure of a later step. NaN counts as greater than any number.
    pub fn add(&mut self, figure: f64, at: StepPlace) {
        if self.at.is_none() || is_less(self.figure, figure) {
            *self = Self { figure, at: Some(at) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_step_is_found_whatever_its_figure() {
        let worst = |figures: &[f64]| {
            let mut found = Worst::default();
            for (index, figure) in (0..).zip(figures) {
                found.add(*figure, StepPlace { index, row: 0, curve: 0, point_mm: [0.0; 3] });
            }
            (found.figure, found.at.map(|at| at.index))
        };
        assert_eq!([worst(&[1.0, 3.0, 2.0]), worst(&[1.0, 3.0, 3.0])], [(3.0, Some(1)); 2]);
        assert_eq!((worst(&[0.0, 0.0]), worst(&[])), ((0.0, Some(0)), (0.0, None)));
        for at in 0..3 {
            let mut figures = [1.0; 3];
            figures[at] = f64::NAN;
            let (figure, step) = worst(&figures);
            assert!(figure.is_nan() && step == u64::try_from(at).ok(), "{at}");
        }
    }
}
