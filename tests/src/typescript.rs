//! TypeScript declarations from JSON Schemas.
#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    reason = "helpers of tests: what does not hold fails the test"
)]

use std::fmt::Write as _;

use serde_json::Value;

/// A declaration for each of the `$defs` of a schema.
pub fn declarations(schema: &Value) -> String {
    let types = schema["$defs"].as_object().unwrap();
    let mut names: Vec<&String> = types.keys().collect();
    names.sort();
    let mut text = String::new();
    for name in names {
        let schema = &types[name];
        comment(&mut text, "", schema);
        match schema.get("properties") {
            Some(_) => writeln!(text, "export interface {name} {}\n", object(schema, "")),
            None => writeln!(text, "export type {name} = {};\n", of(schema, "")),
        }
        .unwrap();
    }
    text.truncate(text.trim_end().len());
    text + "\n"
}

/// The description of a schema as a comment.
fn comment(text: &mut String, indent: &str, schema: &Value) {
    if let Some(Value::String(description)) = schema.get("description") {
        writeln!(text, "{indent}/** {description} */").unwrap();
    }
}

fn object(schema: &Value, indent: &str) -> String {
    let inner = format!("{indent}  ");
    let required = schema.get("required").and_then(Value::as_array);
    let mut text = String::from("{\n");
    for (name, field) in schema["properties"].as_object().unwrap() {
        comment(&mut text, &inner, field);
        let is_required = required.is_some_and(|all| all.iter().any(|one| one == name));
        let mark = if is_required { "" } else { "?" };
        writeln!(text, "{inner}{name}{mark}: {};", of(field, &inner)).unwrap();
    }
    text + indent + "}"
}

/// The type of a schema.
fn of(schema: &Value, indent: &str) -> String {
    let list = |keyword: &str| schema.get(keyword).and_then(Value::as_array);
    let union = |all: Vec<String>| all.join(" | ");
    if let Some(Value::String(reference)) = schema.get("$ref") {
        return reference.trim_start_matches("#/$defs/").to_owned();
    }
    if let Some(value) = schema.get("const") {
        return literal(value);
    }
    if let Some(all) = list("enum") {
        return union(all.iter().map(literal).collect());
    }
    if let Some(all) = list("anyOf").or(list("oneOf")) {
        return union(all.iter().map(|one| of(one, indent)).collect());
    }
    match &schema["type"] {
        Value::String(name) => named(name, schema, indent),
        Value::Array(names) => {
            let names = names.iter().map(|name| name.as_str().unwrap());
            union(names.map(|name| named(name, schema, indent)).collect())
        }
        _ => panic!("no type: {schema}"),
    }
}

fn named(name: &str, schema: &Value, indent: &str) -> String {
    match name {
        "integer" | "number" => "number".to_owned(),
        "boolean" | "string" | "null" => name.to_owned(),
        "array" => match schema.get("prefixItems").and_then(Value::as_array) {
            Some(all) => {
                let all: Vec<String> = all.iter().map(|one| of(one, indent)).collect();
                format!("[{}]", all.join(", "))
            }
            None => match of(&schema["items"], indent) {
                item if item.contains(" | ") => format!("({item})[]"),
                item => format!("{item}[]"),
            },
        },
        "object" => match schema.get("properties") {
            Some(_) => object(schema, indent),
            None => format!(
                "Record<string, {}>",
                of(&schema["additionalProperties"], indent)
            ),
        },
        other => panic!("no type `{other}`"),
    }
}

fn literal(value: &Value) -> String {
    match value {
        Value::String(text) => format!("'{text}'"),
        other => other.to_string(),
    }
}
