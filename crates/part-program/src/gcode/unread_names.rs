//! Names of Siemens that are not read, and that change what the blocks behind them mean: a lenient reader leaves those out too.
//!
//! # Source
//! SINUMERIK 840D sl / 828D, Programming Manual Job Planning, "Transformations", "Spline interpolation", "Frames"; Programming Manual
//! Fundamentals, "Modal subprogram call", "Diameter programming".

/// What ends the meaning that a name gives to moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ender {
    /// `MCALL` alone on its line.
    NoCall,
    /// `CYCLE800()`.
    NoSwivel,
    /// `TRAFOOF`.
    NoTransformation,
    /// `TOROTOF`.
    NoToolFrame,
    /// `DIAMOF`.
    NoDiameter,
    /// `GEOAX()`.
    OwnAxes,
}

/// What a name does to the blocks behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameAct {
    /// It is a motion, which later blocks continue.
    Motion,
    /// It gives coordinates, or moves, another meaning until this ends it.
    Begins(Ender),
    /// It ends this.
    Ends(Ender),
}

/// The act of a name, in capitals. `is_bare` tells that neither arguments nor another name follow.
pub(crate) fn act_of_name(name: &str, is_bare: bool) -> Option<NameAct> {
    use NameAct::{Begins, Ends, Motion};
    let begins_or_ends = |ender| Some(if is_bare { Ends(ender) } else { Begins(ender) });
    match name {
        "ASPLINE" | "CSPLINE" | "POLY" | "INVCW" | "INVCCW" | "OEMIPO1" | "OEMIPO2" => Some(Motion),
        "MCALL" => begins_or_ends(Ender::NoCall),
        "CYCLE800" => begins_or_ends(Ender::NoSwivel),
        "GEOAX" => begins_or_ends(Ender::OwnAxes),
        "TRAORI" | "TRANSMIT" | "TRACYL" | "TRAANG" | "TRACON" | "TRACOORD" => {
            Some(Begins(Ender::NoTransformation))
        }
        "TRAFOOF" => Some(Ends(Ender::NoTransformation)),
        "TOROT" | "TOROTX" | "TOROTY" | "TOROTZ" | "TOFRAME" | "TOFRAMEX" | "TOFRAMEY" | "TOFRAMEZ"
        | "PAROT" => Some(Begins(Ender::NoToolFrame)),
        "TOROTOF" | "PAROTOF" => Some(Ends(Ender::NoToolFrame)),
        "DIAMON" | "DIAM90" => Some(Begins(Ender::NoDiameter)),
        "DIAMOF" => Some(Ends(Ender::NoDiameter)),
        _ => None,
    }
}
