//! Machine files from the settings that a control has: everybody has one of these, and nobody has our keys.
//!
//! Each reader takes what its control's settings say of speeds, accelerations, corners and steps, and says what it assumes in place of what
//! they do not say: no such file states an interpolation period, and few a jerk. [`Draft`] becomes a machine file whose comments
//! name the setting, or the assumption, behind each value.

mod draft;
mod fluidnc;
mod grbl;
mod klipper;
mod linuxcnc;
mod marlin;
mod sections;
mod settings;

use std::path::Path;

use anyhow::{Result, bail};

use crate::files;
use draft::Draft;

/// A control whose settings are read.
struct Control {
    /// Its settings, as a person calls them.
    name: &'static str,
    /// Whether a text is such settings.
    is_of: fn(&str) -> bool,
    /// Whether a file's name, in small letters, is that of such settings.
    is_named: fn(&str) -> bool,
    /// Reads the settings of a file of this name.
    read: fn(&str, &str) -> Result<Draft>,
}

const CONTROLS: [Control; 5] = [
    Control {
        name: "Marlin's Configuration.h",
        is_of: marlin::is_marlin,
        is_named: |name| name.ends_with(".h"),
        read: marlin::read,
    },
    Control {
        name: "Klipper's printer.cfg",
        is_of: klipper::is_klipper,
        is_named: |name| name.ends_with(".cfg"),
        read: klipper::read,
    },
    Control {
        name: "an INI file of LinuxCNC",
        is_of: linuxcnc::is_linuxcnc,
        is_named: |name| name.ends_with(".ini"),
        read: linuxcnc::read,
    },
    Control {
        name: "FluidNC's config.yaml",
        is_of: fluidnc::is_fluidnc,
        is_named: |name| name.ends_with(".yaml") || name.ends_with(".yml"),
        read: fluidnc::read,
    },
    Control {
        name: "what Grbl prints at $$",
        is_of: grbl::is_grbl,
        is_named: |name| name.contains("grbl"),
        read: grbl::read,
    },
];

/// A machine file, and what of it is assumed.
pub(crate) struct Made {
    pub(crate) text: String,
    /// Each assumption in a line, and what of the settings is not taken.
    pub(crate) said: Vec<String>,
}

/// Makes a machine file from the settings in a file, told by their content or else by the file's name.
///
/// # Errors
/// If the file cannot be read, is none of these settings, lacks what a machine needs, or has a value that no machine file may have; with file
/// and line.
pub(crate) fn machine_from(path: &Path) -> Result<Made> {
    let bytes = files::bytes("--from", path, files::MOST_OF_SMALL)?;
    made(&path.display().to_string(), &String::from_utf8_lossy(&bytes))
}

fn made(name: &str, text: &str) -> Result<Made> {
    // Editors of Windows put a mark of the byte order before the text.
    let text = text.trim_start_matches('\u{feff}');
    let small =
        Path::new(name).file_name().map(|last| last.to_string_lossy().to_lowercase()).unwrap_or_default();
    let by_content = CONTROLS.iter().find(|control| (control.is_of)(text));
    let Some(control) = by_content.or_else(|| CONTROLS.iter().find(|control| (control.is_named)(&small)))
    else {
        let names: Vec<&str> = CONTROLS.iter().map(|control| control.name).collect();
        bail!("{name}: no settings that are known: expected {}", names.join(", "));
    };
    let draft = (control.read)(name, text)?;
    let made = Made { text: draft.toml(name, control.name), said: draft.said() };
    // What is written reads back, before it is printed.
    part_program::read_machine(name, &made.text)?;
    Ok(made)
}

#[cfg(test)]
mod tests {
    use part_program::{Machine, read_machine};

    use super::*;

    /// The machine that settings make, and what is said of it.
    pub(super) fn machine_of(name: &str, text: &str) -> (Machine, Made) {
        let made = made(name, text).expect("a machine file");
        (read_machine(name, &made.text).expect("it reads back"), made)
    }

    /// Each assumption stands above its value, and is said.
    pub(super) fn expect_assumptions(made: &Made, count: usize) {
        let in_file = made.text.lines().filter(|line| line.starts_with("# Assumed: ")).count();
        let said = made.said.iter().filter(|line| line.contains(" is assumed: ")).count();
        assert_eq!((in_file, said), (count, count), "{}\n{:?}", made.text, made.said);
        // The key names them for whoever judges by the file.
        let limits = part_program::read_limits("made", &made.text).expect("limits");
        assert_eq!(limits.assumed.len(), count, "{}", made.text);
    }

    const SMALL: [(&str, &str); 5] = [
        ("Configuration.h", marlin::tests::SMALL),
        ("printer.cfg", klipper::tests::SMALL),
        ("mill.ini", linuxcnc::tests::SMALL),
        ("config.yaml", fluidnc::tests::SMALL),
        ("grbl.txt", grbl::tests::SMALL),
    ];

    /// Content goes before the name, which a person may have changed.
    #[test]
    fn settings_are_told_by_their_content() {
        for (control, (_, text)) in CONTROLS.iter().zip(SMALL) {
            let found = CONTROLS.iter().filter(|one| (one.is_of)(text)).map(|one| one.name);
            assert_eq!(found.collect::<Vec<_>>(), [control.name]);
            let (_, made) = machine_of("my settings", text);
            assert!(made.text.contains(control.name), "{}", made.text);
        }
    }

    /// Windows ends its lines otherwise, and marks the begin of a text.
    #[test]
    fn line_ends_change_nothing() {
        for (name, text) in SMALL {
            let (unix, _) = machine_of(name, text);
            let (windows, _) = machine_of(name, &format!("\u{feff}{}", text.replace('\n', "\r\n")));
            assert_eq!(unix, windows, "{name}");
        }
    }

    /// Every prefix of settings, and settings in which a character is another: a machine file or an error, and never a panic. What is
    /// made reads back.
    #[test]
    fn hostile_settings_are_refused_in_a_line() {
        for (name, text) in SMALL {
            for (end, _) in text.char_indices() {
                let _ = made(name, &text[..end]);
            }
            for (at, letter) in text.char_indices() {
                for other in ['\0', '{', '"', '-', '9', '\n', '\u{7f}', 'ß'] {
                    let changed = format!("{}{other}{}", &text[..at], &text[at + letter.len_utf8()..]);
                    if let Err(error) = made(name, &changed) {
                        assert!(format!("{error:#}").contains(name), "{error:#}");
                    }
                }
            }
        }
        for text in
            ["", "\0\0\0", "G1 X10\n", &"[".repeat(100_000), &"$1=".repeat(100_000), &" :\n".repeat(100_000)]
        {
            for name in ["a", "a.h", "a.cfg", "a.ini", "a.yaml", "grbl"] {
                assert!(made(name, text).is_err(), "{name}");
            }
        }
    }

    /// A number that no machine file may have is refused at its line.
    #[test]
    fn a_number_beside_its_domain_is_refused_with_its_line() {
        for (name, text, (old, new), place) in [
            (
                "Configuration.h",
                marlin::tests::SMALL,
                ("{ 200, 180, 8, 30 }", "{ 1e300, 180, 8, 30 }"),
                "Configuration.h:7: ",
            ),
            ("printer.cfg", klipper::tests::SMALL, ("max_accel: 2500", "max_accel: -1"), "printer.cfg:5: "),
            (
                "mill.ini",
                linuxcnc::tests::SMALL,
                ("SERVO_PERIOD = 500000", "SERVO_PERIOD = 0"),
                "mill.ini:4: ",
            ),
            (
                "config.yaml",
                fluidnc::tests::SMALL,
                ("acceleration_mm_per_sec2: 250", "acceleration_mm_per_sec2: nan"),
                "config.yaml:7: ",
            ),
            ("grbl.txt", grbl::tests::SMALL, ("$120=350.000", "$120=inf"), "grbl.txt:"),
        ] {
            assert!(text.contains(old), "{old}");
            let Err(error) = made(name, &text.replace(old, new)) else { panic!("{new} is taken") };
            let said = format!("{error:#}");
            assert!(said.starts_with(place) && said.contains("expected"), "{said}");
        }
    }
}
