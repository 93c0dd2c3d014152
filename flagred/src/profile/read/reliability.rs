//! Reads the key `reliability` of a profile: how often large attitude errors followed a risk.

use alloc::{format, vec::Vec};

use fuzzy::{
    diagnostic::Diagnostic,
    tree::{Fields, Node},
};

use super::Mistakes;
use crate::profile::{ErrorFrequency, Reliability};

pub(super) fn reliability(fields: &Fields, found: &mut Mistakes) -> Vec<Reliability> {
    let items = fields.get("reliability").and_then(|node| {
        let help = format!("write `reliability: [{ROW}]`, with a row for each range of risks");
        node.items("`reliability`", &help, found)
    });
    let mut rows: Vec<Reliability> = Vec::new();
    for node in items.unwrap_or_default() {
        let Some(row) = row(node, found) else {
            continue;
        };
        if rows.last().is_some_and(|last| row.from_pct < last.to_pct) {
            let message = "a row begins below the end of the previous row";
            found.push(
                Diagnostic::error("order", node.span.clone(), message)
                    .help("order the rows by `risk`, without overlaps"),
            );
        }
        rows.push(row);
    }
    rows
}

const ROW: &str = "{risk: [60, 80], real: {moments: 889, followed: 759}}";

fn row(node: &Node, found: &mut Mistakes) -> Option<Reliability> {
    let what = "a row of `reliability`";
    let help = format!("write `{ROW}`");
    let fields = node.fields(what, &["risk", "real", "simulated"], &help, found)?;
    let risk = fields.require("risk", &help, found)?;
    let [from_pct, to_pct] = pair(risk, found)?;
    if !(0.0 <= from_pct && from_pct < to_pct && to_pct <= 100.0) {
        let message = format!("`risk` is [{from_pct}, {to_pct}]");
        found.push(
            Diagnostic::error("out-of-range", risk.span.clone(), message)
                .help("write a range within [0, 100], its lower end first"),
        );
    }
    let mut count = |key| followed(&fields, key, found);
    Some(Reliability {
        from_pct,
        to_pct,
        real: count("real"),
        simulated: count("simulated"),
    })
}

fn pair(node: &Node, found: &mut Mistakes) -> Option<[f64; 2]> {
    let help = "write `risk: [60, 80]`";
    let items = node.items("`risk`", help, found)?;
    let [from, to] = items else {
        found.push(
            Diagnostic::error("wrong-type", node.span.clone(), "`risk` takes two numbers")
                .help(help),
        );
        return None;
    };
    Some([from.finite("`risk`", found)?, to.finite("`risk`", found)?])
}

fn followed(fields: &Fields, key: &str, found: &mut Mistakes) -> Option<ErrorFrequency> {
    let node = fields.get(key)?;
    let help = format!("write `{key}: {{moments: 889, followed: 759}}`");
    let fields = node.fields(&format!("`{key}`"), &["moments", "followed"], &help, found)?;
    let mut count = |key: &str| {
        let help = format!("write `{key}`, a number of moments");
        let node = fields.require(key, &help, found)?;
        node.whole(&format!("`{key}`"), 0, found)
    };
    let counts = ErrorFrequency {
        moments: count("moments")?,
        followed: count("followed")?,
    };
    if counts.followed > counts.moments {
        let message = format!("`followed` of `{key}` is greater than its `moments`");
        found.push(
            Diagnostic::error("order", node.span.clone(), message)
                .help("`followed` counts those of the `moments` that a large error followed: it is at most `moments`"),
        );
    }
    Some(counts)
}
