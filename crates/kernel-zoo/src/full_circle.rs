//! Whether an arc that ends where it begins is a full circle: with `θ = atan2(r × t, r · t)`, it is if `θ ≤ 0`.
//!
//! # Source
//! grbl/grbl#495: from X80 Y-20 of the machine, counter-clockwise circles with I and J of ±4.24264 mm. Those with I-4.24264
//! J-4.24264 and I4.24264 J4.24264 are not executed, the other two are. Position, centre and target are f32. The sign of θ is that
//! of r × t, so that no arctangent is needed.

use kernel_size::{Input, InputError, Kernel, Output, Steps, compare};
use real::Real;

use crate::report::Report;

pub(crate) const REPORT: Report = Report {
    name: "full-circle",
    thread: "grbl/grbl#495",
    fault: "Some full circles are not executed: rounding of the centre turns an angle of 0 into one above 0.",
    cure: "An arc is a full circle if it ends where it begins.",
    reported_in: "f32",
    compare: |is_cured, formats| compare(&FullCircle { is_cured }, formats),
};

struct FullCircle {
    is_cured: bool,
}

/// The centre lies at ±`offset` in X and Y: these are the signs of I and J, and which way it lies.
const CENTRES: [(&str, [i32; 2]); 4] =
    [("north_east", [1, 1]), ("north_west", [-1, 1]), ("south_west", [-1, -1]), ("south_east", [1, -1])];

impl Kernel for FullCircle {
    fn name(&self) -> &'static str {
        REPORT.name
    }

    fn steps(&self) -> usize {
        1
    }

    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::recorded("offset", (0.0, 5.0), vec![4.24264])?])
    }

    /// 1 for a full circle.
    fn outputs(&self) -> Vec<Output> {
        CENTRES.map(|(name, _)| Output::named(name).exact().truth(vec![1.0])).into()
    }

    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let position = [80, -20].map(|mm| R::from_ratio(mm, 1));
        let target = position;
        while let Some([offset]) = steps.begin() {
            let is_circle = |[x, y]: [i32; 2]| {
                let to_centre = [offset * R::from_ratio(x, 1), offset * R::from_ratio(y, 1)];
                let centre = [position[0] + to_centre[0], position[1] + to_centre[1]];
                let to_target = [target[0] - centre[0], target[1] - centre[1]];
                let cross = ((-to_centre[0]) * to_target[1] - (-to_centre[1]) * to_target[0]).signal("cross");
                let is_circle = if self.is_cured { target == position } else { cross <= R::zero() };
                if is_circle { R::one() } else { R::zero() }
            };
            steps.end(CENTRES.map(|(_, signs)| is_circle(signs)));
        }
    }
}
