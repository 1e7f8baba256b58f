//! Options for planning and running a part, which several subcommands share.

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use clap_complete::ArgValueCandidates;
use domains::options::{END_FEED, FLUCTUATION, PIECE_LENGTH, SOLVER_TOLERANCE, START_FEED, WINDOW};
use format_compare::{Engine, Options, PlanIn, Problem, ProfileKind};
use part_program::{Machine, Part};

use crate::bounds::{expect_an_end, expect_few_pieces};
use crate::candidates;
use crate::formats::named;
use crate::input::{AnyProblem, Input, Text};
use crate::numbers::number;
use crate::output;

/// Options for planning and running a part.
#[derive(Args)]
pub(crate) struct RunArguments {
    /// Form of the path in real time. Default: pieces; `compare`, `servo` and `sweep` run both, side by side.
    #[arg(long, value_enum)]
    evaluate: Option<EvaluateName>,
    /// Solver of the next parameter. Newton goes with pieces, the others with de-boor.
    #[arg(long, value_enum)]
    solver: Option<SolverName>,
    /// Longest compiled piece, in mm.
    #[arg(long, value_name = "MM", default_value_t = 32.0, value_parser = number(&PIECE_LENGTH))]
    piece_length: f64,
    #[command(flatten)]
    plan: PlanArguments,
    /// Fluctuation that is good enough, in place of the machine file's `fluctuation_limit`.
    #[arg(long, value_name = "RATIO", value_parser = number(&FLUCTUATION))]
    fluctuation: Option<f64>,
    /// Fluctuation that the solver stops at. Default: the one that is good enough with de-boor, else the format's
    /// resolution.
    #[arg(long, value_name = "RATIO", value_parser = number(&SOLVER_TOLERANCE))]
    solver_tolerance: Option<f64>,
}

/// Options for planning a part.
#[derive(Args)]
pub(crate) struct PlanArguments {
    /// The format to plan in: a format's name, or `same` for each its own.
    #[arg(long, value_name = "F", default_value = "f64", add = ArgValueCandidates::new(candidates::planners))]
    plan_in: String,
    /// How the plan changes from one feed to another.
    #[arg(long, value_enum, default_value_t = ProfileName::Fastest)]
    profile: ProfileName,
    /// Feed at the start of the path, in mm/s.
    #[arg(long, value_name = "MM_PER_S", default_value_t = 0.0, value_parser = number(&START_FEED))]
    start_feed: f64,
    /// Feed at the end of the path, in mm/s.
    #[arg(long, value_name = "MM_PER_S", default_value_t = 0.0, value_parser = number(&END_FEED))]
    end_feed: f64,
    /// Look ahead no further than this, in mm, as a controller does that streams a long program: what a plan of so much of
    /// the path says becomes setpoints while the next is made. Plans from rest to rest.
    #[arg(
        long,
        value_name = "MM",
        conflicts_with_all = ["start_feed", "end_feed"],
        value_parser = number(&WINDOW)
    )]
    window: Option<f64>,
}

/// Forms of the path, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum EvaluateName {
    /// One global parameter, de Boor's scheme each time.
    DeBoor,
    /// Compiled pieces.
    Pieces,
}

/// Solvers, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SolverName {
    /// Secant iteration on the chord.
    Secant,
    /// First-order Taylor expansion.
    #[value(name = "taylor-1")]
    Taylor1,
    /// Second-order Taylor expansion.
    #[value(name = "taylor-2")]
    Taylor2,
    /// Newton's correction of the step per chord.
    Newton,
}

/// Kinds of transitions, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ProfileName {
    /// Pieces of constant jerk that carry acceleration through the minima of the limit: within half a percent of the
    /// fastest plan.
    Fastest,
    /// Cubic polynomials of time.
    Cubic,
    /// Pieces of constant jerk between constant feeds.
    SCurve,
    /// Half-cosines.
    Trigonometric,
    /// S-curves, and half-cosines over stretches whose limit changes again before a transition has ended.
    Flexible,
    /// Without look-ahead, as a baseline: each period takes the feed that the path allows where the period begins. It keeps
    /// neither acceleration nor jerk in bends.
    None,
    /// All of them side by side; for `plan` only.
    All,
}

impl PlanArguments {
    /// Whether the profile is `flexible`, or the default, which an option that is about `flexible` alone replaces.
    pub(crate) fn allows_flexible(&self) -> bool {
        matches!(self.profile, ProfileName::Flexible | ProfileName::Fastest)
    }

    /// The kinds of transitions that the options name.
    pub(crate) fn profiles(&self) -> &'static [ProfileKind] {
        use ProfileKind::{Cubic, Fastest, Flexible, SCurve, Trigonometric, WithoutLookAhead};
        match self.profile {
            ProfileName::Cubic => &[Cubic],
            ProfileName::SCurve => &[SCurve],
            ProfileName::Trigonometric => &[Trigonometric],
            ProfileName::Flexible => &[Flexible],
            ProfileName::Fastest => &[Fastest],
            ProfileName::None => &[WithoutLookAhead],
            ProfileName::All => &[Cubic, SCurve, Trigonometric, Flexible, Fastest, WithoutLookAhead],
        }
    }

    /// Says on the screen how much of the path a plan sees, if that is not all of it.
    pub(crate) fn note_window(&self) {
        if let Some(window) = self.window {
            output::note(&format!("the plan is made with {window} mm of the path in view at a time"));
        }
    }

    /// The options of a plan of one kind of transitions.
    pub(crate) fn options(&self, profile: ProfileKind) -> Result<Options> {
        let plan_in = match self.plan_in.as_str() {
            "" | "f64" => PlanIn::default(),
            "same" => PlanIn::Same,
            name => PlanIn::Format(
                named(name)
                    .with_context(|| format!("--plan-in {name}, where `same` is each format its own"))?,
            ),
        };
        let end_feeds_mm_per_s = [self.start_feed, self.end_feed];
        Ok(Options { plan_in, profile, end_feeds_mm_per_s, window_mm: self.window, ..Options::default() })
    }
}

impl RunArguments {
    /// Reads the problem to plan and run. Notes say what the run leaves out.
    pub(crate) fn problem(&self, input: &Input) -> Result<AnyProblem> {
        self.problem_of(input, &input.text()?)
    }

    /// As [`problem`](Self::problem), of a text that is at hand.
    pub(crate) fn problem_of(&self, input: &Input, text: &Text) -> Result<AnyProblem> {
        let (part, machine) = self.part_and_machine(input, text)?;
        AnyProblem::new(&part, &machine)
    }

    /// Reads the part and its machine. If the options give a fluctuation, it replaces the file's.
    pub(crate) fn part_and_machine(&self, input: &Input, text: &Text) -> Result<(Part, Machine)> {
        let (part, machine) = input.part_and_machine_of(text)?;
        Ok((part, self.with_fluctuation(machine)))
    }

    /// The machine with the fluctuation that the options give, if they give one.
    pub(crate) fn with_fluctuation(&self, machine: Machine) -> Machine {
        let fluctuation_limit = self.fluctuation.unwrap_or(machine.fluctuation_limit);
        Machine { fluctuation_limit, ..machine }
    }

    /// The fluctuation that the options give.
    pub(crate) fn fluctuation(&self) -> Option<f64> {
        self.fluctuation
    }

    /// The engines that the options name; both forms of the path if they name none.
    pub(crate) fn engines(&self) -> Result<Vec<Engine>> {
        use EvaluateName::{DeBoor, Pieces};
        use SolverName::{Newton, Secant, Taylor1, Taylor2};
        Ok(match (self.evaluate, self.solver) {
            (None, None) => vec![Engine::DeBoorSecant, Engine::Pieces],
            (Some(DeBoor), None) | (Some(DeBoor) | None, Some(Secant)) => vec![Engine::DeBoorSecant],
            (Some(DeBoor) | None, Some(Taylor1)) => vec![Engine::DeBoorTaylor1],
            (Some(DeBoor) | None, Some(Taylor2)) => vec![Engine::DeBoorTaylor2],
            (Some(Pieces), None) | (Some(Pieces) | None, Some(Newton)) => vec![Engine::Pieces],
            (Some(DeBoor), Some(Newton)) => bail!("--solver newton runs on pieces: give --evaluate pieces"),
            (Some(Pieces), Some(_)) => {
                bail!("on pieces the solver is newton; the others go with --evaluate de-boor")
            }
        })
    }

    /// Whether the options name an engine.
    pub(crate) fn names_engine(&self) -> bool {
        self.evaluate.is_some() || self.solver.is_some()
    }

    /// The options of a run. If there are several engines, the last one is used.
    pub(crate) fn options(&self) -> Result<Options> {
        let [profile] = *self.plan.profiles() else {
            bail!("--profile all goes with `plan`: expected one kind of transitions here");
        };
        Ok(Options {
            engine: self.engines()?.pop().unwrap_or(Engine::Pieces),
            piece_length_mm: self.piece_length,
            fluctuation: self.solver_tolerance,
            ..self.plan.options(profile)?
        })
    }

    /// The options for a problem; a problem that would run for hours is refused.
    pub(crate) fn options_for<const D: usize>(&self, problem: &Problem<D>) -> Result<Options> {
        let options = self.options()?;
        expect_an_end(problem, &options)?;
        expect_few_pieces(problem, &options)?;
        self.plan.note_window();
        Ok(options)
    }
}
