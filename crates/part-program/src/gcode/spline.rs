//! Splines of a part program that are being read.

use crate::gcode::fanuc::FanucNurbs;
use crate::gcode::linuxcnc::LinuxCncNurbs;
use crate::gcode::siemens::SiemensSpline;

/// A spline that may have further blocks.
pub(crate) enum Spline {
    Fanuc(FanucNurbs),
    LinuxCnc(LinuxCncNurbs),
    Siemens(SiemensSpline),
}
