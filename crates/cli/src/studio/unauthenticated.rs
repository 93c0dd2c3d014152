//! Connections that have not sent the token yet. They must not block the user's connections, however many there are.

use std::{
    collections::VecDeque,
    net::{Shutdown, TcpStream},
    sync::{Mutex, PoisonError},
};

/// Maximum number of such connections; a browser opens about six.
const MAX_CONNECTIONS: usize = 64;

/// Connections that have not sent the token yet, the oldest first.
#[derive(Default)]
pub(super) struct UnauthenticatedConnections(Mutex<ConnectionQueue>);

#[derive(Default)]
struct ConnectionQueue {
    count: u64,
    open: VecDeque<(u64, TcpStream)>,
}

impl UnauthenticatedConnections {
    /// Adds a connection, and returns its number. If there are too many connections, the oldest is closed. This does
    /// not affect a browser, because it sends its request immediately.
    pub(super) fn admit(&self, stream: &TcpStream) -> u64 {
        let mut queue = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        queue.count += 1;
        let number = queue.count;
        if let Ok(stream) = stream.try_clone() {
            queue.open.push_back((number, stream));
        }
        if queue.open.len() > MAX_CONNECTIONS
            && let Some((_, oldest)) = queue.open.pop_front()
        {
            // This fails if the connection is closed already.
            let _ = oldest.shutdown(Shutdown::Both);
        }
        number
    }

    /// Removes a connection that ended or sent the token.
    pub(super) fn forget(&self, number: u64) {
        let mut queue = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        queue.open.retain(|(other, _)| *other != number);
    }
}
