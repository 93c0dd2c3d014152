//! A place for the files of one test.

use std::{fs, path::Path};

/// A folder of a test's own, gone when the test is.
pub struct Folder(tempfile::TempDir);

#[expect(
    clippy::new_without_default,
    clippy::expect_used,
    reason = "a test that has no room for its files has failed"
)]
impl Folder {
    /// A new one, and empty.
    pub fn new() -> Self {
        Folder(tempfile::tempdir().expect("a temporary folder"))
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Where a file of that name is or would be, as an argument for a command.
    pub fn at(&self, name: &str) -> String {
        self.path().join(name).display().to_string()
    }

    /// Writes a file; where it is, as an argument for a command.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.at(name);
        fs::write(&path, content).expect("a file in a temporary folder");
        path
    }
}
