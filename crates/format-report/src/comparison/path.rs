//! The path, coloured by fluctuation.

use std::ops::Range;

use format_compare::Trace;

use crate::chart::{Layout, draw};
use crate::comparison::material::Material;
use crate::comparison::runs::RunView;
use crate::equal_scales::{MOST_POINTS, equal_scales};
use crate::figure::Figure;
use crate::levels::{legend, level};
use crate::number;
use crate::thinned::thinned;

/// Most parts that a path is cut into. Each has the colour of its worst period.
const MOST_PARTS: usize = 400;

/// Points that each of these pictures may have in any case.
const FEW_POINTS: usize = 1500;

/// A step below this share of the full step is near rest, and its ratio is not judged.
const AT_CRUISE: f64 = 0.25;

/// A picture for each run, from above. If the path is not in the plane of X and Y, one more from the front.
pub(crate) fn figures(material: &Material<'_>, runs: &[RunView<'_>]) -> Vec<Figure> {
    let flat = runs.iter().filter_map(|run| run.trace).all(|trace| {
        let heights = trace.point_mm.iter().map(|point| point[2]);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
        high - low <= 1e-6
    });
    let views: &[(usize, usize, &str)] = if flat { &[(0, 1, "")] } else { &[(0, 1, "-xy"), (0, 2, "-xz")] };
    let pictures = runs.iter().filter(|run| run.trace.is_some()).count().max(1) * views.len();
    let view = |run, view| figure(material, run, view, (MOST_POINTS / pictures).max(FEW_POINTS));
    runs.iter().flat_map(|run| views.iter().filter_map(move |one| view(run, *one))).collect()
}

fn figure(
    material: &Material<'_>,
    run: &RunView<'_>,
    (across, up, view): (usize, usize, &str),
    most_points: usize,
) -> Option<Figure> {
    let trace = run.trace.filter(|trace| trace.entries() > 1)?;
    let points: Vec<(f64, f64)> = trace.point_mm.iter().map(|point| (point[across], point[up])).collect();
    let (axes, height, pixel) =
        equal_scales(&points, ["X [mm]", "Y [mm]", "Z [mm]"][across], ["X [mm]", "Y [mm]", "Z [mm]"][up]);
    let limit = material.comparison.machine.fluctuation_limit;
    let full_step = material.comparison.machine.feedrate_mm_per_s * material.period_s();
    let jumps = jumps(trace);
    let mut coloured_parts = coloured_parts(trace, full_step, limit);
    // Where the path crosses itself, the worst part must be on top.
    coloured_parts.sort_by_key(|part| std::cmp::Reverse(part.level));
    let lines = coloured_parts
        .iter()
        .map(|part| without_jumps(&points, &jumps, part.first..part.last + 1))
        .collect::<Vec<_>>();
    let lines = thinned(&lines, pixel, most_points);
    let drawn = draw(axes, &Layout { height, ..Layout::default() }, |plot| {
        // The worst is drawn last, on top.
        for (part, lines) in coloured_parts.iter().zip(&lines).rev().filter(|(_, lines)| !lines.is_empty()) {
            let lines: Vec<_> = lines.iter().map(Vec::as_slice).collect();
            let from = (part.first as f64 + 1.0) * material.period_s();
            let to = (part.last as f64 + 1.0) * material.period_s();
            let times = format!("{} to {} s", number::short(from), number::short(to));
            match part.level {
                Some(level) => {
                    let tip = format!("{times}: fluctuation up to {}", number::short(part.largest));
                    plot.trails(&format!("trail v{level}"), &lines, &tip);
                }
                None => {
                    plot.trails("rest", &lines, &format!("{times}: near rest, below a quarter of the feed"))
                }
            }
        }
    });
    let caption = format!(
        "Each part has the colour of its largest |δ|. The limit is {}; the thin grey ends are near rest, where it does \
         not hold.",
        number::short(limit)
    );
    let side = match view {
        "-xy" => " from above",
        "-xz" => " from the front",
        _ => "",
    };
    let title = format!("The path{side}, coloured by the fluctuation of {}", run.name());
    let name = format!("path-{}{view}", run.name());
    Some(drawn.named(&name, &title, &caption).of_run(run.index).with_legend(legend(limit, "near rest")))
}

/// The periods that do not begin where the one before ends: a rapid move was left out.
fn jumps(trace: &Trace) -> Vec<usize> {
    let distance = |pair: &[[f64; 3]]| pair[1].iter().zip(&pair[0]).fold(0.0_f64, |d, (a, b)| d.hypot(a - b));
    let is_jump = |(index, pair): (usize, &[[f64; 3]])| {
        // A chord has the wanted length, up to rounding.
        let periods = (trace.end[index + 1] - trace.end[index]) as f64;
        let allowed = 2.0 * periods * trace.wanted_mm[index + 1] + GAP_MM;
        (distance(pair) > allowed).then_some(index + 1)
    };
    trace.point_mm.windows(2).enumerate().filter_map(is_jump).collect()
}

/// The longest chord, in mm, that rounding alone can make.
const GAP_MM: f64 = 0.05;

/// The points of these periods, as a line from each jump to the next.
fn without_jumps<'a>(
    points: &'a [(f64, f64)],
    jumps: &[usize],
    periods: Range<usize>,
) -> Vec<&'a [(f64, f64)]> {
    let within = jumps.iter().copied().filter(|jump| periods.start < *jump && *jump < periods.end);
    let ends: Vec<usize> = std::iter::once(periods.start).chain(within).chain([periods.end]).collect();
    ends.windows(2).map(|ends| &points[ends[0]..ends[1]]).collect()
}

/// A part of the path that has one colour.
#[derive(Debug, PartialEq)]
struct ColouredPart {
    first: usize,
    last: usize,
    /// The level of the colour; `None` near rest.
    level: Option<usize>,
    largest: f64,
}

/// The path in parts of equal colour, each a whole number of groups of periods.
fn coloured_parts(trace: &Trace, full_step: f64, limit: f64) -> Vec<ColouredPart> {
    let group = trace.entries().div_ceil(MOST_PARTS).max(1);
    let mut coloured_parts: Vec<ColouredPart> = Vec::new();
    for first in (0..trace.entries()).step_by(group) {
        let last = (first + group).min(trace.entries() - 1);
        let periods = first..(first + group).min(trace.entries());
        // The last period takes the rest of the path: it is not at cruise, as in the figures of a run.
        let judged = periods.filter(|period| {
            period + 1 < trace.entries() && trace.wanted_mm[*period] >= AT_CRUISE * full_step
        });
        let largest = judged.map(|period| trace.fluctuation[period].abs()).fold(f64::NAN, f64::max);
        let level = (!largest.is_nan()).then(|| level(largest, limit));
        match coloured_parts.last_mut() {
            Some(before) if before.level == level => {
                before.last = last;
                before.largest = before.largest.max(largest);
            }
            _ => coloured_parts.push(ColouredPart { first, last, level, largest }),
        }
    }
    coloured_parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rapid moves are not drawn.
    #[test]
    fn a_rapid_move_that_was_left_out_is_a_gap() {
        let along = |x: f64| [x, 0.0, 0.0];
        let trace = Trace {
            end: (1..=5).collect(),
            point_mm: [0.5, 1.0, 1.5, 40.0, 40.5].map(along).into(),
            wanted_mm: vec![0.5; 5],
            fluctuation: vec![0.0; 5],
            ..Trace::default()
        };
        assert_eq!(jumps(&trace), [3]);
        let points: Vec<_> = trace.point_mm.iter().map(|point| (point[0], point[1])).collect();
        let lines = without_jumps(&points, &jumps(&trace), 1..5);
        assert_eq!(lines, [&[(1.0, 0.0), (1.5, 0.0)], &[(40.0, 0.0), (40.5, 0.0)]]);
    }

    /// The parts join without gaps, cover the path, and each has the colour of its worst period.
    #[test]
    fn parts_cover_the_path() {
        let periods = 1000;
        let trace = Trace {
            end: (1..=1000).collect(),
            wanted_mm: (0..periods).map(|i| if i < 10 { 0.01 } else { 0.6 }).collect(),
            fluctuation: (0..periods).map(|i| if i == 500 { 1e-4 } else { 1e-8 }).collect(),
            ..Trace::default()
        };
        let found = coloured_parts(&trace, 0.6, 1e-6);
        assert_eq!((found[0].level, found[0].first), (None, 0));
        assert!(found.windows(2).all(|pair| pair[0].last == pair[1].first));
        assert_eq!(found.last().map(|part| part.last), Some(periods - 1));
        let worst = found.iter().find(|s| s.first <= 500 && 500 < s.last).expect("a part");
        assert_eq!((worst.level, worst.largest), (Some(5), 1e-4));
    }
}
