//! Every block of every document runs as printed: commands with their output, rule sets, profiles, and Rust.
//!
//! A `console` block contains commands after `$ ` and their output; a line of `...` matches any lines. The commands of
//! a document run in sequence in a folder that looks like the repository, so that later commands can read files of
//! earlier ones. A YAML block whose first line is a comment with a file name is written under that name.
//!
//! `UPDATE_DOCUMENTS=1 cargo test -p flagred-tests --test documents` writes the output of the commands into the documents;
//! review the difference before you keep it.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use flagred_tests::{Folder, flagred};

/// Commands in the documents that these tests do not run, because they download or build the whole workspace, or
/// install programs.
const NOT_RUN: [&str; 6] = [
    "cargo test",
    "cargo install",
    "cargo build",
    "cargo bench",
    "git clone",
    ".ci/run",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The Markdown files of the repository's root, of `docs/`, of `examples/` and of the packages.
fn documents() -> Vec<PathBuf> {
    let pages: Vec<PathBuf> = rust::PAGES.iter().map(|page| root().join(page)).collect();
    assert!(pages.len() >= 5, "{pages:?}");
    pages
}

struct Block {
    language: String,
    text: String,
    line: usize,
}

/// The fenced blocks of a document.
fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (i, line) in text.lines().enumerate() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(language), None) => {
                open = Some(Block {
                    language: language.trim().to_owned(),
                    text: String::new(),
                    line: i + 1,
                });
            }
            (None, Some(block)) => {
                block.text += line;
                block.text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

/// A copy of the repository's files, in which documents may write.
struct RepositoryCopy(Folder);

impl RepositoryCopy {
    fn new() -> Self {
        let copy = Folder::new();
        for folder in ["bin", "repository"] {
            fs::create_dir_all(copy.path().join(folder)).unwrap();
        }
        for shared in ["examples", "rules", "tests", "docs"] {
            let there = root().join(shared);
            if there.exists() {
                std::os::unix::fs::symlink(
                    there.canonicalize().unwrap(),
                    copy.path().join("repository").join(shared),
                )
                .unwrap();
            }
        }
        let binary = flagred().get_program().to_owned();
        std::os::unix::fs::symlink(&binary, copy.path().join("bin/flagred")).unwrap();
        // `cargo run --profile quick -- assess LOG` runs the program with these arguments.
        let cargo =
            "#!/bin/sh\nwhile [ \"$1\" != -- ]; do shift; done; shift; exec flagred \"$@\"\n";
        fs::write(copy.path().join("bin/cargo"), cargo).unwrap();
        let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
        fs::set_permissions(copy.path().join("bin/cargo"), executable).unwrap();
        RepositoryCopy(copy)
    }

    /// The output of a command, including standard error.
    fn run(&self, command: &str) -> String {
        let path = format!(
            "{}:{}",
            self.0.path().join("bin").display(),
            std::env::var("PATH").unwrap()
        );
        let output = Command::new("sh")
            .args(["-c", &format!("{{ {command}\n}} 2>&1")])
            .current_dir(self.0.path().join("repository"))
            .env("PATH", path)
            .output()
            .unwrap();
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

/// Whether the printed lines match the document, where `...` matches any lines.
fn matches(output: &[&str], printed: &[&str]) -> bool {
    match output {
        [] => printed.is_empty(),
        ["...", rest @ ..] => (0..=printed.len()).any(|skip| matches(rest, &printed[skip..])),
        [line, rest @ ..] => {
            printed
                .first()
                .is_some_and(|first| first.trim_end() == line.trim_end())
                && matches(rest, &printed[1..])
        }
    }
}

/// Runs the commands of a block; returns the corrected block, and the commands whose output differs.
fn run_console(copy: &RepositoryCopy, block: &Block) -> (String, Vec<String>) {
    let (mut text, mut wrong) = (String::new(), Vec::new());
    let mut lines = block.text.lines().peekable();
    while let Some(line) = lines.next() {
        let Some(command) = line.strip_prefix("$ ") else {
            wrong.push(format!(
                "`{line}` is not a command: write `$ ` before the first line"
            ));
            break;
        };
        let mut said = Vec::new();
        while let Some(line) = lines.next_if(|line| !line.starts_with("$ ")) {
            said.push(line);
        }
        text += &format!("{line}\n");
        if NOT_RUN.iter().any(|known| command.starts_with(known)) {
            text.extend(said.iter().map(|line| format!("{line}\n")));
            continue;
        }
        let printed = copy.run(command);
        let printed: Vec<&str> = printed.trim_end().lines().map(str::trim_end).collect();
        if matches(&said, &printed) {
            text.extend(said.iter().map(|line| format!("{line}\n")));
        } else {
            text.extend(printed.iter().map(|line| format!("{line}\n")));
            let (printed, said) = (printed.join("\n"), said.join("\n"));
            wrong.push(format!(
                "`{command}` prints\n{printed}\nbut the document says\n{said}"
            ));
        }
    }
    (text, wrong)
}

/// Checks that a YAML block is a rule set, a profile, or a part of one of them.
fn check_yaml(copy: &RepositoryCopy, block: &Block) -> Result<(), String> {
    let named = block
        .text
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("# "));
    if let Some(name) = named.filter(|name| name.ends_with(".yaml") && !name.contains(' ')) {
        fs::write(copy.0.path().join("repository").join(name), &block.text).unwrap();
    }
    let starts = |word: &str| block.text.lines().any(|line| line.starts_with(word));
    if starts("fuzzy: ") {
        let document = fuzzy::yaml::parse(&block.text).map_err(|findings| findings.to_string())?;
        fuzzy::Engine::new(&document.model).map_err(|error| error.to_string())?;
    } else if starts("flagred: ") {
        block
            .text
            .parse::<flagred::profile::Profile>()
            .map_err(|findings| findings.to_string())?;
    }
    Ok(())
}

#[test]
fn every_block_runs_as_printed() {
    let mut failures = Vec::new();
    for page in documents() {
        let text = fs::read_to_string(&page).unwrap();
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        let copy = RepositoryCopy::new();
        let mut updated = text.clone();
        for block in blocks(&text) {
            let wrong = match block.language.as_str() {
                "console" => {
                    let (text, wrong) = run_console(&copy, &block);
                    updated = updated.replacen(&block.text, &text, 1);
                    wrong
                }
                "yaml" => check_yaml(&copy, &block).err().into_iter().collect(),
                "json" => serde_json::from_str::<serde_json::Value>(&block.text)
                    .err()
                    .map(|error| error.to_string())
                    .into_iter()
                    .collect(),
                _ => Vec::new(),
            };
            let place = format!("{name}, line {}", block.line);
            failures.extend(wrong.into_iter().map(|what| format!("{place}: {what}")));
        }
        if std::env::var_os("UPDATE_DOCUMENTS").is_some() && updated != text {
            fs::write(&page, updated).unwrap();
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

/// The links of a document, outside of its blocks.
fn links(text: &str) -> Vec<&str> {
    text.split("```")
        .step_by(2)
        .flat_map(|prose| prose.split("](").skip(1))
        .filter_map(|rest| rest.split(')').next())
        .filter(|target| !target.contains("://") && !target.contains(' '))
        .collect()
}

/// The anchors of a document's headings, as GitHub makes them.
fn anchors(text: &str) -> Vec<String> {
    let prose: String = text.split("```").step_by(2).collect();
    let headings = prose.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let title = heading.trim_start_matches('#').trim().to_lowercase();
        title
            .chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    headings.map(anchor).collect()
}

/// Links within the repository lead to existing files.
#[test]
fn every_link_to_a_file_leads_to_one() {
    let mut broken = Vec::new();
    for page in documents() {
        let text = fs::read_to_string(&page).unwrap();
        for target in links(&text) {
            let file = target.split('#').next().unwrap_or_default();
            if !file.is_empty() && !page.parent().unwrap().join(file).exists() {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn every_link_to_a_heading_leads_to_one() {
    let mut broken = Vec::new();
    for page in documents() {
        let text = fs::read_to_string(&page).unwrap();
        for target in links(&text) {
            let Some((file, anchor)) = target.split_once('#') else {
                continue;
            };
            let headings = match file {
                "" => anchors(&text),
                _ => anchors(&fs::read_to_string(page.parent().unwrap().join(file)).unwrap()),
            };
            if !headings.iter().any(|heading| heading == anchor) {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

mod rust {
    #![allow(unused, reason = "what a page shows need not be used")]

    /// The module of docs/firmware.md: `flagred export --rust rules/tipper.yaml`.
    mod tipper {
        include!(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/exported/rules_tipper.rs"
        ));
    }

    /// The module of examples/09-on-board.md: `flagred export --rust`.
    mod profile {
        include!(concat!(env!("CARGO_MANIFEST_DIR"), "/exported/flagred.rs"));
    }

    include!(concat!(env!("OUT_DIR"), "/documents.rs"));
}
