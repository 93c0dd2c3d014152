//! The files that commands write, and those that they must not write.
#![cfg(unix)]

use std::{
    fs,
    io::Read,
    os::unix::{
        fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink},
        net::UnixListener,
    },
    path::Path,
    process::{Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use flagred_tests::{
    Folder, STEADY, flagred,
    vehicle::flight,
    watch::{Watch, assess},
    wire::{Link, Speed},
    writing::{RULES, WritingCommand, commands, drafts, limited, wild_flight},
};

fn run(arguments: &[&str]) -> (Option<i32>, String) {
    let output = flagred().args(arguments).output().unwrap();
    let reported = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), reported)
}

/// An input is recognised by its own name, through a symbolic link, by another spelling of its path, and by a hard
/// link.
#[test]
fn no_output_replaces_an_input() {
    let folder = Folder::new();
    let log = folder.file("log.csv", wild_flight(30));
    let rules = folder.file("rules.svg", fs::read(RULES).unwrap());
    let rows = folder.file("rows.csv", "margin,spread,risk\n0.1,0.1,50\n");
    let table = folder.file(
        "table.svg",
        "att_rmse_deg,margin,spread\n1,0.3,0.05\n9,0.02,0.2\n",
    );
    let profile = fs::read_to_string(RULES.replace("flagred-paper", "profiles/flagred-paper"));
    let profile = folder.file("profile.yaml", profile.unwrap());
    // A log is detected by its content, whatever its name is.
    let page = folder.file("page.html", wild_flight(30));
    symlink(&log, folder.at("link.csv")).unwrap();
    fs::hard_link(&page, folder.at("other.html")).unwrap();
    fs::create_dir(folder.at("sub")).unwrap();
    let (link, other) = (folder.at("link.csv"), folder.at("other.html"));
    let around = folder.at("sub/../rules.svg");
    let values = ["margin=0.1", "spread=0.1"];
    for (arguments, input) in [
        (vec!["convert", &log, "-o", &log], &log),
        (vec!["convert", &log, "-o", &link], &log),
        (vec!["convert", &link, "-o", &log], &log),
        (vec!["assess", &page, "--html", &page], &page),
        (vec!["assess", STEADY, &page, "--html", &other], &page),
        (vec!["map", &rules, "--svg", &rules], &rules),
        (vec!["map", &rules, "--surface", "--svg", &around], &rules),
        (
            vec!["explain", &rules, values[0], values[1], "--svg", &rules],
            &rules,
        ),
        (
            vec!["learn", &rules, &rows, "-o", &rules, "--force"],
            &rules,
        ),
        (vec!["learn", &rules, &rows, "-o", &rows, "--force"], &rows),
        (vec!["validate", "--rows", &table, "--svg", &table], &table),
        (vec!["export", "--c", &profile, "-o", &profile], &profile),
        (
            vec!["assess", &log, "--profile", &profile, "--html", &profile],
            &profile,
        ),
    ] {
        let before = fs::read(input).unwrap();
        let (code, reported) = run(&arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {reported}");
        assert!(
            reported.contains("is also an input")
                || reported.contains("which is an input")
                || reported.contains("; write `"),
            "{arguments:?}: {reported}"
        );
        assert!(fs::read(input).unwrap() == before, "{arguments:?}");
    }
    assert_eq!(drafts(folder.path()), [""; 0]);
}

/// `assess --html *.BIN` takes the first log as the name of the report.
#[test]
fn a_log_named_as_the_report_is_not_replaced() {
    let folder = Folder::new();
    let first = folder.file("first.BIN", fs::read(STEADY).unwrap());
    for arguments in [
        ["assess", "--html", &first, STEADY],
        ["assess", "--svg", &first, STEADY],
        ["convert", "-o", &first, STEADY],
    ] {
        let (code, reported) = run(&arguments);
        assert_eq!(code, Some(2), "{reported}");
        assert!(reported.contains("; write `"), "{reported}");
        assert!(fs::read(&first).unwrap() == fs::read(STEADY).unwrap());
    }
}

#[test]
fn two_outputs_cannot_be_the_same_file() {
    let folder = Folder::new();
    let same = folder.at("same");
    symlink("same", folder.at("link")).unwrap();
    let link = folder.at("link");
    for (html, svg) in [(&same, &same), (&same, &link), (&link, &same)] {
        let (code, reported) = run(&["assess", STEADY, "--html", html, "--svg", svg]);
        assert_eq!(code, Some(2), "{reported}");
        assert!(
            reported.contains("which is another output")
                || reported.contains("is also another output"),
            "{reported}"
        );
        assert!(!Path::new(&same).exists());
    }
    let (code, reported) = run(&["assess", STEADY, "--html", "-", "--svg", "-"]);
    assert_eq!(code, Some(2));
    assert!(reported.contains("two outputs are `-`"), "{reported}");
}

/// `flagred convert log.csv -o - >> log.csv` would never end.
#[test]
fn standard_output_that_is_also_an_input_or_output_is_refused() {
    let folder = Folder::new();
    let log = folder.file("log.csv", wild_flight(30));
    let html = folder.file("page.html", "");
    let append = |file: &str, arguments: &[&str]| {
        let out = fs::OpenOptions::new().append(true).open(file).unwrap();
        let Output { status, stderr, .. } = flagred()
            .args(arguments)
            .stdout(out)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        (status.code(), String::from_utf8(stderr).unwrap())
    };
    let before = fs::read(&log).unwrap();
    for (file, arguments) in [
        (&log, vec!["convert", &log, "-o", "-"]),
        (&log, vec!["inspect", &log]),
        (&log, vec!["dataset", &log]),
        (&html, vec!["assess", &log, "--html", &html]),
    ] {
        let (code, reported) = append(file, &arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {reported}");
        assert!(reported.contains("standard output"), "{reported}");
    }
    assert!(fs::read(&log).unwrap() == before);
}

#[test]
fn a_replaced_file_keeps_its_mode_and_links_keep_leading_to_it() {
    let folder = Folder::new();
    let log = folder.file("log.csv", wild_flight(30));
    for writing in commands(&folder) {
        for file in &writing.files {
            let path = Path::new(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            let real = format!("{file}.real");
            fs::write(&real, "old").unwrap();
            fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
            symlink(
                path.file_name().unwrap().to_str().unwrap().to_owned() + ".real",
                path,
            )
            .unwrap();
        }
        let code = writing.command().status().unwrap().code();
        assert!(matches!(code, Some(0 | 1)), "{:?}", writing.arguments);
        for file in &writing.files {
            let link = fs::symlink_metadata(file).unwrap();
            assert!(link.is_symlink(), "{file}");
            let real = fs::metadata(format!("{file}.real")).unwrap();
            assert_eq!(real.mode() & 0o777, 0o640, "{file}");
            assert!(real.len() > 3, "{file}");
        }
    }
    // A new file has the default mode of new files, even if it is created through a link.
    symlink("target.csv", folder.at("dangling.csv")).unwrap();
    let (code, reported) = run(&["convert", &log, "-o", &folder.at("dangling.csv")]);
    assert_eq!(code, Some(0), "{reported}");
    let plain = fs::metadata(folder.file("plain", "")).unwrap();
    let made = fs::symlink_metadata(folder.at("target.csv")).unwrap();
    assert!(made.is_file() && made.mode() == plain.mode());
}

#[test]
fn special_files_are_written_to_and_not_replaced() {
    let folder = Folder::new();
    let fifo = folder.at("fifo");
    assert!(
        Command::new("mkfifo")
            .arg(&fifo)
            .status()
            .unwrap()
            .success()
    );
    let socket = folder.at("socket");
    let listener = UnixListener::bind(&socket).unwrap();
    let mut whole = None;
    for place in [folder.at("plain"), fifo.clone(), socket.clone()] {
        let from = (place.clone(), listener.try_clone().unwrap());
        let reader = thread::spawn(move || {
            let (place, listener) = from;
            let mut read = Vec::new();
            if place.ends_with("socket") {
                listener.accept().unwrap().0.read_to_end(&mut read).unwrap();
            } else if place.ends_with("fifo") {
                fs::File::open(place)
                    .unwrap()
                    .read_to_end(&mut read)
                    .unwrap();
            }
            read
        });
        let (code, reported) = run(&["convert", STEADY, "-o", &place]);
        assert_eq!(code, Some(0), "{place}: {reported}");
        let read = reader.join().unwrap();
        let whole = whole.get_or_insert_with(|| fs::read(&place).unwrap());
        assert!(read == *whole || place.ends_with("plain"), "{place}");
    }
    assert!(fs::symlink_metadata(fifo).unwrap().file_type().is_fifo());
    assert!(
        fs::symlink_metadata(socket)
            .unwrap()
            .file_type()
            .is_socket()
    );
}

/// Rule sets may be written by hand: `new` and `learn` do not replace them without an option.
#[test]
fn files_that_may_be_edited_are_replaced_only_with_force() {
    let folder = Folder::new();
    for writing in commands(&folder) {
        if !writing
            .arguments
            .iter()
            .any(|argument| argument == "--force")
        {
            continue;
        }
        let file = &writing.files[0];
        fs::write(file, "by hand").unwrap();
        let cautious: Vec<&str> = writing.arguments.iter().map(String::as_str).collect();
        let cautious: Vec<&str> = cautious.into_iter().filter(|a| *a != "--force").collect();
        let (code, reported) = run(&cautious);
        assert_eq!(code, Some(2), "{reported}");
        assert!(
            reported.contains("exists already") && reported.contains("`--force`"),
            "{reported}"
        );
        assert_eq!(fs::read_to_string(file).unwrap(), "by hand");
        assert_eq!(writing.command().status().unwrap().code(), Some(0));
        assert!(fs::read_to_string(file).unwrap().contains("fuzzy: 1"));
    }
}

/// The old file is intact, the error is reported, and no temporary file is left.
#[test]
fn a_full_disk_leaves_the_old_file_and_exits_with_2() {
    let folder = Folder::new();
    for writing in commands(&folder) {
        for file in &writing.files {
            fs::create_dir_all(Path::new(file).parent().unwrap()).unwrap();
            fs::write(file, "old").unwrap();
        }
        let output = writing.limited(1).output().unwrap();
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(
            output.status.code(),
            Some(2),
            "{:?}: {reported}",
            writing.arguments
        );
        assert!(
            reported.contains("cannot be written") && reported.contains("free some disk space"),
            "{reported}"
        );
        assert!(
            writing.contents().iter().all(|content| content == b"old"),
            "{reported}"
        );
        for file in &writing.files {
            assert_eq!(drafts(Path::new(file).parent().unwrap()), [""; 0]);
        }
    }
}

/// An incomplete table must not be mistaken for a complete one.
#[test]
fn a_full_disk_behind_standard_output_exits_with_2() {
    for arguments in [
        vec!["convert", STEADY, "-o", "-"],
        vec!["assess", STEADY],
        vec!["assess", "--json", STEADY],
        vec!["assess", "--csv", STEADY],
        vec!["inspect", STEADY],
        vec!["check", RULES],
        vec!["map", RULES],
        vec!["map", RULES, "--csv"],
        vec!["explain", RULES, "margin=0.1", "spread=0.1"],
        vec!["dataset", STEADY],
        vec!["export", "--c"],
        vec!["new", "mine", "-o", "-"],
        vec!["man"],
        vec!["completions", "bash"],
    ] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = flagred().args(&arguments).stdout(full).output().unwrap();
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {reported}");
        assert!(
            reported.contains("cannot be written"),
            "{arguments:?}: {reported}"
        );
    }
}

#[test]
fn a_watch_reports_a_failed_recording_and_continues() {
    let folder = Folder::new();
    let file = folder.at("recorded.tlog");
    let flight = flight(Path::new(STEADY));
    let watch = Watch::of(limited(100), "udpin:127.0.0.1:0", &["--record", &file]);
    let mut vehicle = watch.vehicle(&flight, Link::default());
    vehicle.meet();
    let air = flight.in_air.as_ref().unwrap().spans[0];
    vehicle.fly(&flight, Speed::Fastest, air.start_s, air.end_s);
    let said = watch.end();
    assert!(said.has_note("cannot record to"));
    let failed = said.events.iter().position(|event| {
        event["text"]
            .as_str()
            .is_some_and(|text| text.contains("cannot record to"))
    });
    let risks = said.events[failed.unwrap()..].iter();
    let risks = risks.filter(|event| event["event"] == "risk").count();
    assert!(risks > 100, "{risks}");
    assert_eq!(said.code, Some(0));
    // The recording ends with a complete packet.
    let read = assess(Path::new(&file));
    assert_eq!(read["read"]["truncated"], false, "{}", read["read"]);
    assert_eq!(read["read"]["skipped_bytes"], 0);
    assert!((10_000..=51_200).contains(&fs::metadata(&file).unwrap().len()));
}

/// Faults during the writing of a file.
#[derive(Debug)]
enum Fault {
    Kill(Duration),
    FullDisk(u64),
    ClosedPipe,
}

struct Round {
    writing: WritingCommand,
    /// The contents of the files that the command wrote without a fault.
    new: Vec<Vec<u8>>,
    code: Option<i32>,
    /// The duration of the command without a fault.
    time: Duration,
}

fn rounds(folder: &Folder) -> Vec<Round> {
    let commands = commands(folder).into_iter();
    let round = |writing: WritingCommand| {
        let start = Instant::now();
        let code = writing.command().status().unwrap().code();
        let (new, time) = (writing.contents(), start.elapsed());
        assert!(matches!(code, Some(0 | 1)), "{:?}", writing.arguments);
        Round {
            writing,
            new,
            code,
            time,
        }
    };
    commands.map(round).collect()
}

/// After any fault, each file is completely the old one or the new one.
fn old_or_new(seed: u64, count: usize) {
    let folder = Folder::new();
    let rounds = rounds(&folder);
    let mut random = fastrand::Rng::with_seed(seed);
    let (mut kept, mut replaced) = (0, 0);
    for i in 0..count {
        let round = &rounds[i % rounds.len()];
        let Round { writing, new, .. } = round;
        let old = format!("old {i}").into_bytes();
        writing
            .files
            .iter()
            .for_each(|file| fs::write(file, &old).unwrap());
        let largest = new.iter().map(Vec::len).max().unwrap() as u64 / 512 + 2;
        let fault = match random.u8(0..4) {
            0 | 1 => Fault::Kill(round.time.mul_f64(random.f64() * 1.1)),
            2 => Fault::FullDisk(random.u64(1..largest)),
            _ => Fault::ClosedPipe,
        };
        let code = match fault {
            Fault::Kill(after) => {
                let mut child = writing.command().spawn().unwrap();
                thread::sleep(after);
                child.kill().unwrap();
                child.wait().unwrap().code()
            }
            Fault::FullDisk(blocks) => writing.limited(blocks).output().unwrap().status.code(),
            Fault::ClosedPipe => {
                let mut child = writing.command().stdout(Stdio::piped()).spawn().unwrap();
                drop(child.stdout.take());
                child.wait().unwrap().code()
            }
        };
        let what = format!("seed {seed}, round {i}, {fault:?}, {:?}", writing.arguments);
        let now = writing.contents();
        for (now, new) in now.iter().zip(new) {
            assert!(*now == old || now == new, "{what}: {} bytes", now.len());
            kept += usize::from(*now == old);
            replaced += usize::from(now == new);
        }
        let is_new = now == *new;
        match fault {
            Fault::Kill(_) => {}
            // Only some manual pages are compared; the page that does not fit on the disk may be one of the others.
            Fault::FullDisk(_) if is_new && writing.arguments[0] == "man" => {}
            Fault::FullDisk(_) => {
                assert_eq!(code, if is_new { round.code } else { Some(2) }, "{what}");
            }
            Fault::ClosedPipe => assert!(is_new && code == round.code, "{what}: {code:?}"),
        }
    }
    assert!(
        kept > count / 10 && replaced > count / 10,
        "{kept} kept, {replaced} replaced"
    );
}

#[test]
fn a_failed_write_leaves_the_old_or_the_new_file() {
    old_or_new(16, 40);
}

#[test]
#[ignore = "takes half a minute"]
fn a_failed_write_leaves_the_old_or_the_new_file_many_times() {
    for seed in 0..4 {
        old_or_new(seed, 250);
    }
}

/// On a disk that is really full, the old file is intact as well.
#[test]
#[ignore = "mounts a small file system, which not every machine allows"]
fn a_full_file_system_leaves_the_old_file() {
    let folder = Folder::new();
    let mounted = folder.path().join("out");
    let script = "mount -t tmpfs -o size=64k none \"$OUT\" && printf old > \"$FILE\" \
        && head -c 60k /dev/zero > \"$OUT/ballast\" && \"$@\"; echo \"$?\"; cat \"$FILE\"; ls -A \"$OUT\" | wc -l";
    let mut tried = 0;
    for writing in commands(&folder) {
        let file = &writing.files[0];
        if writing.arguments[0] == "man" || writing.arguments[0] == "new" {
            // Manual pages are written to their own folder, and a template fits on the disk.
            continue;
        }
        let output = Command::new("unshare")
            .args(["-rm", "sh", "-c", script, "sh"])
            .arg(flagred().get_program())
            .args(&writing.arguments)
            .env("OUT", &mounted)
            .env("FILE", file)
            .output()
            .unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let reported = String::from_utf8(output.stderr).unwrap();
        assert!(
            said.ends_with("2\nold2\n"),
            "{:?}: {said}{reported}",
            writing.arguments
        );
        assert!(reported.contains("No space left on device"), "{reported}");
        tried += 1;
    }
    assert!(tried >= 8);
}
