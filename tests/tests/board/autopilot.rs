//! A stand-in for the autopilot that runs exported scripts: Lua 5.3 with 32-bit floats and integers, and with stricter
//! limits on local variables and upvalues than in ArduPilot's Lua.

use std::{
    fmt::Write as _,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::OnceLock,
};

use flagred::{board::Factors, verdict::Level};
use flagred_flightlog::{Flight, ardupilot_frames};
use flagred_tests::Folder;

/// The maximum number of instructions per call. ArduPilot allows 10,000 (SCR_VM_I_COUNT).
const BUDGET: f64 = 8_000.0;
/// The maximum numbers of local variables and upvalues of a function. ArduPilot's limits are 100 and 127, Lua's own 200 and 255.
const LIMITS: [(&str, &str, &str); 2] = [
    ("lparser.c", "#define MAXVARS\t\t200", "#define MAXVARS 90"),
    ("lfunc.h", "#define MAXUPVAL\t255", "#define MAXUPVAL 110"),
];
/// The maximum heap of the script with 32-bit pointers, as on the autopilot; with 64-bit pointers
/// the heap is nearly twice as large. `CFLAGS=-m32` builds Lua with 32 bits, if the compiler
/// supports it.
const HEAP_BYTES: u64 = 75_000;
/// The clock of the autopilot wraps around after 71 minutes; in the tests, this is a minute after the first sample.
const FIRST_US: u64 = (1 << 32) - 60_000_000;

/// The sources of Lua 5.3, which the package `lua-src` contains.
fn sources() -> PathBuf {
    // The packages for other platforms may not have been downloaded, so only those for this platform are listed.
    let version = Command::new("rustc").arg("-vV").output().unwrap();
    let version = String::from_utf8(version.stdout).unwrap();
    let mut lines = version.lines();
    let host = lines.find_map(|line| line.strip_prefix("host: ")).unwrap();
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--offline"])
        .args(["--filter-platform", host])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&metadata.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    let package = packages.iter().find(|package| package["name"] == "lua-src");
    let manifest = package.unwrap()["manifest_path"].as_str().unwrap();
    Path::new(manifest).parent().unwrap().join("lua-5.3.6")
}

/// Copies a source file of the Lua interpreter and replaces its limits by those of the autopilot.
fn limited(source: &Path, folder: &Folder) -> PathBuf {
    let mut text = std::fs::read_to_string(source).unwrap();
    let name = source.file_name().unwrap().to_str().unwrap();
    for (_, usual, limit) in LIMITS.iter().filter(|(file, _, _)| *file == name) {
        assert!(text.contains(usual), "{name} has no `{usual}`");
        text = text.replace(usual, limit);
    }
    let copy = folder.path().join(name);
    std::fs::write(&copy, text).unwrap();
    copy
}

/// `tests/lua/autopilot.c` with Lua, compiled by `cc`, which Rust requires for linking too.
fn autopilot() -> Command {
    static BUILT: OnceLock<(PathBuf, Folder)> = OnceLock::new();
    let (binary, _) = BUILT.get_or_init(|| {
        let folder = Folder::new();
        let files = std::fs::read_dir(sources()).unwrap();
        let files: Vec<PathBuf> = files
            .map(|file| limited(&file.unwrap().path(), &folder))
            .collect();
        let binary = folder.path().join("autopilot");
        let mut cc = Command::new("cc");
        cc.args(["-O2", "-w", "-DLUA_32BITS", "-I"])
            .arg(folder.path());
        cc.args(
            files
                .iter()
                .filter(|file| file.extension().is_some_and(|end| end == "c")),
        );
        cc.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/lua/autopilot.c"));
        if let Ok(flags) = std::env::var("CFLAGS") {
            cc.args(flags.split_whitespace());
        }
        let compiled = cc.arg("-lm").arg("-o").arg(&binary).output().unwrap();
        let reported = String::from_utf8_lossy(&compiled.stderr);
        assert!(compiled.status.success(), "{reported}");
        (binary, folder)
    });
    Command::new(binary)
}

/// A vehicle.
pub(super) struct Vehicle {
    /// The range of the motors in us.
    pub(super) pwm: (f64, f64),
    /// The ends of the effective range, as fractions of the range.
    pub(super) spin: (f64, f64),
    /// FRAME_CLASS and FRAME_TYPE.
    pub(super) frame: (i64, i64),
    pub(super) factors: Vec<Factors>,
}

/// The state of the autopilot at one time.
#[derive(Clone)]
pub(super) struct Record {
    pub(super) t_us: u64,
    pub(super) flying: bool,
    /// The pulse of each motor in us; NaN without an output.
    pub(super) pwm: Vec<f64>,
    /// The battery level in %; NaN if it is not monitored.
    pub(super) battery_pct: f64,
}

impl Vehicle {
    pub(super) fn of(flight: &Flight) -> Vehicle {
        let range = flight.range.as_ref().unwrap();
        let geometry = flight.geometry.as_ref().unwrap();
        let name = geometry.frame.as_deref().unwrap();
        let frame = ardupilot_frames().find(|frame| frame.name == name).unwrap();
        Vehicle {
            pwm: (range.low, range.high),
            spin: (flight.effective_range.low, flight.effective_range.high),
            frame: (frame.class, frame.kind),
            factors: geometry.factors.clone(),
        }
    }

    pub(super) fn named(name: &str) -> Vehicle {
        let frame = ardupilot_frames().find(|frame| frame.name == name).unwrap();
        Vehicle {
            pwm: (1000.0, 2000.0),
            spin: (0.15, 0.95),
            frame: (frame.class, frame.kind),
            factors: frame.motors.iter().map(|(_, factors)| *factors).collect(),
        }
    }

    fn parameters(&self) -> Vec<String> {
        vec![
            format!("MOT_PWM_MIN={}", self.pwm.0),
            format!("MOT_PWM_MAX={}", self.pwm.1),
            format!("MOT_SPIN_MIN={}", self.spin.0),
            format!("MOT_SPIN_MAX={}", self.spin.1),
            format!("FRAME_CLASS={}", self.frame.0),
            format!("FRAME_TYPE={}", self.frame.1),
        ]
    }

    pub(super) fn effective(&self, pwm: f64) -> f64 {
        let command = ((pwm - self.pwm.0) / (self.pwm.1 - self.pwm.0)).clamp(0.0, 1.0);
        ((command - self.spin.0) / (self.spin.1 - self.spin.0)).clamp(0.0, 1.0)
    }
}

/// The states of the autopilot during a flight. Commands are rounded to whole microseconds.
pub(super) fn records(flight: &Flight) -> Vec<Record> {
    let first_s = flight.commands.t_s()[0];
    let mut battery = flight
        .signal("battery_remaining_pct")
        .map(|signal| signal.hold());
    let rows = flight.commands.rows().map(|(t_s, row)| Record {
        t_us: ((t_s - first_s) * 1e6).round() as u64,
        flying: flight.is_in_air(t_s) == Some(true),
        pwm: row.iter().map(|pwm| pwm.round()).collect(),
        battery_pct: battery
            .as_mut()
            .and_then(|hold| hold.at(t_s))
            .map_or(f64::NAN, f64::round),
    });
    rows.collect()
}

/// The output for a record: the index of the record, risk and elevated risk in %, and level.
pub(super) type RecordOutput = (usize, f64, f64, Level);

/// The output of a run of the script.
#[derive(Default)]
pub(super) struct Run {
    pub(super) logged: Vec<RecordOutput>,
    pub(super) texts: String,
    pub(super) values: usize,
    /// The reason why the autopilot could not be armed.
    pub(super) blocks: Option<String>,
    /// The number of instructions of a call: the maximum at the start, the maximum in flight, and the mean in flight.
    pub(super) instructions: [f64; 3],
    /// The size of a pointer in bytes, followed by the bytes in use at four times: before the script is loaded, with
    /// the script after a garbage collection, at the peak at the start, and at the peak in flight.
    pub(super) heap: [u64; 5],
}

pub(super) fn run(script: &str, vehicle: &Vehicle, records: &[Record], parameters: &[&str]) -> Run {
    let mut child = autopilot()
        .arg(script)
        .arg(vehicle.factors.len().to_string())
        .arg(FIRST_US.to_string())
        .args(vehicle.parameters())
        .args(parameters)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let numbers = records.iter().flat_map(|record| {
        [
            (record.t_us - records[0].t_us) as f64,
            f64::from(u8::from(record.flying)),
        ]
        .into_iter()
        .chain(record.pwm.iter().copied())
        .chain([record.battery_pct])
    });
    let bytes: Vec<u8> = numbers.flat_map(f64::to_ne_bytes).collect();
    let mut stdin = child.stdin.take().unwrap();
    let writer = std::thread::spawn(move || stdin.write_all(&bytes));
    let output = child.wait_with_output().unwrap();
    let written = writer.join().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    let mut run = Run::default();
    let (mut calls, mut ended) = (0, false);
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |i: usize| words[i].parse::<f64>().unwrap();
        match words[0] {
            "log" => {
                let level = match words[4] {
                    "0" => Level::Good,
                    "2" => Level::Warn,
                    "3" => Level::Fail,
                    level => panic!("level {level}"),
                };
                run.logged
                    .push((words[1].parse().unwrap(), number(2), number(3), level));
            }
            "float" => run.values += 1,
            "text" => {
                let t_s = match words[1] {
                    "-1" => "start".to_owned(),
                    record => format!(
                        "{:.1} s",
                        records[record.parse::<usize>().unwrap()].t_us as f64 / 1e6
                    ),
                };
                let _ = writeln!(run.texts, "{t_s}, {}: {}", words[2], words[3..].join(" "));
            }
            "blocks" => run.blocks = Some(words[2..].join(" ")),
            "ended" => ended = true,
            "calls" => calls = number(1) as usize,
            "instructions" => run.instructions = [1, 2, 3].map(number),
            "heap" => run.heap = [1, 2, 3, 4, 5].map(|i| number(i) as u64),
            _ => panic!("{line}"),
        }
    }
    let stops = ended || run.blocks.is_some();
    assert_eq!(calls, if stops { 0 } else { records.len() }, "{text}");
    assert!(written.is_ok() || stops);
    run
}

impl Run {
    pub(super) fn assert_within_budget(&self, what: &str) {
        let instructions = self.instructions;
        assert!(
            instructions.iter().all(|count| *count <= BUDGET),
            "{what}: {instructions:?}"
        );
        assert_eq!(self.blocks, None, "{what}");
        let [pointer, before, kept, ..] = self.heap;
        assert!(
            (kept - before) * 4 / pointer < HEAP_BYTES,
            "{what}: {:?}",
            self.heap
        );
    }
}
