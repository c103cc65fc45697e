//! Why Zenoh does not reach whom it should connect to. It tries again and again, and says why it failed nowhere but in
//! its log; so this listens there.

use std::fmt;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use tracing::field::{Field, Visit};
use tracing::{Event, Subscriber, dispatcher};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;

/// The part of Zenoh that connects.
pub(crate) const SPEAKER: &str = "zenoh::net::runtime::orchestrator";

/// How Zenoh begins what is of interest here.
const FAILED: &str = "Unable to connect to ";

/// An attempt older than this says nothing about now: Zenoh makes one every few seconds.
const NEWS_FOR: Duration = Duration::from_secs(15);

/// What each refusal means, and what to do about it; the first that is contained in Zenoh's words counts.
const MEANINGS: [(&str, &str); 9] = [
    (
        "invalid peer certificate: UnknownIssuer",
        "the certificate there is not signed by our root_ca_certificate",
    ),
    ("invalid peer certificate: Expired", "the certificate there has expired, or a clock is wrong"),
    ("invalid peer certificate: NotValidForName", "the certificate there is for another host name"),
    ("fatal alert: UnknownCA", "our certificate is not accepted there: another authority signed it"),
    ("fatal alert: CertificateExpired", "our certificate has expired, or a clock is wrong"),
    (
        "fatal alert: CertificateRequired",
        "a certificate is wanted there: set connect_certificate and enable_mtls",
    ),
    ("fatal alert: HandshakeFailure", "no certificate of ours is accepted there"),
    ("Connection refused", "nobody listens there; is the router running?"),
    ("No route to host", "there is no way there"),
];

/// Where an attempt of this process to connect failed in the last seconds and why, in words for people; `None` when none
/// did, or logging was not started.
#[must_use]
pub fn newest() -> Option<String> {
    dispatcher::get_default(|log| log.downcast_ref::<LinkTrouble>().and_then(LinkTrouble::newest))
}

/// What to say where no router is connected.
#[must_use]
pub fn no_router() -> String {
    match newest() {
        Some(trouble) => format!("no router is connected: {trouble}"),
        None => "no router is connected; is `waymark router` running where zenoh.connect says?".to_owned(),
    }
}

/// The part of a process's log that keeps the newest failed attempt to connect.
#[derive(Debug, Default)]
pub(crate) struct LinkTrouble {
    newest: Mutex<Option<(Instant, String)>>,
}

impl LinkTrouble {
    fn newest(&self) -> Option<String> {
        let newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        newest.as_ref().filter(|(at, _)| at.elapsed() < NEWS_FOR).map(|(_, words)| words.clone())
    }

    fn note(&self, said: &str) {
        if let Some(words) = explained(said) {
            *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Some((Instant::now(), words));
        }
    }
}

impl<S: Subscriber> Layer<S> for LinkTrouble {
    fn on_event(&self, event: &Event<'_>, _context: Context<'_, S>) {
        if event.metadata().target() == SPEAKER {
            event.record(&mut Message(self));
        }
    }
}

/// Hands on the text of an event.
struct Message<'a>(&'a LinkTrouble);

impl Visit for Message<'_> {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        if field.name() == "message" {
            self.0.note(&format!("{value:?}"));
        }
    }
}

/// Endpoint, meaning and Zenoh's own words of a failed attempt; `None` when `said` tells of something else.
fn explained(said: &str) -> Option<String> {
    let (endpoint, cause) = said.strip_prefix(FAILED)?.split_once("! ")?;
    let endpoint = endpoint.trim_start_matches("configured peer ");
    let cause = cause.split(" at /").next().unwrap_or(cause);
    let cause = cause.split(". Retry in").next().unwrap_or(cause).trim_end_matches('.');
    let meaning = MEANINGS.iter().find(|(sign, _)| cause.contains(sign)).map(|(_, meaning)| *meaning);
    Some(match meaning {
        Some(meaning) => format!("{endpoint}: {meaning} ({cause})"),
        None => format!("{endpoint}: {cause}"),
    })
}

#[cfg(test)]
mod tests {
    use tracing::Level;
    use tracing_subscriber::filter::Targets;
    use tracing_subscriber::layer::SubscriberExt;

    use super::*;

    #[test]
    fn the_reason_is_taken_from_what_zenoh_says() {
        let said = "Unable to connect to configured peer tls/10.0.0.1:7447! received fatal alert: CertificateExpired at \
                    /some/where/unicast.rs:226.. Retry in 200ms.";
        assert_eq!(
            explained(said).unwrap(),
            "tls/10.0.0.1:7447: our certificate has expired, or a clock is wrong (received fatal alert: CertificateExpired)"
        );
        let said = "Unable to connect to tcp/10.0.0.1:7447! Something new. Retry in 1s.";
        assert_eq!(explained(said).unwrap(), "tcp/10.0.0.1:7447: Something new");
        assert_eq!(explained("Successfully connected to configured peer tcp/10.0.0.1:7447"), None);
    }

    #[test]
    fn only_the_one_who_connects_is_listened_to() {
        assert_eq!(newest(), None, "nobody listens");
        let filter = Targets::new().with_target(SPEAKER, Level::DEBUG);
        let subscriber = tracing_subscriber::registry().with(LinkTrouble::default().with_filter(filter));
        tracing::subscriber::with_default(subscriber, || {
            tracing::debug!(target: "elsewhere", "Unable to connect to a! b");
            assert_eq!(newest(), None);
            tracing::debug!(target: SPEAKER, "Unable to connect to {}! {}", "a", "Connection refused");
            assert_eq!(
                newest().unwrap(),
                "a: nobody listens there; is the router running? (Connection refused)"
            );
        });
    }
}
