//! Answers to queries that never wait for the one who asked.
//!
//! Zenoh sends a reply the way its query was sent, and queries block by default: one querier that has stopped reading
//! would then hold up everybody behind the same router for seconds. A whole sample as the reply keeps its own way.

use zenoh::Wait as _;
use zenoh::bytes::{Encoding, ZBytes};
use zenoh::key_expr::KeyExpr;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::Query;
use zenoh::sample::SampleBuilder;

/// One answer.
#[derive(Clone, Debug)]
pub struct Answer {
    /// What it answers for; must match the query's key expression.
    pub key: KeyExpr<'static>,
    /// The content.
    pub payload: ZBytes,
    /// What the content is.
    pub encoding: Encoding,
    /// What travels beside it.
    pub attachment: Option<ZBytes>,
}

/// Sends `answer`, or drops it where there is no room; whoever asked asks again.
pub fn reply(query: &Query, answer: Answer) {
    let sample = SampleBuilder::put(answer.key, answer.payload)
        .encoding(answer.encoding)
        .attachment(answer.attachment)
        .congestion_control(CongestionControl::Drop)
        .priority(Priority::InteractiveHigh);
    if let Err(error) = query.reply_sample(sample.into()).wait() {
        tracing::debug!(%error, "an answer could not be sent");
    }
}
