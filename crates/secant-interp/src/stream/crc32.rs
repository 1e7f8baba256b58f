//! The checksum that finds damaged bytes.

/// CRC-32 of some bytes, as streams have it.
///
/// It is the remainder of the bytes, as a polynomial over bits, by `x³² + x²⁶ + x²³ + x²² + x¹⁶ + x¹² + x¹¹ + x¹⁰ + x⁸ +
/// x⁷ + x⁵ + x⁴ + x² + x + 1`; bits run from low to high, and all bits are turned before the first byte and behind the
/// last. It tells each change of up to 32 bits in a row, and of any other change all but one in 2³².
///
/// # Source
/// IEEE 802.3, clause 3.2.9. Four bits are taken at a time: a table of 64 bytes serves a controller better than one of 1024.
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = !0_u32;
    for byte in bytes {
        crc ^= u32::from(*byte);
        crc = (crc >> 4) ^ REMAINDERS[(crc & 15) as usize];
        crc = (crc >> 4) ^ REMAINDERS[(crc & 15) as usize];
    }
    !crc
}

/// The remainders of all words of four bits.
const REMAINDERS: [u32; 16] = remainders();

const fn remainders() -> [u32; 16] {
    let mut table = [0; 16];
    let mut word = 0;
    while word < 16 {
        let mut remainder = word;
        let mut bit = 0;
        while bit < 4 {
            let is_odd = remainder & 1 == 1;
            remainder = (remainder >> 1) ^ if is_odd { 0xedb8_8320 } else { 0 };
            bit += 1;
        }
        table[word as usize] = remainder;
        word += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::crc32;

    /// The first is the check value of the CRC's catalogues, the others are zlib's.
    #[test]
    fn it_is_the_crc_of_everybody() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
        assert_eq!(crc32(b""), 0);
        assert_eq!(crc32(&[0; 32]), 0x190a_55ad);
        assert_eq!(crc32(&[0xff; 32]), 0xff6c_ab0b);
    }
}
