//! The Zenoh session: how a process reaches the others.

use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use zenoh::{Config, Session};

/// A process's place in the Zenoh network.
///
/// A vehicle's processes are routers that usually listen nowhere: unlike clients they start whether or not anybody can
/// be reached, and unlike peers they hear of each other through a router between them, which counts on peers being
/// connected directly (Zenoh 1.10, "regions").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Starts without waiting, connects to `connect` as soon as it can and again whenever it must, and routes between
    /// all who are connected to it.
    #[default]
    Router,
    /// Needs a router from the start; for short-lived commands.
    Client,
    /// Connects directly to other peers, without a router.
    Peer,
}

/// The `zenoh` part of a configuration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SessionSettings {
    /// Place in the network.
    pub mode: Mode,
    /// Endpoints to connect to, as in `tcp/127.0.0.1:7447`.
    pub connect: Vec<String>,
    /// Endpoints to accept connections on.
    pub listen: Vec<String>,
    /// Whether to look for others by multicast. Off: nothing is opened to a network that was not named.
    pub multicast: bool,
    /// How long opening may take, and how long a client looks for its router, in seconds.
    pub open_timeout_s: f64,
    /// A Zenoh configuration file (JSON5) to be used as it is, for TLS, users, access control and the rest; the
    /// settings above then have no effect.
    pub file: Option<PathBuf>,
}

impl Default for SessionSettings {
    fn default() -> Self {
        Self {
            mode: Mode::Router,
            connect: vec!["tcp/127.0.0.1:7447".to_owned()],
            listen: Vec::new(),
            multicast: false,
            open_timeout_s: 5.0,
            file: None,
        }
    }
}

/// The largest message accepted from the network, in bytes: the largest picture, and room for its message. Zenoh's
/// own limit is 1 GiB.
const MAX_MESSAGE_BYTES: usize = 17 << 20;

/// How long a connection may be silent until it counts as lost, and everything behind it as gone.
pub const LEASE: Duration = Duration::from_secs(10);

/// How long one attempt to connect may take. Where nothing answers, not even a refusal, the system sends its requests
/// at growing intervals, and only a new attempt begins anew: this bounds how late a healed link is noticed.
const ATTEMPT: Duration = Duration::from_secs(3);

/// Zenoh's word for a connection that is tried for as long as the session lives.
const FOR_EVER: i64 = -1;

/// Why there is no session.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// A setting that Zenoh does not accept.
    #[error("zenoh.{setting} is {value}: {reason}")]
    Setting {
        /// Which.
        setting: &'static str,
        /// Its value.
        value: String,
        /// Zenoh's words.
        reason: zenoh::Error,
    },
    /// The JSON5 file cannot be used.
    #[error("the Zenoh configuration {path}: {reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// Zenoh's words.
        reason: zenoh::Error,
    },
    /// The session did not open.
    #[error("no Zenoh session ({place}): {reason}; is the router running, and does it listen there?")]
    Open {
        /// Where it was to connect and listen.
        place: String,
        /// Zenoh's words.
        reason: zenoh::Error,
    },
    /// Opening took too long.
    #[error(
        "no Zenoh session ({place}) within {timeout_s} s; is the router running, and does it listen there?"
    )]
    Timeout {
        /// Where it was to connect and listen.
        place: String,
        /// The time allowed.
        timeout_s: f64,
    },
}

impl SessionSettings {
    /// A router that listens on `listen` and connects to nobody.
    #[must_use]
    pub fn router(listen: &str) -> Self {
        Self { connect: Vec::new(), listen: vec![listen.to_owned()], ..Self::default() }
    }

    /// A service of a vehicle whose router is, or will be, at `router`.
    #[must_use]
    pub fn vehicle(router: &str) -> Self {
        Self { connect: vec![router.to_owned()], ..Self::default() }
    }

    /// A client of the router at `router`.
    #[must_use]
    pub fn client(router: &str) -> Self {
        Self { mode: Mode::Client, ..Self::vehicle(router) }
    }

    /// Opens the session.
    ///
    /// # Errors
    /// When a setting is not accepted, an endpoint cannot be listened on, or a client does not reach its router in
    /// time. Routers and peers open whether or not anybody is there.
    pub async fn open(&self) -> Result<Session, SessionError> {
        let config = self.zenoh_config()?;
        let timeout = self.open_timeout();
        // Zenoh keeps the time itself where it waits for a router; this is for whatever else takes long.
        match tokio::time::timeout(timeout + Duration::from_secs(1), zenoh::open(config)).await {
            Ok(Ok(session)) => Ok(session),
            Ok(Err(reason)) => Err(SessionError::Open { place: self.place(), reason }),
            Err(_) => Err(SessionError::Timeout { place: self.place(), timeout_s: timeout.as_secs_f64() }),
        }
    }

    fn open_timeout(&self) -> Duration {
        Duration::from_secs_f64(self.open_timeout_s.clamp(0.1, 3600.0))
    }

    fn place(&self) -> String {
        match &self.file {
            Some(file) => format!("as {} says", file.display()),
            None => format!("connecting to {:?}, listening on {:?}", self.connect, self.listen),
        }
    }

    fn zenoh_config(&self) -> Result<Config, SessionError> {
        if let Some(path) = &self.file {
            return Config::from_file(path)
                .map_err(|reason| SessionError::File { path: path.clone(), reason });
        }
        let mode = match self.mode {
            Mode::Client => "client",
            Mode::Peer => "peer",
            Mode::Router => "router",
        };
        let connect_timeout_ms = match self.mode {
            Mode::Client => i64::try_from(self.open_timeout().as_millis()).unwrap_or(i64::MAX),
            Mode::Peer | Mode::Router => FOR_EVER,
        };
        let mut config = Config::default();
        for (setting, key, value) in [
            ("mode", "mode", json(&mode)),
            ("connect", "connect/endpoints", json(&self.connect)),
            ("open_timeout_s", "connect/timeout_ms", json(&connect_timeout_ms)),
            ("connect", "connect/exit_on_failure", json(&(self.mode == Mode::Client))),
            // Found again within the second after a router's restart.
            ("connect", "connect/retry", r#"{"period_init_ms":200,"period_max_ms":1000}"#.to_owned()),
            ("listen", "listen/endpoints", json(&self.listen)),
            ("multicast", "scouting/multicast/enabled", json(&self.multicast)),
            ("multicast", "scouting/gossip/enabled", json(&self.multicast)),
            ("connect", "transport/unicast/open_timeout", json(&ATTEMPT.as_millis())),
            ("mode", "transport/link/tx/lease", json(&LEASE.as_millis())),
            ("mode", "transport/link/rx/max_message_size", json(&MAX_MESSAGE_BYTES)),
        ] {
            config.insert_json5(key, &value).map_err(|reason| SessionError::Setting {
                setting,
                value,
                reason,
            })?;
        }
        Ok(config)
    }
}

/// Whether a router is connected at this moment.
pub async fn is_router_connected(session: &Session) -> bool {
    session.info().routers_zid().await.next().is_some()
}

fn json<T: Serialize>(value: &T) -> String {
    serde_json::json!(value).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_that_zenoh_does_not_know_are_named() {
        let settings = SessionSettings { connect: vec!["nowhere".into()], ..SessionSettings::default() };
        let error = settings.zenoh_config().unwrap_err().to_string();
        assert!(error.starts_with("zenoh.connect is [\"nowhere\"]"), "{error}");
    }

    #[test]
    fn a_missing_file_is_named() {
        let settings = SessionSettings { file: Some("no-such.json5".into()), ..SessionSettings::default() };
        let error = settings.zenoh_config().unwrap_err().to_string();
        assert!(error.contains("no-such.json5"), "{error}");
    }

    #[test]
    fn the_file_is_taken_as_it_is() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("zenoh.json5");
        std::fs::write(&path, "{ mode: 'router', listen: { endpoints: ['tcp/127.0.0.1:1'] } }").unwrap();
        let settings = SessionSettings { file: Some(path), ..SessionSettings::default() };
        let config = settings.zenoh_config().unwrap();
        assert_eq!(config.get_json("mode").unwrap(), "\"router\"");
        assert!(config.get_json("listen/endpoints").unwrap().contains("127.0.0.1:1"));
    }
}
