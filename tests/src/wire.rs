//! The connection between a stand-in vehicle and `flagred watch`, with losses.

use std::{
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpStream, UdpSocket},
    time::Duration,
};

use flagred_flightlog::mavlink::Stream;

/// The behaviour of a link. Losses apply in both directions; repetition and reordering apply only to packets of the
/// vehicle.
#[derive(Debug, Clone, Copy, Default)]
pub struct Link {
    /// The share of lost packets.
    pub loss: f64,
    /// The share of packets that arrive after later ones.
    pub reordered: f64,
    /// The share of packets that arrive twice.
    pub repeated: f64,
}

/// The speed of a replay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Speed {
    /// As fast as possible.
    Fastest,
    /// This many times the original speed.
    Times(f64),
}

/// The connection to the other side.
pub enum Wire {
    /// Datagrams.
    Udp(UdpSocket),
    /// A TCP connection, and the bytes still to be written. Small packets are collected and sent together, as a radio
    /// does.
    Tcp(TcpStream, Vec<u8>),
}

/// The number of bytes written at once.
const SEGMENT: usize = 1200;

impl Wire {
    /// A socket that sends datagrams to `address`.
    pub fn udp(address: SocketAddr) -> Wire {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.connect(address).unwrap();
        socket.set_nonblocking(true).unwrap();
        Wire::Udp(socket)
    }

    /// A TCP connection that is already open.
    pub fn tcp(stream: TcpStream) -> Wire {
        stream.set_nodelay(true).unwrap();
        // The stream is non-blocking, because even the shortest read time-out waits for a tick of the kernel, that is,
        // milliseconds per read.
        stream.set_nonblocking(true).unwrap();
        Wire::Tcp(stream, Vec::new())
    }

    /// Sends bytes unchanged. The link may fail; the tests check the consequences.
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

    /// Writes the pending bytes.
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
