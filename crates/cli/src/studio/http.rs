//! A minimal HTTP server for a page on the same machine: one request per connection, with bounded
//! lengths and durations.

use std::{
    borrow::Cow,
    io::{self, Read, Write},
    net::{Shutdown, TcpStream},
    time::{Duration, Instant},
};

/// Maximum number of bytes in the head of a request; browsers send about one kilobyte.
const HEAD: usize = 16_384;
const HEADERS: usize = 64;
/// Time limit for a request, including the remainder that is read after the answer.
const REQUEST_TIMEOUT: Duration = Duration::from_secs(10);
/// Time limit for the answer: the page may be sent through a slow tunnel.
const RESPONSE_TIMEOUT: Duration = Duration::from_secs(60);
/// Maximum number of bytes of a refused body that are read, so that the sender can receive the
/// answer.
const DRAINED: u64 = 64_000_000;

/// A request whose body has not been read yet.
pub(super) struct Request<S> {
    pub(super) method: String,
    /// The path without the query.
    pub(super) path: String,
    headers: Vec<(String, String)>,
    /// The beginning of the body, which arrived with the head.
    body_start: Vec<u8>,
    stream: S,
}

/// An error response: its status and its text.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Refusal(pub(super) Status, pub(super) String);

impl Refusal {
    pub(super) fn new(status: Status, words: &str) -> Refusal {
        Refusal(status, words.to_owned())
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Status(u16, &'static str);

impl Status {
    pub(super) const OK: Status = Status(200, "OK");
    pub(super) const NO_CONTENT: Status = Status(204, "No Content");
    pub(super) const SEE_OTHER: Status = Status(303, "See Other");
    pub(super) const NOT_MODIFIED: Status = Status(304, "Not Modified");
    pub(super) const BAD_REQUEST: Status = Status(400, "Bad Request");
    pub(super) const FORBIDDEN: Status = Status(403, "Forbidden");
    pub(super) const NOT_FOUND: Status = Status(404, "Not Found");
    pub(super) const METHOD_NOT_ALLOWED: Status = Status(405, "Method Not Allowed");
    pub(super) const LENGTH_REQUIRED: Status = Status(411, "Length Required");
    pub(super) const PRECONDITION_FAILED: Status = Status(412, "Precondition Failed");
    pub(super) const CONTENT_TOO_LARGE: Status = Status(413, "Content Too Large");
    pub(super) const PRECONDITION_REQUIRED: Status = Status(428, "Precondition Required");
    pub(super) const HEAD_TOO_LARGE: Status = Status(431, "Request Header Fields Too Large");
    pub(super) const INTERNAL_ERROR: Status = Status(500, "Internal Server Error");
}

/// A response to a request.
pub(super) struct Response<'a> {
    pub(super) status: Status,
    pub(super) headers: Vec<(&'static str, String)>,
    pub(super) body: Cow<'a, str>,
}

impl<S: Read> Request<S> {
    /// Reads the head. `None` if nothing arrived, as on connections that browsers open in advance.
    pub(super) fn read(mut stream: S) -> Result<Option<Request<S>>, Refusal> {
        let mut bytes = Vec::new();
        loop {
            let mut headers = [httparse::EMPTY_HEADER; HEADERS];
            let mut parsed = httparse::Request::new(&mut headers);
            let status = parsed.parse(&bytes).map_err(|error| match error {
                httparse::Error::TooManyHeaders => {
                    Status::HEAD_TOO_LARGE.refusal("too many headers")
                }
                error => {
                    Status::BAD_REQUEST.refusal(&format!("the request cannot be read: {error}"))
                }
            })?;
            if let httparse::Status::Complete(length) = status {
                let headers = parsed.headers.iter().map(|header| {
                    let value = String::from_utf8_lossy(header.value).into_owned();
                    (header.name.to_ascii_lowercase(), value)
                });
                let path = parsed.path.unwrap_or_default();
                return Ok(Some(Request {
                    method: parsed.method.unwrap_or_default().to_owned(),
                    path: path.split('?').next().unwrap_or_default().to_owned(),
                    headers: headers.collect(),
                    body_start: bytes.split_off(length),
                    stream,
                }));
            }
            if bytes.len() >= HEAD {
                return Err(Status::HEAD_TOO_LARGE.refusal("the head of the request is too large"));
            }
            let mut buffer = [0; 4096];
            match stream.read(&mut buffer) {
                Ok(count) if count > 0 => {
                    bytes.extend_from_slice(buffer.get(..count).unwrap_or_default());
                }
                _ if bytes.is_empty() => return Ok(None),
                _ => return Err(Status::BAD_REQUEST.refusal("the request ends too early")),
            }
        }
    }

    /// Returns the value of a header; repeated headers are joined into a list.
    pub(super) fn header(&self, name: &str) -> Option<String> {
        let named = self.headers.iter().filter(|(other, _)| other == name);
        let values: Vec<&str> = named.map(|(_, value)| value.as_str()).collect();
        (!values.is_empty()).then(|| values.join(", "))
    }

    /// Reads the body, a text of at most `limit` bytes.
    pub(super) fn body(&mut self, limit: usize) -> Result<String, Refusal> {
        let length = self.header("content-length");
        if self.header("transfer-encoding").is_some() {
            let status = match length {
                None => Status::LENGTH_REQUIRED,
                Some(_) => Status::BAD_REQUEST,
            };
            return Err(status.refusal("send the text with its length, not in chunks"));
        }
        if self.header("content-encoding").is_some() {
            return Err(Status::BAD_REQUEST.refusal("send the text without a content encoding"));
        }
        let length = length
            .and_then(|length| length.parse::<usize>().ok())
            .ok_or_else(|| Status::LENGTH_REQUIRED.refusal("the length of the text is missing"))?;
        if length > limit {
            let limit = limit / 1_000_000;
            return Err(
                Status::CONTENT_TOO_LARGE.refusal(&format!("the text is larger than {limit} MB"))
            );
        }
        let mut bytes = std::mem::take(&mut self.body_start);
        while bytes.len() < length {
            let mut buffer = [0; 16_384];
            match self.stream.read(&mut buffer) {
                Ok(count) if count > 0 => {
                    bytes.extend_from_slice(buffer.get(..count).unwrap_or_default());
                }
                _ => return Err(Status::BAD_REQUEST.refusal("the text ends too early")),
            }
        }
        bytes.truncate(length);
        String::from_utf8(bytes).map_err(|_| Status::BAD_REQUEST.refusal("the text is not UTF-8"))
    }
}

impl Status {
    pub(super) fn refusal(self, words: &str) -> Refusal {
        Refusal::new(self, words)
    }
}

impl From<Refusal> for Response<'_> {
    fn from(Refusal(status, words): Refusal) -> Self {
        Response {
            status,
            headers: vec![("Content-Type", "text/plain; charset=utf-8".to_owned())],
            body: words.into(),
        }
    }
}

impl Response<'_> {
    fn bytes(&self, with_body: bool) -> Vec<u8> {
        let Status(code, reason) = self.status;
        let mut text = format!("HTTP/1.1 {code} {reason}\r\nConnection: close\r\n");
        for (name, value) in &self.headers {
            text += &format!("{name}: {value}\r\n");
        }
        // Responses with these statuses have no body and no length.
        if !matches!(self.status, Status::NO_CONTENT | Status::NOT_MODIFIED) {
            text += &format!("Content-Length: {}\r\n", self.body.len());
        }
        text += "\r\n";
        let mut bytes = text.into_bytes();
        if with_body {
            bytes.extend_from_slice(self.body.as_bytes());
        }
        bytes
    }
}

/// A connection with a deadline, however slowly the client sends or reads.
pub(super) struct DeadlineStream<'s> {
    stream: &'s TcpStream,
    end: Instant,
}

impl<'s> DeadlineStream<'s> {
    fn new(stream: &'s TcpStream, patience: Duration) -> DeadlineStream<'s> {
        let end = Instant::now() + patience;
        DeadlineStream { stream, end }
    }

    fn left(&self) -> io::Result<Duration> {
        let left = self.end.saturating_duration_since(Instant::now());
        match left.is_zero() {
            true => Err(io::ErrorKind::TimedOut.into()),
            false => Ok(left),
        }
    }
}

impl Read for DeadlineStream<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        self.stream.read(bytes)
    }
}

impl Write for DeadlineStream<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Answers the request on a connection, and closes it. A HEAD request is answered like a GET request, but without the
/// body.
pub(super) fn serve<'a>(
    stream: &TcpStream,
    respond: impl FnOnce(&mut Request<&mut DeadlineStream<'_>>) -> Response<'a>,
) -> io::Result<()> {
    let mut reading = DeadlineStream::new(stream, REQUEST_TIMEOUT);
    let (response, with_body) = match Request::read(&mut reading) {
        Ok(None) => return Ok(()),
        Ok(Some(mut request)) => (respond(&mut request), request.method != "HEAD"),
        Err(refusal) => (refusal.into(), true),
    };
    DeadlineStream::new(stream, RESPONSE_TIMEOUT).write_all(&response.bytes(with_body))?;
    stream.shutdown(Shutdown::Write)?;
    // If the connection were closed with unread input, it would be reset and the answer would be lost.
    reading.end = reading.end.min(Instant::now() + Duration::from_secs(1));
    io::copy(&mut reading.take(DRAINED), &mut io::sink())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Option<Request<&[u8]>>, Refusal> {
        Request::read(text.as_bytes())
    }

    #[test]
    fn a_request_is_read_with_its_body() {
        let text = "PUT /a/b?c HTTP/1.1\r\nHOST: x\r\nContent-Length: 3\r\n\r\nabcd";
        let mut request = read(text).unwrap().unwrap();
        assert_eq!((&*request.method, &*request.path), ("PUT", "/a/b"));
        assert_eq!(request.header("host").as_deref(), Some("x"));
        assert_eq!(request.header("origin"), None);
        assert_eq!(request.body(3).unwrap(), "abc");
    }

    /// Two headers with the same name form a list, which is not a valid host, origin or length.
    #[test]
    fn a_repeated_header_has_no_single_value() {
        let text = "PUT / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 1\r\n\r\na";
        let mut request = read(text).unwrap().unwrap();
        assert_eq!(request.header("content-length").as_deref(), Some("1, 1"));
        assert_eq!(request.body(9).unwrap_err().0, Status::LENGTH_REQUIRED);
    }

    #[test]
    fn requests_that_are_too_large_or_too_short_are_refused() {
        let status = |text: &str| read(text).map(|_| ()).unwrap_err().0;
        assert!(read("").unwrap().is_none());
        assert_eq!(status("GET / HT"), Status::BAD_REQUEST);
        assert_eq!(status("\u{1}\r\n\r\n"), Status::BAD_REQUEST);
        let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(HEAD * 2));
        assert_eq!(status(&long), Status::HEAD_TOO_LARGE);
        let many = format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(HEADERS + 1));
        assert_eq!(status(&many), Status::HEAD_TOO_LARGE);
        for (length, status) in [
            ("99999999999999999999999", Status::LENGTH_REQUIRED),
            ("18446744073709551615", Status::CONTENT_TOO_LARGE),
            ("-1", Status::LENGTH_REQUIRED),
            ("5", Status::BAD_REQUEST),
        ] {
            let text = format!("PUT / HTTP/1.1\r\nContent-Length: {length}\r\n\r\nab");
            let refused = read(&text).unwrap().unwrap().body(9).unwrap_err();
            assert_eq!(refused.0, status, "{length}");
        }
    }

    #[test]
    fn any_bytes_are_answered() {
        let seed =
            "PUT /token/api/file HTTP/1.1\r\nHost: 127.0.0.1:1\r\nContent-Length: 4\r\n\r\nabcd";
        let mut random = fastrand::Rng::with_seed(24);
        for _ in 0..20_000 {
            let mut bytes = seed.as_bytes().to_vec();
            for _ in 0..random.usize(1..6) {
                let at = random.usize(..bytes.len());
                bytes[at] = random.u8(..);
            }
            bytes.truncate(random.usize(..=bytes.len()));
            if let Ok(Some(mut request)) = Request::read(bytes.as_slice()) {
                assert!(request.body(100).map_or(0, |text| text.len()) <= 100);
            }
        }
    }
}
