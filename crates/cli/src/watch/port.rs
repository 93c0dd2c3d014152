//! Sockets and serial ports: they transfer bytes and do not interpret them.

use std::{
    io::{self, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs, UdpSocket},
    thread,
    time::{Duration, Instant},
};

use super::endpoint::Endpoint;
use crate::failure::Failure;

/// The time for which a call waits for bytes, which is also the interval of all periodic work.
const WAIT: Duration = Duration::from_millis(20);
/// The time limit for connecting.
const CONNECT: Duration = Duration::from_secs(3);
/// The interval between attempts to connect.
const RETRY: Duration = Duration::from_secs(1);

/// The requested size of the system's buffer, which stores datagrams until the program reads them. It has space for
/// the datagrams of 500 vehicles during a second, including the overhead of each packet. The default size suffices
/// for a tenth of that.
const BUFFER: usize = 4 << 20;

/// An open endpoint.
pub(crate) struct Port {
    kind: PortState,
    /// The reason why the endpoint could not be opened at first; `None` after it was reported.
    closed_because: Option<String>,
    /// The number of packets that could not be sent.
    unsent: u64,
}

enum PortState {
    /// The endpoint could not be opened yet.
    Closed { endpoint: Endpoint, tried: Instant },
    Udp {
        socket: UdpSocket,
        /// The origin of the latest datagram.
        from: Option<SocketAddr>,
        /// The address to which packets are sent.
        to: Option<SocketAddr>,
    },
    Tcp {
        address: String,
        stream: Option<TcpStream>,
        tried: Instant,
    },
    TcpIn {
        listener: TcpListener,
        client: Option<Client>,
        /// Connections that replace the client if it is silent, the oldest first.
        waiting: Vec<Client>,
    },
    Serial {
        path: String,
        baud: u32,
        port: Option<serial2::SerialPort>,
        tried: Instant,
    },
}

/// Maximum number of waiting connections.
const MAX_WAITING: usize = 8;
/// A client that is silent for this long is replaced by a waiting connection that sends.
const CLIENT_SILENT: Duration = Duration::from_secs(2);

/// An incoming connection.
struct Client {
    stream: TcpStream,
    address: SocketAddr,
    received_at: Instant,
}

/// The result of reading from the port.
pub(crate) enum PortEvent {
    /// This number of bytes, which may end in the middle of a packet.
    Bytes(usize),
    /// A datagram of this number of bytes. A packet does not continue in the next datagram.
    Datagram(usize),
    /// Nothing within the waiting time.
    Nothing,
    /// The endpoint could not be opened for this reason. Opening is retried.
    Waiting(String),
    /// The connection is open.
    Opened,
    /// The connection was closed for this reason. Opening is retried.
    Closed(String),
}

impl Port {
    /// Opens an endpoint. If it is not available yet, opening is retried later, unless `waits` is false.
    ///
    /// # Errors
    ///
    /// If another program uses the port, or permission is denied. If `waits` is false, any other reason for which the
    /// endpoint cannot be opened is an error too.
    pub(crate) fn open(endpoint: &Endpoint, waits: bool) -> Result<Port, Failure> {
        let (kind, closed_because) = match open(endpoint) {
            Ok(kind) => (kind, None),
            Err(error) if waits && is_temporary(&error) => {
                let closed = PortState::Closed {
                    endpoint: endpoint.clone(),
                    tried: Instant::now(),
                };
                (closed, Some(error.to_string()))
            }
            Err(error) => return Err(refusal(endpoint, &error)),
        };
        Ok(Port {
            kind,
            closed_because,
            unsent: 0,
        })
    }

    /// The local address of a listening endpoint, with the actual port instead of 0.
    pub(crate) fn listens_at(&self) -> Option<SocketAddr> {
        match &self.kind {
            PortState::Udp { socket, .. } => socket.local_addr().ok(),
            PortState::TcpIn { listener, .. } => listener.local_addr().ok(),
            PortState::Closed { .. } | PortState::Tcp { .. } | PortState::Serial { .. } => None,
        }
    }

    /// The size of the system's buffer for datagrams, if it is less than half of the requested size.
    pub(crate) fn small_buffer(&self) -> Option<usize> {
        match &self.kind {
            PortState::Udp { socket, .. } => buffer(socket).filter(|bytes| *bytes < BUFFER / 2),
            _ => None,
        }
    }

    /// Waits briefly for bytes.
    pub(crate) fn receive(&mut self, buffer: &mut [u8]) -> PortEvent {
        if let Some(why) = self.closed_because.take() {
            return PortEvent::Waiting(why);
        }
        match &mut self.kind {
            PortState::Closed { endpoint, tried } => {
                if tried.elapsed() < RETRY {
                    thread::sleep(WAIT);
                    return PortEvent::Nothing;
                }
                *tried = Instant::now();
                match open(endpoint) {
                    Ok(kind) => {
                        self.kind = kind;
                        PortEvent::Opened
                    }
                    Err(_) => PortEvent::Nothing,
                }
            }
            PortState::Udp { socket, from, .. } => match socket.recv_from(buffer) {
                Ok((count, address)) => {
                    *from = Some(address);
                    PortEvent::Datagram(count)
                }
                // The other side is not listening yet, and may start later.
                Err(error) => pause(&error),
            },
            PortState::Tcp {
                address,
                stream,
                tried,
            } => match stream {
                Some(open) => read(open, buffer).unwrap_or_else(|why| {
                    *stream = None;
                    *tried = Instant::now();
                    PortEvent::Closed(why)
                }),
                None => again(tried, || connect(address), stream),
            },
            PortState::TcpIn {
                listener,
                client,
                waiting,
            } => serve(listener, client, waiting, buffer),
            PortState::Serial {
                path,
                baud,
                port,
                tried,
            } => match port {
                Some(open) => read(open, buffer).unwrap_or_else(|why| {
                    *port = None;
                    *tried = Instant::now();
                    PortEvent::Closed(why)
                }),
                None => again(tried, || open_serial(path, *baud), port),
            },
        }
    }

    /// The origin of the latest bytes; `None` on a serial port.
    pub(crate) fn source(&self) -> Option<SocketAddr> {
        match &self.kind {
            PortState::Udp { from, .. } => *from,
            PortState::Tcp { stream, .. } => stream.as_ref()?.peer_addr().ok(),
            PortState::TcpIn { client, .. } => Some(client.as_ref()?.address),
            PortState::Closed { .. } | PortState::Serial { .. } => None,
        }
    }

    /// Directs answers to the origin of the latest datagram.
    pub(crate) fn answer(&mut self) {
        if let PortState::Udp { from, to, .. } = &mut self.kind {
            *to = from.or(*to);
        }
    }

    /// Sends a packet if there is a receiver.
    pub(crate) fn send(&mut self, packet: &[u8]) {
        let sent = match &mut self.kind {
            PortState::Udp {
                socket,
                to: Some(to),
                ..
            } => socket.send_to(packet, *to).map(drop),
            PortState::Tcp {
                stream: Some(stream),
                ..
            }
            | PortState::TcpIn {
                client: Some(Client { stream, .. }),
                ..
            } => stream.write_all(packet),
            PortState::Serial {
                port: Some(port), ..
            } => port.write_all(packet),
            _ => Ok(()),
        };
        self.unsent += u64::from(sent.is_err());
    }

    /// The number of packets that could not be sent.
    pub(crate) fn unsent(&self) -> u64 {
        self.unsent
    }
}

fn open(endpoint: &Endpoint) -> io::Result<PortState> {
    let udp = |socket: UdpSocket, to: Option<SocketAddr>| {
        socket.set_read_timeout(Some(WAIT))?;
        enlarge(&socket);
        Ok(PortState::Udp {
            socket,
            from: None,
            to,
        })
    };
    match endpoint {
        Endpoint::UdpIn(address) => udp(UdpSocket::bind(address)?, None),
        Endpoint::UdpOut(address) => {
            let to = resolve(address)?;
            let any = if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
            udp(UdpSocket::bind(any)?, Some(to))
        }
        Endpoint::Tcp(address) => Ok(PortState::Tcp {
            address: address.clone(),
            stream: Some(connect(address)?),
            tried: Instant::now(),
        }),
        Endpoint::TcpIn(address) => {
            let listener = TcpListener::bind(address)?;
            listener.set_nonblocking(true)?;
            Ok(PortState::TcpIn {
                listener,
                client: None,
                waiting: Vec::new(),
            })
        }
        Endpoint::Serial { path, baud } => Ok(PortState::Serial {
            path: path.clone(),
            baud: *baud,
            port: Some(open_serial(path, *baud)?),
            tried: Instant::now(),
        }),
    }
}

/// Enlarges the system's buffer for datagrams. Linux grants at most its limit; other systems refuse a request that is too large.
fn enlarge(socket: &UdpSocket) {
    #[cfg(unix)]
    (0..5)
        .map(|half| BUFFER >> half)
        .find(|bytes| rustix::net::sockopt::set_socket_recv_buffer_size(socket, *bytes).is_ok());
    #[cfg(not(unix))]
    let _ = socket;
}

/// The size of the system's buffer for a socket; unknown on systems other than Unix.
fn buffer(socket: &UdpSocket) -> Option<usize> {
    #[cfg(unix)]
    return rustix::net::sockopt::socket_recv_buffer_size(socket).ok();
    #[cfg(not(unix))]
    return None;
}

/// Returns whether an endpoint may open later without the user's help: the vehicle, its cable or the network may be
/// missing for now, or the host name cannot be resolved yet.
fn is_temporary(error: &io::Error) -> bool {
    !matches!(
        error.kind(),
        io::ErrorKind::AddrInUse | io::ErrorKind::PermissionDenied | io::ErrorKind::InvalidInput
    )
}

/// Serves one client at a time. A waiting connection takes its place if the client closes, or if the client is silent
/// and the waiting connection sends.
fn serve(
    listener: &TcpListener,
    client: &mut Option<Client>,
    waiting: &mut Vec<Client>,
    buffer: &mut [u8],
) -> PortEvent {
    if waiting.len() < MAX_WAITING
        && let Ok((stream, address)) = listener.accept()
        && let Ok(stream) = prepare(stream)
    {
        let received_at = Instant::now();
        waiting.push(Client {
            stream,
            address,
            received_at,
        });
    }
    if let Some(open) = client {
        match read(&mut open.stream, buffer) {
            Ok(PortEvent::Nothing) => {}
            Ok(received) => {
                open.received_at = Instant::now();
                return received;
            }
            Err(why) => {
                *client = None;
                return PortEvent::Closed(why);
            }
        }
        if open.received_at.elapsed() < CLIENT_SILENT {
            return PortEvent::Nothing;
        }
        // Drops waiting connections that have been closed.
        waiting.retain(|next| !matches!(peek(&next.stream), Ok(0)));
        let is_sending = |next: &Client| matches!(peek(&next.stream), Ok(1..));
        let Some(index) = waiting.iter().position(is_sending) else {
            // If all are silent and there is no room for another connection, the oldest is dropped.
            if waiting.len() == MAX_WAITING {
                waiting.remove(0);
            }
            return PortEvent::Nothing;
        };
        *client = Some(waiting.remove(index));
        return PortEvent::Opened;
    }
    if waiting.is_empty() {
        thread::sleep(WAIT);
        return PortEvent::Nothing;
    }
    let mut next = waiting.remove(0);
    next.received_at = Instant::now();
    *client = Some(next);
    PortEvent::Opened
}

/// Peeks without waiting: 1 if a byte is available, 0 if the connection closed, otherwise an error.
fn peek(stream: &TcpStream) -> io::Result<usize> {
    stream.set_nonblocking(true)?;
    let count = stream.peek(&mut [0]);
    stream.set_nonblocking(false)?;
    count
}

fn read(open: &mut impl Read, buffer: &mut [u8]) -> Result<PortEvent, String> {
    match open.read(buffer) {
        Ok(0) => Err("the other side closed the link".to_owned()),
        Ok(count) => Ok(PortEvent::Bytes(count)),
        Err(error) => match error.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted => {
                Ok(PortEvent::Nothing)
            }
            _ => Err(error.to_string()),
        },
    }
}

fn pause(error: &io::Error) -> PortEvent {
    let waited = matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut
    );
    if !waited {
        thread::sleep(WAIT);
    }
    PortEvent::Nothing
}

/// Tries to open a closed port again, at intervals.
fn again<T>(
    tried: &mut Instant,
    open: impl FnOnce() -> io::Result<T>,
    place: &mut Option<T>,
) -> PortEvent {
    if tried.elapsed() < RETRY {
        thread::sleep(WAIT);
        return PortEvent::Nothing;
    }
    *tried = Instant::now();
    *place = open().ok();
    match place {
        Some(_) => PortEvent::Opened,
        None => PortEvent::Nothing,
    }
}

fn resolve(address: &str) -> io::Result<SocketAddr> {
    let mut addresses = address.to_socket_addrs()?;
    let none = || {
        io::Error::new(
            io::ErrorKind::NotFound,
            "the name does not resolve to an address",
        )
    };
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

/// Opens a serial port exclusively: a second program would take some of the bytes.
fn open_serial(path: &str, baud: u32) -> io::Result<serial2::SerialPort> {
    let mut port = serial2::SerialPort::open(path, baud)?;
    port.set_read_timeout(WAIT)?;
    port.set_write_timeout(WAIT)?;
    #[cfg(unix)]
    rustix::termios::ioctl_tiocexcl(&port)?;
    Ok(port)
}

fn refusal(endpoint: &Endpoint, error: &io::Error) -> Failure {
    let failure = Failure::unreadable(format!("`{endpoint}` cannot be opened: {error}"));
    match (error.kind(), endpoint) {
        (io::ErrorKind::AddrInUse, _) => failure.help(
            "another program, such as a ground station, uses the port: close it, or have it forward the packets to another port",
        ),
        (io::ErrorKind::PermissionDenied, Endpoint::Serial { .. }) => failure.help(
            "on Linux your user must be in the group that owns the port, often `dialout`: `sudo usermod -aG dialout $USER`, then log in again",
        ),
        (io::ErrorKind::NotFound, Endpoint::Serial { .. }) => {
            failure.help("check that the cable is plugged in; `ls /dev/tty*` lists the serial ports")
        }
        (io::ErrorKind::ConnectionRefused, _) => {
            failure.help("no program listens there: start the vehicle or the simulator, or leave out `--no-wait`")
        }
        _ => failure,
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

    use super::*;

    /// The buffer is as large as the system allows; Linux also counts the overhead of the packets.
    #[test]
    fn a_socket_buffers_a_second_of_many_vehicles() {
        let usual = buffer(&UdpSocket::bind("127.0.0.1:0").unwrap()).unwrap();
        let most = std::fs::read_to_string("/proc/sys/net/core/rmem_max").unwrap();
        let most: usize = most.trim().parse().unwrap();
        for endpoint in ["udpin:127.0.0.1:0", "udpout:127.0.0.1:9"] {
            let port = Port::open(&endpoint.parse().unwrap(), true).unwrap_or_else(|_| panic!());
            let PortState::Udp { socket, .. } = &port.kind else {
                panic!("{endpoint}");
            };
            let bytes = buffer(socket).unwrap();
            assert!(
                bytes >= BUFFER.min(most) && bytes >= usual,
                "{bytes} {usual}"
            );
            assert!(bytes > usual || most <= usual / 2, "{bytes} {usual}");
            assert_eq!(port.small_buffer().is_some(), bytes < BUFFER / 2);
        }
    }

    #[test]
    fn a_serial_port_is_read_and_written_and_found_again() {
        let other = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
        grantpt(&other).unwrap();
        unlockpt(&other).unwrap();
        let path = ptsname(&other, Vec::new()).unwrap().into_string().unwrap();
        let endpoint = format!("{path}:57600").parse().unwrap();
        let mut port =
            Port::open(&endpoint, true).unwrap_or_else(|_| panic!("{path} does not open"));
        let mut buffer = [0; 16];
        assert!(matches!(port.receive(&mut buffer), PortEvent::Nothing));
        // Bytes are unchanged: line ends are neither awaited nor converted, and nothing is echoed.
        rustix::io::write(&other, b"\xfd\n\r\x03\x04").unwrap();
        assert!(matches!(port.receive(&mut buffer), PortEvent::Bytes(5)));
        assert_eq!(&buffer[..5], b"\xfd\n\r\x03\x04");
        port.send(b"\xfe\n\x11");
        assert_eq!(rustix::io::read(&other, &mut buffer).unwrap(), 3);
        assert_eq!((&buffer[..3], port.unsent()), (&b"\xfe\n\x11"[..], 0));
        // The other end is disconnected.
        drop(other);
        let closed = (0..10).find_map(|_| match port.receive(&mut buffer) {
            PortEvent::Closed(why) => Some(why),
            _ => None,
        });
        assert!(closed.is_some());
        assert!(matches!(port.receive(&mut buffer), PortEvent::Nothing));
    }
}
