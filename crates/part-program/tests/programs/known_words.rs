//! The book's page of words is made from the reader's own table, and no word is read that is not in it.

use std::fmt::Write;

use expect_test::expect_file;
use part_program::{Dialect, ReadOptions, WordUse, known_words, read_part_with};

const CONTROLS: [Option<Dialect>; 4] =
    [Some(Dialect::Fanuc), Some(Dialect::LinuxCnc), Some(Dialect::Siemens), None];

const HEAD: &str = "# Words

You have a word of a program, and you want to know what `feedbits` makes of it on your control.

- *read*: it is executed.
- *passed*: it has no effect on the path. `convert` counts it among what it leaves out, unless it switches off what is off anyway.
- *left out*: it is an error. With `--lenient` its block is left out, and nothing moves until its axes are named again.
- *refused*: it is an error, with `--lenient` too.

A G word that is not here is left out on every control. At an M word that is not here the tool rests, and `convert` keeps it. \"Not named\"
is of a program whose control is not named, neither by `--dialect` nor by its words.

| word | FANUC | LinuxCNC | Siemens | not named | what it does |
|---|---|---|---|---|---|
";

fn shown(word_use: WordUse) -> &'static str {
    match word_use {
        WordUse::Read => "read",
        WordUse::Passed => "passed",
        WordUse::LeftOut => "left out",
        WordUse::Refused => "refused",
    }
}

#[test]
fn the_page_of_words_is_the_table() {
    let mut page = HEAD.to_owned();
    for word in known_words() {
        let [fanuc, linuxcnc, siemens, unnamed] = word.uses.map(shown);
        let name = format!("{}{}", word.letter, word.number);
        writeln!(page, "| `{name}` | {fanuc} | {linuxcnc} | {siemens} | {unnamed} | {} |", word.meaning)
            .unwrap();
    }
    expect_file!["../../../../docs/words.md"].assert_eq(&page);
}

/// Whatever stands beside it, a word that is read is one that the table lets in.
#[test]
fn no_word_is_read_that_is_not_in_the_table() {
    let known = known_words();
    let numbers = (0..=1200).chain((1210..=9990).step_by(10)).map(|tenths| f64::from(tenths) / 10.0);
    for number in numbers {
        for (index, dialect) in CONTROLS.into_iter().enumerate() {
            let uses = known.iter().filter(|word| word.letter == 'G' && word.number == number);
            let is_let_in = uses
                .map(|word| word.uses[index])
                .any(|found| matches!(found, WordUse::Read | WordUse::Passed));
            for words in ["", "X3 Y3 Z3 R4", "P1", "Q1 P2", "L2 P1 X1", "I2 J0"] {
                let text = format!("G0 X0 Y0 Z0\nG1 X1 F60\nG{number} {words}\nG1 X2 Y0\n");
                let read = |lenient| {
                    read_part_with("p", &text, ReadOptions { dialect, lenient, ..ReadOptions::default() })
                };
                assert!(read(false).is_err() || is_let_in, "{dialect:?}: {text}");
                if read(false).is_err() && read(true).is_ok() {
                    assert!(
                        !read(true).unwrap().warnings.is_empty(),
                        "{dialect:?}: left out in silence: {text}"
                    );
                }
            }
        }
    }
}

/// Where the table lets a word in, some block with it is read.
#[test]
fn every_word_of_the_table_is_read_in_some_block() {
    let blocks = [
        "",
        "X3 Y3",
        "X3 Y3 F2\nG94",
        "X3 Y0 R4",
        "X3 Y3 Z-3 R4 Q1",
        "P0",
        "P7",
        "Q1",
        "L2 P1 X1",
        "X2 Y1 I1 J0 P1 Q1",
        "X2 Y1 I1 J1",
        "X2 Z1 K1",
        "P2 K0 X1 Y0\nK0 X5\nK1\nK1",
        "P1\nX4 Y4 P1\nX5 Y0 P1\nG5.3",
        "\nG1 X3 E1\nM83",
        "D0.1",
    ];
    let ends = "M30\nO7\nG1 X9\nM99\n";
    for word in known_words().iter().filter(|word| word.letter == 'G') {
        for (dialect, found) in CONTROLS.into_iter().zip(word.uses) {
            if !matches!(found, WordUse::Read | WordUse::Passed) {
                continue;
            }
            let is_read = blocks.iter().any(|block| {
                ["", "G1 X1 E1\n", "G5.2 P1\nX2 Y2 P1\nX3 Y0 P1\n"].iter().any(|before| {
                    let text = format!(
                        "G0 X0 Y0 Z5\nG1 X1 F60 S9\n{before}G{} {block}\nG1 X2 Y0\n{ends}",
                        word.number
                    );
                    read_part_with("p", &text, ReadOptions { dialect, ..ReadOptions::default() }).is_ok()
                })
            });
            assert!(is_read, "{dialect:?} G{}", word.number);
        }
    }
}
