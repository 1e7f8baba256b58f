//! A run with feed override, whose result the self-test compares.

use real::Backend;
use secant_interp::{CompiledPath, FeedOverride, OverrideState, PositionChecksum, Rate};

/// A new rate from some period on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateCommand {
    /// The number of setpoints before it.
    pub period: usize,
    /// The share of the plan's own speed.
    pub share: f64,
}

impl RateCommand {
    /// The share in units of 2⁻³².
    #[must_use]
    pub fn rate(&self) -> u64 {
        real::Real::to_phase(self.share, -32)
    }
}

/// A run at changing rates, from begin to end.
#[derive(Clone, Debug, PartialEq)]
pub struct OverriddenRun {
    /// What is commanded, in order of time.
    pub commands: Vec<RateCommand>,
    /// The number of setpoints.
    pub periods: usize,
    /// Their [`PositionChecksum`].
    pub checksum: u64,
}

/// Periods after which a run is given up, for each period of the plan and beyond.
const MOST: (usize, usize) = (64, 1 << 16);

impl OverriddenRun {
    /// Slows the path down to a half at a quarter of its `periods`, holds it for some periods in the middle, and then goes
    /// on at three quarters. It begins at the rate `commanded`, in units of 2⁻³². `None` for a run without an end.
    pub(crate) fn of<R: Backend, const D: usize>(
        path: &CompiledPath<R, D>,
        feeds: &FeedOverride,
        commanded: f64,
        periods: usize,
    ) -> Option<Self> {
        let at = |period: usize, share| RateCommand { period: period.max(1), share };
        let middle = periods / 2;
        let commands = vec![at(periods / 4, 0.5), at(middle, 0.0), at(middle + 40, 0.75)];
        let (mut made, mut checksum) = (0, PositionChecksum::default());
        let mut rates = OverrideState::at(Rate::of(commanded));
        for run in path.runs() {
            let mut state = run.start();
            while let Some(setpoint) = run.step_overridden(&mut state, feeds, &mut rates) {
                checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
                made += 1;
                if let Some(command) = commands.iter().find(|command| command.period == made) {
                    rates.set(Rate::of(command.share));
                }
                if made > MOST.0 * periods + MOST.1 {
                    return None;
                }
            }
        }
        Some(Self { commands, periods: made, checksum: checksum.value() })
    }
}
