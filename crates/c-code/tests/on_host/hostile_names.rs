//! Names from outside in the comments of C files add nothing to what is compiled.

use std::path::Path;
use std::process::Command;

use c_code::CName;
use foreign_text::hostile::NAMES;
use real::I4F28;

use crate::compilers::{Compiler, compilers};
use crate::paths::paper_a;
use crate::planned_path::PlannedPath;
use crate::program::{STRICT, demand_success};

/// The names that a compiled source has: of functions, tables and constants, here and elsewhere. `None` without `nm`.
fn symbols(compiler: &Compiler, folder: &Path, source: &str) -> Option<String> {
    std::fs::write(folder.join("part.c"), source).expect("a file");
    // Nothing is left out and nothing is inlined, so a function is a symbol even if nobody calls it.
    let flags = STRICT.iter().chain(&["-std=c99", "-O0", "-c", "-o", "part.o", "part.c"]);
    let arguments: Vec<_> = flags.map(|flag| (*flag).to_owned()).collect();
    demand_success(&compiler.run(folder, &arguments), compiler, &arguments);
    let listed = Command::new("nm").args(["-P", "-A", "part.o"]).current_dir(folder).output().ok()?;
    assert!(listed.status.success());
    let text = String::from_utf8_lossy(&listed.stdout).into_owned();
    assert!(text.contains("part_step"), "{text}");
    Some(text)
}

#[test]
fn no_name_adds_a_symbol() {
    let path = paper_a();
    let planned = PlannedPath::new(&path, 9000).expect("a plan");
    let files_of = |about: &str| {
        let name = CName::try_new("part").expect("a name");
        let files = planned.files_about::<I4F28>(name, false, about.to_owned(), Some(about.to_owned()));
        files.expect("I4F28 holds the path")
    };
    let plain = files_of("part.nc");
    let hostile = NAMES.map(|name| (name, files_of(name)));
    let code = |text: &str| text.split_once("*/").map(|(_, code)| code.to_string());
    for (name, files) in &hostile {
        assert_eq!(code(&files.header), code(&plain.header), "{name:?}");
        assert_eq!(code(&files.source), code(&plain.source), "{name:?}");
    }
    for compiler in compilers() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("part.h"), &plain.header).expect("a file");
        let Some(expected) = symbols(compiler, folder.path(), &plain.source) else {
            println!("nm is not found: the symbols are not compared");
            return;
        };
        let changed = plain.source.clone() + "int injected(void);\nint injected(void){return 666;}\n";
        let found = symbols(compiler, folder.path(), &changed);
        assert_ne!(found.as_ref(), Some(&expected), "a function is seen");
        for (name, files) in &hostile {
            std::fs::write(folder.path().join("part.h"), &files.header).expect("a file");
            let found = symbols(compiler, folder.path(), &files.source);
            assert_eq!(found.as_ref(), Some(&expected), "{}: {name:?}", compiler.command);
        }
    }
}
