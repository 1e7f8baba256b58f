//! Units of lengths in logs.

use std::str::FromStr;

/// The unit of a log's positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres. Angles of a joint are taken as they are, with limits in the same unit.
    Millimetre,
    /// Metres, as ROS has them.
    Metre,
    /// Inches of 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// What one of it is in mm.
    #[must_use]
    pub fn in_mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Metre => 1000.0,
            Self::Inch => 25.4,
        }
    }
}

impl FromStr for LengthUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "mm" => Ok(Self::Millimetre),
            "m" => Ok(Self::Metre),
            "inch" => Ok(Self::Inch),
            _ => Err("expected mm, m or inch".into()),
        }
    }
}
