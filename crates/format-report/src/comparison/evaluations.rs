//! A histogram of the evaluations of the curve in a period.

use crate::chart::{Axis, Layout, draw};
use crate::comparison::runs::{RunView, entries};
use crate::figure::Figure;
use crate::number;

/// One picture of all runs.
pub(crate) fn figures(runs: &[RunView<'_>]) -> Vec<Figure> {
    let counted: Vec<(&RunView<'_>, Vec<f64>)> =
        runs.iter().filter_map(|run| Some((run, shares(&run.trace?.evaluations)))).collect();
    let most = counted.iter().map(|(_, shares)| shares.len()).max().unwrap_or(0);
    if most == 0 {
        return Vec::new();
    }
    let names = (0..most).map(|count| count.to_string()).collect();
    let x = Axis::of_names("evaluations of the curve in a period [count]", names);
    let y = Axis::linear("share of the periods [%]", 0.0..100.0);
    // The bars of all runs stand side by side in eight tenths of the room.
    let width = 0.8 / counted.len() as f64;
    let figure = draw((x, y), &Layout::default(), |plot| {
        for (place, (run, shares)) in counted.iter().enumerate() {
            plot.group(&run.class(), &run.name(), |plot| {
                for (count, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                    let left = count as f64 - 0.4 + width * place as f64;
                    let tip = format!(
                        "{}: {count} in {} % of the periods",
                        run.name(),
                        number::short(share * 100.0)
                    );
                    plot.boxes("fill", &[[left, left + 0.9 * width, 0.0, share * 100.0]], &tip);
                }
            });
        }
    });
    let caption = "Evaluations are what a period's time goes into. The worst period counts for a controller, not the mean.";
    vec![figure.named("evaluations", "Evaluations a period, by format", caption).with_runs(entries(runs))]
}

/// The share of the periods with 0, 1, 2, … evaluations.
fn shares(periods: &[u64]) -> Vec<f64> {
    let all = periods.iter().sum::<u64>().max(1) as f64;
    periods.iter().map(|count| *count as f64 / all).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn shares_add_up() {
        assert_eq!(super::shares(&[0, 2, 0, 2]), [0.0, 0.5, 0.0, 0.5]);
    }
}
