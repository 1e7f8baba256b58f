//! The feed limit of a plan.

use format_compare::{ExactPlan, ProfileKind};

use crate::examples::{EXAMPLE, on_example_machine};

#[test]
fn the_limit_is_that_of_the_problem_and_made_once() {
    let problem = on_example_machine::<2>(EXAMPLE, "");
    let expected = problem.feed_limit().unwrap();
    for plan in [
        ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]),
        ExactPlan::in_format::<f32, 2>(&problem, [0.0; 2]),
        ExactPlan::through_window::<f64, 2>(&problem, 50.0, ProfileKind::Cubic),
    ] {
        let plan = plan.unwrap();
        let limit = plan.limit(&problem).unwrap();
        assert_eq!(*limit, expected);
        assert!(std::ptr::eq(limit, plan.limit(&problem).unwrap()), "made twice");
    }
}
