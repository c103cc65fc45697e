//! Everyone who is there, with their clocks.

use std::collections::BTreeMap;

use zenoh::Session;

use super::{ANSWER_TIMEOUT, CLOCK_EXCHANGES, Introduction, ask};
use crate::clock::{ClockOffset, Exchange, best_offset};

/// A process that is announced.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Key expression of this process alone.
    pub key: String,
    /// What it answered; `None` when its token is there and it does not answer: stopped, cut off, or just gone.
    pub introduction: Option<Introduction>,
    /// How far its clock is off.
    pub clock: Option<ClockOffset>,
}

/// Everyone who is announced at `key_expression`, in the order of their keys, with what they answer and the offsets of
/// their clocks. Takes some round trips, and some seconds where somebody who is announced does not answer.
///
/// # Errors
/// When Zenoh refuses a query.
pub async fn members(session: &Session, key_expression: &str) -> zenoh::Result<Vec<Member>> {
    let mut heard: BTreeMap<String, (Option<Introduction>, Vec<Exchange>)> = BTreeMap::new();
    let tokens = session.liveliness().get(key_expression).timeout(ANSWER_TIMEOUT).await?;
    while let Ok(reply) = tokens.recv_async().await {
        let Ok(token) = reply.into_result() else { continue };
        heard.entry(token.key_expr().to_string()).or_default();
    }
    for _ in 0..CLOCK_EXCHANGES {
        for answer in ask(session, key_expression).await? {
            let (introduction, exchanges) = heard.entry(answer.key).or_default();
            *introduction = Some(answer.introduction);
            exchanges.push(answer.exchange);
        }
    }
    let member =
        |(key, (introduction, exchanges))| Member { key, introduction, clock: best_offset(exchanges) };
    Ok(heard.into_iter().map(member).collect())
}
