//! A log of Klipper's `motan`: the moves of a tool, each of constant acceleration, sampled once a period.
//!
//! Its text is messages in JSON, each with a byte 3 behind it. Those whose `q` is `trapq:toolhead` hold moves: when a move begins and how
//! long it takes, in s; its velocity there in mm/s, its acceleration in mm/s²; where it begins, in mm; and its direction, a unit vector.
//! At t behind its begin the tool is v t + a t² / 2 along the direction from there.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};

use serde::Deserialize;

use crate::log_error::{LogError, quoted};
use crate::part_path::distance;
use crate::row::{Row, Rows};
use crate::text::{Text, unreadable};

/// The byte behind each message.
const END: u8 = 3;
/// Bytes of a message, at most: Klipper sends what it has done in a fraction of a second, and once all that it knows of itself.
const LONGEST: usize = 16 << 20;
/// The moves of the tool.
const TOOL: &str = "trapq:toolhead";
/// A velocity that differs by more than this behind a joint of moves has jumped, in mm/s: numbers in JSON are rounded.
const JUMP_MM_PER_S: f64 = 1e-3;

/// A message, as far as it matters here.
#[derive(Deserialize)]
struct Message {
    q: Option<String>,
    params: Option<Params>,
}

#[derive(Deserialize)]
struct Params {
    #[serde(default)]
    data: serde_json::Value,
}

/// A move of constant acceleration.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
struct Move {
    begin_s: f64,
    takes_s: f64,
    velocity: f64,
    acceleration: f64,
    from_mm: [f64; 3],
    direction: [f64; 3],
}

impl Move {
    fn end_s(&self) -> f64 {
        self.begin_s + self.takes_s
    }

    /// Where the tool is at a time, which is cut to that of the move.
    fn at(&self, time_s: f64) -> [f64; 3] {
        let t = (time_s - self.begin_s).clamp(0.0, self.takes_s);
        let way = (self.velocity + 0.5 * self.acceleration * t) * t;
        std::array::from_fn(|axis| self.from_mm[axis] + self.direction[axis] * way)
    }

    /// The velocity so long behind its begin.
    fn velocity_at(&self, t: f64) -> [f64; 3] {
        self.direction.map(|part| part * (self.velocity + self.acceleration * t))
    }
}

/// A log of moves that is being read.
pub(crate) struct MotanLog<'a> {
    source: BufReader<Box<dyn Read + 'a>>,
    message: Vec<u8>,
    messages: u64,
    moves: VecDeque<Move>,
    /// The move that was made last.
    last: Option<Move>,
    period_s: f64,
    begin_s: f64,
    /// Setpoints so far, and periods: those without a move between have none.
    rows: u64,
    next_period: u64,
    largest_mm: f64,
    /// Where the tool was followed to, and how long its way there is from the last setpoint, in mm.
    followed_to: Option<[f64; 3]>,
    way_mm: f64,
}

impl<'a> MotanLog<'a> {
    /// Whether a text begins as such a log does.
    pub(crate) fn begins(head: &[u8]) -> bool {
        head.trim_ascii_start().starts_with(b"{")
    }

    pub(crate) fn new(text: Text<'a>, period_s: f64) -> Self {
        Self {
            source: BufReader::new(text.all),
            message: Vec::new(),
            messages: 0,
            moves: VecDeque::new(),
            last: None,
            period_s,
            begin_s: 0.0,
            rows: 0,
            next_period: 0,
            largest_mm: 0.0,
            followed_to: None,
            way_mm: 0.0,
        }
    }

    /// Follows the tool along a straight way.
    fn go_to(&mut self, point_mm: [f64; 3]) {
        let from = self.followed_to.replace(point_mm);
        self.way_mm += from.map_or(0.0, |from| distance(&from, &point_mm));
    }

    /// Reads messages until there is a move; `false` at the end.
    fn read_moves(&mut self) -> Result<bool, LogError> {
        while self.moves.is_empty() {
            self.message.clear();
            let mut within = (&mut self.source).take(LONGEST as u64);
            let count = within.read_until(END, &mut self.message).map_err(|error| unreadable(&error))?;
            if count == 0 {
                return Ok(false);
            }
            self.messages += 1;
            if self.message.pop_if(|last| *last == END).is_none() {
                if count == LONGEST {
                    return Err(self.wrong("is too long", "a log of Klipper's motan"));
                }
                // A logger that was killed leaves a part of its last message.
                return Ok(false);
            }
            self.take_message()?;
        }
        Ok(true)
    }

    fn wrong(&self, what: &str, expected: &str) -> LogError {
        let begin = quoted(&self.message);
        LogError::whole(format!("message {} {what}: `{begin}`", self.messages), expected)
    }

    fn take_message(&mut self) -> Result<(), LogError> {
        let message: Message = serde_json::from_slice(&self.message).map_err(|error| {
            self.wrong(&format!("is not read ({error})"), "JSON, as Klipper's motan writes it")
        })?;
        if message.q.as_deref() != Some(TOOL) {
            return Ok(());
        }
        let data = message.params.map(|params| params.data).unwrap_or_default();
        let moves: Vec<Move> = serde_json::from_value(data).map_err(|error| {
            let expected =
                "moves of time, duration, start_velocity, acceleration, start_position and direction";
            self.wrong(&format!("holds no moves ({error})"), expected)
        })?;
        for one in moves {
            let before = self.moves.back().or(self.last.as_ref());
            let numbers = [one.begin_s, one.takes_s, one.velocity, one.acceleration];
            let is_sound = numbers.iter().chain(&one.from_mm).chain(&one.direction).all(|x| x.abs() < 1e12);
            if !is_sound || one.takes_s < 0.0 {
                return Err(self.wrong("holds a move that takes no time", "times from 0 up"));
            }
            if before.is_some_and(|before| one.begin_s < before.begin_s) {
                return Err(self.wrong("goes back in time", "moves in the order in which they were made"));
            }
            self.moves.push_back(one);
        }
        Ok(())
    }

    /// Whether the velocity jumps at the begin of the next move.
    fn jumps(&self, next: &Move) -> bool {
        let before = self.last.as_ref().map_or([0.0; 3], |last| last.velocity_at(last.takes_s));
        let behind = next.velocity_at(0.0);
        (0..3).any(|axis| (before[axis] - behind[axis]).abs() > JUMP_MM_PER_S)
    }

    fn row(&mut self, point_mm: [f64; 3], passes_corner: bool) -> Row {
        let time_s = self.begin_s + self.next_period as f64 * self.period_s;
        self.rows += 1;
        self.next_period += 1;
        self.go_to(point_mm);
        let chord_mm = Some(std::mem::take(&mut self.way_mm));
        self.largest_mm = point_mm.iter().fold(self.largest_mm, |most, x| most.max(x.abs()));
        Row { number: self.rows, time_s: Some(time_s), point_mm, passes_corner, chord_mm, ..Row::default() }
    }

    /// The place of the tool at a time at which it stands between two moves, or behind the last; `None` if it moves on.
    fn standing_at(&self, time_s: f64) -> Option<[f64; 3]> {
        let last = self.last.as_ref()?;
        let next = self.moves.front().map_or(f64::INFINITY, |next| next.begin_s);
        (time_s < next).then(|| last.at(last.end_s()))
    }
}

impl Rows for MotanLog<'_> {
    fn next_row(&mut self) -> Result<Option<Row>, LogError> {
        let mut passes_corner = false;
        loop {
            let has_moves = self.read_moves()?;
            if self.rows == 0
                && let Some(first) = self.moves.front()
            {
                self.begin_s = first.begin_s;
                let from = first.from_mm;
                return Ok(Some(self.row(from, false)));
            }
            let time_s = self.begin_s + self.next_period as f64 * self.period_s;
            if let Some(point) = self.standing_at(time_s) {
                let is_over =
                    !has_moves && self.last.is_some_and(|last| time_s > last.end_s() + 2.0 * self.period_s);
                if is_over {
                    return Ok(None);
                }
                self.pass_over_a_stand(time_s);
                return Ok(Some(self.row(point, passes_corner)));
            }
            let Some(next) = self.moves.front().copied() else { return Ok(None) };
            if time_s <= next.end_s() {
                passes_corner |= self.entered(&next);
                let point = next.at(time_s);
                return Ok(Some(self.row(point, passes_corner)));
            }
            passes_corner |= self.entered(&next);
            self.go_to(next.at(next.end_s()));
            self.moves.pop_front();
            self.last = Some(next);
        }
    }

    fn resolution_mm(&self) -> f64 {
        // The rounding of the sums above.
        8.0 * f64::EPSILON * self.largest_mm
    }

    fn time_resolution_s(&self) -> f64 {
        0.0
    }
}

impl MotanLog<'_> {
    /// Goes on to just before the next move where the tool has stood for some periods and still does: such periods need no rows.
    fn pass_over_a_stand(&mut self, time_s: f64) {
        let margin_s = 2.0 * self.period_s;
        let has_stood = self.last.is_some_and(|last| time_s > last.end_s() + margin_s);
        let Some(next) = self.moves.front().filter(|_| has_stood) else { return };
        let periods = ((next.begin_s - margin_s - time_s) / self.period_s).floor();
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is clamped before")]
        let periods = periods.clamp(0.0, 1e15) as u64;
        self.next_period += periods;
    }

    /// Whether the step to this time enters a move with a jump of the velocity.
    fn entered(&self, next: &Move) -> bool {
        let before = self.begin_s + (self.next_period as f64 - 1.0) * self.period_s;
        next.begin_s >= before && self.jumps(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::begun;

    /// From rest at 3,000 mm/s² to 30 mm/s, on at that, and round a corner with a jump; then it stands, and goes back.
    const LOG: &str = "{\"id\":1,\"result\":{}}\u{3}{\"q\":\"status\",\"params\":{\"data\":{\"a\":1}}}\u{3}\
        {\"q\":\"trapq:toolhead\",\"params\":{\"data\":[[4.0,0.01,0.0,3000.0,[1.0,2.0,0.0],[1.0,0.0,0.0]],\
        [4.01,0.01,30.0,0.0,[1.15,2.0,0.0],[1.0,0.0,0.0]]]}}\u{3}\
        {\"q\":\"trapq:toolhead\",\"params\":{\"data\":[[4.02,0.01,30.0,-3000.0,[1.45,2.0,0.0],[0.0,1.0,0.0]],\
        [9.0,0.01,0.0,3000.0,[1.45,2.15,0.0],[-1.0,0.0,0.0]]]}}\u{3}";

    fn rows(text: &str) -> Result<Vec<Row>, LogError> {
        rows_of(text, 0.001)
    }

    fn rows_of(text: &str, period_s: f64) -> Result<Vec<Row>, LogError> {
        let mut log = MotanLog::new(begun(text.as_bytes())?, period_s);
        let mut rows = Vec::new();
        while let Some(row) = log.next_row()? {
            rows.push(row);
        }
        Ok(rows)
    }

    #[test]
    fn moves_are_sampled_once_a_period() {
        assert!(MotanLog::begins(LOG.as_bytes()));
        let rows = rows(LOG).unwrap();
        for (index, expected) in [(0, [1.0, 2.0]), (5, [1.0375, 2.0]), (15, [1.3, 2.0]), (25, [1.45, 2.1125])]
        {
            let [x, y, _] = rows[index].point_mm;
            assert!((x - expected[0]).abs() < 1e-9 && (y - expected[1]).abs() < 1e-9, "{index}: {x} {y}");
        }
        let corners: Vec<u64> = rows.iter().filter(|row| row.passes_corner).map(|row| row.number).collect();
        assert!(corners == [21] || corners == [22], "{corners:?}");
        // The time between 4.03 s and 9 s takes no rows.
        assert!(rows.len() < 60, "{}", rows.len());
        let last = rows.last().unwrap();
        assert!((last.point_mm[0] - 1.3).abs() < 1e-9 && last.time_s.unwrap() > 9.009, "{last:?}");
    }

    /// A step that passes a corner has the length of both of its legs.
    #[test]
    fn the_length_of_a_step_is_that_of_its_moves() {
        let rows = rows_of(LOG, 0.0013).unwrap();
        let ways: Vec<f64> = rows.iter().filter_map(|row| row.chord_mm).collect();
        assert!(ways.len() == rows.len() && (ways.iter().sum::<f64>() - 0.75).abs() < 1e-9, "{ways:?}");
        let chords = rows.windows(2).map(|pair| distance(&pair[0].point_mm, &pair[1].point_mm));
        assert!(chords.sum::<f64>() < 0.749);
    }

    #[test]
    fn what_is_no_such_log_is_refused() {
        let said = |text: &str| rows(text).unwrap_err().to_string();
        assert!(said("{\"q\":1}\u{3}").contains("message 1 is not read"));
        let back = "{\"q\":\"trapq:toolhead\",\"params\":{\"data\":[[2,1,0,0,[0,0,0],[1,0,0]],[1,1,0,0,[0,0,0],[1,0,0]]]}}\u{3}";
        assert!(said(back).contains("goes back in time"));
    }
}
