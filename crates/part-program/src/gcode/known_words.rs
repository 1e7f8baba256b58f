//! Every G and M word that the reader knows, by control, and what becomes of it. A G word that has no row for the control
//! of a program is not read: only this table lets a word in. The book's page of words is made from it.

use crate::gcode::word::END_OF_SUBPROGRAM;
use crate::options::Dialect;

/// What becomes of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WordUse {
    /// It is executed.
    Read,
    /// It has no effect on the path. Letters of its own are passed with it.
    Passed,
    /// It is an error; a lenient reader leaves out its block.
    LeftOut,
    /// It is an error, for a lenient reader too.
    Refused,
}

/// A word, as the book lists it.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownWord {
    /// G or M.
    pub letter: char,
    /// Its number.
    pub number: f64,
    /// What becomes of it in a program of FANUC, of LinuxCNC, of Siemens, and of a control that is not named.
    pub uses: [WordUse; 4],
    /// What it does.
    pub meaning: String,
}

/// What the reader does with a G word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Act {
    /// Executes it.
    Read,
    /// Passes it with these letters.
    Pass(&'static [u8]),
    /// Passes it: it switches off what is off in a program that lacks the word that switches it on.
    Off,
    /// Cannot read it, nor the moves behind it until one of these words, by ten times their numbers.
    Frame(&'static [u16]),
    /// Cannot read it, nor the moves behind it until its own word without an angle, or with 0.
    Cylinder,
    /// Cannot read it, nor the blocks that continue this motion.
    Motion,
    /// Cannot read its block.
    Leave,
    /// Refuses the program: it is for a lathe.
    Lathe,
    /// Refuses the word by name: it is a spline of another control.
    Foreign,
}

impl Act {
    fn shown(self) -> WordUse {
        match self {
            Self::Read => WordUse::Read,
            Self::Pass(_) | Self::Off => WordUse::Passed,
            Self::Frame(_) | Self::Cylinder | Self::Motion | Self::Leave => WordUse::LeftOut,
            Self::Lathe | Self::Foreign => WordUse::Refused,
        }
    }
}

/// The controls of a row: FANUC, LinuxCNC, Siemens, and one that is not named.
type Controls = u8;
const F: Controls = 1;
const L: Controls = 2;
const S: Controls = 4;
const N: Controls = 8;
const ALL: Controls = F | L | S | N;

/// A row: ten times the numbers of its words, the controls, the act and the meaning.
type Row = (&'static [u16], Controls, Act, &'static str);

/// Words of work offsets, each of which ends the one before.
const WORK_OFFSETS: [u16; 9] = [540, 550, 560, 570, 580, 590, 591, 592, 593];

/// The G words. Of two rows for one word and control the first counts.
const G_WORDS: &[Row] = &[
    (&[0], ALL, Act::Read, "rapid move"),
    (&[10], ALL, Act::Read, "straight move at feed"),
    (&[20, 30], ALL, Act::Read, "arc or helix, clockwise and counterclockwise"),
    (&[22, 23, 32, 33], ALL, Act::Motion, "involute and other curves"),
    (&[40], ALL, Act::Read, "dwell: the tool rests"),
    (&[50], F | L | N, Act::Read, "FANUC: high precision, P10000 or P0; LinuxCNC: cubic spline"),
    (&[51], F | L | N, Act::Read, "FANUC: precision, Q; LinuxCNC: quadratic spline"),
    (&[52, 53], L | N, Act::Read, "NURBS of LinuxCNC, and its end"),
    (&[52, 53], F | S, Act::Foreign, "NURBS of LinuxCNC, and its end"),
    (&[62], F | L | N, Act::Read, "NURBS of FANUC"),
    (&[62], S, Act::Foreign, "NURBS of FANUC"),
    (&[70], L | S | N, Act::Lathe, "on a lathe: X is a diameter"),
    (&[71], F, Act::Cylinder, "coordinates on a cylinder"),
    (&[80], L, Act::Pass(b"P"), "of LinuxCNC: X is a radius"),
    (&[80], F | N, Act::Pass(b"P"), "of FANUC: blocks are read ahead"),
    (&[90], F | S | N, Act::Read, "exact stop at the end of this block"),
    (
        &[100],
        ALL,
        Act::Read,
        "L2, L20: a work offset; L1, L10 to L13: tables of tools; of printers: filament is pulled",
    ),
    (&[110], N, Act::Read, "of printers: filament is pushed"),
    (&[121], F | N, Act::Frame(&[131]), "coordinates on a face"),
    (&[131], F | N, Act::Off, "coordinates on a face off"),
    (&[150], F | N, Act::Off, "polar coordinates off"),
    (&[160], F | N, Act::Frame(&[150]), "polar coordinates"),
    (&[170, 180, 190], ALL, Act::Read, "plane of X and Y, Z and X, Y and Z"),
    (&[200, 210], ALL, Act::Read, "inches and millimetres, of lengths and of F"),
    (&[230, 250], F | N, Act::Off, "checks of stroke and speed off"),
    (&[280, 300], ALL, Act::Read, "over a point to a place of the machine, which is not known"),
    (&[281, 301], ALL, Act::Read, "that place is set"),
    (&[290], F | N, Act::Read, "of printers: the bed is measured; with axes it is not read"),
    (&[310], F | N, Act::Leave, "move until a signal"),
    (&[320, 340, 350], F | N, Act::Motion, "thread"),
    (&[330], ALL, Act::Read, "move along with the spindle"),
    (&[331], L | N, Act::Read, "tap along with the spindle, and back"),
    (&[331], S, Act::Motion, "of Siemens: tap"),
    (&[382, 383, 384, 385], L | N, Act::Motion, "move until a probe touches"),
    (&[400], L | N, Act::Read, "cutter compensation off"),
    (&[400], F | S, Act::Off, "cutter compensation off"),
    (&[401], F | N, Act::Off, "normal direction control off"),
    (&[410, 420], L | N, Act::Read, "cutter compensation, left and right, by the radius of a tool"),
    (&[410, 420], F | S, Act::Frame(&[400]), "cutter compensation, left and right, by the radius of a tool"),
    (
        &[411, 421],
        L | N,
        Act::Read,
        "cutter compensation by D, the diameter; of FANUC, the tool turned across the path",
    ),
    (
        &[411, 421],
        F,
        Act::Frame(&[401]),
        "cutter compensation by D, the diameter; of FANUC, the tool turned across the path",
    ),
    (
        &[411, 421],
        S,
        Act::Frame(&[400]),
        "cutter compensation by D, the diameter; of FANUC, the tool turned across the path",
    ),
    (&[430], ALL, Act::Pass(b""), "length of the tool"),
    (&[431, 432], ALL, Act::Read, "length of the tool by axis words"),
    (&[434, 435], F | N, Act::Frame(&[490]), "place of the tool's tip, with rotary axes"),
    (&[490], ALL, Act::Off, "length of the tool off"),
    (&[500, 501], F | N, Act::Read, "scaling and mirroring off; G50 with S shows a lathe"),
    (&[510], F | N, Act::Frame(&[500]), "scaled coordinates"),
    (&[511], F | N, Act::Frame(&[501]), "mirrored coordinates"),
    (&[520], F | L | N, Act::Read, "zero of the coordinates"),
    (&[530], ALL, Act::Read, "move by the coordinates of the machine"),
    (&[541], F | N, Act::Frame(&WORK_OFFSETS), "further work offsets"),
    (&[540, 550, 560, 570], ALL, Act::Read, "work offset"),
    (&[580, 590], ALL, Act::Read, "work offset; of Siemens with axes, a shift, it is left out"),
    (&[591, 592, 593], F | L | N, Act::Read, "work offset"),
    (&[600], S, Act::Read, "exact stop"),
    (&[6010, 6020, 6030], S, Act::Pass(b""), "how exact a stop is"),
    (&[610], ALL, Act::Read, "exact stop; of LinuxCNC, exact path"),
    (&[611], ALL, Act::Read, "exact stop"),
    (&[620, 630], F, Act::Read, "cutting modes that change feeds: taken as commanded, with a warning"),
    (&[640], ALL, Act::Read, "continuous path; a run of LinuxCNC is judged by its P and Q, no plan is"),
    (&[6410, 6420, 6430, 6440, 6450], S, Act::Read, "rounded blocks: taken as commanded, with a warning"),
    (&[650], F | L | N, Act::Read, "call of a subprogram in the same file, with arguments"),
    (&[660, 661], F | N, Act::Frame(&[670]), "call at every place"),
    (&[670], F | N, Act::Off, "call at every place off"),
    (&[680, 682], F | N, Act::Frame(&[690]), "turned coordinates"),
    (&[690], ALL, Act::Off, "turned coordinates off"),
    (&[700, 710], S | N, Act::Read, "inches and millimetres, of lengths alone"),
    (&[700, 710, 721, 722, 723], F | L | N, Act::Lathe, "on a lathe: a contour"),
    (&[720], F | L | N, Act::Leave, "a cycle; with the blocks of a contour it is a lathe's, and refused"),
    (
        &[730, 740, 760],
        F | L | N,
        Act::Read,
        "drilling cycle; G76 with P and no X or Y cuts a thread on a lathe",
    ),
    (&[800], ALL, Act::Read, "drilling cycle off"),
    (&[810, 820, 830, 840, 850, 860, 880, 890], ALL, Act::Read, "drilling cycle"),
    (&[870], ALL, Act::Motion, "boring from behind"),
    (&[900, 910], ALL, Act::Read, "coordinates from 0, and from the place of the tool"),
    (&[901, 911], ALL, Act::Read, "centres from 0, and from the start of the arc"),
    (&[920, 921, 922, 923], ALL, Act::Read, "the tool's coordinates are set, forgotten, put aside, restored"),
    (&[930, 940, 950], ALL, Act::Read, "feed by time, a minute, a revolution"),
    (&[960], ALL, Act::Read, "speed of the cut: that of the spindle is not known"),
    (&[970], ALL, Act::Read, "speed of the spindle"),
    (&[980, 990], F | L | N, Act::Read, "where a drilling cycle ends"),
    (&[1030], F | N, Act::Pass(b"P"), "blocks that are read ahead"),
    (&[1070], F | N, Act::Cylinder, "coordinates on a cylinder"),
    (&[1120], F | N, Act::Frame(&[1130]), "coordinates on a face"),
    (&[1130], F | N, Act::Off, "coordinates on a face off"),
    (&[1870], F | N, Act::Pass(b"PE"), "smoothness"),
    (&[3310, 3320], S, Act::Motion, "tapping"),
    (&[4500, 4510], S | N, Act::Pass(b""), "corners of a compensation that is off"),
    (&[5000], S | N, Act::Pass(b""), "work offset off"),
    (&[7000, 7100], S | N, Act::Read, "inches and millimetres, of lengths and of F"),
];

fn control(dialect: Option<Dialect>) -> Controls {
    match dialect {
        Some(Dialect::Fanuc) => F,
        Some(Dialect::LinuxCnc | Dialect::Canon) => L,
        Some(Dialect::Siemens) => S,
        None => N,
    }
}

/// What the reader does with a G word, by ten times its number.
pub(super) fn act_of(tenths: u16, dialect: Option<Dialect>) -> Act {
    let control = control(dialect);
    let row = G_WORDS.iter().find(|(words, controls, ..)| controls & control != 0 && words.contains(&tenths));
    row.map_or(Act::Leave, |(_, _, act, _)| *act)
}

/// What the reader does with an M word that is more than a word at which the tool rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MAct {
    /// Ends the program, or returns from a subprogram.
    End,
    /// Calls a subprogram.
    Call,
    /// Of a printer: passed without a rest.
    Printer,
    /// Of a printer: the tool waits.
    PrinterWaits,
    /// Of a printer, if it has words of its own.
    PrinterSetting,
    /// Of a printer: limits, which are named.
    PrinterLimits,
    /// Of a printer: a percentage of every feed.
    PrinterFeed,
    /// A text follows, which has no words.
    Text,
}

/// The M words that do more than rest the tool, with their meaning.
const M_WORDS: &[(&[u16], MAct, &str)] = &[
    (&[2, 30, 99], MAct::End, "the end of the program, or of a subprogram"),
    (&[17], MAct::End, "of Siemens: the end of the program"),
    (&[98], MAct::Call, "call of a subprogram in the same file"),
    (&[198], MAct::Call, "call of a subprogram of another device: an error, left out with --lenient"),
    (&[82, 83], MAct::Printer, "of printers: E counts from 0, or from its place"),
    (&[104, 106, 107, 140], MAct::Printer, "of printers: heat and fans"),
    (&[109, 190], MAct::PrinterWaits, "of printers: heat, and wait"),
    (&[191, 400, 600], MAct::PrinterWaits, "of printers, once a word shows one: wait, change the filament"),
    (&[84], MAct::PrinterWaits, "of printers: motors off"),
    (&[23, 118, 862], MAct::Text, "of printers: a file, a text, a check of the model"),
    (&[117], MAct::Printer, "of printers: a text that is shown"),
    (
        &[201, 202, 203, 204, 205, 566],
        MAct::PrinterLimits,
        "of printers: limits; the machine file's hold, with a warning",
    ),
    (&[220], MAct::PrinterFeed, "of printers: a percentage of every feed"),
    (
        &[
            73, 92, 115, 200, 206, 207, 208, 209, 221, 301, 304, 412, 413, 420, 486, 500, 569, 572, 593, 851,
            900, 906, 907,
        ],
        MAct::PrinterSetting,
        "of printers, with words of its own: progress, motors, filament, drives, pressure",
    ),
];

/// What the reader does with an M word beside resting the tool; `None` for all others.
pub(super) fn m_act_of(value: f64) -> Option<MAct> {
    M_WORDS
        .iter()
        .find(|(words, ..)| words.iter().any(|word| f64::from(*word) == value))
        .map(|(_, act, _)| *act)
}

/// Every word that the reader knows, in the order of the numbers: the G words, then the M words. Of all others, a G word is
/// left out, and the tool rests at an M word.
#[must_use]
pub fn known_words() -> Vec<KnownWord> {
    let mut tenths: Vec<u16> = G_WORDS.iter().flat_map(|(words, ..)| words.iter().copied()).collect();
    tenths.sort_unstable();
    tenths.dedup();
    let of_g = tenths.into_iter().map(|word| {
        let meanings =
            G_WORDS.iter().filter(|(words, ..)| words.contains(&word)).map(|(.., meaning)| *meaning);
        let mut meanings: Vec<_> = meanings.collect();
        meanings.dedup();
        let controls = [Some(Dialect::Fanuc), Some(Dialect::LinuxCnc), Some(Dialect::Siemens), None];
        let uses = controls.map(|dialect| act_of(word, dialect).shown());
        KnownWord { letter: 'G', number: f64::from(word) / 10.0, uses, meaning: meanings.join("; ") }
    });
    let mut m_words: Vec<(u16, &str)> = M_WORDS
        .iter()
        .flat_map(|(words, _, meaning)| words.iter().map(move |word| (*word, *meaning)))
        .collect();
    m_words.sort_unstable();
    let of_m = m_words.into_iter().map(|(word, meaning)| {
        let mut uses = [WordUse::Read; 4];
        if f64::from(word) == END_OF_SUBPROGRAM {
            // The tool rests there on the others.
            uses = [WordUse::Passed, WordUse::Passed, WordUse::Read, WordUse::Passed];
        }
        KnownWord { letter: 'M', number: f64::from(word), uses, meaning: meaning.to_owned() }
    });
    of_g.chain(of_m).collect()
}
