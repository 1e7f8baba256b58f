//! Setpoints as CSV or JSON, written one by one.

use std::io::Write;

use anyhow::Result;
use format_compare::SetpointRow;

/// A table that is being written.
pub(super) struct Rows<'a> {
    file: &'a mut (dyn Write + Send),
    is_json: bool,
    is_empty: bool,
}

impl<'a> Rows<'a> {
    /// Begins a table in this file. Nothing is written before the first row, for a run may be refused at its begin.
    pub(super) fn new(file: &'a mut (dyn Write + Send), is_json: bool) -> Self {
        Self { file, is_json, is_empty: true }
    }

    fn write_head(&mut self, side_axes: &[(&str, f64)]) -> Result<()> {
        if self.is_json {
            self.file.write_all(b"[")?;
            return Ok(());
        }
        let head = "step,time_s,span,t,u,x_mm,y_mm,z_mm,feed_mm_per_s,chord_mm,fluctuation,evaluations";
        self.file.write_all(head.as_bytes())?;
        side_axes.iter().try_for_each(|(name, _)| write!(self.file, ",{name}"))?;
        self.file.write_all(b"\n")?;
        Ok(())
    }

    /// Writes a row. In CSV each number is the shortest text that reads back as the same number.
    pub(super) fn write(&mut self, row: &SetpointRow) -> Result<()> {
        let is_first = std::mem::take(&mut self.is_empty);
        if is_first {
            self.write_head(&row.side_axes)?;
        }
        if self.is_json {
            let text = serde_json::to_string_pretty(row)?.replace('\n', "\n  ");
            let comma = if is_first { "" } else { "," };
            write!(self.file, "{comma}\n  {text}")?;
            return Ok(());
        }
        let [x, y, z] = row.point_mm;
        write!(
            self.file,
            "{},{},{},{},{},{x},{y},{z},{},{},{},{}",
            row.step,
            row.time_s,
            row.span,
            row.t,
            row.u,
            row.feed_mm_per_s,
            row.chord_mm,
            row.fluctuation,
            row.evaluations
        )?;
        row.side_axes.iter().try_for_each(|(_, place)| write!(self.file, ",{place}"))?;
        self.file.write_all(b"\n")?;
        Ok(())
    }

    /// Ends the table.
    pub(super) fn finish(mut self) -> Result<()> {
        if self.is_empty {
            self.write_head(&[])?;
        }
        if self.is_json {
            self.file.write_all(if self.is_empty { b"]\n" } else { b"\n]\n" })?;
        }
        Ok(())
    }
}
