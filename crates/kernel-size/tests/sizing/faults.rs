//! Kernels that end otherwise than they must.

use kernel_size::{Ended, Output, Refusal, Steps, built_in, compare, named, price, vectors};
use real::Real;

use crate::kernels::{Biquad, What, one};

struct By<F>(F);

impl<F: Fn(usize) -> bool + Sync> What for By<F> {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut step = 0;
        while let Some([x]) = steps.begin() {
            assert!(
                !(self.0)(step) || R::resolution() > R::one().ldexp(-52),
                "the table has no entry {step}"
            );
            steps.end([x]);
            step += 1;
        }
    }
}

#[test]
fn a_panic_is_reported_with_its_step() {
    // Only in formats as fine as f64, so that the reference has it too.
    let kernel = one(By(|step| step == 7), 20, (0.0, 1.0), Output::named("y").within(0.1));
    let refused = compare(&kernel, &built_in()).unwrap_err();
    let message =
        "in double-double, which is the reference, the kernel panics in step 7: the table has no entry 7";
    assert_eq!(refused.to_string(), message);
    let truth = compare(&kernel, &built_in());
    assert!(matches!(truth, Err(Refusal::Reference(Ended::Panicked { step: 7, .. }))));
}

#[test]
fn a_panic_in_one_format_leaves_the_others() {
    struct Coarse;
    impl What for Coarse {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            let table = [0, 1, 2, 3];
            while let Some([x]) = steps.begin() {
                // Finer formats find an entry.
                let place = if x.ldexp(-20) > R::zero() { 3 } else { 4 };
                steps.end([R::from_ratio(table[place], 1)]);
            }
        }
    }
    let kernel = one(Coarse, 5, (0.25, 0.5), Output::named("y").exact());
    let compared = compare(&kernel, &[named("I4F12").unwrap(), named("I8F24").unwrap()]).unwrap();
    assert!(
        matches!(compared.formats[0].ended, Ended::Panicked { step: 0, .. }),
        "{:?}",
        compared.formats[0].ended
    );
    assert_eq!((compared.formats[0].first_bad_step, compared.formats[1].good), (Some(0), true));
    let text = compared.to_string();
    assert!(text.contains("I4F12: the kernel panics in step 0: index out of bounds"), "{text}");
}

#[test]
fn what_is_no_number_is_reported_with_its_step() {
    struct Grows;
    impl What for Grows {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            let mut y = R::from_ratio(2, 1);
            while let Some([_]) = steps.begin() {
                y = (y * y).signal("y");
                steps.end([y]);
            }
        }
    }
    // 2 to the power of 2 to the power of k: an f32 ends at 2¹²⁸, in the seventh square.
    let kernel = one(Grows, 9, (0.0, 1.0), Output::named("y").within_part(0.1));
    let compared =
        compare(&kernel, &[named("f32").unwrap(), named("f64").unwrap(), named("I32F32").unwrap()]).unwrap();
    let [f32, f64, fixed] = &compared.formats[..] else { panic!("three formats") };
    assert_eq!(f32.ended, Ended::NotFinite { output: "y", step: 6 });
    assert_eq!((f32.first_bad_step, f64.good), (Some(6), true));
    assert_eq!(fixed.overflows.as_ref().map(|lost| lost.first_step), Some(4));
}

#[test]
fn inputs_and_constants_that_do_not_fit_are_named() {
    let kernel = one(Biquad, 10, (-9.0, 9.0), Output::named("y").within(0.1));
    let compared = compare(&kernel, &[named("I2F30").unwrap()]).unwrap();
    let Ended::DoesNotFit { signal: "x", step, value } = compared.formats[0].ended else {
        panic!("{:?}", compared.formats[0].ended)
    };
    assert!(step < 10 && value.abs() > 2.0);
    let refused = vectors(&kernel, named("I2F30").unwrap()).unwrap_err();
    assert!(refused.to_string().starts_with("in I2F30 x = "), "{refused}");
    assert!(matches!(price(&kernel, named("I2F30").unwrap(), &[], None), Err(Refusal::Run(..))));
}

/// A kernel whose loop is not as it should be.
struct Wrong(u8);

impl What for Wrong {
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut count = 0;
        while let Some([x]) = steps.begin() {
            count += 1;
            match self.0 {
                0 if count == 3 => return,
                1 => drop(steps.begin::<2>()),
                2 => steps.end([x, x]),
                3 => {}
                _ => steps.end([x]),
            }
        }
    }
}

#[test]
fn a_kernel_that_does_not_keep_to_its_steps_is_told_what_is_expected() {
    for (wrong, message) in [
        (0, "the kernel returns before step 2: expected it to run all steps"),
        (1, "in step 0 the kernel begins another step: expected it to end this one"),
        (2, "in step 0 the kernel ends a step with 2 outputs: expected 1, once in a step that has begun"),
        (3, "in step 0 the kernel begins another step: expected it to end this one"),
    ] {
        let kernel = one(Wrong(wrong), 5, (0.0, 1.0), Output::named("y").within(0.1));
        let refused = compare(&kernel, &built_in()).unwrap_err().to_string();
        assert_eq!(refused, format!("in double-double, which is the reference, {message}"));
    }
}

/// A kernel that ends as it should, and panics then; and one whose panic has no message.
#[test]
fn a_panic_after_the_last_step_and_one_without_a_message_are_reported() {
    struct After;
    impl What for After {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            while let Some([x]) = steps.begin() {
                steps.end([x]);
            }
            panic!("the file is locked");
        }
    }
    struct Silent;
    impl What for Silent {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            if steps.begin::<1>().is_some() {
                std::panic::panic_any(7);
            }
        }
    }
    let output = || Output::named("y").within(0.1);
    let refused =
        |error: Refusal| error.to_string().replace("in double-double, which is the reference, ", "");
    let after = compare(&one(After, 3, (0.0, 1.0), output()), &built_in()).unwrap_err();
    assert_eq!(refused(after), "the kernel panics in step 3: the file is locked");
    let silent = compare(&one(Silent, 3, (0.0, 1.0), output()), &built_in()).unwrap_err();
    assert_eq!(refused(silent), "the kernel panics in step 0: what it panics with is no text");
}

/// Where the right values are known otherwise, formats are judged though the reference panics, and the answer says that it does.
#[test]
fn a_reference_that_panics_is_told_beside_the_formats() {
    let truth = Output::named("y").within(1.0).truth(vec![0.5; 20]);
    let compared = compare(&one(By(|step| step == 7), 20, (0.0, 1.0), truth), &built_in()).unwrap();
    assert!(compared.run("I16F16").is_some_and(|run| run.good));
    let text = compared.to_string();
    assert!(text.contains("double-double: the kernel panics in step 7: the table has no entry 7"), "{text}");
}

/// What is no number inside, but not in an output, is found where it turns a comparison.
#[test]
fn a_state_that_is_no_number_is_found_by_the_way_that_it_turns() {
    struct Hidden;
    impl What for Hidden {
        fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
            let (mut y, mut count) = (R::from_ratio(2, 1), R::zero());
            while let Some([_]) = steps.begin() {
                y = (y * y).signal("y");
                let lost = (y - y).signal("lost");
                count = if lost >= R::zero() { count + R::one() } else { count };
                steps.end([count]);
            }
        }
    }
    let kernel = one(Hidden, 9, (0.0, 1.0), Output::named("count").exact());
    let compared = compare(&kernel, &[named("f32").unwrap(), named("f64").unwrap()]).unwrap();
    let run = compared.run("f32").unwrap();
    // 2¹²⁸ is infinite in an f32, in the seventh square, and its distance from itself no number.
    assert_eq!((&run.ended, run.first_bad_step), (&Ended::Finished, Some(6)));
    let other = run.divergence.as_ref().unwrap();
    assert_eq!((other.step, other.signal, other.holds), (6, Some("lost"), false));
    assert!(compared.run("f64").is_some_and(|run| run.good));
}

#[test]
fn a_kernel_without_outputs_is_refused() {
    struct Nothing;
    impl kernel_size::Kernel for Nothing {
        fn name(&self) -> &'static str {
            "nothing"
        }
        fn steps(&self) -> usize {
            5
        }
        fn inputs(&self) -> Result<Vec<kernel_size::Input>, kernel_size::InputError> {
            Ok(Vec::new())
        }
        fn outputs(&self) -> Vec<Output> {
            Vec::new()
        }
        fn run<R: Real>(&self, _: &mut Steps<'_, R>) {}
    }
    let refused = compare(&Nothing, &built_in()).unwrap_err().to_string();
    assert_eq!(refused, "no output: expected at least one");
}

#[test]
fn requests_without_an_answer_are_refused() {
    let refused = |steps, output| compare(&one(Biquad, steps, (0.0, 1.0), output), &built_in()).unwrap_err();
    let of = |output: Output| refused(5, output).to_string();
    let requirement =
        "output y: expected at least one requirement, and limits that are finite and not below 0";
    assert_eq!(of(Output::named("y")), requirement);
    assert_eq!(of(Output::named("y").within(f64::NAN)), requirement);
    assert_eq!(of(Output::named("y").drift(-1.0)), requirement);
    assert_eq!(
        of(Output::named("y").within(1.0).truth(vec![0.0; 4])),
        "the right course of output y has 4 values: expected 5, one for each step"
    );
    let steps = |steps| refused(steps, Output::named("y").within(1.0)).to_string();
    assert_eq!(steps(0), "0 steps: expected from 1 to 16777216");
    let kernel = one(Biquad, 5, (0.0, 1.0), Output::named("y").within(1.0));
    let unknown = compare(&kernel, &[real::FormatName::fixed(1, 31)]).unwrap_err().to_string();
    assert!(unknown.starts_with("unknown format \"I1F31\": expected f32, f64"), "{unknown}");
}
