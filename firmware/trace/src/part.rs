//! What a part costs as `feedbits compile` ships it, by what its periods pass.

use kernel::{OwnPart, PeriodKind, Record};
use serde::Deserialize;

use crate::Failure;
use crate::calls::Counts;

/// A compiled part on one target.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Part {
    /// The program, for readers.
    pub(crate) program: String,
    pub(crate) target: String,
    pub(crate) format: String,
    pub(crate) stack_bytes: usize,
    /// The start of a section.
    start: Instructions,
    /// All periods.
    period: Instructions,
    /// The periods of each kind that the part has.
    kind: Vec<Kind>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Kind {
    name: String,
    #[serde(flatten)]
    period: Instructions,
}

/// Instructions of calls.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
struct Instructions {
    calls: usize,
    mean: f64,
    median: u64,
    /// At most so many in 99 of 100 calls.
    p99: u64,
    max: u64,
}

impl Instructions {
    /// `None` for no calls.
    fn of(mut calls: Vec<u64>) -> Option<Self> {
        calls.sort_unstable();
        let at = |percent: usize| calls.get((calls.len() * percent).div_ceil(100).saturating_sub(1)).copied();
        let mean = calls.iter().sum::<u64>() as f64 / calls.len() as f64;
        Some(Self {
            calls: calls.len(),
            mean: (mean * 10.0).round() / 10.0,
            median: at(50)?,
            p99: at(99)?,
            max: at(100)?,
        })
    }

    /// As keys of the data file.
    fn text(&self) -> String {
        let Self { calls, mean, median, p99, max } = self;
        format!("calls = {calls}, mean = {mean:.1}, median = {median}, p99 = {p99}, max = {max}")
    }
}

impl Part {
    /// The counts of an image's two groups of calls, starts and periods, whose kinds the host has found.
    pub(crate) fn new(
        (program, target): (&str, &str),
        own: &OwnPart,
        records: &[Record],
        (counts, stack): (&[Counts], &[usize]),
        kinds: &[PeriodKind],
    ) -> Result<Self, Failure> {
        let ([_, record], [starts, periods], [starting, stepping]) = (records, counts, stack) else {
            return Err("the image of a part makes two groups of calls".into());
        };
        if record.checksum != own.judged {
            let (found, judged) = (record.checksum, own.judged);
            return Err(
                format!("the run has the checksum {found:#018x}, and the judged one {judged:#018x}").into()
            );
        }
        if kinds.len() != periods.calls.len() {
            let (found, known) = (periods.calls.len(), kinds.len());
            return Err(format!("{found} periods on the target, {known} on the host").into());
        }
        let of_kind = |kind: PeriodKind| {
            let calls = periods.calls.iter().zip(kinds).filter(|(_, found)| **found == kind);
            let period = Instructions::of(calls.map(|(count, _)| *count).collect())?;
            Some(Kind { name: kind.name().to_owned(), period })
        };
        Ok(Self {
            program: program.to_owned(),
            target: target.to_owned(),
            format: own.format.to_string(),
            stack_bytes: *starting.max(stepping),
            start: Instructions::of(starts.calls.clone()).ok_or("the part has no section")?,
            period: Instructions::of(periods.calls.clone()).ok_or("the part has no period")?,
            kind: PeriodKind::ALL.into_iter().filter_map(of_kind).collect(),
        })
    }

    /// Whether this is the other's place in the data file.
    pub(crate) fn is_of_same(&self, other: &Self) -> bool {
        (&self.program, &self.target, &self.format) == (&other.program, &other.target, &other.format)
    }

    /// The rows of its table: name, calls, share of the periods, and instructions.
    fn rows(&self) -> Vec<[String; 7]> {
        let share = |calls: usize| format!("{:.2} %", 100.0 * calls as f64 / self.period.calls as f64);
        let row = |name: &str, found: &Instructions, share: String| {
            let Instructions { calls, mean, median, p99, max } = found;
            [
                name.to_owned(),
                calls.to_string(),
                share,
                format!("{mean:.0}"),
                median.to_string(),
                p99.to_string(),
                max.to_string(),
            ]
        };
        let kinds = self.kind.iter().map(|kind| row(&kind.name, &kind.period, share(kind.period.calls)));
        kinds
            .chain([
                row("all periods", &self.period, share(self.period.calls)),
                row("setting a run to its begin", &self.start, String::new()),
            ])
            .collect()
    }

    /// Its table of the data file.
    pub(crate) fn text(&self) -> String {
        let Self { program, target, format, stack_bytes, start, period, kind } = self;
        let kinds: Vec<_> = kind
            .iter()
            .map(|Kind { name, period }| format!("    {{ name = {name:?}, {} }},\n", period.text()))
            .collect();
        format!(
            "[[part]]\nprogram = {program:?}\ntarget = {target:?}\nformat = {format:?}\nstack_bytes = {stack_bytes}\n\
             start = {{ {} }}\nperiod = {{ {} }}\nkind = [\n{}]\n",
            start.text(),
            period.text(),
            kinds.concat()
        )
    }

    /// For the screen.
    pub(crate) fn print(&self) {
        println!(
            "{}, {}: {} periods as they were judged, {} bytes of stack",
            self.target, self.format, self.period.calls, self.stack_bytes
        );
        for row in [HEADER.map(str::to_owned)].into_iter().chain(self.rows()) {
            let [name, numbers @ ..] = row;
            let numbers = numbers.map(|number| format!("{number:>9}")).concat();
            println!("    {name:<28}{numbers}");
        }
    }
}

const HEADER: [&str; 7] = ["a period's instructions", "periods", "share", "mean", "median", "p99", "worst"];

/// What of a new measurement is beyond `tolerance` of the committed one.
pub(crate) fn differences(committed: &Part, new: &Part, tolerance: f64) -> Vec<String> {
    let place = format!("{} {} {}", new.program, new.target, new.format);
    let mut faults = Vec::new();
    for (what, now, then) in [
        ("mean", new.period.mean, committed.period.mean),
        ("worst", new.period.max as f64, committed.period.max as f64),
    ] {
        if (now / then - 1.0).abs() > tolerance {
            faults.push(format!("{place}: {now:.1} instructions a period, {what}, committed {then:.1}"));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use real::Backend;

    use super::*;

    fn part() -> Result<Part, Failure> {
        let own = OwnPart { format: f32::name(), judged: 7 };
        let record = |item, checksum| Record {
            format: "own",
            item,
            symbol: "k_step_part",
            calls: 3,
            checksum,
            stack_bytes: 0,
        };
        let counts = |calls: &[u64]| Counts { calls: calls.to_vec(), ..Counts::default() };
        let counts = [counts(&[500]), counts(&[300, 100, 900, 110])];
        let kinds = [PeriodKind::Start, PeriodKind::Common, PeriodKind::Knot, PeriodKind::Common];
        let records = [record("start", 1), record("part", 7)];
        Part::new(("a part", "cortex-m3"), &own, &records, (&counts, &[96, 90]), &kinds)
    }

    #[test]
    fn periods_are_counted_by_their_kind() {
        let part = part().unwrap();
        let rows: Vec<_> =
            part.rows().into_iter().map(|row| format!("{}: {} of {}", row[0], row[6], row[1])).collect();
        assert_eq!(
            rows,
            [
                "common: 110 of 2",
                "knot: 900 of 1",
                "start: 300 of 1",
                "all periods: 900 of 4",
                "setting a run to its begin: 500 of 1"
            ]
        );
        assert_eq!(part.period, Instructions { calls: 4, mean: 352.5, median: 110, p99: 900, max: 900 });
    }

    #[test]
    fn a_worse_period_is_a_difference() {
        let committed = part().unwrap();
        let mut new = committed.clone();
        assert!(differences(&committed, &new, 0.02).is_empty());
        new.period.max = 930;
        assert_eq!(differences(&committed, &new, 0.02).len(), 1);
    }
}
