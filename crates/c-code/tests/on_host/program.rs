//! Parts that are compiled to programs, which print the verdicts of the parts' self-tests.

use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Output};

use c_code::{CFiles, CName};

use crate::compilers::{Compiler, Family, compiler_of, compilers};
use crate::planned_path::PlannedPath;

/// Whoever compiles these files takes no warning for an answer.
pub(crate) const STRICT: [&str; 6] =
    ["-Wall", "-Wextra", "-Wconversion", "-Wsign-conversion", "-pedantic", "-Werror"];

/// How parts are compiled, by whom if it is there, and which of three parts, one after the other.
struct Build {
    family: Family,
    flags: &'static [&'static str],
    has_checks: bool,
    takes: [bool; 3],
}

/// Each part is compiled as it stands, and checks itself while it runs. Of three parts one more is compiled for size and one for speed.
/// Two in three form products as cores without long ones do.
const BUILDS: [Build; 4] = [
    Build { family: Family::Gcc, flags: &["-O0"], has_checks: true, takes: [true, false, false] },
    Build {
        family: Family::Gcc,
        flags: &["-O0", SHORT_PRODUCTS],
        has_checks: true,
        takes: [false, true, true],
    },
    Build {
        family: Family::Gcc,
        flags: &["-Os", SHORT_PRODUCTS],
        has_checks: false,
        takes: [true, false, false],
    },
    Build {
        family: Family::Clang,
        flags: &["-O2", "-ffp-contract=fast"],
        has_checks: false,
        takes: [false, true, false],
    },
];
const SHORT_PRODUCTS: &str = "-DFEEDBITS_SHORT_PRODUCTS=1";

/// Files of several parts.
pub(crate) struct Parts {
    files: Vec<(String, CFiles)>,
    first: usize,
}

impl Parts {
    /// No parts. The first one counts as number `first`: so several tests give a format to several builds.
    pub(crate) fn from(first: usize) -> Self {
        Self { files: Vec::new(), first }
    }

    /// Adds the path in a format that can hold it. Whether it was added.
    pub(crate) fn add<const D: usize>(
        &mut self,
        path: &PlannedPath<'_, D>,
        format: &str,
        has_override: bool,
    ) -> bool {
        let name = format!("part{}", self.files.len());
        let files = path.files(CName::try_new(&name).expect("a name"), format, has_override);
        let is_held = files.is_some();
        self.files.extend(files.map(|files| (name, files)));
        is_held
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
        let folder = self.folder();
        for compiler in compilers() {
            let sources = self.files.iter().map(|(name, _)| format!("{name}.c"));
            let output = compiler.run(folder.path(), sources.chain(["-fsyntax-only".to_owned()]));
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(!output.status.success(), "{} took the parts", compiler.command);
            assert!(texts.iter().all(|text| errors.contains(text)), "{}: {errors}", compiler.command);
        }
    }

    /// Compiles the parts in every build, and demands that all self-tests find the run of Rust.
    pub(crate) fn demand_the_same_runs(&self) {
        self.demand_verdicts(&vec![0; self.files.len()]);
    }

    /// Compiles the parts in every build, and demands these verdicts of their self-tests.
    pub(crate) fn demand_verdicts(&self, verdicts: &[i32]) {
        let folder = self.folder();
        for build in &BUILDS {
            let takes = |part: &usize| build.takes[(part + self.first) % build.takes.len()];
            let parts: Vec<_> = (0..self.files.len()).filter(takes).collect();
            let Some(compiler) = compiler_of(build.family).filter(|_| !parts.is_empty()) else { continue };
            let said = self.said_by(compiler, build, &parts, folder.path());
            let lines = parts.iter().map(|part| format!("{} {}\n", self.files[*part].0, verdicts[*part]));
            assert_eq!(
                said,
                lines.collect::<String>(),
                "{} {:?}: the verdicts",
                compiler.command,
                build.flags
            );
        }
    }

    /// A folder with the files of all parts.
    fn folder(&self) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, files) in &self.files {
            write_files(folder.path(), name, files);
        }
        folder
    }

    /// The verdicts that a program of these parts prints.
    fn said_by(&self, compiler: &Compiler, build: &Build, parts: &[usize], folder: &Path) -> String {
        let (mut includes, mut calls) = (String::from("#include <stdio.h>\n"), String::new());
        let mut arguments = vec!["main.c".to_owned()];
        for (name, _) in parts.iter().map(|part| &self.files[*part]) {
            let _ = writeln!(includes, "#include \"{name}.h\"");
            let _ = writeln!(calls, "    printf(\"{name} %d\\n\", (int){name}_self_test());");
            arguments.push(format!("{name}.c"));
        }
        let main = format!("{includes}\nint main(void)\n{{\n{calls}    return 0;\n}}\n");
        std::fs::write(folder.join("main.c"), main).expect("a file");
        let checks = if build.has_checks { compiler.checks } else { &[] };
        let flags = STRICT.iter().chain(build.flags).chain(checks).chain(&["-std=c99", "-o", "program"]);
        arguments.extend(flags.map(|flag| (*flag).to_owned()));
        demand_success(&compiler.run(folder, &arguments), compiler, &arguments);
        let output = Command::new(folder.join("program")).output().expect("a program that runs");
        demand_success(&output, compiler, &arguments);
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

/// Writes the files of a part, and a copy of them to the folder that `FEEDBITS_KEEP_C` names.
pub(crate) fn write_files(folder: &Path, name: &str, files: &CFiles) {
    let kept = std::env::var_os("FEEDBITS_KEEP_C");
    for folder in kept.iter().map(Path::new).chain([folder]) {
        std::fs::write(folder.join(format!("{name}.h")), &files.header).expect("a file");
        std::fs::write(folder.join(format!("{name}.c")), &files.source).expect("a file");
    }
}

/// Demands that a compiler, or the program that it made, ended well.
pub(crate) fn demand_success(output: &Output, compiler: &Compiler, arguments: &[String]) {
    let [text, errors] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    let command = format!("{} {}", compiler.command, arguments.join(" "));
    assert!(output.status.success(), "{command}\n{}: {text}{errors}", output.status);
}
