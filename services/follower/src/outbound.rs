//! Messages of this vehicle on their way out: encoded, numbered, stamped with the attachment.

use waymark_proto::attachment::Stamper;
use waymark_proto::payload::WireMessage;
use zenoh::Session;
use zenoh::bytes::Encoding;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority, Reliability};

use crate::error::FollowerError;

/// A publisher of one kind of message on one key. Nothing waits on a peer: what cannot be sent is dropped, and the
/// receiver sees the gap.
pub(crate) struct Outbound {
    publisher: Publisher<'static>,
    stamper: Stamper,
}

impl Outbound {
    /// Declares a publisher of `M`.
    pub(crate) async fn declare<M: WireMessage>(
        session: &Session,
        key: String,
        reliability: Reliability,
        priority: Priority,
    ) -> Result<Self, FollowerError> {
        let publisher = session
            .declare_publisher(key)
            .encoding(Encoding::from(M::encoding()))
            .congestion_control(CongestionControl::Drop)
            .priority(priority)
            .reliability(reliability)
            .await
            .map_err(FollowerError::zenoh("declaring a publisher"))?;
        Ok(Self { publisher, stamper: Stamper::new(uuid::Uuid::new_v4().into_bytes()) })
    }

    /// Sends an encoded message and returns its number; without a session it is lost, and the gap will show.
    pub(crate) async fn put(&self, payload: Vec<u8>, source_time_ns: i64) -> i64 {
        let attachment = self.stamper.stamp(source_time_ns);
        if let Err(error) = self.publisher.put(payload).attachment(attachment.to_bytes().as_slice()).await {
            tracing::debug!(%error, key = %self.publisher.key_expr(), "not sent");
        }
        attachment.sequence
    }
}
