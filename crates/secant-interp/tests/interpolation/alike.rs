//! Periods of a straight move that are passed at once lead where they lead one by one.

use crate::path_run::{Path, Settings, compiled, interpolator};
use crate::steps::step;
use nurbs_core::{NurbsBuf, PiecesBuf};
use real::Real as _;
use real::{
    Audited, Backend, Extremes, I3F29, I4F28, I4F60, I8F24, I16F48, Overflow, Rounding, RuntimeFixed,
    RuntimeFormat,
};
use secant_interp::{LengthStage, PieceInterpolator, PieceSetpoint};

const FULL_MM: f64 = 0.05;

fn line(points: [[f64; 2]; 2]) -> NurbsBuf<f64, 2> {
    NurbsBuf::try_new_nonrational(1, points.to_vec(), vec![0.0, 0.0, 1.0, 1.0]).unwrap()
}

/// Straight moves and a bend between them.
fn moves() -> Path<2> {
    let [a, b, c, d] = [[0.0, 0.0], [29.0, 13.0], [40.0, 13.5], [40.0, 60.0]];
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let bend = NurbsBuf::try_new_nonrational(3, vec![b, [32.0, 15.0], [40.0, 9.0], c], knots).unwrap();
    Path { curves: vec![line([a, b]), bend, line([c, d])], feed_mm: FULL_MM }
}

/// Feeds that rise and fall between long stretches at constant feed.
fn stages<R: Backend>(full: f64) -> Vec<LengthStage<R>> {
    let feed = |part: f64| R::from_f64(part * full).unwrap();
    let turns =
        [(0.0, 1.0, 20), (1.0, 1.0, 301), (1.0, 0.5, 20), (0.5, 0.5, 200), (0.5, 1.0, 20), (1.0, 1.0, 4000)];
    let of = |(from, to, periods): (f64, f64, u64)| {
        // Stages begin in the middle of periods, as those of a plan do.
        LengthStage::new((periods << 32) + (1 << 30), feed(from), feed(to) - feed(from))
    };
    turns.into_iter().filter_map(of).collect()
}

/// All setpoints of a path, and how many periods were passed at once: none unless `skips`.
fn setpoints<R: Backend>(
    run: &PieceInterpolator<'_, R, 2>,
    skips: bool,
) -> (Vec<Option<PieceSetpoint<R, 2>>>, u64) {
    let (mut state, mut passed, mut found) = (run.start(), 0, Vec::new());
    while !run.is_at_end(&state) {
        let before = state.course();
        let Some(setpoint) = step(run, &mut state) else { break };
        found.push(Some(setpoint));
        if skips {
            let most = run.skip_alike(&mut state, &before, &setpoint, 70);
            assert!(most <= 70);
            found.extend((0..most).map(|_| None));
            passed += most;
        }
    }
    (found, passed)
}

/// Setpoints behind passed periods are those of a run that makes them all, and no number of it is beyond the extremes of the others.
fn lead_where_single_steps_do<R: Backend>(path: &Path<2>, at_least: u64) {
    let table: PiecesBuf<R, 2> = compiled(path, &Settings::default()).unwrap();
    let stages = stages::<R>(path.feed_mm.ldexp(table.as_pieces().chord_exponent));
    let run = interpolator(path, &Settings::default(), &table, &stages);
    let ((all, none), of_all) = Extremes::of(|| setpoints(&run, false));
    let ((some, passed), of_some) = Extremes::of(|| setpoints(&run, true));
    assert_eq!((none, all.len()), (0, some.len()), "{}", R::name());
    assert!(passed >= at_least, "{}: {passed} of {}", R::name(), all.len());
    for (period, (all, some)) in all.iter().zip(&some).enumerate() {
        assert!(some.is_none() || all == some, "{} in period {period}: {all:?} {some:?}", R::name());
    }
    assert_eq!(of_all, of_some, "{}", R::name());
}

#[test]
fn periods_that_are_passed_lead_where_single_steps_do() {
    let path = moves();
    lead_where_single_steps_do::<f64>(&path, 400);
    lead_where_single_steps_do::<f32>(&path, 400);
    lead_where_single_steps_do::<I8F24>(&path, 400);
    lead_where_single_steps_do::<I4F60>(&path, 400);
    // Their σ may go round in a circle of two numbers, the higher one in every fourth period.
    lead_where_single_steps_do::<I4F28>(&path, 0);
    lead_where_single_steps_do::<I3F29>(&path, 0);
    lead_where_single_steps_do::<I16F48>(&path, 0);
    lead_where_single_steps_do::<Audited<f64>>(&path, 400);
    // I8F24, in the type whose audited runs are compiled for other tests too.
    let format = RuntimeFormat::new(32, 24, Rounding::Nearest, Overflow::Wrap).unwrap();
    format.run::<0, _>(|| lead_where_single_steps_do::<Audited<RuntimeFixed<0>>>(&path, 400));
}

#[test]
fn nothing_is_passed_on_a_bend() {
    let bend = Path { curves: vec![moves().curves.remove(1)], feed_mm: FULL_MM };
    let table: PiecesBuf<f64, 2> = compiled(&bend, &Settings::default()).unwrap();
    let stages = stages::<f64>(bend.feed_mm.ldexp(table.as_pieces().chord_exponent));
    assert_eq!(setpoints(&interpolator(&bend, &Settings::default(), &table, &stages), true).1, 0);
}
