//! A log in rows of numbers, separated by commas, semicolons, tabs or blanks, with a head or without one.

use std::io::Read;

use csv::{ByteRecord, Reader, ReaderBuilder, Trim};
use domains::curve::COORDINATE;
use domains::shown;

use crate::columns::{ColumnMap, Columns};
use crate::decimal::decimal;
use crate::log_error::{LogError, quoted};
use crate::row::{Row, Rows};
use crate::text::{BoundedLines, Text};
use crate::unit::LengthUnit;

/// What LinuxCNC's halsampler prints where it was too slow to take all that the controller wrote.
const OVERRUN: &[u8] = b"overrun";

/// The largest time, in s: three hundred years.
const LATEST_S: f64 = 1e10;

/// 2⁵³: up to here a double holds every whole number.
const MOST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// A log of numbers that is being read.
pub(crate) struct CsvLog<'a> {
    reader: Reader<BoundedLines<Box<dyn Read + 'a>>>,
    record: ByteRecord,
    /// The columns of a record that are not empty between blanks.
    fields: Vec<usize>,
    is_blank_separated: bool,
    /// Whether `record` is a row that was read to tell whether there is a head.
    has_record: bool,
    pub(crate) columns: Columns,
    unit_mm: f64,
    rows: u64,
    is_behind_loss: bool,
    last_place: Option<i32>,
    /// The last binary place of any position so far: -16 where all are multiples of 2⁻¹⁶.
    last_bit: Option<i32>,
    time_place_s: f64,
}

impl<'a> CsvLog<'a> {
    /// Begins to read; `map` says which column is what, in place of the head, and `unit` which unit positions have.
    pub(crate) fn new(
        text: Text<'a>,
        map: Option<&ColumnMap>,
        unit: Option<LengthUnit>,
    ) -> Result<Self, LogError> {
        let delimiter = delimiter(&text.head);
        let reader = ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .quoting(false)
            .comment(Some(b'#'))
            .trim(Trim::None)
            .buffer_capacity(1 << 16)
            .from_reader(BoundedLines::new(text.all));
        let mut log = Self {
            reader,
            record: ByteRecord::new(),
            fields: Vec::new(),
            is_blank_separated: delimiter == b' ',
            has_record: false,
            columns: Columns::default(),
            unit_mm: 1.0,
            rows: 0,
            is_behind_loss: false,
            last_place: None,
            last_bit: None,
            time_place_s: 0.0,
        };
        log.find_columns(map)?;
        log.unit_mm = unit.or(log.columns.unit).unwrap_or(LengthUnit::Millimetre).in_mm();
        Ok(log)
    }

    /// Reads the head, if there is one, and finds the columns.
    fn find_columns(&mut self, map: Option<&ColumnMap>) -> Result<(), LogError> {
        if !self.next_record()? {
            return Err(LogError::whole("the log is empty", "a row for each setpoint"));
        }
        let line = self.line();
        let is_head = (0..self.fields.len()).any(|index| decimal(self.field(index)).is_none());
        let head: Vec<&[u8]> = (0..self.fields.len()).map(|index| self.field(index)).collect();
        let columns = match (map, is_head) {
            (Some(map), _) => Columns::of_map(map, is_head.then_some(&head[..]), line)?,
            (None, true) => Columns::of_head(&head, line)?,
            (None, false) => {
                return Err(LogError::at(
                    line,
                    1,
                    format!("the log has {} columns and no head that names them", head.len()),
                    "--columns, as --columns time=0,x=1,y=2,z=3",
                ));
            }
        };
        if let Some([first, second]) = columns.named_twice {
            let name = quoted(self.field(second));
            let message = format!("two columns are named `{name}`, {} and {}", first + 1, second + 1);
            let expected = "a name for one column, or --columns with numbers from 0";
            return Err(LogError::at(line, self.column(second), message, expected));
        }
        self.columns = columns;
        self.has_record = !is_head;
        Ok(())
    }

    /// Reads the next record that is not empty; `false` at the end.
    fn next_record(&mut self) -> Result<bool, LogError> {
        loop {
            let found = self.reader.read_byte_record(&mut self.record);
            if !found.map_err(|error| {
                LogError::whole(format!("cannot read the log: {error}"), "rows of numbers")
            })? {
                return Ok(false);
            }
            let (record, blanks) = (&self.record, self.is_blank_separated);
            self.fields.clear();
            self.fields.extend((0..record.len()).filter(|index| !(blanks && record[*index].is_empty())));
            if self.fields.iter().any(|index| !record[*index].trim_ascii().is_empty()) {
                return Ok(true);
            }
        }
    }

    fn line(&self) -> u64 {
        self.record.position().map_or(0, csv::Position::line)
    }

    /// A field of the record, without blanks around it; nothing if the record is shorter.
    fn field(&self, index: usize) -> &[u8] {
        let own = self.fields.get(index).and_then(|index| self.record.get(*index));
        own.unwrap_or_default().trim_ascii()
    }

    /// The column of the text in which a field begins, from 1.
    fn column(&self, index: usize) -> usize {
        let own = self.fields.get(index).or(self.fields.last()).copied().unwrap_or(0);
        // Between two fields stands one separator.
        self.record.range(own).map_or(0, |range| range.start) + own + 1
    }

    /// The number of a column.
    fn number(&self, index: usize, what: &str) -> Result<crate::decimal::Decimal, LogError> {
        decimal(self.field(index)).ok_or_else(|| {
            let message = match self.fields.len() {
                count if count <= index => {
                    format!("no {what}: the row has {count} columns, and {what} is in column {}", index + 1)
                }
                _ => format!("{what} is `{}`", quoted(self.field(index))),
            };
            LogError::at(self.line(), self.column(index), message, "a number")
        })
    }

    /// The whole number of a column, from 0 up.
    fn whole(&self, index: usize, what: &str) -> Result<f64, LogError> {
        let value = self.number(index, what)?.value;
        if value.fract() == 0.0 && (0.0..=MOST_WHOLE).contains(&value) {
            return Ok(value);
        }
        let message = format!("{what} is `{}`", quoted(self.field(index)));
        Err(LogError::at(self.line(), self.column(index), message, "a whole number from 0 to 2^53"))
    }

    fn row(&mut self) -> Result<Row, LogError> {
        const AXES: [&str; 3] = ["X", "Y", "Z"];
        self.rows += 1;
        let mut row = Row { number: self.rows, text_line: self.line(), ..Row::default() };
        for (axis, name) in AXES.into_iter().enumerate() {
            let Some(index) = self.columns.axes[axis] else { continue };
            let read = self.number(index, name)?;
            row.point_mm[axis] = read.value * self.unit_mm;
            if !COORDINATE.holds(row.point_mm[axis]) {
                let message = format!("{name} is {} mm", shown(row.point_mm[axis]));
                let place = (self.line(), self.column(index));
                return Err(LogError::at(place.0, place.1, message, COORDINATE.to_string()));
            }
            let lower = |known: Option<i32>, place: i32| Some(known.map_or(place, |known| known.min(place)));
            self.last_place = lower(self.last_place, read.last_place);
            if let Some(bit) = last_bit(read.value) {
                self.last_bit = lower(self.last_bit, bit);
            }
        }
        self.set_time(&mut row)?;
        if let Some(index) = self.columns.sample {
            row.sample = Some(self.whole(index, "the number of the setpoint")?);
            row.time_column = self.column(index);
        }
        if let Some(index) = self.columns.line {
            row.program_line = line_of(self.whole(index, "the program's line")?);
        }
        if let Some(index) = self.columns.chord {
            let chord_mm = self.number(index, "the step's length")?.value;
            if chord_mm < 0.0 {
                let message = format!("the step's length is {} mm", shown(chord_mm));
                return Err(LogError::at(self.line(), self.column(index), message, "a length from 0 up"));
            }
            row.chord_mm = Some(chord_mm);
        }
        row.is_behind_loss = std::mem::take(&mut self.is_behind_loss);
        Ok(row)
    }

    fn set_time(&mut self, row: &mut Row) -> Result<(), LogError> {
        for at in 0..self.columns.time.len() {
            let (index, unit_s) = self.columns.time[at];
            let read = self.number(index, "the time")?;
            let time_s = row.time_s.unwrap_or(0.0) + read.value * unit_s;
            if time_s.abs() > LATEST_S {
                let message = format!("the time is {} s", shown(time_s));
                return Err(LogError::at(self.line(), self.column(index), message, "a time within 1e10 s"));
            }
            row.time_s = Some(time_s);
            let place_s = unit_s * 10.0_f64.powi(read.last_place);
            let is_finer = self.time_place_s == 0.0 || place_s < self.time_place_s;
            self.time_place_s = if is_finer { place_s } else { self.time_place_s };
        }
        if let Some((index, _)) = self.columns.time.first() {
            row.time_column = self.column(*index);
        }
        Ok(())
    }
}

/// A grid of binary places is not taken for one of decimals unless it is as fine as this: a quarter has two of both.
const LEAST_GRID: i32 = -8;

/// The last binary place of a number: -2 of 0.75. None of 0.
fn last_bit(value: f64) -> Option<i32> {
    const FRACTION_BITS: i32 = 52;
    let bits = value.to_bits();
    let exponent = i32::try_from(bits >> FRACTION_BITS & 0x7ff).ok()? - 1023;
    let fraction = bits & ((1 << FRACTION_BITS) - 1);
    let zeros = if fraction == 0 { FRACTION_BITS } else { i32::try_from(fraction.trailing_zeros()).ok()? };
    (value != 0.0).then_some(exponent - FRACTION_BITS + zeros)
}

/// The line that a log names, 0 if it names none.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is a whole number from 0 up")]
fn line_of(number: f64) -> usize {
    number as usize
}

/// What separates the columns: in the first line that is no comment, the first of comma, semicolon and tab that is there; else blanks.
fn delimiter(head: &[u8]) -> u8 {
    let lines = head.split(|byte| *byte == b'\n' || *byte == b'\r');
    let first = lines.into_iter().find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#"));
    let has = |byte: &u8| first.is_some_and(|line| line.trim_ascii().contains(byte));
    *[b',', b';', b'\t'].iter().find(|byte| has(byte)).unwrap_or(&b' ')
}

impl Rows for CsvLog<'_> {
    fn next_row(&mut self) -> Result<Option<Row>, LogError> {
        loop {
            if !std::mem::take(&mut self.has_record) && !self.next_record()? {
                return Ok(None);
            }
            if self.fields.len() == 1 && self.field(0) == OVERRUN {
                self.is_behind_loss = true;
                continue;
            }
            return self.row().map(Some);
        }
    }

    fn resolution_mm(&self) -> f64 {
        let place = self.last_place.unwrap_or(0);
        // A multiple of 2⁻ᶠ has f decimals: positions in fixed point, each digit of which was written.
        let unit = match self.last_bit {
            Some(bit) if bit == place && bit <= LEAST_GRID => 2.0_f64.powi(bit),
            _ => 10.0_f64.powi(place),
        };
        0.5 * self.unit_mm * unit
    }

    fn time_resolution_s(&self) -> f64 {
        0.5 * self.time_place_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::begun;

    fn rows(text: &str, map: Option<&str>) -> Result<(Vec<Row>, f64), LogError> {
        let map = map.map(|map| map.parse().unwrap());
        let mut log = CsvLog::new(begun(text.as_bytes())?, map.as_ref(), None)?;
        let mut rows = Vec::new();
        while let Some(row) = log.next_row()? {
            rows.push(row);
        }
        Ok((rows, log.resolution_mm()))
    }

    #[test]
    fn rows_are_read_in_each_form() {
        let (halsampler, r) = rows(
            "0 0.000000 1.500000 0.000000 7 \n1 0.25 1.5 0 8 \noverrun\n9 2.0 1.5 0 8\n",
            Some("sample=0,x=1,y=2,line=4"),
        )
        .unwrap();
        assert_eq!(halsampler[1].point_mm, [0.25, 1.5, 0.0]);
        let lines: Vec<_> = halsampler.iter().map(|row| (row.program_line, row.is_behind_loss)).collect();
        assert_eq!((lines, r), (vec![(7, false), (8, false), (8, true)], 5e-7));
        for (text, x) in [
            ("time,x\n0,1.25\n", 1.25),
            ("# a note\ntime;x\r\n0; 1.25\r\n", 1.25),
            ("time\tx\n0\t1.25\n\n", 1.25),
            ("time_from_start,positions[0]\n0,0.00125\n", 1.25),
        ] {
            let (found, _) = rows(text, None).unwrap();
            assert_eq!((found.len(), found[0].point_mm[0], found[0].time_s), (1, x, Some(0.0)), "{text}");
        }
    }

    /// Multiples of 2⁻¹⁶, written with all their digits, are within 2⁻¹⁷; decimals are within half of their last.
    #[test]
    fn positions_in_fixed_point_are_known_by_their_binary_places() {
        assert_eq!([0.75, -3.0, 1.0 / 65536.0, 12.0].map(last_bit), [Some(-2), Some(0), Some(-16), Some(2)]);
        let fixed: String = (0..100).map(|k| format!("{}\n", 3.0 + f64::from(k) / 65536.0)).collect();
        let (_, r) = rows(&format!("x\n{fixed}"), None).unwrap();
        assert_eq!(r, 2.0_f64.powi(-17));
        let (_, r) = rows("x\n0.25\n0.75\n1.25\n", None).unwrap();
        assert_eq!(r, 0.005);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let said = |text: &str, map: Option<&str>| rows(text, map).unwrap_err().to_string();
        assert_eq!(
            said("time,x,y\n0,1,2\n1,1.5,nan\n", None),
            "line 3, column 7: Y is `nan`: expected a number"
        );
        assert_eq!(
            said("time,x,y\n0,1,2\n1,1.5\n", None),
            "line 3, column 3: no Y: the row has 2 columns, and Y is in column 3: expected a number"
        );
        assert_eq!(
            said("0 1 2\n", None),
            "line 1, column 1: the log has 3 columns and no head that names them: expected --columns, as --columns \
             time=0,x=1,y=2,z=3"
        );
        assert!(said("time,x\n0,1e200\n", None).starts_with("line 2, column 3: X is 1e200 mm"));
        assert!(said("", None).contains("empty"));
        assert!(said(&"x".repeat(1 << 17), None).contains("longer than"));
    }

    #[test]
    fn what_gzip_has_packed_is_unpacked() {
        use std::io::Write;
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        packed.write_all(b"time,x\n0,1.5\n").unwrap();
        let packed = packed.finish().unwrap();
        let mut log = CsvLog::new(begun(&packed[..]).unwrap(), None, None).unwrap();
        assert_eq!(log.next_row().unwrap().unwrap().point_mm[0], 1.5);
        let cut = &packed[..packed.len() - 9];
        let log = begun(cut).and_then(|text| CsvLog::new(text, None, None));
        assert!(log.and_then(|mut log| log.next_row()).is_err());
    }
}
