//! The host's C compilers, and parts that they compile.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use c_code::{CFiles, CName, COverride, CPart, ExpectedRun};
use feed_plan::Schedule;
use nurbs_core::{PieceLimits, compile_with_stops};
use real::{Backend, DoubleDouble};
use secant_interp::{ChordTolerance, CompiledPath, FeedOverride, OverrideLimits, PositionChecksum};
use stress::{PlannedPath, RandomPath};

/// Whoever compiles these files takes no warning for an answer.
const STRICT: [&str; 7] =
    ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-pedantic", "-Werror"];

/// Compilers of the host, and what they check while the program runs. The second forms products as cores without long ones.
const COMPILERS: [(&str, &[&str]); 3] = [
    ("gcc", &["-O1", "-fsanitize=undefined,address", "-fno-sanitize-recover=all"]),
    ("gcc", &["-Os", "-DFEEDBITS_SHORT_PRODUCTS=1", "-fsanitize=undefined", "-fno-sanitize-recover=all"]),
    ("clang", &["-O2", "-ffp-contract=fast"]),
];

/// Files of several parts, which are compiled to one program.
#[derive(Default)]
pub(crate) struct Parts {
    files: Vec<(String, CFiles)>,
}

impl Parts {
    /// A name for the next part.
    pub(crate) fn name(&self) -> CName {
        CName::try_new(&format!("part{}", self.files.len())).expect("a name")
    }

    /// The path in `R`, if `R` can hold it and it lasts at most `most_periods`. Whether it was added.
    pub(crate) fn add<R: Backend, const D: usize>(
        &mut self,
        path: &RandomPath<D>,
        most_periods: u32,
        has_override: bool,
    ) -> bool {
        let Some(planned) = PlannedPath::new(path, most_periods) else { return false };
        let curves: Vec<_> = path.curves.iter().map(nurbs_core::NurbsBuf::as_curve).collect();
        let step_mm = path.limits.feedrate + planned.landing_step();
        let limits = PieceLimits { length_mm: path.piece_mm, step_mm };
        let Ok(table) = compile_with_stops::<DoubleDouble, R, D>(&curves, &limits, &planned.stops()) else {
            return false;
        };
        let fluctuation = path.max_evaluations.is_multiple_of(2).then_some(1e-4);
        let tolerance = ChordTolerance::for_fluctuation(fluctuation, path.max_evaluations);
        let stages = planned.stages();
        let plan = Schedule::new(&stages, 1.0, planned.periods());
        let Ok(path) = CompiledPath::new(table, &plan, tolerance, planned.landing_step()) else {
            return false;
        };
        let Some(run) = expected(&path, 4 * most_periods as usize) else { return false };
        let feed_override = has_override.then(|| override_of(&planned));
        let name = self.name();
        let about = format!("{} in {}", name.as_str(), R::name());
        let part = CPart { name, about, fault: None, path: &path, period_s: 0.001, run, feed_override };
        let name = part.name.as_str().to_owned();
        self.files.push((name, part.files().expect("C has the format")));
        true
    }

    /// Compiles all parts with every compiler that is there, and demands that all self-tests find the run of Rust.
    pub(crate) fn demand_the_same_runs(&self) {
        self.demand_verdicts(&vec![0; self.files.len()]);
    }

    /// Changes the source of a part, as a bad copy would.
    pub(crate) fn change(&mut self, part: usize, change: impl FnOnce(&str) -> String) {
        let source = &mut self.files[part].1.source;
        let changed = change(source);
        assert_ne!(*source, changed, "the change meets nothing");
        *source = changed;
    }

    /// Changes the header of a part, as one of another run of `feedbits compile` would be.
    pub(crate) fn change_header(&mut self, part: usize, change: impl FnOnce(&str) -> String) {
        let header = &mut self.files[part].1.header;
        let changed = change(header);
        assert_ne!(*header, changed, "the change meets nothing");
        *header = changed;
    }

    /// Demands that every compiler that is there refuses the parts, and that what it says has each of these texts.
    pub(crate) fn demand_refusal(&self, texts: &[&str]) {
        for (compiler, flags) in COMPILERS {
            if Command::new(compiler).arg("--version").output().is_err() {
                println!("{compiler} is not found: its part of the test is skipped");
                continue;
            }
            let folder = tempfile::tempdir().expect("a folder");
            let (output, _) = self.compiled(compiler, flags, folder.path());
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(!output.status.success(), "{compiler} took the parts");
            assert!(texts.iter().all(|text| errors.contains(text)), "{compiler}: {errors}");
        }
    }

    /// Compiles all parts with every compiler that is there, and demands these verdicts of their self-tests.
    pub(crate) fn demand_verdicts(&self, verdicts: &[i32]) {
        let mut compiled = 0;
        for (compiler, flags) in COMPILERS {
            if Command::new(compiler).arg("--version").output().is_err() {
                println!("{compiler} is not found: its part of the test is skipped");
                continue;
            }
            compiled += 1;
            let folder = tempfile::tempdir().expect("a folder");
            let program = self.program(compiler, flags, folder.path());
            let output = Command::new(&program).output().expect("a program that runs");
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{compiler}: {text}{errors}");
            let lines =
                self.files.iter().zip(verdicts).map(|((name, _), verdict)| format!("{name} {verdict}\n"));
            assert_eq!(text, lines.collect::<String>(), "{compiler}: the verdicts");
        }
        let must = std::env::var_os("FEEDBITS_C_COMPILER").is_some();
        assert!(compiled > 0 || !must, "no C compiler is found, and FEEDBITS_C_COMPILER asks for one");
    }

    /// The program that prints the verdict of each part.
    fn program(&self, compiler: &str, flags: &[&str], folder: &Path) -> PathBuf {
        let (output, program) = self.compiled(compiler, flags, folder);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{compiler}: {errors}");
        program
    }

    /// What the compiler says of that program, and where it is if the compiler takes it.
    fn compiled(&self, compiler: &str, flags: &[&str], folder: &Path) -> (Output, PathBuf) {
        let (mut includes, mut calls) = (String::from("#include <stdio.h>\n"), String::new());
        let mut sources = vec![folder.join("main.c")];
        for (name, files) in &self.files {
            std::fs::write(folder.join(format!("{name}.h")), &files.header).expect("a file");
            std::fs::write(folder.join(format!("{name}.c")), &files.source).expect("a file");
            let _ = writeln!(includes, "#include \"{name}.h\"");
            let _ = writeln!(calls, "    printf(\"{name} %d\\n\", (int){name}_self_test());");
            sources.push(folder.join(format!("{name}.c")));
        }
        let main = format!("{includes}\nint main(void)\n{{\n{calls}    return 0;\n}}\n");
        std::fs::write(folder.join("main.c"), main).expect("a file");
        let program = folder.join("program");
        let output = Command::new(compiler)
            .args(STRICT)
            .args(flags)
            .args(&sources)
            .arg("-o")
            .arg(&program)
            .output()
            .expect("a compiler that runs");
        if let Ok(kept) = std::env::var("FEEDBITS_KEEP_C") {
            for file in std::fs::read_dir(folder).expect("a folder").flatten() {
                let _ = std::fs::copy(file.path(), Path::new(&kept).join(file.file_name()));
            }
        }
        (output, program)
    }
}

/// Feed override with a reserve of a fifth of the plan's own acceleration and jerk; 100 % is four fifths of its speed.
fn override_of<const D: usize>(planned: &PlannedPath<'_, D>) -> COverride {
    let limits = &planned.path.limits;
    let feeds = FeedOverride::new(&OverrideLimits {
        acceleration: 1.25 * limits.acceleration,
        jerk: 1.25 * limits.jerk,
        planned_acceleration: limits.acceleration,
        planned_jerk: limits.jerk,
        planned_feed: limits.feedrate,
    });
    COverride { feeds: feeds.expect("a reserve"), commanded: 0.8 }
}

/// The run in Rust; `None` if it is not over after so many periods.
fn expected<R: Backend, const D: usize>(path: &CompiledPath<R, D>, most: usize) -> Option<ExpectedRun> {
    let (mut periods, mut checksum) = (0, PositionChecksum::default());
    for run in path.runs() {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
            periods += 1;
            if periods > most {
                return None;
            }
        }
    }
    Some(ExpectedRun { periods, checksum: checksum.value() })
}
