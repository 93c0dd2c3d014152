//! `--record`: what was received, as a telemetry log.

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::Path,
    time::{SystemTime, UNIX_EPOCH},
};

use crate::failure::Failure;

/// A telemetry log that is being written: before each packet 8 bytes with the time in microseconds since 1970, the
/// most significant first.
pub(crate) struct Recording {
    name: String,
    file: BufWriter<File>,
}

impl Recording {
    /// Begins one; a file of that name is not overwritten.
    pub(crate) fn create(path: &Path) -> Result<Recording, Failure> {
        let name = path.display().to_string();
        let file = File::create_new(path).map_err(|error| {
            Failure::unreadable(format!("`{name}` cannot be recorded to: {error}"))
        })?;
        Ok(Recording {
            name,
            file: BufWriter::new(file),
        })
    }

    /// Adds a packet that arrived just now.
    pub(crate) fn add(&mut self, packet: &[u8]) -> Result<(), Failure> {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH);
        let t_us = since_1970.map_or(0, |time| time.as_micros() as u64);
        let written = self.file.write_all(&t_us.to_be_bytes());
        written
            .and_then(|()| self.file.write_all(packet))
            .map_err(|error| self.failed(&error))
    }

    /// Brings what was added to the disk: a watch may end at any moment.
    pub(crate) fn flush(&mut self) -> Result<(), Failure> {
        self.file.flush().map_err(|error| self.failed(&error))
    }

    fn failed(&self, error: &std::io::Error) -> Failure {
        Failure::unreadable(format!("`{}` cannot be recorded to: {error}", self.name))
    }
}
