//! A piece before it is rounded: power basis in t, in high precision, with bounds of its polynomials.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::pieces::scales::{Scales, fraction_and_exponent, power_of_two};
use crate::pieces::speed::Speed;
use crate::polynomials::bezier::Bezier;
use crate::polynomials::polynomial::{PARTS, binomial, bound_on_unit_interval, hull, on_part, power_basis};
use crate::vector::{add, over, scaled, sub};
use crate::{Joint, ORIGIN_EXPONENT, Place, tangent_breaks};

/// A piece in high precision: power basis in t, coordinates in mm relative to the piece's first point.
pub(crate) struct LocalPiece<H, const D: usize> {
    pub(crate) place: Place,
    /// The index of the curve that the piece was cut from, and the index of the span, or of the part of a span between
    /// stops.
    pub(crate) part_of_span: (usize, usize),
    /// How often that span or part was halved.
    pub(crate) halvings: i32,
    pub(crate) origin: [i64; D],
    pub(crate) numerator: Vec<[H; D]>,
    pub(crate) weight: Vec<H>,
    /// Least and greatest weight of the Bezier form: W lies between them.
    pub(crate) weight_range: (f64, f64),
    pub(crate) rational: bool,
    pub(crate) speed: Speed,
    pub(crate) extents: Extents,
}

/// How large the numbers of a piece are, in mm and in parts of its weights, whatever the format.
#[derive(Clone, Debug, Default)]
pub(crate) struct Extents {
    /// The largest entry in the synthetic division that shifts N to t, for t in [0, 1], in mm.
    pub(crate) shifted_mm: f64,
    /// The largest coordinate of |N| and of |P|, in mm.
    pub(crate) offset_mm: f64,
    /// The largest entry in the synthetic division that shifts W without its constant, or W itself where that is larger.
    pub(crate) weight: f64,
    /// Bounds of `ω_k / W` for k = 1..=p.
    pub(crate) weights: Vec<f64>,
    /// Bounds of the length of the chord's coefficients `(c_k - P ω_k)/W`, for k = 1..=p, in mm.
    pub(crate) chords_mm: Vec<f64>,
}

impl Extents {
    /// The largest number in coordinate units, in mm.
    pub(crate) fn coordinate_mm(&self) -> f64 {
        self.chords_mm.iter().copied().fold(self.shifted_mm.max(self.offset_mm), f64::max)
    }
}

impl<H: Backend, const D: usize> LocalPiece<H, D> {
    /// Power basis about the first point, with weights about 1. `None` when the origin is out of range.
    pub(crate) fn new(
        bezier: &Bezier<H, D>,
        place: Place,
        part_of_span: (usize, usize),
        halvings: i32,
        speed: Speed,
    ) -> Option<Self> {
        let start = bezier.euclidean(0);
        let mut origin = [0; D];
        for (slot, x) in origin.iter_mut().zip(start) {
            *slot = origin_units(x)?;
        }
        let (first, last) = (bezier.weights[0], bezier.weights[bezier.weights.len() - 1]);
        let unit = (first * last).sqrt();
        let weight: Vec<H> = bezier.weights.iter().map(|w| *w / unit).collect();
        let points: Vec<[H; D]> = bezier.seen_from_start().map(|point| over(&point, unit)).collect();
        let mut numerator = alloc::vec![[H::zero(); D]; points.len()];
        for d in 0..D {
            let column = power_basis(&points.iter().map(|p| p[d]).collect::<Vec<_>>());
            for (row, value) in numerator.iter_mut().zip(column) {
                row[d] = value;
            }
        }
        numerator.remove(0); // the constant term: 0, for `start` was subtracted
        let mut piece = Self {
            place,
            part_of_span,
            halvings,
            origin,
            numerator,
            weight_range: weight
                .iter()
                .map(|w| w.to_f64())
                .fold((f64::MAX, 0.0), |(l, h), w| (l.min(w), h.max(w))),
            weight: power_basis(&weight),
            rational: bezier.rational,
            speed,
            extents: Extents::default(),
        };
        piece.extents = Extents {
            shifted_mm: piece.largest_shifted_mm(),
            offset_mm: piece.offset_bound_mm(),
            weight: piece.largest_weight(),
            weights: piece.weight_bounds(),
            chords_mm: piece.chord_bounds_mm(),
        };
        Some(piece)
    }

    /// Whether speed, weights and coefficients are numbers.
    pub(crate) fn is_finite(&self) -> bool {
        let Speed { least, greatest, begin, end } = self.speed;
        let coefficients = self.numerator.iter().flatten().chain(&self.weight);
        [least, greatest, begin, end].iter().all(|speed| speed.is_finite())
            && coefficients.into_iter().all(|x| x.to_f64().is_finite())
    }

    /// Least and greatest step per chord, in the solver's scale.
    pub(crate) fn step_per_chord(&self, scales: &Scales) -> [f64; 2] {
        self.speed.step_per_chord(scales.chord - scales.step)
    }

    /// |C'| at the end over |C'| at the start of `next`, in the solver's scales, as a fraction in [½, 1) and an
    /// exponent.
    pub(crate) fn joint(&self, scales: &Scales, next: &Self, next_scales: &Scales) -> (f64, i32) {
        let ratio = if self.continues_in(next) {
            // Both pieces are halves of halves of one span, so the ratio of their widths is exactly a power of two.
            power_of_two(next.halvings - self.halvings)
        } else {
            self.speed.end / next.speed.begin
        };
        fraction_and_exponent(ratio * power_of_two(next_scales.step - scales.step))
    }

    /// How the path goes on to `next`.
    pub(crate) fn joint_to(&self, next: &Self) -> Joint {
        if self.continues_in(next) {
            Joint::Continues
        } else if tangent_breaks(&self.direction_at_end(), &next.direction_at_begin()) {
            Joint::Breaks
        } else {
            Joint::Smooth
        }
    }

    /// A vector along C'(0): `N'(0)`, for N begins with 0.
    fn direction_at_begin(&self) -> [H; D] {
        self.numerator.first().copied().unwrap_or([H::zero(); D])
    }

    /// A vector along C'(1): `N'(1) W(1) - N(1) W'(1)`.
    fn direction_at_end(&self) -> [H; D] {
        let whole = |k: usize| H::from_f64(k as f64).unwrap_or_else(H::zero);
        let sum = |terms: &mut dyn Iterator<Item = H>| terms.fold(H::zero(), |sum, term| sum + term);
        let weight = sum(&mut self.weight.iter().copied());
        let weight_rise = sum(&mut (0..).zip(&self.weight).map(|(k, w)| whole(k) * *w));
        let mut value = [H::zero(); D];
        let mut rise = value;
        for (k, n) in (1..).zip(&self.numerator) {
            value = add(&value, n);
            rise = add(&rise, &n.map(|x| whole(k) * x));
        }
        sub(&scaled(&rise, weight), &scaled(&value, weight_rise))
    }

    /// Whether `next` continues the same polynomial.
    pub(crate) fn continues_in(&self, next: &Self) -> bool {
        self.part_of_span == next.part_of_span
    }

    /// Coordinate `d` of N in f64: `n_1..=n_p`, in mm.
    fn column(&self, d: usize) -> Vec<f64> {
        self.numerator.iter().map(|n| n[d].to_f64()).collect()
    }

    /// `w_1..=w_p`.
    fn weight_column(&self) -> Vec<f64> {
        self.weight.iter().skip(1).map(|w| w.to_f64()).collect()
    }

    fn largest_shifted_mm(&self) -> f64 {
        (0..D).map(|d| largest_shifted(&self.column(d))).fold(0.0, f64::max)
    }

    fn largest_weight(&self) -> f64 {
        largest_shifted(&self.weight_column()).max(self.weight_range.1)
    }

    fn weight_bounds(&self) -> Vec<f64> {
        let column = self.weight_column();
        (1..=column.len()).map(|k| self.bound_over_weight(&[derivative(&column, k)], 1)).collect()
    }

    fn offset_bound_mm(&self) -> f64 {
        let with_constant = |d: usize| core::iter::once(0.0).chain(self.column(d)).collect::<Vec<_>>();
        let both =
            |column: Vec<f64>| bound_on_unit_interval(&column).max(self.bound_over_weight(&[column], 1));
        (0..D).map(|d| both(with_constant(d))).fold(0.0, f64::max)
    }

    /// Over the common denominator W², the numerator is the polynomial `c_k W - N ω_k`.
    fn chord_bounds_mm(&self) -> Vec<f64> {
        let weight: Vec<f64> = self.weight.iter().map(|w| w.to_f64()).collect();
        let turns = self.weight_column();
        let numerator = |d: usize, k: usize| {
            let column = self.column(d);
            let c = derivative(&column, k);
            if !self.rational {
                return c;
            }
            let point: Vec<f64> = core::iter::once(0.0).chain(column).collect();
            let mut numerator = product(&c, &weight);
            let drag = product(&point, &derivative(&turns, k));
            numerator.resize(numerator.len().max(drag.len()), 0.0);
            for (n, x) in numerator.iter_mut().zip(drag) {
                *n -= x;
            }
            numerator
        };
        let bound = |k| self.bound_over_weight(&(0..D).map(|d| numerator(d, k)).collect::<Vec<_>>(), 2);
        (1..=self.numerator.len()).map(bound).collect()
    }

    /// The largest length of a vector of polynomials over W^`power`, found part by part. Numerator and weight rise and
    /// fall together; one hull of each over the whole piece would lose that.
    fn bound_over_weight(&self, vector: &[Vec<f64>], power: i32) -> f64 {
        let weight: Vec<f64> = self.weight.iter().map(|w| w.to_f64()).collect();
        let on = |part: u32| {
            let lengths = vector.iter().map(|row| bound_on_unit_interval(&on_part(row, part)));
            let lightest =
                if self.rational { hull(&on_part(&weight, part)).0.max(self.weight_range.0) } else { 1.0 };
            let length = Real::sqrt(lengths.map(|x| x * x).sum::<f64>());
            (0..power).fold(length, |quotient, _| quotient / lightest)
        };
        (0..PARTS).map(on).fold(0.0, f64::max)
    }
}

/// The polynomial `Σ_{j≥k} binomial(j, k) a_j t^{j-k}`, the k-th derivative over k!, of `Σ_{j≥1} a_j t^j`.
fn derivative(column: &[f64], k: usize) -> Vec<f64> {
    (k..=column.len()).map(|j| binomial(j, k) * column[j - 1]).collect()
}

/// The largest value of any entry while `Σ_{j≥1} a_j t^j` is shifted to t in [0, 1]. After m divisions the entry of
/// power k is `Σ_{j≥k} binomial(j - k + m - 1, m - 1) a_j t^{j-k}`.
fn largest_shifted(column: &[f64]) -> f64 {
    let degree = column.len();
    let entry = |k: usize, m: usize| -> f64 {
        let polynomial: Vec<f64> =
            (k..=degree).map(|j| binomial(j - k + m - 1, m - 1) * column[j - 1]).collect();
        bound_on_unit_interval(&polynomial)
    };
    let entries = (1..=degree).flat_map(|k| (1..=k + 1).map(move |m| (k, m)));
    entries.map(|(k, m)| entry(k, m)).fold(0.0, f64::max)
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut result = alloc::vec![0.0; (a.len() + b.len()).saturating_sub(1)];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            result[i + j] += x * y;
        }
    }
    result
}

/// `x · 2³⁹` as an integer, rounded toward 0; `None` beyond ±2²⁴.
fn origin_units<H: Backend>(x: H) -> Option<i64> {
    let range = 1.0_f64.ldexp(63 + ORIGIN_EXPONENT);
    if !(-range < x.to_f64() && x.to_f64() < range) {
        return None;
    }
    // As a fraction of the range, in 64 bits, one of which is the sign.
    let magnitude = (x.abs().to_phase(-(63 + ORIGIN_EXPONENT)) >> 1).cast_signed();
    Some(if x < H::zero() { -magnitude } else { magnitude })
}
