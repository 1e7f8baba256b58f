//! A register of its own for each named signal.
//!
//! Every named signal is rounded to its register wherever it is named, and operators between registers are exact to 53
//! bits: see [`Quantized`]. The integer bits follow from the range that the signal had, the fraction bits from a search:
//! they start from those of the uniform format and are taken away, many from each signal in turn and then fewer, as long as
//! every requirement is met, until no single bit can go.

use std::cell::Cell;

use real::{Audit, Audited, Backend, Datapath, FormatName, Quantized};
use serde::Serialize;

use crate::bench::run;
use crate::case::Case;
use crate::ended::Ended;
use crate::judge::OutputFound;
use crate::kernel::Kernel;
use crate::reference::Reference;
use crate::until_bad::UntilBad;

/// A register for each signal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Registers {
    /// The registers, in the order of names.
    pub signals: Vec<Register>,
    /// Their widths together, each signal once.
    pub bits: u32,
    /// The widths together if every signal had that of the uniform format.
    pub uniform_bits: u32,
    /// The outputs of the run in these registers.
    pub outputs: Vec<OutputFound>,
}

/// A signal and its format.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Register {
    /// The signal.
    pub signal: &'static str,
    /// The format's name.
    pub format: String,
    /// Its width.
    pub bits: u32,
    /// The largest magnitude of the signal, from which the integer bits follow.
    pub bound: f64,
}

/// Most fraction bits of a register: an f64 has no more.
const MOST_FRACTION_BITS: i32 = 52;

/// Bits that are taken from one signal at a time.
const STRIDES: [i32; 4] = [8, 4, 2, 1];

/// Runs in registers.
pub(crate) struct Search<'a, 'k, K> {
    pub(crate) case: &'a Case<'k, K>,
    pub(crate) reference: &'a Reference,
    pub(crate) datapath: Datapath,
    pub(crate) runs: &'a Cell<usize>,
}

impl<K: Kernel> Search<'_, '_, K> {
    /// Registers for these signals, whose uniform format has so many fraction bits and this width; `None` if not even 53 bits
    /// in all are enough.
    pub(crate) fn registers(
        &self,
        signals: &[&'static str],
        fraction_bits: u32,
        width: u32,
    ) -> Option<Registers> {
        let start = fraction_bits.cast_signed();
        // Operators between registers do not round as those of a uniform format do; an additional bit makes up for it.
        let mut bits = (start..=MOST_FRACTION_BITS).find_map(|start| {
            let registers: Vec<_> = signals.iter().map(|signal| (*signal, start)).collect();
            self.run::<Quantized>(&registers).map(|_| registers)
        })?;
        for stride in STRIDES {
            while self.take(&mut bits, stride) && stride == 1 {}
        }
        self.confirmed(&bits, width)
    }

    /// Takes so many fraction bits from each register from which they can be taken. Returns whether there was one.
    fn take(&self, bits: &mut Vec<(&'static str, i32)>, stride: i32) -> bool {
        let mut was_taken = false;
        for place in 0..bits.len() {
            if bits[place].1 < stride {
                continue;
            }
            bits[place].1 -= stride;
            if self.run::<Quantized>(bits).is_some() {
                was_taken = true;
            } else {
                bits[place].1 += stride;
            }
        }
        was_taken
    }

    /// The outputs of the run in these registers, if it meets every requirement.
    fn run<R: Backend>(&self, registers: &[(&'static str, i32)]) -> Option<Vec<OutputFound>> {
        self.runs.set(self.runs.get() + 1);
        let mut until_bad = UntilBad::of(self.case, self.reference, || false);
        let run = || run::<K, R>(self.case, &mut until_bad);
        let ended = Quantized::run(self.datapath.rounding, registers, run);
        (ended == Ended::Finished).then(|| until_bad.good())?
    }

    fn confirmed(&self, bits: &[(&'static str, i32)], width: u32) -> Option<Registers> {
        let (outputs, audit) = Audit::of(|| self.run::<Audited<Quantized>>(bits));
        let register = |(signal, fraction_bits): &(&'static str, i32)| {
            let (min, max) = audit.signals.get(signal).map_or((0.0, 0.0), |range| (range.min, range.max));
            // -2^(n-1) ≤ v < 2^(n-1) for n integer bits.
            let fits = |n: &i32| -f64::powi(2.0, n - 1) <= min && max < f64::powi(2.0, n - 1);
            let (integer_bits, fraction_bits) =
                ((1..64).find(fits).unwrap_or(64).unsigned_abs(), fraction_bits.unsigned_abs());
            let format = FormatName::Fixed { integer_bits, fraction_bits, datapath: self.datapath };
            let bound = min.abs().max(max.abs());
            Register { signal, format: format.to_string(), bits: integer_bits + fraction_bits, bound }
        };
        let signals: Vec<Register> = bits.iter().map(register).collect();
        Some(Registers {
            bits: signals.iter().map(|one| one.bits).sum(),
            uniform_bits: width * u32::try_from(signals.len()).ok()?,
            signals,
            outputs: outputs?,
        })
    }
}
