//! A kernel of your own as a page: its errors over the steps by format, the ranges of its signals, and what a step costs.

use askama::Template;
use kernel_size::{Comparison, FormatRun, Registers, Sizing, StepPrice};

use crate::chart::{Axis, Layout, draw};
use crate::cost_table::cost_table;
use crate::figure::{Entry, Figure};
use crate::frame::Frame;
use crate::number;
use crate::palette::{DASH_COUNT, HUE_COUNT, series};
use crate::ranges::{self, Ranges};
use crate::report::{Report, files};
use crate::switch::Switch;
use crate::table::{Cell, Column, Table};

/// What the page of a kernel is made of.
#[derive(Clone, Copy, Debug)]
pub struct KernelPage<'a> {
    /// Its runs in several formats.
    pub comparison: &'a Comparison,
    /// The fewest bits that are enough, if they were searched.
    pub sizing: Option<&'a Sizing>,
    /// What a step costs in some formats.
    pub prices: &'a [StepPrice],
    /// The command that makes the page.
    pub command: &'a str,
}

#[derive(Template)]
#[template(path = "kernel.html")]
struct Page<'a> {
    frame: Frame<'a>,
    is_good: bool,
    answer: &'a str,
    lines: Vec<String>,
    formats: &'a Table,
    runs: Vec<Switch>,
    errors: Vec<(&'a Figure, String)>,
    ranges: Vec<(&'a Figure, String)>,
    tables: Vec<&'a Table>,
}

impl KernelPage<'_> {
    /// The page, with a file for each picture and two for each table.
    ///
    /// # Errors
    /// As [`Report::of`].
    pub fn report(&self) -> Result<Report, askama::Error> {
        let runs = views(self.comparison);
        let errors = errors(self.comparison, &runs);
        let ranges: Vec<Figure> = runs.iter().filter_map(RunView::ranges).collect();
        let formats = formats(self.comparison);
        let registers = self.sizing.and_then(|sizing| sizing.registers.as_ref()).map(registers);
        let costs = costs(self.prices);
        let others: Vec<&Table> = registers.iter().chain(&costs).collect();
        let tables = std::iter::once(&formats).chain(others.iter().copied());
        let files = files(errors.iter().chain(&ranges), tables);
        let title = format!("feedbits: {}", self.comparison.kernel);
        let question = "Which format is good enough for this kernel?";
        let lines = self.lines();
        let page = Page {
            frame: Frame::new((title, question), self.comparison.kernel, &files, self.command),
            is_good: self.comparison.recommended.is_some(),
            answer: &lines[0],
            lines: lines[1..].to_vec(),
            formats: &formats,
            runs: runs.iter().map(RunView::switch).collect(),
            errors: errors.iter().map(|figure| (figure, figure.inline())).collect(),
            ranges: ranges.iter().map(|figure| (figure, figure.inline())).collect(),
            tables: others,
        };
        Ok(Report::new(&page.render()?, files))
    }

    /// The answer, and below it what else was found: at least one line.
    fn lines(&self) -> Vec<String> {
        let Comparison { recommended, reference, not_a_question_of_format, steps, .. } = self.comparison;
        let mut lines = vec![match recommended {
            Some(format) => format!("{format} is the narrowest of these formats that is good"),
            None => "None of these formats is good".to_string(),
        }];
        if *not_a_question_of_format {
            lines.push("Double-double is not good either: it is no question of format.".to_string());
        }
        if let Some(uniform) = self.sizing.and_then(|sizing| sizing.uniform.as_ref()) {
            let used = number::short(100.0 * uniform.used());
            let (bits, format) = (uniform.bits, &uniform.format);
            lines.push(format!(
                "{bits} bits are enough for all signals: {format}, with {used} % of what is allowed."
            ));
        }
        if let Some(Registers { bits, uniform_bits, .. }) = self.sizing.and_then(|one| one.registers.as_ref())
        {
            lines.push(format!(
                "A register for each signal takes {bits} bits in all, against {uniform_bits}."
            ));
        }
        lines.push(format!(
            "Every step of {steps} is judged by double-double, or by the right values where they are known."
        ));
        if reference.ended.step().is_some() {
            lines.push(format!("In double-double {}.", reference.ended));
        }
        lines
    }
}

/// A run in the page.
struct RunView<'a> {
    index: usize,
    run: &'a FormatRun,
    hue: usize,
    dash: usize,
    is_recommended: bool,
}

fn views(comparison: &Comparison) -> Vec<RunView<'_>> {
    let recommended = comparison.recommended.as_ref();
    let runs = comparison.formats.iter().enumerate();
    runs.map(|(index, run)| RunView {
        index,
        run,
        hue: index % HUE_COUNT,
        dash: index / HUE_COUNT % DASH_COUNT,
        is_recommended: recommended == Some(&run.format),
    })
    .collect()
}

impl RunView<'_> {
    fn class(&self) -> String {
        series(self.index, self.hue, self.dash)
    }

    fn switch(&self) -> Switch {
        Switch {
            // A run that ended in its first step has no error to show.
            ran: self.run.ended.step() != Some(0),
            good: self.run.good,
            recommended: self.is_recommended,
            ..Switch::new(self.index, self.run.format.clone(), self.hue, self.dash)
        }
    }

    fn ranges(&self) -> Option<Figure> {
        let (name, audit) = (self.run.format.clone(), &self.run.audit);
        ranges::figure(&Ranges {
            index: self.index,
            name,
            hue: self.hue,
            format: &self.run.format,
            signals: &audit.signals,
            histograms: &audit.histograms,
        })
    }
}

/// A picture for each output: its error over the steps, in every format.
fn errors(comparison: &Comparison, runs: &[RunView<'_>]) -> Vec<Figure> {
    let outputs = comparison.formats.first().map_or(&[][..], |run| &run.outputs);
    (0..outputs.len()).map(|place| error_figure(comparison, runs, place)).collect()
}

fn error_figure(comparison: &Comparison, runs: &[RunView<'_>], place: usize) -> Figure {
    let of = |run: &RunView<'_>| -> Vec<(f64, f64)> {
        let course = run.run.outputs.get(place).map_or(&[][..], |output| &output.course);
        course.iter().map(|(step, error)| (*step as f64, *error)).collect()
    };
    let courses: Vec<Vec<(f64, f64)>> = runs.iter().map(of).collect();
    let output = &comparison.formats[0].outputs[place];
    let limits = || output.requirements.iter().filter(|one| one.kind == "absolute").map(|one| one.limit);
    let x = Axis::linear("step [1]", 0.0..comparison.steps as f64);
    let values = courses.iter().flatten().map(|(_, error)| *error).chain(limits());
    let y = Axis::decades("error [unit of the output]", values, DECADES);
    let figure = draw((x, y), &Layout::default(), |plot| {
        limits().for_each(|limit| plot.limit(limit, "limit"));
        for (run, course) in runs.iter().zip(&courses) {
            plot.group(&run.class(), &run.run.format, |plot| plot.line(course));
        }
    });
    let name = format!("error-{place}-{}", output.output);
    let title = format!("Error of {} over the steps, by format", output.output);
    let caption = "The distance from the right value. Errors of 0 lie on the lower edge.";
    let entries = runs.iter().map(|run| Entry::line(&run.class(), &run.run.format)).collect();
    figure.named(&name, &title, caption).following_the_pointer().with_runs(entries)
}

/// Decades of an error that are shown at most.
const DECADES: i32 = 20;

fn formats(comparison: &Comparison) -> Table {
    let columns = [
        ("format", "format"),
        ("bits", "bits"),
        ("verdict", "verdict"),
        ("first_bad_step", "first bad step"),
        ("output", "worst output"),
        ("worst_error", "its largest error"),
        ("worst_step", "in step"),
        ("used_percent", "used of what is allowed [%]"),
        ("what_happened", "what happened"),
    ];
    let row = |run: &FormatRun| {
        let worst = run.outputs.iter().max_by(|one, other| one.worst_error.total_cmp(&other.worst_error));
        let step = |step: usize| Cell::Number(step as f64);
        vec![
            Cell::text(&run.format),
            Cell::Number(run.bits.into()),
            Cell::text(if run.good { "good" } else { "bad" }),
            run.first_bad_step.map_or(Cell::Nothing, step),
            worst.map_or(Cell::Nothing, |worst| Cell::text(worst.output)),
            Cell::maybe(worst.map(|worst| worst.worst_error)),
            worst.map_or(Cell::Nothing, |worst| step(worst.worst_step)),
            Cell::Number(100.0 * run.used()),
            Cell::text(run.remarks().join("; ")),
        ]
    };
    table("formats", "The formats", &columns, comparison.formats.iter().map(row).collect())
}

fn registers(registers: &Registers) -> Table {
    let columns = [("signal", "signal"), ("format", "format"), ("bits", "bits"), ("bound", "at most")];
    let row = |one: &kernel_size::Register| {
        vec![
            Cell::text(one.signal),
            Cell::text(&one.format),
            Cell::Number(one.bits.into()),
            Cell::Number(one.bound),
        ]
    };
    table("registers", "A register for each signal", &columns, registers.signals.iter().map(row).collect())
}

fn costs(prices: &[StepPrice]) -> Option<Table> {
    let mut rows = Vec::new();
    for price in prices {
        let row = |(target, cost)| (vec![Cell::text(target), Cell::text(&price.format)], cost);
        rows.extend(price.targets.iter().map(row));
    }
    cost_table("What a step costs", &[("target", "target"), ("format", "format")], rows)
}

fn table(name: &str, title: &str, columns: &[(&'static str, &'static str)], rows: Vec<Vec<Cell>>) -> Table {
    let columns = columns.iter().map(|(key, heading)| Column { key, heading }).collect();
    Table { name: name.into(), title: title.into(), columns, rows }
}
