//! Whether the leader is there, and when it was last heard.

use runtime::presence::TokenWatch;
use runtime::session::LEASE;
use waymark_proto::keys::{PresenceKey, Role, VehicleKeys};
use zenoh::Session;

use crate::error::FollowerError;
use crate::fleet_watch::FleetWatch;
use crate::landmark_feed::LastHeard;
use crate::status::{ClockStatus, LeaderStatus};

/// Watches the liveliness tokens of one vehicle in the role of leader.
pub(crate) struct LeaderWatch {
    vehicle: String,
    tokens: TokenWatch,
    last_heard: LastHeard,
    fleet: FleetWatch,
}

impl LeaderWatch {
    /// Begins to watch.
    pub(crate) async fn begin(
        session: &Session,
        leader: &VehicleKeys,
        last_heard: LastHeard,
        fleet: FleetWatch,
    ) -> Result<Self, FollowerError> {
        let key = PresenceKey::of_role(leader.fleet(), leader.vehicle(), Role::Leader);
        let watching = TokenWatch::begin(session, &key).await;
        let tokens = watching.map_err(FollowerError::zenoh("watching for the leader"))?;
        Ok(Self { vehicle: leader.vehicle().to_string(), tokens, last_heard, fleet })
    }

    /// Everyone in the fleet, the leader among them.
    pub(crate) fn fleet(&self) -> &FleetWatch {
        &self.fleet
    }

    /// A token outlives its process where that has only stopped, and a manifest comes every second: whoever was not
    /// heard for a lease is gone, whatever its token says.
    pub(crate) fn status(&self) -> LeaderStatus {
        let heard = *self.last_heard.borrow();
        let silent = heard.is_some_and(|heard| heard.at.elapsed() > LEASE);
        LeaderStatus {
            vehicle: self.vehicle.clone(),
            present: !silent && !self.tokens.tokens().borrow().is_empty(),
            age_s: heard.map(|heard| heard.at.elapsed().as_secs_f64()),
            clock: self.fleet.clock(&self.vehicle, Role::Leader).map(ClockStatus::from),
            missed: heard.and_then(|heard| heard.missed),
        }
    }
}
