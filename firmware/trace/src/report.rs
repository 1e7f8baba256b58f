//! The data file, and the tables of the documentation.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use kernel::Record;
use serde::{Deserialize, Serialize};

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

/// The parts of the file, as they are written.
#[derive(Serialize)]
struct Parts<'a> {
    part: &'a [Part],
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
    min: u64,
    max: u64,
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
    steps: usize,
    checksum: String,
    stack_bytes: usize,
    instructions: Cost,
    /// Branches, calls and returns that left the straight line, per step.
    taken_branches: f64,
    /// Instructions of each class, per step.
    classes: BTreeMap<String, f64>,
}

impl Cost {
    fn new(counts: &Counts, table: Option<&Table>) -> Self {
        let cycles =
            table.and_then(|t| t.price(counts)).map_or(Price::Unknown(Unknown::Unknown), Price::Known);
        let mean = counts.total() as f64 / counts.calls.len().max(1) as f64;
        let min = counts.calls.iter().copied().min().unwrap_or(0);
        let max = counts.calls.iter().copied().max().unwrap_or(0);
        Self { mean: tenths(mean), min, max, cycles }
    }
}

fn tenths(x: f64) -> f64 {
    (x * 10.0).round() / 10.0
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
                format.step.insert(item, Step::new(record, counts, table.as_ref(), *stack));
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
    fn new(record: &Record, counts: &Counts, table: Option<&Table>, stack_bytes: usize) -> Self {
        // The last call only finds that the path is over: no step.
        let mut steps = counts.clone();
        steps.calls.pop();
        let per_step = |count: u64| tenths(count as f64 / counts.calls.len().max(1) as f64);
        let mut instructions = Cost::new(&steps, None);
        instructions.cycles = Cost::new(counts, table).cycles;
        Self {
            steps: steps.calls.len(),
            checksum: format!("{:016x}", record.checksum),
            stack_bytes,
            instructions,
            taken_branches: per_step(counts.classes.values().map(|t| t.taken).sum()),
            classes: counts.classes.iter().map(|(class, t)| (class.to_string(), per_step(t.count))).collect(),
        }
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
    format!("{{ mean = {:.1}, min = {}, max = {}, cycles = {cycles} }}", cost.mean, cost.min, cost.max)
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
            for (path, step) in &format.step {
                let classes: Vec<_> =
                    step.classes.iter().map(|(class, n)| format!("{class} = {n:.1}")).collect();
                let _ = writeln!(
                    text,
                    "[target.format.step.{path}]\nsteps = {}\nchecksum = {:?}\nstack_bytes = {}\n\
                     instructions = {}\ntaken_branches = {:.1}\nclasses = {{ {} }}",
                    step.steps,
                    step.checksum,
                    step.stack_bytes,
                    cost(&step.instructions),
                    step.taken_branches,
                    classes.join(", ")
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
        text.push_str(&toml::to_string(&Parts { part: &data.part }).unwrap_or_default());
    }
    text
}

/// Compares a new measurement with the committed one: checksums must be the same, and counts but for one in fifty if the
/// toolchain is; another compiler may change them, but not by more than a quarter.
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
                if step.checksum != before.checksum {
                    faults
                        .push(format!("{place}: checksum {}, committed {}", step.checksum, before.checksum));
                }
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

/// Names of the paths for readers.
const PATHS: [(&str, &str); 2] =
    [("paper_a", "the seven-point cubic"), ("ten_points", "the ten-point rational cubic")];

/// Writes the tables for readers.
pub(crate) fn render(from: &Path, to: &Path) -> Result<(), Failure> {
    let data = read(from)?;
    let mut page = String::from(
        "<!-- Written by scripts/firmware from data/target-costs.toml: do not edit. -->\n\
         # Cost of a step on controllers\n\n\
         The real-time kernels, unchanged, on the instruction sets of controllers: built for bare metal, run in an \
         emulator, every executed instruction counted, with the feature `cubic` of `secant-interp`. Each run's setpoints are \
         bit for bit those of the host, in every format on every target.\n\n\
         Instructions are exact for the toolchain below. Cycles are estimates: instructions by class, times the manuals' \
         cycles (`firmware/trace/cycles/`, where each row names its place), with memory that never waits; flash wait \
         states come on top. Nothing here was measured on silicon. For Cortex-M7 no table is published, so its cycles are \
         unknown.\n\n",
    );
    page.push_str("| toolchain | |\n|---|---|\n");
    for (key, value) in &data.toolchain {
        let _ = writeln!(page, "| {} | {value} |", key.replace('_', " "));
    }
    part::render(&mut page, &data.part, |target| {
        data.target
            .iter()
            .find(|known| known.name == target)
            .map_or_else(|| target.to_owned(), |t| t.title.clone())
    });
    for (path, title) in PATHS {
        let _ = writeln!(page, "\n## Along {title}\n");
        step_table(&mut page, &data, "Instructions a step, mean (worst)", |f| {
            let step = f.step.get(path)?;
            Some(format!("{:.0} ({})", step.instructions.mean, step.instructions.max))
        });
        step_table(&mut page, &data, "Cycles a step, typical (low–high), mean", |f| {
            Some(match f.step.get(path)?.instructions.cycles {
                Price::Known(c) => format!("{:.0} ({:.0}–{:.0})", c.typical, c.low, c.high),
                Price::Unknown(_) => "unknown".to_owned(),
            })
        });
        step_table(&mut page, &data, "Stack of a step, bytes", |f| {
            Some(f.step.get(path)?.stack_bytes.to_string())
        });
    }
    page.push_str(
        "\n## Operations\n\nMean instructions, with call, loads and store; `copy` is these alone.\n",
    );
    let names: Vec<_> =
        data.target.first().into_iter().flat_map(|t| &t.format).map(|f| f.name.clone()).collect();
    for name in names {
        operation_table(&mut page, &data, &name);
    }
    fs::write(to, page).map_err(|e| format!("{}: {e}", to.display()).into())
}

fn header(page: &mut String, data: &Data, corner: &str) {
    let titles: Vec<_> = data.target.iter().map(|t| t.title.clone()).collect();
    let _ = writeln!(page, "\n| {corner} | {} |\n|---|{}", titles.join(" | "), "---:|".repeat(titles.len()));
}

fn step_table(page: &mut String, data: &Data, corner: &str, cell: impl Fn(&Format) -> Option<String>) {
    header(page, data, corner);
    let Some(first) = data.target.first() else { return };
    for name in first.format.iter().filter(|f| !f.step.is_empty()).map(|f| &f.name) {
        let cells: Vec<_> = data
            .target
            .iter()
            .map(|t| t.format.iter().find(|f| f.name == *name).and_then(&cell).unwrap_or_default())
            .collect();
        let _ = writeln!(page, "| {name} | {} |", cells.join(" | "));
    }
}

fn operation_table(page: &mut String, data: &Data, format: &str) {
    header(page, data, format);
    let of = |target: &Target, operation: &str| {
        let format = target.format.iter().find(|f| f.name == format)?;
        format.operation.get(operation).map(|c| format!("{:.0}", c.mean))
    };
    let Some(first) = data.target.first().and_then(|t| t.format.iter().find(|f| f.name == format)) else {
        return;
    };
    for operation in first.operation.keys() {
        let cells: Vec<_> = data.target.iter().map(|t| of(t, operation).unwrap_or_default()).collect();
        let _ = writeln!(page, "| {} | {} |", operation.replace('_', " "), cells.join(" | "));
    }
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
            assert_eq!((step.steps, step.instructions.mean, step.instructions.max), (2, 11.0, 12));
        }
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
