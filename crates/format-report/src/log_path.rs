//! The path of a log, coloured by what it takes of limits.

use crate::chart::{Layout, draw};
use crate::equal_scales::{MOST_POINTS, equal_scales};
use crate::figure::Figure;
use crate::levels::{legend, level};
use crate::log_path_point::LogPathPoint;
use crate::number;
use crate::thinned::thinned;

/// A stretch of one colour: the places from the first to the one behind the last.
struct Stretch {
    first: usize,
    last: usize,
    level: usize,
    largest: f64,
}

/// The path from above; if it is not in the plane of X and Y, from the front too. None of fewer than two places.
pub(crate) fn figures(path: &[LogPathPoint]) -> Vec<Figure> {
    let heights = path.iter().map(|place| place.point_mm[2]);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), z| (l.min(z), h.max(z)));
    let views: &[(usize, usize, &str)] =
        if high - low <= 1e-6 { &[(0, 1, "")] } else { &[(0, 1, "-xy"), (0, 2, "-xz")] };
    let most = MOST_POINTS / views.len();
    if path.len() < 2 { Vec::new() } else { views.iter().map(|view| figure(path, *view, most)).collect() }
}

fn figure(path: &[LogPathPoint], (across, up, view): (usize, usize, &str), most: usize) -> Figure {
    let points: Vec<(f64, f64)> =
        path.iter().map(|place| (place.point_mm[across], place.point_mm[up])).collect();
    let labels = ["X [mm]", "Y [mm]", "Z [mm]"];
    let (axes, height, pixel) = equal_scales(&points, labels[across], labels[up]);
    let mut stretches = stretches(path);
    // The worst is first where there is no room for all, and drawn last, on top.
    stretches.sort_by_key(|one| std::cmp::Reverse(one.level));
    let lines: Vec<Vec<&[(f64, f64)]>> =
        stretches.iter().map(|one| vec![&points[one.first..=one.last]]).collect();
    let lines = thinned(&lines, pixel, most);
    let drawn = draw(axes, &Layout { height, ..Layout::default() }, |plot| {
        for (one, lines) in stretches.iter().zip(&lines).rev().filter(|(_, lines)| !lines.is_empty()) {
            let lines: Vec<_> = lines.iter().map(Vec::as_slice).collect();
            let [from, to] = [one.first, one.last].map(|place| number::short(path[place].time_s));
            let tip = format!("{from} to {to} s: up to {} of a limit", number::short(one.largest));
            plot.trails(&format!("trail v{}", one.level), &lines, &tip);
        }
    });
    let side = match view {
        "-xy" => " from above",
        "-xz" => " from the front",
        _ => "",
    };
    let caption = "Each part has the colour of the largest share of a limit that it takes for certain: what the log's resolution may make \
                   is left off. Nothing is drawn where rows are missing.";
    let title = format!("The path{side}, coloured by what it takes of limits");
    drawn.named(&format!("log-path{view}"), &title, caption).with_legend(legend(1.0, "not judged"))
}

/// The path in stretches of one colour, each up to the place behind it if the motion is seen there.
fn stretches(path: &[LogPathPoint]) -> Vec<Stretch> {
    let mut all: Vec<Stretch> = Vec::new();
    for (index, pair) in path.windows(2).enumerate() {
        let [place, next] = pair else { continue };
        if !next.follows {
            continue;
        }
        let level = level(place.share, 1.0);
        match all.last_mut() {
            Some(before) if before.level == level && before.last == index => {
                before.last = index + 1;
                before.largest = before.largest.max(place.share);
            }
            _ => all.push(Stretch { first: index, last: index + 1, level, largest: place.share }),
        }
    }
    all
}
