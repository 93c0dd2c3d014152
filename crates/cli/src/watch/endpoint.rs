//! Endpoints, from which packets are received: `udpin:0.0.0.0:14550`, `tcp:127.0.0.1:5760`,
//! `/dev/ttyACM0:57600`.

use std::{fmt, str::FromStr};

/// The default baud rate of a serial port, which telemetry radios commonly use.
const BAUD: u32 = 57_600;

/// An address at which a vehicle can be received.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Endpoint {
    /// Receive datagrams at an address.
    UdpIn(String),
    /// Send datagrams to an address, and receive answers.
    UdpOut(String),
    /// Connect to an address.
    Tcp(String),
    /// Wait for a connection at an address.
    TcpIn(String),
    /// Open a serial port.
    Serial { path: String, baud: u32 },
}

impl FromStr for Endpoint {
    type Err = String;

    fn from_str(text: &str) -> Result<Endpoint, String> {
        let socket = text.split_once(':').and_then(|(kind, address)| {
            let address = address.to_owned();
            match kind {
                "udpin" => Some(Endpoint::UdpIn(address)),
                "udpout" => Some(Endpoint::UdpOut(address)),
                "tcp" => Some(Endpoint::Tcp(address)),
                "tcpin" => Some(Endpoint::TcpIn(address)),
                _ => None,
            }
        });
        if let Some(endpoint) = socket {
            if let Some((kind, address)) = text.split_once("://") {
                return Err(format!("write `{kind}:{address}`, without `//`"));
            }
            let port = text.rsplit_once(':').map(|(_, port)| port.parse::<u16>());
            return match (port, text.matches(':').count()) {
                (Some(Ok(_)), 2..) => Ok(endpoint),
                (Some(Ok(port)), _) if text.starts_with("udpin:") || text.starts_with("tcpin:") => {
                    let (kind, _) = text.split_once(':').unwrap_or_default();
                    Err(format!(
                        "to listen on a port, write `{kind}:0.0.0.0:{port}`"
                    ))
                }
                _ => Err(format!(
                    "`{text}` has no address with a port from 0 to 65535, such as `127.0.0.1:14550`"
                )),
            };
        }
        if std::path::Path::new(text).is_file() {
            return Err(format!("`{text}` is a file: `flagred assess {text}`"));
        }
        let (path, baud) = match text.rsplit_once(':') {
            Some((path, baud)) => {
                let baud = baud.parse().ok().filter(|baud| *baud > 0);
                (path, baud.ok_or_else(|| unknown(text))?)
            }
            None => (text, BAUD),
        };
        if path.starts_with('/') || path.to_ascii_uppercase().starts_with("COM") {
            return Ok(Endpoint::Serial {
                path: path.to_owned(),
                baud,
            });
        }
        Err(unknown(text))
    }
}

fn unknown(text: &str) -> String {
    // For example `14550`, `udp:14550` and `udp://:14550`.
    let port = text
        .rsplit(':')
        .next()
        .and_then(|port| port.parse::<u16>().ok());
    let before = text.rsplit_once(':').map_or("", |(before, _)| before);
    if let Some(port) = port
        .filter(|_| ["", "udp", "udp:", "udp://", "udp:0.0.0.0", "udp://0.0.0.0"].contains(&before))
    {
        return format!("to listen on a port, write `udpin:0.0.0.0:{port}`");
    }
    format!(
        "`{text}` is not an endpoint: write `udpin:`, `udpout:`, `tcp:` or `tcpin:` and an address with a port, or a serial port such as `/dev/ttyACM0:57600`"
    )
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Endpoint::UdpIn(address) => write!(f, "udpin:{address}"),
            Endpoint::UdpOut(address) => write!(f, "udpout:{address}"),
            Endpoint::Tcp(address) => write!(f, "tcp:{address}"),
            Endpoint::TcpIn(address) => write!(f, "tcpin:{address}"),
            Endpoint::Serial { path, baud } => write!(f, "{path}:{baud}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints_are_read_as_they_are_written() {
        for text in [
            "udpin:0.0.0.0:14550",
            "udpout:[::1]:14550",
            "tcp:localhost:5760",
            "tcpin:0.0.0.0:5760",
            "/dev/ttyACM0:115200",
            "COM3:57600",
        ] {
            assert_eq!(text.parse::<Endpoint>().unwrap().to_string(), text);
        }
        let serial = "/dev/ttyUSB0".parse::<Endpoint>().unwrap();
        assert_eq!(serial.to_string(), "/dev/ttyUSB0:57600");
    }

    #[test]
    fn invalid_endpoints_are_reported() {
        for text in [
            "",
            "14550",
            "udpin:14550",
            "tcp:host:port",
            "udp:1.2.3.4:5",
            "/dev/x:0",
        ] {
            assert!(text.parse::<Endpoint>().is_err(), "{text}");
        }
    }
}
