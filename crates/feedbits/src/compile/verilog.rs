//! A part as a core in Verilog.

use std::path::Path;

use anyhow::{Context, Result, bail};
use c_code::CName;
use format_compare::{CRequest, Dimension, Format, Space};
use hardware::{CoreFiles, CoreRequest, Figures, QUEUES};
use real::FormatName;

use super::judged::{Judged, expect_room};
use crate::output;
use crate::places::Folder;
use crate::progress::Progress;

/// The folder of the files.
pub(crate) fn folder(out: Option<&Path>) -> Result<Folder> {
    let Some(out) = out else {
        bail!("--language verilog writes four files: give --out FOLDER");
    };
    Folder::named("--out", out)
}

/// Refuses a format that the core has no numbers for.
pub(crate) fn expect_format<const D: usize>(format: &dyn Format<D>) -> Result<()> {
    Ok(c_code::expect_described(format.name())?)
}

/// Writes the part.
pub(crate) fn write<const D: usize>(
    judged: &Judged<'_, D>,
    folder: &Folder,
    flash: Option<usize>,
    progress: Progress,
) -> Result<()>
where
    Space: Dimension<D>,
{
    let Judged { problem, plan, options, format, about, fault } = judged;
    let FormatName::Fixed { fraction_bits, .. } = format.name() else { bail!("the core has no floats") };
    let name = CName::try_new("part")?;
    let request =
        CRequest { name: name.clone(), about: about.clone(), fault: fault.clone(), is_description: true };
    let c = format.c_files(problem, plan, options, &request)?;
    let request = CoreRequest {
        header: &c.header,
        source: &c.source,
        name: name.as_str(),
        about,
        bits: format.name().bits(),
        fraction_bits,
        periods: c.run.periods,
        checksum: c.run.checksum,
    };
    let CoreFiles { core, microcode, part, testbench, figures, .. } =
        hardware::compile(&request).with_context(|| format!("{about}: it does not become a core"))?;
    let bytes = 8 * figures.table_words;
    expect_room(bytes, flash)?;
    progress.finish();
    let files =
        [("core.v", &core), ("microcode.hex", &microcode), ("part.hex", &part), ("testbench.v", &testbench)];
    folder.write(&files.map(|(name, text)| (name, text.as_str())))?;
    let Figures { words, registers, cycles, until_ready, least_periods, .. } = figures;
    output::note(&format!(
        "core.v, microcode.hex, part.hex and testbench.v are in {}: {} periods; {words} words of microcode, {registers} registers, {bytes} \
         bytes of tables; checksum {:#018x}",
        folder.path().display(),
        c.run.periods,
        c.run.checksum
    ));
    output::note(&format!(
        "cycles from a setpoint to the next one: {:.1} in the mean, {} at worst; until the core can be asked again {:.1} and {}",
        cycles.0, cycles.1, until_ready.0, until_ready.1
    ));
    let periods = QUEUES.iter().zip(least_periods).map(|(queue, cycles)| format!("{queue}: {cycles}"));
    output::note(&format!(
        "the least period that it holds, in cycles, by the setpoints that wait at its output, QUEUE: {}",
        periods.collect::<Vec<_>>().join(", ")
    ));
    Ok(())
}
