//! The angle that an arc travels, `θ = atan2(r × t, r · t)`, with r and t from the centre to the start and to the target.
//!
//! # Source
//! grbl/grbl#1739: where a large radius makes the angle less than an epsilon, which was added so that full circles are not
//! missed, a short arc becomes a full circle. grblHAL/core#547 has the cure: it is a full circle only where target and start are
//! the same. The epsilon here is 5e-7 rad. θ is less than 1e-5 rad, so that atan2 is the quotient.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "arc-epsilon",
    thread: "grbl/grbl#1739",
    fault: "A short arc of large radius, whose angle is below an epsilon, becomes a full circle.",
    cure: "An arc is a full circle only if it ends where it begins.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&ArcEpsilon { is_cured }, formats),
};

struct ArcEpsilon {
    is_cured: bool,
}

const RADIUS_MM: f64 = 1000.0;

/// From 0.1 to 2 µm of arc, in rad; a full circle at last.
fn angle(step: usize) -> f64 {
    if step < 20 { (step + 1) as f64 * 1e-7 } else { 0.0 }
}

impl Kernel for ArcEpsilon {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        21
    }

    /// The target from the centre, which lies to the left of the start.
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        let along = |step: usize| RADIUS_MM * angle(step).cos();
        let across = |step: usize| RADIUS_MM * angle(step).sin();
        Ok(vec![
            Input::generated("target_x", (0.0, RADIUS_MM), self.steps(), along)?,
            Input::generated("target_y", (0.0, RADIUS_MM), self.steps(), across)?,
        ])
    }

    fn outputs(&self) -> Vec<Output> {
        let truth = |step: usize| if step < 20 { angle(step) } else { std::f64::consts::TAU };
        vec![Output::named("travel").within(1e-6).truth((0..self.steps()).map(truth).collect())]
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let start = (R::from_ratio(1000, 1), R::zero());
        let turn = steps.constant("turn", std::f64::consts::TAU);
        let epsilon = steps.constant("epsilon", 5e-7);
        while let Some([x, y]) = steps.begin() {
            let cross = (start.0 * y - start.1 * x).signal("cross");
            let along = R::sum_of_products([(start.0, x), (start.1, y)]).signal("along");
            let travel = (cross / along).signal("travel");
            let is_circle = if self.is_cured { (x, y) == start } else { travel <= epsilon };
            steps.end([if is_circle { travel + turn } else { travel }]);
        }
    }
}
