//! The examples in `--help` of each subcommand. A test reads every line by the command's own grammar.

pub(crate) const COMPARE: &str = "Examples:
  feedbits compare part.nc --machine router
  feedbits compare part.nc --machine mill.toml
  feedbits compare --formats I8F24,I4F28,f32 --report report
  feedbits compare part.dxf --machine mill.toml --targets cortex-m4f,dsp48
  feedbits compare --json --out comparison.json
  feedbits compare programs --machine router --cache results --json --out set.json";
pub(crate) const INTERPOLATE: &str = "Examples:
  feedbits interpolate part.nc --machine mill.toml --format I4F28 --out setpoints.csv
  feedbits interpolate --format f64 --solver taylor-2";
pub(crate) const COMPILE: &str = "Examples:
  feedbits compile part.nc --machine mill.toml --format I4F28 --out part.rs
  feedbits compile part.nc --machine mill.toml --format I4F28 --stream --buffer 16384 --out part.stream";
pub(crate) const PLAN: &str = "Examples:
  feedbits plan part.nc --machine mill.toml
  feedbits plan --profile s-curve --out plan.csv";
pub(crate) const SIZE: &str = "Examples:
  feedbits size part.nc --machine mill.toml
  feedbits size --fluctuation 1e-5 --json
  feedbits size a.nc b.nc --machine mill.toml";
pub(crate) const SWEEP: &str = "Examples:
  feedbits sweep part.nc --machine mill.toml --period 0.25..4 --feed 10..500 --scale 1..10000
  feedbits sweep --period 0.5..4/4 --feed 50..400/4 --formats I8F24,f32 --evaluate pieces --report maps
  feedbits sweep --feed 10..500/50 --shard 3/8 --out part-3.jsonl";
pub(crate) const MERGE: &str = "Examples:
  feedbits merge part-1.jsonl part-2.jsonl --out all.jsonl --report maps";
pub(crate) const SERVO: &str = "Examples:
  feedbits servo --plot circle.svg
  feedbits servo part.nc --machine mill.toml --formats I4F28,f32";
pub(crate) const PAPERS: &str = "Examples:
  feedbits papers
  feedbits papers --report pictures
  feedbits papers --contour";
pub(crate) const SMOOTH: &str = "Examples:
  feedbits smooth part.nc --machine mill.toml --tolerance 0.01 --out smooth.toml";
pub(crate) const TARGETS: &str = "Examples:
  feedbits targets
  feedbits targets cortex-m4f
  feedbits targets --check";
pub(crate) const CHECK: &str = "Examples:
  feedbits check part.nc --dialect siemens";
pub(crate) const JUDGE: &str = "Examples:
  feedbits judge log.csv --machine mill.toml
  feedbits judge halsampler.txt.gz --machine mill.toml --columns sample=0,x=1,y=2,z=3,line=6 --period 1
  feedbits judge log.csv --machine mill.toml --part part.nc --tolerance 0.01
  feedbits judge motan.json.gz --machine printer.toml --json";
pub(crate) const CONVERT: &str = "Examples:
  feedbits convert part.dxf --to g06.2 --out part.nc
  feedbits convert part.nc --to g1 --tolerance 0.001 --digits 3
  feedbits convert part.nc --fit 0.01 --out curves.nc";
pub(crate) const MACHINE: &str = "Examples:
  feedbits machine
  feedbits machine router --out my-machine.toml
  feedbits machine --from grbl-settings.txt --out my-machine.toml";
pub(crate) const FORMATS: &str = "Examples:
  feedbits formats --json";
pub(crate) const ZOO: &str = "Examples:
  feedbits zoo
  feedbits zoo full-circle
  feedbits zoo --formats f32,I8F24-floor --json";
pub(crate) const COMPLETIONS: &str = "Examples:
  feedbits completions bash --out feedbits.bash
  feedbits completions zsh";

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};

    #[test]
    fn every_subcommand_has_examples_that_it_understands() {
        for command in crate::Arguments::command().get_subcommands().filter(|one| one.get_name() != "help") {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help.lines().filter_map(|line| line.strip_prefix("  ")).collect();
            assert!(!examples.is_empty(), "{} has no example", command.get_name());
            for example in examples {
                let words: Vec<&str> = example.split_whitespace().collect();
                assert_eq!(words[..2], ["feedbits", command.get_name()], "{example}");
                if let Err(error) = crate::Arguments::try_parse_from(&words) {
                    panic!("{example}: {error}");
                }
            }
        }
    }
}
