//! The telemetry log that `--record` writes: the received packets, each with its time.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
    time::{SystemTime, UNIX_EPOCH},
};

use crate::{failure::Failure, output};

/// A telemetry log under construction. Each packet is preceded by its time: the microseconds since 1970 as 8 bytes, the
/// most significant byte first.
pub(crate) struct Recording {
    name: String,
    /// `None` after an error.
    file: Option<BufWriter<File>>,
    /// The number of bytes of all packets added.
    added: u64,
    /// The number of these bytes that are certainly in the file; they end with a complete packet.
    written: u64,
}

impl Recording {
    /// Creates a recording. An existing file is not overwritten.
    pub(crate) fn create(path: &Path) -> Result<Recording, Failure> {
        Ok(Recording {
            name: path.display().to_string(),
            file: Some(BufWriter::new(output::new_file(path)?)),
            added: 0,
            written: 0,
        })
    }

    /// Adds a packet that has just arrived.
    ///
    /// # Errors
    ///
    /// If the file cannot be written. The error is a message. It ends the recording, so it is returned only once;
    /// the file then ends with its last complete packet.
    pub(crate) fn add(&mut self, packet: &[u8]) -> Result<(), String> {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH);
        let t_us = since_1970.map_or(0, |time| time.as_micros() as u64);
        let result = self.file.as_mut().map_or(Ok(()), |file| {
            file.write_all(&t_us.to_be_bytes())?;
            file.write_all(packet)
        });
        self.added += 8 + packet.len() as u64;
        result.map_err(|error| self.end(&error))
    }

    /// Writes all buffered packets to the file, because a watch may end at any moment.
    ///
    /// # Errors
    ///
    /// As for [`Recording::add`].
    pub(crate) fn flush(&mut self) -> Result<(), String> {
        let result = self.file.as_mut().map_or(Ok(()), Write::flush);
        result.map_err(|error| self.end(&error))?;
        self.written = self.added;
        Ok(())
    }

    fn end(&mut self, error: &io::Error) -> String {
        let reported = format!("cannot record to `{}`: {error}", self.name);
        // The buffered bytes are discarded, not written.
        let file = self.file.take().map(|file| file.into_parts().0);
        let is_whole = file.is_some_and(|file| file.set_len(self.written).is_ok());
        match is_whole {
            true => format!(
                "{reported}; the recording ends after {} bytes, the watch continues",
                self.written
            ),
            false => format!("{reported}; the recording ends inside a packet, the watch continues"),
        }
    }
}
