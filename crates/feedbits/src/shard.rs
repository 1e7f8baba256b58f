//! Shards: the share of a sweep, or of a set of parts, that one job of an array runs.

use std::path::PathBuf;
use std::str::FromStr;

use domains::options::SHARDS;

/// Shard i of n, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    index: usize,
    count: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts =
            text.split_once('/').and_then(|(i, n)| Some((i.parse::<u32>().ok()?, n.parse::<u32>().ok()?)));
        parts
            .filter(|(index, count)| {
                index <= count && [*index, *count].iter().all(|n| SHARDS.holds(f64::from(*n)))
            })
            .map(|(index, count)| Self { index: index as usize, count: count as usize })
            .ok_or_else(|| format!("{text:?}: expected I/N with 1 ≤ I ≤ N ≤ 1,000,000, as in 2/8"))
    }
}

impl Shard {
    /// Whether a cell, or a part, is of this shard.
    pub(crate) fn has(self, cell: usize) -> bool {
        cell % self.count == self.index - 1
    }

    /// Each shard has its own file, since shards may run at the same time. `of` is what is sharded.
    pub(crate) fn file(self, of: &str) -> PathBuf {
        match self {
            Self { count: 1, .. } => format!("{of}.jsonl").into(),
            Self { index, count } => format!("{of}-{index}-of-{count}.jsonl").into(),
        }
    }

    /// Whether it is not all.
    pub(crate) fn is_part(self) -> bool {
        self.count > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_the_cells_without_rest() {
        let shards: Vec<Shard> = (1..=3).map(|i| format!("{i}/3").parse().expect("a shard")).collect();
        assert!((0..100).all(|cell| shards.iter().filter(|shard| shard.has(cell)).count() == 1));
        assert!(["0/2", "3/2", "1", "a/b", "1/0"].iter().all(|wrong| wrong.parse::<Shard>().is_err()));
    }
}
