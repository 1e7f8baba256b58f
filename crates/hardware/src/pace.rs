//! The least period that a run holds, by the cycles that its setpoints take.
//!
//! Setpoints are taken at ticks, one period P apart, from a queue of Q places. The core begins with setpoint k, by passing a wait, at
//! b_k. It is whole at w_k = b_k + until_whole_k, and then comes the next wait: b_{k+1} is b_k + until_ready_k, or the cycle behind the
//! tick that takes setpoint k + 1 - Q if that is later. The run holds P if each setpoint of a section is whole when its tick comes.
//!
//! A section begins at rest: its first setpoint is shown when the queue is full, or when all setpoints are made. Its ticks are counted
//! from the worst moment, at which the first one is taken as soon as it is shown. The tick behind the last setpoint may come when it is
//! known that there is no other one.

/// What a setpoint takes, in cycles from when the wait before it was passed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace {
    /// Until it stands in the queue.
    pub(crate) until_whole: u64,
    /// Until the next wait.
    pub(crate) until_ready: u64,
}

/// What the setpoints of a section take.
#[derive(Clone, Debug, Default)]
pub(crate) struct SectionPace {
    pub(crate) setpoints: Vec<Pace>,
    /// From the last wait until the section is known to be over.
    pub(crate) until_done: u64,
}

impl SectionPace {
    /// When the core has made each setpoint, and when it knows that there is no other one, from the section's first wait on. `room` is when a
    /// wait of this number may be passed.
    fn made(&self, room: impl Fn(usize) -> u64) -> impl Iterator<Item = u64> {
        let wholes = self.setpoints.iter().map(|pace| pace.until_whole).chain([self.until_done]);
        let waits = [0].into_iter().chain(self.setpoints.iter().map(|pace| pace.until_ready));
        let begins = waits.enumerate().scan(0, move |begins, (number, wait)| {
            *begins = (*begins + wait).max(room(number));
            Some(*begins)
        });
        begins.zip(wholes).map(|(begins, until_whole)| begins + until_whole)
    }

    /// Whether no tick comes too early, with this period and queue.
    fn holds(&self, period: u64, queue: usize) -> bool {
        let Some(shown) = self.made(|_| 0).take(queue.min(self.setpoints.len() + 1)).last() else {
            return true;
        };
        let tick = |number: usize| shown + number as u64 * period;
        let room = |number: usize| number.checked_sub(queue).map_or(0, |taken| tick(taken) + 1);
        self.made(room).enumerate().all(|(number, made)| made <= tick(number))
    }
}

/// The least period in cycles that all sections hold with a queue of so many places, from one on.
pub(crate) fn least_period(sections: &[SectionPace], queue: usize) -> u64 {
    let paces = sections.iter().flat_map(|section| &section.setpoints);
    let longest = paces.map(|pace| pace.until_whole.max(pace.until_ready)).max().unwrap_or(0);
    let done = sections.iter().map(|section| section.until_done).max().unwrap_or(0);
    // A run holds every period above one that it holds: what is taken later leaves more time for what is behind it.
    let (mut least, mut most) = (1, 2 * longest + done + 1);
    while least < most {
        let middle = least.midpoint(most);
        if sections.iter().all(|section| section.holds(middle, queue)) {
            most = middle;
        } else {
            least = middle + 1;
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(until_whole: &[u64]) -> Vec<SectionPace> {
        let setpoints =
            until_whole.iter().map(|cycles| Pace { until_whole: *cycles, until_ready: *cycles }).collect();
        vec![SectionPace { setpoints, until_done: 1 }]
    }

    #[test]
    fn without_a_queue_the_worst_setpoint_decides() {
        // The wait is passed the cycle behind the tick.
        assert_eq!(least_period(&section(&[900, 10, 10, 100, 10, 10]), 1), 101);
    }

    #[test]
    fn a_queue_brings_the_least_period_near_the_mean() {
        let slow_once = [10, 10, 10, 10, 10, 10, 100, 10, 10, 10];
        // Two places, full at 20. The slow one is begun behind tick 4, and tick 6 is 2 P later.
        assert_eq!(least_period(&section(&slow_once), 2), 51);
        // Six places, full at 60. The slow one is begun behind tick 0, and tick 6 is 6 P later.
        assert_eq!(least_period(&section(&slow_once), 6), 17);
    }

    #[test]
    fn a_section_that_fits_the_queue_holds_any_period() {
        assert_eq!(least_period(&section(&[500, 900, 700]), 4), 1);
    }

    #[test]
    fn the_end_of_a_section_is_known_before_the_next_tick() {
        let mut sections = section(&[10, 10]);
        sections[0].until_done = 50;
        assert_eq!(least_period(&sections, 1), 51);
    }

    #[test]
    fn each_section_counts_from_its_own_rest() {
        let mut sections = section(&[10, 30]);
        sections.extend(section(&[500, 40]));
        assert_eq!(least_period(&sections, 1), 41);
    }
}
