//! Numbers by which texts are told apart.

/// A number of 64 bits that almost certainly differs for different texts: the hash of Fowler, Noll and Vo, version 1a,
/// which is the same on every machine and at any time.
pub(crate) fn fingerprint(text: impl Iterator<Item = u8>) -> String {
    let hash = text.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// The same, of a text at hand.
pub(crate) fn fingerprint_of(text: &str) -> String {
    fingerprint(text.bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published test values of the hash.
    #[test]
    fn fingerprints_are_those_of_fnv_1a() {
        assert_eq!(["", "a"].map(fingerprint_of), ["cbf29ce484222325", "af63dc4c8601ec8c"]);
        assert_eq!(fingerprint_of("foobar"), "85944171f73967e8");
    }
}
