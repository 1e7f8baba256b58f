//! The switch of a run: with it, a reader takes the run into the pictures and out of them.

use crate::palette;

/// A switch, as the templates show it.
pub(crate) struct Switch {
    pub(crate) index: usize,
    pub(crate) name: String,
    pub(crate) light: &'static str,
    pub(crate) dark: &'static str,
    pub(crate) dash: &'static str,
    /// Whether it is on before the reader chooses.
    pub(crate) shown: bool,
    /// Whether the run was made: a switch of none is left out.
    pub(crate) ran: bool,
    pub(crate) good: bool,
    pub(crate) recommended: bool,
}

impl Switch {
    /// The switch of a run with this number, name, hue and dash: on, of a good run that is not the recommended one.
    pub(crate) fn new(index: usize, name: String, hue: usize, dash: usize) -> Self {
        let (light, dark) = palette::hue(hue);
        let dash = palette::dash(dash);
        Self { index, name, light, dark, dash, shown: true, ran: true, good: true, recommended: false }
    }
}
