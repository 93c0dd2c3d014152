//! Rewrites the text of a rule set that was changed in a program. Unchanged parts keep their text, including comments.

use std::ops::Range;

use fuzzy::{
    Model,
    format::{self, Document},
    tree::{Node, Value},
    yaml,
};

use crate::{Edit, edited, numbers};

/// Returns `text`, edited so that it describes the rule set `wanted`. If its entries can be changed, added and removed in
/// place, all other lines are kept; otherwise the rule set is written anew, below the comments at the top of the text.
///
/// ```
/// let text = "fuzzy: 1
/// name: fan # short
/// inputs: {heat: {range: [0, 40], partition: {cool: 5, hot: 35}}}
/// outputs: {speed: {range: [0, 9], partition: [slow, fast]}}
/// rules:
///   ## from the manual
///   - IF heat IS hot THEN speed IS fast # loud
/// ";
/// let document = fuzzy::yaml::parse(text)?;
/// let mut wanted = document.model.clone();
/// wanted.rules[0].rule = fuzzy::rule::parse("IF heat IS hot THEN speed IS slow").map_err(|finding| finding.message)?;
/// let expected = text.replace("THEN speed IS fast", "THEN speed IS slow");
/// assert_eq!(flagred_authoring::rewrite::rewritten(text, &document, &wanted), expected);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rewritten(text: &str, document: &Document, wanted: &Model) -> String {
    if document.model == *wanted {
        return text.to_owned();
    }
    if flagred_interchange::Format::of(text).is_some() {
        return yaml::to_string(wanted);
    }
    let means_it = |text: &String| {
        let tree = yaml::read(text).ok();
        let read = tree.and_then(|tree| format::read_unfinished(&tree).ok());
        read.is_some_and(|read| read.model == *wanted)
    };
    let by_number = numbers::of_model(text, document, wanted).map(|edits| edited(text, &edits));
    if let Some(text) = by_number.filter(means_it) {
        return text;
    }
    let by_entry = entries(text, &document.model, wanted).map(|edits| edited(text, &edits));
    if let Some(text) = by_entry.filter(means_it) {
        return text;
    }
    head(text) + &yaml::to_string(wanted)
}

/// The comments at the start of a text.
pub(crate) fn head(text: &str) -> String {
    let lines = text.split_inclusive('\n');
    lines.take_while(|line| line.starts_with('#')).collect()
}

/// The edits of the entries that differ; `None` if these entries cannot be changed in place.
fn entries(text: &str, before: &Model, after: &Model) -> Option<Vec<Edit>> {
    let tree = yaml::read(text).ok()?;
    let mut changes = Changes {
        text,
        edits: Vec::new(),
    };
    changes.node(&tree, &format::write(before), &format::write(after))?;
    Some(changes.edits)
}

struct Changes<'t> {
    text: &'t str,
    edits: Vec<Edit>,
}

impl<'t> Changes<'t> {
    fn replace(&mut self, span: Range<usize>, text: String) {
        self.edits.push(Edit { span, text });
    }

    /// Changes the node `written` where `after` differs from `before`; `None` if that is not possible in place.
    fn node(&mut self, written: &Node, before: &Node, after: &Node) -> Option<()> {
        if before == after {
            return Some(());
        }
        match (&written.value, &before.value, &after.value) {
            (Value::Mapping(there), Value::Mapping(before), Value::Mapping(after))
                if !there.is_empty() && !after.is_empty() =>
            {
                self.mapping(there, before, after)
            }
            (Value::List(there), Value::List(before), Value::List(after))
                if there.len() == before.len() && !there.is_empty() && !after.is_empty() =>
            {
                self.list(there, before, after)
            }
            // The rule is a mapping with the single key `rule` in the text, and a scalar in the model.
            (Value::Mapping(there), _, Value::Scalar(_)) => {
                let (_, rule) = there
                    .iter()
                    .find(|(key, _)| key.as_text() == Some("rule"))?;
                let only = there.len() == 1;
                only.then(|| self.replace(rule.span.clone(), yaml::to_line(after)))
            }
            _ => {
                let span = written.span.clone();
                let ended = self.text.get(span.clone())?.trim_end().len();
                (ended > 0)
                    .then(|| self.replace(span.start..span.start + ended, yaml::to_line(after)))
            }
        }
    }

    fn mapping(
        &mut self,
        there: &[(Node, Node)],
        before: &[(Node, Node)],
        after: &[(Node, Node)],
    ) -> Option<()> {
        fn value<'n>(entries: &'n [(Node, Node)], key: &Node) -> Option<&'n Node> {
            let found = entries
                .iter()
                .find(|(other, _)| other.as_text() == key.as_text());
            found.map(|(_, value)| value)
        }
        let gone = |key: &Node| value(before, key).is_some() && value(after, key).is_none();
        for (i, (key, old)) in there.iter().enumerate() {
            if gone(key) {
                self.remove(
                    key.span.start..end(self.text, old),
                    i.checked_sub(1).map(|i| end(self.text, &there[i].1)),
                    there.get(i + 1).map(|(key, _)| key.span.start),
                )?;
            }
        }
        for (key, new) in after {
            match (value(there, key), value(before, key)) {
                (Some(old), Some(before)) => self.node(old, before, new)?,
                (None, Some(before)) if before == new => {}
                _ => {
                    let (last, old) = there.last()?;
                    let entry = format!("{}: {}", yaml::to_line(key), yaml::to_line(new));
                    self.insert_behind(last.span.start, end(self.text, old), "", &entry)?;
                }
            }
        }
        Some(())
    }

    fn list(&mut self, there: &[Node], before: &[Node], after: &[Node]) -> Option<()> {
        let same = |(before, after): &(&Node, &Node)| before == after;
        let first = before.iter().zip(after).take_while(same).count();
        let rest = before.len().min(after.len()) - first;
        let backwards = before.iter().rev().zip(after.iter().rev());
        let last = backwards.take(rest).take_while(same).count();
        let (old, new) = (first..before.len() - last, first..after.len() - last);
        let both = old.len().min(new.len());
        for i in 0..both {
            self.node(&there[first + i], &before[first + i], &after[first + i])?;
        }
        for i in first + both..old.end {
            self.remove(
                there[i].span.start..end(self.text, &there[i]),
                i.checked_sub(1).map(|i| end(self.text, &there[i])),
                there.get(i + 1).map(|next| next.span.start),
            )?;
        }
        let added = after.get(first + both..new.end)?;
        let lines: Vec<String> = added.iter().map(yaml::to_line).collect();
        if lines.is_empty() {
            return Some(());
        }
        match (first + both).checked_sub(1) {
            Some(at) => {
                let behind = &there[at];
                for line in &lines {
                    self.insert_behind(behind.span.start, end(self.text, behind), "- ", line)?;
                }
            }
            None => {
                let start = there[0].span.start;
                match self.indent(start) {
                    Some(dash) => {
                        let at = start - self.column(start);
                        let indent = dash.split('-').next()?;
                        let lines = lines.iter().map(|line| format!("{indent}- {line}\n"));
                        self.replace(at..at, lines.collect());
                    }
                    None => self.replace(start..start, lines.join(", ") + ", "),
                }
            }
        }
        Some(())
    }

    /// Adds an entry after another one: on a separate line in a block, on the same line in `[...]` and `{...}`.
    fn insert_behind(&mut self, start: usize, end: usize, mark: &str, entry: &str) -> Option<()> {
        match self.indent(start) {
            Some(before) => {
                let indent = before.split('-').next()?;
                let line = self.text.get(end..)?.find('\n').map(|length| end + length);
                let at = line.unwrap_or(self.text.len());
                // In a list that is itself an item of a list, the first line has dashes in place of the indentation
                // that the new entry needs.
                let is_nested = before.matches('-').count() > mark.trim().len();
                (!is_nested).then(|| self.replace(at..at, format!("\n{indent}{mark}{entry}")))
            }
            None => {
                self.replace(end..end, format!(", {entry}"));
                Some(())
            }
        }
    }

    /// Removes an entry: its lines in a block, or the entry and a comma in `[...]` and `{...}`.
    fn remove(
        &mut self,
        entry: Range<usize>,
        before: Option<usize>,
        next: Option<usize>,
    ) -> Option<()> {
        if self.indent(entry.start).is_some() {
            let start = entry.start - self.column(entry.start);
            let end = self.text.get(entry.end..)?.find('\n');
            let end = end.map_or(self.text.len(), |length| entry.end + length + 1);
            self.replace(start..end, String::new());
            return Some(());
        }
        match (before, next) {
            (_, Some(next)) => self.replace(entry.start..next, String::new()),
            (Some(before), None) => self.replace(before..entry.end, String::new()),
            (None, None) => return None,
        }
        Some(())
    }

    fn column(&self, at: usize) -> usize {
        let line = self
            .text
            .get(..at)
            .and_then(|text| text.rsplit('\n').next());
        line.map_or(0, str::len)
    }

    /// The text before an entry on its line, if that text consists of spaces and dashes, that is,
    /// if the entry is in a block.
    fn indent(&self, at: usize) -> Option<&'t str> {
        let text: &'t str = self.text;
        let line = text.get(..at)?.rsplit('\n').next()?;
        line.chars().all(|c| c == ' ' || c == '-').then_some(line)
    }
}

/// The end of a node's text, without trailing spaces.
fn end(text: &str, node: &Node) -> usize {
    let written = text.get(node.span.clone()).unwrap_or("");
    node.span.start + written.trim_end().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAN: &str = "# The fan of the server room.
fuzzy: 1
name: fan # short
inputs:
  # by the door
  heat: {range: [0, 40], unit: °C, partition: {cool: 5, hot: 35}} # sensor 1
outputs:
  speed: {range: [0, 9], partition: [slow, fast]}
rules:
  # from the manual
  - IF heat IS cool THEN speed IS slow # quiet
  - IF heat IS hot THEN speed IS fast # loud
";

    fn changed(text: &str, change: impl FnOnce(&mut Model)) -> String {
        let document = yaml::parse(text).unwrap();
        let mut wanted = document.model.clone();
        change(&mut wanted);
        let rewritten = rewritten(text, &document, &wanted);
        assert_eq!(
            yaml::parse(&rewritten).unwrap().model,
            wanted,
            "{rewritten}"
        );
        rewritten
    }

    fn rule(text: &str) -> fuzzy::model::Rule {
        let text = FAN.replace("IF heat IS hot THEN speed IS fast", text);
        yaml::parse(&text).unwrap().model.rules.remove(1)
    }

    #[test]
    fn comments_stay_where_entries_change() {
        let weighted = "IF heat IS hot THEN speed IS fast WITH 0.5";
        assert_eq!(
            changed(FAN, |model| model.rules[1] = rule(weighted)),
            FAN.replace("IF heat IS hot THEN speed IS fast", weighted)
        );
        let other = "IF heat IS NOT cool THEN speed IS fast";
        assert_eq!(
            changed(FAN, |model| model.rules[1] = rule(other)),
            FAN.replace("IF heat IS hot THEN speed IS fast", other)
        );
        assert_eq!(
            changed(FAN, |model| model.name = "fan of two".into()),
            FAN.replace("name: fan #", "name: fan of two #")
        );
        assert_eq!(
            changed(FAN, |model| model.inputs[0].high = 45.0),
            FAN.replace("[0, 40]", "[0, 45]")
        );
        assert_eq!(
            changed(FAN, |model| model.inputs[0].unit = None),
            FAN.replace("unit: °C, ", "")
        );
    }

    #[test]
    fn comments_stay_where_entries_are_added_and_removed() {
        let added = "IF heat IS very hot THEN speed IS fast";
        assert_eq!(
            changed(FAN, |model| model.rules.push(rule(added))),
            FAN.replace("# loud\n", &format!("# loud\n  - {added}\n"))
        );
        assert_eq!(
            changed(FAN, |model| model.rules.insert(0, rule(added))),
            FAN.replace(
                "  - IF heat IS cool",
                &format!("  - {added}\n  - IF heat IS cool")
            )
        );
        assert_eq!(
            changed(FAN, |model| drop(model.rules.remove(0))),
            FAN.replace("  - IF heat IS cool THEN speed IS slow # quiet\n", "")
        );
        let described = changed(FAN, |model| model.description = Some("cools".into()));
        assert!(described.contains("# quiet") && described.contains("description: cools\n"));
        let second = changed(FAN, |model| {
            let mut damp = model.inputs[0].clone();
            damp.name = "damp".into();
            model.inputs.push(damp);
        });
        assert!(second.contains("# sensor 1\n  damp: {"), "{second}");
    }

    #[test]
    fn in_one_line_entries_are_added_and_removed_with_their_commas() {
        let flow = FAN.split("rules:").next().unwrap().to_owned()
            + "rules: [IF heat IS cool THEN speed IS slow, IF heat IS hot THEN speed IS fast] # both\n";
        let one = changed(&flow, |model| drop(model.rules.remove(0)));
        assert!(
            one.ends_with("rules: [IF heat IS hot THEN speed IS fast] # both\n"),
            "{one}"
        );
        let added = "IF heat IS very hot THEN speed IS fast";
        let three = changed(&flow, |model| model.rules.push(rule(added)));
        assert!(
            three.contains("IS fast, IF heat IS very hot THEN speed IS fast] # both"),
            "{three}"
        );
    }

    #[test]
    fn text_that_cannot_change_in_place_is_rewritten_below_the_header() {
        let reordered = changed(FAN, |model| {
            let mut damp = model.inputs[0].clone();
            damp.name = "damp".into();
            model.inputs.insert(0, damp);
        });
        assert!(reordered.starts_with("# The fan of the server room.\nfuzzy: 1\n"));
    }
}
