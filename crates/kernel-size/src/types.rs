//! The registers of a sizing as types of a language.

use real::Datapath;
use register_types::{Language, Register, Types, identifier};

use crate::size::Sizing;

impl Sizing {
    /// A file of the registers as types of a language, whose names begin with the kernel's; `None` if there are no registers.
    /// The datapath is the one that was sized for.
    #[must_use]
    pub fn types(&self, language: Language, datapath: Datapath) -> Option<String> {
        let registers = self.registers.as_ref()?;
        let mut names: Vec<String> = Vec::new();
        for register in &registers.signals {
            let name = identifier(register.signal);
            let mut others = (2..).map(|number| format!("{name}_{number}"));
            let is_new = |name: &String| !names.contains(name);
            let name = if is_new(&name) { name } else { others.find(is_new).unwrap_or_default() };
            names.push(name);
        }
        let typed = registers.signals.iter().zip(&names);
        let typed = typed.filter_map(|(one, name)| Register::named(name, &one.format, one.bound));
        let about = [
            format!("Kernel {}: {} registers of {} bits in all.", self.kernel, names.len(), registers.bits),
            format!("Sized by kernel-size, version {}.", env!("CARGO_PKG_VERSION")),
            String::new(),
            format!("Every requirement is met over {} steps if each signal is rounded to its", self.steps),
            "type wherever it is named, and the operators between two signals are exact to 53".to_string(),
            "bits. A type holds the values that its signal had; nothing is proved of others.".to_string(),
        ];
        let any = names.first().map_or("x", String::as_str);
        let types = Types {
            registers: &typed.collect::<Vec<_>>(),
            datapath,
            prefix: &identifier(self.kernel),
            about: &about,
            example: [any; 3],
        };
        Some(types.in_language(language))
    }
}
