//! The limits that a machine states for motions, and how closely setpoints show whether they are kept.

use limit_judge::{Of, StatedLimit};
use part_program::{Junction, coarse_increment_mm};

use crate::problem::problem::Problem;
use crate::run::run::AboutRun;

/// The limits that the machine of a problem states, where the feed may be `share` times what is commanded.
pub(crate) fn stated_limits<const D: usize>(problem: &Problem<D>, share: f64) -> Vec<StatedLimit> {
    let (machine, t) = (&problem.machine, problem.period_s());
    let (along, across) = (machine.acceleration_mm_per_s2, machine.centripetal_acceleration_mm_per_s2);
    let of_path = [share, along * t.powi(2), machine.jerk_mm_per_s3 * t.powi(3)];
    let of_path = (0..).zip(of_path).map(|(order, most)| StatedLimit { of: Of::Path, order, most });
    let total =
        across.map(|across| StatedLimit { of: Of::Vector, order: 1, most: along.hypot(across) * t.powi(2) });
    let axes = (0..D.min(3)).zip(problem.axes_per_period()).flat_map(|(index, axis)| {
        let limits = (0..).zip([axis.velocity, axis.acceleration, axis.jerk]);
        limits.filter_map(move |(order, most)| Some(StatedLimit { of: Of::Axis(index), order, most: most? }))
    });
    let stated = [machine.axes.x, machine.axes.y, machine.axes.z];
    let jumps = (0..D.min(3)).zip(stated).filter_map(|(index, axis)| {
        let most = axis.velocity_jump_mm_per_s.filter(|_| machine.junction == Junction::VelocityJump)?;
        Some(StatedLimit { of: Of::Jump(index), order: 0, most: most * t })
    });
    of_path.chain(total).chain(axes).chain(jumps).collect()
}

/// How far a motion may be from the setpoints of a run, in mm: half of their last place, and half of the fluctuation that is allowed in a
/// full step; or half of what the drives resolve where a machine states more than is taken otherwise.
pub(crate) fn seen_within_mm<const D: usize>(run: &AboutRun, problem: &Problem<D>) -> f64 {
    let machine = &problem.machine;
    let fluctuation_mm = machine.fluctuation_limit * problem.full_step_mm();
    let increment_mm = coarse_increment_mm(machine.position_increment_mm);
    limit_judge::seen_within_mm(0.5 * run.resolution_mm, fluctuation_mm, increment_mm)
}
