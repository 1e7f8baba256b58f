//! No compiler has a warning for any part: as C99 and as C++17, with long products and with short ones. So there is no function, macro,
//! variable or constant that a part does not use.

use std::collections::BTreeSet;

use c_code::{CFiles, CName};
use stress::RandomPath;

use crate::compilers::{Compiler, Family, compilers};
use crate::paths::{at_every_profile, in_space, in_the_plane, lines, paper_a};
use crate::planned_path::PlannedPath;
use crate::program::{STRICT, demand_success, write_files};
use crate::random_parts::random_paths;

const FORMATS: [&str; 13] = [
    "I4F4", "I3F5", "I4F12", "I8F8", "I16F16", "I8F24", "I4F28", "I2F30", "I32F32", "I4F60", "I2F62", "f32",
    "f64",
];

/// Periods of a run, at most.
const MOST_PERIODS: u32 = 4000;

/// Where a file is only read, gcc looks at macros and variables, and clang at functions too, also at inline ones.
const UNUSED: [&str; 3] = ["-Wunused-macros", "-Wunused-const-variable", "-Wunused-function"];

/// As what a file is compiled, and with which products.
const LANGUAGES: [[&str; 4]; 2] = [
    ["-x", "c", "-std=c99", "-DFEEDBITS_SHORT_PRODUCTS=0"],
    ["-x", "c++", "-std=c++17", "-DFEEDBITS_SHORT_PRODUCTS=1"],
];

/// Files whose code differs in more than numbers.
#[derive(Default)]
struct DifferentFiles {
    seen: BTreeSet<(String, String)>,
    files: Vec<CFiles>,
    formats: BTreeSet<&'static str>,
}

impl DifferentFiles {
    /// Adds the paths in every format that holds them, in every second one with feed override, if there is no such file yet.
    fn add<const D: usize>(&mut self, paths: &[RandomPath<D>]) {
        for (number, path) in paths.iter().enumerate() {
            let planned = PlannedPath::new(path, MOST_PERIODS).expect("a plan");
            for (index, format) in FORMATS.into_iter().enumerate() {
                self.add_one(&planned, format, (number + index).is_multiple_of(2));
            }
        }
    }

    fn add_one<const D: usize>(
        &mut self,
        path: &PlannedPath<'_, D>,
        format: &'static str,
        has_override: bool,
    ) {
        let name = CName::try_new("part").expect("a name");
        let Some(files) = path.files(name, format, has_override) else { return };
        self.formats.insert(format);
        if self.seen.insert((format.to_owned(), without_numbers(&files.source))) {
            self.files.push(files);
        }
    }

    /// Demands that no compiler has a warning.
    fn demand_no_warnings(&self) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut sources = Vec::new();
        for (index, files) in self.files.iter().enumerate() {
            let folder = folder.path().join(index.to_string());
            std::fs::create_dir(&folder).expect("a folder");
            write_files(&folder, "part", files);
            sources.push(format!("{index}/part.c"));
        }
        println!("{} files", sources.len());
        for compiler in compilers() {
            for language in languages(compiler) {
                let arguments: Vec<String> =
                    flags(language).map(str::to_owned).chain(sources.iter().cloned()).collect();
                demand_success(&compiler.run(folder.path(), &arguments), compiler, &arguments);
            }
        }
    }
}

/// Those that the compiler knows.
fn languages(compiler: &Compiler) -> &'static [[&'static str; 4]] {
    if compiler.has_cpp { &LANGUAGES } else { &LANGUAGES[..1] }
}

fn flags(language: &'static [&'static str]) -> impl Iterator<Item = &'static str> {
    STRICT.into_iter().chain(UNUSED).chain(["-fsyntax-only"]).chain(language.iter().copied())
}

/// The code of a file: without tables, digits and the values of macros.
fn without_numbers(source: &str) -> String {
    let lines = source.lines().filter(|line| !line.starts_with("    { "));
    let code = lines.map(|line| match line.strip_prefix("#define ") {
        Some(macro_) if !line.contains('(') => macro_.split(' ').next().unwrap_or_default(),
        _ => line,
    });
    code.flat_map(|line| line.chars().chain(['\n'])).filter(|c| !c.is_ascii_digit()).collect()
}

#[test]
fn paths_in_the_plane_compile_without_a_warning() {
    let mut files = DifferentFiles::default();
    files.add(&in_the_plane());
    assert_eq!(files.formats.len(), FORMATS.len(), "each format holds a path: {:?} do", files.formats);
    files.demand_no_warnings();
}

#[test]
fn paths_in_space_and_every_profile_compile_without_a_warning() {
    let mut files = DifferentFiles::default();
    files.add(&in_space());
    files.add(&at_every_profile(&lines()));
    files.add(&at_every_profile(&paper_a()));
    files.demand_no_warnings();
}

#[test]
fn random_parts_compile_without_a_warning() {
    let mut files = DifferentFiles::default();
    for (index, path) in random_paths::<2>(7).take(120).enumerate() {
        if let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) {
            files.add_one(&planned, FORMATS[index % FORMATS.len()], index.is_multiple_of(2));
        }
    }
    files.demand_no_warnings();
}

/// The tests above fail where something is unused: a macro by each compiler, an inline function by clang.
#[test]
fn what_is_unused_is_refused() {
    let path = paper_a();
    let planned = PlannedPath::new(&path, MOST_PERIODS).expect("a plan");
    let name = CName::try_new("part").expect("a name");
    let files = planned.files(name, "I4F28", false).expect("files");
    for compiler in compilers() {
        for language in languages(compiler) {
            let refuses = |text: &str| {
                let folder = tempfile::tempdir().expect("a folder");
                let source = files.source.clone() + text;
                write_files(folder.path(), "part", &CFiles { source, ..files.clone() });
                !compiler.run(folder.path(), flags(language).chain(["part.c"])).status.success()
            };
            assert!(!refuses(""), "{compiler:?} {language:?}");
            assert!(refuses("#define UNUSED 1\n"), "{compiler:?} {language:?}");
            let is_refused = refuses("static inline int unused(void)\n{\n    return 0;\n}\n");
            assert_eq!(is_refused, compiler.family == Family::Clang, "{compiler:?} {language:?}");
        }
    }
}
