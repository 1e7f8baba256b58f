//! The components of a vector and the terms of a sum of products, by number.

use real::Real;

/// A vector, component by component.
///
/// `array::from_fn` and `array::map` would give the same. But where a crate is compiled in several units without optimisation over
/// units, parts of them are functions to call, number by number.
#[inline(always)]
pub(crate) fn vector<R: Real, const D: usize>(of: impl Fn(usize) -> R) -> [R; D] {
    let mut components = [R::zero(); D];
    for (d, component) in components.iter_mut().enumerate() {
        *component = of(d);
    }
    components
}

/// Pairs of factors: one by itself if there is one, then those of numbers 0, 1, …
///
/// A chain of a map would give the same pairs. But the folds of these are functions to call where a crate is compiled in
/// several units without optimisation over units, and a step would then pass its numbers through memory.
pub(crate) struct Terms<T, F> {
    first: Option<T>,
    next: usize,
    count: usize,
    of: F,
}

impl<T, F: FnMut(usize) -> T> Terms<T, F> {
    /// `count` terms.
    #[inline(always)]
    pub(crate) fn of(count: usize, of: F) -> Self {
        Self { first: None, next: 0, count, of }
    }

    /// The same terms behind another one.
    #[inline(always)]
    pub(crate) fn behind(self, first: T) -> Self {
        Self { first: Some(first), ..self }
    }
}

impl<T, F: FnMut(usize) -> T> Iterator for Terms<T, F> {
    type Item = T;

    #[inline(always)]
    fn next(&mut self) -> Option<T> {
        if let Some(first) = self.first.take() {
            return Some(first);
        }
        let number = self.next;
        (number < self.count).then(|| {
            self.next = number + 1;
            (self.of)(number)
        })
    }

    #[inline(always)]
    fn fold<B, G: FnMut(B, T) -> B>(mut self, start: B, mut sum: G) -> B {
        let mut sum_so_far = match self.first {
            Some(first) => sum(start, first),
            None => start,
        };
        for number in self.next..self.count {
            sum_so_far = sum(sum_so_far, (self.of)(number));
        }
        sum_so_far
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_by_one_and_folded_they_are_the_same_terms() {
        let terms = || Terms::of(3, |number| 10 * number).behind(7);
        assert_eq!(terms().collect::<Vec<_>>(), [7, 0, 10, 20]);
        assert_eq!(terms().fold(0, |sum, term| 2 * sum + term), 2 * (2 * (2 * 7) + 10) + 20);
        let mut begun = terms();
        assert_eq!([begun.next(), begun.next()], [Some(7), Some(0)]);
        assert_eq!(begun.fold(1, |sum, term| 100 * sum + term), 11_020);
    }
}
