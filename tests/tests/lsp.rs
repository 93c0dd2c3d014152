//! `flagred lsp` from an editor's point of view: messages over a pipe.

use std::{
    io::{BufRead, BufReader, Read, Write},
    process::{Child, ChildStdin, ChildStdout, Stdio},
};

use flagred_tests::{Folder, flagred};
use serde_json::{Value, json};

const RULES: &str = "fuzzy: 1
name: fan
inputs:
  heat: {range: [0, 100], unit: °C, partition: [low, high]}
outputs:
  speed: {range: [0, 9], terms: {slow: {triangle: [0, 2, 4]}, fast: {triangle: [4, 7, 9]}}}
rules:
  - IF heat IS low THEN speed IS slow
  - IF heat IS not low THEN speed IS fast
";

struct Editor {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    requested: u32,
}

impl Editor {
    fn new(encodings: &[&str]) -> Editor {
        let mut server = flagred()
            .args(["lsp", "--stdio"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let to = server.stdin.take().unwrap();
        let from = BufReader::new(server.stdout.take().unwrap());
        let mut editor = Editor {
            server,
            to,
            from,
            requested: 0,
        };
        let able = json!({"general": {"positionEncodings": encodings}});
        let answer = editor.request("initialize", json!({"capabilities": able}));
        let known = &answer["capabilities"]["positionEncoding"];
        assert_eq!(known, encodings.first().copied().unwrap_or("utf-16"));
        editor.notify("initialized", json!({}));
        editor
    }

    fn send(&mut self, mut message: Value) {
        message["jsonrpc"] = "2.0".into();
        let text = message.to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        self.to.flush().unwrap();
    }

    fn notify(&mut self, method: &str, params: Value) {
        self.send(json!({"method": method, "params": params}));
    }

    fn ask_raw(&mut self, method: &str, params: Value) -> Value {
        self.requested += 1;
        self.send(json!({"id": self.requested, "method": method, "params": params}));
        let answer = self.hear();
        assert_eq!(answer["id"], self.requested);
        answer
    }

    fn request(&mut self, method: &str, params: Value) -> Value {
        let answer = self.ask_raw(method, params);
        assert_eq!(answer["error"], Value::Null);
        answer["result"].clone()
    }

    fn hear(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(
                self.from.read_line(&mut line).unwrap() > 0,
                "the server is gone"
            );
            if let Some(said) = line.strip_prefix("Content-Length: ") {
                length = said.trim().parse().unwrap();
            } else if line.trim().is_empty() {
                break;
            }
        }
        let mut text = vec![0; length];
        self.from.read_exact(&mut text).unwrap();
        serde_json::from_slice(&text).unwrap()
    }

    /// Opens a text and returns the messages of its diagnostics.
    fn open(&mut self, uri: &str, text: &str) -> Vec<String> {
        let document = json!({"uri": uri, "languageId": "yaml", "version": 1, "text": text});
        self.notify("textDocument/didOpen", json!({"textDocument": document}));
        self.found(uri)
    }

    fn found(&mut self, uri: &str) -> Vec<String> {
        let reported = self.hear();
        assert_eq!(reported["method"], "textDocument/publishDiagnostics");
        assert_eq!(reported["params"]["uri"], uri);
        let found = reported["params"]["diagnostics"].as_array().unwrap();
        let shown = |one: &Value| {
            let from = &one["range"]["start"];
            let message = one["message"].as_str().unwrap().replace('\n', " / ");
            format!(
                "{}:{} {} {message}",
                from["line"],
                from["character"],
                one["code"].as_str().unwrap()
            )
        };
        found.iter().map(shown).collect()
    }

    /// The completions at `|` in a text.
    fn offered(&mut self, text: &str) -> Vec<String> {
        let offset = text.find('|').unwrap();
        let (uri, text) = ("file:///tmp/offered.yaml", text.replacen('|', "", 1));
        self.open(uri, &text);
        let before = &text[..offset];
        let line = before.matches('\n').count();
        let column = before.chars().rev().take_while(|c| *c != '\n').count();
        let at = place(uri, line, column);
        let items = self.request("textDocument/completion", at);
        let label = |item: &Value| item["label"].as_str().unwrap().to_owned();
        items.as_array().unwrap().iter().map(label).collect()
    }

    fn end(mut self) {
        self.request("shutdown", Value::Null);
        self.notify("exit", Value::Null);
        assert!(self.server.wait().unwrap().success());
    }
}

fn place(uri: &str, line: usize, character: usize) -> Value {
    json!({"textDocument": {"uri": uri}, "position": {"line": line, "character": character}})
}

#[test]
fn mistakes_are_reported_while_typing() {
    let mut editor = Editor::new(&["utf-16"]);
    let uri = "file:///tmp/fan.yaml";
    let found = editor.open(uri, RULES);
    let starts = [
        "3:53 unused no rule uses the term `high`",
        "5:2 narrow-reach `speed` stays",
    ];
    assert_eq!(found.len(), starts.len());
    for (found, start) in found.iter().zip(starts) {
        assert!(found.starts_with(start), "{found}");
    }
    let changes = json!([{"text": RULES.replace("IS slow", "IS slwo")}]);
    let document = json!({"uri": uri, "version": 2});
    let changed = json!({"textDocument": document, "contentChanges": changes});
    editor.notify("textDocument/didChange", changed);
    let found = editor.found(uri);
    assert!(found[0].starts_with("7:33 unknown-term"), "{found:?}");
    assert!(found[0].contains("did you mean `slow`?"), "{found:?}");
    editor.notify(
        "textDocument/didClose",
        json!({"textDocument": {"uri": uri}}),
    );
    assert_eq!(editor.found(uri), Vec::<String>::new());
    editor.end();
}

#[test]
fn a_profile_is_checked_with_the_rule_set_beside_it() {
    let folder = Folder::new();
    folder.file(
        "my rules.yaml",
        include_str!("../../rules/flagred-paper.yaml"),
    );
    let mut editor = Editor::new(&["utf-8"]);
    let uri = format!("file://{}", folder.at("mine.yaml")).replace(' ', "%20");
    let profile = "flagred: 1\nname: mine\nrules: my rules.yaml\ninputs:\n  margin: {mean: motor_margin}\n  spraed: {std: motor_command}\n";
    let found = editor.open(&uri, profile);
    assert!(found[0].starts_with("5:2 unknown-input"), "{found:?}");
    assert!(found[0].contains("did you mean `spread`?"), "{found:?}");
    let found = editor.open(&uri, &profile.replace("my rules", "no rules"));
    assert!(
        found[0].starts_with("2:7 rule-set the rule set `no rules.yaml`"),
        "{found:?}"
    );
    editor.end();
}

#[test]
fn completions_are_offered() {
    let mut editor = Editor::new(&[]);
    let with = |rule: &str| format!("{}  - {rule}", RULES);
    for (text, expected) in [
        (with("IF |"), &["heat", "speed", "NOT"][..]),
        (with("IF he|"), &["heat", "speed", "NOT"]),
        (with("IF heat |"), &["IS"]),
        (
            with("IF heat IS |"),
            &["low", "high", "NOT", "very", "somewhat"],
        ),
        (with("IF heat IS very |"), &["low", "high"]),
        (with("IF (heat IS low |"), &["AND", "OR", "THEN"]),
        (with("IF heat IS low THEN |"), &["speed"]),
        (with("IF heat IS low THEN speed IS |"), &["slow", "fast"]),
        (
            with("IF heat IS low THEN speed IS fast |"),
            &["AND", "WITH"],
        ),
        (with("IF heat IS low\n    THEN |"), &["speed"]),
        (
            format!("{RULES}|"),
            &["fuzzy", "name", "inputs", "outputs", "operators", "rules"],
        ),
        (
            RULES.replace("name: fan", "name: fan\noperators: {and: |"),
            &["minimum", "product"],
        ),
        (
            RULES.replace("  heat: {", "  heat: {|"),
            &["range", "partition", "terms", "unit"],
        ),
        (
            RULES.replace("outputs:\n", "  cold:\n    |\noutputs:\n"),
            &["range", "terms"],
        ),
        (
            "flagred: 1\n|".into(),
            &["name", "rules", "inputs", "verdict"],
        ),
        (
            "flagred: 1\nverdict:\n  |".into(),
            &["warn", "fail", "idle_below"],
        ),
        (
            "flagred: 1\nverdict:\n  warn: {risk: 66, |".into(),
            &["risk", "until"],
        ),
        (
            "flagred: 1\ninputs:\n  x: {mean: |".into(),
            &["motor_margin", "battery_v"],
        ),
    ] {
        let offered = editor.offered(&text);
        for word in expected {
            assert!(
                offered.iter().any(|one| one == word),
                "{word} of {offered:?} in {text}"
            );
        }
        assert!(offered.len() < 60, "{offered:?}");
    }
    editor.end();
}

#[test]
fn names_are_described_found_and_renamed() {
    let mut editor = Editor::new(&["utf-8"]);
    let uri = "file:///tmp/fan.yaml";
    editor.open(uri, RULES);
    let hover = editor.request("textDocument/hover", place(uri, 7, 33));
    let text = hover["contents"]["value"].as_str().unwrap();
    assert_eq!(text, "**slow** of `speed` [0, 9]\n\n`triangle: [0, 2, 4]`");
    let hover = editor.request("textDocument/hover", place(uri, 7, 8));
    let text = hover["contents"]["value"].as_str().unwrap();
    assert_eq!(text, "**heat** [0, 100] °C\n\nterms: `low`, `high`");
    assert_eq!(
        editor.request("textDocument/hover", place(uri, 0, 2)),
        Value::Null
    );

    let there = editor.request("textDocument/definition", place(uri, 8, 20));
    assert_eq!(there["range"]["start"], json!({"line": 3, "character": 49}));

    let rename = |to: &str| {
        let mut requested = place(uri, 3, 49);
        requested["newName"] = to.into();
        requested
    };
    let edits = editor.request("textDocument/rename", rename("cold"));
    let mut text = RULES.to_owned();
    let mut edits = edits["changes"][uri].as_array().unwrap().clone();
    edits.reverse();
    for edit in edits {
        let line = edit["range"]["start"]["line"].as_u64().unwrap() as usize;
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        let at = |end: &str| start + edit["range"][end]["character"].as_u64().unwrap() as usize;
        text.replace_range(at("start")..at("end"), edit["newText"].as_str().unwrap());
    }
    assert_eq!(
        text,
        RULES
            .replace("low,", "cold,")
            .replace("IS low", "IS cold")
            .replace("not low", "not cold")
    );
    for (to, why) in [
        ("high", "already"),
        ("very hot", "not a name"),
        ("AND", "not a name"),
    ] {
        let answer = editor.ask_raw("textDocument/rename", rename(to));
        let said = answer["error"]["message"].as_str().unwrap();
        assert!(said.contains(why), "{said}");
    }
    let answer = editor.ask_raw("textDocument/unheard-of", json!({}));
    assert_eq!(answer["error"]["code"], -32601);
    editor.end();
}

#[test]
fn the_layout_is_that_of_fmt() {
    let folder = Folder::new();
    let untidy = RULES
        .replace("name: fan", "name:    fan  # a fan")
        .replace("IF heat", "if   heat");
    let file = folder.file("fan.yaml", &untidy);
    let check = || {
        flagred()
            .args(["fmt", "--check", &file])
            .status()
            .unwrap()
            .code()
    };
    assert_eq!(check(), Some(1));
    let mut editor = Editor::new(&[]);
    let uri = "file:///tmp/fan.yaml";
    editor.open(uri, &untidy);
    let options = json!({"tabSize": 2, "insertSpaces": true});
    let requested = json!({"textDocument": {"uri": uri}, "options": options});
    let edits = editor.request("textDocument/formatting", requested);
    editor.end();
    assert!(flagred().args(["fmt", &file]).status().unwrap().success());
    let formatted = std::fs::read_to_string(&file).unwrap();
    assert_eq!(edits[0]["newText"], formatted.as_str());
    assert!(formatted.contains("# a fan") && formatted.contains("- IF heat IS low THEN"));
    assert_eq!(check(), Some(0));
}

#[test]
fn the_server_ends_when_the_editor_disconnects() {
    let Editor {
        mut server,
        to,
        from,
        ..
    } = Editor::new(&[]);
    drop((to, from));
    server.wait().unwrap();
}

/// The server reports findings about the text of another program, but does not change it.
#[test]
fn a_rule_set_of_another_program_has_findings_and_is_not_formatted() {
    let text = "FUNCTION_BLOCK fan\nVAR_INPUT\n  heat : REAL;\nEND_VAR\nVAR_OUTPUT\n  speed : REAL;\nEND_VAR\n\
        FUZZIFY heat\n  RANGE := (0 .. 100);\n  TERM low := (0, 1) (100, 0);\nEND_FUZZIFY\n\
        DEFUZZIFY speed\n  RANGE := (0 .. 9);\n  TERM slow := (0, 0) (2, 1) (4, 0);\n  METHOD : COGG;\nEND_DEFUZZIFY\n\
        RULEBLOCK rules\n  RULE 1 : IF heat IS low THEN speed IS slow;\nEND_RULEBLOCK\nEND_FUNCTION_BLOCK\n";
    let mut editor = Editor::new(&["utf-8"]);
    let uri = "file:///tmp/fan.fcl";
    let found = editor.open(uri, text);
    assert!(
        found[0].starts_with("14:11 unknown-word") && found[0].contains("did you mean `COG`?"),
        "{found:?}"
    );
    let line = text
        .lines()
        .position(|line| line.contains("RULE 1"))
        .unwrap();
    let mut rename = place(uri, line, 22);
    rename["newName"] = "cold".into();
    assert!(editor.ask_raw("textDocument/rename", rename)["error"].is_object());
    let options = json!({"tabSize": 2, "insertSpaces": true});
    let formatted = editor.request(
        "textDocument/formatting",
        json!({"textDocument": {"uri": uri}, "options": options}),
    );
    assert_eq!(formatted, Value::Null);
    editor.end();
}

/// The next message is read after a length that exceeds any memory, a message that is too long, and an invalid message.
#[test]
fn a_message_that_is_too_long_is_skipped() {
    let mut editor = Editor::new(&[]);
    let long = format!("Content-Length: 20000000\r\n\r\n{}", " ".repeat(20_000_000));
    editor.to.write_all(long.as_bytes()).unwrap();
    editor.to.write_all(b"Content-Length: 2\r\n\r\n{{").unwrap();
    assert!(!editor.open("file:///tmp/fan.yaml", RULES).is_empty());
    editor.end();

    let mut editor = Editor::new(&[]);
    editor
        .to
        .write_all(b"Content-Length: 18446744073709551615\r\n\r\n{}")
        .unwrap();
    let Editor { mut server, to, .. } = editor;
    drop(to);
    assert!(server.wait().unwrap().success());
}

#[test]
fn the_order_of_messages_is_that_of_the_protocol() {
    let mut editor = Editor::new(&[]);
    let again = editor.ask_raw("initialize", json!({"capabilities": {}}));
    assert_eq!(again["error"]["code"], -32600);
    editor.notify("exit", Value::Null);
    assert_eq!(editor.server.wait().unwrap().code(), Some(1));
}
