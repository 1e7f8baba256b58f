//! Largest magnitude and root mean square of an error.

use serde::Serialize;

/// How large an error is over a path, in mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ErrorSize {
    /// Largest magnitude.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
}

impl ErrorSize {
    /// The size of these values; 0 for none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let (mut max, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
        for value in values {
            max = max.max(value.abs());
            sum += value * value;
            count += 1.0;
        }
        Self { max, rms: if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn max_and_root_mean_square() {
        let size = ErrorSize::of([1.0, -7.0]);
        assert_eq!(size, ErrorSize { max: 7.0, rms: 5.0 });
        assert_eq!(ErrorSize::of([]), ErrorSize::default());
    }
}
