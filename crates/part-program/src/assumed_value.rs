//! Values of a machine's file that its control does not state: the file lists them under the key `assumed`.

use domains::Key;
use domains::machine::ASSUMED;
use serde::Serialize;

use crate::toml_table::TableReader;

/// A value of a machine's file that its control does not state: the key `assumed` names it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AssumedValue {
    /// The axis in whose table it is, in small letters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axis: Option<&'static str>,
    /// Its key.
    pub key: &'static str,
    /// The value.
    pub value: f64,
}

/// The values that the key `assumed` of a table names.
pub(crate) fn assumed(
    keys: &mut TableReader<'_, '_, '_>,
    axis: Option<&'static str>,
    known: &[Key],
) -> Vec<AssumedValue> {
    let named = keys.named_numbers(&ASSUMED, known);
    named.into_iter().map(|(key, value)| AssumedValue { axis, key, value }).collect()
}
