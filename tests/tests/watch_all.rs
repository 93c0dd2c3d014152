//! `flagred watch --all`: hundreds of vehicles on several links.

use std::{
    collections::HashMap,
    io::{BufRead, BufReader},
    net::UdpSocket,
    process::{Command, Stdio},
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use flagred_flightlog::mavlink::{
    Sender, Version,
    dialect::{MavMessage, MavType},
};
use flagred_tests::{
    flagred,
    schema::{errors, schema},
    vehicle::{heartbeat, servo},
};
use serde_json::Value;

/// The number of sockets that vehicles send from.
const SOCKETS: usize = 10;
/// The number of vehicles per socket. The system numbers are the same on all sockets.
const SYSTEMS: usize = 50;
const VEHICLES: usize = SOCKETS * SYSTEMS;
/// Motor commands per second of each vehicle.
const RATE_HZ: u32 = 10;
/// The number of groups of vehicles; the groups send one after the other within the interval of the commands.
const PARTS: usize = 10;
/// The vehicle whose motors are at their limits in the second half.
const TROUBLED: usize = 123;
/// The vehicle that is silent in the second half.
const SILENT: usize = 321;

/// The moment at which each command was sent. The keys are the vehicle and its clock in ms.
type SendTimes = Arc<Mutex<HashMap<(usize, u32), Instant>>>;

/// All lines of the watch, the delay of each risk, and resource figures.
struct WatchResults {
    lines: Vec<Value>,
    late_ms: Vec<f64>,
    resident_kb: u64,
    cpu_share: f64,
    code: Option<i32>,
}

fn pulses(vehicle: usize, tick: u32, is_second_half: bool) -> [u16; 4] {
    let wiggle = (tick % 5) as u16;
    match vehicle == TROUBLED && is_second_half {
        true => [1000, 2000, 1000, 2000],
        false => [1500 + wiggle, 1500, 1500 - wiggle, 1500],
    }
}

fn outputs([a, b, c, d]: [u16; 4]) -> [u16; 16] {
    [a, b, c, d, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
}

fn fly(seconds: u32) -> WatchResults {
    let mut child = flagred()
        .args([
            "watch",
            "--all",
            "udpin:127.0.0.1:0",
            "udpin:127.0.0.1:0",
            "--jsonl",
        ])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut first = String::new();
    lines.read_line(&mut first).unwrap();
    let first: Value = serde_json::from_str(&first).unwrap();
    assert_eq!(errors(&schema("watch-all"), &first), [""; 0]);
    let address = |link: usize| {
        let text = first["endpoints"][link].as_str().unwrap();
        text.strip_prefix("listening at ").unwrap().to_owned()
    };
    let addresses = [address(0), address(1)];
    let sockets: Vec<UdpSocket> = (0..SOCKETS)
        .map(|_| UdpSocket::bind("127.0.0.1:0").unwrap())
        .collect();
    let names: HashMap<String, usize> = (0..VEHICLES)
        .map(|vehicle| (name(&sockets, vehicle), vehicle))
        .collect();
    let sent = SendTimes::default();
    let reader = {
        let sent = Arc::clone(&sent);
        std::thread::spawn(move || {
            let mut late_ms = Vec::new();
            let mut kept = Vec::new();
            for line in lines.lines() {
                let line: Value = serde_json::from_str(&line.unwrap()).unwrap();
                let now = Instant::now();
                if line["watch"]["event"] == "risk" {
                    let vehicle = names[line["vehicle"].as_str().unwrap()];
                    let t_ms = (line["watch"]["t_s"].as_f64().unwrap() * 1e3).round() as u32;
                    let at = sent.lock().unwrap().remove(&(vehicle, t_ms));
                    late_ms.extend(at.map(|at| (now - at).as_secs_f64() * 1e3));
                }
                // Risks are not kept, because ten minutes produce millions of such lines.
                if line["watch"]["event"] != "risk"
                    || line["vehicle"].as_str().unwrap().starts_with("7@")
                {
                    kept.push(line);
                }
            }
            (kept, late_ms)
        })
    };

    let mut senders: Vec<Sender> = (0..VEHICLES).map(|_| Sender::new(1)).collect();
    let mut send = |vehicle: usize, message: &MavMessage| {
        let socket = vehicle / SYSTEMS;
        let system = (vehicle % SYSTEMS + 1) as u8;
        let packet = senders[vehicle].packet(Version::V2, system, message);
        let to = &addresses[socket % addresses.len()];
        sockets[socket].send_to(&packet, to).unwrap();
    };
    let start = Instant::now();
    let period = Duration::from_secs(1) / RATE_HZ;
    let cpu_before = cpu_s(child.id());
    for tick in 0..seconds * RATE_HZ {
        let is_second_half = tick >= seconds * RATE_HZ / 2;
        for part in 0..PARTS {
            let due = period * tick + period / PARTS as u32 * part as u32;
            std::thread::sleep(due.saturating_sub(start.elapsed()));
            for vehicle in (part..VEHICLES).step_by(PARTS) {
                if vehicle == SILENT && is_second_half {
                    continue;
                }
                if tick % RATE_HZ == 0 {
                    send(vehicle, &heartbeat(MavType::MAV_TYPE_QUADROTOR, true, true));
                }
                let t_ms = 100_000 + 1000 / RATE_HZ * tick;
                sent.lock().unwrap().insert((vehicle, t_ms), Instant::now());
                let pulses = pulses(vehicle, tick, is_second_half);
                send(vehicle, &servo(t_ms * 1000, &outputs(pulses)));
            }
        }
    }
    let cpu_share = (cpu_s(child.id()) - cpu_before) / start.elapsed().as_secs_f64();
    let resident_kb = resident_kb(child.id());
    for vehicle in (0..VEHICLES).filter(|vehicle| *vehicle != SILENT) {
        send(
            vehicle,
            &heartbeat(MavType::MAV_TYPE_QUADROTOR, false, false),
        );
        let pulses = [1000; 4];
        send(
            vehicle,
            &servo((100_000 + 1000 * seconds) * 1000, &outputs(pulses)),
        );
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_millis(500));
    let interrupted = Command::new("sh")
        .args(["-c", &format!("kill -INT {}", child.id())])
        .status();
    assert!(interrupted.unwrap().success());
    let (lines, mut late_ms) = reader.join().unwrap();
    late_ms.sort_by(f64::total_cmp);
    WatchResults {
        lines,
        late_ms,
        resident_kb,
        cpu_share,
        code: child.wait().unwrap().code(),
    }
}

fn name(sockets: &[UdpSocket], vehicle: usize) -> String {
    let address = sockets[vehicle / SYSTEMS].local_addr().unwrap();
    format!("{}@{address}", vehicle % SYSTEMS + 1)
}

/// Memory in kB; 0 if the system does not report it.
fn resident_kb(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmRSS:"));
    line.map_or(0, |line| {
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    })
}

/// Seconds of processor time; 0 if the system does not report it.
fn cpu_s(process: u32) -> f64 {
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
    let fields = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace();
    let ticks = fields
        .skip(11)
        .take(2)
        .filter_map(|field| field.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}

/// Verifies the results, and returns the sum over all vehicles of the share of lost packets. On a busy machine, the
/// system drops some packets.
fn check(results: &WatchResults, seconds: u32) -> f64 {
    let summaries: Vec<&Value> = (results.lines.iter())
        .filter(|line| line["verdict"].is_string())
        .collect();
    assert_eq!(summaries.len(), VEHICLES);
    let of = |verdict: &str| {
        summaries
            .iter()
            .filter(|line| line["verdict"] == verdict)
            .count()
    };
    assert_eq!((of("GOOD"), of("NA")), (VEHICLES - 2, 1));
    // The vehicle in most danger comes first, and only one is in danger.
    assert!(
        summaries[0]["verdict"] == "FAIL" || summaries[0]["verdict"] == "WARN",
        "{}",
        summaries[0]
    );
    let systems = (TROUBLED % SYSTEMS + 1, SILENT % SYSTEMS + 1);
    assert!(
        summaries[0]["vehicle"]
            .as_str()
            .unwrap()
            .starts_with(&format!("{}@", systems.0))
    );
    let silent = summaries
        .iter()
        .find(|line| line["verdict"] == "NA")
        .unwrap();
    assert!(
        silent["vehicle"]
            .as_str()
            .unwrap()
            .starts_with(&format!("{}@", systems.1))
    );
    assert_eq!(silent["reason"], "the vehicle was lost in the air");
    assert!(summaries.iter().all(|line| line["risk_max"].is_number()));
    let share = |line: &&Value| line["lost_share"].as_f64().unwrap();
    let lost: f64 = summaries.iter().map(share).sum();
    let last = results.lines.last().unwrap();
    assert_eq!(
        (&last["vehicles"], &last["dropped_lines"]),
        (&VEHICLES.into(), &0.into())
    );
    assert_eq!(results.code, Some(1));
    // A risk line for each command, except in the first five seconds: in the first two, the risk is unknown.
    let expected = (seconds - 5) as usize * RATE_HZ as usize * VEHICLES;
    assert!(
        results.late_ms.len() > expected,
        "{} of {expected}",
        results.late_ms.len()
    );
    let at = |share: f64| results.late_ms[(results.late_ms.len() as f64 * share) as usize];
    println!(
        "lost {lost}; {VEHICLES} vehicles at {RATE_HZ} Hz for {seconds} s: {:.0} % of a core, {} kB, {} lines; from packet to line median {:.1} ms, 99 % {:.1} ms",
        100.0 * results.cpu_share,
        results.resident_kb,
        results.late_ms.len(),
        at(0.5),
        at(0.99)
    );
    lost
}

#[test]
fn five_hundred_vehicles_are_followed_and_the_one_in_trouble_is_listed_first() {
    let results = fly(16);
    check(&results, 16);
    let (of_all, of_one) = (schema("watch-all"), schema("watch"));
    for line in &results.lines {
        assert_eq!(errors(&of_all, line), [""; 0], "{line}");
        if line["watch"].is_object() {
            assert_eq!(errors(&of_one, &line["watch"]), [""; 0], "{line}");
        }
    }
    assert!(results.resident_kb < 300_000, "{} kB", results.resident_kb);
}

/// The limits apply to an otherwise idle machine.
#[test]
#[ignore = "ten minutes on a machine that does nothing else"]
fn five_hundred_vehicles_for_ten_minutes() {
    let results = fly(600);
    assert_eq!(check(&results, 600), 0.0, "packets were lost");
    let late_ms = results.late_ms[results.late_ms.len() * 99 / 100];
    assert!(late_ms < 50.0 && results.cpu_share < 1.0, "{late_ms} ms");
}

#[test]
fn several_endpoints_require_the_option_all_and_send_nothing() {
    for (arguments, said) in [
        (
            &["udpin:127.0.0.1:0", "udpin:127.0.0.1:0"][..],
            "is a second endpoint",
        ),
        (
            &["--all", "udpout:127.0.0.1:9"][..],
            "which `--all` rules out",
        ),
        (&[][..], "ENDPOINT"),
    ] {
        let output = flagred().arg("watch").args(arguments).output().unwrap();
        let reported = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{reported}");
        assert!(reported.contains(said), "{reported}");
    }
}
