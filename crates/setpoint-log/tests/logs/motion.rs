//! Motions in closed form, as logs: straight moves and arcs from rest to rest, with bounded jerk.

use std::fmt::Write;

use part_program::{ReadOptions, StatedLimits, read_limits, read_part_with};
use setpoint_log::{Followed, Judgement, Log, LogError, LogOptions};

/// The time between two setpoints, in s.
pub(crate) const PERIOD_S: f64 = 1e-3;

/// The machine whose limits the sound motions take up to 19/20 and more.
pub(crate) const MACHINE: &str = "[machine]
interpolation_period_ms = 1
[machine.axes.x]
velocity_mm_per_s = 60
acceleration_mm_per_s2 = 640
jerk_mm_per_s3 = 20000
[machine.axes.y]
velocity_mm_per_s = 60
acceleration_mm_per_s2 = 640
jerk_mm_per_s3 = 20000
";

/// The same machine, which bounds no jerk: an arc that follows a line takes any.
pub(crate) fn without_jerk() -> String {
    let lines = MACHINE.lines().filter(|line| !line.starts_with("jerk"));
    lines.fold(String::new(), |text, line| text + line + "\n")
}

/// How a way is made: at most this velocity, acceleration and jerk, in mm and s.
#[derive(Clone, Copy)]
pub(crate) struct Pace {
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

pub(crate) const SOUND: Pace = Pace { velocity: 50.0, acceleration: 600.0, jerk: 19_000.0 };

impl Pace {
    /// The way made after a time, of a whole way from rest to rest, in mm: jerk up, none, down to the velocity, and the same backwards.
    fn way(&self, whole: f64, t: f64) -> f64 {
        let (tj, v) = (self.acceleration / self.jerk, self.velocity);
        let ta = v / self.acceleration - tj;
        assert!(ta >= 0.0, "a pace that reaches its acceleration");
        let ramp_s = 2.0 * tj + ta;
        let total_s = whole / v + ramp_s;
        let up = |t: f64| {
            let (j, a) = (self.jerk, self.acceleration);
            match t {
                t if t <= 0.0 => 0.0,
                t if t < tj => j * t.powi(3) / 6.0,
                t if t < tj + ta => {
                    j * tj.powi(3) / 6.0 + a * tj / 2.0 * (t - tj) + a / 2.0 * (t - tj).powi(2)
                }
                t if t < ramp_s => v * ramp_s / 2.0 - v * (ramp_s - t) + j * (ramp_s - t).powi(3) / 6.0,
                t => v * ramp_s / 2.0 + v * (t - ramp_s),
            }
        };
        assert!(whole >= v * ramp_s, "a way that reaches its velocity");
        if t < total_s - ramp_s { up(t) } else { whole - up(total_s - t) }
    }

    /// The time that a whole way takes, in s.
    fn takes_s(&self, whole: f64) -> f64 {
        whole / self.velocity + self.velocity / self.acceleration + self.acceleration / self.jerk
    }
}

/// A place of a motion: its point, and the line of the program.
pub(crate) type Place = ([f64; 3], usize);

/// A motion as its setpoints.
#[derive(Clone, Default)]
pub(crate) struct Motion(pub(crate) Vec<Place>);

impl Motion {
    /// Stands for some periods.
    pub(crate) fn stand(mut self, at: [f64; 3], periods: usize) -> Self {
        let line = self.0.last().map_or(0, |last| last.1);
        self.0.extend(vec![(at, line); periods]);
        self
    }

    /// Goes along a way of a length, at a pace.
    pub(crate) fn along(
        mut self,
        (length, line): (f64, usize),
        pace: Pace,
        point: impl Fn(f64) -> [f64; 3],
    ) -> Self {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a motion takes some seconds"
        )]
        let periods = (pace.takes_s(length) / PERIOD_S).ceil() as usize;
        self.0.extend((1..=periods).map(|index| (point(pace.way(length, index as f64 * PERIOD_S)), line)));
        self
    }

    /// Goes straight.
    pub(crate) fn line(self, from: [f64; 3], to: [f64; 3], line: usize, pace: Pace) -> Self {
        let way: [f64; 3] = std::array::from_fn(|axis| to[axis] - from[axis]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.along((length, line), pace, |s| std::array::from_fn(|axis| from[axis] + way[axis] * s / length))
    }

    /// The log, with times, and positions of so many decimals.
    pub(crate) fn log(&self, decimals: usize) -> String {
        let mut text = String::from("time,x,y,z,line\n");
        for (index, ([x, y, z], line)) in self.0.iter().enumerate() {
            let _ = writeln!(
                text,
                "{:.3},{x:.decimals$},{y:.decimals$},{z:.decimals$},{line}",
                index as f64 * PERIOD_S
            );
        }
        text
    }

    /// The log without times.
    pub(crate) fn log_without_times(&self, decimals: usize) -> String {
        let rows = self.log(decimals);
        rows.lines()
            .fold(String::new(), |text, row| text + row.split_once(',').map_or("", |(_, rest)| rest) + "\n")
    }
}

/// Two moves with a rest between them.
pub(crate) const CORNER: &str = "G21 G90\nG1 X60 F3000\nG1 Y30\n";

/// That part, with X at a pace and Y at another.
pub(crate) fn corner(x: Pace, y: Pace) -> Motion {
    let [begin, middle, end] = [[0.0, 0.0, 0.0], [60.0, 0.0, 0.0], [60.0, 30.0, 0.0]];
    Motion::default()
        .stand(begin, 5)
        .line(begin, middle, 2, x)
        .stand(middle, 20)
        .line(middle, end, 3, y)
        .stand(end, 5)
}

/// A line, a whole circle that it touches, and another line, in one motion.
pub(crate) const CIRCLE: &str = "G21 G90 G17\nG1 X40 F3000\nG3 X40 Y0 I0 J10\nG1 X80\n";
pub(crate) const CIRCLE_MM: f64 = 20.0 * std::f64::consts::PI;

/// That part, with the circle or without it.
pub(crate) fn circle(has_circle: bool) -> Motion {
    let around = if has_circle { CIRCLE_MM } else { 0.0 };
    let point = |s: f64| {
        if s < 40.0 {
            return [s, 0.0, 0.0];
        }
        let (sin, cos) = (((s - 40.0) / 10.0).min(around / 10.0)).sin_cos();
        match s < 40.0 + around {
            true => [40.0 + 10.0 * sin, 10.0 - 10.0 * cos, 0.0],
            false => [s - around, 0.0, 0.0],
        }
    };
    Motion::default().stand([0.0; 3], 5).along((80.0 + around, 0), SOUND, point).stand([80.0, 0.0, 0.0], 5)
}

pub(crate) fn machine(text: &str) -> StatedLimits {
    read_limits("m.toml", text).unwrap()
}

/// What is found in a log.
pub(crate) fn judged(
    log: &str,
    machine_text: &str,
    part: Option<(&str, Option<f64>)>,
) -> Result<Judgement, LogError> {
    let log = Log::begin(log.as_bytes(), &machine(machine_text), &LogOptions::default())?;
    let options = ReadOptions { start_mm: Some(log.first_point_mm()), ..ReadOptions::default() };
    let read =
        part.map(|(text, tolerance_mm)| (read_part_with("p.nc", text, options).unwrap(), tolerance_mm));
    log.judge(read.as_ref().map(|(part, tolerance_mm)| Followed { part, tolerance_mm: *tolerance_mm }))
}
