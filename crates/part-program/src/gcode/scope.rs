//! The inputs of expressions: the values of variables, and the place of the tool.

use crate::arc::Plane;
use crate::gcode::modal::{FeedMode, Modal, Motion};
use crate::gcode::variables::{HIGHEST, Value, Variable, Variables};
use crate::options::Dialect;

/// The inputs of expressions: the values of variables, and the place of the tool.
#[derive(Clone, Copy)]
pub(crate) struct Scope<'a> {
    pub(crate) variables: &'a Variables,
    pub(crate) modal: &'a Modal,
    pub(crate) dialect: Option<Dialect>,
}

impl Scope<'_> {
    /// The value of a variable, or the value that a control keeps under its name.
    pub(crate) fn get(&self, variable: &Variable) -> Value {
        self.variables.get(variable).or_else(|| match variable {
            Variable::Number(number) => self.kept_number(*number),
            Variable::Name(name) => self.kept_name(name),
            Variable::R(_) => Some(0.0),
        })
    }

    /// The tool's place, by the numbers of LinuxCNC and FANUC, and LinuxCNC's settings that have a number.
    fn kept_number(&self, number: u32) -> Value {
        let axis = |first: u32| self.modal.programmed((number - first) as usize);
        match number {
            5420..=5422 => Some(axis(5420)),
            5001..=5003 | 5021..=5023 | 5041..=5043 => Some(axis(number / 10 * 10 + 1)),
            // FANUC's words in force.
            4001..=4120 if self.dialect == Some(Dialect::Fanuc) => self.kept_word(number),
            5220 => Some(f64::from(self.modal.work_offset) + 1.0),
            1..=HIGHEST if self.dialect == Some(Dialect::LinuxCnc) => Some(0.0),
            _ => None,
        }
    }

    /// The number of a group's word in force, as FANUC keeps it; `None` for groups that are not followed.
    fn kept_word(&self, number: u32) -> Value {
        let modal = self.modal;
        Some(match number {
            4001 => match modal.motion {
                Motion::Rapid => 0.0,
                Motion::Line => 1.0,
                Motion::Arc { clockwise: true } => 2.0,
                Motion::Arc { clockwise: false } => 3.0,
                _ => return None,
            },
            4002 => match modal.plane {
                Plane::Xy => 17.0,
                Plane::Zx => 18.0,
                Plane::Yz => 19.0,
            },
            4003 => 90.0 + f64::from(u8::from(modal.incremental)),
            4005 => match modal.feed_mode {
                FeedMode::InverseTime => 93.0,
                FeedMode::PerMinute => 94.0,
                FeedMode::PerRevolution => 95.0,
            },
            4006 => 21.0 - f64::from(u8::from(modal.inches)),
            4014 if modal.work_offset < 6 => 54.0 + f64::from(modal.work_offset),
            4109 => modal.feedrate_mm_per_s? * 60.0 / modal.mm(1.0),
            4119 => modal.spindle_per_minute?,
            _ => return None,
        })
    }

    /// LinuxCNC's predefined names.
    fn kept_name(&self, name: &str) -> Value {
        let (modal, truth) = (self.modal, |holds| f64::from(u8::from(holds)));
        let count = |calls: usize| u32::try_from(calls).map_or(0.0, f64::from);
        Some(match name {
            "_x" => modal.programmed(0),
            "_y" => modal.programmed(1),
            "_z" => modal.programmed(2),
            "_a" | "_b" | "_c" | "_u" | "_v" | "_w" | "_task" | "_remap_level" => 0.0,
            // No value has been returned.
            "_value" | "_value_returned" => 0.0,
            "_lathe_diameter_mode" => 0.0,
            "_lathe_radius_mode" => 1.0,
            "_ccomp" => 400.0,
            "_plane" => match modal.plane {
                Plane::Xy => 170.0,
                Plane::Zx => 180.0,
                Plane::Yz => 190.0,
            },
            "_motion_mode" => match modal.motion {
                Motion::None => 800.0,
                Motion::Rapid => 0.0,
                Motion::Line => 10.0,
                Motion::Arc { clockwise: true } => 20.0,
                Motion::Arc { clockwise: false } => 30.0,
                _ => return None,
            },
            "_inverse_time" => truth(modal.feed_mode == FeedMode::InverseTime),
            "_units_per_minute" => truth(modal.feed_mode == FeedMode::PerMinute),
            "_units_per_rev" => truth(modal.feed_mode == FeedMode::PerRevolution),
            "_ijk_absolute_mode" => truth(modal.absolute_centres),
            "_rpm" => modal.spindle_per_minute.unwrap_or(0.0),
            "_call_level" => count(self.variables.calls),
            "_metric" => truth(!modal.inches),
            "_imperial" => truth(modal.inches),
            "_absolute" => truth(!modal.incremental),
            "_incremental" => truth(modal.incremental),
            "_feed" => modal.feedrate_mm_per_s.unwrap_or(0.0) * 60.0 / modal.mm(1.0),
            "_coord_system" if modal.work_offset > 5 => 585.0 + f64::from(modal.work_offset),
            "_coord_system" => 540.0 + 10.0 * f64::from(modal.work_offset),
            "_vmajor" => 2.9,
            "_vminor" => 0.0,
            _ => return None,
        })
    }
}
