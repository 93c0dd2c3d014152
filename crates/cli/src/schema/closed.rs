//! Derived schemas, simplified for programs and people: every object is closed, and descriptions are plain text.

use serde_json::{Map, Value};

type Object = Map<String, Value>;

/// Closes a schema: objects may have only the properties that it describes.
///
/// Fields that serde flattens are derived as a reference or as alternatives beside `properties`. They are merged before the objects
/// are closed, since `additionalProperties` considers only the `properties` beside it.
pub(super) fn closed(mut root: Value) -> Value {
    let types = root.get("$defs").cloned().unwrap_or_default();
    close(&mut root, &types);
    drop_unused(&mut root);
    root
}

fn close(schema: &mut Value, types: &Value) {
    match schema {
        Value::Array(items) => items.iter_mut().for_each(|item| close(item, types)),
        Value::Object(object) => {
            object.remove("format");
            if let Some(Value::String(text)) = object.get_mut("description") {
                *text = plain(text);
            }
            if object.contains_key("properties") {
                merge_reference(object, types);
                merge_alternatives(object);
            }
            if object.contains_key("properties") {
                let closed = object.entry("additionalProperties");
                closed.or_insert(Value::Bool(false));
            }
            for (keyword, part) in object.iter_mut() {
                match (keyword.as_str(), part) {
                    // These keys are names, not keywords.
                    ("properties" | "$defs", Value::Object(named)) => {
                        named.values_mut().for_each(|part| close(part, types));
                    }
                    (_, part) => close(part, types),
                }
            }
        }
        _ => {}
    }
}

/// Replaces an object's reference by the properties of the type that it refers to.
fn merge_reference(object: &mut Object, types: &Value) {
    let Some(Value::String(reference)) = object.get("$ref") else {
        return;
    };
    let name = reference.trim_start_matches("#/$defs/").to_owned();
    if let Some(Value::Object(named)) = types.get(&name) {
        object.remove("$ref");
        *object = merged(object, named);
    }
}

/// Moves the properties of an object into each of its alternatives.
fn merge_alternatives(object: &mut Object) {
    let Some(alternatives) = alternatives(object) else {
        return;
    };
    let common = ["properties", "required"].map(|name| object.remove_entry(name));
    let common: Object = common.into_iter().flatten().collect();
    object.remove("type");
    let mut all = Vec::new();
    flat(alternatives, &mut all);
    let merged = all.iter().map(|one| Value::Object(merged(&common, one)));
    object.insert("anyOf".into(), merged.collect());
}

/// Removes the alternatives from an object and returns them.
fn alternatives(object: &mut Object) -> Option<Vec<Value>> {
    let mut found = ["oneOf", "anyOf"].into_iter();
    match found.find_map(|keyword| object.remove(keyword)) {
        Some(Value::Array(alternatives)) => Some(alternatives),
        _ => None,
    }
}

/// Collects alternatives, including nested ones.
fn flat(found: Vec<Value>, all: &mut Vec<Object>) {
    for alternative in found {
        let Value::Object(mut alternative) = alternative else {
            continue;
        };
        match alternatives(&mut alternative) {
            Some(inner) => flat(inner, all),
            None => all.push(alternative),
        }
    }
}

/// Merges the keywords of two objects. The keywords of `first` take precedence; the properties and required names of
/// `second` are appended.
fn merged(first: &Object, second: &Object) -> Object {
    let mut all = first.clone();
    for (keyword, value) in second {
        match (all.get_mut(keyword), value) {
            (Some(Value::Object(known)), Value::Object(more)) => known.extend(more.clone()),
            (Some(Value::Array(known)), Value::Array(more)) => known.extend(more.clone()),
            (Some(_), _) => {}
            (None, value) => _ = all.insert(keyword.clone(), value.clone()),
        }
    }
    all
}

/// Removes types that nothing refers to. A schema that consists only of types keeps them all.
fn drop_unused(root: &mut Value) {
    let text = root.to_string();
    if let Value::Object(object) = root
        && object.len() > 1
        && let Some(Value::Object(types)) = object.get_mut("$defs")
    {
        types.retain(|name, _| text.contains(&format!("\"#/$defs/{name}\"")));
    }
}

/// Returns the first paragraph of a doc comment, without links and with `null` for `None`.
fn plain(doc: &str) -> String {
    let first = doc.split("\n\n").next().unwrap_or_default();
    let mut text = first.replace('\n', " ").replace("`None`", "null");
    while let Some(end) = text.find("`](") {
        let close = text.get(end..).and_then(|rest| rest.find(')'));
        let Some(close) = close else { break };
        text.replace_range(end + 1..=end + close, "");
    }
    text.replace("[`", "`").replace("`]", "`")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn flattened_parts_are_merged_before_objects_are_closed() {
        let schema = json!({
            "type": "object",
            "properties": {"at_s": {"type": "number", "format": "double"}, "format": {"type": "string"}},
            "required": ["at_s"],
            "oneOf": [
                {"type": "object", "properties": {"event": {"const": "a"}}, "required": ["event"], "$ref": "#/$defs/A"},
                {"anyOf": [{"type": "object", "properties": {"event": {"const": "b"}}, "required": ["event"]}]},
            ],
            "$defs": {"A": {"type": "object", "properties": {"more": {"type": "string"}}, "required": ["more"]}},
        });
        let expected = json!({
            "anyOf": [
                {
                    "properties": {"at_s": {"type": "number"}, "format": {"type": "string"}, "event": {"const": "a"}, "more": {"type": "string"}},
                    "required": ["at_s", "event", "more"],
                    "type": "object",
                    "additionalProperties": false,
                },
                {
                    "properties": {"at_s": {"type": "number"}, "format": {"type": "string"}, "event": {"const": "b"}},
                    "required": ["at_s", "event"],
                    "type": "object",
                    "additionalProperties": false,
                },
            ],
            "$defs": {},
        });
        assert_eq!(closed(schema), expected);
    }

    #[test]
    fn descriptions_are_plain_text() {
        let doc = "The value in [0, 1]\nof [`Step::inputs`] ([`Update::judged`](crate::Update::judged));\n`None` is unknown.\n\n# Example";
        assert_eq!(
            plain(doc),
            "The value in [0, 1] of `Step::inputs` (`Update::judged`); null is unknown."
        );
    }
}
