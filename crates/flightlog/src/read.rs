//! Detects the format of a log by its content and calls the reader of that format.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{self, UNNAMED, io_error};
use crate::input::Input;
use crate::kind::{self, FileKind};
use crate::{Commands, Flight, PulseRange, Range, ReadError, csv, dataflash, geometry, tlog, ulog};

/// Options for reading a log.
///
/// # Example: one signal of many
/// ```
/// use flagred_flightlog::Options;
///
/// let log = "t_s,motor1,roll_deg,wind_m_s\n0,0.4,0.3,5\n";
/// let mut only_wind = Options::default();
/// only_wind.signals = Some(vec!["wind_m_s".into()]);
/// let flight = flagred_flightlog::read(log.as_bytes(), &only_wind)?;
/// assert!(flight.signal("wind_m_s").is_some() && flight.signal("roll_deg").is_none());
/// # Ok::<(), flagred_flightlog::ReadError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Options {
    /// Names of the signals to keep; `None` keeps all. Motor commands, armed and in-air times, modes and messages are
    /// always read, and the [`Report`](crate::Report) does not depend on this option.
    pub signals: Option<Vec<String>>,
    /// The range of the motor outputs, for a log that does not report it, such as a telemetry log without parameters.
    /// The flight's [`assumed`](Flight::assumed) mentions this range. A log is refused ([`ReadError::Range`]) if it
    /// reports its own range, or if its commands contradict the range given here.
    pub range: Option<PulseRange>,
}

impl Options {
    /// Whether to keep the signal `name`.
    fn keeps(&self, name: &str) -> bool {
        self.signals
            .as_ref()
            .is_none_or(|names| names.iter().any(|wanted| wanted == name))
    }

    /// The range of motor outputs in the log, or the given one if the log has none.
    pub(crate) fn range_or_given(&self, own: Option<Range>) -> Option<Range> {
        own.or_else(|| self.range.map(PulseRange::range))
    }

    /// Whether to read the signal `name`, either to keep it or for the geometry.
    pub(crate) fn wants(&self, name: &str) -> bool {
        self.keeps(name) || geometry::infer::SIGNALS.contains(&name)
    }
}

/// Reads the log at `path`; `-` is standard input. The format is detected from the content, not from the name; the file
/// may be gzipped.
///
/// # Errors
///
/// If there is no such file, if it is empty, or if it is not a flight log. A damaged log is not an error: see
/// [`Flight::report`].
///
/// # Example
/// ```no_run
/// let flight = flagred_flightlog::open("flight.bin", &flagred_flightlog::Options::default())?;
/// for motor in &flight.motors {
///     println!("motor {}: output {} ({})", motor.number, motor.output, motor.source);
/// }
/// println!("in the air: {:?}", flight.in_air);
/// # Ok::<(), flagred_flightlog::ReadError>(())
/// ```
pub fn open(path: impl AsRef<Path>, options: &Options) -> Result<Flight, ReadError> {
    let path = path.as_ref();
    if path == Path::new("-") {
        return read(io::stdin().lock(), options).map_err(|error| error.with_path(error::STDIN));
    }
    let name = path.display().to_string();
    let file = File::open(path).and_then(|file| match file.metadata()?.is_dir() {
        true => Err(io::ErrorKind::IsADirectory.into()),
        false => Ok(file),
    });
    match file {
        Ok(file) => read(file, options).map_err(|error| error.with_path(&name)),
        Err(source) => Err(ReadError::Io { path: name, source }),
    }
}

/// Reads a log from any source of bytes, once and from front to back.
///
/// # Errors
///
/// As [`open`].
///
/// ```
/// let log = "# vehicle: my quad\nt_s,motor1,motor2,motor3,motor4\n0.0,0.4,0.4,0.5,0.5\n";
/// let flight = flagred_flightlog::read(log.as_bytes(), &flagred_flightlog::Options::default())?;
/// assert_eq!(flight.motors.len(), 4);
/// # Ok::<(), flagred_flightlog::ReadError>(())
/// ```
pub fn read(source: impl Read, options: &Options) -> Result<Flight, ReadError> {
    let mut input = Input::new(Box::new(source), false);
    let (start, _) = input.window().map_err(io_error)?;
    if start.starts_with(&[0x1f, 0x8b]) {
        let unpacked = flate2::read::MultiGzDecoder::new(input.into_rest());
        input = Input::new(Box::new(unpacked), true);
    }
    read_unpacked(&mut input, options)
}

/// The shortest time on the ground between two flights, in seconds; shorter ones are chatter of the land detector.
const SHORTEST_LANDING_S: f64 = 1.0;

fn read_unpacked(input: &mut Input<'_>, options: &Options) -> Result<Flight, ReadError> {
    let (start, _) = input.window().map_err(io_error)?;
    let mut flight = match sniff(start) {
        Content::DataFlash => dataflash::read(input, options).map_err(io_error)?,
        Content::DataFlashText => dataflash::text::read(input, options).map_err(io_error)?,
        Content::ULog => ulog::read(input, options).map_err(io_error)?,
        Content::Tlog => tlog::read(input, options).map_err(io_error)?,
        Content::Csv => csv::read(input, options)?,
        Content::Empty => {
            return Err(ReadError::Empty {
                path: UNNAMED.into(),
            });
        }
        Content::Sdlog2 => {
            return Err(ReadError::NotRead {
                path: UNNAMED.into(),
                what: error::SDLOG2.into(),
            });
        }
        Content::Other(kind) if kind.name == kind::BETAFLIGHT => {
            return Err(ReadError::NotRead {
                path: UNNAMED.into(),
                what: kind.name.into(),
            });
        }
        Content::Other(kind) => {
            return Err(ReadError::NotALog {
                path: UNNAMED.into(),
                what: kind.name.into(),
            });
        }
    };
    if let Some(given) = options.range {
        given.apply(&mut flight)?;
    }
    flight.in_air = flight
        .in_air
        .map(|in_air| in_air.joined(SHORTEST_LANDING_S));
    // Rows without any known value do not count.
    if flight.commands.are_unknown() {
        flight.commands = Commands::default();
    }
    for series in &mut flight.series {
        series.retain(|name| options.keeps(name));
    }
    flight.series.retain(|series| !series.is_empty());
    flight.report.bytes = input.taken();
    if let Some(failure) = input.failure() {
        flight.report.truncated = true;
        flight.report.reason = Some(failure.into());
    }
    Ok(flight)
}

enum Content {
    DataFlash,
    DataFlashText,
    ULog,
    Tlog,
    Csv,
    Empty,
    Sdlog2,
    Other(FileKind),
}

/// The label of the only field of sdlog2's time messages.
const SDLOG2: &[u8] = b"StartTime\0";

/// Returns the kind of a file by its first bytes: a flight log in a binary format, or a file of another kind that is not
/// text; `None` for text.
pub fn kind_of(start: &[u8]) -> Option<FileKind> {
    match sniff(start) {
        Content::DataFlash | Content::ULog | Content::Tlog | Content::Sdlog2 => Some(FileKind::LOG),
        Content::Other(kind) if !FileKind::PLAIN.contains(&kind) => Some(kind),
        Content::Other(_) | Content::DataFlashText | Content::Csv | Content::Empty => None,
    }
}

/// Returns whether a text begins like a flight CSV or a text log.
pub fn is_text_log(start: &[u8]) -> bool {
    matches!(sniff(start), Content::DataFlashText) || csv::has_times(start)
}

/// The kind of content, from the first bytes of a log or, if these are damaged, from the following ones.
fn sniff(start: &[u8]) -> Content {
    if start.is_empty() {
        return Content::Empty;
    }
    if let Some(kind) = kind::signed(start) {
        return Content::Other(kind);
    }
    if kind::is_utf16(start) {
        return Content::Other(FileKind::UTF_16);
    }
    if dataflash::looks_like(start) {
        // PX4 before ULog used the same encoding with its own messages.
        return match start.windows(SDLOG2.len()).any(|bytes| bytes == SDLOG2) {
            true => Content::Sdlog2,
            false => Content::DataFlash,
        };
    }
    if ulog::looks_like(start) {
        return Content::ULog;
    }
    if tlog::looks_like(start) {
        return Content::Tlog;
    }
    if dataflash::text::looks_like(start) {
        return Content::DataFlashText;
    }
    if kind::is_parameters(start) {
        return Content::Other(FileKind::PARAMETERS);
    }
    if csv::looks_like(start) {
        return Content::Csv;
    }
    Content::Other(kind::of_rest(start))
}
