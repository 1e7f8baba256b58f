//! The setpoints of a stream are those of the whole path.

use real::{FromWord, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32};
use secant_interp::PieceInterpolator;

use super::streamed::{compiled, file_of, read};
use crate::steps::step;

/// The bits of each setpoint of a run.
fn bits<R: FromWord, const D: usize>(run: &PieceInterpolator<'_, R, D>) -> Vec<Vec<u64>> {
    let mut state = run.start();
    let setpoints = std::iter::from_fn(|| step(run, &mut state));
    let of = |at: secant_interp::PieceSetpoint<R, D>| {
        let numbers = at.offset.into_iter().chain([at.length]).map(real::word_of);
        let position = run.pieces.position(at.piece, &at.offset).map(i64::cast_unsigned);
        let counts = [at.piece as u64, at.phase, u64::from(at.evaluations)];
        numbers.chain(position).chain(counts).collect()
    };
    setpoints.map(of).collect()
}

fn are_the_same<R: FromWord, const D: usize>() {
    for rational in [false, true] {
        let (path, _) = compiled::<R, D>(rational);
        let expected: Vec<_> = path.runs().map(|run| bits(&run)).collect();
        let (file, mut found) = (file_of(&path, 0), Vec::new());
        let (_, end) = read::<R, D>(&file, |run| found.push(bits(run)));
        assert_eq!(end, Ok(()), "{}", R::name());
        assert!(expected == found && expected.iter().all(|run| !run.is_empty()), "{} in {D}", R::name());
    }
}

/// A format is a width of words and a place of the point; the number of coordinates is the rows' business in any of them. So space is
/// asked of one format of each kind of word.
#[test]
fn every_format_makes_the_same_setpoints_in_the_plane_and_in_space() {
    are_the_same::<I16F16, 2>();
    are_the_same::<I8F24, 2>();
    are_the_same::<I4F28, 2>();
    are_the_same::<I3F29, 2>();
    are_the_same::<I2F30, 2>();
    are_the_same::<f32, 2>();
    are_the_same::<I32F32, 2>();
    are_the_same::<I16F48, 2>();
    are_the_same::<I4F60, 2>();
    are_the_same::<f64, 2>();
    are_the_same::<I4F28, 3>();
    are_the_same::<f32, 3>();
    are_the_same::<I4F60, 3>();
    are_the_same::<f64, 3>();
}
