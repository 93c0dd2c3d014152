//! The signals that the readers of logs provide.

use std::collections::BTreeMap;

use crate::{Format, dataflash, tlog, ulog};

/// A signal that logs of some formats contain. A flight CSV may have signals with any name.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct KnownSignal {
    /// The name, such as `battery_v`.
    pub name: &'static str,
    /// The unit; `1` for a share, empty for a count or a code.
    pub unit: &'static str,
    /// The formats whose logs can contain the signal, in the order DataFlash, ULog, tlog.
    pub formats: Vec<Format>,
}

/// Returns all signals that the readers of DataFlash logs, ULogs and tlogs know, sorted by name.
///
/// # Example
/// ```
/// use flagred_flightlog::Format;
///
/// let signals = flagred_flightlog::known_signals();
/// let wind = signals.iter().find(|signal| signal.name == "ekf_wind_m_s").ok_or("unknown")?;
/// assert_eq!((wind.unit, wind.formats.len()), ("m/s", 3));
/// # Ok::<(), &str>(())
/// ```
pub fn known_signals() -> Vec<KnownSignal> {
    let dataflash = dataflash::known_signals().map(|signal| (signal, Format::DataFlash));
    let ulog = ulog::known_signals().map(|signal| (signal, Format::ULog));
    let tlog = tlog::known_signals().map(|signal| (signal, Format::Tlog));
    let mut known = BTreeMap::new();
    for ((name, unit), format) in dataflash.chain(ulog).chain(tlog) {
        let entry = known.entry(name).or_insert(KnownSignal {
            name,
            unit,
            formats: Vec::new(),
        });
        if !entry.formats.contains(&format) {
            entry.formats.push(format);
        }
    }
    known.into_values().collect()
}
