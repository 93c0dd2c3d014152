//! The analysis of any small rule set that compiles ends, and finds only numbers.
#![no_main]

use fuzzy::{Engine, check};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(document) = fuzzy::yaml::parse(text) else {
        return;
    };
    let model = &document.model;
    if model.inputs.len() > 4 || model.rules.len() > 20 {
        return;
    }
    let Ok(engine) = Engine::new(model) else {
        return;
    };
    let report = check::check(model, &engine, &check::Options::default()).expect("no claims were made");
    for reach in &report.reach {
        assert!(reach.low.is_finite() && reach.low <= reach.high && reach.high.is_finite());
    }
    for one in &report.uncovered {
        assert!(one.share >= 0.0 && one.share <= 1.0);
    }
    let _ = report.findings(model, &document.places);
    let middle: Vec<f64> = model.inputs.iter().map(|v| 0.5 * v.low + 0.5 * v.high).collect();
    let explanation = engine.explain(model, &middle).expect("the inputs are finite");
    for output in &explanation.outputs {
        assert!(output.value.is_none_or(f64::is_finite));
    }
});
