//! The script with places to fill: `-- @put name` is replaced by lines, and what stands between `-- @if name`, `-- @else` and
//! `-- @end` is kept where it holds.

/// What fills the places.
#[derive(Default)]
pub(super) struct Filling {
    holds: Vec<(&'static str, bool)>,
    lines: Vec<(&'static str, Vec<String>)>,
}

impl Filling {
    /// Whether a part is kept.
    pub(super) fn set(&mut self, name: &'static str, holds: bool) {
        self.holds.push((name, holds));
    }

    /// The lines of a place.
    pub(super) fn put(&mut self, name: &'static str, lines: Vec<String>) {
        self.lines.push((name, lines));
    }

    /// The script. A name that is not known is kept as it is, and counts as not holding.
    pub(super) fn fill(&self, template: &str) -> String {
        let (mut out, mut kept) = (String::new(), Vec::new());
        for line in template.lines() {
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["--", "@if", name] => kept.push(self.holds(name)),
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
                    out.push_str(line);
                    out.push('\n');
                }
            }
        }
        out
    }

    fn holds(&self, name: &str) -> bool {
        self.holds
            .iter()
            .any(|(known, holds)| *known == name && *holds)
    }
}
