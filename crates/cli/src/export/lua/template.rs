//! Templates of the script: `-- @put name` is replaced by lines, and the lines between `-- @if name`, `-- @else` and `-- @end` are kept
//! only if the condition holds.

/// The values for a template.
#[derive(Default)]
pub(super) struct TemplateValues {
    conditions: Vec<(&'static str, bool)>,
    lines: Vec<(&'static str, Vec<String>)>,
    constants: Vec<(&'static str, String)>,
}

impl TemplateValues {
    /// Sets a condition.
    pub(super) fn set(&mut self, name: &'static str, holds: bool) {
        self.conditions.push((name, holds));
    }

    /// Sets the lines that replace `-- @put name`.
    pub(super) fn put(&mut self, name: &'static str, lines: Vec<String>) {
        self.lines.push((name, lines));
    }

    /// Sets the value that replaces a name in capitals outside strings and comments.
    pub(super) fn constant(&mut self, name: &'static str, value: String) {
        self.constants.push((name, value));
    }

    /// Returns the script. Unknown names in capitals are kept, and unknown conditions are false.
    pub(super) fn fill(&self, template: &str) -> String {
        let (mut out, mut kept) = (String::new(), Vec::new());
        for line in template.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["--", "@if", name] => kept.push(self.is_set(name)),
                ["--", "@else"] => {
                    if let Some(last) = kept.last_mut() {
                        *last = !*last;
                    }
                }
                ["--", "@end"] => {
                    kept.pop();
                }
                _ if kept.contains(&false) => {}
                ["--", "@put", name] => {
                    let found = self.lines.iter().find(|(known, _)| *known == name);
                    for line in found.iter().flat_map(|(_, lines)| lines) {
                        out.push_str(line);
                        out.push('\n');
                    }
                }
                _ => {
                    self.line(line, &mut out);
                    out.push('\n');
                }
            }
        }
        out
    }

    /// Appends a line of the template with constants replaced by their values.
    fn line(&self, line: &str, out: &mut String) {
        let code = line.find("--").unwrap_or(line.len());
        let (code, comment) = line.split_at(code);
        for (i, part) in code.split('"').enumerate() {
            if i > 0 {
                out.push('"');
            }
            match i % 2 {
                0 => self.code(part, out),
                _ => out.push_str(part),
            }
        }
        out.push_str(comment);
    }

    fn code(&self, code: &str, out: &mut String) {
        let is_of_a_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let mut rest = code;
        while let Some(start) = rest.find(is_of_a_name) {
            let (before, from) = rest.split_at(start);
            let end = from.find(|c| !is_of_a_name(c)).unwrap_or(from.len());
            let (word, after) = from.split_at(end);
            let known = self.constants.iter().find(|(name, _)| *name == word);
            out.push_str(before);
            out.push_str(known.map_or(word, |(_, value)| value));
            rest = after;
        }
        out.push_str(rest);
    }

    pub(super) fn is_set(&self, name: &str) -> bool {
        self.conditions
            .iter()
            .any(|(known, holds)| *known == name && *holds)
    }
}
