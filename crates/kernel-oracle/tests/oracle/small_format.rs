//! A format of eight bits, I2F6, on every input that it has: stage shapes, and chords from every place of a piece
//! without a history.

use feed_plan::StageShape;
use nurbs_core::{NurbsBuf, PieceLimits, Pieces, compile};
use real::{Backend, DoubleDouble, Overflow, Real, Rounding, RuntimeFixed, RuntimeFormat};
use secant_interp::{Chord, ChordTolerance};

type Small = RuntimeFixed<0>;

/// The resolution.
const UNIT: f64 = 1.0 / 64.0;

fn in_small<T>(work: impl FnOnce() -> T) -> T {
    RuntimeFormat::new(8, 6, Rounding::Nearest, Overflow::Wrap).unwrap().run::<0, _>(work)
}

/// The mean of a shape over an interval, `(G(b) - G(a))/(b - a)`, and its value where that has no length; exact to 1e-12.
fn exact_mean(shape: StageShape<f64>, middle: f64, width: f64) -> f64 {
    if width == 0.0 {
        return shape.reached(middle);
    }
    let integral = |x: f64| match shape {
        StageShape::Cubic => x.powi(3) - x.powi(4) / 2.0,
        StageShape::Onset => x.powi(3) / 3.0,
        StageShape::Steady => x * x / 2.0,
        StageShape::Easing => x * x - x.powi(3) / 3.0,
        StageShape::Bent(by) => x * x / 2.0 + by * (x * x / 2.0 - x.powi(3) / 3.0),
        StageShape::Cosine => x / 2.0 - (std::f64::consts::PI * x).sin() / (2.0 * std::f64::consts::PI),
    };
    (integral(middle + width / 2.0) - integral(middle - width / 2.0)) / width
}

/// The worst error of a shape over every interval in [0, 1], in units; and the number of intervals.
fn worst_of(shape: StageShape<Small>) -> (f64, u32) {
    let exact = shape.map(Small::to_f64);
    let (mut worst, mut intervals) = (0.0_f64, 0);
    for width in 0..=64_i64 {
        for middle in 0..=64_i64 {
            let ends = [2 * middle - width, 2 * middle + width];
            if ends[0] < 0 || ends[1] > 128 {
                continue;
            }
            let found = shape.mean(Small::from_bits(middle), Small::from_bits(width)).to_f64();
            let expected = exact_mean(exact, middle as f64 * UNIT, width as f64 * UNIT);
            worst = worst.max((found - expected).abs() / UNIT);
            intervals += 1;
        }
    }
    (worst, intervals)
}

#[test]
fn every_interval_of_every_stage_shape() {
    in_small(|| {
        // Half a unit for each product that is rounded, times what it is multiplied by: most for the cubic, whose square counts
        // three times, and for the cosine, whose sine is a series.
        let plain = [
            (StageShape::Cubic, 2.2),
            (StageShape::Onset, 1.1),
            (StageShape::Steady, 0.0),
            (StageShape::Easing, 1.1),
            (StageShape::Cosine, 2.8),
        ];
        let mut shapes = 0;
        let bent = (-64..=64).map(|by| (StageShape::Bent(Small::from_bits(by)), 1.5));
        for (shape, most) in plain.into_iter().chain(bent) {
            let (worst, intervals) = worst_of(shape);
            assert!(worst <= most, "{shape:?}: {worst} units");
            assert_eq!(intervals, 2_113);
            shapes += 1;
        }
        assert_eq!(shapes, 134);
    });
}

/// The chord over a step from t, in units of chords, exactly as the rounded piece has it.
fn chord(pieces: &Pieces<'_, DoubleDouble, 2>, t: f64, part: f64) -> f64 {
    let [from, to] = [t, t + part].map(|t| pieces.offset(0, DoubleDouble::from(t)));
    let way = core::array::from_fn::<_, 2, _>(|d| to[d] - from[d]);
    DoubleDouble::norm(&way).value().ldexp(pieces.coordinate_exponent + pieces.chord_exponent)
}

#[test]
fn every_chord_from_every_place_of_a_piece() {
    let points = vec![[0.0, 0.0], [0.6, 0.0], [1.1, 0.25]];
    let curve = NurbsBuf::try_new_nonrational(2, points, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
    let limits = PieceLimits { length_mm: 4.0, step_mm: 0.5 };
    in_small(|| {
        let table = compile::<DoubleDouble, Small, 2>(&[curve.as_curve()], &limits).unwrap();
        let pieces = table.as_pieces();
        assert_eq!(pieces.pieces.len(), 1);
        let row = pieces.pieces[0];
        // The rounded piece itself is what a step has to follow.
        let exact = |rows: &[[Small; 2]]| {
            rows.iter().map(|row| row.map(|x| DoubleDouble::from(x.to_f64()))).collect::<Vec<_>>()
        };
        let numerators = exact(pieces.numerators);
        let exact_row = compile::<DoubleDouble, DoubleDouble, 2>(&[curve.as_curve()], &limits).unwrap();
        let judge = Pieces {
            pieces: exact_row.as_pieces().pieces,
            numerators: &numerators,
            weights: &[],
            degree: pieces.degree,
            coordinate_exponent: pieces.coordinate_exponent,
            chord_exponent: pieces.chord_exponent,
        };
        let tolerance = ChordTolerance::for_fluctuation(None, 16);
        let [low, high] = row.step_per_chord.map(Small::to_bits);
        let longest = Small::from_f64(limits.step_mm.ldexp(pieces.chord_exponent)).unwrap().to_bits();
        let (mut worst, mut cases) = (0.0_f64, 0);
        for place in 0..64_i64 {
            let t = Small::from_bits(place);
            let at = pieces.shifted(0, t);
            for length in 1..=longest {
                let length = Small::from_bits(length);
                let travelled = |sigma: Small| (sigma * length).to_f64().ldexp(-i32::from(row.step_exponent));
                let off = |sigma: Small| {
                    (chord(&judge, t.to_f64(), travelled(sigma)) - length.to_f64()).abs() / UNIT
                };
                // A step that leads past the piece is no matter of this chord.
                let start = Small::from_bits(i64::midpoint(low, high));
                let ask = Chord::<_, 2> {
                    at: &at,
                    degree: pieces.degree,
                    rational: false,
                    range_exponent: row.range_exponent.into(),
                    whole: row.whole(),
                    length,
                    before: None,
                    range: row.step_per_chord,
                };
                let (sigma, evaluations) = ask.solve(start, &tolerance);
                assert!(evaluations <= 16 && (low..=high).contains(&sigma.to_bits()));
                if t.to_f64() + travelled(sigma) > 1.0 {
                    continue;
                }
                let best = (low..=high).map(|bits| off(Small::from_bits(bits))).fold(f64::MAX, f64::min);
                worst = worst.max(off(sigma) - best);
                cases += 1;
            }
        }
        // The solver stops where its residual is a few units; its chord is then a unit longer or shorter than the best.
        assert!(worst <= 1.1, "{worst} units more than the best step");
        assert!(cases > 1_500, "{cases}");
    });
}
