//! Converts names of a rule set to words for readers.

use fuzzy::drawing::visible;

/// The name of an input or output as words: `battery_risk` is "battery risk".
pub(crate) fn words_of(name: &str) -> String {
    visible(name).replace('_', " ")
}
