//! The wrapper that lists every named value: what another implementation of a kernel is compared with, word by word.

use std::cell::RefCell;

use crate::wrapper::{Wrapper, wrapper};
use crate::{Backend, Operation, word_of};

thread_local! {
    static NAMED: RefCell<Vec<(&'static str, u64)>> = const { RefCell::new(Vec::new()) };
}

/// A backend whose named values are listed. It computes exactly as `R` does.
///
/// ```
/// use real::{Backend, I8F24, Named, Real, named_words};
///
/// let (_, named) = named_words(|| Named::<I8F24>::from_f64(1.5).unwrap().signal("x"));
/// assert_eq!(named, [("x", 0x0180_0000)]);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Named<R>(pub R);

/// Runs `work`. Returns its result, and the [bits](crate::word_of) of each value that was named meanwhile on this thread, in
/// order.
///
/// An inner call keeps a list of its own, which the outer call does not see.
pub fn named_words<T>(work: impl FnOnce() -> T) -> (T, Vec<(&'static str, u64)>) {
    let outer = NAMED.take();
    let result = work();
    (result, NAMED.replace(outer))
}

impl<R: Backend> Wrapper for Named<R> {
    type Inner = R;

    fn inner(self) -> R {
        self.0
    }

    fn constant(value: R) -> Self {
        Self(value)
    }

    fn observe(_: Operation, _: &[Self], result: R) -> Self {
        Self(result)
    }

    fn named(self, name: &'static str) -> Self {
        // A register rounds what it is given: the word is what it holds then.
        let held = self.0.signal(name);
        NAMED.with_borrow_mut(|named| named.push((name, word_of(held))));
        Self(held)
    }
}

wrapper!(impl[R: Backend] Named<R>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{I4F28, Real, RuntimeFixed, RuntimeFormat};

    #[test]
    fn words_are_the_bits_that_a_register_holds() {
        let minus = |x: f64| I4F28::from_f64(x).unwrap();
        assert_eq!(word_of(minus(-1.0)), 0xf000_0000);
        assert_eq!((word_of(1.5_f32), word_of(-2.0_f64)), (0x3fc0_0000, 0xc000_0000_0000_0000));
        let narrow = RuntimeFormat::named("I5F13").unwrap();
        let word = narrow.run::<0, _>(|| word_of(RuntimeFixed::<0>::from_f64(-1.0).unwrap()));
        assert_eq!(word, 0x3e000);
    }

    #[test]
    fn an_inner_list_is_its_own() {
        let one = Named(1.0_f64);
        let (inner, outer) = named_words(|| {
            let _ = one.signal("a");
            let (_, inner) = named_words(|| one.signal("b"));
            let _ = one.signal("c");
            inner
        });
        let names =
            |list: Vec<(&'static str, u64)>| list.into_iter().map(|(name, _)| name).collect::<Vec<_>>();
        assert_eq!((names(inner), names(outer)), (vec!["b"], vec!["a", "c"]));
    }
}
