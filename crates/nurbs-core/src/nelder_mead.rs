//! The least value of a function of several variables, without derivatives.

use alloc::vec::Vec;

/// Searches where `of` is least, by Nelder and Mead's simplex. The simplex begins at `start`, with an edge of `width`
/// along each variable, and takes `steps` steps of at most N + 2 evaluations each.
///
/// Returns the best place found and the value there, which is never above `of(start)`. One of several minima is found;
/// a value that is not a number counts as infinite.
///
/// # Source
/// Nelder and Mead, "A simplex method for function minimization", The Computer Journal 7, 1965.
pub(crate) fn nelder_mead<const N: usize>(
    start: [f64; N],
    width: f64,
    steps: usize,
    of: impl Fn(&[f64; N]) -> f64,
) -> ([f64; N], f64) {
    let tried = |x: [f64; N]| {
        let value = of(&x);
        (x, if value.is_nan() { f64::INFINITY } else { value })
    };
    let mut simplex = Vec::with_capacity(N + 1);
    simplex.push(tried(start));
    simplex.extend((0..N).map(|along| {
        let mut corner = start;
        corner[along] += width;
        tried(corner)
    }));
    for _ in 0..steps {
        simplex.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (simplex[0], simplex[N]);
        let second_worst = simplex[N - 1].1;
        let centre = mean(&simplex[..N]);
        let beyond = |factor: f64| core::array::from_fn(|d| centre[d] + factor * (centre[d] - worst.0[d]));
        let reflected = tried(beyond(1.0));
        if reflected.1 < best.1 {
            let expanded = tried(beyond(2.0));
            simplex[N] = if expanded.1 < reflected.1 { expanded } else { reflected };
        } else if reflected.1 < second_worst {
            simplex[N] = reflected;
        } else {
            let contracted = tried(beyond(-0.5));
            if contracted.1 < worst.1 {
                simplex[N] = contracted;
                continue;
            }
            for corner in &mut simplex[1..] {
                *corner = tried(core::array::from_fn(|d| f64::midpoint(best.0[d], corner.0[d])));
            }
        }
    }
    simplex.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a }).unwrap_or((start, f64::INFINITY))
}

/// The mean of places.
fn mean<const N: usize>(places: &[([f64; N], f64)]) -> [f64; N] {
    let share = 1.0 / N as f64;
    core::array::from_fn(|d| places.iter().map(|(x, _)| x[d] * share).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_finds_the_minimum_of_rosenbrock_s_valley_and_of_an_edge() {
        let (at, value) =
            nelder_mead([-1.2, 1.0], 0.5, 120, |[x, y]| (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2));
        assert!((at[0] - 1.0).abs() < 1e-4 && (at[1] - 1.0).abs() < 1e-4 && value < 1e-8, "{at:?} {value}");
        let (at, value) = nelder_mead([3.0], 0.1, 60, |[x]| (x - 0.25).abs());
        assert!((at[0] - 0.25).abs() < 1e-6 && value < 1e-6, "{at:?}");
        // What is no number is not taken, and the start stays if nothing is better.
        let (at, _) = nelder_mead([1.0, 1.0], 0.1, 9, |x| if *x == [1.0, 1.0] { 1.0 } else { f64::NAN });
        assert_eq!(at, [1.0, 1.0]);
    }
}
