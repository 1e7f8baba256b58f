//! The position after relative moves (G91): `p ← p + Δ`.
//!
//! # Source
//! grblHAL/core#1015: files of 3600 lines of small relative moves, which should end at 3600 degrees and an offset and do not;
//! a position in double precision cures it. The moves here are of 1.0001 degrees. The compensated sum is W. Kahan's, "Further
//! remarks on reducing truncation errors", Communications of the ACM 8 (1965).

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "relative-moves",
    thread: "grblHAL/core#1015",
    fault: "Thousands of small relative moves, summed in f32, do not end where they should.",
    cure: "What a sum loses is kept and added to the next move.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&RelativeMoves { is_cured }, formats),
};

struct RelativeMoves {
    is_cured: bool,
}

impl Kernel for RelativeMoves {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        3600
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::generated("move", (0.0, 2.0), self.steps(), |_| 1.0001)?])
    }

    fn outputs(&self) -> Vec<Output> {
        let truth = (1..=self.steps()).map(|moves| moves as f64 * 1.0001);
        vec![Output::named("position").within(0.005).truth(truth.collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let (mut position, mut lost) = (R::zero(), R::zero());
        while let Some([by]) = steps.begin() {
            let by = if self.is_cured { by - lost } else { by };
            let next = (position + by).signal("position");
            lost = (next - position) - by;
            position = next;
            steps.end([position]);
        }
    }
}
