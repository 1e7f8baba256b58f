//! Commands of a feed override.

use format_compare::{ExactPlan, OverrideTarget, Overrides, ProfileKind};

use crate::examples::on_example_machine;

#[test]
fn an_axis_that_stands_still_delays_no_override() {
    let overrides = Overrides::try_new(vec![OverrideTarget { time_s: 0.3, share: 0.5 }], 0.2).unwrap();
    let periods = |axes: &str| {
        let problem = on_example_machine::<3>("G0 X20 Y0 Z0\nG3 X20 Y0 I-20 J0 F6000\n", axes);
        let to_plan = overrides.to_plan(&problem);
        let plan = ExactPlan::in_format_with::<f64, 3>(&to_plan, [0.0; 2], ProfileKind::SCurve).unwrap();
        overrides.commands(&problem, &plan).unwrap().periods()
    };
    let weak = "\n[machine.axes.z]\nacceleration_mm_per_s2 = 1\njerk_mm_per_s3 = 1\n";
    assert_eq!(periods(weak), periods(""));
}
