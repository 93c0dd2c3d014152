//! Runs the commands on bytes, without files, sockets or a terminal, for the fuzz targets and the tests that share
//! their code. This is not a public interface; it changes without notice.

use std::{convert::Infallible, net::SocketAddr, sync::Arc};

use flagred::{estimator::Estimator, loaded, log::assess, shipped};
use flagred_authoring::examine;
use flagred_flightlog::{
    Flight,
    mavlink::{Sender, Stream},
};
use fuzzy::{Findings, Source, check};

use flagred_report::{
    document,
    page::{self, Subject},
    steps, words,
};

use crate::{
    diagnostics::draw,
    export, inspect,
    profile::Loaded,
    watch::{
        jsonl,
        lines::Words,
        screen::Screen,
        session::{Session, SessionOutput},
    },
};

/// A compiled profile with its rule set.
pub struct Profile(Loaded);

impl Profile {
    /// Compiles a profile with a rule set; `None` if that fails.
    pub fn new(profile_text: &str, rules_text: &str) -> Option<Profile> {
        let [profile, rules] = [profile_text, rules_text].map(Source::new);
        let loaded = loaded::with_rules::<Infallible>("the profile", profile, rules);
        loaded.ok().map(Profile)
    }

    /// Returns the default profile.
    pub fn shipped() -> Option<Profile> {
        Profile::new(shipped::PROFILES[0].text, shipped::RULE_SETS[0].text)
    }

    /// Returns the compiled profile and rule set.
    pub fn estimator(&self) -> &Estimator {
        &self.0.estimator
    }

    /// Returns the Rust and C code that `export` writes; `None` if there is no closed form.
    pub fn exported(&self) -> Option<[String; 2]> {
        let code = |language| export::profile_code(&self.0.estimator, language).ok();
        Some([code(export::Language::Rust)?, code(export::Language::C)?])
    }
}

/// The output about a flight.
#[derive(Debug, Default)]
pub struct Documents {
    /// The text of `assess` and `inspect`.
    pub words: Vec<u8>,
    /// The documents of `assess --json` and `inspect --json`.
    pub json: Vec<String>,
    /// The table of `assess --csv`.
    pub csv: Vec<u8>,
    /// The report, the picture, and the comparison of the flight with itself.
    pub pages: Vec<String>,
}

/// Returns everything that `assess` and `inspect` write about a flight.
///
/// # Errors
///
/// None in practice: the output goes to memory.
pub fn documents(name: &str, flight: Flight, profile: &Profile) -> std::io::Result<Documents> {
    let mut all = Documents::default();
    let loaded = &profile.0;
    let estimator = &loaded.estimator;
    let assessed = assess(&flight, estimator, Some(0.1));
    inspect::text::write(&mut all.words, name, &flight)?;
    words::write(&mut all.words, name, &flight, estimator, &assessed, true)?;
    all.json = vec![
        serde_json::to_string(&inspect::json::Document::new(name, &flight))?,
        serde_json::to_string(&document::document(name, &flight, estimator, &assessed))?,
    ];
    steps::write_csv(&mut all.csv, Some(name), true, estimator, &assessed)?;
    let subject = Subject {
        name: name.to_owned(),
        flight: Arc::new(flight),
        assessed,
    };
    all.pages.push(page::report(&subject, loaded));
    all.pages.extend(page::svg(&subject, loaded));
    all.pages.push(page::comparison(&[&subject], loaded));
    Ok(all)
}

/// Returns a flight as `convert` writes it.
///
/// # Errors
///
/// None in practice: the output goes to memory.
pub fn converted(flight: &Flight) -> std::io::Result<Vec<u8>> {
    let mut csv = Vec::new();
    flagred_report::table::write_flight(&mut csv, flight)?;
    Ok(csv)
}

/// Returns the findings of `check`, the findings as text, and the analysis if there is one.
pub fn checked(text: &str) -> (Findings, String, Option<check::Report>) {
    let source = Source::new(text);
    let (findings, report) = match examine(&source, &check::Options::default()) {
        Ok(examined) => (
            examined.findings,
            examined.analysed.map(|(_, report)| report),
        ),
        // This fails only for invalid claims, and there are no claims.
        Err(finding) => (Findings(vec![*finding]), None),
    };
    let drawn = draw(&findings.0, "rules.yaml", text, false);
    (findings, drawn, report)
}

/// A watch without sockets or files, which produces all kinds of output.
pub struct Watch<'e> {
    session: Session<'e>,
    estimator: &'e Estimator,
    stream: Stream,
    out: SessionOutput,
    words: Words,
    screen: Screen,
    reported: WatchOutput,
}

/// Output of a watch since the previous call.
#[derive(Debug, Default)]
pub struct WatchOutput {
    /// The lines of text output.
    pub words: Vec<String>,
    /// The lines of JSON output.
    pub json: Vec<String>,
    /// The packets to send.
    pub packets: Vec<Vec<u8>>,
}

/// The state of the vehicle that is followed.
#[derive(Debug, Clone, Copy)]
pub struct VehicleState {
    /// The MAVLink system number of the vehicle.
    pub system: u8,
    /// Whether the vehicle or its motor commands are lost.
    pub is_lost: bool,
    /// The vehicle's clock at its latest sample.
    pub t_s: Option<f64>,
}

impl<'e> Watch<'e> {
    /// Creates a watch that also sends packets.
    pub fn new(estimator: &'e Estimator) -> Watch<'e> {
        Watch {
            session: Session::new(estimator, Some(Sender::new(191)), false),
            estimator,
            stream: Stream::new(),
            out: SessionOutput::default(),
            words: Words::default(),
            screen: Screen::new("fuzzing".to_owned()),
            reported: WatchOutput::default(),
        }
    }

    /// Processes a datagram, and returns how many of its packets come from the vehicle.
    pub fn receive(&mut self, now_s: f64, source: Option<SocketAddr>, datagram: &[u8]) -> usize {
        let mut taken = 0;
        self.stream.push(datagram);
        while let Some(packet) = self.stream.packet() {
            let is_taken = self.session.receive(now_s, source, &packet, &mut self.out);
            taken += usize::from(is_taken);
        }
        self.stream.end();
        self.collect_events(now_s);
        taken
    }

    /// Advances the clock.
    pub fn tick(&mut self, now_s: f64) {
        self.session.tick(now_s, &mut self.out);
        self.collect_events(now_s);
    }

    /// Ends the watch and the current flight.
    pub fn finish(&mut self, now_s: f64) {
        self.session.finish(&mut self.out);
        self.collect_events(now_s);
    }

    /// Returns the output since the previous call.
    pub fn reported(&mut self) -> WatchOutput {
        std::mem::take(&mut self.reported)
    }

    /// Returns the text of the screen.
    pub fn screen(&self, size: (usize, usize)) -> String {
        let view = self.session.view();
        self.screen.frame(view.as_ref(), self.estimator, size)
    }

    /// Returns the vehicle that is followed.
    pub fn followed(&self) -> Option<VehicleState> {
        self.session.view().map(|view| VehicleState {
            system: view.system,
            is_lost: view.link_lost || view.motors_lost,
            t_s: view.latest.map(|update| update.t_s),
        })
    }

    fn collect_events(&mut self, now_s: f64) {
        for event in self.out.events.drain(..) {
            let (session, estimator) = (&self.session, self.estimator);
            let words = self.words.line(now_s, &event, session, estimator);
            self.reported.words.extend(words);
            let line = jsonl::line(now_s, &event, session, estimator);
            let json = line.and_then(|line| jsonl::text(&line).ok());
            self.reported.json.extend(json);
            self.screen.add(now_s, &event, session, estimator);
        }
        self.reported.packets.append(&mut self.out.packets);
    }
}
