//! Finds the documents and creates a test of every Rust block in them, so that the printed code is the code that runs.

use std::{env, fmt::Write as _, fs, path::Path};

fn main() -> std::io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    println!("cargo::rerun-if-changed=build.rs");
    let (mut names, mut tests) = (Vec::new(), String::new());
    for folder in [
        "",
        "docs",
        "examples",
        "fuzzy",
        "flagred",
        "crates/flightlog",
        "crates/cli",
        "bindings/c",
    ] {
        let folder = root.join(folder);
        println!("cargo::rerun-if-changed={}", folder.display());
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        let mut pages: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        pages.sort();
        for page in pages {
            if page.extension().is_some_and(|extension| extension == "md") {
                println!("cargo::rerun-if-changed={}", page.display());
                let name = page.strip_prefix(&root).unwrap_or(&page);
                let text = fs::read_to_string(&page)?;
                add(
                    &mut tests,
                    &name.with_extension("").to_string_lossy(),
                    &text,
                );
                names.push(name.to_owned());
            }
        }
    }
    let _ = writeln!(tests, "pub const PAGES: &[&str] = &{names:?};");
    let out = env::var_os("OUT_DIR").unwrap_or_default();
    fs::write(Path::new(&out).join("documents.rs"), tests)
}

/// Adds a test for each block fenced as `rust`. The tests run at the root of the repository, like the commands of a reader.
fn add(tests: &mut String, page: &str, text: &str) {
    let name: String = page
        .chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '_'
            }
        })
        .collect();
    for (i, rest) in text.split("\n```rust\n").skip(1).enumerate() {
        let Some((code, _)) = rest.split_once("\n```") else {
            continue;
        };
        // As in rustdoc, `# ` hides a line that a reader does not need. The test has its own `Ok`.
        let code: String = code
            .lines()
            .map(|line| line.strip_prefix("# ").unwrap_or(line))
            .filter(|line| !line.starts_with("Ok::<"))
            .map(|line| format!("{line}\n"))
            .collect();
        let name = format!("page_{name}_{}", i + 1);
        let result = "Result<(), Box<dyn std::error::Error>>";
        // A block that uses a `text` supplied by the reader is only compiled, because there is no text to run it on.
        if code.find("(text)") < code.find("let text").or(Some(usize::MAX))
            && code.contains("(text)")
        {
            let _ = writeln!(
                tests,
                "fn {name}(text: &str) -> {result} {{\n{code}\nOk(())\n}}\n"
            );
            continue;
        }
        let call = if code.contains("fn main()") {
            "main()?;"
        } else {
            ""
        };
        let _ = writeln!(
            tests,
            "#[test]\nfn {name}() -> {result} {{\n\
             std::env::set_current_dir(concat!(env!(\"CARGO_MANIFEST_DIR\"), \"/..\"))?;\n\
             {code}\n{call}Ok(())\n}}\n"
        );
    }
}
