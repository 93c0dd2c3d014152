//! `flagred studio` as a browser, another page and another user meet it.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    os::unix::fs::{PermissionsExt, symlink},
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use common::folder;

const POLICY: &str = "default-src 'none'; script-src 'sha256-abc='; connect-src 'self'";
const RULES: &str = "fuzzy: 1\nname: fan\n";

/// What stands for the page: what is in it does not matter here.
fn page() -> String {
    format!(
        "<!doctype html><meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\
         <title>flagred</title>"
    )
}

/// A running studio that serves the page, with the arguments added.
struct Studio {
    child: Child,
    /// The host and port.
    authority: String,
    token: String,
    said: Vec<String>,
}

impl Studio {
    fn start(folder: &Path, arguments: &[&str]) -> Studio {
        let mut command = Command::new(env!("CARGO_BIN_EXE_flagred"));
        command.arg("studio").args(arguments).arg("--no-browser");
        Studio::run(command, folder)
    }

    fn run(mut command: Command, folder: &Path) -> Studio {
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

    /// Sends a request as it is, and reads the answer.
    fn send(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(&self.authority).unwrap();
        let patience = Some(Duration::from_secs(20));
        stream.set_read_timeout(patience).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        Answer::parse(&String::from_utf8(bytes).unwrap())
    }

    /// Asks for a path below the token.
    fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Answer {
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

    fn file(&self) -> Answer {
        self.ask("GET", "api/file", &[], "")
    }

    fn save(&self, tag: &str, text: &str) -> Answer {
        self.ask("PUT", "api/file", &[("If-Match", tag)], text)
    }

    fn interrupt(mut self) -> Option<i32> {
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
        // Neither can be told to anybody: it has ended already, or the test has failed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[derive(Debug)]
struct Answer {
    status: u16,
    headers: Vec<(String, String)>,
    body: String,
}

impl Answer {
    fn parse(text: &str) -> Answer {
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

    fn header(&self, name: &str) -> &str {
        let named = self.headers.iter().find(|(other, _)| other == name);
        named.map_or("", |(_, value)| value)
    }
}

#[test]
fn the_page_comes_with_its_own_policy() {
    let folder = folder(&[]);
    let studio = Studio::start(folder.path(), &[]);
    assert_eq!(studio.said.len(), 2, "{:?}", studio.said);
    let answer = studio.ask("GET", "", &[], "");
    assert_eq!((answer.status, answer.body.as_str()), (200, &*page()));
    let policy = format!("{POLICY}; frame-ancestors 'none'");
    for (name, value) in [
        ("content-type", "text/html; charset=utf-8"),
        ("content-security-policy", &policy),
        ("x-content-type-options", "nosniff"),
        ("referrer-policy", "no-referrer"),
        ("cross-origin-opener-policy", "same-origin"),
        ("cross-origin-resource-policy", "same-origin"),
        ("cache-control", "no-store"),
    ] {
        assert_eq!(answer.header(name), value, "{name}");
    }
    let head = studio.ask("HEAD", "", &[], "");
    assert_eq!((head.status, head.body.as_str()), (200, ""));
    assert_eq!(head.header("content-length"), page().len().to_string());
    // Nothing to edit.
    assert_eq!(studio.file().status, 204);
    assert_eq!(studio.save("\"x\"", "text").status, 404);
    assert_eq!(studio.interrupt(), Some(0));
}

#[test]
fn nobody_else_gets_anything() {
    let folder = folder(&[("rules.yaml", RULES), ("secret.txt", "secret")]);
    let studio = Studio::start(folder.path(), &["rules.yaml"]);
    let (authority, token) = (&studio.authority, &studio.token);
    let port = authority.split_once(':').unwrap().1;
    let own = format!("http://{authority}");
    let request = |path: &str, host: &str, headers: &str| {
        studio.send(&format!(
            "GET {path} HTTP/1.1\r\nHost: {host}\r\n{headers}\r\n"
        ))
    };
    let (page, file) = (format!("/{token}/"), format!("/{token}/api/file"));
    assert_eq!(request(&page, authority, "").status, 200);
    assert_eq!(
        request(&file, authority, &format!("Origin: {own}\r\n")).status,
        200
    );
    // A name that another page made lead here.
    for host in [
        "evil.example",
        &format!("evil.example:{port}"),
        "127.0.0.1",
        "",
    ] {
        assert_eq!(request(&page, host, "").status, 403, "{host}");
        assert_eq!(request(&file, host, "").status, 403, "{host}");
    }
    assert_eq!(
        studio.send(&format!("GET {page} HTTP/1.0\r\n\r\n")).status,
        403
    );
    let twice = format!("Host: {authority}\r\n");
    assert_eq!(request(&page, authority, &twice).status, 403);
    for origin in [
        "http://evil.example",
        "null",
        "http://127.0.0.1:1",
        &format!("{own}, {own}"),
    ] {
        let refused = request(&file, authority, &format!("Origin: {origin}\r\n"));
        assert_eq!(refused.status, 403, "{origin}");
    }
    let tag = studio.file().header("etag").to_owned();
    let headers = [("If-Match", &*tag), ("Origin", "http://evil.example")];
    assert_eq!(studio.ask("PUT", "api/file", &headers, "x").status, 403);
    let wrong = "0".repeat(token.len());
    for path in [
        "/",
        "/api/file",
        "/favicon.ico",
        "//",
        "*",
        &format!("/{token}"),
        &format!("/{wrong}/"),
        &format!("/{wrong}/api/file"),
        &format!("/{token}/secret.txt"),
        &format!("/{token}/../secret.txt"),
        &format!("/{token}/api/../secret.txt"),
        &format!("/{token}/api/file/"),
        &format!("/{token}//etc/passwd"),
        &format!("http://{authority}/{token}/"),
    ] {
        let answer = request(path, authority, "");
        assert_eq!(answer.status, 404, "{path}");
        assert!(!answer.body.contains(&**token), "{path}");
    }
    for method in ["POST", "DELETE", "PATCH", "OPTIONS", "TRACE"] {
        for path in ["", "api/file"] {
            assert_eq!(
                studio.ask(method, path, &[], "").status,
                405,
                "{method} {path}"
            );
        }
    }
    assert_eq!(studio.send("\u{1}\u{2}\r\n\r\n").status, 400);
    assert_eq!(
        fs::read_to_string(folder.path().join("rules.yaml")).unwrap(),
        RULES
    );
    // None of it made it stop.
    assert_eq!(studio.file().status, 200);
}

/// What is sent on the command line of the browser leads to the page once, so that who reads it there comes too late.
#[test]
fn the_address_that_a_browser_is_given_works_once() {
    let folder = folder(&[]);
    let opener = folder.path().join("xdg-open");
    fs::write(
        &opener,
        "#!/bin/sh\necho \"$1\" > opened.part\nmv opened.part opened\n",
    )
    .unwrap();
    fs::set_permissions(&opener, fs::Permissions::from_mode(0o755)).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_flagred"));
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{path}", folder.path().display());
    command.env("PATH", path).arg("studio");
    let studio = Studio::run(command, folder.path());
    let opened = folder.path().join("opened");
    let start = Instant::now();
    while !opened.exists() {
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "no browser is opened"
        );
        thread::sleep(Duration::from_millis(10));
    }
    let address = fs::read_to_string(opened).unwrap();
    assert!(!address.contains(&studio.token), "{address}");
    let path = address.trim_end().split_once(&studio.authority).unwrap().1;
    let request = format!("GET {path} HTTP/1.1\r\nHost: {}\r\n\r\n", studio.authority);
    let first = studio.send(&request);
    assert_eq!(
        (first.status, first.header("location")),
        (303, &*format!("/{}/", studio.token))
    );
    let second = studio.send(&request);
    assert_eq!(second.status, 404);
    assert!(second.body.contains("opened already"), "{}", second.body);
}

#[test]
fn the_file_is_read_and_written_as_long_as_nobody_else_writes_it() {
    let folder = folder(&[("my räder.yaml", RULES)]);
    let studio = Studio::start(folder.path(), &["my räder.yaml"]);
    assert_eq!(studio.said[1], "edits `my räder.yaml`");
    let path = folder.path().join("my räder.yaml");
    let first = studio.file();
    assert_eq!((first.status, first.body.as_str()), (200, RULES));
    assert_eq!(first.header("content-type"), "text/plain; charset=utf-8");
    assert_eq!(first.header("x-file-name"), "my%20r%C3%A4der%2Eyaml");
    assert_eq!(first.header("x-read-only"), "false");
    let tag = first.header("etag");
    let unchanged = studio.ask("GET", "api/file", &[("If-None-Match", tag)], "");
    assert_eq!((unchanged.status, unchanged.body.as_str()), (304, ""));

    let text = format!("{RULES}# grün\n");
    let saved = studio.save(tag, &text);
    assert_eq!(saved.status, 204, "{}", saved.body);
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    let changed = studio.ask("GET", "api/file", &[("If-None-Match", tag)], "");
    assert_eq!(
        (changed.status, changed.body.as_str()),
        (200, text.as_str())
    );
    assert_eq!(changed.header("etag"), saved.header("etag"));
    // The tag of before, another's tag, none.
    assert_eq!(studio.save(tag, "lost").status, 412);
    assert_eq!(studio.save("*", "lost").status, 412);
    assert_eq!(studio.ask("PUT", "api/file", &[], "lost").status, 428);

    fs::write(&path, "another editor").unwrap();
    let refused = studio.save(saved.header("etag"), "lost");
    assert_eq!(refused.status, 412);
    assert_eq!(
        refused.body,
        "`my räder.yaml` was changed on disk meanwhile"
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "another editor");

    fs::remove_file(&path).unwrap();
    let gone = studio.file();
    assert_eq!(gone.status, 500);
    assert!(
        gone.body.contains("`my räder.yaml` cannot be read"),
        "{}",
        gone.body
    );
    assert_eq!(studio.save(tag, "lost").status, 500);
    assert!(!path.exists());
    assert_eq!(studio.interrupt(), Some(0));
}

#[test]
fn a_text_that_is_too_large_or_none_changes_nothing() {
    let folder = folder(&[("rules.yaml", RULES)]);
    let studio = Studio::start(folder.path(), &["rules.yaml"]);
    let tag = studio.file().header("etag").to_owned();
    let large = "#".repeat(4_000_001);
    let refused = studio.save(&tag, &large);
    assert_eq!(
        (refused.status, refused.body.as_str()),
        (413, "the text is larger than 4 MB")
    );
    let (authority, token) = (&studio.authority, &studio.token);
    let head =
        format!("PUT /{token}/api/file HTTP/1.1\r\nHost: {authority}\r\nIf-Match: {tag}\r\n");
    let chunked = format!("{head}Transfer-Encoding: chunked\r\n\r\n1\r\na\r\n0\r\n\r\n");
    assert_eq!(studio.send(&chunked).status, 411);
    let endless = format!("{head}Content-Length: 999999999999\r\n\r\n");
    assert_eq!(studio.send(&endless).status, 413);
    let mut stream = TcpStream::connect(authority).unwrap();
    let latin = b"Content-Length: 1\r\n\r\n\xe4";
    stream
        .write_all(&[head.as_bytes(), latin].concat())
        .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert_eq!(Answer::parse(&answer).status, 400);
    assert_eq!(
        fs::read_to_string(folder.path().join("rules.yaml")).unwrap(),
        RULES
    );
    // One that says nothing keeps nobody waiting.
    let _silent: Vec<TcpStream> = (0..8)
        .map(|_| TcpStream::connect(authority).unwrap())
        .collect();
    let start = Instant::now();
    assert_eq!(studio.file().status, 200);
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn what_is_read_only_is_never_written() {
    let folder = folder(&[("rules.yaml", RULES)]);
    let studio = Studio::start(folder.path(), &["rules.yaml", "--read-only"]);
    assert_eq!(studio.said[1], "shows `rules.yaml`, read only");
    let file = studio.file();
    assert_eq!(file.header("x-read-only"), "true");
    let refused = studio.save(file.header("etag"), "text");
    assert_eq!(
        (refused.status, refused.body.as_str()),
        (403, "`rules.yaml` is read only")
    );
    assert_eq!(
        fs::read_to_string(folder.path().join("rules.yaml")).unwrap(),
        RULES
    );
}

/// Another name of the old file shows that the new one is another file, put in its place.
#[test]
fn the_file_is_replaced_where_its_link_leads_and_keeps_its_mode() {
    let folder = folder(&[("real.yaml", RULES)]);
    let (real, old) = (
        folder.path().join("real.yaml"),
        folder.path().join("old.yaml"),
    );
    fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
    fs::hard_link(&real, &old).unwrap();
    let link = folder.path().join("link.yaml");
    symlink("real.yaml", &link).unwrap();
    let studio = Studio::start(folder.path(), &["link.yaml"]);
    let file = studio.file();
    assert_eq!(file.header("x-file-name"), "link%2Eyaml");
    assert_eq!(studio.save(file.header("etag"), "new").status, 204);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&real).unwrap(), "new");
    assert_eq!(
        fs::metadata(&real).unwrap().permissions().mode() & 0o777,
        0o640
    );
    assert_eq!(fs::read_to_string(&old).unwrap(), RULES);
    let names = fs::read_dir(folder.path()).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.ends_with(".part")));
}

#[test]
fn the_page_is_written_as_one_file_and_over_no_input() {
    let folder = folder(&[("page.html", &page())]);
    let run = |arguments: &[&str]| common::flagred(folder.path(), arguments);
    let written = run(&["studio", "--page", "page.html", "--html", "out.html"]);
    assert_eq!(written, (Some(0), String::new(), String::new()));
    assert_eq!(
        fs::read_to_string(folder.path().join("out.html")).unwrap(),
        page()
    );
    let (code, said, _) = run(&["studio", "--page", "page.html", "--html", "-"]);
    assert_eq!((code, said), (Some(0), page()));
    for (out, told) in [
        ("page.html", "is to be written, and is read as well"),
        ("./page.html", "is the same file as `page.html`"),
        ("flight.BIN", "the page is HTML; write `flight.html`"),
        ("nowhere/page.html", "cannot be written"),
    ] {
        let (code, _, error) = run(&["studio", "--page", "page.html", "--html", out]);
        assert_eq!(code, Some(2), "{out}: {error}");
        assert!(error.contains(told), "{out}: {error}");
    }
    assert_eq!(
        fs::read_to_string(folder.path().join("page.html")).unwrap(),
        page()
    );
}

#[test]
fn what_cannot_be_served_is_told() {
    let folder = folder(&[
        ("page.html", &page()),
        ("other.html", "<p>"),
        ("rules.yaml", RULES),
    ]);
    fs::write(folder.path().join("latin.yaml"), b"name: r\xe4der").unwrap();
    fs::create_dir(folder.path().join("sub")).unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let in_use = format!("error: port {port} is in use\n  help: ");
    for (arguments, code, told) in [
        (vec!["--port", &port], 2, &*in_use),
        (
            vec!["nowhere.yaml"],
            3,
            "error: `nowhere.yaml` cannot be read: No such file or directory (os error 2)\n  \
             help: `flagred new NAME` writes a rule set to start from",
        ),
        (
            vec!["-"],
            2,
            "error: standard input cannot be edited\n  help: name a file",
        ),
        (vec!["sub"], 3, "error: `sub` is not a file"),
        (
            vec!["latin.yaml"],
            3,
            "error: `latin.yaml` is not UTF-8: line 1",
        ),
        (
            vec!["--page", "other.html"],
            3,
            "error: `other.html` is not the page of the studio",
        ),
        (
            vec!["--page", "none.html"],
            3,
            "error: `none.html` cannot be read",
        ),
        (vec!["--read-only"], 2, "<FILE>"),
        (
            vec!["rules.yaml", "--html", "out.html"],
            2,
            "cannot be used with",
        ),
    ] {
        let mut typed = vec!["studio", "--no-browser"];
        if arguments.contains(&"--html") {
            typed.pop();
        }
        typed.extend(&arguments);
        if !arguments.contains(&"--page") {
            typed.extend(["--page", "page.html"]);
        }
        let (status, _, error) = common::flagred(folder.path(), &typed);
        assert_eq!(status, Some(code), "{typed:?}: {error}");
        assert!(error.contains(told), "{typed:?}: {error}");
    }
}
