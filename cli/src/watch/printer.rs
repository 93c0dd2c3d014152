//! Standard output from a thread of its own: who does not read it, or stops the terminal, must not stop the watch.

use std::{
    io::{self, Write},
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use crate::failure::Failure;

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

    /// Prints a piece as soon as there is somebody to read it; it is dropped where too many wait for that.
    ///
    /// # Errors
    ///
    /// Where standard output is closed or cannot be written.
    pub(crate) fn print(&mut self, piece: String) -> Result<(), Failure> {
        let sent = self.pieces.as_ref().map(|pieces| pieces.try_send(piece));
        match sent {
            Some(Err(TrySendError::Full(_))) => self.dropped += 1,
            Some(Err(TrySendError::Disconnected(_))) => {
                let ended = self.thread.take().map(JoinHandle::join);
                if let Some(Ok(Err(error))) = ended {
                    return Err(error.into());
                }
                return Err(io::Error::from(io::ErrorKind::BrokenPipe).into());
            }
            Some(Ok(())) | None => {}
        }
        Ok(())
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
