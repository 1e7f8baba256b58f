//! The page of a kernel: everything that was found is on it, it needs nothing but the files beside it, and names change
//! no element.

use foreign_text::hostile::NAMES;
use format_report::{KernelPage, Report};
use kernel_size::{Input, InputError, Kernel, Output, Steps, compare, named, price, size};
use real::Real;

/// A sum of thirds, of which a coarse format drifts away and a narrow one overflows.
struct Thirds {
    name: &'static str,
    signal: &'static str,
}

impl Kernel for Thirds {
    fn name(&self) -> &'static str {
        self.name
    }
    fn steps(&self) -> usize {
        3000
    }
    fn inputs(&self) -> Result<Vec<Input>, InputError> {
        Ok(vec![Input::drawn("x", 5, (0.0, 1.0), self.steps())?])
    }
    fn outputs(&self) -> Vec<Output> {
        vec![Output::named(self.signal).within(0.01)]
    }
    fn run<R: Real>(&self, steps: &mut Steps<'_, R>) {
        let mut sum = R::zero();
        while let Some([x]) = steps.begin() {
            sum = (sum + x * R::from_ratio(1, 3)).signal(self.signal);
            steps.end([sum]);
        }
    }
}

const FORMATS: [&str; 4] = ["I12F8", "I4F28", "I16F16", "f64"];

fn report(name: &'static str, signal: &'static str) -> Report {
    let kernel = Thirds { name, signal };
    let formats = FORMATS.map(|name| named(name).expect("a format"));
    let comparison = compare(&kernel, &formats).expect("a comparison");
    let sizing = size(&kernel).expect("a sizing");
    let targets = target_cost::built_in().expect("targets");
    let prices = [price(&kernel, formats[2], &targets, None).expect("a price")];
    let page = KernelPage {
        comparison: &comparison,
        sizing: Some(&sizing),
        prices: &prices,
        command: "a <command>",
    };
    page.report().expect("a page")
}

fn file<'a>(report: &'a Report, name: &str) -> &'a str {
    report.files.iter().find(|file| file.0 == name).map_or_else(|| panic!("{name}"), |file| &file.1)
}

#[test]
fn everything_that_was_found_is_on_the_page() {
    let report = report("thirds", "sum");
    let page = file(&report, Report::PAGE);
    assert!(page.contains("I16F16 is the narrowest of these formats that is good"));
    assert!(
        page.contains("bits are enough for all signals") && page.contains("A register for each signal takes")
    );
    for reference in page.match_indices("href=\"") {
        let target = page[reference.0..].split('"').nth(1).expect("a target");
        assert!(target == "data:," || report.files.iter().any(|(name, _)| name == target), "{target}");
    }
    // A line of a run, of a thousand points at most, and the limit.
    let errors = file(&report, "error-0-sum.svg");
    for format in FORMATS {
        assert!(errors.contains(&format!("data-name=\"{format}\"")), "{format}");
        assert!(report.files.iter().any(|(name, _)| *name == format!("ranges-{format}.svg")), "{format}");
        assert!(page.contains(&format!("</svg>{format}")), "{format} has a switch");
    }
    assert!(errors.contains("limit") && errors.contains("step [1]"));
    let rows = |name: &str| file(&report, name).lines().count() - 1;
    assert_eq!((rows("formats.csv"), rows("registers.csv")), (FORMATS.len(), 2));
    assert_eq!(rows("costs.csv"), target_cost::built_in().expect("targets").len());
    let table = file(&report, "formats.csv");
    assert!(table.contains("\nI12F8,20,bad,"), "{table}");
    assert!(table.contains("I4F28,32,bad,") && table.contains(" first in step "), "{table}");
}

/// Names are words wherever they stand: no element is added by them, and no file leaves the folder.
#[test]
fn names_change_no_element() {
    let elements = |text: &str| text.matches('<').count();
    let plain = report("thirds", "sum");
    for name in NAMES {
        let hostile = report(name, name);
        assert_eq!(hostile.files.len(), plain.files.len(), "{name:?}");
        for ((file, text), (_, expected)) in hostile.files.iter().zip(&plain.files) {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
            assert!(file.chars().all(is_plain) && !file.starts_with('.'), "{file:?}");
            if file.ends_with(".svg") || file.ends_with(".html") {
                assert_eq!(elements(text), elements(expected), "{name:?} in {file}");
            }
        }
    }
}
