//! Messages on standard input: a header with the length, then JSON. The length is bounded, so that a wrong length
//! cannot exhaust memory.

use std::io::{self, BufRead, Read};

use fuzzy::diagnostic::quoted;
use lsp_server::Message;

use crate::output::print_note;

/// Maximum number of bytes of a message: the largest rule set, with every fourth character escaped.
const LONGEST: u64 = 16_000_000;
/// Maximum number of bytes of a header line.
const LONGEST_LINE: u64 = 4096;

/// Reads a message; `None` at the end. Messages that are too long or malformed are skipped, since the next ones can
/// still be read.
///
/// # Errors
/// If the header of a message cannot be read, because the end of the message is then unknown.
pub(super) fn read<R: BufRead>(from: &mut R) -> io::Result<Option<Message>> {
    while let Some(length) = head(from)? {
        if length > LONGEST {
            print_note(&format!(
                "a message of {length} bytes is skipped: the limit is {LONGEST}"
            ));
            io::copy(&mut from.by_ref().take(length), &mut io::sink())?;
            continue;
        }
        let mut text = Vec::new();
        from.by_ref().take(length).read_to_end(&mut text)?;
        if (text.len() as u64) < length {
            return Ok(None);
        }
        match serde_json::from_slice(&text) {
            Ok(message) => return Ok(Some(message)),
            Err(error) => print_note(&format!("a message is skipped: {error}")),
        }
    }
    Ok(None)
}

/// Reads a header, and returns the length of its message; `None` at the end.
fn head<R: BufRead>(from: &mut R) -> io::Result<Option<u64>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        from.by_ref()
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line)?;
        if line.is_empty() {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim_end();
        if line.is_empty() {
            let missing = || invalid("the `Content-Length` of a message is missing".into());
            return length.map(Some).ok_or_else(missing);
        }
        let Some((name, value)) = line.split_once(": ") else {
            return Err(invalid(format!("`{}` is not a header line", quoted(line))));
        };
        if name.eq_ignore_ascii_case("content-length") {
            let wrong = |_| {
                invalid(format!(
                    "`{}` is not the length of a message",
                    quoted(value)
                ))
            };
            length = Some(value.parse().map_err(wrong)?);
        }
    }
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{text}", text.len())
    }

    const EXIT: &str = "{\"jsonrpc\":\"2.0\",\"method\":\"exit\"}";

    #[test]
    fn messages_that_are_too_long_or_damaged_are_skipped() {
        let long = message(&" ".repeat(LONGEST as usize + 1));
        let all = format!("{long}{}{}", message("{"), message(EXIT));
        let mut all = all.as_bytes();
        let read_one = |from: &mut &[u8]| read(from).unwrap();
        assert!(
            matches!(read_one(&mut all), Some(Message::Notification(one)) if one.method == "exit")
        );
        assert!(read_one(&mut all).is_none());
    }

    /// If a header announces an excessive length, no buffer of that length is allocated.
    #[test]
    fn a_message_without_end_takes_little_memory() {
        for length in ["18446744073709551615", "99999999999999", "3000000000"] {
            let text = format!("Content-Length: {length}\r\n\r\n{EXIT}");
            assert!(read(&mut text.as_bytes()).unwrap().is_none(), "{length}");
        }
        let cut_off = format!("Content-Length: 15999999\r\n\r\n{EXIT}");
        assert!(read(&mut cut_off.as_bytes()).unwrap().is_none());
    }

    #[test]
    fn a_head_that_cannot_be_read_is_an_error() {
        for (head, reported) in [
            ("Content-Length: x\r\n\r\n", "`x` is not the length"),
            (
                "Content-Length: 18446744073709551616\r\n\r\n",
                "is not the length",
            ),
            ("Content-Type: y\r\n\r\n", "is missing"),
            ("GET / HTTP/1.1\r\n\r\n", "is not a header line"),
        ] {
            let error = read(&mut head.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(reported), "{error}");
        }
    }
}
