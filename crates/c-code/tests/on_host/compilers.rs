//! The C compilers of this machine.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

/// Whose compiler it is, whatever its command is called: on some machines `cc` or `gcc` is clang.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Gcc,
    Clang,
}

/// A compiler that was found.
#[derive(Debug)]
pub(crate) struct Compiler {
    pub(crate) command: &'static str,
    pub(crate) family: Family,
    /// Flags with which a program checks itself for undefined behaviour and, where that links, for addresses.
    pub(crate) checks: &'static [&'static str],
    /// Whether it compiles C++ too.
    pub(crate) has_cpp: bool,
}

/// The checks, strongest first: the second needs no library. That of addresses finds each wrong pointer at its use, so none is
/// checked where it is formed.
const CHECKS: [(Family, &[&str]); 4] = [
    (
        Family::Gcc,
        &["-fsanitize=address,undefined,float-cast-overflow", NO_POINTERS, "-fno-sanitize-recover=all"],
    ),
    (Family::Gcc, &["-fsanitize=undefined,float-cast-overflow", "-fsanitize-undefined-trap-on-error"]),
    (
        Family::Clang,
        &["-fsanitize=address,undefined,float-cast-overflow", NO_POINTERS, "-fno-sanitize-recover=all"],
    ),
    (Family::Clang, &["-fsanitize=undefined,float-cast-overflow", "-fsanitize-trap=all"]),
];
const NO_POINTERS: &str = "-fno-sanitize=null,alignment,object-size,pointer-overflow";

static FOUND: LazyLock<Vec<Compiler>> = LazyLock::new(|| {
    let mut found: Vec<Compiler> = Vec::new();
    for command in ["gcc", "clang", "cc"] {
        let Some(family) = family(command) else { continue };
        if found.iter().all(|other| other.family != family) {
            let folder = tempfile::tempdir().expect("a folder");
            let (checks, has_cpp) = (checks(command, family, folder.path()), has_cpp(command, folder.path()));
            found.push(Compiler { command, family, checks, has_cpp });
        }
    }
    println!("C compilers: {found:?}");
    if std::env::var_os("FEEDBITS_C_COMPILER").is_some() {
        for family in [Family::Gcc, Family::Clang] {
            let compiler = found.iter().find(|compiler| compiler.family == family);
            assert!(
                compiler.is_some_and(|compiler| compiler.has_cpp && !compiler.checks.is_empty()),
                "FEEDBITS_C_COMPILER asks for gcc and clang, with C++ and checks: found are {found:?}"
            );
        }
    }
    found
});

/// Those of gcc and clang that this machine has. All tests take their compilers from here.
///
/// # Panics
/// If `FEEDBITS_C_COMPILER` is set and one of the two is missing.
pub(crate) fn compilers() -> &'static [Compiler] {
    &FOUND
}

/// The compiler of this family, or another one that is there.
pub(crate) fn compiler_of(family: Family) -> Option<&'static Compiler> {
    let found = compilers();
    found.iter().find(|compiler| compiler.family == family).or(found.first())
}

impl Compiler {
    /// Runs the compiler in a folder.
    pub(crate) fn run<S: AsRef<OsStr>>(
        &self,
        folder: &Path,
        arguments: impl IntoIterator<Item = S>,
    ) -> Output {
        let output = Command::new(self.command).current_dir(folder).args(arguments).output();
        output.expect("a compiler that was found runs")
    }
}

/// Whose compiler this command is; `None` if there is none.
fn family(command: &str) -> Option<Family> {
    let macros =
        Command::new(command).args(["-dM", "-E", "-x", "c", "-"]).stdin(Stdio::null()).output().ok()?;
    let macros = String::from_utf8_lossy(&macros.stdout).into_owned();
    match (macros.contains("__clang__"), macros.contains("__GNUC__")) {
        (true, _) => Some(Family::Clang),
        (_, true) => Some(Family::Gcc),
        _ => None,
    }
}

/// The first of the checks with which a program links and runs.
fn checks(command: &str, family: Family, folder: &Path) -> &'static [&'static str] {
    std::fs::write(folder.join("empty.c"), "int main(void) { return 0; }\n").expect("a file");
    let links = |flags: &[&str]| {
        let program = folder.join("empty");
        let mut compile = Command::new(command);
        compile.current_dir(folder).args(flags).args(["empty.c", "-o"]).arg(&program);
        let is_good = |command: &mut Command| command.output().is_ok_and(|output| output.status.success());
        is_good(&mut compile) && is_good(&mut Command::new(program))
    };
    let of_family = CHECKS.iter().filter(|(of, _)| *of == family).map(|(_, flags)| *flags);
    of_family.into_iter().find(|flags| links(flags)).unwrap_or_default()
}

fn has_cpp(command: &str, folder: &Path) -> bool {
    std::fs::write(folder.join("empty.cpp"), "#include <stdint.h>\n").expect("a file");
    let output =
        Command::new(command).current_dir(folder).args(["-std=c++17", "-fsyntax-only", "empty.cpp"]).output();
    output.is_ok_and(|output| output.status.success())
}
