//! The state of a motor.

/// The motor of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorState {
    /// Position x, in mm of the axis.
    pub position: f64,
    /// Velocity v, in mm/s.
    pub velocity: f64,
    /// The pull a of the drive, as the acceleration that it causes without friction, in mm/s². Only a drive with a
    /// current lag keeps it; for any other it stays 0.
    pub pull: f64,
}
