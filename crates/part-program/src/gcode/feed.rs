//! F words, and lengths that a control may read in another unit.

use domains::machine::FEED;
use domains::shown;

use crate::gcode::block::Block;
use crate::gcode::modal::{FeedMode, Motion};
use crate::gcode::reader::Reader;
use crate::options::Dialect;
use crate::source::Span;

impl Reader<'_, '_, '_> {
    /// Warns once of a length without a decimal point, which many controls of FANUC count in least increments.
    pub(crate) fn look_for_points(&mut self, block: &Block<'_>) {
        if !self.whole_units {
            return;
        }
        let letters: &[u8] = match self.modal.motion {
            Motion::Arc { .. } => b"XYZIJKR",
            _ => b"XYZ",
        };
        let source = &self.report.source;
        let Some(word) = block.without_point(source, letters) else { return };
        let (text, unit) =
            (source.slice(word.span), if self.modal.inches { "inches" } else { "millimetres" });
        let increments = if self.modal.inches { "0.0001 inch" } else { "0.001 mm" };
        let message = format!("numbers without a decimal point are read as whole {unit}: `{text}`");
        self.report.warning(word.span, message).hint(format!(
            "a control may read them as increments of {increments}; with a point they are alike"
        ));
        self.whole_units = false;
    }

    /// Takes F: in G94 it becomes the feedrate, in G93 it is returned, in 1/min, and in G95 it becomes the feed of a
    /// revolution.
    pub(crate) fn feed(&mut self, block: &mut Block<'_>, unit_before: f64) -> Option<f64> {
        let word = block.take_letter(b'F')?;
        let mut unit = self.modal.feed_unit_mm();
        if unit != unit_before {
            let dialect = self.options.dialect;
            if dialect == Some(Dialect::LinuxCnc) {
                unit = unit_before;
            } else if dialect.is_none() {
                let text = self.report.source.slice(word.span).to_owned();
                self.report
                    .warning(word.span, format!("`{text}` is read in the unit that its block sets"))
                    .hint("LinuxCNC reads it in the unit before, as with its dialect given");
            }
        }
        if self.options.dialect.is_none() && self.modal.inches != self.modal.feed_in_inches {
            let text = self.report.source.slice(word.span);
            let unit = if self.modal.feed_in_inches { "inches" } else { "mm" };
            let message = format!("`{text}` is read in {unit}: G70 and G71 change the unit of lengths alone");
            self.report.of_kind(false, word.span, "feed unit", message).hint(
                "so do Siemens' controls; on others they change that of F too, as G700, G710, G20 and G21 do",
            );
        }
        if word.value <= 0.0 {
            let message = format!("the feed is {}", shown(word.value));
            self.report.error(word.span, message).expected("a feed above 0");
            return None;
        }
        match self.modal.feed_mode {
            FeedMode::PerMinute => {}
            FeedMode::InverseTime => return Some(word.value),
            FeedMode::PerRevolution => {
                self.modal.feed_mm_per_revolution = Some(word.value * unit);
                return None;
            }
        }
        let feedrate = word.value * unit / 60.0;
        if feedrate < FEED.least() {
            let message = format!("the feed is {} mm/s", shown(feedrate));
            self.report.error(word.span, message).expected(FEED.to_string());
            return None;
        }
        self.others.feed.commanded_mm_per_s = Some(feedrate);
        self.scale_feed(word.span);
        None
    }

    /// Puts the commanded feed into force, as a printer's M220 scales it.
    fn scale_feed(&mut self, span: Span) {
        let feed = &self.others.feed;
        let scaled = feed.commanded_mm_per_s.map(|commanded| commanded * feed.scale);
        self.modal.feedrate_mm_per_s = scaled.and_then(|feedrate| self.within_feeds(feedrate, span));
    }

    /// `M220 S50`: every feed is 50 % of what is commanded. B keeps the percentage, R brings the kept one back.
    pub(crate) fn feed_percentage(&mut self, block: &mut Block<'_>, span: Span) {
        let feed = &mut self.others.feed;
        let mut asks = |letter: u8| block.take_letter(letter).is_some() || self.flags.contains(&letter);
        if asks(b'B') {
            feed.kept_scale = feed.scale;
        }
        if asks(b'R') {
            feed.scale = feed.kept_scale;
        }
        if let Some(word) = block.take_letter(b'S') {
            if word.value <= 0.0 {
                let text = self.report.source.slice(word.span);
                let message = format!("`{text}`: a feed of {} %", shown(word.value));
                self.report.error(word.span, message).expected("a percentage above 0");
                return;
            }
            feed.scale = word.value / 100.0;
        }
        self.scale_feed(span);
    }

    /// A feedrate in mm/s that a machine can have: above that, none, and the machine's own holds; below that, the least.
    pub(crate) fn within_feeds(&mut self, feedrate: f64, span: Span) -> Option<f64> {
        if feedrate > FEED.most() {
            let text = self.report.source.slice(span);
            let message = format!(
                "`{text}` is {} mm/s, as fast as any machine can: the machine's own feed is taken",
                if feedrate < 1e9 { format!("{feedrate:.0}") } else { shown(feedrate) }
            );
            self.report.of_kind(false, span, "fast", message);
            return None;
        }
        if feedrate.is_nan() || feedrate < FEED.least() {
            let message = format!(
                "a feed of {} mm/s is slower than any machine: {} mm/s is taken",
                shown(feedrate),
                shown(FEED.least())
            );
            self.report.of_kind(false, span, "slow", message);
            return Some(FEED.least());
        }
        Some(feedrate)
    }
}
