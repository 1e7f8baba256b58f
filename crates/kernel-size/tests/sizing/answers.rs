//! Errors, steps, costs and bits that are known beforehand.

use kernel_size::{
    Input, InputError, Kernel, Language, Output, Steps, built_in, compare, named, price, size, vectors,
};
use real::{Backend, I8F24, I16F16, Real};
use target_cost::{Cost, built_in as targets};

use crate::kernels::{Biquad, Sum, What, one};

/// Adds tenths.
struct Tenths;

impl What for Tenths {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut sum = R::zero();
        while let Some([_]) = steps.begin() {
            sum = (sum + R::from_ratio(1, 10)).signal("sum");
            steps.end([sum]);
        }
    }
}

/// A tenth is 6553.6 units of I16F16, and so 6554: each step is 0.4 units too long.
#[test]
fn an_error_that_grows_is_found_where_it_is_too_large() {
    let unit = 2.0_f64.powi(-16);
    let kernel = one(Tenths, 1000, (0.0, 1.0), Output::named("sum").within(0.4 * unit * 500.5).drift(unit));
    let compared = compare(&kernel, &[named("I16F16").unwrap(), named("f64").unwrap()]).unwrap();
    let run = compared.run("I16F16").unwrap();
    let sum = &run.outputs[0];
    assert!((sum.worst_error - 0.4 * unit * 1000.0).abs() < 1e-12, "{}", sum.worst_error);
    assert_eq!((sum.worst_step, sum.requirements[0].first_broken), (999, Some(500)));
    assert_eq!(
        (run.good, run.first_bad_step, &run.overflows, &run.divergence),
        (false, Some(500), &None, &None)
    );
    // The mean of the last hundred errors is that of the first and 900 steps.
    assert!((sum.requirements[1].found - 0.4 * unit * 900.0).abs() < 1e-12, "{:?}", sum.requirements[1]);
    assert_eq!(sum.requirements[1].first_broken, Some(900));
    assert_eq!((compared.recommended.as_deref(), compared.not_a_question_of_format), (Some("f64"), false));
    assert_eq!(run.signals.iter().map(|one| one.signal).collect::<Vec<_>>(), ["sum", "x"]);
}

/// Over 10 000 steps the course has the largest error of every ten, and the worst of all is among them.
#[test]
fn the_course_of_an_error_keeps_its_extremes() {
    let kernel = one(Sum, 10_000, (-1.0, 1.0), Output::named("sum").within(1.0));
    let compared = compare(&kernel, &[named("I16F16").unwrap()]).unwrap();
    let sum = &compared.formats[0].outputs[0];
    assert_eq!(sum.course.len(), 1000);
    assert!(sum.course.iter().enumerate().all(|(stretch, (step, _))| step / 10 == stretch));
    assert!(sum.course.contains(&(sum.worst_step, sum.worst_error)) && sum.worst_error > 0.0);
    let few = compare(&one(Sum, 7, (-1.0, 1.0), Output::named("sum").within(1.0)), &built_in()).unwrap();
    assert_eq!(
        few.formats[0].outputs[0].course.iter().map(|(step, _)| *step).collect::<Vec<_>>(),
        [0, 1, 2, 3, 4, 5, 6]
    );
}

/// The sum of halves is 128 after 256 steps, which is beyond I8F24.
#[test]
fn an_overflow_is_found_by_step_and_signal() {
    struct Halves;
    impl What for Halves {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            let mut sum = R::zero();
            while let Some([_]) = steps.begin() {
                sum = (sum + R::one().half()).signal("sum");
                steps.end([sum.signal("again")]);
            }
        }
    }
    let kernel = one(Halves, 300, (0.0, 1.0), Output::named("sum").within(1e-3));
    let compared = compare(&kernel, &built_in()).unwrap();
    let lost = compared.run("I8F24").and_then(|run| run.overflows.clone()).unwrap();
    assert_eq!((lost.count, lost.first_step, lost.first_signal), (1, 255, Some("sum")));
    assert_eq!(compared.recommended.as_deref(), Some("I16F16"));
    let text = compared.to_string();
    assert!(text.contains("I8F24: 1 overflow, first in step 255, before or at sum"), "{text}");
}

/// Ten tenths of an f32 are more than 1, and those of the reference are less.
#[test]
fn the_first_other_way_is_found_by_step_and_signal() {
    struct Lap;
    impl What for Lap {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            let (mut sum, mut laps) = (R::zero(), R::zero());
            while let Some([_]) = steps.begin() {
                sum = (sum + R::from_ratio(1, 10)).signal("sum");
                if sum >= R::one() {
                    (sum, laps) = (sum - R::one(), laps + R::one());
                }
                steps.end([laps]);
            }
        }
    }
    let kernel = one(Lap, 15, (0.0, 1.0), Output::named("laps").exact());
    let compared = compare(&kernel, &[named("f32").unwrap(), named("I16F16").unwrap()]).unwrap();
    let run = compared.run("f32").unwrap();
    let other = run.divergence.clone().unwrap();
    assert_eq!((other.step, other.signal, other.holds), (9, Some("sum"), true));
    assert!(other.compared[0] > 1.0 && other.in_reference == Some([1.0, 1.0]), "{other:?}");
    assert_eq!(run.first_bad_step, Some(9));
}

/// A step of the filter is a sum of three products and nothing else, and costs what its graph does.
#[test]
fn a_step_costs_what_its_operations_do() {
    let kernel = one(Biquad, 50, (-1.0, 1.0), Output::named("y").within(0.1));
    let targets = targets().unwrap();
    let priced = price(&kernel, named("I8F24").unwrap(), &targets, Some(1e-3)).unwrap();
    assert_eq!(priced.recorded_steps, 50);
    assert_eq!(
        priced.operations.iter().map(|(name, n)| (*name, *n)).collect::<Vec<_>>(),
        [("sum_of_products", 1.0)]
    );
    use real::{Graph, Recorded};
    let number = |name| Recorded::input(name, I8F24::from_ratio(1, 3));
    let [b, x, a1, last, a2, before] = ["b", "x", "a1", "last", "a2", "before"];
    let (_, graph) = Graph::of(|| {
        let pairs = [(b, x), (a1, last), (a2, before)];
        Recorded::sum_of_products(pairs.map(|(one, other)| (number(one), number(other))))
    });
    let step = target_cost::Step::of(&graph);
    for target in &targets {
        let alone = target_cost::StepCost::of(&step, target, named("I8F24").unwrap());
        match (&priced.targets[&target.name], alone) {
            (Cost::Known(cost), Ok(alone)) => assert_eq!(cost.max, alone.length.typical, "{}", target.name),
            (Cost::Unknown { .. }, Err(_)) => {}
            other => panic!("{}: {other:?}", target.name),
        }
    }
}

/// Names that a language does not take become some that it does, and stay apart.
#[test]
fn registers_become_types() {
    struct Names;
    impl What for Names {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            while let Some([x]) = steps.begin() {
                let half = x.half().signal("x/2");
                steps.end([(half + half.half().signal("x 2")).signal("¾")]);
            }
        }
    }
    let kernel = one(Names, 50, (-1.0, 1.0), Output::named("y").within(1e-3));
    let found = size(&kernel).unwrap();
    let types = found.types(Language::C, real::Datapath::default()).unwrap();
    let names: Vec<&str> = types.lines().filter_map(|line| line.strip_prefix("typedef ")).collect();
    assert_eq!(names, ["int16_t one_x;", "int16_t one_x_2;", "int16_t one_x_2_2;", "int16_t one_s;"]);
    assert!(types.contains("Kernel one: 4 registers of"), "{types}");
}

/// The words are those of the fixed-point type itself.
#[test]
fn vectors_have_the_bits_of_the_type() {
    let kernel = one(Sum, 40, (-1.0, 1.0), Output::named("sum").within(0.1));
    let text = vectors(&kernel, named("I16F16").unwrap()).unwrap();
    let inputs = kernel.inputs().unwrap();
    let mut sum = I16F16::from_ratio(0, 1);
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("step,x,sum"));
    for (step, x) in inputs[0].values().iter().enumerate() {
        let x = I16F16::from_f64(*x).unwrap();
        sum = sum + x * I16F16::from_ratio(1, 3);
        let expected = format!("{step},{:08x},{:08x}", x.to_bits(), sum.to_bits());
        assert_eq!(lines.next(), Some(expected.as_str()));
    }
    assert_eq!(lines.next(), None);
}

/// A kernel that is wrong itself: no format cures it, and the answer says so.
#[test]
fn a_fault_of_the_kernel_is_told_from_one_of_formats() {
    struct GoesOn;
    impl Kernel for GoesOn {
        fn name(&self) -> &'static str {
            "goes on"
        }
        fn steps(&self) -> usize {
            20
        }
        fn inputs(&self) -> Result<Vec<Input>, InputError> {
            Ok(Vec::new())
        }
        fn outputs(&self) -> Vec<Output> {
            vec![Output::named("y").within(0.1).truth((0..20).map(|k| f64::from(k.min(5))).collect())]
        }
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            let mut y = R::zero();
            while let Some([]) = steps.begin() {
                steps.end([y]);
                y = y + R::one();
            }
        }
    }
    let compared = compare(&GoesOn, &built_in()).unwrap();
    assert!(compared.not_a_question_of_format && compared.recommended.is_none());
    for run in &compared.formats {
        // It ends at 20, where the right course is 5: a narrow format overflows before.
        assert!(run.first_bad_step.is_some_and(|step| step <= 6), "{run:?}");
    }
    assert_eq!(compared.run("f64").and_then(|run| run.first_bad_step), Some(6));
    let sizing = size(&GoesOn).unwrap();
    assert!(sizing.uniform.is_none() && sizing.not_a_question_of_format);
    assert!(sizing.to_string().contains("no question of format"), "{sizing}");
    assert!(compared.json().contains("\"not_a_question_of_format\": true"));
}
