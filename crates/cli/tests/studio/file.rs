//! The file that the page edits: reading, saving and refusals.

use std::{
    fs,
    io::{Read, Write},
    net::TcpStream,
    os::unix::fs::{PermissionsExt, symlink},
    time::{Duration, Instant},
};

use super::{
    client::{Answer, RULES, Studio},
    common::folder,
};

#[test]
fn the_file_is_written_only_if_nobody_else_changed_it() {
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
    let unchanged = studio.request("GET", "api/file", &[("If-None-Match", tag)], "");
    assert_eq!((unchanged.status, unchanged.body.as_str()), (304, ""));

    let text = format!("{RULES}# grün\n");
    let saved = studio.save(tag, &text);
    assert_eq!(saved.status, 204, "{}", saved.body);
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    let changed = studio.request("GET", "api/file", &[("If-None-Match", tag)], "");
    assert_eq!(
        (changed.status, changed.body.as_str()),
        (200, text.as_str())
    );
    assert_eq!(changed.header("etag"), saved.header("etag"));
    // Saving with the previous tag, with a wrong tag and without a tag is refused.
    assert_eq!(studio.save(tag, "lost").status, 412);
    assert_eq!(studio.save("*", "lost").status, 412);
    assert_eq!(studio.request("PUT", "api/file", &[], "lost").status, 428);

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
fn refused_texts_change_nothing() {
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
    let both = format!(
        "{head}Content-Length: 11\r\nTransfer-Encoding: chunked\r\n\r\n1\r\na\r\n0\r\n\r\n"
    );
    let refused = studio.send(&both);
    assert_eq!(refused.status, 400);
    assert!(refused.body.contains("not in chunks"), "{}", refused.body);
    let packed = format!("{head}Content-Length: 2\r\nContent-Encoding: gzip\r\n\r\nab");
    assert_eq!(studio.send(&packed).status, 400);
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
    // Silent connections do not block other connections.
    let _silent: Vec<TcpStream> = (0..8)
        .map(|_| TcpStream::connect(authority).unwrap())
        .collect();
    let start = Instant::now();
    assert_eq!(studio.file().status, 200);
    assert!(start.elapsed() < Duration::from_secs(5));
}

#[test]
fn a_read_only_file_is_never_written() {
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

/// A hard link to the old file proves that saving creates a new file in its place.
#[test]
fn the_target_of_a_link_is_replaced_and_keeps_its_mode() {
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

/// Opening a FIFO would wait for its other end forever, and so would the next save.
#[test]
fn a_file_that_becomes_unreadable_is_reported_at_once() {
    let folder = folder(&[("rules.yaml", RULES)]);
    let studio = Studio::start(folder.path(), &["rules.yaml"]);
    let tag = studio.file().header("etag").to_owned();
    let path = folder.path().join("rules.yaml");
    fs::remove_file(&path).unwrap();
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.unwrap().success());
    let start = Instant::now();
    for answer in [studio.file(), studio.save(&tag, "lost")] {
        assert_eq!(answer.status, 500);
        assert!(
            answer.body.contains("is not a file any more"),
            "{}",
            answer.body
        );
    }
    assert!(start.elapsed() < Duration::from_secs(5));
    assert_eq!(studio.interrupt(), Some(0));
}

#[test]
fn a_file_in_utf_16_is_shown_and_not_rewritten() {
    let folder = folder(&[]);
    let mut bytes = vec![0xff, 0xfe];
    bytes.extend(RULES.encode_utf16().flat_map(u16::to_le_bytes));
    fs::write(folder.path().join("rules.yaml"), &bytes).unwrap();
    fs::write(folder.path().join("page.html"), super::client::page()).unwrap();
    let refused = [
        "studio",
        "rules.yaml",
        "--no-browser",
        "--page",
        "page.html",
    ];
    let (code, _, error) = super::common::flagred(folder.path(), &refused);
    assert_eq!(code, Some(3));
    assert!(
        error.contains("`rules.yaml` is in UTF-16") && error.contains("show it with `--read-only`"),
        "{error}"
    );
    let studio = Studio::start(folder.path(), &["rules.yaml", "--read-only"]);
    assert_eq!(studio.file().body, RULES);
    assert_eq!(fs::read(folder.path().join("rules.yaml")).unwrap(), bytes);
}

/// No user can create a file in a folder of `/proc`.
#[test]
#[cfg(target_os = "linux")]
fn a_file_in_a_folder_that_cannot_be_written_is_read_only_from_the_start() {
    let folder = folder(&[]);
    let studio = Studio::start(folder.path(), &["/proc/sys/kernel/hostname"]);
    assert!(
        studio.said[1].starts_with("shows `hostname`, read only: "),
        "{:?}",
        studio.said
    );
    assert_eq!(studio.file().header("x-read-only"), "true");
}
