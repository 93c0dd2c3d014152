//! Standard output in its own thread: a reader that stops, or a stopped terminal, must not block the watch.

use std::{
    io::{self, Write},
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use crate::output;

/// The maximum time that the program waits at its end for the last output to be read.
const FLUSH_TIMEOUT: Duration = Duration::from_secs(1);

/// Prints pieces of text in their order.
pub(crate) struct Printer {
    pieces: Option<SyncSender<String>>,
    thread: Option<JoinHandle<io::Result<()>>>,
    dropped: u64,
}

impl Printer {
    /// Creates a printer with a queue of at most `waiting` pieces.
    pub(crate) fn new(waiting: usize) -> Printer {
        let (sender, receiver) = sync_channel(waiting);
        Printer {
            pieces: Some(sender),
            thread: Some(thread::spawn(move || write_all(&receiver))),
            dropped: 0,
        }
    }

    /// Queues a piece of text. It is dropped if the queue is full. If standard output cannot be written any more, the piece is dropped
    /// too, and the error is reported once.
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
                    output::print_note(&format!("standard output cannot be written: {error}"));
                }
            }
            Some(Ok(())) | None => {}
        }
    }

    /// Returns whether standard output cannot be written any more.
    pub(crate) fn is_closed(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// The number of pieces that were dropped because the queue was full.
    pub(crate) fn dropped(&self) -> u64 {
        self.dropped
    }
}

impl Drop for Printer {
    fn drop(&mut self) {
        self.pieces = None;
        let start = Instant::now();
        let busy = |thread: &JoinHandle<_>| !thread.is_finished();
        while self.thread.as_ref().is_some_and(busy) && start.elapsed() < FLUSH_TIMEOUT {
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
