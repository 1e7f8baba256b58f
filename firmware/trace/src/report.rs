//! The data file, of which `scripts/figures` makes the tables of the documentation.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use kernel::Record;
use serde::Deserialize;

use crate::Failure;
use crate::calls::Counts;
use crate::cycles::{Cycles, Table};
use crate::part::{self, Part};
use crate::target;

/// The data file.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Data {
    toolchain: BTreeMap<String, String>,
    /// Mean operations of a step, by format and path.
    #[serde(default)]
    operations: BTreeMap<String, BTreeMap<String, BTreeMap<String, f64>>>,
    #[serde(default)]
    target: Vec<Target>,
    #[serde(default)]
    part: Vec<Part>,
}

/// All that was measured on one target.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    name: String,
    title: String,
    triple: String,
    machine: String,
    format: Vec<Format>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Format {
    name: String,
    /// Whole runs, by the path's name.
    #[serde(default)]
    step: BTreeMap<String, Step>,
    /// Single operations, their call and operands included.
    #[serde(default)]
    operation: BTreeMap<String, Cost>,
}

/// Instructions of a call, and its cycles.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cost {
    mean: f64,
    /// Of the steps of a run.
    max: Option<u64>,
    cycles: Price,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
enum Price {
    Known(Cycles),
    Unknown(Unknown),
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Unknown {
    Unknown,
}

/// The periods of a run.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Step {
    stack_bytes: usize,
    instructions: Cost,
}

impl Cost {
    fn new(counts: &Counts, table: Option<&Table>) -> Self {
        let cycles =
            table.and_then(|t| t.price(counts)).map_or(Price::Unknown(Unknown::Unknown), Price::Known);
        let mean = counts.total() as f64 / counts.calls.len().max(1) as f64;
        Self { mean: (mean * 10.0).round() / 10.0, max: None, cycles }
    }
}

impl Target {
    /// The counts of all groups of calls, `records`, as rows by format.
    pub(crate) fn new(
        target: &target::Target,
        records: &[Record],
        counts: &[Counts],
        stack: &[usize],
    ) -> Result<Self, Failure> {
        let table = target.cycles.map(Table::parse).transpose()?;
        let mut formats: Vec<Format> = Vec::new();
        for ((record, counts), stack) in records.iter().zip(counts).zip(stack) {
            let index = formats.iter().position(|f| f.name == record.format).unwrap_or(formats.len());
            if index == formats.len() {
                formats.push(Format { name: record.format.to_owned(), ..Format::default() });
            }
            let Some(format) = formats.get_mut(index) else { continue };
            let item = record.item.to_owned();
            if record.symbol.starts_with("k_step_") {
                format.step.insert(item, Step::new(counts, table.as_ref(), *stack));
            } else {
                format.operation.insert(item, Cost::new(counts, table.as_ref()));
            }
        }
        Ok(Self {
            name: target.name.to_owned(),
            title: target.title.to_owned(),
            triple: target.triple.to_owned(),
            machine: target.machine.to_owned(),
            format: formats,
        })
    }
}

impl Step {
    fn new(counts: &Counts, table: Option<&Table>, stack_bytes: usize) -> Self {
        // The last call only finds that the path is over: no step.
        let mut steps = counts.clone();
        steps.calls.pop();
        let max = steps.calls.iter().copied().max();
        let cycles = Cost::new(counts, table).cycles;
        Self { stack_bytes, instructions: Cost { max, cycles, ..Cost::new(&steps, None) } }
    }
}

/// Compares what the target printed with the host's records; returns the stack use of each group.
pub(crate) fn check(host: &[Record], printed: &str) -> Result<Vec<usize>, Failure> {
    let lines: Vec<_> = printed.lines().filter(|line| line.starts_with("record ")).collect();
    if lines.len() != host.len() {
        return Err(format!("the target printed {} records, not {}", lines.len(), host.len()).into());
    }
    let mut stack = Vec::new();
    let mut different = String::new();
    for (line, record) in lines.iter().zip(host) {
        let expected =
            format!("record {} {} {} {:016x} ", record.format, record.item, record.calls, record.checksum);
        match line.strip_prefix(&expected).map(str::parse) {
            Some(Ok(bytes)) => stack.push(bytes),
            _ => {
                let _ = write!(different, "\n  host:   {expected}\n  target: {line}");
            }
        }
    }
    if different.is_empty() { Ok(stack) } else { Err(format!("target and host differ:{different}").into()) }
}

fn read(path: &Path) -> Result<Data, Failure> {
    let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    toml::from_str(&text).map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Writes a part's costs into the file, in place of older ones.
pub(crate) fn merge_part(path: &Path, measured: Part) -> Result<(), Failure> {
    let mut data = if path.exists() { read(path)? } else { Data::default() };
    match data.part.iter_mut().find(|known| known.is_of_same(&measured)) {
        Some(old) => *old = measured,
        None => data.part.push(measured),
    }
    fs::write(path, text(&data)).map_err(|e| format!("{}: {e}", path.display()).into())
}

/// Writes a target's measurement into the file, in place of an older one.
pub(crate) fn merge(
    path: &Path,
    measured: Target,
    toolchain: Vec<(String, String)>,
    emulator: &str,
) -> Result<(), Failure> {
    let mut data = if path.exists() { read(path)? } else { Data::default() };
    data.toolchain.extend(toolchain);
    data.toolchain.insert("emulator".to_owned(), emulator.to_owned());
    for run in tables::operations()? {
        let means = run.per_step.into_iter().map(|(name, mean)| (name.to_owned(), mean)).collect();
        data.operations.entry(run.format).or_default().insert(run.path.to_owned(), means);
    }
    match data.target.iter_mut().find(|t| t.name == measured.name) {
        Some(old) => *old = measured,
        None => data.target.push(measured),
    }
    fs::write(path, text(&data)).map_err(|e| format!("{}: {e}", path.display()).into())
}

fn cost(cost: &Cost) -> String {
    let cycles = match cost.cycles {
        Price::Known(Cycles { low, typical, high }) => {
            format!("{{ low = {low:.1}, typical = {typical:.1}, high = {high:.1} }}")
        }
        Price::Unknown(_) => "\"unknown\"".to_owned(),
    };
    let max = cost.max.map_or_else(String::new, |max| format!(", max = {max}"));
    format!("{{ mean = {:.1}{max}, cycles = {cycles} }}", cost.mean)
}

fn text(data: &Data) -> String {
    let mut text = String::from(
        "# Instructions and cycles on controllers, counted in an emulator. Written by scripts/firmware: do not edit.\n\
         # Instructions are exact for this toolchain. Cycles are estimates from the manuals' tables, mean per call, with\n\
         # memory that never waits. An operation includes its call: loads of the operands, store of the result, return.\n\
         [toolchain]\n",
    );
    for (key, value) in &data.toolchain {
        let _ = writeln!(text, "{key} = {value:?}");
    }
    text.push_str(
        "\n# Operations of a step, mean: counted on the host, the same on every target.\n[operations]\n",
    );
    for (format, paths) in &data.operations {
        for (path, means) in paths {
            let means: Vec<_> = means.iter().map(|(name, mean)| format!("{name} = {mean}")).collect();
            let _ = writeln!(text, "{format}.{path} = {{ {} }}", means.join(", "));
        }
    }
    for target in &data.target {
        let _ = writeln!(
            text,
            "\n[[target]]\nname = {:?}\ntitle = {:?}\ntriple = {:?}\nmachine = {:?}",
            target.name, target.title, target.triple, target.machine
        );
        for format in &target.format {
            let _ = writeln!(text, "\n[[target.format]]\nname = {:?}", format.name);
            for (path, Step { stack_bytes, instructions }) in &format.step {
                let instructions = cost(instructions);
                let _ = writeln!(
                    text,
                    "step.{path} = {{ stack_bytes = {stack_bytes}, instructions = {instructions} }}"
                );
            }
            text.push_str("[target.format.operation]\n");
            for (operation, c) in &format.operation {
                let _ = writeln!(text, "{operation} = {}", cost(c));
            }
        }
    }
    if !data.part.is_empty() {
        text.push_str("\n# Parts as `feedbits compile` ships them, by what a period passes.\n");
    }
    let parts: Vec<_> = data.part.iter().map(Part::text).collect();
    text + &parts.join("\n")
}

/// Compares a new measurement with the committed one: counts must be the same but for one in fifty if the toolchain is;
/// another compiler may change them, but not by more than a quarter.
pub(crate) fn compare(committed: &Path, new: &Path) -> Result<(), Failure> {
    const SAME_TOOLCHAIN: f64 = 0.02;
    const ANOTHER_TOOLCHAIN: f64 = 0.25;
    let (old, new) = (read(committed)?, read(new)?);
    let same =
        ["rustc", "library", "opt_level"].iter().all(|k| old.toolchain.get(*k) == new.toolchain.get(*k));
    let tolerance = if same { SAME_TOOLCHAIN } else { ANOTHER_TOOLCHAIN };
    let mut faults = Vec::new();
    let mut compared = 0;
    for target in &new.target {
        let Some(before) = old.target.iter().find(|t| t.name == target.name) else { continue };
        for format in &target.format {
            let Some(before) = before.format.iter().find(|f| f.name == format.name) else { continue };
            for (path, step) in &format.step {
                let Some(before) = before.step.get(path) else { continue };
                let (now, then) = (step.instructions.mean, before.instructions.mean);
                compared += 1;
                let place = format!("{} {} {path}", target.name, format.name);
                if (now / then - 1.0).abs() > tolerance {
                    faults.push(format!("{place}: {now:.1} instructions a step, committed {then:.1}"));
                }
            }
        }
    }
    for part in &new.part {
        let Some(before) = old.part.iter().find(|known| known.is_of_same(part)) else { continue };
        compared += 1;
        faults.extend(part::differences(before, part, tolerance));
    }
    if faults.is_empty() && compared > 0 {
        let kind = if same { "within 2 % of" } else { "within a quarter of" };
        println!("{compared} runs: counts {kind} the committed ones");
        return Ok(());
    }
    Err(format!("{compared} runs compared with the committed file:\n  {}", faults.join("\n  ")).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_can_be_read() {
        let counts = Counts { calls: vec![10, 12, 3], ..Counts::default() };
        let record =
            |symbol, item| Record { format: "f32", item, symbol, calls: 3, checksum: 7, stack_bytes: 0 };
        let records = [record("k_step_f32", "paper_a"), record("k_mul_f32", "mul")];
        for name in ["cortex-m7", "cortex-m3"] {
            let target = target::find(name).unwrap();
            let measured =
                Target::new(&target, &records, &[counts.clone(), counts.clone()], &[96, 0]).unwrap();
            let mut data = Data { target: vec![measured], ..Data::default() };
            data.toolchain.insert("rustc".into(), "1 \"quoted\"".into());
            let again: Data = toml::from_str(&text(&data)).unwrap();
            assert_eq!(text(&again), text(&data));
            let step = &again.target[0].format[0].step["paper_a"];
            assert_eq!((step.instructions.mean, step.instructions.max), (11.0, Some(12)));
        }
    }

    /// A run of the script changes only what it counts.
    #[test]
    fn the_committed_file_is_as_it_is_written() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/target-costs.toml");
        assert_eq!(text(&read(&file).unwrap()), fs::read_to_string(&file).unwrap());
    }

    #[test]
    fn a_different_checksum_is_a_failure() {
        let record = Record {
            format: "f32",
            item: "mul",
            symbol: "k_mul_f32",
            calls: 16,
            checksum: 0xab,
            stack_bytes: 0,
        };
        assert_eq!(check(&[record], "record f32 mul 16 00000000000000ab 40\n").unwrap(), [40]);
        let failure = check(&[record], "record f32 mul 16 00000000000000ac 40\n").unwrap_err();
        assert!(failure.to_string().contains("differ"), "{failure}");
        assert!(check(&[record], "").is_err());
    }
}
