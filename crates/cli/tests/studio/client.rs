//! A running `flagred studio`, and requests as a browser or another program sends them.

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

pub(crate) const POLICY: &str = "default-src 'none'; script-src 'sha256-abc='; connect-src 'self'";
pub(crate) const RULES: &str = "fuzzy: 1\nname: fan\n";

/// A placeholder for the page; its contents do not matter in these tests.
pub(crate) fn page() -> String {
    format!(
        "<!doctype html><meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\
         <title>flagred</title>"
    )
}

/// A running `flagred studio` that serves the placeholder page.
pub(crate) struct Studio {
    child: Child,
    /// The host and port.
    pub(crate) authority: String,
    pub(crate) token: String,
    pub(crate) said: Vec<String>,
}

impl Studio {
    pub(crate) fn start(folder: &Path, arguments: &[&str]) -> Studio {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flagred"));
        command.arg("studio").args(arguments).arg("--no-browser");
        Studio::run(command, folder)
    }

    pub(crate) fn run(mut command: Command, folder: &Path) -> Studio {
        fs::write(folder.join("page.html"), page()).unwrap();
        let mut child = command
            .args(["--page", "page.html"])
            .current_dir(folder)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let mut said = Vec::new();
        for line in lines {
            said.push(line.unwrap());
            if said.last().unwrap().starts_with("Ctrl-C") {
                break;
            }
        }
        let address = said[0].strip_prefix("http://").unwrap();
        let (authority, token) = address.trim_end_matches('/').split_once('/').unwrap();
        let (authority, token) = (authority.to_owned(), token.to_owned());
        Studio {
            child,
            authority,
            token,
            said,
        }
    }

    /// Sends a request unchanged, and reads the answer.
    pub(crate) fn send(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(&self.authority).unwrap();
        let patience = Some(Duration::from_secs(20));
        stream.set_read_timeout(patience).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        Answer::parse(&String::from_utf8(bytes).unwrap())
    }

    /// Sends a request for a path below the token.
    pub(crate) fn request(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, &str)],
        body: &str,
    ) -> Answer {
        let mut request = format!(
            "{method} /{}/{path} HTTP/1.1\r\nHost: {}\r\n",
            self.token, self.authority
        );
        for (name, value) in headers {
            request += &format!("{name}: {value}\r\n");
        }
        if method == "PUT" {
            request += &format!("Content-Length: {}\r\n", body.len());
        }
        self.send(&format!("{request}\r\n{body}"))
    }

    pub(crate) fn file(&self) -> Answer {
        self.request("GET", "api/file", &[], "")
    }

    pub(crate) fn save(&self, tag: &str, text: &str) -> Answer {
        self.request("PUT", "api/file", &[("If-Match", tag)], text)
    }

    pub(crate) fn interrupt(mut self) -> Option<i32> {
        let kill = format!("kill -INT {}", self.child.id());
        assert!(
            Command::new("sh")
                .args(["-c", &kill])
                .status()
                .unwrap()
                .success()
        );
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(20) {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status.code();
            }
            thread::sleep(Duration::from_millis(10));
        }
        panic!("it goes on");
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        // Errors are ignored: the process has ended already, or the test has failed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    headers: Vec<(String, String)>,
    pub(crate) body: String,
}

impl Answer {
    pub(crate) fn parse(text: &str) -> Answer {
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        let (first, lines) = head.split_once("\r\n").unwrap();
        let status = first.strip_prefix("HTTP/1.1 ").unwrap();
        let headers = lines.split("\r\n").map(|line| {
            let (name, value) = line.split_once(": ").unwrap();
            (name.to_ascii_lowercase(), value.to_owned())
        });
        Answer {
            status: status[..3].parse().unwrap(),
            headers: headers.collect(),
            body: body.to_owned(),
        }
    }

    pub(crate) fn header(&self, name: &str) -> &str {
        let named = self.headers.iter().find(|(other, _)| other == name);
        named.map_or("", |(_, value)| value)
    }
}
