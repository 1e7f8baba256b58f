//! Host instructions of a step by a given chord, on pieces and by plain Newton iteration: `<group>::<function> <curve>`, to be
//! divided by [`STEPS`](chords::STEPS). A program of its own: within another one the compiler would inline other functions there.

#![allow(missing_docs, reason = "the benchmark macros make public items without documentation")]

#[allow(dead_code, reason = "one of two benches that share it")]
mod chords;
#[allow(dead_code, reason = "one of two benches that share it")]
mod newton;

use std::hint::black_box;

use chords::{Chords, look};
use feedbits_benches::{paper_a, ten_points, thousand_points};
use iai_callgrind as gungraun; // The macros write this name.
use iai_callgrind::{library_benchmark, library_benchmark_group, main};

// Paths are given back, lest their memory is freed while instructions are counted. All fields of a setpoint are asked for.
macro_rules! by_chords {
    ($($plane:ident, $space:ident: $run:expr),+) => {$(
        #[library_benchmark]
        #[bench::a(Chords::of(&paper_a()))]
        #[bench::b(Chords::of(&ten_points()))]
        fn $plane(path: Chords<2>) -> Chords<2> {
            let run: fn(&Chords<2>) -> f64 = $run;
            black_box(run(black_box(&path)));
            path
        }

        #[library_benchmark]
        #[bench::c(Chords::of(&thousand_points()))]
        fn $space(path: Chords<3>) -> Chords<3> {
            let run: fn(&Chords<3>) -> f64 = $run;
            black_box(run(black_box(&path)));
            path
        }
    )+};
}

by_chords!(
    chord_pieces, chord_pieces_in_space: |path| path.on_pieces(look),
    chord_newton, chord_newton_in_space: |path| path.by_newton::<false>(look),
    chord_trend, chord_trend_in_space: |path| path.by_newton::<true>(look)
);

library_benchmark_group!(
    name = steps;
    benchmarks = chord_pieces, chord_pieces_in_space, chord_newton, chord_newton_in_space, chord_trend, chord_trend_in_space
);
main!(library_benchmark_groups = steps);
