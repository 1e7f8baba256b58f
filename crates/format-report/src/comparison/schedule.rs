//! The data-flow graph of a period on a target: when each operation runs, and on which unit.

use std::collections::BTreeMap;

use target_cost::{Kind, Measure, Placed, Target};

use crate::chart::{Axis, Layout, draw};
use crate::comparison::material::{Material, Schedule};
use crate::figure::{Entry, Figure};
use crate::number;
use crate::palette::HUE_COUNT;

/// A picture for each schedule.
pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    material.schedules.iter().filter(|schedule| !schedule.cost.placed.is_empty()).map(figure).collect()
}

fn figure(schedule: &Schedule<'_>) -> Figure {
    let (target, cost) = (schedule.target, &schedule.cost);
    let lanes = lanes(&cost.placed, target);
    let names: Vec<String> = lanes.iter().map(|(name, _)| name.clone()).collect();
    let hues = hues(&cost.placed);
    let what = match target.measure {
        Measure::Cycles => "cycles",
        Measure::Instructions => "instructions",
    };
    let height = 74 + 26 * u32::try_from(names.len()).unwrap_or(1);
    let end = cost.placed.iter().map(|placed| placed.end).fold(1.0, f64::max);
    let layout = Layout { height, left: 130, from_top: true };
    let axes = (
        Axis::linear(&format!("{what} from the period's start [count]"), 0.0..end),
        Axis::of_names("", names),
    );
    let drawn = draw(axes, &layout, |plot| {
        for (row, (_, operations)) in lanes.iter().enumerate() {
            for placed in operations {
                let name = placed.operation.name();
                let hue = hues.get(name).copied().unwrap_or(0);
                let tip = format!("{name}: {} to {}", number::short(placed.start), number::short(placed.end));
                let (top, bottom) = (row as f64 - 0.38, row as f64 + 0.38);
                plot.boxes(&format!("operation k{hue}"), &[[placed.start, placed.end, top, bottom]], &tip);
            }
        }
    });
    let order = match target.kind {
        Kind::Processor => "In program order, as the processor issues it, a row a kind of operation.",
        Kind::Vliw | Kind::Fpga => {
            "List schedule: whatever is ready begins, the longest way to the end first; a row a unit."
        }
    };
    let caption = format!(
        "The most common period of {} on {}: {} {what} long, its longest chain of operations that need each other {}. \
         {order} A box reaches until its result is there, so boxes of one pipelined unit overlap.",
        schedule.run,
        target.title,
        number::short(cost.length.typical),
        number::short(cost.critical_path.typical)
    );
    let title = format!("One period of {} on {}", schedule.run, target.title);
    let legend =
        hues.iter().map(|(name, hue)| Entry::area(&format!("k{hue}"), &name.replace('_', " "))).collect();
    drawn.named(&format!("schedule-{}", target.name), &title, &caption).with_legend(legend)
}

type Lane = (String, Vec<Placed>);

/// Operations by unit, a row for each copy of a unit; by kind if there is a single unit for all.
fn lanes(placed: &[Placed], target: &Target) -> Vec<Lane> {
    let mut lanes: BTreeMap<(usize, usize), Lane> = BTreeMap::new();
    for operation in placed {
        let (unit, name, copies) = match operation.unit.and_then(|unit| Some((unit, target.unit.get(unit)?)))
        {
            Some((place, unit)) => (place, unit.name.clone(), unit.count.max(1) as usize),
            None => {
                (target.unit.len() + operation.operation as usize, operation.operation.name().to_string(), 1)
            }
        };
        // The copy that has been idle longest takes the next operation.
        let last = |copy: usize| {
            lanes.get(&(unit, copy)).and_then(|lane| lane.1.last()).map_or(-1.0, |last| last.start)
        };
        let copy = (0..copies).min_by(|a, b| last(*a).total_cmp(&last(*b))).unwrap_or(0);
        let label = if copies > 1 { format!("{name} {}", copy + 1) } else { name };
        lanes.entry((unit, copy)).or_insert((label.replace('_', " "), Vec::new())).1.push(*operation);
    }
    lanes.into_values().collect()
}

/// A colour for each kind of operation.
fn hues(placed: &[Placed]) -> BTreeMap<&'static str, usize> {
    let mut hues = BTreeMap::new();
    for operation in placed {
        let next = hues.len() % HUE_COUNT;
        hues.entry(operation.operation.name()).or_insert(next);
    }
    hues
}
