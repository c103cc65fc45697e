//! The web face of a running vehicle, as a client sees it.

use std::io::{BufRead, BufReader, Read};
use std::time::Instant;

use serde_json::Value;
use ureq::{Agent, Body, http::Response};

use crate::{DEADLINE, until};

/// A vehicle's address.
#[derive(Clone, Debug)]
pub struct Face {
    root: String,
    agent: Agent,
}

/// One answer.
#[derive(Debug)]
pub struct Answer {
    /// HTTP status.
    pub status: u16,
    /// Media type.
    pub media_type: String,
    /// Everything after the headers.
    pub body: Vec<u8>,
}

impl Face {
    /// The face at `root`, as in `http://127.0.0.1:8080`.
    #[must_use]
    pub fn at(root: &str) -> Self {
        let config =
            Agent::config_builder().http_status_as_error(false).timeout_global(Some(DEADLINE)).build();
        Self { root: root.trim_end_matches('/').to_owned(), agent: config.into() }
    }

    /// Host and port.
    #[must_use]
    pub fn address(&self) -> &str {
        self.root.trim_start_matches("http://")
    }

    /// Waits until somebody listens: a page's address is known before its program serves it.
    ///
    /// # Panics
    /// When nobody ever does.
    #[must_use]
    pub fn once_reachable(self) -> Self {
        until("somebody listens", || self.agent.get(format!("{}/livez", self.root)).call().ok());
        self
    }

    /// Asks for a path.
    ///
    /// # Panics
    /// When nobody answers.
    #[must_use]
    pub fn get(&self, path: &str) -> Answer {
        let mut response = self.open(path);
        let media_type = response.body().mime_type().unwrap_or_default().to_owned();
        let body = response.body_mut().read_to_vec().unwrap_or_else(|error| panic!("GET {path}: {error}"));
        Answer { status: response.status().as_u16(), media_type, body }
    }

    /// Asks for a JSON document.
    ///
    /// # Panics
    /// When the answer is none, or an error.
    #[must_use]
    pub fn json(&self, path: &str) -> Value {
        let answer = self.get(path);
        assert_eq!(answer.status, 200, "GET {path}: {}", String::from_utf8_lossy(&answer.body));
        serde_json::from_slice(&answer.body).unwrap_or_else(|error| panic!("GET {path}: {error}"))
    }

    /// Asks for something to be done, and returns the status of the answer.
    ///
    /// # Panics
    /// When nobody answers.
    #[must_use]
    pub fn post(&self, path: &str) -> u16 {
        let answer = self.agent.post(format!("{}{path}", self.root)).send_empty();
        answer.unwrap_or_else(|error| panic!("POST {path}: {error}")).status().as_u16()
    }

    /// Asks for a document again with every event of the vehicle until it satisfies `wanted`.
    ///
    /// # Panics
    /// When it never does.
    pub fn json_once(&self, path: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        let deadline = Instant::now() + DEADLINE;
        let mut document = self.json(path);
        let mut events = BufReader::new(self.stream("/api/v1/events")).lines();
        while !wanted(&document) {
            assert!(Instant::now() < deadline, "GET {path} stays at {document:#}");
            let event = events.next().unwrap_or_else(|| panic!("events ended; GET {path} was {document:#}"));
            if event.unwrap_or_else(|error| panic!("events: {error}")).is_empty() {
                document = self.json(path);
            }
        }
        document
    }

    /// Asks for a document of a vehicle without events again and again until it satisfies `wanted`.
    ///
    /// # Panics
    /// When it never does.
    pub fn polled(&self, path: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        until(path, || Some(self.json(path)).filter(&wanted))
    }

    /// Asks again and again whether the vehicle is ready, until the answer, of whatever status, satisfies `wanted`.
    ///
    /// # Panics
    /// When it never does.
    pub fn readiness_once(&self, wanted: impl Fn(&Value) -> bool) -> Value {
        until("/readyz", || serde_json::from_slice(&self.get("/readyz").body).ok().filter(&wanted))
    }

    /// Begins to read an answer without end.
    ///
    /// # Panics
    /// When nobody answers.
    pub fn stream(&self, path: &str) -> impl Read + use<> {
        self.open(path).into_body().into_reader()
    }

    fn open(&self, path: &str) -> Response<Body> {
        let asked = self.agent.get(format!("{}{path}", self.root)).call();
        asked.unwrap_or_else(|error| panic!("GET {}{path}: {error}", self.root))
    }
}
