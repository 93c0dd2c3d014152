//! Every command that writes files, with small inputs, for tests of these files.
#![expect(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    reason = "helpers of tests: what does not hold fails the test"
)]

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use crate::{Folder, flagred};

pub const RULES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../rules/flagred-paper.yaml");

/// A command, and the files that it writes.
pub struct WritingCommand {
    pub arguments: Vec<String>,
    pub files: Vec<String>,
}

/// Returns a flight of the given length at 10 Hz, whose motors alternate between their limits. The verdict is FAIL,
/// unless the flight is short.
pub fn wild_flight(length_s: u32) -> String {
    let mut log = "t_s,motor1,motor2,motor3,motor4,in_air\n".to_owned();
    for i in 0..length_s * 10 {
        let swing = |motor: u32| {
            if (i / 3 + motor).is_multiple_of(2) {
                1.0
            } else {
                0.05
            }
        };
        let [a, b, c, d] = [0, 1, 0, 1].map(swing);
        let in_air = u8::from(i > 10);
        log += &format!("{},{a},{b},{c},{d},{in_air}\n", f64::from(i) / 10.0);
    }
    log
}

/// All commands that write files, with inputs in a folder, and outputs in its folder `out`.
pub fn commands(folder: &Folder) -> Vec<WritingCommand> {
    let log = folder.file("log.csv", wild_flight(40));
    let rows = "margin,spread,risk\n0.1,0.1,50\n0.3,0.05,10\n0.02,0.2,95\n";
    let rows = folder.file("rows.csv", rows);
    let table = "att_rmse_deg,margin,spread\n1,0.3,0.05\n9,0.02,0.2\n2,0.2,0.1\n7,0.05,0.15\n";
    let table = folder.file("table.csv", table);
    let policy = "http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'\"";
    let page = folder.file("page.html", format!("<meta {policy}>{}", " ".repeat(5000)));
    fs::create_dir_all(folder.path().join("out")).unwrap();
    let out = |name: &str| folder.at(&format!("out/{name}"));
    let writing = |arguments: &[&str], files: &[&str]| WritingCommand {
        arguments: arguments.iter().map(|a| (*a).to_owned()).collect(),
        files: files.iter().map(|file| (*file).to_owned()).collect(),
    };
    let (html, svg) = (&out("report.html"), &out("risk.svg"));
    let (csv, map) = (&out("flight.csv"), &out("map.svg"));
    let (explained, curves) = (&out("explained.svg"), &out("curves.svg"));
    let (learned, new) = (&out("learned.yaml"), &out("new.yaml"));
    let (rust, c, pages) = (&out("profile.rs"), &out("profile.h"), &out("pages"));
    let studio = &out("studio.html");
    let values = ["margin=0.1", "spread=0.1"];
    vec![
        writing(
            &["assess", &log, "--html", html, "--svg", svg],
            &[html, svg],
        ),
        writing(&["convert", &log, "-o", csv], &[csv]),
        writing(&["map", RULES, "--svg", map], &[map]),
        writing(
            &["explain", RULES, values[0], values[1], "--svg", explained],
            &[explained],
        ),
        writing(&["validate", "--rows", &table, "--svg", curves], &[curves]),
        writing(
            &["learn", RULES, &rows, "-o", learned, "--force"],
            &[learned],
        ),
        writing(&["new", "mine", "-o", new, "--force"], &[new]),
        writing(&["export", "--rust", "-o", rust], &[rust]),
        writing(&["export", "--c", "-o", c], &[c]),
        writing(&["studio", "--page", &page, "--html", studio], &[studio]),
        writing(
            &["man", "--folder", pages],
            &[&out("pages/flagred.1"), &out("pages/flagred-new.1")],
        ),
    ]
}

impl WritingCommand {
    /// The command, with its standard output and error discarded.
    pub fn command(&self) -> Command {
        let mut command = flagred();
        command.args(&self.arguments);
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command
    }

    /// The command with a limit on the size of files, in blocks of 512 bytes.
    pub fn limited(&self, blocks: u64) -> Command {
        let mut command = limited(blocks);
        command.args(&self.arguments);
        command
    }

    /// The contents of the files that the command wrote.
    pub fn contents(&self) -> Vec<Vec<u8>> {
        self.files
            .iter()
            .map(|file| fs::read(file).unwrap())
            .collect()
    }
}

/// The binary with a limit on the size of files, in blocks of 512 bytes, as on a full disk.
pub fn limited(blocks: u64) -> Command {
    let mut command = Command::new("sh");
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    command.args(["-c", &script]).arg(flagred().get_program());
    command
}

/// The names of temporary files left in a folder.
pub fn drafts(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.ends_with(".part")).collect()
}
