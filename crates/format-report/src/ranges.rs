//! The powers of two of each named signal's values, against the format's range.

use std::collections::BTreeMap;

use plotters::style::text_anchor::{HPos, VPos};
use real::{FormatName, Histogram, RuntimeFormat, SignalRange};

use crate::chart::{Axis, Layout, Plot, draw};
use crate::figure::Figure;
use crate::number;

/// The signals of a run.
pub(crate) struct Ranges<'a> {
    /// The run's number, name and hue.
    pub(crate) index: usize,
    pub(crate) name: String,
    pub(crate) hue: usize,
    /// Its format.
    pub(crate) format: &'a str,
    /// The range of each signal.
    pub(crate) signals: &'a BTreeMap<&'static str, SignalRange>,
    /// How large its values were.
    pub(crate) histograms: &'a BTreeMap<&'static str, Histogram>,
}

/// The picture of a run; `None` if no signal had a value.
pub(crate) fn figure(run: &Ranges<'_>) -> Option<Figure> {
    let exponents =
        || run.histograms.values().flat_map(|histogram| histogram.bins().map(|(exponent, _)| exponent));
    let (low, high) = (exponents().min()?, exponents().max()?);
    let edges = edges(run.format);
    // The picture shows the format's range if it is near the values; the range of a float is far away.
    let (low, high) = edges.map_or((low - 2, high + 3), |(least, beyond)| {
        ((least - 6).min(low - 1), (beyond + 8).max(high + 6))
    });
    let names: Vec<String> = run.signals.keys().map(|name| name.replace('_', " ")).collect();
    let height = 70 + 24 * u32::try_from(names.len()).unwrap_or(1);
    let x = Axis::linear(
        "position of the leading bit: log₂ of the magnitude [1]",
        f64::from(low)..f64::from(high),
    );
    let y = Axis::of_names("", names.clone());
    let (top, bottom) = (-0.5, names.len() as f64 - 0.5);
    let layout = Layout { height, left: 170, from_top: true };
    let drawn = draw((x, y), &layout, |plot| {
        if let Some((least, beyond)) = edges {
            let beyond_name = format!("{}: overflow from here on", run.format);
            plot.boxes("outside", &[[f64::from(beyond), f64::from(high), top, bottom]], &beyond_name);
            let below_name = format!("{}: below its resolution", run.format);
            plot.boxes("outside", &[[f64::from(low), f64::from(least), top, bottom]], &below_name);
            plot.upright(f64::from(beyond));
            plot.upright(f64::from(least));
        }
        plot.group(&format!("c{} d0", run.hue), "", |plot| signals(plot, run, f64::from(high)));
    });
    let caption = match edges {
        Some(_) => {
            "How often the leading bit of each signal stood at which power of two; heights on a logarithmic scale. \
             Shaded: left of the resolution a value is zero, right of the range it overflows. What did is written beside \
             its signal."
        }
        None => {
            "How often the leading bit of each signal stood at which power of two; heights on a logarithmic scale. A \
             float's own range is far outside the picture."
        }
    };
    let title = format!("Ranges of the signals in {}", run.name);
    Some(drawn.named(&format!("ranges-{}", run.name), &title, caption).of_run(run.index))
}

fn signals(plot: &mut Plot<'_>, run: &Ranges<'_>, right: f64) {
    let bins = || run.histograms.values().flat_map(|histogram| histogram.bins());
    let most = bins().map(|(_, count)| count as f64).fold(1.0, f64::max).ln_1p();
    for (place, (name, range)) in run.signals.iter().enumerate() {
        let foot = place as f64 + 0.42;
        let boxes: Vec<[f64; 4]> = run.histograms.get(name).map_or_else(Vec::new, |histogram| {
            let bar = |(exponent, count): (i32, u64)| {
                let height = 0.84 * (count as f64).ln_1p() / most;
                [f64::from(exponent), f64::from(exponent + 1), foot, foot - height]
            };
            histogram.bins().map(bar).collect()
        });
        let tip = format!(
            "{name}: {} to {}, {} values, {} of them zero, {} overflows, {} underflows to zero",
            number::short(range.min),
            number::short(range.max),
            range.count,
            range.zeros,
            range.overflows,
            range.underflows
        );
        plot.boxes("fill", &boxes, &tip);
        let fate: Vec<String> = [(range.overflows, "overflows"), (range.underflows, "underflows")]
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{count} {what}"))
            .collect();
        if !fate.is_empty() {
            plot.note((right - 0.3, place as f64), (HPos::Right, VPos::Center), &fate.join(", "));
        }
    }
}

/// The exponent of a fixed-point format's resolution, and the first exponent beyond its range.
fn edges(format: &str) -> Option<(i32, i32)> {
    match RuntimeFormat::named(format)?.name() {
        FormatName::Fixed { integer_bits, fraction_bits, .. } => {
            Some((-fraction_bits.cast_signed(), integer_bits.cast_signed() - 1))
        }
        FormatName::Fraction { bits, fraction_bits } => {
            Some((-fraction_bits.cast_signed(), bits.cast_signed() - fraction_bits.cast_signed() - 1))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_range_of_a_format_in_powers_of_two() {
        assert_eq!(super::edges("I8F24"), Some((-24, 7)));
        assert_eq!(super::edges("I16F16"), Some((-16, 15)));
        assert_eq!(super::edges("f32"), None);
    }
}
