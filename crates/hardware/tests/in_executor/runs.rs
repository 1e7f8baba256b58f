//! Every raw word of every setpoint is the kernel's.

use feed_plan::ProfileKind;
use hardware::{CoreFiles, QUEUES};
use stress::RandomPath;

use crate::paths::{corners, lines, paper_a, quintic, ten_points};
use crate::planned_path::{Judged, core_of};

/// The core of a path, after each word of its run was compared.
pub(crate) fn compared<const D: usize>(path: &RandomPath<D>, format: &str) -> CoreFiles {
    let Judged { core, expected } =
        core_of(path, format).unwrap_or_else(|| panic!("{format} holds the path"));
    let core = core.unwrap_or_else(|error| panic!("{format}: {error}"));
    assert_eq!(core.setpoints.len(), expected.len(), "{format}: setpoints");
    for (period, (found, expected)) in core.setpoints.iter().zip(&expected).enumerate() {
        for ((name, bits), word) in core.outputs.iter().zip(found) {
            let of_name = expected.iter().find(|(other, _)| other == name).map(|(_, word)| *word);
            let cut = of_name.map(|word| word & (u64::MAX >> (64 - bits)));
            assert_eq!(Some(*word), cut, "{format}, period {period}: {name}");
        }
    }
    core
}

/// A format of each width. Below 18 bits a factor has two bits before the point.
const WIDTHS: [&str; 17] = [
    "I2F14", "I2F15", "I3F15", "I3F16", "I3F17", "I3F18", "I4F18", "I4F19", "I4F20", "I4F21", "I2F24",
    "I4F23", "I4F24", "I4F25", "I4F26", "I4F27", "I4F28",
];

#[test]
fn the_plane_cubic_runs_as_in_rust_in_every_width() {
    for format in WIDTHS {
        compared(&paper_a(), format);
    }
}

#[test]
fn paper_a_takes_so_many_cycles() {
    let figures = compared(&paper_a(), "I4F28").figures;
    assert!(figures.cycles.0 <= 150.0 && figures.cycles.1 <= 950 && figures.words <= 2400, "{figures:?}");
    let queued = QUEUES.iter().zip(figures.least_periods).find(|(queue, _)| **queue == 4);
    assert!(queued.is_some_and(|(_, cycles)| cycles <= 350), "{figures:?}");
}

#[test]
fn the_rational_cubic_in_space_runs_as_in_rust() {
    compared(&ten_points(), "I4F28");
}

#[test]
fn degree_five_and_half_cosines_run_as_in_rust() {
    compared(&quintic(), "I4F28");
    compared(&RandomPath { profile: ProfileKind::Trigonometric, ..paper_a() }, "I4F28");
}

#[test]
fn sections_and_corners_run_as_in_rust() {
    compared(&lines(), "I4F28");
    compared(&corners(), "I4F28");
}
