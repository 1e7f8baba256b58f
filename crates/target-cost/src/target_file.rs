//! Target files, with the costs that were counted.

use crate::calibration::Calibration;
use crate::error::TargetError;
use crate::target::Target;

impl Target {
    /// Reads a target file.
    ///
    /// # Errors
    /// [`TargetError`], naming the file and line, key and value.
    pub fn read(file: &str, text: &str) -> Result<Self, TargetError> {
        let target: Self =
            toml::from_str(text).map_err(|error| TargetError::Toml { file: file.to_string(), error })?;
        target.validate(file, text)?;
        if target.calibrated { Calibration::committed()?.complete(file, target) } else { Ok(target) }
    }
}
