//! Test vectors: the bits that another implementation of a kernel must make.

use std::ops::ControlFlow;

use real::{Backend, FormatName, Work, word_of};

use crate::bench::{Observer, run};
use crate::case::Case;
use crate::ended::Ended;
use crate::formats::in_format;
use crate::kernel::Kernel;
use crate::refusal::Refusal;

/// The bits of all inputs and outputs of a run, as comma-separated values: a line a step, each number in hexadecimal digits
/// of the format's width, in two's complement or as IEEE 754 has it.
///
/// # Errors
/// As [`compare`](crate::compare()), and [`Refusal::Run`] if the kernel does not finish in the format.
pub fn vectors<K: Kernel>(kernel: &K, format: FormatName) -> Result<String, Refusal> {
    let case = Case::of(kernel, &[format])?;
    let (ended, rows) = in_format(format, Writing { case: &case });
    if ended != Ended::Finished {
        return Err(Refusal::Run(format.to_string(), ended));
    }
    let inputs = case.inputs.iter().map(|input| input.name);
    let header: Vec<&str> =
        std::iter::once("step").chain(inputs).chain(case.outputs.iter().map(|o| o.name)).collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    let _ = writer.write_record(header);
    rows.iter().for_each(|row| drop(writer.write_record(row)));
    Ok(String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default())
}

struct Writing<'a, 'k, K> {
    case: &'a Case<'k, K>,
}

struct Rows<'a, 'k, K> {
    case: &'a Case<'k, K>,
    rows: Vec<Vec<String>>,
}

fn word<R: Backend>(number: R) -> String {
    let digits = R::name().bits().div_ceil(4) as usize;
    format!("{:0digits$x}", word_of(number))
}

impl<R: Backend, K: Kernel> Observer<R> for Rows<'_, '_, K> {
    fn ends(&mut self, step: usize, outputs: &[R]) -> ControlFlow<()> {
        let inputs = self
            .case
            .inputs
            .iter()
            .map(|input| R::from_f64(input.values[step]).map_or_else(String::new, word));
        let words = inputs.chain(outputs.iter().copied().map(word));
        self.rows.push(std::iter::once(step.to_string()).chain(words).collect());
        ControlFlow::Continue(())
    }
}

impl<K: Kernel> Work for Writing<'_, '_, K> {
    type Output = (Ended, Vec<Vec<String>>);

    fn in_backend<R: Backend>(self) -> Self::Output {
        let mut rows = Rows { case: self.case, rows: Vec::new() };
        (run::<K, R>(self.case, &mut rows), rows.rows)
    }
}
