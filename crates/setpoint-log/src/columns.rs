//! Which column of a log holds what.

use std::str::FromStr;

use crate::log_error::{LogError, quoted};
use crate::unit::LengthUnit;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    /// The time; several of them are added up, as seconds and nanoseconds.
    Time,
    /// The number of the setpoint, as the controller counts.
    Sample,
    /// The position of an axis, 0 for X.
    Axis(usize),
    /// The line of the program.
    Line,
    /// The length of the step, in mm.
    Chord,
}

/// What `--columns` says: for each quantity a column, by its number from 0 or by its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColumnMap(Vec<(Quantity, f64, String)>);

/// The words that name quantities in `--columns`.
const WORDS: &str = "time, time_ms, sample, x, y, z or line";

impl FromStr for ColumnMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let one = |pair: &str| {
            let (name, column) = pair
                .split_once('=')
                .ok_or_else(|| format!("{pair:?}: expected NAME=COLUMN, as in time=0,x=1,y=2,z=3"))?;
            let (quantity, factor) = match name.trim() {
                "time" => (Quantity::Time, 1.0),
                "time_ms" => (Quantity::Time, 1e-3),
                "sample" => (Quantity::Sample, 1.0),
                "x" => (Quantity::Axis(0), 1.0),
                "y" => (Quantity::Axis(1), 1.0),
                "z" => (Quantity::Axis(2), 1.0),
                "line" => (Quantity::Line, 1.0),
                other => return Err(format!("{other:?} is no quantity: expected {WORDS}")),
            };
            Ok((quantity, factor, column.trim().to_string()))
        };
        let map: Vec<_> = text.split(',').map(one).collect::<Result<_, String>>()?;
        let is_twice = |(index, (quantity, ..)): (usize, &(Quantity, f64, String))| {
            map.iter().skip(index + 1).any(|(other, ..)| other == quantity)
        };
        if map.iter().enumerate().any(is_twice) {
            return Err("a quantity has two columns: expected each once".into());
        }
        if !map.iter().any(|(quantity, ..)| matches!(quantity, Quantity::Axis(_))) {
            return Err("no axis has a column: expected x, y or z".into());
        }
        Ok(Self(map))
    }
}

/// The columns of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Columns {
    /// The columns that make the time together, with what each counts in s.
    pub(crate) time: Vec<(usize, f64)>,
    pub(crate) sample: Option<usize>,
    pub(crate) axes: [Option<usize>; 3],
    pub(crate) line: Option<usize>,
    pub(crate) chord: Option<usize>,
    /// The unit of lengths that such logs have.
    pub(crate) unit: Option<LengthUnit>,
    /// Axes that the log has beside the three.
    pub(crate) other_axes: usize,
    /// Two columns that have the same name, at least one of which is read.
    pub(crate) named_twice: Option<[usize; 2]>,
}

/// The names of columns, each after what it holds and what it counts in s. Of several that a log has for one quantity the first is taken.
const NAMES: [(Quantity, f64, &[&str]); 12] = [
    (
        Quantity::Time,
        1.0,
        &["time_s", "time", "t_s", "time_sec", "seconds", "timestamp", "time_from_start", "t"],
    ),
    (Quantity::Time, 1e-3, &["time_ms", "t_ms", "timestamp_ms"]),
    (Quantity::Time, 1e-6, &["time_us", "t_us", "timestamp_us"]),
    (Quantity::Time, 1e-9, &["time_ns", "t_ns", "timestamp_ns"]),
    (Quantity::Time, 1.0, &["time_from_start.sec", "time_from_start.secs", "sec", "secs"]),
    (Quantity::Sample, 1.0, &["sample", "step", "period", "index"]),
    (Quantity::Axis(0), 1.0, &["x_mm", "x", "pos_x", "x_pos", "position_x", "axis_x"]),
    (Quantity::Axis(1), 1.0, &["y_mm", "y", "pos_y", "y_pos", "position_y", "axis_y"]),
    (Quantity::Axis(2), 1.0, &["z_mm", "z", "pos_z", "z_pos", "position_z", "axis_z"]),
    (Quantity::Line, 1.0, &["line", "program_line", "motion_line"]),
    (Quantity::Chord, 1.0, &["chord_mm"]),
    (Quantity::Time, 1e-9, &["time_from_start.nanosec", "time_from_start.nsecs", "nanosec", "nsecs"]),
];

/// The nanoseconds that ROS writes beside the seconds.
const NANOSECONDS: &[&str] = NAMES[11].2;

impl Columns {
    /// The columns that the head of a log names.
    pub(crate) fn of_head(head: &[&[u8]], line: u64) -> Result<Self, LogError> {
        let names: Vec<String> =
            head.iter().map(|name| String::from_utf8_lossy(name).to_ascii_lowercase()).collect();
        let find =
            |known: &[&str]| known.iter().find_map(|known| names.iter().position(|name| name == known));
        let mut columns = Self::default();
        for (quantity, factor, known) in NAMES {
            let Some(index) = find(known) else { continue };
            let is_beside = known == NANOSECONDS && columns.time.iter().any(|(_, unit)| *unit == 1.0);
            if quantity != Quantity::Time || columns.time.is_empty() || is_beside {
                columns.set(quantity, factor, index);
            }
        }
        columns.add_joints(&names);
        let of_name = columns.all().into_iter().find_map(|taken| twice(&names, taken));
        columns.named_twice = columns.named_twice.or(of_name);
        if columns.axes == [None; 3] {
            let shown: Vec<String> = head.iter().take(20).map(|name| format!("`{}`", quoted(name))).collect();
            return Err(LogError::at(
                line,
                1,
                format!("no column is X, Y or Z among {}", shown.join(", ")),
                "columns named x, y and z, or --columns time=0,x=1,y=2,z=3",
            ));
        }
        Ok(columns)
    }

    /// The positions of ROS, `positions[0]` and so on: the first three are the axes.
    fn add_joints(&mut self, names: &[String]) {
        let joint = |name: &String| {
            let rest = name.strip_prefix("positions").or_else(|| name.strip_prefix("position"))?;
            rest.trim_matches(['[', ']', '_', '.']).parse::<usize>().ok()
        };
        let mut joints: Vec<(usize, usize)> =
            names.iter().enumerate().filter_map(|(index, name)| Some((joint(name)?, index))).collect();
        if self.axes != [None; 3] || joints.is_empty() {
            return;
        }
        joints.sort_unstable();
        self.named_twice =
            joints.windows(2).find(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]);
        self.unit = Some(LengthUnit::Metre);
        self.other_axes = joints.len().saturating_sub(3);
        for (axis, (_, index)) in self.axes.iter_mut().zip(joints) {
            *axis = Some(index);
        }
    }

    /// The columns that `--columns` names, where the log has a head or none.
    pub(crate) fn of_map(map: &ColumnMap, head: Option<&[&[u8]]>, line: u64) -> Result<Self, LogError> {
        let mut columns = Self::default();
        for (quantity, factor, column) in &map.0 {
            let by_name = || head?.iter().position(|name| *name == column.as_bytes());
            let Some(index) = column.parse().ok().or_else(by_name) else {
                let message = match head {
                    Some(_) => format!("--columns: no column is named {column:?}"),
                    None => format!("--columns: {column:?} is no number, and the log has no head"),
                };
                return Err(LogError::at(line, 1, message, "the number of a column, from 0, or its name"));
            };
            columns.set(*quantity, *factor, index);
            let is_named = column.parse::<usize>().is_err();
            let of_name = head.filter(|_| is_named).and_then(|head| twice(head, index));
            columns.named_twice = columns.named_twice.or(of_name);
        }
        Ok(columns)
    }

    /// All columns that are read.
    fn all(&self) -> Vec<usize> {
        let times = self.time.iter().map(|(index, _)| *index);
        let others = [self.sample, self.line, self.chord].into_iter().chain(self.axes).flatten();
        times.chain(others).collect()
    }

    fn set(&mut self, quantity: Quantity, factor: f64, index: usize) {
        match quantity {
            Quantity::Time => self.time.push((index, factor)),
            Quantity::Sample => self.sample = Some(index),
            Quantity::Axis(axis) => self.axes[axis] = Some(index),
            Quantity::Line => self.line = Some(index),
            Quantity::Chord => self.chord = Some(index),
        }
    }
}

/// The numbers of a column that is read and of another one with the same name, if there is one.
fn twice<T: PartialEq>(names: &[T], taken: usize) -> Option<[usize; 2]> {
    let other = names.iter().enumerate().position(|(index, name)| index != taken && *name == names[taken])?;
    Some([taken.min(other), taken.max(other)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_head(head: &str) -> Result<Columns, LogError> {
        let names: Vec<&[u8]> = head.split(',').map(str::as_bytes).collect();
        Columns::of_head(&names, 1)
    }

    #[test]
    fn logs_are_known_by_their_heads() {
        let ours =
            of_head("step,time_s,span,t,u,x_mm,y_mm,z_mm,feed_mm_per_s,chord_mm,fluctuation,evaluations");
        let ours = ours.unwrap();
        assert_eq!((ours.time, ours.sample, ours.chord), (vec![(1, 1.0)], Some(0), Some(9)));
        assert_eq!(ours.axes, [Some(5), Some(6), Some(7)]);
        let sampler = of_head("sample,x,y,z,current_vel,requested_vel,line,motion_type,in_position").unwrap();
        assert_eq!((sampler.sample, sampler.line, sampler.time), (Some(0), Some(6), vec![]));
        let ros = of_head("time_from_start.sec,time_from_start.nanosec,positions[1],positions[0]").unwrap();
        assert_eq!((ros.time, ros.unit), (vec![(0, 1.0), (1, 1e-9)], Some(LengthUnit::Metre)));
        assert_eq!(ros.axes, [Some(3), Some(2), None]);
        let six = of_head("time_from_start,positions_0,positions_1,positions_2,positions_3").unwrap();
        assert_eq!((six.axes[2], six.other_axes), (Some(3), 1));
        assert!(of_head("time,speed").unwrap_err().to_string().contains("no column is X, Y or Z"));
    }

    #[test]
    fn columns_are_mapped_by_number_and_by_name() {
        let map: ColumnMap = "time=0,x=1,y=pos,line=6".parse().unwrap();
        let head: [&[u8]; 3] = [b"a", b"b", b"pos"];
        let columns = Columns::of_map(&map, Some(&head), 1).unwrap();
        assert_eq!((columns.axes, columns.line), ([Some(1), Some(2), None], Some(6)));
        assert!(Columns::of_map(&map, None, 1).is_err());
        for wrong in ["", "x", "q=1", "time=0", "x=1,x=2"] {
            assert!(wrong.parse::<ColumnMap>().is_err(), "{wrong}");
        }
    }
}
