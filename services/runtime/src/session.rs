//! The Zenoh session: how a process reaches the others.

use std::path::PathBuf;
use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use zenoh::{Config, Session};

use crate::link_trouble;

/// A process's place in the Zenoh network.
///
/// A vehicle's processes are routers that usually listen nowhere: unlike clients they start whether or not anybody can
/// be reached, and unlike peers they hear of each other through a router between them, which counts on peers being
/// connected directly (Zenoh 1.10, "regions").
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
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

/// Zenoh's words without the place in its own source that it ends them with.
fn words(error: &zenoh::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at ") {
        Some((words, place)) if place.contains(".rs:") => words.to_owned(),
        _ => text,
    }
}

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
        reason: String,
    },
    /// The JSON5 file cannot be used.
    #[error("the Zenoh configuration {path}: {reason}")]
    File {
        /// The file.
        path: PathBuf,
        /// Zenoh's words.
        reason: String,
    },
    /// The session did not open.
    #[error("no Zenoh session ({place}): {reason}; is the router running, and does it listen there?")]
    Open {
        /// Where it was to connect and listen.
        place: String,
        /// Zenoh's words.
        reason: String,
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

    /// Looks whether Zenoh takes these settings, without opening anything.
    ///
    /// # Errors
    /// The setting or file that it does not take.
    pub fn check(&self) -> Result<(), SessionError> {
        self.zenoh_config().map(drop)
    }

    /// Opens the session.
    ///
    /// # Errors
    /// When a setting is not accepted, an endpoint cannot be listened on, or a client does not reach its router in
    /// time. Routers and peers open whether or not anybody is there.
    pub async fn open(&self) -> Result<Session, SessionError> {
        self.opened(self.zenoh_config()?).await
    }

    async fn opened(&self, config: Config) -> Result<Session, SessionError> {
        let timeout = self.open_timeout();
        // Zenoh keeps the time itself where it waits for a router; this is for whatever else takes long.
        match tokio::time::timeout(timeout + Duration::from_secs(1), zenoh::open(config)).await {
            Ok(Ok(session)) => Ok(session),
            Ok(Err(error)) => {
                let reason = link_trouble::newest().unwrap_or_else(|| words(&error));
                Err(SessionError::Open { place: self.place(), reason })
            }
            Err(_) => Err(SessionError::Timeout { place: self.place(), timeout_s: timeout.as_secs_f64() }),
        }
    }

    /// Opens a session that takes the same way to the others and only looks around: a client, which listens nowhere
    /// and so does not get in the way of the service with these settings.
    ///
    /// # Errors
    /// As [`Self::open`], and when nobody can be reached.
    pub async fn visit(&self) -> Result<Session, SessionError> {
        let mut config = self.zenoh_config()?;
        let timeout_ms = i64::try_from(self.open_timeout().as_millis()).unwrap_or(i64::MAX);
        for (key, value) in [
            // A list, or one for each mode: taken before the mode is another.
            ("connect/endpoints", endpoints_of_own_mode(&config)),
            ("mode", json(&"client")),
            ("connect/timeout_ms", json(&timeout_ms)),
            ("connect/exit_on_failure", json(&true)),
            ("listen/endpoints", json(&[""; 0])),
        ] {
            config.insert_json5(key, &value).map_err(|error| SessionError::Setting {
                setting: "file",
                value,
                reason: words(&error),
            })?;
        }
        self.opened(config).await
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
                .map_err(|error| SessionError::File { path: path.clone(), reason: words(&error) });
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
            config.insert_json5(key, &value).map_err(|error| SessionError::Setting {
                setting,
                value,
                reason: words(&error),
            })?;
        }
        Ok(config)
    }
}

/// The endpoints to connect to, where a configuration may name others for each mode.
fn endpoints_of_own_mode(config: &Config) -> String {
    let read = |key: &str| {
        let text = config.get_json(key).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or(serde_json::Value::Null)
    };
    let (mode, endpoints) = (read("mode"), read("connect/endpoints"));
    let of_mode = endpoints.get(mode.as_str().unwrap_or("peer")).unwrap_or(&endpoints);
    if of_mode.is_array() { of_mode.to_string() } else { json(&[""; 0]) }
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
    fn a_visitor_takes_the_endpoints_of_the_mode_that_it_stands_in_for() {
        let endpoints = |connect: &str| {
            let text = format!("{{ mode: 'router', connect: {{ endpoints: {connect} }} }}");
            endpoints_of_own_mode(&Config::from_json5(&text).unwrap())
        };
        assert_eq!(endpoints("['tcp/127.0.0.1:1']"), r#"["tcp/127.0.0.1:1"]"#);
        assert_eq!(
            endpoints("{ router: ['tcp/127.0.0.1:2'], client: ['tcp/127.0.0.1:3'] }"),
            r#"["tcp/127.0.0.1:2"]"#
        );
        assert_eq!(endpoints("{ client: ['tcp/127.0.0.1:3'] }"), "[]");
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
