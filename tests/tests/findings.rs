//! The findings that a pilot reads, and their list in docs/findings.md.

use std::collections::BTreeSet;

use flagred::{
    estimator::Estimator,
    flight::Words,
    profile::{ErrorFrequency, Reliability},
    shipped,
    verdict::Measure,
};
use flagred_tests::{flagred, reference_data};

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
    let measures = Measure::ALL.into_iter();
    causes
        .chain(measures.map(|measure| Words::of_measure(estimator.profile(), measure)))
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
fn the_document_lists_the_words_of_every_finding() {
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

/// Every input has its own words; none falls back to its name.
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

/// The reliability of the shipped profiles is measured on held-out vehicles by `scripts/learn-flagred`, whereas
/// `flagred validate` uses rules that were learned from these vehicles. The shares of both differ by at most 10 points.
#[test]
#[ignore = "needs FLAGRED_SHARED"]
fn the_reliability_is_near_that_of_rules_learned_from_the_vehicles() {
    let counts = |folders: &[&str]| {
        let paths = folders.iter().map(|folder| reference_data().join(folder));
        let output = flagred()
            .args(["validate", "--json", "--profile", "flagred"])
            .args(paths)
            .output();
        let document = serde_json::from_slice::<serde_json::Value>(&output.unwrap().stdout);
        let bands = document.unwrap()["estimators"][0]["reliability"].take();
        let bands = bands.as_array().unwrap().clone().into_iter();
        let counts = bands.map(|band| {
            let count = |name: &str| band[name].as_u64().unwrap();
            (count("cases"), count("critical"))
        });
        counts.collect::<Vec<(u64, u64)>>()
    };
    let real = counts(&["real/flights", "real2/flights"]);
    let simulated = [counts(&["sitl2/timeseries"]), counts(&["sitl3/timeseries"])];
    let estimator = shipped::flagred();
    let rows = &estimator.profile().reliability;
    assert!(!rows.is_empty());
    for Reliability {
        from_pct,
        to_pct,
        real: of_real,
        simulated: of_simulated,
    } in rows
    {
        let bands = (*from_pct / 10.0) as usize..(*to_pct / 10.0) as usize;
        let known = |counts: &[&Vec<(u64, u64)>]| {
            let counts = counts.iter().flat_map(|counts| &counts[bands.clone()]);
            let (moments, followed) =
                counts.fold((0, 0), |sum, band| (sum.0 + band.0, sum.1 + band.1));
            ErrorFrequency { moments, followed }
        };
        let [sitl2, sitl3] = &simulated;
        for (left_out, known) in [
            (of_real.unwrap(), known(&[&real])),
            (of_simulated.unwrap(), known(&[sitl2, sitl3])),
        ] {
            let pct = |of: ErrorFrequency| 100.0 * of.followed as f64 / of.moments as f64;
            assert!(
                (pct(left_out) - pct(known)).abs() < 10.0,
                "{from_pct} to {to_pct} %: {left_out:?}, {known:?}"
            );
        }
    }
}
