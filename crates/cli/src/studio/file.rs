//! The file that the page edits.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use flagred_authoring::provenance::digits;
use sha2::{Digest, Sha256};

use crate::{
    built_in,
    diagnostics::{is_utf16, read_bytes, text},
    failure::Failure,
    output::{Files, Replace, can_replace},
};

/// Number of hash digits that identify a text: 128 bits.
const TAG_DIGITS: usize = 32;

pub(super) struct EditedFile {
    path: PathBuf,
    /// The reason why the file is read-only; empty if the user chose that, `None` if the file can be changed.
    pub(super) read_only: Option<&'static str>,
}

/// The current content of the file.
pub(super) struct Content {
    pub(super) text: String,
    /// A hash that identifies the text.
    pub(super) tag: String,
}

/// The result of saving a text.
pub(super) enum SaveResult {
    /// The text was saved; this is its tag.
    Yes(String),
    /// The text was not saved, because another program has changed the file in the meantime.
    Changed,
}

impl EditedFile {
    pub(super) fn open(path: &Path, is_read_only: bool) -> Result<EditedFile, Failure> {
        let shown = path.display();
        if path == Path::new("-") {
            return Err(Failure::usage("standard input cannot be edited").help("name a file"));
        }
        let found = fs::metadata(path).map_err(|error| {
            let failure = Failure::unreadable(format!("`{shown}` cannot be read: {error}"));
            failure.help(built_in::help_to_edit(path).unwrap_or_else(|| {
                let help = match error.kind() {
                    ErrorKind::NotFound => "`flagred new NAME` writes a rule set to start from",
                    _ => "check the path",
                };
                help.into()
            }))
        })?;
        if !found.is_file() {
            return Err(Failure::unreadable(format!("`{shown}` is not a file"))
                .help("name a rule set or a profile"));
        }
        // Standard output must not be the file itself.
        Files::reading([path])?;
        let file = EditedFile {
            path: path.to_owned(),
            read_only: match is_read_only {
                true => Some(""),
                false if !can_write(path) => Some("the file cannot be written to"),
                // The new file is written into the same folder, then renamed.
                false if !can_replace(path) => Some("its folder cannot be written to"),
                false => None,
            },
        };
        file.read()?;
        Ok(file)
    }

    /// The name of the file without its folder.
    pub(super) fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    pub(super) fn read(&self) -> Result<Content, Failure> {
        let shown = self.path.display().to_string();
        let failed = |error: io::Error| {
            Failure::unreadable(format!("`{shown}` cannot be read: {error}")).help("check the path")
        };
        let file = open(&self.path).map_err(failed)?;
        // The path may have become a device or a FIFO, whose content never ends.
        if !file.metadata().map_err(failed)?.is_file() {
            return Err(Failure::unreadable(format!(
                "`{shown}` is not a file any more"
            )));
        }
        let bytes = read_bytes(file, &shown)?;
        if self.read_only.is_none() && is_utf16(&bytes) {
            let message = format!("`{shown}` is in UTF-16, but the page would save it in UTF-8");
            return Err(Failure::unreadable(message)
                .help("convert the file to UTF-8, or show it with `--read-only`"));
        }
        let text = text(bytes, &shown)?;
        let tag = tag(&text);
        Ok(Content { text, tag })
    }

    /// Replaces the file with a text if its current content has the expected tag.
    pub(super) fn save(&self, text: &str, expected: &str) -> Result<SaveResult, Failure> {
        if self.read()?.tag != expected {
            return Ok(SaveResult::Changed);
        }
        let mut files = Files::reading::<PathBuf>([])?;
        files.output(&self.path, Replace::Yes)?.write(text)?;
        Ok(SaveResult::Yes(tag(text)))
    }
}

/// Opens a file for reading. Does not wait for the other end of a FIFO.
fn open(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        let flags = rustix::fs::OFlags::NONBLOCK.bits();
        options.custom_flags(flags.cast_signed());
    }
    options.read(true).open(path)
}

fn can_write(path: &Path) -> bool {
    OpenOptions::new().write(true).open(path).is_ok()
}

fn tag(text: &str) -> String {
    let mut digest = digits(&Sha256::digest(text.as_bytes()));
    digest.truncate(TAG_DIGITS);
    format!("\"{digest}\"")
}
