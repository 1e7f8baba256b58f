//! `feedbits size`: the fewest bits that are enough.

mod types;

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use format_compare::{
    Dimension, Engine, ExactPlan, FrontPoint, Machine, Mixed, Options, Problem, Register, Sizing, Space,
    Vectors,
};
use real::{Datapath, FormatName, Overflow, Rounding};
use serde::Serialize;
use serde_json::Value;
use target_cost::Target;
use types::Language;

use crate::baseline::{self, Baseline, BaselineArguments};
use crate::bounds::expect_few_vectors;
use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input, in_part};
use crate::interpolate::{vectors_folder, write_vectors};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::screen::{self, times};
use crate::set::baseline::SetBaseline;
use crate::set::parts::{Given, Parts};
use crate::set::work::{OfEachPart, OwnAnswer, Worked};
use crate::set::{self, Outputs};
use crate::targets::TargetArguments;
use crate::{interrupt, output, period_costs};

/// Options of `size`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    parts: Parts,
    #[command(flatten)]
    run: RunArguments,
    /// How the datapath rounds products, quotients, roots and shifts.
    #[arg(long, value_enum, default_value_t = RoundingName::Nearest)]
    rounding: RoundingName,
    /// What sums and products do that do not fit. Quotients and roots saturate in any case.
    #[arg(long, value_enum, default_value_t = OverflowName::Wrap)]
    overflow: OverflowName,
    /// Write the registers of the signals as types of this language, in place of the report.
    #[arg(long, value_enum, value_name = "LANGUAGE", conflicts_with = "json")]
    types: Option<Language>,
    /// Write test vectors of the run with these registers into this folder: the setpoint of each period, and the word of each register,
    /// in its own width, as CSV and as memory images.
    #[arg(long, value_name = "FOLDER")]
    vectors: Option<PathBuf>,
    #[command(flatten)]
    targets: TargetArguments,
    #[command(flatten)]
    baseline: BaselineArguments,
    #[command(flatten)]
    output: output::Output,
}

/// Ways of rounding, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RoundingName {
    /// To nearest, ties up.
    Nearest,
    /// To nearest, ties to even.
    Even,
    /// Toward -∞: the bits are dropped, which takes no adder.
    Floor,
    /// Toward zero.
    Zero,
}

/// Ways of overflowing, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OverflowName {
    /// The high bits are lost.
    Wrap,
    /// The nearest extreme is taken.
    Saturate,
}

impl Arguments {
    fn datapath(&self) -> Datapath {
        let rounding = match self.rounding {
            RoundingName::Nearest => Rounding::Nearest,
            RoundingName::Even => Rounding::NearestEven,
            RoundingName::Floor => Rounding::Floor,
            RoundingName::Zero => Rounding::TowardZero,
        };
        let overflow = match self.overflow {
            OverflowName::Wrap => Overflow::Wrap,
            OverflowName::Saturate => Overflow::Saturate,
        };
        Datapath { rounding, overflow }
    }
}

/// Searches and prints the result.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    match arguments.parts.given() {
        Given::One(input) => run_one(&input, arguments),
        Given::Set(parts) => run_set(parts, arguments),
    }
}

/// Searches for each part of a set, and prints what is enough for all of them.
fn run_set(parts: &Parts, arguments: &Arguments) -> Result<Ending> {
    if arguments.vectors.is_some() {
        bail!("--vectors: the registers of one part have words: expected one part, or no --vectors");
    }
    if arguments.types.is_some() {
        bail!("--types: the registers of one part become types: expected one part, or no --types");
    }
    let targets = arguments.targets.read()?;
    let work = SizeEach { arguments, targets: &targets };
    let outputs = Outputs {
        out: arguments.output.place()?,
        folder: None,
        json: arguments.output.json,
        targets: &targets,
        baseline: SetBaseline::read(&arguments.baseline, SizeEach::COMMAND)?,
    };
    set::run(&work, parts, &arguments.run, &outputs)
}

/// The search for each part of a set.
struct SizeEach<'a> {
    arguments: &'a Arguments,
    targets: &'a [Target],
}

impl OfEachPart for SizeEach<'_> {
    const COMMAND: &'static str = "size";

    fn options(&self) -> Result<String> {
        let run = &self.arguments.run;
        Ok(format!("{:?} {:?} {:?}", run.options()?, self.datapath(), run.fluctuation()))
    }

    fn datapath(&self) -> Datapath {
        self.arguments.datapath()
    }

    fn options_for<const D: usize>(&self, problem: &Problem<D>) -> Result<Options> {
        Ok(Options { interrupt: Some(interrupt::flag()), ..self.arguments.run.options_for(problem)? })
    }

    fn work<const D: usize>(&self, problem: &Problem<D>, part_checksum: u32) -> Result<Worked>
    where
        Space: Dimension<D>,
    {
        let options = self.options_for(problem)?;
        let (found, plan) = sized(problem, &options, self.datapath(), self.targets)?;
        let json = baseline::json(Self::COMMAND, part_checksum, &found)?;
        Ok(Worked { json, plan: Some(plan) })
    }

    fn plan<const D: usize>(&self, problem: &Problem<D>) -> Result<Option<ExactPlan>>
    where
        Space: Dimension<D>,
    {
        Ok(Some(planned(problem, &self.options_for(problem)?)?))
    }

    fn own_answer(&self, result: &Value) -> OwnAnswer {
        let format = result["uniform"]["format"].as_str().and_then(FormatName::named);
        match format {
            Some(format) => OwnAnswer::Found { format, margin: result["uniform_margin"].as_f64() },
            None => {
                let widest = result["tried"].as_array().and_then(|tried| tried.last());
                let reasons = widest.map_or(&Value::Null, |run| &run["verdict"]["reasons"]);
                let first = reasons.as_str().or_else(|| reasons[0].as_str()).unwrap_or_default();
                OwnAnswer::None(format!("48 bits are not enough: {first}"))
            }
        }
    }
}

/// Searches for one part and prints the result.
fn run_one(input: &Input, arguments: &Arguments) -> Result<Ending> {
    let folder = arguments.vectors.as_deref().map(vectors_folder).transpose()?;
    let out = arguments.output.place()?;
    let part = input.text()?;
    let baseline = arguments.baseline.read("size", &part)?;
    let targets = arguments.targets.read()?;
    let (found, types, vectors) = match arguments.run.problem_of(input, &part)? {
        AnyProblem::Planar(problem) => {
            in_part(&problem, size(&problem, arguments, &targets, baseline.as_ref()))?
        }
        AnyProblem::Spatial(problem) => {
            in_part(&problem, size(&problem, arguments, &targets, baseline.as_ref()))?
        }
    };
    let sizing = &found.sizing;
    let is_met = if arguments.types.is_some() { sizing.mixed.is_some() } else { sizing.uniform.is_some() };
    let text = match (arguments.output.json, arguments.types, types) {
        (true, ..) => baseline::json("size", part.checksum(), &found)?,
        (false, None, _) => report(sizing) + &period_costs::of_sizing(sizing, &targets),
        (false, Some(_), Some(types)) => types,
        (false, Some(_), None) => {
            output::say(&format!("feedbits: no types are written. {}", answer(sizing)));
            return Ok(Ending::RequirementNotMet);
        }
    };
    if let (Some(folder), Some(vectors)) = (&folder, &vectors) {
        write_vectors(folder, vectors)?;
    } else if folder.is_some() {
        output::say("feedbits: no test vectors are written: no registers are enough");
    }
    output::write(&out, &text)?;
    let ending = if is_met { Ending::Good } else { Ending::RequirementNotMet };
    baseline.map_or(Ok(ending), |baseline| baseline.judge(&found, ending))
}

/// The result of a search, and of what it is one.
#[derive(Serialize)]
struct Found {
    part: PartName,
    machine: Machine,
    #[serde(flatten)]
    sizing: Sizing,
}

/// The part, as `compare` names it too.
#[derive(Serialize)]
struct PartName {
    name: String,
}

/// The result of the search, and its registers in the language that is asked for, if there are any.
fn size<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
    targets: &[Target],
    baseline: Option<&Baseline>,
) -> Result<(Found, Option<String>, Option<Vectors>)>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    expect_pieces(&options)?;
    baseline.map_or(Ok(()), |baseline| baseline.expect_machine(&problem.machine))?;
    if arguments.vectors.is_some() {
        expect_few_vectors(problem, &options)?;
    }
    let progress = Progress::spinning("running the path in formats of 12 to 48 bits");
    let datapath = arguments.datapath();
    let (found, plan) = sized(problem, &options, datapath, targets)?;
    let vectors = match arguments.vectors {
        Some(_) => {
            format_compare::register_vectors(&found.sizing, problem, &plan, &options, datapath.rounding)?
        }
        None => None,
    };
    progress.finish();
    let sizing = &found.sizing;
    let (part, fluctuation_limit) = (problem.name.as_str(), problem.machine.fluctuation_limit);
    let types =
        sizing.mixed.as_ref().zip(arguments.types).map(|(mixed, language)| {
            types::in_language(mixed, datapath, (part, fluctuation_limit), language)
        });
    Ok((found, types, vectors))
}

/// Refuses other forms of the path, for which there are no registers.
fn expect_pieces(options: &Options) -> Result<()> {
    if options.engine != Engine::Pieces {
        bail!("registers are sized for compiled pieces: give --evaluate pieces, or nothing");
    }
    Ok(())
}

/// The result of the search, and the plan that it followed.
fn sized<const D: usize>(
    problem: &Problem<D>,
    options: &Options,
    datapath: Datapath,
    targets: &[Target],
) -> Result<(Found, ExactPlan)>
where
    Space: Dimension<D>,
{
    let plan = planned(problem, options)?;
    let mut sizing = format_compare::size(problem, &plan, options, datapath)?;
    if !targets.is_empty() {
        format_compare::price_sizing(&mut sizing, problem, &plan, options, targets)?;
    }
    let (part, machine) = (PartName { name: problem.name.clone() }, problem.machine.clone());
    Ok((Found { part, machine, sizing }, plan))
}

/// The plan that the runs of the search follow.
fn planned<const D: usize>(problem: &Problem<D>, options: &Options) -> Result<ExactPlan>
where
    Space: Dimension<D>,
{
    expect_pieces(options)?;
    let formats = selected::<D>(&["f64".to_string()])?;
    Ok(format_compare::plan_for(problem, formats[0].as_ref(), options)?)
}

/// The width that is enough, or why none is.
fn answer(sizing: &Sizing) -> String {
    match (&sizing.uniform, sizing.uniform_margin) {
        (Some(row), Some(margin)) => {
            format!("{} bits are enough: {}, {} better than asked.", row.bits, row.format, times(margin))
        }
        _ => {
            let widest = sizing.tried.last();
            let widest = widest.map(|row| format!("The widest, {}: {}.", row.format, row.verdict));
            let why = sizing.not_a_question_of_format.as_ref().map(ToString::to_string);
            let lines = ["No format of up to 48 bits meets the requirements.".to_string()].into_iter();
            lines.chain(widest).chain(why).collect::<Vec<_>>().join("\n")
        }
    }
}

/// The result of a search without its costs on targets.
pub(crate) fn report(sizing: &Sizing) -> String {
    let point = |point: &FrontPoint| {
        let good = if point.good { "good enough" } else { "" };
        vec![
            point.format.clone(),
            point.bits.to_string(),
            format!("{:.1e}", point.fluctuation),
            good.to_string(),
        ]
    };
    let (mixed, registers) = sizing.mixed.as_ref().map(registers).unwrap_or_default();
    screen::answer(&answer(sizing))
        + &mixed
        + "\nBits against fluctuation, one format for all signals:\n"
        + &screen::table(&["format", "bits", "fluctuation", ""], sizing.front.iter().map(point).collect())
        + &registers
        + &format!("\n{} runs of the whole path.\n", sizing.runs)
}

/// The bits that a register for each signal saves, and the registers.
fn registers(mixed: &Mixed) -> (String, String) {
    let said = screen::paragraph(&format!(
        "With a register for each signal {} bits in all, against {} in one format; fluctuation {:.1e}, {} better than asked.",
        mixed.bits,
        mixed.uniform_bits,
        mixed.fluctuation,
        times(mixed.margin)
    ));
    let row = |signal: &Register| {
        vec![
            signal.signal.to_string(),
            signal.group.to_string(),
            signal.format.clone(),
            signal.bits.to_string(),
            format!("{:.4}", signal.bound),
        ]
    };
    let table = screen::table(
        &["signal", "group", "format", "bits", "proven bound"],
        mixed.signals.iter().map(row).collect(),
    );
    (said, format!("\nA register for each signal:\n{table}"))
}
