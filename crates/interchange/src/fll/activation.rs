//! Activation methods of FLL: `General`, `First 1 0.0`, `Highest 2`, `Threshold >= 0.5`.

use fuzzy::model::{Activation, Comparison};

const COMPARISONS: [(&str, Comparison); 6] = [
    ("<", Comparison::Below),
    ("<=", Comparison::AtMost),
    ("==", Comparison::Equal),
    ("!=", Comparison::NotEqual),
    (">=", Comparison::AtLeast),
    (">", Comparison::Above),
];

/// All methods, for help.
pub(super) const METHODS: [&str; 7] = [
    "General",
    "First",
    "Last",
    "Highest",
    "Lowest",
    "Proportional",
    "Threshold",
];

pub(super) fn read(written: &str) -> Option<Activation> {
    let mut words = written.split_whitespace();
    let method = words.next()?;
    let rest: Vec<&str> = words.collect();
    let rules = || rest.first().map_or(Some(1), |word| word.parse().ok());
    let at_least = || rest.get(1).map_or(Some(0.0), |word| word.parse().ok());
    Some(match method {
        "General" | "none" => Activation::General,
        "First" => Activation::First {
            rules: rules()?,
            at_least: at_least()?,
        },
        "Last" => Activation::Last {
            rules: rules()?,
            at_least: at_least()?,
        },
        "Highest" => Activation::Highest { rules: rules()? },
        "Lowest" => Activation::Lowest { rules: rules()? },
        "Proportional" => Activation::Proportional,
        "Threshold" => {
            let word = rest.first()?;
            let (_, comparison) = *COMPARISONS.iter().find(|(known, _)| known == word)?;
            Activation::Threshold {
                comparison,
                strength: rest.get(1)?.parse().ok()?,
            }
        }
        _ => return None,
    })
}

pub(super) fn write(activation: Activation) -> String {
    match activation {
        Activation::General => "General".into(),
        Activation::First { rules, at_least } => format!("First {rules} {at_least}"),
        Activation::Last { rules, at_least } => format!("Last {rules} {at_least}"),
        Activation::Highest { rules } => format!("Highest {rules}"),
        Activation::Lowest { rules } => format!("Lowest {rules}"),
        Activation::Proportional => "Proportional".into(),
        Activation::Threshold {
            comparison,
            strength,
        } => {
            let word = COMPARISONS.iter().find(|(_, known)| *known == comparison);
            format!("Threshold {} {strength}", word.map_or("", |(word, _)| word))
        }
    }
}
