//! Problems and their runs.

use format_compare::{Dimension, Engine, JudgedRun, Options, Problem, Space, compare, select};
use part_program::{Machine, read_machine, read_part};

/// The built-in example.
pub(crate) const EXAMPLE: &str = include_str!("../../../../data/seed-000.toml");

const MILL: &str = "[machine]\ninterpolation_period_ms = 1.0\nfeedrate_mm_per_s = 50.0\n\
                    acceleration_mm_per_s2 = 1000.0\njerk_mm_per_s3 = 40000.0\nchord_error_mm = 0.001\n\
                    fluctuation_limit = 1e-4\nparameter_tolerance = 1e-10\nmax_iterations = 8\n";

/// A part program or curve file on a milling machine. `more` is appended to the machine file.
pub(crate) fn mill<const D: usize>(part: &str, more: &str) -> Problem<D> {
    Problem::new(&read_part("p.nc", part).unwrap(), &read_machine("m", &(MILL.to_string() + more)).unwrap())
        .unwrap()
}

/// The machine of the built-in example. `more` is appended to its file.
pub(crate) fn example_machine(more: &str) -> Machine {
    let own = EXAMPLE[EXAMPLE.find("[machine]").unwrap()..].split("[[").next().unwrap();
    read_machine("m", &format!("{own}\n{more}")).unwrap()
}

/// A part program or curve file on the machine of the built-in example. `more` is appended to the machine file.
pub(crate) fn on_example_machine<const D: usize>(part: &str, more: &str) -> Problem<D> {
    Problem::new(&read_part("p.nc", part).unwrap(), &example_machine(more)).unwrap()
}

/// The runs of a problem on pieces in these formats, judged.
pub(crate) fn judged<const D: usize>(problem: &Problem<D>, formats: &[&str]) -> Vec<JudgedRun>
where
    Space: Dimension<D>,
{
    compare(problem, &select(formats).unwrap(), &[Engine::Pieces], &Options::default()).unwrap().formats
}
