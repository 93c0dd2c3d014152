//! Validation of JSON against the schemas that `flagred schema` prints.
//!
//! The validator supports the keywords that these schemas use, and fails on any other. A complete validator of JSON
//! Schema would need about fifty packages.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    reason = "helpers of tests: what does not hold fails the test"
)]

use serde_json::Value;

/// The documents that have a schema.
pub const DOCUMENTS: [&str; 11] = [
    "assess",
    "check",
    "evaluate",
    "explain",
    "identify",
    "inspect",
    "learn",
    "simplify",
    "tune",
    "watch",
    "watch-all",
];

/// The schema of a document, as `flagred schema` prints it.
pub fn printed(name: &str) -> Value {
    let output = crate::flagred().args(["schema", name]).output().unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The schema of a document with its references resolved.
pub fn schema(name: &str) -> Value {
    let schema = printed(name);
    resolved(&schema, &schema)
}

/// A part of a schema with its references resolved.
fn resolved(root: &Value, part: &Value) -> Value {
    match part {
        Value::Object(fields) => {
            let of = |(name, value): (&String, &Value)| (name.clone(), resolved(root, value));
            let mut all: serde_json::Map<String, Value> = fields.iter().map(of).collect();
            if let Some(Value::String(reference)) = all.remove("$ref") {
                let named = root.pointer(reference.strip_prefix('#').unwrap()).unwrap();
                let Value::Object(named) = resolved(root, named) else {
                    panic!("{reference}")
                };
                all.extend(named);
            }
            Value::Object(all)
        }
        Value::Array(items) => items.iter().map(|item| resolved(root, item)).collect(),
        other => other.clone(),
    }
}

/// The violations of a schema by a value, as `path: violation`.
pub fn errors(schema: &Value, value: &Value) -> Vec<String> {
    let mut found = Vec::new();
    check(schema, value, "$", &mut found);
    found
}

fn check(schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let mut wrong = |what: String| found.push(format!("{path}: {what}"));
    for (keyword, rule) in schema.as_object().unwrap() {
        match keyword.as_str() {
            "$schema" | "$id" | "$defs" | "title" | "description" | "additionalProperties" => {}
            "type" => {
                let types = rule
                    .as_array()
                    .map_or(std::slice::from_ref(rule), |all| all);
                if !types
                    .iter()
                    .any(|name| is_of(name.as_str().unwrap(), value))
                {
                    wrong(format!("{value} is not of type {rule}"));
                }
            }
            "const" if rule != value => wrong(format!("{value} is not {rule}")),
            "enum" if !rule.as_array().unwrap().contains(value) => {
                wrong(format!("{value} is none of {rule}"));
            }
            "minimum"
                if value
                    .as_f64()
                    .is_some_and(|value| Some(value) < rule.as_f64()) =>
            {
                wrong(format!("{value} is below {rule}"))
            }
            "maximum"
                if value
                    .as_f64()
                    .is_some_and(|value| Some(value) > rule.as_f64()) =>
            {
                wrong(format!("{value} is above {rule}"))
            }
            "exclusiveMinimum"
                if value
                    .as_f64()
                    .is_some_and(|value| Some(value) <= rule.as_f64()) =>
            {
                wrong(format!("{value} is not above {rule}"))
            }
            "minItems" | "maxItems" => {
                let items = value.as_array().map(|items| items.len() as u64);
                let (limit, is_least) = (rule.as_u64(), keyword == "minItems");
                if items.is_some()
                    && (if is_least {
                        items < limit
                    } else {
                        items > limit
                    })
                {
                    wrong(format!("not {rule} items"));
                }
            }
            "required" => {
                for name in rule.as_array().unwrap() {
                    if value.is_object() && value.get(name.as_str().unwrap()).is_none() {
                        wrong(format!("no {name}"));
                    }
                }
            }
            "dependentRequired" => {
                for (key, needed) in rule.as_object().unwrap() {
                    for name in needed.as_array().unwrap() {
                        let name = name.as_str().unwrap();
                        if value.get(key).is_some() && value.get(name).is_none() {
                            wrong(format!("{key} without {name}"));
                        }
                    }
                }
            }
            "anyOf" | "oneOf" => {
                let all = rule.as_array().unwrap();
                let valid = all.iter().filter(|one| errors(one, value).is_empty());
                let count = valid.count();
                if count == 0 || (count > 1 && keyword == "oneOf") {
                    wrong(format!("{value} is valid for {count} of {keyword}"));
                }
            }
            "const" | "enum" | "minimum" | "maximum" | "exclusiveMinimum" | "items"
            | "prefixItems" | "properties" => {}
            other => panic!("the keyword `{other}` is not checked"),
        }
    }
    for (i, item) in value.as_array().into_iter().flatten().enumerate() {
        let here = schema.get("prefixItems").and_then(|all| all.get(i));
        if let Some(items) = here.or(schema.get("items")) {
            check(items, item, &format!("{path}[{i}]"), found);
        }
    }
    for (name, field) in value.as_object().into_iter().flatten() {
        let path = format!("{path}.{name}");
        let known = schema.get("properties").and_then(|all| all.get(name));
        match known.or(schema.get("additionalProperties")) {
            Some(Value::Bool(false)) => found.push(format!("{path} is not described")),
            Some(Value::Bool(true)) | None => {}
            Some(schema) => check(schema, field, &path, found),
        }
    }
}

fn is_of(name: &str, value: &Value) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        other => panic!("no type `{other}`"),
    }
}

#[cfg(test)]
mod tests {
    use super::errors;
    use serde_json::json;

    #[test]
    fn keys_that_a_schema_does_not_describe_are_found() {
        let schema = json!({
            "type": "object",
            "properties": {
                "level": {"enum": ["GOOD", null]},
                "steps": {"type": "array", "maxItems": 2, "items": {"type": ["integer", "null"], "minimum": 1}},
                "kind": {"oneOf": [{"const": "a"}, {"type": "number"}]}
            },
            "required": ["level"],
            "additionalProperties": false
        });
        for good in [
            json!({"level": null}),
            json!({"level": "GOOD", "steps": [1, null], "kind": 0.5}),
        ] {
            assert_eq!(errors(&schema, &good), Vec::<String>::new());
        }
        for bad in [
            json!([]),
            json!({}),
            json!({"level": "BAD"}),
            json!({"level": null, "other": 1}),
            json!({"level": null, "steps": [0]}),
            json!({"level": null, "steps": [1.5]}),
            json!({"level": null, "steps": [1, 2, 3]}),
            json!({"level": null, "kind": "b"}),
        ] {
            assert_eq!(errors(&schema, &bad).len(), 1, "{bad}");
        }
    }
}
