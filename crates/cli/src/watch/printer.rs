//! Standard output from a thread of its own: who does not read it, or stops the terminal, must not stop the watch.

use std::{
    io::{self, Write},
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use crate::output;

/// How long the end waits for the last words to be read.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// Prints pieces of text in their order.
pub(crate) struct Printer {
    pieces: Option<SyncSender<String>>,
    thread: Option<JoinHandle<io::Result<()>>>,
    dropped: u64,
}

impl Printer {
    /// At most so many pieces wait to be printed.
    pub(crate) fn new(waiting: usize) -> Printer {
        let (sender, receiver) = sync_channel(waiting);
        Printer {
            pieces: Some(sender),
            thread: Some(thread::spawn(move || write_all(&receiver))),
            dropped: 0,
        }
    }

    /// Prints a piece as soon as there is somebody to read it; it is dropped where too many wait for that, and where
    /// standard output cannot be written any more, which is said once.
    pub(crate) fn print(&mut self, piece: String) {
        let sent = self.pieces.as_ref().map(|pieces| pieces.try_send(piece));
        match sent {
            Some(Err(TrySendError::Full(_))) => self.dropped += 1,
            Some(Err(TrySendError::Disconnected(_))) => {
                self.pieces = None;
                let ended = self.thread.take().map(JoinHandle::join);
                if let Some(Ok(Err(error))) = ended
                    && error.kind() != io::ErrorKind::BrokenPipe
                {
                    output::say(&format!("standard output cannot be written: {error}"));
                }
            }
            Some(Ok(())) | None => {}
        }
    }

    /// Whether nothing can be printed any more.
    pub(crate) fn is_closed(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// How many pieces nobody read in time.
    pub(crate) fn dropped(&self) -> u64 {
        self.dropped
    }
}

impl Drop for Printer {
    fn drop(&mut self) {
        self.pieces = None;
        let start = Instant::now();
        let busy = |thread: &JoinHandle<_>| !thread.is_finished();
        while self.thread.as_ref().is_some_and(busy) && start.elapsed() < LAST_WORDS {
            thread::sleep(Duration::from_millis(2));
        }
    }
}

fn write_all(pieces: &Receiver<String>) -> io::Result<()> {
    let mut out = anstream::stdout();
    for piece in pieces {
        out.write_all(piece.as_bytes())?;
        out.flush()?;
    }
    Ok(())
}
