//! The numbers of the command line: each option takes its domain from the table of all keys.

use clap::{Arg, Command};
use domains::{Key, shown};

/// A parser of the number of an option, within its domain.
pub(crate) fn number(
    key: &'static Key,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| within(key, text)
}

/// A parser of the whole number of an option, within its domain.
pub(crate) fn whole<T: TryFrom<u32> + Clone + Send + Sync + 'static>(
    key: &'static Key,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    move |text| {
        let whole = text.trim().parse::<u32>().ok().filter(|whole| key.holds(f64::from(*whole)));
        whole.and_then(|whole| T::try_from(whole).ok()).ok_or_else(|| expected(key))
    }
}

/// The number that a text is, within the domain of a key.
pub(crate) fn within(key: &Key, text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|number| key.holds(*number)).ok_or_else(|| expected(key))
}

/// Why a part of an option's value is refused: the number, and what is expected of it.
pub(crate) fn refusal(key: &Key, number: f64) -> String {
    format!("{}: {}", shown(number), expected(key))
}

fn expected(key: &Key) -> String {
    format!("expected {}", key.expected())
}

/// The command line, with the domain of each number in its help. A negative number behind an option is its value, and what refuses it
/// names the option.
pub(crate) fn with_domains(command: Command) -> Command {
    command.mut_subcommands(|subcommand| {
        let name = subcommand.get_name().to_owned();
        let domain = |long: &str| {
            let option = format!("--{long}");
            let own = format!("{name} {option}");
            let keys = || domains::options::KEYS.iter();
            keys().find(|key| key.name == own).or_else(|| keys().find(|key| key.name == option))
        };
        let ranges: Vec<_> = subcommand
            .get_arguments()
            .filter_map(|argument| {
                let key = domain(argument.get_long()?)?;
                Some((argument.get_id().clone(), format!("{} [{}]", argument.get_help()?, key.range())))
            })
            .collect();
        let takes_value =
            |argument: &Arg| argument.get_long().is_some() && argument.get_action().takes_values();
        ranges
            .into_iter()
            .fold(subcommand, |subcommand, (id, help)| subcommand.mut_arg(id, |argument| argument.help(help)))
            .mut_args(|argument| {
                let negative = takes_value(&argument);
                argument.allow_negative_numbers(negative)
            })
    })
}
