//! A folder for the files of one test.

use std::{fs, path::Path};

/// A temporary folder, removed at the end of the test.
pub struct Folder(tempfile::TempDir);

#[expect(
    clippy::new_without_default,
    clippy::expect_used,
    reason = "a test that has no room for its files has failed"
)]
impl Folder {
    /// Creates an empty folder.
    pub fn new() -> Self {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    /// The path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Returns the path of a file with the given name, as an argument for a command; the file need
    /// not exist.
    pub fn at(&self, name: &str) -> String {
        self.path().join(name).display().to_string()
    }

    /// Writes a file and returns its path, as an argument for a command.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.at(name);
        fs::write(&path, content).expect("a file in a temporary folder");
        path
    }
}
