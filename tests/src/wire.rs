//! The wire between a stand-in vehicle and the other side, and what becomes of packets on it.

use std::{
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpStream, UdpSocket},
    time::Duration,
};

use flagred_flightlog::mavlink::Stream;

/// What a link does to packets, both ways for what it loses, and to those of the vehicle else.
#[derive(Debug, Clone, Copy, Default)]
pub struct Link {
    /// The share that is lost.
    pub loss: f64,
    /// The share that arrives after later ones.
    pub reordered: f64,
    /// The share that arrives twice.
    pub repeated: f64,
}

/// How fast a flight is flown again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Speed {
    /// As fast as it goes.
    Fastest,
    /// So many times as fast as it was.
    Times(f64),
}

/// The wire to the other side.
pub enum Wire {
    /// Datagrams.
    Udp(UdpSocket),
    /// A connection, and what is still to be written to it: a radio sends many small packets at once too.
    Tcp(TcpStream, Vec<u8>),
}

/// So many bytes are written at once.
const SEGMENT: usize = 1200;

impl Wire {
    /// Datagrams to `address`.
    ///
    /// # Panics
    ///
    /// Where the machine has no loopback.
    pub fn udp(address: SocketAddr) -> Wire {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.connect(address).unwrap();
        socket.set_nonblocking(true).unwrap();
        Wire::Udp(socket)
    }

    /// An open connection.
    ///
    /// # Panics
    ///
    /// Where it cannot be set up.
    pub fn tcp(stream: TcpStream) -> Wire {
        stream.set_nodelay(true).unwrap();
        // The shortest time-out of a read is a tick of the kernel: milliseconds for every look.
        stream.set_nonblocking(true).unwrap();
        Wire::Tcp(stream, Vec::new())
    }

    /// Sends some bytes as they are. A link may fail; what comes of it is what is tested.
    pub fn send(&mut self, bytes: &[u8]) {
        match self {
            Wire::Udp(socket) => drop(socket.send(bytes)),
            Wire::Tcp(_, waiting) => {
                waiting.extend(bytes);
                if waiting.len() >= SEGMENT {
                    self.flush();
                }
            }
        }
    }

    /// Writes what waits.
    pub(crate) fn flush(&mut self) {
        let Wire::Tcp(stream, waiting) = self else {
            return;
        };
        let bytes = std::mem::take(waiting);
        let mut rest = bytes.as_slice();
        while !rest.is_empty() {
            match stream.write(rest) {
                Ok(0) => return,
                Ok(written) => rest = &rest[written..],
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    std::thread::sleep(Duration::from_micros(100));
                }
                Err(_) => return,
            }
        }
    }

    pub(crate) fn receive(&mut self, stream: &mut Stream) -> bool {
        let mut buffer = [0; 2048];
        let read = match self {
            Wire::Udp(socket) => socket.recv(&mut buffer),
            Wire::Tcp(stream, _) => stream.read(&mut buffer),
        };
        match read {
            Ok(0) => false,
            Ok(count) => {
                stream.push(&buffer[..count]);
                true
            }
            Err(error) => {
                assert!(
                    !matches!(error.kind(), ErrorKind::InvalidInput),
                    "the wire is broken: {error}"
                );
                false
            }
        }
    }
}
