//! An assessed flight, the subject of a report.

use std::sync::Arc;

use flagred::flight::Assessment;
use flagred_flightlog::Flight;

use crate::{charts, curve::Stretch};

/// An assessed flight.
pub struct Subject {
    /// The name of the file that contains the flight.
    pub name: String,
    /// The flight.
    pub flight: Arc<Flight>,
    /// The assessment of the flight.
    pub assessed: Assessment,
}

impl Subject {
    /// The file name without its folders.
    pub(crate) fn title(&self) -> &str {
        let file = std::path::Path::new(&self.name).file_name();
        file.and_then(|file| file.to_str()).unwrap_or(&self.name)
    }

    /// The time that a report shows by default: from the first take-off to the last landing, or the whole log.
    pub fn stretch(&self) -> Stretch {
        charts::stretch(&self.flight)
    }

    pub(crate) fn in_air_s(&self) -> f64 {
        self.assessed.summary.in_air_s
    }
}
