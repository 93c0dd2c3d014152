//! `flagred watch`: the risk of a flight in progress.

mod all;
mod endpoint;
mod fleet;
pub(crate) mod jsonl;
pub(crate) mod lines;
mod messages;
mod port;
mod printer;
pub(crate) mod screen;
pub(crate) mod session;
mod tlog;

use std::{
    fs::File,
    io::{self, IsTerminal, Read},
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use flagred::{estimator::Estimator, flight::Verdict};
use flagred_flightlog::{
    Format, known_signals,
    mavlink::{Key, Sender, SkipCounts, Stream},
};

use crate::{
    assess::{FailOn, exit_of},
    failure::{Exit, Failure},
    numbers::whole,
    profile,
    range::RangeArgument,
};
use endpoint::Endpoint;
use jsonl::EventLine;
pub(crate) use jsonl::{FleetLine, Line};
use port::{Port, PortEvent};
use printer::Printer;
use screen::Screen;
use session::{Event, Session, SessionOutput, UntrustedCounts};

/// The default component id: the first one reserved for onboard computers.
const COMPONENT: u8 = 191;
const KEY_HELP: &str = "`--key` names a file with the key: 32 bytes, or 64 hexadecimal digits";
/// Maximum number of bytes read of a key file: digits and some white space.
const KEY_FILE: u64 = 256;
/// The largest possible datagram.
const DATAGRAM: usize = 65_536;
/// The interval between screen frames.
const FRAME: Duration = Duration::from_millis(100);
/// The maximum number of screen frames queued for the terminal.
const FRAMES: usize = 2;
/// Maximum number of queued output lines: half an hour of the vehicle's samples.
const LINES: usize = 50_000;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Address of a vehicle: udpin:0.0.0.0:14550, udpout:HOST:PORT, tcp:HOST:PORT, tcpin:0.0.0.0:PORT or /dev/ttyACM0:57600
    #[arg(value_name = "ENDPOINT", required = true)]
    endpoints: Vec<Endpoint>,

    /// Follow every vehicle that is received on these endpoints, one line each; nothing is sent
    #[arg(long, conflicts_with_all = ["record", "send_anyway", "component", "range"])]
    all: bool,

    /// Profile (inputs, rule set, thresholds): `flagred`, `flagred-paper`, `flagred-battery`, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = profile::DEFAULT)]
    profile: String,

    #[command(flatten)]
    range: RangeArgument,

    /// Print one JSON object per line instead of text
    #[arg(long)]
    jsonl: bool,

    /// Accept only packets signed with the key in this file (32 bytes or 64 hexadecimal digits), and sign sent ones
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,

    /// Only listen: send neither requests nor warnings
    #[arg(long)]
    no_send: bool,

    /// Send warnings even if another `flagred watch` sends them
    #[arg(long, conflicts_with = "no_send")]
    send_anyway: bool,

    /// End at once if the endpoint does not open, instead of trying again every second
    #[arg(long)]
    no_wait: bool,

    /// The MAVLink component id to send as
    #[arg(long, value_name = "NUMBER", default_value_t = COMPONENT, value_parser = whole(2, u8::MAX))]
    component: u8,

    /// Record received packets to this telemetry log, which must not exist yet
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

/// Returns the first input that cannot be computed live, and the reason: a signal that no MAVLink message contains, if
/// the input has no `if_missing`.
fn not_live(estimator: &Estimator) -> Option<(&str, &str)> {
    let known = known_signals();
    let is_live = |signal: &str| {
        let mut known = known.iter().filter(|known| known.name == signal);
        known.any(|known| known.formats.contains(&Format::Tlog))
    };
    let inputs = estimator.profile().inputs.iter();
    let needed = inputs.filter(|input| input.if_missing.is_none());
    let mut signals = needed.flat_map(|input| {
        let carried = input.source.signal.carried();
        carried.map(|signal| (input.name.as_str(), signal))
    });
    signals.find(|(_, signal)| !is_live(signal))
}

/// Watches until interrupted.
pub(crate) fn run(arguments: &Arguments) -> Result<Exit, Failure> {
    let estimator = profile::load(&arguments.profile)?.estimator;
    if let Some((input, signal)) = not_live(&estimator) {
        return Err(Failure::usage(format!(
            "profile `{}` needs the signal `{signal}`, which is not in MAVLink messages",
            arguments.profile
        ))
        .help(format!(
            "give input `{input}` a value with `if_missing`, or use a signal of tlogs: docs/profiles.md#signals-of-logs"
        )));
    }
    let (endpoint, others) = match arguments.endpoints.split_first() {
        Some(split) => split,
        None => return Err(Failure::usage("no endpoint is given")),
    };
    if let (Some(other), false) = (others.first(), arguments.all) {
        return Err(Failure::usage(format!("`{other}` is a second endpoint"))
            .help("`--all` follows the vehicles of several endpoints"));
    }
    let range = arguments.range.given()?;
    let silent = match (arguments.no_send, arguments.all) {
        (_, true) => Some("--all"),
        (true, _) => Some("--no-send"),
        _ => None,
    };
    let sends_first = |endpoint: &Endpoint| matches!(endpoint, Endpoint::UdpOut(_));
    if let Some(option) = silent
        && arguments.endpoints.iter().any(sends_first)
    {
        return Err(Failure::usage(format!(
            "`udpout:` sends first and waits for answers, which `{option}` rules out",
        ))
        .help("have the packets sent here, and listen with `udpin:`"));
    }
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed)).map_err(|error| {
        Failure::unreadable(format!("cannot set the handler for Ctrl-C: {error}"))
    })?;
    let key = arguments.key.as_deref().map(read_key).transpose()?;
    if arguments.all {
        let how = (arguments.jsonl, !arguments.no_wait);
        return all::run(&arguments.endpoints, how, key.as_ref(), &estimator, &stop);
    }
    let mut port = Port::open(endpoint, !arguments.no_wait)?;
    let mut recording = match &arguments.record {
        Some(path) => Some(tlog::Recording::create(path)?),
        None => None,
    };
    let sender = (!arguments.no_send).then(|| {
        let sender = Sender::new(arguments.component);
        match &key {
            Some(key) => sender.signed(key.clone()),
            None => sender,
        }
    });
    let mut session = Session::new(&estimator, sender, arguments.send_anyway).with_range(range);
    let title = match port.listens_at() {
        Some(address) if matches!(endpoint, Endpoint::UdpIn(_) | Endpoint::TcpIn(_)) => {
            format!("listening at {address}")
        }
        _ => endpoint.to_string(),
    };
    let mut display = Display::new(arguments.jsonl, &title, &estimator)?;
    let mut stream = key.map_or_else(Stream::new, Stream::with_key);
    let mut buffer = vec![0; DATAGRAM];
    let mut out = SessionOutput::default();
    let start = Instant::now();
    // If nobody reads the output, the watch continues as long as it sends warnings or records packets.
    let is_needed = !arguments.no_send || arguments.record.is_some();
    while !stop.load(Ordering::Relaxed) && (is_needed || !display.printer.is_closed()) {
        let received = port.receive(&mut buffer);
        let is_datagram = matches!(received, PortEvent::Datagram(_));
        let now_s = start.elapsed().as_secs_f64();
        match received {
            PortEvent::Bytes(count) | PortEvent::Datagram(count) => {
                stream.push(buffer.get(..count).unwrap_or_default());
            }
            PortEvent::Nothing => {}
            PortEvent::Waiting(why) => {
                let text = format!(
                    "`{endpoint}` cannot be opened yet: {why}; trying again every second (with `--no-wait`, `watch` ends instead)"
                );
                out.events.push(Event::Note { text });
            }
            PortEvent::Opened => {
                stream.end();
                let text = "the link is open".to_owned();
                out.events.push(Event::Note { text });
            }
            PortEvent::Closed(why) => {
                session.closed();
                let text = format!("the link is closed: {why}; waiting for it to open again");
                out.events.push(Event::Note { text });
            }
        }
        while let Some(packet) = stream.packet() {
            let is_vehicles = session.receive(now_s, port.source(), &packet, &mut out);
            if is_vehicles {
                port.answer();
            }
            // A telemetry log contains no addresses, so its reader would attribute packets of other senders to the vehicle.
            if is_vehicles || !session.is_doubtful(&packet) {
                let recorded = recording.as_mut().map_or(Ok(()), |r| r.add(packet.bytes));
                let failed = recorded.err().map(|text| Event::Note { text });
                out.events.extend(failed);
            }
            // Packets are sent at once, so that they do not wait for the display.
            out.packets.drain(..).for_each(|packet| port.send(&packet));
            display.show(now_s, &mut out.events, &session, &estimator)?;
        }
        if is_datagram {
            stream.end();
        }
        session.tick(now_s, &mut out);
        out.packets.drain(..).for_each(|packet| port.send(&packet));
        display.skipped(stream.skipped(), &mut out.events);
        let recorded = recording.as_mut().map_or(Ok(()), tlog::Recording::flush);
        let failed = recorded.err().map(|text| Event::Note { text });
        out.events.extend(failed);
        display.show(now_s, &mut out.events, &session, &estimator)?;
        display.refresh(&session, &estimator);
    }
    let worst = session.finish(&mut out);
    let now_s = start.elapsed().as_secs_f64();
    display.show(now_s, &mut out.events, &session, &estimator)?;
    let totals = Totals {
        skipped: stream.skipped(),
        doubts: session.doubts(),
        unsent: port.unsent(),
    };
    display.end(now_s, &worst, &totals)?;
    Ok(exit_of(&worst, FailOn::Warn))
}

/// Reads the key of MAVLink signatures from a file.
fn read_key(path: &Path) -> Result<Key, Failure> {
    let name = path.display();
    // A key is short, so reading is limited in case the file is not a key.
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(KEY_FILE).read_to_end(&mut bytes))
        .map_err(|error| {
            Failure::unreadable(format!("`{name}` cannot be read: {error}")).help(KEY_HELP)
        })?;
    Key::from_bytes(&bytes)
        .ok_or_else(|| Failure::unreadable(format!("`{name}` is not a key")).help(KEY_HELP))
}

/// Counts of packets that were skipped, doubted or not sent.
struct Totals {
    skipped: SkipCounts,
    doubts: UntrustedCounts,
    unsent: u64,
}

impl Totals {
    fn words(&self) -> String {
        let mut text = format!(
            "{} bytes skipped, {} bad checksums, {} unknown messages, {} signed packets ignored, {} packets not sent",
            self.skipped.bytes,
            self.skipped.checksums,
            self.skipped.unknown,
            self.skipped.signed,
            self.unsent
        );
        if self.skipped.unsigned + self.skipped.bad_signatures > 0 {
            text += &format!(
                ", {} unsigned packets and {} with a wrong signature refused",
                self.skipped.unsigned, self.skipped.bad_signatures
            );
        }
        let doubts = self.doubts;
        if doubts != UntrustedCounts::default() {
            text += &format!(
                "; ignored: {} packets of a second sender, {} parameters of other components, {} jumps of the clock",
                doubts.second_sender, doubts.other_component, doubts.clock_jumps
            );
        }
        text
    }
}

/// Prints events in the chosen form.
struct Display {
    form: DisplayForm,
    printer: Printer,
    reported: SkipCounts,
    drawn: Option<Instant>,
}

enum DisplayForm {
    Json,
    Words(lines::Words),
    Screen(Screen),
}

impl Display {
    fn new(jsonl: bool, title: &str, estimator: &Estimator) -> Result<Display, Failure> {
        let profile = &estimator.profile().name;
        let is_screen = !jsonl && io::stdout().is_terminal();
        let mut printer = Printer::new(if is_screen { FRAMES } else { LINES });
        let form = if jsonl {
            let started = Line::new(0.0, EventLine::started(title, profile));
            printer.print(jsonl::text(&started)?);
            DisplayForm::Json
        } else if is_screen {
            let title = format!("{title}, profile {profile}");
            printer.print(screen::ENTER.to_owned());
            DisplayForm::Screen(Screen::new(title))
        } else {
            printer.print(lines::words(0.0, &format!("{title}, profile {profile}")));
            DisplayForm::Words(lines::Words::default())
        };
        Ok(Display {
            form,
            printer,
            reported: SkipCounts::default(),
            drawn: None,
        })
    }

    /// Prints the events, and clears the list.
    fn show(
        &mut self,
        at_s: f64,
        events: &mut Vec<Event>,
        session: &Session<'_>,
        estimator: &Estimator,
    ) -> Result<(), Failure> {
        for event in events.drain(..) {
            let line = match &mut self.form {
                DisplayForm::Json => {
                    let line = jsonl::line(at_s, &event, session, estimator);
                    line.map(|line| jsonl::text(&line)).transpose()?
                }
                DisplayForm::Words(words) => words.line(at_s, &event, session, estimator),
                DisplayForm::Screen(screen) => {
                    screen.add(at_s, &event, session, estimator);
                    None
                }
            };
            if let Some(line) = line {
                self.printer.print(line);
            }
        }
        Ok(())
    }

    /// Adds a note the first time that packets of a kind are skipped. The counts are reported at the end.
    fn skipped(&mut self, now: SkipCounts, events: &mut Vec<Event>) {
        let reported = std::mem::replace(&mut self.reported, now);
        let kinds = [
            (
                reported.signed,
                now.signed,
                "signed packets are ignored: they cannot be verified without the key (`--key`)",
            ),
            (
                reported.unsigned,
                now.unsigned,
                "packets that are not signed are refused",
            ),
            (
                reported.bad_signatures,
                now.bad_signatures,
                "packets with a wrong or an already used signature are refused",
            ),
            (
                reported.unknown,
                now.unknown,
                "some messages are unknown: they are recorded, but not evaluated",
            ),
            (
                reported.bytes,
                now.bytes,
                "some bytes are not MAVLink packets: they are skipped",
            ),
        ];
        for (before, after, text) in kinds {
            if before == 0 && after > 0 {
                let text = text.to_owned();
                events.push(Event::Note { text });
            }
        }
    }

    fn refresh(&mut self, session: &Session<'_>, estimator: &Estimator) {
        if let DisplayForm::Screen(screen) = &self.form
            && self.drawn.is_none_or(|drawn| drawn.elapsed() >= FRAME)
        {
            self.drawn = Some(Instant::now());
            let frame = screen.frame(session.view().as_ref(), estimator, screen::size());
            self.printer.print(frame);
        }
    }

    fn end(mut self, at_s: f64, worst: &Verdict, totals: &Totals) -> Result<(), Failure> {
        let last = if let DisplayForm::Json = self.form {
            let ended = EventLine::Ended {
                worst: worst.into(),
                reason: lines::reason(worst),
                skipped_bytes: totals.skipped.bytes,
                bad_checksums: totals.skipped.checksums,
                unknown_messages: totals.skipped.unknown,
                signed: totals.skipped.signed,
                unsigned: totals.skipped.unsigned,
                bad_signatures: totals.skipped.bad_signatures,
                not_believed: totals.doubts,
                unsent: totals.unsent,
                dropped_lines: self.printer.dropped(),
            };
            jsonl::text(&Line::new(at_s, ended))?
        } else {
            let why = lines::reason(worst).map_or(String::new(), |reason| format!(": {reason}"));
            lines::words(at_s, &format!("{worst} at worst{why}; {}", totals.words()))
        };
        self.leave();
        self.printer.print(last);
        Ok(())
    }

    /// Leaves the screen before the final line, which must remain visible.
    fn leave(&mut self) {
        if let DisplayForm::Screen(_) = self.form {
            // Queued frames are printed first.
            std::thread::sleep(FRAME);
            self.printer.print(screen::LEAVE.to_owned());
            self.form = DisplayForm::Words(lines::Words::default());
        }
    }
}

/// Restores the terminal, however the watch ends.
impl Drop for Display {
    fn drop(&mut self) {
        self.leave();
    }
}
