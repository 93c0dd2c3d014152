//! Splits FCL into names, numbers and symbols, without comments.

/// The words of a text. Comments extend from `//` to the end of the line, and between `/*` and `*/` or `(*` and `*)`.
pub(super) fn words(text: &str) -> Vec<&str> {
    let mut words = vec![];
    let mut rest = text;
    loop {
        rest = rest.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}');
        let Some(first) = rest.chars().next() else {
            return words;
        };
        let length = comment(rest)
            .or_else(|| number(rest))
            .unwrap_or_else(|| sign_or_name(rest, first));
        let (word, after) = rest.split_at(length);
        if comment(rest).is_none() {
            words.push(word);
        }
        rest = after;
    }
}

fn comment(rest: &str) -> Option<usize> {
    let until = |open: &str, close: &str| {
        let inner = rest.strip_prefix(open)?;
        Some(
            inner
                .find(close)
                .map_or(rest.len(), |at| open.len() + at + close.len()),
        )
    };
    until("//", "\n")
        .or_else(|| until("/*", "*/"))
        .or_else(|| until("(*", "*)"))
}

/// The length of the number at the start of `rest`. In `1..2`, the number ends before the two dots.
fn number(rest: &str) -> Option<usize> {
    let bytes = rest.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let sign = usize::from(matches!(bytes.first(), Some(b'-' | b'+')));
    let mut end = digits(sign);
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1) != Some(&b'.') {
        end = digits(end + 1);
    }
    if !bytes.get(sign..end)?.iter().any(u8::is_ascii_digit) {
        return None;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'-' | b'+')));
        let exponent = digits(end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    Some(end)
}

fn sign_or_name(rest: &str, first: char) -> usize {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    if is_name(first) {
        return rest.find(|c| !is_name(c)).unwrap_or(rest.len());
    }
    if rest.starts_with(":=") || rest.starts_with("..") {
        return 2;
    }
    first.len_utf8()
}
