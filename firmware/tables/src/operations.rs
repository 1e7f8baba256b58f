//! How many operations a step makes: counted on the host, and the same on every target.

use nurbs_core::CompileError;
use real::{Backend, Counted, I3F29, I4F28, I4F60, OperationCounts};

use crate::{Path, paths, with_run};

/// The operations of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Operations {
    /// The number format.
    pub format: String,
    /// The path's name.
    pub path: &'static str,
    /// Mean per step, by the names of the operations.
    pub per_step: Vec<(&'static str, f64)>,
}

/// Of every path in every format that the firmware runs.
///
/// # Errors
/// [`CompileError`] of the first path that does not fit a format.
pub fn operations() -> Result<Vec<Operations>, CompileError> {
    let mut all = Vec::new();
    for path in paths() {
        all.push(counted::<f64>(&path)?);
        all.push(counted::<f32>(&path)?);
        all.push(counted::<I3F29>(&path)?);
        all.push(counted::<I4F28>(&path)?);
        all.push(counted::<I4F60>(&path)?);
    }
    Ok(all)
}

fn counted<R: Backend>(path: &Path) -> Result<Operations, CompileError> {
    let (steps, counts) = with_run::<Counted<R>, _>(path, |interpolator| {
        let mut state = interpolator.start();
        OperationCounts::of(|| {
            let mut steps = 0;
            while !interpolator.is_at_end(&state) && interpolator.step(&mut state).is_some() {
                steps += 1;
            }
            steps
        })
    })?;
    let mean = |count: u64| (count as f64 / steps as f64 * 1000.0).round() / 1000.0;
    let per_step = [
        ("add", counts.add + counts.sub + counts.neg),
        ("compare", counts.compare),
        ("mul", counts.mul),
        ("mul_add", counts.mul_add),
        ("sum_of_products", counts.sum_of_products),
        ("sum_of_products_terms", counts.sum_of_products_terms),
        ("scale", counts.scale),
        ("div", counts.div),
        ("sqrt", counts.sqrt),
        ("norm", counts.norm),
        ("norm_terms", counts.norm_terms),
        ("convert", counts.convert),
    ];
    Ok(Operations {
        format: R::name().to_string(),
        path: path.name,
        per_step: per_step.map(|(name, count)| (name, mean(count))).to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_makes_operations() {
        let all = operations().unwrap();
        assert_eq!(all.len(), 10);
        for run in all {
            let of = |name| run.per_step.iter().find(|(n, _)| *n == name).map_or(0.0, |(_, mean)| *mean);
            // Cubic, so three products a coordinate and evaluation. Divisions are for rational points and for joints.
            assert!(of("mul_add") >= 6.0, "{run:?}");
            assert_eq!(of("div") >= 1.0, run.path == "ten_points", "{run:?}");
        }
    }
}
