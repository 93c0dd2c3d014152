//! A running `flagred watch`, and its output.
#![expect(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    missing_docs,
    reason = "helpers of tests: what does not hold fails the test"
)]

use std::{
    io::{BufRead, BufReader},
    net::SocketAddr,
    path::Path,
    process::{Child, Command, Output, Stdio},
    sync::{Arc, atomic::Ordering},
    thread::JoinHandle,
};

use flagred_flightlog::{Flight, mavlink::Version};
use serde_json::Value;

use crate::{
    flagred,
    vehicle::{Inbox, Progress, StandIn},
    wire::{Link, Speed, Wire},
};

/// A process that is killed at the end of the test, even if the test fails.
struct ChildProcess(Child);

impl Drop for ChildProcess {
    fn drop(&mut self) {
        // Errors are ignored: the process has ended already, or the test has failed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A running watch, and its address.
pub struct Watch {
    child: ChildProcess,
    address: Option<SocketAddr>,
    /// The reader of the watch's output, without which the watch would block.
    reader: JoinHandle<Vec<Value>>,
    progress: Arc<Progress>,
}

impl Watch {
    pub fn start(endpoint: &str, options: &[&str]) -> Watch {
        Watch::start_keeping(endpoint, options, |_| true)
    }

    /// Starts a watch and keeps the events that satisfy `keep`.
    pub fn start_keeping(endpoint: &str, options: &[&str], keep: fn(&Value) -> bool) -> Watch {
        Watch::run(flagred(), endpoint, options, keep)
    }

    /// Starts a watch with a command, to which the endpoint and the options are added as arguments.
    pub fn of(command: Command, endpoint: &str, options: &[&str]) -> Watch {
        Watch::run(command, endpoint, options, |_| true)
    }

    fn run(
        mut command: Command,
        endpoint: &str,
        options: &[&str],
        keep: fn(&Value) -> bool,
    ) -> Watch {
        let child = command
            .args(["watch", endpoint, "--jsonl"])
            .args(options)
            .stdout(Stdio::piped())
            .spawn();
        let mut child = ChildProcess(child.unwrap());
        let mut lines = BufReader::new(child.0.stdout.take().unwrap());
        let mut first = String::new();
        lines.read_line(&mut first).unwrap();
        let started: Value = serde_json::from_str(&first).unwrap();
        assert_eq!(started["schema"], "flagred.watch/1");
        let endpoint = started["endpoint"].as_str().unwrap();
        let address = endpoint.strip_prefix("listening at ");
        let address = address.map(|address| address.parse().unwrap());
        let progress = Arc::new(Progress::default());
        let made = Arc::clone(&progress);
        Watch {
            child,
            address,
            reader: std::thread::spawn(move || {
                let events = lines.lines().map(|line| {
                    let event: Value = serde_json::from_str(&line.unwrap()).unwrap();
                    match event["event"].as_str() {
                        Some("ready") => made.is_ready.store(true, Ordering::Release),
                        Some("another_vehicle") => {
                            let system = event["system"].as_u64().unwrap_or(0);
                            made.other_system.store(system, Ordering::Release);
                        }
                        _ => {}
                    }
                    if let Some(t_s) = event["t_s"].as_f64() {
                        let t_ms = (t_s * 1e3).round() as u64;
                        made.followed_ms.store(t_ms, Ordering::Release);
                    }
                    event
                });
                std::iter::once(started)
                    .chain(events)
                    .filter(keep)
                    .collect()
            }),
            progress,
        }
    }

    pub fn udp(options: &[&str]) -> Watch {
        Watch::start("udpin:127.0.0.1:0", options)
    }

    pub fn address(&self) -> SocketAddr {
        self.address.unwrap()
    }

    /// The resident memory of the watch, in kB.
    pub fn resident_kb(&self) -> u64 {
        let status =
            std::fs::read_to_string(format!("/proc/{}/status", self.child.0.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:"));
        let kb = line.unwrap().split_whitespace().nth(1).unwrap();
        kb.parse().unwrap()
    }

    /// Creates a vehicle that sends datagrams to the watch.
    pub fn vehicle(&self, flight: &Flight, link: Link) -> StandIn {
        self.vehicle_on(flight, Wire::udp(self.address()), link, Version::V2)
    }

    /// Creates a vehicle on a wire to the watch.
    pub fn vehicle_on(&self, flight: &Flight, wire: Wire, link: Link, version: Version) -> StandIn {
        let mut vehicle = StandIn::new(flight, wire, link, version);
        vehicle.progress = Some(Arc::clone(&self.progress));
        vehicle
    }

    /// Interrupts the watch and returns its output.
    pub fn end(mut self) -> WatchOutput {
        // Uses the `kill` that is built into the shell, because not every machine has a program of that name.
        let interrupted = Command::new("sh")
            .args(["-c", &format!("kill -INT {}", self.child.0.id())])
            .status();
        assert!(interrupted.unwrap().success());
        let events = self.reader.join().unwrap();
        let code = self.child.0.wait().unwrap().code();
        WatchOutput { events, code }
    }
}

pub struct WatchOutput {
    /// The events that the watch printed.
    pub events: Vec<Value>,
    /// The exit code.
    pub code: Option<i32>,
}

impl WatchOutput {
    pub fn all<'a>(&'a self, kind: &'a str) -> impl Iterator<Item = &'a Value> {
        self.events
            .iter()
            .filter(move |event| event["event"] == kind)
    }

    pub fn one(&self, kind: &str) -> &Value {
        let is_of = |event: &&Value| event["event"] == kind;
        let all: Vec<&Value> = self.events.iter().filter(is_of).collect();
        assert_eq!(all.len(), 1, "`{kind}` in {:?}", self.events);
        all[0]
    }

    /// The worst verdict of the flights; `NA` only if no flight has another verdict.
    pub fn verdict(&self) -> String {
        let order = ["NA", "GOOD", "WARN", "FAIL"];
        let is_end = |event: &&Value| {
            let kind = event["event"].as_str().unwrap();
            ["landed", "lost_in_air", "left_in_air"].contains(&kind)
        };
        let verdicts = self.events.iter().filter(is_end);
        let verdicts = verdicts.map(|event| event["verdict"].as_str().unwrap());
        let worst = verdicts.max_by_key(|verdict| order.iter().position(|known| known == verdict));
        worst.unwrap_or("none").to_owned()
    }

    pub fn has_note(&self, part: &str) -> bool {
        self.all("note")
            .any(|event| event["text"].as_str().unwrap().contains(part))
    }
}

pub fn assess(log: &Path) -> Value {
    let output = flagred()
        .args(["assess", "--json", "--step", "0"])
        .arg(log)
        .output()
        .unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Replays a log over UDP; returns the output of the watch and the messages to the vehicle.
pub fn fly_udp(
    flight: &Flight,
    link: Link,
    options: &[&str],
    speed: Speed,
) -> (WatchOutput, StandIn) {
    let watch = Watch::udp(options);
    let mut vehicle = watch.vehicle(flight, link);
    vehicle.meet();
    vehicle.fly(flight, speed, 0.0, f64::INFINITY);
    (watch.end(), vehicle)
}

/// The share of samples with a reported risk, and the largest difference from the results of `assess`.
pub fn compare(output: &WatchOutput, assessed: &Value) -> (f64, f64) {
    let steps = assessed["steps"].as_array().unwrap();
    let mut watched = output
        .all("risk")
        .filter_map(|event| Some((event["t_s"].as_f64()?, event["risk"].as_f64()?)));
    let (mut matched, mut known, mut largest) = (0, 0, 0.0_f64);
    let mut next = watched.next();
    for step in steps {
        let (Some(t_s), Some(risk)) = (step["t_s"].as_f64(), step["risk"].as_f64()) else {
            continue;
        };
        known += 1;
        while next.is_some_and(|(at_s, _)| at_s < t_s - 1e-4) {
            next = watched.next();
        }
        if let Some((at_s, watched_risk)) = next
            && (at_s - t_s).abs() < 1e-4
        {
            matched += 1;
            largest = largest.max((watched_risk - risk).abs());
        }
    }
    (f64::from(matched) / f64::from(known), largest)
}

/// Checks that there is one text for each change of state, none on the ground, and all in the form that ground stations require.
pub fn check_texts(output: &WatchOutput, received: &Inbox) {
    let texts = received.texts();
    let levels: Vec<(String, u8)> = output
        .all("level")
        .map(|event| {
            let severity = match event["level"].as_str() {
                Some("GOOD") => 6,
                // `None`: the risk is unknown, and an alarm was raised before.
                Some("WARN") | None => 4,
                _ => 2,
            };
            (event["text"].as_str().unwrap().to_owned(), severity)
        })
        .collect();
    assert_eq!(texts.len(), levels.len(), "{texts:?} {levels:?}");
    for ((severity, text), (level, expected)) in texts.iter().zip(&levels) {
        assert_eq!((text, severity), (level, expected));
        assert!(text.starts_with("FLAGRED: ") && text.len() <= 50, "{text}");
    }
}

pub fn refused(endpoint: &str, options: &[&str]) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = flagred()
        .args(["watch", endpoint])
        .args(options)
        .output()
        .unwrap();
    (status.code(), String::from_utf8(stderr).unwrap())
}
