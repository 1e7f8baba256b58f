//! Addresses of the kernels: the symbol table of a 32-bit little-endian ELF file.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::Failure;

/// Reads the addresses of all symbols that begin with `k_`.
pub(crate) fn read(image: &Path) -> Result<BTreeMap<String, u32>, Failure> {
    let bytes = fs::read(image).map_err(|e| format!("{}: {e}", image.display()))?;
    symbols(&bytes).ok_or_else(|| format!("{}: not a 32-bit ELF file with symbols", image.display()).into())
}

fn half(bytes: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?)))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

fn symbols(bytes: &[u8]) -> Option<BTreeMap<String, u32>> {
    /// Type of a section that holds a symbol table.
    const SYMBOL_TABLE: u32 = 2;
    /// Size of a symbol: name, value, size, and four bytes of kinds.
    const SYMBOL: usize = 16;
    if !bytes.starts_with(b"\x7fELF\x01\x01") {
        return None;
    }
    let (sections, size, count) = (word(bytes, 0x20)? as usize, half(bytes, 0x2e)?, half(bytes, 0x30)?);
    let section = |index: usize| {
        let at = sections + index * size;
        // Type, offset, size and link.
        Some((
            word(bytes, at + 4)?,
            word(bytes, at + 16)? as usize,
            word(bytes, at + 20)? as usize,
            word(bytes, at + 24)?,
        ))
    };
    let mut found = BTreeMap::new();
    for index in 0..count {
        let (kind, offset, length, link) = section(index)?;
        if kind != SYMBOL_TABLE {
            continue;
        }
        let (_, names, _, _) = section(link as usize)?;
        for at in (offset..offset + length).step_by(SYMBOL) {
            let name = bytes.get(names + word(bytes, at)? as usize..)?;
            let name = std::str::from_utf8(name.split(|b| *b == 0).next()?).ok()?;
            if name.starts_with("k_") {
                // Thumb functions have bit 0 set.
                found.insert(name.to_owned(), word(bytes, at + 4)? & !1);
            }
        }
    }
    Some(found)
}
