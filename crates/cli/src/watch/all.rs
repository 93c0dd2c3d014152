//! `flagred watch --all`: follows every vehicle on one or several links, one line each. It only
//! receives.

use std::{
    io::{self, IsTerminal},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

use flagred::{estimator::Estimator, flight::Verdict};
use flagred_flightlog::mavlink::{Key, PacketScan, Stream, next_packet};
use flagred_report::words::level_style;
use fuzzy::drawing::visible;

use super::{
    DATAGRAM, FRAMES, LINES,
    endpoint::Endpoint,
    fleet::{Fleet, Summary, VehicleId, worst},
    jsonl::{self, FleetLine},
    lines,
    port::{Port, PortEvent},
    printer::Printer,
    screen,
    session::{Event, Session, Source, VehicleView},
};
use crate::{
    assess::{FailOn, exit_of},
    failure::{Exit, Failure},
};

/// The interval at which all vehicles are updated.
const TICK: Duration = Duration::from_millis(50);
/// The interval at which the screen is drawn.
const FRAME: Duration = Duration::from_millis(500);
/// Maximum number of packets queued for evaluation. When the queue is full, no more packets are read from the links.
const PACKETS: usize = 20_000;

/// A packet or a message from a link.
enum LinkItem {
    Packet(Source, Vec<u8>),
    Note(String),
}

/// The form of the output.
#[derive(Clone, Copy, PartialEq, Eq)]
enum OutputForm {
    Json,
    Words,
    Screen,
}

/// Watches until interrupted.
pub(super) fn run(
    endpoints: &[Endpoint],
    (jsonl, waits): (bool, bool),
    key: Option<&Key>,
    estimator: &Estimator,
    stop: &Arc<AtomicBool>,
) -> Result<Exit, Failure> {
    let form = match (jsonl, io::stdout().is_terminal()) {
        (true, _) => OutputForm::Json,
        (false, false) => OutputForm::Words,
        (false, true) => OutputForm::Screen,
    };
    let (sender, receiver) = sync_channel(PACKETS);
    let (mut names, mut small) = (Vec::new(), Vec::new());
    for (link, endpoint) in endpoints.iter().enumerate() {
        let port = Port::open(endpoint, waits)?;
        let name =
            (port.listens_at()).map_or(endpoint.to_string(), |at| format!("listening at {at}"));
        names.push(name);
        small.extend(port.small_buffer().map(|bytes| {
            format!(
                "`{endpoint}`: the receive buffer of the system is {} kB, too small for hundreds of vehicles: run `sysctl -w net.core.rmem_max=4194304` as root (Linux), then start again",
                bytes / 1024
            )
        }));
        let stream = key.map_or_else(Stream::new, |key| Stream::with_key(key.clone()));
        let (sender, stop, name) = (sender.clone(), Arc::clone(stop), endpoint.to_string());
        thread::spawn(move || listen(link, &name, port, stream, &sender, &stop));
    }
    drop(sender);
    let printer = Printer::new(if form == OutputForm::Screen {
        FRAMES
    } else {
        LINES
    });
    let mut shown = LiveOutput {
        form,
        printer,
        endpoints,
        estimator,
        note: String::new(),
    };
    shown.start(&names);
    for text in &small {
        shown.note(0.0, text);
    }
    let mut fleet = Fleet::new(estimator);
    let start = Instant::now();
    follow(&receiver, &mut fleet, &mut shown, start, stop);
    let now_s = start.elapsed().as_secs_f64();
    let all = fleet.finish(|id, event, session| shown.event(now_s, id, event, session));
    shown.end(now_s, &all, &fleet);
    Ok(exit_of(&worst(&all), FailOn::Warn))
}

/// Receives packets from a link, in a separate thread.
fn listen(
    link: usize,
    name: &str,
    mut port: Port,
    mut stream: Stream,
    sender: &SyncSender<(usize, LinkItem)>,
    stop: &AtomicBool,
) {
    let mut buffer = vec![0; DATAGRAM];
    while !stop.load(Ordering::Relaxed) {
        let note = match port.receive(&mut buffer) {
            PortEvent::Bytes(count) => {
                stream.push(buffer.get(..count).unwrap_or_default());
                None
            }
            PortEvent::Datagram(count) => {
                stream.end();
                stream.push(buffer.get(..count).unwrap_or_default());
                None
            }
            PortEvent::Nothing => None,
            PortEvent::Waiting(why) => Some(format!(
                "`{name}` cannot be opened yet: {why}; trying again every second"
            )),
            PortEvent::Opened => {
                stream.end();
                Some(format!("`{name}`: the link is open"))
            }
            PortEvent::Closed(why) => Some(format!("`{name}`: the link is closed: {why}")),
        };
        let source = port.source();
        let mut is_heard =
            note.is_none_or(|note| sender.send((link, LinkItem::Note(note))).is_ok());
        while let Some(packet) = stream.packet() {
            // Messages that cannot be verified are not used.
            if packet.sound == Some(true) {
                let received = LinkItem::Packet(source, packet.bytes.to_vec());
                is_heard &= sender.send((link, received)).is_ok();
            }
        }
        if !is_heard {
            return;
        }
    }
}

fn follow<'e>(
    receiver: &Receiver<(usize, LinkItem)>,
    fleet: &mut Fleet<'e>,
    shown: &mut LiveOutput<'e>,
    start: Instant,
    stop: &AtomicBool,
) {
    let (mut ticked, mut drawn) = (start, start);
    while !stop.load(Ordering::Relaxed) && !shown.printer.is_closed() {
        let received = receiver.recv_timeout(TICK);
        let now_s = start.elapsed().as_secs_f64();
        match received {
            Ok((link, LinkItem::Packet(source, bytes))) => {
                if let PacketScan::Packet(packet) = next_packet(&bytes) {
                    fleet.receive(now_s, (link, source), &packet, |id, event, session| {
                        shown.event(now_s, id, event, session);
                    });
                }
            }
            Ok((_, LinkItem::Note(text))) => shown.note(now_s, &text),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        if ticked.elapsed() >= TICK {
            ticked = Instant::now();
            fleet.tick(now_s, |id, event, session| {
                shown.event(now_s, id, event, session)
            });
        }
        if shown.form == OutputForm::Screen && drawn.elapsed() >= FRAME {
            drawn = Instant::now();
            let frame = shown.frame(fleet, screen::size());
            shown.printer.print(frame);
        }
    }
}

/// Prints events in the chosen form.
struct LiveOutput<'e> {
    form: OutputForm,
    printer: Printer,
    endpoints: &'e [Endpoint],
    estimator: &'e Estimator,
    /// The latest note, which the screen shows.
    note: String,
}

impl<'e> LiveOutput<'e> {
    fn start(&mut self, names: &[String]) {
        let profile = &self.estimator.profile().name;
        let text = match self.form {
            OutputForm::Json => {
                return self.json(&FleetLine::started(names, profile));
            }
            OutputForm::Words => {
                lines::words(0.0, &format!("{}, profile {profile}", names.join(", ")))
            }
            OutputForm::Screen => screen::ENTER.to_owned(),
        };
        self.printer.print(text);
    }

    /// The name of a vehicle: its system and its address.
    fn name(&self, id: VehicleId) -> String {
        let from = match id.source {
            Some(address) => address.to_string(),
            None => (self.endpoints.get(id.link)).map_or(String::new(), Endpoint::to_string),
        };
        format!("{}@{from}", id.system)
    }

    fn event(&mut self, now_s: f64, id: VehicleId, event: &Event, session: &Session<'e>) {
        let name = || self.name(id);
        let text = match self.form {
            OutputForm::Json => {
                if let Some(watch) = jsonl::line(now_s, event, session, self.estimator) {
                    let vehicle = name();
                    self.json(&FleetLine::Event { vehicle, watch });
                }
                return;
            }
            OutputForm::Words if !matches!(event, Event::Risk { .. }) => {
                let what = lines::describe(event, session, self.estimator);
                lines::words(now_s, &format!("{}: {what}", name()))
            }
            OutputForm::Words | OutputForm::Screen => return,
        };
        self.printer.print(text);
    }

    fn json(&mut self, line: &FleetLine<'_>) {
        if let Ok(text) = jsonl::text(line) {
            self.printer.print(text);
        }
    }

    fn note(&mut self, now_s: f64, text: &str) {
        match self.form {
            OutputForm::Json => {
                let at_s = jsonl::rounded(now_s);
                self.json(&FleetLine::Note { at_s, note: text });
            }
            OutputForm::Words => self.printer.print(lines::words(now_s, text)),
            OutputForm::Screen => text.clone_into(&mut self.note),
        }
    }

    /// The text of a screen of this size, in columns and rows.
    fn frame(&self, fleet: &Fleet<'e>, (columns, rows): (usize, usize)) -> String {
        let views = fleet.views();
        let in_air = views.iter().filter(|(_, view)| view.is_in_air).count();
        let head = format!(
            "FLAGRED  {} vehicles, {in_air} in the air; Ctrl-C quits",
            views.len()
        );
        let below = rows.saturating_sub(3);
        let shown = if views.len() > below {
            below.saturating_sub(1)
        } else {
            views.len()
        };
        let mut lines = vec![cut(&head, columns), cut(&visible(&self.note), columns)];
        let named = views.iter().take(shown);
        lines.extend(named.map(|(id, view)| self.row(*id, view, columns)));
        if shown < views.len() {
            lines.push(cut(&format!("and {} more", views.len() - shown), columns));
        }
        screen::text(&lines, rows)
    }

    fn row(&self, id: VehicleId, view: &VehicleView<'_>, columns: usize) -> String {
        let latest = view.latest;
        let state = match (view.link_lost, view.motors_lost, view.is_in_air) {
            (true, ..) => "LINK LOST",
            (_, true, _) => "no motor commands",
            (.., true) => "in the air",
            _ => "on the ground",
        };
        let known = latest.and_then(|latest| latest.risk.ok());
        let risk = known.map_or("risk unknown".to_owned(), |known| {
            format!("risk {:3.0} %", known.risk_pct)
        });
        let name = self.name(id);
        let rest = format!("  {risk:<12}  {:<30}  {state}", visible(&name));
        let Some(level) = latest.and_then(|latest| latest.level) else {
            return cut(&format!("    {rest}"), columns);
        };
        let (name, style) = (level.to_string(), level_style(level));
        let line = cut(&format!("{name:<4}{rest}"), columns);
        match line.strip_prefix(&name) {
            Some(rest) => format!("{style}{name}{style:#}{rest}"),
            None => line,
        }
    }

    /// Leaves the full screen, and prints a line for each vehicle.
    fn end(&mut self, now_s: f64, all: &[Summary], fleet: &Fleet<'_>) {
        // Text for people is printed as one piece, because the queue for a screen holds only two pieces.
        let mut text = String::new();
        if self.form == OutputForm::Screen {
            thread::sleep(TICK);
            text += screen::LEAVE;
            self.form = OutputForm::Words;
        }
        for one in all {
            let name = self.name(one.id);
            let verdict = one.verdict.to_string();
            let reason = lines::reason(&one.verdict);
            let help = match &one.verdict {
                Verdict::NotAvailable(reason) => reason.help(),
                Verdict::Known(_) => None,
            };
            match self.form {
                OutputForm::Json => {
                    self.json(&FleetLine::Summary {
                        vehicle: &name,
                        verdict: (&one.verdict).into(),
                        reason,
                        help,
                        risk_max: one.risk_max,
                        lost_share: one.lost_share,
                    });
                }
                _ => {
                    let most = one.risk_max.map_or("risk unknown".to_owned(), |most| {
                        format!("highest risk {most:.0} %")
                    });
                    let why = reason.map_or(String::new(), |reason| format!("; {reason}"));
                    let help = help.map_or(String::new(), |help| format!("\n     help: {help}"));
                    let name = visible(&name);
                    text += &format!("{verdict:<4} {name}: {most}{why}{help}\n");
                }
            }
        }
        let worst = worst(all);
        let (vehicles, dropped) = (all.len(), self.printer.dropped());
        match self.form {
            OutputForm::Json => {
                self.json(&FleetLine::Ended {
                    worst: (&worst).into(),
                    vehicles,
                    heartbeats_refused: fleet.refused,
                    vehicles_left_out: fleet.forgotten,
                    dropped_lines: dropped,
                });
            }
            _ => {
                let ended = format!("worst verdict {worst} of {vehicles} vehicles");
                self.printer.print(text + &lines::words(now_s, &ended));
            }
        }
    }
}

/// Restores the terminal, however the watch ends.
impl Drop for LiveOutput<'_> {
    fn drop(&mut self) {
        if self.form == OutputForm::Screen {
            self.printer.print(screen::LEAVE.to_owned());
        }
    }
}

/// Truncates a line to one column less than the width, because a full line would wrap.
fn cut(line: &str, columns: usize) -> String {
    line.chars().take(columns.saturating_sub(1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::{
        fleet::tests::{AT_LIMITS, HOVER, TestLink},
        session::tests::estimator,
    };

    #[test]
    fn the_vehicle_in_most_danger_is_on_the_smallest_screen() {
        let estimator = estimator();
        let mut air = TestLink::new(&estimator);
        let calm: Vec<(u8, bool, [u16; 4])> =
            (10..30).map(|system| (system, true, HOVER)).collect();
        let on_the_ground = (1, false, [1000; 4]);
        air.fly(
            40,
            &[
                &calm[..],
                &[(2, true, HOVER), (3, true, HOVER), on_the_ground],
            ]
            .concat(),
        );
        air.fly(
            8,
            &[&calm[..], &[(2, true, AT_LIMITS), on_the_ground]].concat(),
        );
        let endpoints = ["udpin:0.0.0.0:14550".parse().unwrap()];
        let shown = LiveOutput {
            form: OutputForm::Screen,
            printer: Printer::new(1),
            endpoints: &endpoints,
            estimator: &estimator,
            note: String::new(),
        };
        for (columns, rows) in [(80, 24), (60, 8), (20, 5), (1, 1), (0, 0)] {
            let frame =
                anstream::adapter::strip_str(&shown.frame(&air.fleet, (columns, rows))).to_string();
            let lines: Vec<&str> = frame.lines().collect();
            assert!(lines.len() < rows.max(1), "{rows}: {lines:#?}");
            assert!(
                lines
                    .iter()
                    .all(|line| line.chars().count() < columns.max(1)),
                "{columns}: {lines:#?}"
            );
            if rows == 24 {
                insta::assert_snapshot!(frame);
            }
            if rows > 4 {
                assert!(lines[2].starts_with("FAIL"), "{lines:#?}");
            }
        }
    }
}
