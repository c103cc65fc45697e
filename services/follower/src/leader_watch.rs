//! Whether the leader is there, and when it was last heard.

use std::collections::BTreeSet;

use tokio::sync::watch;
use waymark_proto::keys::{PresenceKey, Role, VehicleKeys};
use zenoh::Session;
use zenoh::pubsub::Subscriber;
use zenoh::sample::SampleKind;

use crate::error::FollowerError;
use crate::landmark_feed::LastHeard;
use crate::status::LeaderStatus;

/// Watches the liveliness tokens of one vehicle in the role of leader.
pub(crate) struct LeaderWatch {
    vehicle: String,
    tokens: watch::Receiver<BTreeSet<String>>,
    last_heard: LastHeard,
    _subscriber: Subscriber<()>,
}

impl LeaderWatch {
    /// Begins to watch.
    pub(crate) async fn begin(
        session: &Session,
        leader: &VehicleKeys,
        last_heard: LastHeard,
    ) -> Result<Self, FollowerError> {
        let (sender, tokens) = watch::channel(BTreeSet::new());
        let key = PresenceKey::of_role(leader.fleet(), leader.vehicle(), Role::Leader);
        let subscriber = session
            .liveliness()
            .declare_subscriber(key)
            .history(true)
            .callback(move |sample| {
                let token = sample.key_expr().as_str().to_owned();
                sender.send_modify(|tokens| match sample.kind() {
                    SampleKind::Put => drop(tokens.insert(token)),
                    SampleKind::Delete => drop(tokens.remove(&token)),
                });
            })
            .await
            .map_err(FollowerError::zenoh("watching for the leader"))?;
        Ok(Self { vehicle: leader.vehicle().to_string(), tokens, last_heard, _subscriber: subscriber })
    }

    pub(crate) fn status(&self) -> LeaderStatus {
        LeaderStatus {
            vehicle: self.vehicle.clone(),
            present: !self.tokens.borrow().is_empty(),
            age_s: self.last_heard.borrow().map(|heard| heard.elapsed().as_secs_f64()),
        }
    }
}
