//! Whether the ports that a service wants are free, or taken by that very service.

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::time::Duration;

use serde_json::Value;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;

use super::finding::Finding;
use super::subject::Subject;

const ANSWER_WITHIN: Duration = Duration::from_secs(2);
/// A status is some kilobytes.
const MOST_BYTES: u64 = 1 << 20;

/// Who has a port.
enum Holder {
    /// Nobody.
    Free,
    /// The service that is examined, which runs already.
    Itself {
        /// Its version.
        version: String,
    },
    /// Something else.
    Other,
    /// It cannot be had at all.
    Refused(io::Error),
}

pub(super) async fn examine(subject: &Subject) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut runs = false;
    if let Some(page) = subject.page {
        let holder = holder(page, subject).await;
        runs = matches!(holder, Holder::Itself { .. });
        findings.push(judged(format!("port of the page, {page}"), &holder, "http.listen"));
    }
    for address in subject.zenoh.listen.iter().filter_map(|endpoint| tcp_address(endpoint)) {
        let check = format!("port of Zenoh, {address}");
        findings.push(match bind(address) {
            Holder::Other if runs => Finding::yes(check, "taken, as this service runs"),
            holder => judged(check, &holder, "zenoh.listen"),
        });
    }
    if findings.is_empty() {
        findings.push(Finding::not_applicable("ports", format!("this {} listens nowhere", subject.role())));
    }
    findings
}

fn judged(check: String, holder: &Holder, setting: &str) -> Finding {
    match holder {
        Holder::Free => Finding::yes(check, "free"),
        Holder::Itself { version } => {
            Finding::yes(check, format!("this service runs there, version {version}"))
        }
        Holder::Other => {
            let remedy =
                format!("stop what listens there (`ss -ltnp` shows it), or set {setting} to another port");
            Finding::no(check, "taken by another program", remedy)
        }
        Holder::Refused(error) => {
            let remedy = format!("set {setting} to an address of this machine and a port above 1023");
            Finding::no(check, error.to_string(), remedy)
        }
    }
}

async fn holder(address: SocketAddr, subject: &Subject) -> Holder {
    match bind(address) {
        Holder::Other => {}
        known => return known,
    }
    let Ok(Some(status)) = timeout(ANSWER_WITHIN, status(address)).await else { return Holder::Other };
    let is_itself = status["vehicle"] == subject.keys.vehicle().as_str() && status["role"] == subject.role();
    match status["version"].as_str() {
        Some(version) if is_itself => Holder::Itself { version: version.to_owned() },
        _ => Holder::Other,
    }
}

fn bind(address: SocketAddr) -> Holder {
    match TcpListener::bind(address) {
        Ok(_released) => Holder::Free,
        Err(error) if error.kind() == io::ErrorKind::AddrInUse => Holder::Other,
        Err(error) => Holder::Refused(error),
    }
}

/// What answers there says of itself, where it is one of ours.
async fn status(address: SocketAddr) -> Option<Value> {
    let mut stream = TcpStream::connect(reachable(address)).await.ok()?;
    stream
        .write_all(b"GET /api/v1/status HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        .await
        .ok()?;
    let mut answer = Vec::new();
    stream.take(MOST_BYTES).read_to_end(&mut answer).await.ok()?;
    let answer = String::from_utf8(answer).ok()?;
    let (_head, body) = answer.split_once("\r\n\r\n")?;
    serde_json::from_str(body).ok()
}

/// Where to call what listens on every address of this machine.
fn reachable(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => Ipv4Addr::LOCALHOST.into(),
        IpAddr::V6(ip) if ip.is_unspecified() => Ipv6Addr::LOCALHOST.into(),
        ip => ip,
    };
    (ip, address.port()).into()
}

/// The address of an endpoint over TCP, as in `tls/0.0.0.0:7447?…`; `None` for other links and for names.
fn tcp_address(endpoint: &str) -> Option<SocketAddr> {
    let (protocol, rest) = endpoint.split_once('/')?;
    let address = rest.split(['?', '#']).next()?;
    matches!(protocol, "tcp" | "tls").then(|| address.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_from_endpoints() {
        let address = |endpoint| tcp_address(endpoint).map(|address| address.to_string());
        assert_eq!(address("tcp/0.0.0.0:7447"), Some("0.0.0.0:7447".into()));
        assert_eq!(address("tls/[::1]:7447?rel=1#key=value"), Some("[::1]:7447".into()));
        assert_eq!(address("udp/0.0.0.0:7447"), None);
        assert_eq!(address("tcp/router:7447"), None);
    }

    #[test]
    fn every_address_is_called_on_the_loopback() {
        assert_eq!(reachable(([0, 0, 0, 0], 1).into()), ([127, 0, 0, 1], 1).into());
        assert_eq!(reachable(([10, 0, 0, 7], 1).into()), ([10, 0, 0, 7], 1).into());
    }
}
