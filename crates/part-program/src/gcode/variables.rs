//! Variables of a program: `#5`, `#<name>`, and `R5` of Siemens.
//!
//! Variables 1 to 30 belong to a subprogram that LinuxCNC's `call` calls, 1 to 33 to one of FANUC's G65; all others
//! belong to the program. A name belongs to its subprogram, unless it begins with `_`.
//!
//! # Source
//! LinuxCNC, "Parameters" and "Subroutine parameters"; FANUC Series 30i, B-63944EN/03, section 16.1; SINUMERIK 840D sl, "Arithmetic
//! parameters (R)".

use std::collections::HashMap;

/// A value; `None` for a vacant variable.
pub(crate) type Value = Option<f64>;

/// Highest number of a variable; controls have fewer.
pub(crate) const HIGHEST: u32 = 99_999;
/// Number of a subprogram's own variables, for FANUC's G65.
pub(crate) const FANUC_LOCALS: usize = 33;
/// Number of a subprogram's own variables, for LinuxCNC's `call`.
pub(crate) const LINUXCNC_LOCALS: usize = 30;

/// The name of a variable in a program.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Variable {
    /// `#5`.
    Number(u32),
    /// `#<name>`, in lower case and without spaces.
    Name(Box<str>),
    /// `R5` of Siemens.
    R(u32),
}

/// The own variables of a subprogram, or of the program itself.
struct Locals {
    numbers: [Option<f64>; FANUC_LOCALS],
    /// How many numbers are its own; the others are those of its caller.
    count: usize,
    names: HashMap<Box<str>, f64>,
}

impl Locals {
    fn new(count: usize) -> Self {
        Self { numbers: [None; FANUC_LOCALS], count, names: HashMap::new() }
    }
}

/// The values of variables.
pub(crate) struct Variables {
    numbers: HashMap<u32, f64>,
    names: HashMap<Box<str>, f64>,
    r: HashMap<u32, f64>,
    /// The variables of the program, then those of each subprogram that has been called and has not returned.
    locals: Vec<Locals>,
    /// Calls that have not returned.
    pub(crate) calls: usize,
}

impl Default for Variables {
    fn default() -> Self {
        let (numbers, names, r) = (HashMap::new(), HashMap::new(), HashMap::new());
        Self { numbers, names, r, locals: vec![Locals::new(FANUC_LOCALS)], calls: 0 }
    }
}

impl Variables {
    /// The value of a variable; `None` if it has none.
    pub(crate) fn get(&self, variable: &Variable) -> Option<f64> {
        let locals = self.locals.last()?;
        match variable {
            Variable::Number(number) => match local(*number) {
                Some(index) => self.owner(index)?.numbers[index],
                None => self.numbers.get(number).copied(),
            },
            Variable::Name(name) if name.starts_with('_') => self.names.get(name).copied(),
            Variable::Name(name) => locals.names.get(name).copied(),
            Variable::R(number) => self.r.get(number).copied(),
        }
    }

    /// Gives a variable its value; `None` empties it.
    pub(crate) fn set(&mut self, variable: Variable, value: Option<f64>) {
        let Some(locals) = self.locals.last_mut() else { return };
        match variable {
            Variable::Number(number) => match local(number) {
                Some(index) => {
                    if let Some(owner) = self.locals.iter_mut().rev().find(|locals| index < locals.count) {
                        owner.numbers[index] = value;
                    }
                }
                None => give(&mut self.numbers, number, value),
            },
            Variable::Name(name) if name.starts_with('_') => give(&mut self.names, name, value),
            Variable::Name(name) => give(&mut locals.names, name, value),
            Variable::R(number) => give(&mut self.r, number, value),
        }
    }

    /// The owner of a number that may belong to a subprogram.
    fn owner(&self, index: usize) -> Option<&Locals> {
        self.locals.iter().rev().find(|locals| index < locals.count)
    }

    /// Begins a subprogram whose variables 1 to `count` are its own, of which the `arguments` have values.
    pub(crate) fn enter(&mut self, count: usize, arguments: &[(u32, f64)]) {
        let mut locals = Locals::new(count);
        for (number, value) in arguments {
            if let Some(index) = local(*number) {
                locals.numbers[index] = Some(*value);
            }
        }
        self.locals.push(locals);
    }

    /// Ends the subprogram that was entered last.
    pub(crate) fn leave(&mut self) {
        if self.locals.len() > 1 {
            self.locals.pop();
        }
    }
}

/// Index of a variable that belongs to a subprogram.
fn local(number: u32) -> Option<usize> {
    let index = (number as usize).checked_sub(1)?;
    (index < FANUC_LOCALS).then_some(index)
}

fn give<K: std::hash::Hash + Eq>(values: &mut HashMap<K, f64>, key: K, value: Option<f64>) {
    match value {
        Some(value) => drop(values.insert(key, value)),
        None => drop(values.remove(&key)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_subprogram_has_variables_of_its_own() {
        let mut variables = Variables::default();
        let [first, shared] = [1, 100].map(Variable::Number);
        let [name, global] = ["depth", "_depth"].map(|name| Variable::Name(name.into()));
        for (index, variable) in [&first, &shared, &name, &global].into_iter().enumerate() {
            variables.set(variable.clone(), Some(f64::from(u8::try_from(index).unwrap())));
        }
        variables.enter(FANUC_LOCALS, &[(1, 7.0), (33, 8.0)]);
        assert_eq!(
            [&first, &shared, &name, &global].map(|v| variables.get(v)),
            [Some(7.0), Some(1.0), None, Some(3.0)]
        );
        variables.set(first.clone(), None);
        variables.set(shared.clone(), Some(5.0));
        assert_eq!(variables.get(&Variable::Number(33)), Some(8.0));
        variables.leave();
        assert_eq!([&first, &shared, &name].map(|v| variables.get(v)), [Some(0.0), Some(5.0), Some(2.0)]);
        // LinuxCNC keeps 30 of them apart.
        let [last, next] = [30, 31].map(Variable::Number);
        variables.set(next.clone(), Some(4.0));
        variables.enter(LINUXCNC_LOCALS, &[]);
        assert_eq!([&last, &next].map(|v| variables.get(v)), [None, Some(4.0)]);
        variables.set(next.clone(), Some(6.0));
        variables.leave();
        assert_eq!(variables.get(&next), Some(6.0));
    }
}
