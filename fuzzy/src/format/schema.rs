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
    model::{MIN_STRENGTH, MembershipFunction, Role, ShapeForm},
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
        ("description", text("The purpose of the rule set")),
        (
            "inputs",
            named("The inputs; the keys are the names that rules use", "input"),
        ),
        (
            "outputs",
            named(
                "The outputs; the keys are the names that rules use",
                "output",
            ),
        ),
        ("operators", operators("The operators of all rules", true)),
        ("activation", activation()),
        (
            "least_strength",
            about(
                "A firing strength below this counts as 0; default: 1e-12",
                [
                    ("type", Node::text("number")),
                    ("minimum", Node::number(MIN_STRENGTH)),
                    ("maximum", Node::number(1.0)),
                ],
            ),
        ),
        ("rules", list("The rules", reference("rule"), Some(1))),
        (
            "blocks",
            named(
                "Rule blocks, each with its own operators and activation method; the keys are their names",
                "block",
            ),
        ),
        (
            "allow",
            list(
                "The findings of a check that the author accepts, each with a reason",
                reference("allowed"),
                None,
            ),
        ),
        (
            "provenance",
            list(
                "The commands that created or changed the rule set, in order",
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
                "An output: a range, terms, and how its value is computed",
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
        "description" => text("The meaning of the variable"),
        "unit" => text("The unit of the values, shown to readers"),
        "range" => numbers("[minimum, maximum]", 2),
        "partition" => any_of(
            "Terms whose degrees sum to 1 at every value; the first and the last term are shoulders",
            Vec::from([
                list(
                    "The names of the terms; their peaks are evenly spaced over the range",
                    Node::mapping([("type", scalar())]),
                    Some(2),
                ),
                about(
                    "The peak of each term, from left to right",
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
            "Terms that divide the range at crisp limits: the upper limit of each term, and null for the last one",
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
        "terms" => named(
            "The terms, each with its membership function; the keys are their names",
            "term",
        ),
        "defuzzifier" => words(
            "The defuzzifier, which computes a number from the fuzzy result",
            &DEFUZZIFIERS,
        ),
        "samples" => {
            let rules = [
                (
                    "midpoint",
                    whole(
                        "Evaluate the set at the midpoints of this number of equal steps",
                        1.0,
                    ),
                ),
                (
                    "trapezoid",
                    whole(
                        "Evaluate the set at this number of evenly spaced points, including both ends of the range",
                        2.0,
                    ),
                ),
            ];
            let mut entries = object(
                "Integrate by sampling, to reproduce another program; without this key the result is exact",
                rules,
                &[],
            );
            entries.push(entry("minProperties", Node::number(1.0)));
            entries.push(entry("maxProperties", Node::number(1.0)));
            Node::mapping(entries)
        }
        "when_no_rule_fires" => any_of(
            "The value of the output if no rule fires; default: undefined",
            Vec::from([
                words(
                    "No value, an error, or the value of the previous row",
                    &[("undefined", ()), ("error", ()), ("previous", ())],
                ),
                Node::mapping(object(
                    "A default value",
                    [("value", number("The value"))],
                    &["value"],
                )),
                Node::mapping(object(
                    "The value of the previous row, and a value for the time before there is one",
                    [(
                        "previous",
                        number("The value to use until the output has had a value"),
                    )],
                    &["previous"],
                )),
            ]),
        ),
        "aggregation" => words(
            "The function that combines the terms of this output; default: the aggregation in `operators`",
            &AGGREGATIONS,
        ),
        "clamp" => boolean(
            "Whether a value outside the range is clamped to it; only weighted and Tsukamoto outputs have such values",
        ),
        "type_reduction" => words(
            "How the interval of an output with interval type-2 terms is computed (default: `exact`)",
            &TYPE_REDUCTIONS,
        ),
        // Every key that is read has an entry above. If a new key is forgotten, the schema allows any value for it.
        _ => Node::mapping(Entries::new()),
    }
}

fn allowed() -> Node {
    let codes = allow::CODES.map(|code| (code, ()));
    let properties = [
        ("finding", words("The code of the finding", &codes)),
        (
            "of",
            text(
                "Accept only findings whose message contains this name, such as the name of a variable",
            ),
        ),
        ("because", text("The reason why the finding is accepted")),
    ];
    Node::mapping(object(
        "A finding that the author accepts",
        properties,
        &["finding", "because"],
    ))
}

fn step() -> Node {
    let file = |key: &&'static str| match *key {
        "file" => (*key, text("The name of the file")),
        _ => (*key, text("The SHA-256 hash of the file's content")),
    };
    let of_loss = |key: &&'static str| match *key {
        "name" => (*key, text("The name of the loss, such as `RMS error`")),
        "before" => ("before", number("The loss before the command")),
        key => (key, number("The loss after the command")),
    };
    let property = |key: &'static str| match key {
        "command" => text("The command that created or changed the rule set, or a description"),
        "data" => {
            let file = object(
                "A file with data",
                provenance::DATA_KEYS.iter().map(file),
                &["file"],
            );
            list("The files with the data", Node::mapping(file), None)
        }
        "rows" => whole("The number of rows that were used", 0.0),
        "seed" => whole("The random seed", 0.0),
        "loss" => {
            let keys = provenance::LOSS_KEYS;
            Node::mapping(object(
                "The loss that was minimised",
                keys.iter().map(of_loss),
                &keys,
            ))
        }
        "rules" => numbers("The number of rules, before and after", 2),
        "moved" => {
            let one = Node::mapping([("type", Node::text("string"))]);
            list(
                "The numbers that the command changed, described in text",
                one,
                None,
            )
        }
        "note" => text("Further remarks"),
        "result" => text(
            "A hash of the rule set that the command wrote; if the hash of the rule set differs from it, the rule set was edited afterwards",
        ),
        _ => Node::mapping(Entries::new()),
    };
    let properties = provenance::KEYS.map(|key| (key, property(key)));
    Node::mapping(object(
        "A command that created the rule set, or derived it from another rule set",
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
            "The largest degree of membership; default: 1",
            [
                ("type", Node::text("number")),
                ("exclusiveMinimum", Node::number(0.0)),
                ("maximum", Node::number(1.0)),
            ],
        ),
    );
    let point = numbers("A point: [x, degree]", 2);
    let linear = about(
        "A linear consequent of a Takagi-Sugeno output: a constant, and a coefficient for each input",
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
                "Straight lines between points, from left to right",
                point,
                Some(1),
            ),
        ),
        (
            "function",
            about(
                "A formula for the degree at a value of the variable; in a Takagi-Sugeno output, a formula for the consequent, from inputs and other outputs",
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
        "A membership function, with a height if that is not 1",
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
            degree("The lower membership function is the upper one times this number; default: 1"),
        ),
        (
            "lower_lag",
            ends(
                "The degree of the upper membership function at which the lower one starts to rise, or one for the left and one for the right flank; default: 0",
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
        "An interval type-2 term; the lower membership function must not be above the upper one anywhere",
        bounds,
        &["upper", "lower"],
    );
    any_of(
        "A term: a membership function, an upper and a lower one, or a short form of both",
        Vec::from([reference("function"), Node::mapping(interval), short_term()]),
    )
}

/// Returns the schema of the parameters of a shape, with all its notations.
fn shape(form: &ShapeForm) -> Node {
    let properties = form.parameters.iter().map(|(name, role)| {
        let mut entries = Vec::from([("type", Node::text("number"))]);
        if *role == Role::Positive {
            entries.push(("exclusiveMinimum", Node::number(0.0)));
        }
        (*name, Node::mapping(entries))
    });
    let names = form.names();
    let by_name = Node::mapping(object("The parameters by name", properties, &names));
    let mut options = Vec::new();
    if form.as_list() {
        let order = format!("[{}], from left to right", names.join(", "));
        options.push(numbers(&order, names.len()));
    }
    if names.len() == 1 {
        options.push(number("The only parameter"));
    }
    options.push(by_name);
    any_of(form.about, options)
}

/// Returns the schema of operators. `all` adds the aggregation, which blocks do not have.
fn operators(description: &str, all: bool) -> Node {
    let properties = [
        (
            "and",
            words("The function for AND; default: minimum", &CONJUNCTIONS),
        ),
        (
            "or",
            words("The function for OR; default: maximum", &DISJUNCTIONS),
        ),
        (
            "implication",
            words(
                "The function that applies a firing strength to the term of the consequent; default: minimum",
                &CONJUNCTIONS,
            ),
        ),
        (
            "aggregation",
            words(
                "The function that combines the terms of an output; default: maximum",
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
        "description" => text("The purpose of the rules"),
        "enabled" => boolean("Whether the rules of the block are evaluated; default: true"),
        "operators" => operators(
            "The operators of the block; default: those of the rule set",
            false,
        ),
        "activation" => activation(),
        _ => list("The rules of the block", reference("rule"), None),
    };
    let properties = blocks::KEYS.iter().map(|key| (*key, value(key)));
    Node::mapping(object(
        "A rule block: rules with their own operators and activation method",
        properties,
        &["rules"],
    ))
}

fn activation() -> Node {
    let only =
        |key: &str, which: &str, value: Node| Node::mapping(object(which, [(key, value)], &[key]));
    let counted = |key: &str, which: &str| {
        let counted = object(
            "At most `rules` rules, among those whose firing strength is at least `at_least`",
            [
                ("rules", whole("The number of rules", 1.0)),
                ("at_least", number("The minimum firing strength")),
            ],
            &["rules"],
        );
        let options = Vec::from([whole("The number of rules", 1.0), Node::mapping(counted)]);
        only(key, which, any_of("The number of rules", options))
    };
    let comparisons = COMPARISONS.map(|(word, _)| {
        (
            word,
            number("The number to which the firing strength is compared"),
        )
    });
    let mut threshold = object(
        "The comparison that the firing strength must satisfy",
        comparisons,
        &[],
    );
    threshold.push(entry("minProperties", Node::number(1.0)));
    threshold.push(entry("maxProperties", Node::number(1.0)));
    any_of(
        "The activation method, which determines which rules fire; default: general",
        Vec::from([
            words(
                "general: all rules; proportional: all rules, each firing strength divided by the sum of all",
                &METHODS,
            ),
            counted("first", "Only the first rules that would fire"),
            counted("last", "Only the last rules that would fire"),
            only(
                "highest",
                "Only the rules with the largest firing strengths",
                whole("The number of rules", 1.0),
            ),
            only(
                "lowest",
                "Only the rules with the smallest firing strengths above 0",
                whole("The number of rules", 1.0),
            ),
            only(
                "threshold",
                "Only the rules whose firing strength satisfies a comparison",
                Node::mapping(threshold),
            ),
        ]),
    )
}

fn boolean(description: &str) -> Node {
    about(description, [("type", Node::text("boolean"))])
}

fn rule() -> Node {
    let rejected = object(
        "A consequent that was rejected in favour of the rule's consequent when the rule was learned",
        [
            ("term", text("The term of the rejected consequent")),
            ("degree", degree("The degree of the rejected consequent")),
            (
                "support",
                whole(
                    "The number of samples that support the rejected consequent",
                    0.0,
                ),
            ),
        ],
        &["term", "degree", "support"],
    );
    let value = |key: &str| match key {
        "rule" => rule_text(),
        "confidence" => {
            degree("The confidence of the rule's source, from 0 to 1; it is not used as a weight")
        }
        "support" => whole("The number of samples that support the rule", 0.0),
        "against" => list(
            "The rejected consequents",
            Node::mapping(rejected.clone()),
            None,
        ),
        _ => text("A remark"),
    };
    let properties = rules::KEYS.iter().map(|key| (*key, value(key)));
    let with_provenance = Node::mapping(object("A rule and its origin", properties, &["rule"]));
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
