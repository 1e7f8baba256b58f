//! The limits that machine and part set to a plan.

use real::Real;

use crate::{PlanError, chord_error};

/// The limits of a plan.
///
/// Lengths are in mm. The caller chooses the unit of time and uses it for all limits. With the interpolation period as
/// the unit (`interpolation_period` = 1, feeds in mm/period, accelerations in mm/period², jerks in mm/period³) all
/// values of a usual machine lie between 10⁻⁴ and 10, which a fixed-point format needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KinematicLimits<R> {
    /// Interpolation period T: the time from one setpoint to the next.
    pub interpolation_period: R,
    /// Command feedrate F, mm per unit of time.
    pub feedrate: R,
    /// Largest acceleration A along the path.
    pub acceleration: R,
    /// Largest jerk J along the path.
    pub jerk: R,
    /// Largest distance E, mm, between the curve and the chord of one period.
    pub chord_error: R,
    /// Largest acceleration across the path, if it is limited in addition to the chord error.
    pub centripetal_acceleration: Option<R>,
    /// Limits of single axes, x first; a curve in the plane uses the first two.
    pub axes: [AxisLimits<R>; 3],
    /// How the plan passes a break of the tangent.
    pub junction: Junction<R>,
}

/// The number of axes that can have limits of their own. (Public types say 3: with the constant there, rustc 1.95 stops
/// compiling a closure that captures one of their fields.)
pub(crate) const AXES: usize = 3;

/// The limits of one axis; `None` is no limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisLimits<R> {
    /// Largest velocity.
    pub velocity: Option<R>,
    /// Largest acceleration.
    pub acceleration: Option<R>,
    /// Largest jerk.
    pub jerk: Option<R>,
}

impl<R> AxisLimits<R> {
    pub(crate) fn limits_acceleration(&self) -> bool {
        self.acceleration.is_some() || self.jerk.is_some()
    }
}

/// How the plan passes a break of the tangent, between two curves or inside one.
///
/// With [`Stop`](Self::Stop), a turn by θ is a stop where θ is above `min(4E/(F T), A T/F)`. At full feed a smaller
/// turn cuts the corner by no more than the chord error E and changes the velocity by no more than A T. The other
/// junctions limit the feed at every break where full feed F would be more than they allow, unless the break may come
/// from rounding of the tangents.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Junction<R> {
    /// The plan comes to rest at a corner.
    #[default]
    Stop,
    /// The plan passes the break as if it were rounded within this distance δ, mm, at the acceleration A or the
    /// centripetal one, whichever is less: `V² = A δ cos(φ/2) / (1 - cos(φ/2))` for a turn by φ. Over a whole step V T
    /// before and behind the break the feed is no more than `2δ/(T tan(φ/2))`, or δ/T if that is more. So the chord of
    /// a period over a single corner leaves the corner by no more than δ, wherever the period begins.
    Deviation(R),
    /// The velocity of each axis jumps by at most this: `V |e₂ - e₁|ᵢ ≤ Δvᵢ`, e the unit tangents.
    VelocityJump([R; 3]),
}

/// The share of a full step, as a power of two, by which a setpoint may be off.
const HIDDEN: i32 = -15;

impl<R: Real> KinematicLimits<R> {
    /// Whether the acceleration or the jerk of a single axis is limited, of the first axes, as many as the path has dimensions.
    #[must_use]
    pub fn limit_accelerations_of_axes(&self, dimensions: usize) -> bool {
        self.axes.iter().take(dimensions).any(AxisLimits::limits_acceleration)
    }

    /// By how much a setpoint may be off: less than half of a fluctuation of 10⁻⁴ of a full step.
    pub(crate) fn resolution(&self) -> R {
        (self.feedrate * self.interpolation_period).ldexp(HIDDEN)
    }

    /// Checks that each limit is a positive number.
    ///
    /// # Errors
    /// [`PlanError::NotPositive`] names the first limit that is zero, negative, infinite or not a number; in
    /// a coarse format a small limit may have been rounded to zero.
    pub fn validate(&self) -> Result<(), PlanError> {
        let positive = |what, value: R| {
            let is_positive = value > R::zero() && value.is_finite();
            if is_positive { Ok(value) } else { Err(PlanError::NotPositive { what }) }
        };
        self.try_map(positive).map(|_| ())
    }

    /// Converts each number of the limits; `convert` is also given the number's name in words.
    ///
    /// # Errors
    /// The first error of `convert`.
    pub fn try_map<Q, E>(
        &self,
        mut convert: impl FnMut(&'static str, R) -> Result<Q, E>,
    ) -> Result<KinematicLimits<Q>, E> {
        let interpolation_period = convert("interpolation period", self.interpolation_period)?;
        let feedrate = convert("feedrate", self.feedrate)?;
        let acceleration = convert("acceleration", self.acceleration)?;
        let jerk = convert("jerk", self.jerk)?;
        let chord_error = convert("chord error", self.chord_error)?;
        let mut optional = |what, limit: Option<R>| limit.map(|limit| convert(what, limit)).transpose();
        let centripetal_acceleration = optional("centripetal acceleration", self.centripetal_acceleration)?;
        let mut axis = |axis: AxisLimits<R>| {
            let velocity = optional("axis velocity", axis.velocity)?;
            let acceleration = optional("axis acceleration", axis.acceleration)?;
            Ok(AxisLimits { velocity, acceleration, jerk: optional("axis jerk", axis.jerk)? })
        };
        let [x, y, z] = self.axes;
        let axes = [axis(x)?, axis(y)?, axis(z)?];
        let junction = match self.junction {
            Junction::Stop => Junction::Stop,
            Junction::Deviation(most) => Junction::Deviation(convert("junction deviation", most)?),
            Junction::VelocityJump([x, y, z]) => {
                let mut jump = |jump| convert("velocity jump", jump);
                Junction::VelocityJump([jump(x)?, jump(y)?, jump(z)?])
            }
        };
        Ok(KinematicLimits {
            interpolation_period,
            feedrate,
            acceleration,
            jerk,
            chord_error,
            centripetal_acceleration,
            axes,
            junction,
        })
    }

    /// The acceleration with which a corner may be rounded.
    pub(crate) fn acceleration_across(&self) -> R {
        self.centripetal_acceleration.map_or(self.acceleration, |most| most.min(self.acceleration))
    }

    /// The feed up to which setpoints keep the limits of the axes and the centripetal acceleration in whatever
    /// direction the path goes, if it uses at most the share `reach`ᵢ of the direction of axis i. Steps of at most V T
    /// make accelerations of at most 2V/T and jerks of at most 4V/T².
    pub(crate) fn feed_in_any_direction(&self, reach: &[R; AXES]) -> R {
        let period = self.interpolation_period;
        let by_acceleration = |most: R| most.half() * period;
        let of_axis = |(axis, reach): (&AxisLimits<R>, &R)| {
            let by_jerk = axis.jerk.map(|most| most.ldexp(-2) * period * period);
            let reach = *reach;
            [axis.velocity, axis.acceleration.map(by_acceleration), by_jerk]
                .map(|most| most.filter(|_| reach > R::zero()).map(|most| most / reach))
        };
        let of_axes = self.axes.iter().zip(reach).flat_map(of_axis);
        let all = of_axes.chain([self.centripetal_acceleration.map(by_acceleration)]);
        all.flatten().fold(self.feedrate, R::min)
    }

    /// Largest feedrate on a bend of radius `radius` ρ: `min(F, V_e(ρ), √(a_n ρ))`.
    ///
    /// V_e is [`chord_feedrate`](crate::chord_feedrate), a_n the centripetal acceleration. An infinite or saturated
    /// radius is a straight line and gives F; radius 0 gives 0, and so does NaN.
    #[must_use]
    pub fn feedrate_at_radius(&self, radius: R) -> R {
        self.feedrate_by_chord(radius, self.chord_bound_radius()).min(self.feedrate_across(radius))
    }

    /// `min(F, V_e(ρ))`, given the [`chord_bound_radius`](Self::chord_bound_radius).
    pub(crate) fn feedrate_by_chord(&self, radius: R, chord_bound_radius: R) -> R {
        if !(radius > R::zero()) {
            return R::zero();
        }
        if radius < chord_bound_radius {
            let chord = chord_error::chord_feedrate(radius, self.chord_error, self.interpolation_period);
            chord.min(self.feedrate)
        } else {
            self.feedrate
        }
    }

    /// `min(F, √(a_n ρ))`.
    pub(crate) fn feedrate_across(&self, radius: R) -> R {
        match self.centripetal_acceleration {
            Some(_) if !(radius > R::zero()) => R::zero(),
            Some(a) if radius < self.feedrate * (self.feedrate / a) => (a * radius).sqrt().min(self.feedrate),
            _ => self.feedrate,
        }
    }

    /// The radius below which the chord error limits the feed: `ρ = ((F T/2)² + E²)/(2E)`.
    pub(crate) fn chord_bound_radius(&self) -> R {
        let half_step = (self.feedrate * self.interpolation_period).half();
        half_step * (half_step / self.chord_error).half() + self.chord_error.half()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::paper_limits;

    #[test]
    fn each_limit_must_be_positive() {
        assert_eq!(paper_limits().validate(), Ok(()));
        let cases = [
            KinematicLimits { interpolation_period: 0.0, ..paper_limits() },
            KinematicLimits { feedrate: -1.0, ..paper_limits() },
            KinematicLimits { acceleration: f64::NAN, ..paper_limits() },
            KinematicLimits { jerk: f64::INFINITY, ..paper_limits() },
            KinematicLimits { chord_error: 0.0, ..paper_limits() },
            KinematicLimits { centripetal_acceleration: Some(0.0), ..paper_limits() },
            with_axis(AxisLimits { velocity: Some(0.0), ..AxisLimits::default() }),
            with_axis(AxisLimits { acceleration: Some(f64::NAN), ..AxisLimits::default() }),
            with_axis(AxisLimits { jerk: Some(-1.0), ..AxisLimits::default() }),
            KinematicLimits { junction: Junction::Deviation(0.0), ..paper_limits() },
            KinematicLimits { junction: Junction::VelocityJump([1.0, 0.0, 1.0]), ..paper_limits() },
        ];
        let names = cases.map(|c| match c.validate() {
            Err(PlanError::NotPositive { what }) => what,
            other => panic!("{other:?}"),
        });
        let fields = "interpolation period,feedrate,acceleration,jerk,chord error,centripetal acceleration,\
                      axis velocity,axis acceleration,axis jerk,junction deviation,velocity jump";
        assert!(names.iter().copied().eq(fields.split(',')), "{names:?}");
    }

    /// Steps back and forth make the largest differences between setpoints.
    #[test]
    fn setpoints_keep_the_limits_of_an_axis_whatever_way_they_go() {
        let (t, jerk, acceleration, velocity) = (3.0, Some(4e-3), Some(0.01), Some(0.02));
        let only = [
            AxisLimits { jerk, ..AxisLimits::default() },
            AxisLimits { acceleration, ..AxisLimits::default() },
            AxisLimits { velocity, ..AxisLimits::default() },
        ];
        let feeds = only.map(|axis| KinematicLimits { interpolation_period: t, ..with_axis(axis) });
        let [by_jerk, by_acceleration, by_velocity] =
            feeds.map(|limits| limits.feed_in_any_direction(&[1.0; AXES]));
        let steps = |feed: f64| [feed * t, -feed * t, feed * t];
        let [a, b, c] = steps(by_jerk);
        assert!(((a - 2.0 * b + c) / t.powi(3) / 4e-3 - 1.0).abs() < 1e-12, "{by_jerk}");
        let [a, b, _] = steps(by_acceleration);
        assert!(((a - b) / t.powi(2) / 0.01 - 1.0).abs() < 1e-12, "{by_acceleration}");
        assert_eq!((by_velocity, paper_limits().feed_in_any_direction(&[1.0; AXES])), (0.02, 0.6));
    }

    fn with_axis(axis: AxisLimits<f64>) -> KinematicLimits<f64> {
        KinematicLimits { axes: [AxisLimits::default(), axis, AxisLimits::default()], ..paper_limits() }
    }

    #[test]
    fn the_tightest_of_three_limits_holds() {
        let limits = KinematicLimits { centripetal_acceleration: Some(0.001), ..paper_limits() };
        assert_eq!(limits.feedrate_at_radius(f64::INFINITY), 0.6);
        assert_eq!(paper_limits().feedrate_at_radius(1e9), 0.6);
        // Chord: 2 sqrt(0.0005 (2 * 24.857 - 0.0005)) = 0.31533 mm/period, which is 105.11 mm/s.
        assert!((paper_limits().feedrate_at_radius(24.857) - 0.315_33).abs() < 1e-5);
        // Centripetal: sqrt(0.001 * 24.857) = 0.157 66 mm/period.
        assert!((limits.feedrate_at_radius(24.857) - 0.157_66).abs() < 1e-5);
        assert_eq!(limits.feedrate_at_radius(0.0), 0.0);
        assert_eq!(limits.feedrate_at_radius(f64::NAN), 0.0);
    }

    #[test]
    fn the_limit_is_continuous_where_the_feedrate_takes_over() {
        let limits = paper_limits();
        let radius = limits.chord_bound_radius(); // 0.09/0.001 + 0.00025 = 90.000 25 mm
        assert!((radius - 90.000_25).abs() < 1e-9);
        assert!((limits.feedrate_at_radius(radius * (1.0 - 1e-12)) - 0.6).abs() < 1e-11);
    }
}
