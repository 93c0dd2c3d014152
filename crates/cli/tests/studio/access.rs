//! Access to the page, which only the user who started the studio has.

use std::{
    fs,
    io::Write,
    net::TcpStream,
    os::unix::fs::PermissionsExt,
    process::Command,
    thread,
    time::{Duration, Instant},
};

use super::{
    client::{POLICY, RULES, Studio, page},
    common::folder,
};

#[test]
fn the_page_has_its_own_content_security_policy() {
    let folder = folder(&[]);
    let studio = Studio::start(folder.path(), &[]);
    assert_eq!(studio.said.len(), 2, "{:?}", studio.said);
    let answer = studio.request("GET", "", &[], "");
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
    let head = studio.request("HEAD", "", &[], "");
    assert_eq!((head.status, head.body.as_str()), (200, ""));
    assert_eq!(head.header("content-length"), page().len().to_string());
    // There is no file to edit.
    assert_eq!(studio.file().status, 204);
    assert_eq!(studio.save("\"x\"", "text").status, 404);
    assert_eq!(studio.interrupt(), Some(0));
}

#[test]
fn requests_of_others_are_refused() {
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
    // A foreign page may reach this server under its own host name (DNS rebinding).
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
    assert_eq!(studio.request("PUT", "api/file", &headers, "x").status, 403);
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
                studio.request(method, path, &[], "").status,
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
    // The server is still running.
    assert_eq!(studio.file().status, 200);
}

/// The address on the browser's command line redirects to the page only once, so another user who reads the command
/// line comes too late.
#[test]
fn the_address_for_the_browser_works_once() {
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
    assert!(second.body.contains("already opened"), "{}", second.body);
}

/// Any user of the machine can connect and send single bytes slowly.
#[test]
fn slow_connections_do_not_block_others() {
    let folder = folder(&[("rules.yaml", RULES)]);
    let studio = Studio::start(folder.path(), &["rules.yaml"]);
    let start = Instant::now();
    let mut dripping = Vec::new();
    for i in 0..200 {
        let mut stream = TcpStream::connect(&studio.authority).unwrap();
        let head = match i % 2 {
            // The bytes belong to the head, or to the body of a refused request.
            0 => "GET / HTTP/1.1\r\n",
            _ => "PUT /wrong/api/file HTTP/1.1\r\nHost: x\r\nContent-Length: 60000000\r\n\r\n",
        };
        stream.write_all(head.as_bytes()).unwrap();
        dripping.push(stream);
    }
    for stream in &mut dripping {
        // Some of the connections are closed by now.
        let _ = stream.write_all(b"x");
    }
    assert_eq!(studio.file().status, 200);
    let tag = studio.file().header("etag").to_owned();
    assert_eq!(studio.save(&tag, RULES).status, 204);
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
}

/// The server ends a refused request after a limited time, however slowly the request is sent.
#[test]
fn a_refused_request_is_not_read_for_long() {
    let folder = folder(&[]);
    let studio = Studio::start(folder.path(), &[]);
    let mut stream = TcpStream::connect(&studio.authority).unwrap();
    let head = "PUT /wrong/api/file HTTP/1.1\r\nHost: x\r\nContent-Length: 60000000\r\n\r\n";
    stream.write_all(head.as_bytes()).unwrap();
    let start = Instant::now();
    while stream.write_all(b"x").is_ok() {
        assert!(start.elapsed() < Duration::from_secs(15), "it listens on");
        thread::sleep(Duration::from_millis(100));
    }
}
