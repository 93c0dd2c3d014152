//! The file format as a JSON Schema (draft 2020-12), for editors that complete and check while typing.
//!
//! The schema is generated from the tables that the reader uses, so it lists exactly the existing membership functions
//! and operators. Constraints that a schema cannot express (the order of parameters, names in rules) are checked by
//! [`validate`](crate::validate()).

mod nodes;

use alloc::{format, vec::Vec};

use super::{
    VERSION, allow,
    blocks::{self, COMPARISONS, METHODS},
    provenance, rules,
    variables::{INPUT_KEYS, OUTPUT_KEYS},
    words::{AGGREGATIONS, CONJUNCTIONS, DEFUZZIFIERS, DISJUNCTIONS, TYPE_REDUCTIONS},
};
use nodes::{
    Entries, about, any_of, degree, entry, list, named, number, numbers, object, one_of, reference,
    text, whole, words,
};

use crate::{
    model::{Form, LEAST_STRENGTH, MembershipFunction, Role},
    tree::Node,
};

/// Returns the schema as a tree; `rules/schema.json` is its serialization.
///
/// # Example
/// ```
/// let schema = serde_json::to_value(fuzzy::format::schema())?;
/// assert_eq!(schema["properties"]["fuzzy"]["const"], 1);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[must_use]
pub fn schema() -> Node {
    let properties = [
        (
            "fuzzy",
            about(
                "The version of the format",
                [("const", Node::number(VERSION as f64))],
            ),
        ),
        ("name", text("The name of the rule set")),
        ("description", text("What the rule set is for")),
        (
            "inputs",
            named("The inputs, by the names that rules use", "input"),
        ),
        (
            "outputs",
            named("The outputs, by the names that rules use", "output"),
        ),
        (
            "operators",
            operators("The operators that all rules share", true),
        ),
        ("activation", activation()),
        (
            "least_strength",
            about(
                "A firing strength below it counts as 0; 1e-12 where absent",
                [
                    ("type", Node::text("number")),
                    ("minimum", Node::number(LEAST_STRENGTH)),
                    ("maximum", Node::number(1.0)),
                ],
            ),
        ),
        ("rules", list("The rules", reference("rule"), Some(1))),
        (
            "blocks",
            named(
                "Rules in blocks with operators and an activation method of their own, by names",
                "block",
            ),
        ),
        (
            "allow",
            list(
                "The findings of the analysis that the author accepts, each with a reason",
                reference("allowed"),
                None,
            ),
        ),
        (
            "provenance",
            list(
                "The commands that made the rule set, the last one last",
                reference("step"),
                None,
            ),
        ),
    ];
    let required = ["fuzzy", "name", "inputs", "outputs"];
    let mut schema = object("A fuzzy rule set", properties, &required);
    schema.splice(
        0..0,
        [
            entry(
                "$schema",
                Node::text("https://json-schema.org/draft/2020-12/schema"),
            ),
            entry("title", Node::text("fuzzy rule set")),
        ],
    );
    schema.push(one_of(["rules", "blocks"]));
    schema.push(entry("$defs", definitions()));
    Node::mapping(schema)
}

fn definitions() -> Node {
    let of = |keys: &[&'static str], description| {
        let properties = keys.iter().map(|key| (*key, variable_key(key)));
        let mut entries = object(description, properties, &["range"]);
        entries.push(one_of(["partition", "steps", "terms"]));
        Node::mapping(entries)
    };
    Node::mapping([
        ("input", of(&INPUT_KEYS, "An input: a range and terms")),
        (
            "output",
            of(
                &OUTPUT_KEYS,
                "An output: a range, terms, and how they become a number",
            ),
        ),
        ("term", term()),
        ("function", function()),
        ("rule", rule()),
        ("block", block()),
        ("allowed", allowed()),
        ("step", step()),
    ])
}

/// Returns the schema of a key of an input or output.
fn variable_key(key: &str) -> Node {
    match key {
        "description" => text("What it means"),
        "unit" => text("The unit of its values, for people"),
        "range" => numbers("The least and the greatest value", 2),
        "partition" => any_of(
            "Terms whose memberships sum to 1, the outer ones shoulders",
            Vec::from([
                list(
                    "Evenly spaced over the range",
                    Node::mapping([("type", scalar())]),
                    Some(2),
                ),
                about(
                    "By their peaks, from left to right",
                    [
                        ("type", Node::text("object")),
                        (
                            "additionalProperties",
                            Node::mapping([("type", Node::text("number"))]),
                        ),
                        ("minProperties", Node::number(2.0)),
                    ],
                ),
            ]),
        ),
        "blur" => distance(
            "Makes each term of a partition an interval type-2 term: the distance by which it is moved to both sides, as a share of the range",
        ),
        "steps" => about(
            "Terms that divide the range: the limit below which each one ends, and none for the last",
            [
                ("type", Node::text("object")),
                (
                    "additionalProperties",
                    Node::mapping([(
                        "type",
                        Node::list(["number", "null"].map(Node::text).into()),
                    )]),
                ),
                ("minProperties", Node::number(2.0)),
            ],
        ),
        "terms" => named("Terms, each with a shape of its own", "term"),
        "defuzzifier" => words("How the fuzzy result becomes a number", &DEFUZZIFIERS),
        "samples" => {
            let rules = [
                (
                    "midpoint",
                    whole("At the middles of so many even steps", 1.0),
                ),
                (
                    "trapezoid",
                    whole("At so many evenly spaced points, the ends included", 2.0),
                ),
            ];
            let mut entries = object(
                "Integrate by sampling, to reproduce another program",
                rules,
                &[],
            );
            entries.push(entry("minProperties", Node::number(1.0)));
            entries.push(entry("maxProperties", Node::number(1.0)));
            Node::mapping(entries)
        }
        "when_no_rule_fires" => any_of(
            "What the output is where no rule fires",
            Vec::from([
                words(
                    "Undefined, an error, or the value of the row before",
                    &[("undefined", ()), ("error", ()), ("previous", ())],
                ),
                Node::mapping(object(
                    "A value of the range",
                    [("value", number("The value"))],
                    &["value"],
                )),
                Node::mapping(object(
                    "The value of the row before, and a value before there is one",
                    [("previous", number("The value before there is one"))],
                    &["previous"],
                )),
            ]),
        ),
        "aggregation" => words(
            "How the terms of this output join; as in the rule set's operators where absent",
            &AGGREGATIONS,
        ),
        "clamp" => boolean(
            "Whether a value outside the range is clamped to it; only a weighted defuzzifier gives one",
        ),
        "type_reduction" => words(
            "How the interval of an output with interval type-2 terms is computed; exact where absent",
            &TYPE_REDUCTIONS,
        ),
        // All keys that are read have an entry above; a new key is at least allowed.
        _ => Node::mapping(Entries::new()),
    }
}

fn allowed() -> Node {
    let codes = allow::CODES.map(|code| (code, ()));
    let properties = [
        ("finding", words("The code of the finding", &codes)),
        ("because", text("Why it is accepted")),
    ];
    Node::mapping(object(
        "A finding that the author accepts",
        properties,
        &allow::KEYS,
    ))
}

fn step() -> Node {
    let file = |key: &&'static str| match *key {
        "file" => (*key, text("Its name")),
        _ => (*key, text("The SHA-256 of its bytes")),
    };
    let of_loss = |key: &&'static str| match *key {
        "name" => (*key, text("What it is, as `RMS error`")),
        key => (key, number("Its value")),
    };
    let property = |key: &'static str| match key {
        "command" => text("What made it: a command, or in words"),
        "data" => {
            let file = object("A file", provenance::DATA_KEYS.iter().map(file), &["file"]);
            list("The files with the data", Node::mapping(file), None)
        }
        "rows" => whole("How many rows were used", 0.0),
        "seed" => whole("The seed of what was random", 0.0),
        "loss" => {
            let keys = provenance::LOSS_KEYS;
            Node::mapping(object(
                "The loss that was made small",
                keys.iter().map(of_loss),
                &keys,
            ))
        }
        "rules" => numbers("The number of rules, before and after", 2),
        "moved" => {
            let one = Node::mapping([("type", Node::text("string"))]);
            list("The numbers that moved, in words", one, None)
        }
        "note" => text("What else there is to say"),
        "result" => text(
            "A hash of the rule set that the command made; another one now says that it was edited since",
        ),
        _ => Node::mapping(Entries::new()),
    };
    let properties = provenance::KEYS.map(|key| (key, property(key)));
    Node::mapping(object(
        "A command that made the rule set of another one",
        properties,
        &["command"],
    ))
}

/// Returns the schema of a name, which may look like a number or a boolean.
fn scalar() -> Node {
    Node::list(["string", "number", "boolean"].map(Node::text).into())
}

/// Returns the schema of a membership function with its height.
fn function() -> Node {
    let height = (
        "height",
        about(
            "The largest degree of membership",
            [
                ("type", Node::text("number")),
                ("exclusiveMinimum", Node::number(0.0)),
                ("maximum", Node::number(1.0)),
            ],
        ),
    );
    let point = numbers("[x, degree]", 2);
    let linear = about(
        "Takagi-Sugeno outputs: the sum of the constant and of each input times its number",
        [
            ("type", Node::text("object")),
            (
                "additionalProperties",
                Node::mapping([("type", Node::text("number"))]),
            ),
        ],
    );
    let others = [
        (
            "piecewise",
            list(
                "Straight between points, from left to right",
                point,
                Some(1),
            ),
        ),
        (
            "function",
            about(
                "A formula over the variable; in a Takagi-Sugeno output, the value itself over inputs and other outputs",
                [(
                    "type",
                    Node::list(["string", "number"].map(Node::text).into()),
                )],
            ),
        ),
        ("linear", linear),
        height,
    ];
    let properties = MembershipFunction::FORMS
        .iter()
        .map(|form| (form.name, shape(form)))
        .chain(others);
    let mut entries = object(
        "A membership function, and a height if it is not 1",
        properties,
        &[],
    );
    entries.push(entry("minProperties", Node::number(1.0)));
    entries.push(entry("maxProperties", Node::number(2.0)));
    Node::mapping(entries)
}

/// Returns the schema of a share of a range.
fn distance(description: &str) -> Node {
    about(
        description,
        [
            ("type", Node::text("number")),
            ("minimum", Node::number(0.0)),
            ("exclusiveMaximum", Node::number(1.0)),
        ],
    )
}

/// Returns the schema of a number, or of the two ends of an interval.
fn ends(description: &str, number: Node) -> Node {
    let items = [
        ("type", Node::text("array")),
        ("items", number.clone()),
        ("minItems", Node::number(2.0)),
        ("maxItems", Node::number(2.0)),
    ];
    any_of(description, Vec::from([number, Node::mapping(items)]))
}

/// Returns the schema of the short forms of interval type-2 terms.
fn short_term() -> Node {
    let shapes = MembershipFunction::FORMS.iter();
    let shapes = shapes.map(|form| match form.name {
        "gaussian" => {
            let number = |least: &str| {
                Node::mapping([("type", Node::text("number"))].into_iter().chain(
                    (!least.is_empty()).then(|| ("exclusiveMinimum", Node::number(0.0))),
                ))
            };
            let properties = [
                ("mean", ends("The mean, or its interval", number(""))),
                (
                    "sd",
                    ends("The standard deviation, or its interval", number("positive")),
                ),
            ];
            let gaussian = object(
                "A Gaussian; a mean or a standard deviation that is an interval makes it an interval type-2 term",
                properties,
                &["mean", "sd"],
            );
            (form.name, Node::mapping(gaussian))
        }
        name => (name, reference(&format!("function/properties/{name}"))),
    });
    let lag = distance("The lag of both flanks");
    let keys = [
        ("height", degree("The largest degree of membership")),
        (
            "blur",
            distance(
                "The distance by which the membership function is moved to both sides, as a share of the range: the upper membership function is the maximum of all copies, the lower one their minimum",
            ),
        ),
        (
            "lower_scale",
            degree(
                "The lower membership function is the upper one times this number; 1 where absent",
            ),
        ),
        (
            "lower_lag",
            ends(
                "The degree of the upper membership function at which the lower one starts to rise, or one for the left and one for the right flank; 0 where absent",
                lag,
            ),
        ),
    ];
    Node::mapping(object(
        "An interval type-2 term in short: a membership function with `blur`, with `lower_scale` and `lower_lag`, or a Gaussian with intervals",
        shapes.chain(keys),
        &[],
    ))
}

/// Returns the schema of a term: a membership function, or an upper and a lower one, or a short form of these.
fn term() -> Node {
    let bounds = ["upper", "lower"].map(|bound| (bound, reference("function")));
    let interval = object(
        "An interval type-2 term: the lower membership function is nowhere above the upper one",
        bounds,
        &["upper", "lower"],
    );
    any_of(
        "A term",
        Vec::from([reference("function"), Node::mapping(interval), short_term()]),
    )
}

/// Returns the schema of the parameters of a shape, with all its notations.
fn shape(form: &Form) -> Node {
    let properties = form.parameters.iter().map(|(name, role)| {
        let mut entries = Vec::from([("type", Node::text("number"))]);
        if *role == Role::Positive {
            entries.push(("exclusiveMinimum", Node::number(0.0)));
        }
        (*name, Node::mapping(entries))
    });
    let names = form.names();
    let by_name = Node::mapping(object("By name", properties, &names));
    let mut options = Vec::new();
    if form.as_list() {
        let order = format!("[{}], from left to right", names.join(", "));
        options.push(numbers(&order, names.len()));
    }
    if names.len() == 1 {
        options.push(number("Its one parameter"));
    }
    options.push(by_name);
    any_of(form.about, options)
}

/// Returns the schema of operators. `all` adds the aggregation, which blocks do not have.
fn operators(description: &str, all: bool) -> Node {
    let properties = [
        ("and", words("AND; minimum where absent", &CONJUNCTIONS)),
        ("or", words("OR; maximum where absent", &DISJUNCTIONS)),
        (
            "implication",
            words(
                "How a firing strength cuts or scales a term; minimum where absent",
                &CONJUNCTIONS,
            ),
        ),
        (
            "aggregation",
            words(
                "How the terms of an output join; maximum where absent",
                &AGGREGATIONS,
            ),
        ),
    ];
    let count = if all { 4 } else { 3 };
    let properties = properties.into_iter().take(count);
    Node::mapping(object(description, properties, &[]))
}

fn block() -> Node {
    let value = |key: &str| match key {
        "description" => text("What its rules are for"),
        "enabled" => boolean("Whether its rules are evaluated; true where absent"),
        "operators" => operators("Its operators; those of the rule set where absent", false),
        "activation" => activation(),
        _ => list("Its rules", reference("rule"), None),
    };
    let properties = blocks::KEYS.iter().map(|key| (*key, value(key)));
    Node::mapping(object(
        "Rules with operators and an activation method of their own",
        properties,
        &["rules"],
    ))
}

fn activation() -> Node {
    let only =
        |key: &str, which: &str, value: Node| Node::mapping(object(which, [(key, value)], &[key]));
    let counted = |key: &str, which: &str| {
        let counted = object(
            "So many, of those with at least a strength",
            [
                ("rules", whole("How many", 1.0)),
                ("at_least", number("Their least strength")),
            ],
            &["rules"],
        );
        let options = Vec::from([whole("How many", 1.0), Node::mapping(counted)]);
        only(key, which, any_of("How many", options))
    };
    let comparisons = COMPARISONS.map(|(word, _)| (word, number("The firing strength")));
    let mut threshold = object("The rules whose strength compares so", comparisons, &[]);
    threshold.push(entry("minProperties", Node::number(1.0)));
    threshold.push(entry("maxProperties", Node::number(1.0)));
    any_of(
        "Which rules fire: all where absent",
        Vec::from([
            words(
                "All, or all with the strength divided by the sum of all",
                &METHODS,
            ),
            counted("first", "The first rules that fire"),
            counted("last", "The last rules that fire"),
            only("highest", "The strongest rules", whole("How many", 1.0)),
            only(
                "lowest",
                "The weakest rules that fire",
                whole("How many", 1.0),
            ),
            only(
                "threshold",
                "Those above or below a strength",
                Node::mapping(threshold),
            ),
        ]),
    )
}

fn boolean(description: &str) -> Node {
    about(description, [("type", Node::text("boolean"))])
}

fn rule() -> Node {
    let beaten = object(
        "A conclusion that lost against the one in the rule when it was learned",
        [
            ("term", text("The term that lost")),
            ("degree", degree("Its degree")),
            ("support", whole("How many samples stood behind it", 0.0)),
        ],
        &["term", "degree", "support"],
    );
    let value = |key: &str| match key {
        "rule" => rule_text(),
        "confidence" => degree("How sure its source is of it; it does not weight the rule"),
        "support" => whole("How many samples stand behind it", 0.0),
        "against" => list(
            "The conclusions it beat",
            Node::mapping(beaten.clone()),
            None,
        ),
        _ => text("A remark"),
    };
    let properties = rules::KEYS.iter().map(|key| (*key, value(key)));
    let with_provenance = Node::mapping(object(
        "A rule and where it came from",
        properties,
        &["rule"],
    ));
    any_of(
        "IF input IS [hedge] term {AND|OR ...} THEN output IS term [WITH weight]",
        Vec::from([rule_text(), with_provenance]),
    )
}

fn rule_text() -> Node {
    // Comments and space may precede the rule; a text that consists only of these is not a rule.
    let pattern = r"^(\s|#[^\n]*\n)*[Ii][Ff]\b";
    about(
        "IF input IS [not|very|somewhat|extremely|seldom|any] term {AND|OR ...} THEN output IS term [WITH weight]",
        [
            ("type", Node::text("string")),
            ("pattern", Node::text(pattern)),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `UPDATE_SCHEMA=1 cargo test -p flagred-fuzzy schema` updates the file.
    #[test]
    fn the_schema_file_agrees_with_the_types() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/schema.json");
        let made = serde_json::to_string_pretty(&schema()).unwrap() + "\n";
        if std::env::var_os("UPDATE_SCHEMA").is_some() {
            std::fs::write(path, &made).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), made);
    }

    #[test]
    fn the_guide_has_a_line_for_every_shape() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/rule-sets.md");
        let guide = std::fs::read_to_string(path).unwrap();
        let names = MembershipFunction::FORMS.iter().map(|form| form.name);
        for name in names.chain(["piecewise", "function", "linear"]) {
            assert!(guide.contains(&format!("\n| `{name}` |")), "{name}");
        }
    }

    #[test]
    fn every_key_of_a_variable_is_described() {
        for key in INPUT_KEYS.iter().chain(&OUTPUT_KEYS) {
            let value = serde_json::to_value(variable_key(key)).unwrap();
            assert!(value["description"].is_string(), "{key}");
        }
    }
}
