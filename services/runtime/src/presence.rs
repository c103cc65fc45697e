//! One process for each vehicle and role.
//!
//! A process that starts answers at once who it is, and asks whether others of its vehicle and role do the same. It
//! gives way to one that is established, that is, has been through this itself; of two that start together the one
//! with the earlier start, then with the smaller instance id, stays. One that does not answer is taken for dead,
//! whatever its liveliness token says: tokens outlive their process by a lease.
//!
//! An answer from the same machine is passed over. The caller holds that machine's state directory
//! ([`crate::StateDir`]), which the kernel gives to one process at a time: whoever answers from there has let go of
//! it and is about to end. So a restart takes over without waiting.
//!
//! Two that could not hear each other are both established. Once they can, each sees the other's token, and the rule
//! for two that start together decides who leaves: [`Presence::superseded`].

mod members;
mod tokens;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use zenoh::Session;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;
use zenoh::liveliness::LivelinessToken;
use zenoh::qos::CongestionControl;
use zenoh::query::{ConsolidationMode, Query, QueryTarget, Queryable};

use crate::clock::{ClockOffset, Exchange, best_offset};
use crate::identity::{Identity, unix_time_ns};
use crate::reply::{Answer, reply};
use crate::session::is_router_connected;
use crate::shutdown::Shutdown;
pub use tokens::TokenWatch;

pub use members::{Member, members};

/// How long others have to answer.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(1);
/// Times the question is put: it is sent with Drop, so it may be lost, and who has just connected does not know the
/// way to everybody at once.
const CLAIM_ROUNDS: usize = 3;
/// Pause between two questions.
const BETWEEN_ROUNDS: Duration = Duration::from_millis(100);
/// How long the first question waits for somebody to be connected; a vehicle starts without any.
const CONNECTED_WITHIN: Duration = Duration::from_secs(1);
/// How often a sibling that is announced and did not answer is asked again.
const ASK_SIBLINGS_EVERY: Duration = Duration::from_secs(5);
/// Exchanges that a clock offset is measured with.
const CLOCK_EXCHANGES: usize = 5;

/// Where a process is announced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PresencePlace {
    /// Key expression of this process alone, token and answer.
    pub own_key: String,
    /// Key expression of all processes of the same vehicle and role.
    pub siblings: String,
}

/// What a process answers when asked who it is (JSON).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Introduction {
    /// Names the process.
    pub instance: String,
    /// Names its machine.
    pub machine: String,
    /// The machine's name, for people.
    pub host: String,
    /// The operating system's number of the process.
    pub process: u32,
    /// The program's version.
    pub version: String,
    /// Its start, ns since the Unix epoch by its own clock.
    pub started_at_ns: i64,
    /// Whether it is past the question whether it may run.
    pub established: bool,
    /// When the question was received, ns since the Unix epoch by its own clock.
    pub received_at_ns: i64,
    /// When this was sent, likewise.
    pub answered_at_ns: i64,
}

/// Why a process may not run, or cannot ask.
#[derive(Debug, thiserror::Error)]
pub enum PresenceError {
    /// Another one is there.
    #[error(
        "{place} is already served by instance {} (process {} on {}, version {}): stop that one, or give this one \
         another vehicle id", .first.instance, .first.process, .first.host, .first.version
    )]
    AlreadyPresent {
        /// The key expression of vehicle and role.
        place: String,
        /// The one that is there.
        first: Box<Introduction>,
    },
    /// Zenoh refused a declaration or a query.
    #[error("presence cannot be announced at {place}: {reason}")]
    Zenoh {
        /// The key expression.
        place: String,
        /// Zenoh's words.
        reason: zenoh::Error,
    },
}

/// A process that is announced; it vanishes from the others' sight when this is dropped.
pub struct Presence {
    session: Session,
    place: PresencePlace,
    own: Introduction,
    /// Tokens of vehicle and role, this process's own among them.
    siblings: TokenWatch,
    _token: LivelinessToken,
    _answers: Queryable<()>,
}

impl Presence {
    /// Announces this process, unless another one of its vehicle and role is there.
    ///
    /// # Errors
    /// When another one is there, which the error names, or Zenoh refuses.
    pub async fn claim(
        session: &Session,
        place: &PresencePlace,
        identity: &Identity,
        version: &str,
    ) -> Result<Self, PresenceError> {
        let refused = |reason| PresenceError::Zenoh { place: place.own_key.clone(), reason };
        let established = Arc::new(AtomicBool::new(false));
        let own = introduction(identity, version);
        let answers =
            declare_answers(session, place, own.clone(), Arc::clone(&established)).await.map_err(refused)?;
        // Whoever is not connected by then starts alone, and may have to leave once it is.
        let _may_be_alone = tokio::time::timeout(CONNECTED_WITHIN, until_connected(session)).await;
        for round in 0..CLAIM_ROUNDS {
            if round > 0 {
                tokio::time::sleep(BETWEEN_ROUNDS).await;
            }
            if let Some(first) = first_before(session, place, &own).await.map_err(refused)? {
                let place = place.siblings.clone();
                return Err(PresenceError::AlreadyPresent { place, first: Box::new(first) });
            }
        }
        established.store(true, Ordering::Release);
        let token = session.liveliness().declare_token(&place.own_key).await.map_err(refused)?;
        let siblings = TokenWatch::begin(session, &place.siblings).await.map_err(refused)?;
        Ok(Self {
            session: session.clone(),
            place: place.clone(),
            own: Introduction { established: true, ..own },
            siblings,
            _token: token,
            _answers: answers,
        })
    }

    /// Runs `work`, which ends after `shutdown`, and requests that when this process has to give way to another one.
    /// Returns the other one as an error, if that is how it came.
    pub async fn hold<W: Future>(&self, work: W, shutdown: &Shutdown) -> (W::Output, Option<PresenceError>) {
        let mut work = std::pin::pin!(work);
        let first = tokio::select! {
            ended = &mut work => return (ended, None),
            first = self.superseded() => first,
        };
        tracing::warn!(%first, "ending");
        shutdown.request();
        (work.await, Some(first))
    }

    /// Completes when another established process of the same vehicle and role was met to which this one has to give
    /// way; the error names it. As long as there is none, this waits.
    pub async fn superseded(&self) -> PresenceError {
        let mut tokens = self.siblings.tokens();
        loop {
            let met = tokens.borrow_and_update().iter().any(|token| *token != self.place.own_key);
            if met {
                match first_before(&self.session, &self.place, &self.own).await {
                    Ok(Some(first)) => {
                        let place = self.place.siblings.clone();
                        return PresenceError::AlreadyPresent { place, first: Box::new(first) };
                    }
                    Ok(None) => {}
                    Err(error) => tracing::debug!(%error, "a sibling cannot be asked"),
                }
            }
            tokio::select! {
                Ok(()) = tokens.changed() => {}
                () = tokio::time::sleep(ASK_SIBLINGS_EVERY) => {}
            }
        }
    }
}

/// Nobody announces the moment at which a router is connected, so it is looked for again and again.
async fn until_connected(session: &Session) {
    while !is_router_connected(session).await {
        tokio::time::sleep(BETWEEN_ROUNDS).await;
    }
}

/// The sibling to which `own` has to give way, when there is one.
async fn first_before(
    session: &Session,
    place: &PresencePlace,
    own: &Introduction,
) -> zenoh::Result<Option<Introduction>> {
    let others = who_is_there(session, &place.siblings).await?;
    Ok(others.into_iter().find(|other| gives_way(own, other)))
}

/// Everyone who answers at `key_expression`.
///
/// # Errors
/// When Zenoh refuses the query.
pub async fn who_is_there(session: &Session, key_expression: &str) -> zenoh::Result<Vec<Introduction>> {
    Ok(ask(session, key_expression).await?.into_iter().map(|heard| heard.introduction).collect())
}

/// How far the clock of the process at `key_expression` is off; `None` when nobody answers.
///
/// # Errors
/// When Zenoh refuses the query.
pub async fn clock_offset(session: &Session, key_expression: &str) -> zenoh::Result<Option<ClockOffset>> {
    let mut exchanges = Vec::new();
    for _ in 0..CLOCK_EXCHANGES {
        exchanges.extend(ask(session, key_expression).await?.into_iter().map(|heard| heard.exchange));
    }
    Ok(best_offset(exchanges))
}

/// Whether `own` has to give way to `other`.
fn gives_way(own: &Introduction, other: &Introduction) -> bool {
    if other.instance == own.instance || other.machine == own.machine {
        return false;
    }
    if other.established != own.established {
        return other.established;
    }
    (other.started_at_ns, &other.instance) < (own.started_at_ns, &own.instance)
}

fn introduction(identity: &Identity, version: &str) -> Introduction {
    let host = rustix::system::uname().nodename().to_string_lossy().into_owned();
    Introduction {
        instance: identity.instance.clone(),
        machine: identity.machine.clone(),
        host,
        process: std::process::id(),
        version: version.to_owned(),
        started_at_ns: identity.started_at_ns,
        established: false,
        received_at_ns: 0,
        answered_at_ns: 0,
    }
}

async fn declare_answers(
    session: &Session,
    place: &PresencePlace,
    own: Introduction,
    established: Arc<AtomicBool>,
) -> zenoh::Result<Queryable<()>> {
    let key = KeyExpr::new(place.own_key.clone())?;
    session
        .declare_queryable(key.clone())
        .callback(move |query| {
            let received_at_ns = unix_time_ns();
            let established = established.load(Ordering::Acquire);
            introduce(&query, key.clone(), Introduction { established, received_at_ns, ..own.clone() });
        })
        .await
}

fn introduce(query: &Query, key: KeyExpr<'static>, mut own: Introduction) {
    own.answered_at_ns = unix_time_ns();
    let payload = serde_json::json!(own).to_string().into();
    reply(query, Answer { key, payload, encoding: Encoding::APPLICATION_JSON, attachment: None });
}

/// One answer.
struct Heard {
    key: String,
    introduction: Introduction,
    exchange: Exchange,
}

async fn ask(session: &Session, key_expression: &str) -> zenoh::Result<Vec<Heard>> {
    let asked_at_ns = unix_time_ns();
    let replies = session
        .get(key_expression)
        .target(QueryTarget::All)
        .consolidation(ConsolidationMode::None)
        .congestion_control(CongestionControl::Drop)
        .express(true)
        .timeout(ANSWER_TIMEOUT)
        .await?;
    let mut answers = Vec::new();
    while let Ok(reply) = replies.recv_async().await {
        let heard_at_ns = unix_time_ns();
        let Ok(sample) = reply.into_result() else { continue };
        match serde_json::from_slice::<Introduction>(&sample.payload().to_bytes()) {
            Ok(introduction) => {
                let Introduction { received_at_ns, answered_at_ns, .. } = introduction;
                let exchange = Exchange { asked_at_ns, received_at_ns, answered_at_ns, heard_at_ns };
                answers.push(Heard { key: sample.key_expr().to_string(), introduction, exchange });
            }
            Err(error) => {
                tracing::warn!(key = %sample.key_expr(), %error, "an introduction cannot be read");
            }
        }
    }
    Ok(answers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn process(instance: &str, started_at_ns: i64, established: bool) -> Introduction {
        Introduction {
            instance: instance.into(),
            machine: format!("machine of {instance}"),
            host: "host".into(),
            process: 1,
            version: "0".into(),
            started_at_ns,
            established,
            received_at_ns: 0,
            answered_at_ns: 0,
        }
    }

    #[test]
    fn an_established_process_stays_whatever_the_clocks_say() {
        assert!(gives_way(&process("a", 1, false), &process("b", 2, true)));
    }

    #[test]
    fn of_two_that_start_together_exactly_one_stays() {
        let early = process("b", 1, false);
        let late = process("a", 2, false);
        assert!(gives_way(&late, &early) && !gives_way(&early, &late));
        let (small, large) = (process("a", 1, false), process("b", 1, false));
        assert!(gives_way(&large, &small) && !gives_way(&small, &large));
    }

    #[test]
    fn of_two_established_ones_that_meet_the_earlier_stays_and_a_beginner_displaces_nobody() {
        let (early, late) = (process("b", 1, true), process("a", 2, true));
        assert!(gives_way(&late, &early) && !gives_way(&early, &late));
        assert!(!gives_way(&late, &process("c", 0, false)));
    }

    #[test]
    fn a_process_does_not_give_way_to_itself_or_to_its_own_past() {
        let own = process("a", 2, false);
        assert!(!gives_way(&own, &Introduction { established: true, ..own.clone() }));
        let past = Introduction { machine: own.machine.clone(), ..process("b", 1, true) };
        assert!(!gives_way(&own, &past));
    }
}
