//! What a pilot reads of findings, and that docs/findings.md has it.

use std::collections::BTreeSet;

use flagred::{estimator::Estimator, flight::Words, shipped, verdict::Measure};

/// The estimators of all shipped profiles.
fn estimators() -> [Estimator; 3] {
    [
        shipped::flagred(),
        shipped::flagred_paper(),
        shipped::flagred_battery(),
    ]
}

/// The words of all findings of a shipped profile.
fn all(estimator: &Estimator) -> Vec<Words> {
    let causes = estimator.propositions();
    let causes = causes.map(|(input, term)| Words::of_cause(estimator, input, term));
    causes
        .chain(Measure::ALL.into_iter().map(Words::of_measure))
        .collect()
}

/// A row of docs/findings.md.
fn row(words: &Words) -> String {
    let Words {
        code,
        brief,
        text,
        advice,
    } = words;
    format!("| `{code}` | {} | {text} | {advice} |", brief.concat())
}

#[test]
fn the_document_has_the_words_of_every_finding() {
    let document = include_str!("../../docs/findings.md");
    let expected: BTreeSet<String> = estimators().iter().flat_map(all).map(|w| row(&w)).collect();
    let missing: Vec<&String> = expected
        .iter()
        .filter(|row| !document.contains(row.as_str()))
        .collect();
    let missing = missing.iter().map(|row| format!("{row}\n"));
    let missing: String = missing.collect();
    assert!(missing.is_empty(), "docs/findings.md lacks:\n{missing}");
}

/// Its words are chosen: none falls back to the name of an input.
#[test]
fn every_input_of_a_shipped_rule_set_has_words() {
    for estimator in estimators() {
        for (input, term) in estimator.propositions() {
            let Words { code, brief, .. } = Words::of_cause(&estimator, input, term);
            assert_ne!(code, input);
            assert_eq!(brief[1], "", "{input}");
        }
    }
}

#[test]
fn every_short_text_fits_with_the_largest_numbers() {
    for words in estimators().iter().flat_map(all) {
        let [first, second] = words.brief;
        let full = (first + &second)
            .replace("{peak}", "100")
            .replace("{motor}", "motor 12 or 11");
        let text = match full.contains("100") || full.starts_with("motor") {
            true => format!("FLAGRED: WARN {full}"),
            false => format!("FLAGRED: WARN elevated 100 %, {full}"),
        };
        assert!(text.len() <= 50, "{text}");
    }
}
