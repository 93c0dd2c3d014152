//! Fuzz targets for untrusted rules, rule sets and profiles.

use flagred::monitor::{Craft, Monitor, Sample};
use flagred_cli::fuzzing::{Profile, checked};
use flagred_interchange::{Format, Losses};
use fuzzy::Engine;

use super::assert_harmless;
use crate::board::{findings, reported};

/// Checks that any text, read in the format of another program, gives either findings located inside the text, or a
/// model. If a format supports the model, the text written in this format can be read again.
pub fn other_programs(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let Some(format) = Format::of(text) else {
        return;
    };
    for losses in [Losses::Refuse, Losses::Accept] {
        let (model, findings) = match flagred_interchange::read(text, format, losses) {
            Ok(document) => (Some(document.model), document.warnings),
            Err(findings) => (None, findings),
        };
        for finding in &findings.0 {
            assert!(text.get(finding.span.clone()).is_some(), "{finding:?}");
        }
        for format in Format::ALL {
            let written = model
                .as_ref()
                .map(|model| flagred_interchange::write(model, format, losses));
            let Some(Ok(written)) = written else { continue };
            let again = flagred_interchange::read(&written.text, format, Losses::Accept);
            assert!(again.is_ok(), "{}\n{}", again.unwrap_err(), written.text);
        }
    }
}

/// The separator between a profile and its rule set.
pub(super) const SEPARATOR: &str = "\n---\n";

/// Checks that any text gives a rule that can be printed and parsed again unchanged, or an error located inside the
/// text.
pub fn rule(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match fuzzy::rule::parse(text) {
        Ok(rule) => assert_eq!(fuzzy::rule::parse(&rule.to_string()), Ok(rule)),
        Err(mistake) => assert!(text.get(mistake.span).is_some()),
    }
}

/// Checks that any text gives either findings located inside the text, or a rule set. The rule set must remain the
/// same when it is saved and loaded, and it must be possible to compile and analyse it without a panic. Findings
/// printed with their source lines must be safe on a terminal.
pub fn rule_set(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    match fuzzy::yaml::parse(text) {
        Ok(document) => {
            let saved = fuzzy::yaml::to_string(&document.model);
            let again = fuzzy::yaml::parse(&saved).map(|d| d.model);
            assert_eq!(again.as_ref(), Ok(&document.model), "{saved}");
            let engine = Engine::new(&document.model).unwrap_or_else(|e| panic!("{e}\n{text}"));
            let inputs = document.model.inputs.iter();
            let middle: Vec<f64> = inputs.map(|v| 0.5 * v.low + 0.5 * v.high).collect();
            let explanation = engine.explain(&middle).unwrap();
            for output in &explanation.outputs {
                assert!(output.value.is_none_or(f64::is_finite), "{text}");
            }
        }
        Err(findings) => assert!(findings.has_errors()),
    }
    let (findings, drawn, report) = checked(text);
    for finding in &findings.0 {
        assert!(text.get(finding.span.clone()).is_some(), "{finding:?}");
    }
    assert_harmless(&drawn);
    let Some(report) = report else {
        return;
    };
    for reach in &report.reach {
        assert!(reach.low.is_finite() && reach.low <= reach.high && reach.high.is_finite());
    }
    for one in &report.uncovered {
        assert!(one.share >= 0.0 && one.share <= 1.0);
    }
}

/// Checks that any two texts, as a profile and its rule set, give either findings located inside the profile, or
/// an estimator whose risks are finite and whose plan gives the same risks on board.
pub fn profile(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let (profile, rules) = text.split_once(SEPARATOR).unwrap_or((text, ""));
    if let Err(findings) = profile.parse::<flagred::profile::Profile>() {
        assert!(findings.has_errors());
        for finding in findings.0 {
            assert!(profile.get(finding.span).is_some());
        }
        return;
    }
    let Some(profile) = Profile::new(profile, rules) else {
        return;
    };
    let estimator = profile.estimator();
    let signals = estimator.profile().signals();
    let craft = Craft::new(4).with_signals(&signals);
    let mut monitor = Monitor::new(estimator, craft).unwrap();
    let plan = estimator.plan().ok();
    assert_eq!(profile.exported().is_some(), plan.is_some());
    let mut memory = plan
        .as_ref()
        .map(|plan| flagred::board::OwnedMemory::new(plan, 4));
    let mut on_board = plan.as_ref().zip(memory.as_mut()).map(|(plan, memory)| {
        assert_eq!(plan.check(), Ok(()));
        memory.monitor(plan).unwrap()
    });
    for i in 0..100 {
        let motor = |n: u32| f64::from((i * n) % 11) / 10.0;
        let sample = Sample {
            t_s: 0.1 * f64::from(i),
            motors: &[motor(1), motor(3), motor(5), motor(7)],
            in_air: Some(i > 5),
            signals: &vec![f64::from(i); signals.len()],
        };
        let update = monitor.push(&sample);
        if let Ok(risk) = update.risk {
            assert!(risk.risk_pct.is_finite(), "{text}");
        }
        if let Some(on_board) = &mut on_board {
            assert_eq!(
                reported(&on_board.push(&sample)),
                reported(&update),
                "{text}"
            );
        }
    }
    let ended = findings(&monitor.finish());
    if let Some(on_board) = &mut on_board {
        assert_eq!(findings(&on_board.finish()), ended, "{text}");
    }
    for exported in profile.exported().into_iter().flatten() {
        assert_harmless(&exported);
    }
}
