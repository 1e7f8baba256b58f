//! A part whose runs take little time.

/// A small part, so that many cells take little time.
pub(crate) const PART: &str = "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [10, 0], [10, 10]]\nweights = [1, 0.8, 1]\n\
                    knots = [0, 0, 0, 1, 1, 1]\n\n[machine]\ninterpolation_period_ms = 2.0\nfeedrate_mm_per_s = 100.0\n\
                    acceleration_mm_per_s2 = 5000.0\njerk_mm_per_s3 = 400000.0\nchord_error_mm = 0.0005\n\
                    fluctuation_limit = 1e-6\nparameter_tolerance = 1e-6\nmax_iterations = 5\n";
