//! The file that the page edits.

use std::{
    fs::{self, OpenOptions},
    io::ErrorKind,
    path::{Path, PathBuf},
};

use authoring::provenance::digits;
use sha2::{Digest, Sha256};

use crate::{
    diagnostics::read_text,
    failure::Failure,
    output::{Files, Replace},
};

/// Digits of a hash that tell texts apart: 128 bits.
const TAG_DIGITS: usize = 32;

pub(super) struct EditedFile {
    path: PathBuf,
    pub(super) is_read_only: bool,
}

/// What is in the file now.
pub(super) struct Content {
    pub(super) text: String,
    /// Another one for every other text.
    pub(super) tag: String,
}

/// What became of a text that was to be saved.
pub(super) enum Saved {
    /// It is there, under this tag.
    Yes(String),
    /// Somebody else changed the file meanwhile.
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
            failure.help(match error.kind() {
                ErrorKind::NotFound => "`flagred new NAME` writes a rule set to start from",
                _ => "check the path",
            })
        })?;
        if !found.is_file() {
            return Err(Failure::unreadable(format!("`{shown}` is not a file"))
                .help("name a rule set or a profile"));
        }
        // Standard output is not to be the file itself.
        Files::reading([path])?;
        let file = EditedFile {
            path: path.to_owned(),
            is_read_only: is_read_only || OpenOptions::new().write(true).open(path).is_err(),
        };
        file.read()?;
        Ok(file)
    }

    /// Without its folder.
    pub(super) fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    pub(super) fn read(&self) -> Result<Content, Failure> {
        let text = read_text(&self.path)?;
        let tag = tag(&text);
        Ok(Content { text, tag })
    }

    /// Replaces the file with a text, if it still is the one of that tag.
    pub(super) fn save(&self, text: &str, expected: &str) -> Result<Saved, Failure> {
        if self.read()?.tag != expected {
            return Ok(Saved::Changed);
        }
        let mut files = Files::reading::<PathBuf>([])?;
        files.output(&self.path, Replace::Yes)?.write(text)?;
        Ok(Saved::Yes(tag(text)))
    }
}

fn tag(text: &str) -> String {
    let mut digest = digits(&Sha256::digest(text.as_bytes()));
    digest.truncate(TAG_DIGITS);
    format!("\"{digest}\"")
}
