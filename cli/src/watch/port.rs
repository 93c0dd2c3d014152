//! Sockets and serial ports: bytes in, bytes out, and nothing else.

use std::{
    io::{self, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs, UdpSocket},
    thread,
    time::{Duration, Instant},
};

use super::endpoint::Endpoint;
use crate::failure::Failure;

/// How long a call waits for bytes: the beat of everything that does not hang on a packet.
const WAIT: Duration = Duration::from_millis(20);
/// How long a connection may take, and how long until it is tried again.
const CONNECT: Duration = Duration::from_secs(3);
const RETRY: Duration = Duration::from_secs(1);

/// An open endpoint.
pub(crate) struct Port {
    kind: Kind,
    /// Packets that could not be sent.
    unsent: u64,
}

enum Kind {
    Udp {
        socket: UdpSocket,
        /// Where the latest datagram came from, and where answers go.
        from: Option<SocketAddr>,
        to: Option<SocketAddr>,
    },
    Tcp {
        address: String,
        stream: Option<TcpStream>,
        tried: Instant,
    },
    TcpIn {
        listener: TcpListener,
        stream: Option<TcpStream>,
    },
    Serial {
        path: String,
        baud: u32,
        port: Option<Box<dyn serialport::SerialPort>>,
        tried: Instant,
    },
}

/// What a look at the port gave.
pub(crate) enum Received {
    /// So many bytes.
    Bytes(usize),
    /// A datagram of so many bytes: a packet does not go on in the next one.
    Datagram(usize),
    /// Nothing in this time.
    Nothing,
    /// The other side is there.
    Opened,
    /// The other side is gone; it is waited for.
    Closed(String),
}

impl Port {
    /// Opens it.
    ///
    /// # Errors
    ///
    /// Where the address does not resolve, the port is taken or not ours to open, or nobody answers.
    pub(crate) fn open(endpoint: &Endpoint) -> Result<Port, Failure> {
        let failed = |error: io::Error| refusal(endpoint, &error);
        let kind = match endpoint {
            Endpoint::UdpIn(address) => {
                let socket = UdpSocket::bind(address).map_err(failed)?;
                socket.set_read_timeout(Some(WAIT)).map_err(failed)?;
                Kind::Udp {
                    socket,
                    from: None,
                    to: None,
                }
            }
            Endpoint::UdpOut(address) => {
                let to = resolve(address).map_err(failed)?;
                let any = if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
                let socket = UdpSocket::bind(any).map_err(failed)?;
                socket.set_read_timeout(Some(WAIT)).map_err(failed)?;
                Kind::Udp {
                    socket,
                    from: None,
                    to: Some(to),
                }
            }
            Endpoint::Tcp(address) => Kind::Tcp {
                address: address.clone(),
                stream: Some(connect(address).map_err(failed)?),
                tried: Instant::now(),
            },
            Endpoint::TcpIn(address) => {
                let listener = TcpListener::bind(address).map_err(failed)?;
                listener.set_nonblocking(true).map_err(failed)?;
                Kind::TcpIn {
                    listener,
                    stream: None,
                }
            }
            Endpoint::Serial { path, baud } => Kind::Serial {
                path: path.clone(),
                baud: *baud,
                port: Some(open_serial(path, *baud).map_err(failed)?),
                tried: Instant::now(),
            },
        };
        Ok(Port { kind, unsent: 0 })
    }

    /// The address that is listened at, where there is one: a port of 0 has become a real one.
    pub(crate) fn listens_at(&self) -> Option<SocketAddr> {
        match &self.kind {
            Kind::Udp { socket, .. } => socket.local_addr().ok(),
            Kind::TcpIn { listener, .. } => listener.local_addr().ok(),
            Kind::Tcp { .. } | Kind::Serial { .. } => None,
        }
    }

    /// Waits a moment for bytes.
    pub(crate) fn receive(&mut self, buffer: &mut [u8]) -> Received {
        match &mut self.kind {
            Kind::Udp { socket, from, .. } => match socket.recv_from(buffer) {
                Ok((count, address)) => {
                    *from = Some(address);
                    Received::Datagram(count)
                }
                // Nobody listens yet where this was sent to: whoever it is may come later.
                Err(error) => pause(&error),
            },
            Kind::Tcp {
                address,
                stream,
                tried,
            } => match stream {
                Some(open) => read(open, buffer).unwrap_or_else(|why| {
                    *stream = None;
                    *tried = Instant::now();
                    Received::Closed(why)
                }),
                None => again(tried, || connect(address), stream),
            },
            Kind::TcpIn { listener, stream } => match stream {
                Some(open) => read(open, buffer).unwrap_or_else(|why| {
                    *stream = None;
                    Received::Closed(why)
                }),
                None => match listener.accept().and_then(|(open, _)| prepare(open)) {
                    Ok(open) => {
                        *stream = Some(open);
                        Received::Opened
                    }
                    Err(_) => {
                        thread::sleep(WAIT);
                        Received::Nothing
                    }
                },
            },
            Kind::Serial {
                path,
                baud,
                port,
                tried,
            } => match port {
                Some(open) => read(open, buffer).unwrap_or_else(|why| {
                    *port = None;
                    *tried = Instant::now();
                    Received::Closed(why)
                }),
                None => again(tried, || open_serial(path, *baud), port),
            },
        }
    }

    /// Answers go to where the latest datagram came from.
    pub(crate) fn answer(&mut self) {
        if let Kind::Udp { from, to, .. } = &mut self.kind {
            *to = from.or(*to);
        }
    }

    /// Sends a packet, where there is somebody to send it to.
    pub(crate) fn send(&mut self, packet: &[u8]) {
        let sent = match &mut self.kind {
            Kind::Udp {
                socket,
                to: Some(to),
                ..
            } => socket.send_to(packet, *to).map(drop),
            Kind::Tcp {
                stream: Some(stream),
                ..
            }
            | Kind::TcpIn {
                stream: Some(stream),
                ..
            } => stream.write_all(packet),
            Kind::Serial {
                port: Some(port), ..
            } => port.write_all(packet),
            _ => Ok(()),
        };
        self.unsent += u64::from(sent.is_err());
    }

    /// How many packets could not be sent.
    pub(crate) fn unsent(&self) -> u64 {
        self.unsent
    }
}

fn read(open: &mut impl Read, buffer: &mut [u8]) -> Result<Received, String> {
    match open.read(buffer) {
        Ok(0) => Err("the other side closed the link".to_owned()),
        Ok(count) => Ok(Received::Bytes(count)),
        Err(error) => match error.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => {
                Ok(Received::Nothing)
            }
            _ => Err(error.to_string()),
        },
    }
}

fn pause(error: &io::Error) -> Received {
    let waited = matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    );
    if !waited {
        thread::sleep(WAIT);
    }
    Received::Nothing
}

/// Tries to open what was closed, not too often.
fn again<T>(
    tried: &mut Instant,
    open: impl FnOnce() -> io::Result<T>,
    place: &mut Option<T>,
) -> Received {
    if tried.elapsed() < RETRY {
        thread::sleep(WAIT);
        return Received::Nothing;
    }
    *tried = Instant::now();
    *place = open().ok();
    match place {
        Some(_) => Received::Opened,
        None => Received::Nothing,
    }
}

fn resolve(address: &str) -> io::Result<SocketAddr> {
    let mut addresses = address.to_socket_addrs()?;
    let none = || io::Error::new(io::ErrorKind::NotFound, "the name has no address");
    addresses.next().ok_or_else(none)
}

fn connect(address: &str) -> io::Result<TcpStream> {
    prepare(TcpStream::connect_timeout(&resolve(address)?, CONNECT)?)
}

fn prepare(stream: TcpStream) -> io::Result<TcpStream> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(WAIT))?;
    stream.set_write_timeout(Some(WAIT))?;
    stream.set_nodelay(true)?;
    Ok(stream)
}

fn open_serial(path: &str, baud: u32) -> io::Result<Box<dyn serialport::SerialPort>> {
    Ok(serialport::new(path, baud).timeout(WAIT).open()?)
}

fn refusal(endpoint: &Endpoint, error: &io::Error) -> Failure {
    let failure = Failure::unreadable(format!("`{endpoint}` cannot be opened: {error}"));
    match (error.kind(), endpoint) {
        (io::ErrorKind::AddrInUse, _) => failure.help(
            "another program, such as a ground station, listens there: close it, or have it forward the packets to another port",
        ),
        (io::ErrorKind::PermissionDenied, Endpoint::Serial { .. }) => failure.help(
            "on Linux your user must be in the group that owns the port, often `dialout`: `sudo usermod -aG dialout $USER`, then log in again",
        ),
        (io::ErrorKind::NotFound, Endpoint::Serial { .. }) => {
            failure.help("is the cable plugged in? `ls /dev/tty*` lists the serial ports")
        }
        (io::ErrorKind::ConnectionRefused, _) => {
            failure.help("nobody listens there: start the vehicle or the simulator first")
        }
        _ => failure,
    }
}
