//! The words of each format for operators and defuzzifiers.

use fuzzy::model::{Aggregation, Conjunction, Defuzzifier, Disjunction};

use crate::Format;

/// A value, and its words in FIS, FLL, FCL and FML. Alternatives are separated by `|`; the first is written and all are
/// read.
pub(crate) type Words<T> = [(T, [&'static str; 4])];

/// The words for conjunctions, which are also the words for implications.
pub(crate) const CONJUNCTIONS: &Words<Conjunction> = &[
    (Conjunction::Minimum, ["min", "Minimum", "MIN", "MIN"]),
    (
        Conjunction::Product,
        ["prod|algebraic_product", "AlgebraicProduct", "PROD", "PROD"],
    ),
    (
        Conjunction::BoundedDifference,
        ["bounded_difference", "BoundedDifference", "BDIF", "BDIF"],
    ),
    (
        Conjunction::Drastic,
        ["drastic_product", "DrasticProduct", "DMIN|DPROD", "DRP"],
    ),
    (
        Conjunction::Einstein,
        ["einstein_product", "EinsteinProduct", "EPROD", "EPROD"],
    ),
    (
        Conjunction::Hamacher,
        [
            "hamacher_product",
            "HamacherProduct",
            "HPROD|HAMACHER",
            "HPROD",
        ],
    ),
    (
        Conjunction::NilpotentMinimum,
        [
            "nilpotent_minimum",
            "NilpotentMinimum",
            "NMIN|NIPMIN",
            "NILMIN",
        ],
    ),
];

pub(crate) const DISJUNCTIONS: &Words<Disjunction> = &[
    (Disjunction::Maximum, ["max", "Maximum", "MAX", "MAX"]),
    (
        Disjunction::ProbabilisticSum,
        [
            "probor|algebraic_sum",
            "AlgebraicSum",
            "ASUM|PROBOR",
            "PROBOR",
        ],
    ),
    (
        Disjunction::BoundedSum,
        ["bounded_sum", "BoundedSum", "BSUM", "BSUM"],
    ),
    (
        Disjunction::Drastic,
        ["drastic_sum", "DrasticSum", "DMAX|DSUM", "DRS"],
    ),
    (
        Disjunction::Einstein,
        ["einstein_sum", "EinsteinSum", "ESUM", "ESUM"],
    ),
    (
        Disjunction::Hamacher,
        ["hamacher_sum", "HamacherSum", "HSUM", "HSUM"],
    ),
    (
        Disjunction::NilpotentMaximum,
        [
            "nilpotent_maximum",
            "NilpotentMaximum",
            "NMAX|NIPMAX",
            "NILMAX",
        ],
    ),
];

pub(crate) const AGGREGATIONS: &Words<Aggregation> = &[
    (Aggregation::Maximum, ["max", "Maximum", "MAX", "MAX"]),
    (
        Aggregation::ProbabilisticSum,
        [
            "probor|algebraic_sum",
            "AlgebraicSum",
            "ASUM|PROBOR",
            "PROBOR",
        ],
    ),
    (
        Aggregation::BoundedSum,
        ["bounded_sum", "BoundedSum|NormalizedSum", "BSUM", "BSUM"],
    ),
    (Aggregation::Sum, ["sum", "UnboundedSum", "SUM|NSUM", ""]),
    (
        Aggregation::Drastic,
        ["drastic_sum", "DrasticSum", "DMAX|DSUM", "DRS"],
    ),
    (
        Aggregation::Einstein,
        ["einstein_sum", "EinsteinSum", "ESUM", "ESUM"],
    ),
    (
        Aggregation::Hamacher,
        ["hamacher_sum", "HamacherSum", "HSUM", "HSUM"],
    ),
    (
        Aggregation::NilpotentMaximum,
        [
            "nilpotent_maximum",
            "NilpotentMaximum",
            "NMAX|NIPMAX",
            "NILMAX",
        ],
    ),
];

/// The words for defuzzifiers. FCL's `COGS` and fuzzylite's `WeightedAverage` apply to singletons and constants.
pub(crate) const DEFUZZIFIERS: &Words<Defuzzifier> = &[
    (
        Defuzzifier::Centroid,
        ["centroid", "Centroid", "COG", "COG"],
    ),
    (
        Defuzzifier::Bisector,
        ["bisector", "Bisector", "COA", "COA"],
    ),
    (
        Defuzzifier::SmallestOfMaxima,
        ["som", "SmallestOfMaximum", "LM", "LM"],
    ),
    (
        Defuzzifier::MeanOfMaxima,
        ["mom", "MeanOfMaximum", "MM", "MOM"],
    ),
    (
        Defuzzifier::LargestOfMaxima,
        ["lom", "LargestOfMaximum", "RM", "RM"],
    ),
    (
        Defuzzifier::WeightedAverage,
        ["wtaver", "WeightedAverage", "COGS", "WA"],
    ),
    (
        Defuzzifier::WeightedSum,
        ["wtsum", "WeightedSum", "COGSS", ""],
    ),
    // fuzzylite derives the defuzzifier from the terms.
    (Defuzzifier::Tsukamoto, ["", "WeightedAverage", "", ""]),
];

/// Whether a character may occur within a line of text and in XML.
pub(crate) fn is_printable(c: char) -> bool {
    !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}' | '\u{2028}' | '\u{2029}')
}

/// Whether a word is a name that needs no quotes: a letter, then letters, digits and `_`.
pub(crate) fn is_name(word: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && word.chars().all(is_letter)
}

/// Whether the defuzzifier is a weighted mean or sum of one number per rule.
pub(crate) fn is_weighted(defuzzifier: Defuzzifier) -> bool {
    matches!(
        defuzzifier,
        Defuzzifier::WeightedAverage | Defuzzifier::WeightedSum | Defuzzifier::Tsukamoto
    )
}

/// The value of a word in a format; case is ignored.
pub(crate) fn value<T: Copy>(words: &Words<T>, format: Format, word: &str) -> Option<T> {
    let of = |entry: &&(T, [&'static str; 4])| {
        entry.1[format as usize]
            .split('|')
            .any(|known| !known.is_empty() && known.eq_ignore_ascii_case(word))
    };
    words.iter().find(of).map(|entry| entry.0)
}

/// The word for a value in a format; `None` if it has none.
pub(crate) fn word<T: Copy + PartialEq>(
    words: &Words<T>,
    format: Format,
    value: T,
) -> Option<&'static str> {
    let entry = words.iter().find(|entry| entry.0 == value)?;
    entry.1[format as usize]
        .split('|')
        .next()
        .filter(|word| !word.is_empty())
}

/// All words of a format, for help.
pub(crate) fn all<T>(words: &Words<T>, format: Format) -> Vec<&'static str> {
    let words = words.iter().map(|entry| entry.1[format as usize]);
    let words = words.flat_map(|words| words.split('|'));
    let mut all = vec![];
    for word in words.filter(|word| !word.is_empty()) {
        if !all.contains(&word) {
            all.push(word);
        }
    }
    all
}
