//! Words of other programs for shapes, operators, defuzzifiers, keys and hedges.

use alloc::{string::String, vec::Vec};

/// The words of MATLAB's Fuzzy Logic Toolbox, scikit-fuzzy, fuzzylite and IEC 61131-7, in lower case without `_`, `-`
/// and blanks, with the equivalent words of this format. If a word has several equivalents, those that are valid at
/// its position are used.
pub(crate) const WORDS: &[(&str, &[&str])] = &[
    // Membership functions.
    ("trimf", &["triangle"]),
    ("trapmf", &["trapezoid"]),
    ("linzmf", &["left_shoulder"]),
    ("linsmf", &["right_shoulder"]),
    ("ramp", &["right_shoulder", "left_shoulder"]),
    ("gaussmf", &["gaussian"]),
    ("gauss2mf", &["gaussian2"]),
    ("gaussianproduct", &["gaussian2"]),
    ("gbellmf", &["bell"]),
    ("sigmf", &["sigmoid"]),
    ("dsigmf", &["sigmoid_difference"]),
    ("psigmf", &["sigmoid_product"]),
    ("smf", &["s_shape"]),
    ("zmf", &["z_shape"]),
    ("pimf", &["pi_shape"]),
    ("piecemf", &["piecewise"]),
    ("discrete", &["piecewise"]),
    ("points", &["piecewise"]),
    ("binary", &["right_shoulder", "left_shoulder"]),
    ("spikemf", &["spike"]),
    // Parameters of membership functions.
    ("mu", &["mean"]),
    ("c", &["mean", "center", "inflection", "constant"]),
    ("centre", &["center", "mean", "inflection"]),
    ("center", &["mean", "inflection"]),
    ("mean", &["center", "mean_of_maxima"]),
    ("sigma", &["sd"]),
    ("sig", &["sd"]),
    ("min", &["range", "minimum"]),
    ("max", &["range", "maximum"]),
    ("std", &["sd"]),
    ("stddev", &["sd", "std"]),
    ("standarddeviation", &["sd", "std"]),
    ("const", &["constant"]),
    ("value", &["constant"]),
    ("number", &["constant"]),
    ("umf", &["upper"]),
    ("lmf", &["lower"]),
    // Statistics of a profile.
    ("average", &["mean", "weighted_average"]),
    ("avg", &["mean"]),
    ("stdev", &["std"]),
    ("sd", &["std"]),
    ("variance", &["std"]),
    // Operators.
    ("fmin", &["minimum"]),
    ("fmax", &["maximum"]),
    ("zadeh", &["minimum", "maximum"]),
    ("mamdani", &["minimum"]),
    ("larsen", &["product"]),
    ("prod", &["product"]),
    ("algebraicproduct", &["product"]),
    ("probor", &["probabilistic_sum"]),
    ("asum", &["probabilistic_sum"]),
    ("algebraicsum", &["probabilistic_sum"]),
    ("bdif", &["bounded_difference"]),
    ("bsum", &["bounded_sum"]),
    ("lukasiewicz", &["bounded_difference", "bounded_sum"]),
    ("unboundedsum", &["sum"]),
    ("nsum", &["sum"]),
    ("normalizedsum", &["bounded_sum"]),
    ("dmin", &["drastic"]),
    ("dmax", &["drastic"]),
    ("drasticproduct", &["drastic"]),
    ("drasticsum", &["drastic"]),
    ("eprod", &["einstein"]),
    ("esum", &["einstein"]),
    ("einsteinproduct", &["einstein"]),
    ("einsteinsum", &["einstein"]),
    ("hprod", &["hamacher"]),
    ("hsum", &["hamacher"]),
    ("hamacherproduct", &["hamacher"]),
    ("hamachersum", &["hamacher"]),
    ("nmin", &["nilpotent_minimum"]),
    ("nmax", &["nilpotent_maximum"]),
    // Defuzzifiers.
    ("cog", &["centroid"]),
    ("centerofgravity", &["centroid"]),
    ("centreofgravity", &["centroid"]),
    ("coa", &["centroid", "bisector"]),
    ("centerofarea", &["bisector"]),
    ("centreofarea", &["bisector"]),
    ("cogs", &["centroid"]),
    ("wtaver", &["weighted_average"]),
    ("wtsum", &["weighted_sum"]),
    ("mom", &["mean_of_maxima"]),
    ("mm", &["mean_of_maxima"]),
    ("som", &["smallest_of_maxima"]),
    ("lm", &["smallest_of_maxima"]),
    ("lom", &["largest_of_maxima"]),
    ("rm", &["largest_of_maxima"]),
    // Keys.
    ("mfs", &["terms"]),
    ("membershipfunctions", &["terms"]),
    ("universe", &["range"]),
    ("version", &["fuzzy"]),
    ("cmd", &["command"]),
    ("reason", &["because"]),
    ("default", &["when_no_rule_fires", "if_missing"]),
    ("defaultvalue", &["when_no_rule_fires"]),
    ("method", &["defuzzifier"]),
    ("defuzzmethod", &["defuzzifier"]),
    ("andmethod", &["and"]),
    ("conjunction", &["and"]),
    ("tnorm", &["and"]),
    ("ormethod", &["or"]),
    ("disjunction", &["or"]),
    ("snorm", &["or"]),
    ("impmethod", &["implication"]),
    ("activation", &["implication"]),
    ("act", &["implication"]),
    ("aggmethod", &["aggregation"]),
    ("accumulation", &["aggregation"]),
    ("accu", &["aggregation"]),
    // Hedges.
    ("slightly", &["somewhat"]),
    ("fairly", &["somewhat"]),
    ("rather", &["somewhat"]),
    ("quite", &["somewhat"]),
    ("highly", &["very"]),
    ("intensify", &["extremely"]),
];

/// The letters of the parameters of membership functions in MATLAB and scikit-fuzzy, with the equivalent names in this
/// format.
const LETTERS: &[(&str, &[(&str, &str)])] = &[
    ("bell", &[("a", "width"), ("b", "slope"), ("c", "center")]),
    ("sigmoid", &[("a", "slope"), ("c", "inflection")]),
];

/// Keys of other programs whose information belongs elsewhere in a rule set, with a suggestion.
const ELSEWHERE: &[(&str, &str)] = &[
    (
        "weight",
        "write the weight at the end of the rule: `IF ... THEN ... WITH 0.8`",
    ),
    (
        "type",
        "remove it: the defuzzifier of an output determines its type: Takagi-Sugeno for `weighted_average` and `weighted_sum`, \
         Tsukamoto for `tsukamoto`, otherwise Mamdani",
    ),
    (
        "defuzzmethod",
        "move it to an output: each output has its own `defuzzifier`",
    ),
    (
        "defuzzifier",
        "move it to an output: each output has its own `defuzzifier`",
    ),
    (
        "<<",
        "merge keys are not supported: write out all keys; to reuse a single value, mark it with `&name` and refer to it with `*name`",
    ),
    (
        "implication",
        "move it to the `operators` of the rule set: `operators: {implication: product}`",
    ),
    (
        "aggregation",
        "move it to an output, or to the `operators` of the rule set",
    ),
    ("andmethod", "write `operators: {and: minimum}`"),
    ("ormethod", "write `operators: {or: maximum}`"),
];

fn folded(word: &str) -> String {
    word.chars()
        .filter(|c| !matches!(c, '_' | '-' | ' '))
        .map(|c| c.to_ascii_lowercase())
        .collect()
}

/// Returns the candidates that are equivalent to another program's word.
pub(crate) fn equivalents<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Vec<&'a str> {
    let word = folded(word);
    let known = WORDS.iter().find(|(other, _)| *other == word);
    let meanings = known.map_or(&[][..], |(_, meanings)| meanings);
    let is_meant = |candidate: &&str| {
        let candidate = folded(candidate);
        candidate == word || meanings.iter().any(|meaning| folded(meaning) == candidate)
    };
    candidates.into_iter().filter(is_meant).collect()
}

/// Returns the parameter of a membership function that a key refers to. The key may be the name of the parameter, its
/// letter, or its name in another program.
pub(crate) fn parameter<'a>(function: &str, key: &str, names: &[&'a str]) -> Option<&'a str> {
    let letters = LETTERS.iter().find(|(name, _)| *name == function);
    let mut letters = letters.map_or(&[][..], |(_, letters)| letters).iter();
    let named = |name: &str| names.iter().copied().find(|known| *known == name);
    let of_letter = letters
        .find(|(letter, _)| *letter == key)
        .map(|(_, name)| *name);
    named(key)
        .or_else(|| named(of_letter?))
        .or_else(|| equivalents(key, names.iter().copied()).first().copied())
}

/// Returns a suggestion for a key whose information belongs elsewhere.
pub(crate) fn belongs_elsewhere(key: &str) -> Option<&'static str> {
    let key = folded(key);
    let found = ELSEWHERE.iter().find(|(other, _)| *other == key);
    found.map(|(_, help)| *help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_foreign_word_is_lower_case_and_listed_once() {
        for (i, (word, meanings)) in WORDS.iter().enumerate() {
            assert_eq!(folded(word), *word);
            assert!(!meanings.is_empty(), "{word}");
            assert!(WORDS[..i].iter().all(|(other, _)| other != word), "{word}");
        }
    }

    #[test]
    fn the_meaning_of_a_foreign_word_depends_on_its_position() {
        let or = ["maximum", "bounded_sum"];
        let and = ["minimum", "bounded_difference"];
        assert_eq!(equivalents("Lukasiewicz", or), ["bounded_sum"]);
        assert_eq!(equivalents("Lukasiewicz", and), ["bounded_difference"]);
        assert_eq!(equivalents("BoundedSum", or), ["bounded_sum"]);
        assert!(equivalents("trimf", or).is_empty());
    }
}
