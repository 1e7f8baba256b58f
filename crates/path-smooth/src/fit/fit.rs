//! A part whose runs of straight moves are curves.

use nurbs_core::EndCondition;
use part_program::{Curve, Move, MoveKind, Nurbs, Part, Shape};
use serde::Serialize;

use crate::fit::error::FitError;
use crate::fit::options::FitOptions;
use crate::fit::run::{FittedCurve, Piece, between, fit};
use crate::stretch::{length, rest_before, with_polygons_as_lines};

/// Largest change of direction, in degrees, that a corner may be asked to have.
const MOST_CORNER_DEG: f64 = 90.0;
/// A straight move no longer than this, in mm, ends a run: it has no direction to speak of.
const LEAST_LENGTH_MM: f64 = 1e-9;

/// A part with curves in place of runs of straight moves.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The part. A curve has the line of the first move that it replaces.
    pub path: Part,
    /// What became of the moves.
    pub report: FitReport,
}

/// What became of the straight moves of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FitReport {
    /// The straight moves at feed.
    pub straight_moves: usize,
    /// Those that curves replace.
    pub fitted: usize,
    /// The curves.
    pub curves: usize,
    /// Their control points.
    pub control_points: usize,
    /// Corners between straight moves that stay.
    pub corners: usize,
    /// The most moves from corner to corner, without a rest or a change of feed.
    pub longest_run: usize,
    /// Proven bound of the distance between the curves and the moves that they replace, both ways, in mm.
    pub bound_mm: f64,
}

/// Replaces runs of straight moves at feed by cubic curves within a tolerance.
///
/// A run goes from corner to corner, without a rest of the machine, a word that does not move the tool, or a change of feed:
/// all these stay where they are, and so do arcs, rapid moves, and moves from which no curve keeps within the tolerance. A
/// curve has continuous curvature; it passes the ends of its run and some of the points between, with accumulated chords as
/// knots. Beside an arc, or a straight move that stays, it begins and ends along that, where this keeps within the
/// tolerance.
///
/// Each point of a curve is at most [`FitReport::bound_mm`] from the moves that it replaces, and each point of these from the
/// curve. The bound is proven for the numbers of the curve (see [`nurbs_core::distance_from_segment`]).
///
/// # Errors
/// [`FitError`]; [`FitError::NothingToFit`] if no run becomes a curve.
///
/// # Source
/// Paper D (Liu Ping et al.; see `docs/papers.md`), section 2 with equations (5) and (6): curves through points of a part,
/// knots by chord length. Its curves pass every point, as with [`FitOptions::every_point`].
pub fn fit_curves(part: &Part, options: &FitOptions) -> Result<Fitted, FitError> {
    let &FitOptions { tolerance_mm, corner_deg, .. } = options;
    if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
        return Err(FitError::Tolerance(tolerance_mm));
    }
    if !(corner_deg > 0.0 && corner_deg <= MOST_CORNER_DEG) {
        return Err(FitError::Corner(corner_deg));
    }
    let part = with_polygons_as_lines(part);
    let mut fitted = Fitted {
        path: Part { curves: Vec::new(), moves: Vec::new(), ..part.clone() },
        report: FitReport::default(),
    };
    let mut begin = 0;
    while begin < part.moves.len() {
        let end = end_of_run(&part, begin, options, &mut fitted.report);
        if is_straight_feed(&part, begin) {
            fitted.add_run(&part, begin..end, options)?;
        } else {
            fitted.keep(&part, begin);
        }
        begin = end;
    }
    let report = fitted.report;
    if report.curves == 0 {
        let FitReport { straight_moves, longest_run, .. } = report;
        return Err(FitError::NothingToFit { straight_moves, longest_run, options: *options });
    }
    Ok(fitted)
}

impl Fitted {
    fn keep(&mut self, part: &Part, index: usize) {
        self.path.curves.push(part.curves[index].clone());
        self.path.moves.push(part.moves[index]);
    }

    fn add_run(
        &mut self,
        part: &Part,
        moves: std::ops::Range<usize>,
        options: &FitOptions,
    ) -> Result<(), FitError> {
        self.report.straight_moves += moves.len();
        self.report.longest_run = self.report.longest_run.max(moves.len());
        let first = part.curves[moves.start].control_points_mm()[0];
        let ends = part.curves[moves.clone()].iter().map(|curve| curve.control_points_mm()[1]);
        let points: Vec<[f64; 3]> = std::iter::once(first).chain(ends).collect();
        let conditions = [
            direction_beside(part, moves.start, moves.start.checked_sub(1), options),
            direction_beside(part, moves.end, Some(moves.end), options),
        ];
        let line = part.moves[moves.start].line;
        let pieces = fit(&points, conditions, options).map_err(|error| FitError::Run {
            part: part.name.clone(),
            line,
            error,
        })?;
        for piece in pieces {
            match piece {
                Piece::Straight(at) => self.keep(part, moves.start + at),
                Piece::Curve(curve) => self.add_curve(part, moves.start, &curve),
            }
        }
        Ok(())
    }

    fn add_curve(&mut self, part: &Part, run: usize, fitted: &FittedCurve) {
        let own = run + fitted.moves.start..run + fitted.moves.end;
        let dimension = part.curves[own.clone()].iter().map(|curve| curve.dimension()).max().unwrap_or(3);
        let exact_stop = part.moves[own.end - 1].exact_stop;
        self.path.curves.push(Nurbs::of(&fitted.curve, dimension).into());
        self.path.moves.push(Move { shape: Shape::Nurbs, exact_stop, ..part.moves[own.start] });
        let report = &mut self.report;
        report.curves += 1;
        report.fitted += own.len();
        report.control_points += fitted.curve.control_points().len();
        report.bound_mm = report.bound_mm.max(fitted.bound_mm);
    }
}

/// The end of the run that begins with a move: the next move that does not belong to it. Counts the corner that ends it.
fn end_of_run(part: &Part, begin: usize, options: &FitOptions, report: &mut FitReport) -> usize {
    if !is_straight_feed(part, begin) {
        return begin + 1;
    }
    let mut next = begin + 1;
    while next < part.moves.len() && is_straight_feed(part, next) && !is_divided(part, next) {
        let [before, after] = [next - 1, next].map(|index| part.curves[index].control_points_mm());
        if turn_deg(&between(&before[0], &before[1]), &between(&after[0], &after[1])) > options.corner_deg {
            report.corners += 1;
            break;
        }
        next += 1;
    }
    next
}

/// Whether this is a straight move at feed that has a length.
fn is_straight_feed(part: &Part, index: usize) -> bool {
    let points = part.curves[index].control_points_mm();
    part.moves[index].kind == MoveKind::Feed
        && matches!((points, part.curves[index].degree()), ([a, b], 1) if length(&between(a, b)) > LEAST_LENGTH_MM)
}

/// Whether a move does not continue the one before it as a curve would: at a rest, at another feed, at a word, or at other
/// coordinates.
fn is_divided(part: &Part, next: usize) -> bool {
    let [before, after] = [next - 1, next].map(|index| part.moves[index].block);
    let first = part.auxiliary.partition_point(|word| word.block < before);
    let has_word = part.auxiliary.get(first).is_some_and(|word| word.block <= after);
    let ends = [&part.curves[next - 1], &part.curves[next]];
    let meet = ends[0].control_points_mm().last() == ends[1].control_points_mm().first();
    rest_before(part, next).is_some() || has_word || !meet
}

/// How a run begins or ends beside move `beside`: along an arc or a curve, if it goes on without a rest and without a corner.
fn direction_beside(
    part: &Part,
    joint: usize,
    beside: Option<usize>,
    options: &FitOptions,
) -> EndCondition<3> {
    let free = EndCondition::Parabola;
    let Some(beside) = beside.filter(|beside| *beside < part.moves.len()) else { return free };
    if part.rest_before(joint).is_some() || is_straight_feed(part, beside) {
        return free;
    }
    let is_before = beside < joint;
    let own = if is_before { joint } else { joint - 1 };
    let chord = part.curves[own].control_points_mm();
    let along = end_direction(&part.curves[beside], is_before);
    match along {
        Some(along) if turn_deg(&along, &between(&chord[0], &chord[1])) <= options.corner_deg => {
            EndCondition::Along(along)
        }
        _ => free,
    }
}

/// The direction in which a curve ends or begins.
fn end_direction(curve: &Curve, is_end: bool) -> Option<[f64; 3]> {
    let points = curve.control_points_mm();
    let apart = |pair: &[[f64; 3]]| pair[0] != pair[1];
    let mut pairs = points.windows(2).filter(|pair| apart(pair));
    let pair = if is_end { pairs.next_back() } else { pairs.next() }?;
    Some(between(&pair[0], &pair[1]))
}

/// The angle between two directions, in degrees.
fn turn_deg(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot: f64 = a.iter().zip(b).map(|(x, y)| x * y).sum();
    length(&cross).atan2(dot).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half circle of chords from (5, y) to (-5, y).
    fn half_circle(feed: &str) -> String {
        let mut text = String::new();
        for k in 1..=60 {
            let angle = std::f64::consts::PI * f64::from(k) / 60.0;
            text += &format!(
                "G1 X{:.4} Y{:.4}{}\n",
                5.0 * angle.cos(),
                5.0 * angle.sin(),
                if k == 1 { feed } else { "" }
            );
        }
        text
    }

    fn fitted(text: &str) -> Result<Fitted, FitError> {
        let part = part_program::read_part("p.nc", text).unwrap();
        fit_curves(&part, &FitOptions::within(0.005))
    }

    fn shapes(fitted: &Fitted) -> Vec<(Shape, Option<f64>)> {
        fitted.path.moves.iter().map(|one| (one.shape, one.feedrate_mm_per_s)).collect()
    }

    #[test]
    fn curves_are_made_between_corners_and_keep_the_feed() {
        let text = format!("G0 X5 Y-20\nG1 Y0 F600\n{}G1 Y-20\nG1 X5\nM30\n", half_circle(" F1200"));
        let fitted = fitted(&text).unwrap();
        use Shape::{Line, Nurbs};
        let (slow, fast) = (Some(10.0), Some(20.0));
        assert_eq!(shapes(&fitted)[1..], [(Nurbs, fast), (Line, fast), (Line, fast)]);
        assert_eq!(shapes(&fitted)[0], (Line, slow));
        let report = fitted.report;
        assert_eq!((report.straight_moves, report.fitted, report.curves, report.corners), (63, 60, 1, 1));
        assert!(report.bound_mm <= 0.005 && report.control_points < 40, "{report:?}");
    }

    /// A word, an exact stop, a gap and a rapid move end a run as a corner does; what remains is short of a curve or one.
    #[test]
    fn a_rest_ends_a_run() {
        let whole = fitted(&format!("G0 X5 Y0\n{}", half_circle(" F600"))).unwrap().report;
        assert_eq!((whole.curves, whole.fitted), (1, 60));
        let lines: Vec<String> = half_circle(" F600").lines().map(str::to_owned).collect();
        for between in ["M8", "S900", "G4 P1", "G0 Z1\nG0 Z0"] {
            let text =
                ["G0 X5 Y0 Z0".to_owned(), lines[..30].join("\n"), between.into(), lines[30..].join("\n")];
            let parts = fitted(&(text.join("\n") + "\n")).unwrap();
            assert_eq!((parts.report.curves, parts.report.fitted), (2, 60), "{between}: {:?}", parts.report);
        }
        let mut stop = lines.clone();
        stop[29] = format!("G9 {}", stop[29]);
        let parts = fitted(&format!("G0 X5 Y0\n{}\n", stop.join("\n"))).unwrap();
        assert_eq!(parts.report.curves, 2);
        assert!(parts.path.moves.iter().find(|one| one.shape == Shape::Nurbs).unwrap().exact_stop);
    }

    /// A laser passes S words without a rest, and each of them belongs to its move.
    #[test]
    fn a_word_that_is_passed_ends_a_run_too() {
        let text = format!("G0 X5 Y0\n{}", half_circle(" F600").replacen("Y4.0451", "Y4.0451 S500", 1));
        let mut part = part_program::read_part("p.nc", &text).unwrap();
        part.pass_spindle_words();
        assert!(part.auxiliary.iter().all(|word| word.is_passed) && !part.auxiliary.is_empty());
        let fitted = fit_curves(&part, &FitOptions::within(0.005)).unwrap();
        assert_eq!(fitted.report.curves, 2, "{:?}", fitted.report);
    }

    /// After an arc the curve goes on in the arc's direction.
    #[test]
    fn a_curve_goes_on_along_an_arc() {
        let text = format!("G0 X5 Y-10\nG3 X5 Y0 I-50 J5 F600\n{}", half_circle(""));
        let part = part_program::read_part("p.nc", &text).unwrap();
        let fitted = fit_curves(&part, &FitOptions::within(0.05)).unwrap();
        let [arc, curve] = [0, 1].map(|index| &fitted.path.curves[index]);
        let [a, b] = [end_direction(arc, true).unwrap(), end_direction(curve, false).unwrap()];
        assert!(turn_deg(&a, &b) < 1e-6 && curve.degree() == 3, "{a:?} {b:?}");
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let square = "G0 X0 Y0\nG1 X9 F600\nG1 Y9\nG1 X0\nG1 Y0\n";
        let none = fitted(square).unwrap_err();
        assert_eq!(
            none.to_string(),
            "no curve is made of 4 straight moves: from one corner, rest or change of feed to the next there are 1 at most, \
             and a curve takes 3"
        );
        let part = part_program::read_part("p.nc", square).unwrap();
        for tolerance_mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                fit_curves(&part, &FitOptions::within(tolerance_mm)),
                Err(FitError::Tolerance(_))
            ));
        }
        let wide = FitOptions { corner_deg: 91.0, ..FitOptions::within(1.0) };
        assert!(matches!(fit_curves(&part, &wide), Err(FitError::Corner(_))));
        let long = "G0 X0 Y0\nG1 X9 F600\nG1 X18 Y1\nG1 X27 Y3\nG1 X36 Y6\n";
        assert!(fitted(long).unwrap_err().to_string().contains("0.005 mm"), "{}", fitted(long).unwrap_err());
    }
}
