//! `flagred studio` as seen by a browser, another page and another user.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

mod access;
mod client;
#[path = "../common/mod.rs"]
mod common;
mod file;

use std::{fs, net::TcpListener};

use client::{RULES, page};
use common::folder;

#[test]
fn the_page_is_written_as_one_file_and_never_over_an_input() {
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
    for (out, reported) in [
        ("page.html", "cannot be written: it is also an input"),
        ("./page.html", "is the same file as `page.html`"),
        ("flight.BIN", "the page is HTML; write `flight.html`"),
        ("nowhere/page.html", "cannot be written"),
    ] {
        let (code, _, error) = run(&["studio", "--page", "page.html", "--html", out]);
        assert_eq!(code, Some(2), "{out}: {error}");
        assert!(error.contains(reported), "{out}: {error}");
    }
    assert_eq!(
        fs::read_to_string(folder.path().join("page.html")).unwrap(),
        page()
    );
}

#[test]
fn files_that_cannot_be_served_are_reported() {
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
    for (arguments, code, reported) in [
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
        assert!(error.contains(reported), "{typed:?}: {error}");
    }
}
