//! Everyone who is announced in the fleet, asked again and again: who they are, and how far their clocks are off.

use std::time::Duration;

use runtime::Shutdown;
use runtime::clock::ClockOffset;
use runtime::presence::{Introduction, members};
use tokio::sync::watch;
use tokio::time::sleep;
use waymark_proto::keys::{Id, PresenceKey, Role};
use waymark_proto::v1;
use zenoh::Session;

use crate::status::{ClockStatus, FleetMember, FleetStatus};

/// Clocks drift by some 50 µs a second at worst: half a millisecond between two questions.
const EVERY: Duration = Duration::from_secs(10);
/// A vehicle that is still alone may just not be connected yet.
const WHILE_ALONE_EVERY: Duration = Duration::from_secs(1);
/// More are neither recorded nor counted in the metrics, so that a stranger who announces thousands does no harm.
const MOST_MEMBERS: usize = 64;

/// A process as it was seen last.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Seen {
    key: PresenceKey,
    introduction: Option<Introduction>,
    clock: Option<ClockOffset>,
}

/// What is known of the fleet.
#[derive(Clone, Debug)]
pub(crate) struct FleetWatch {
    seen: watch::Receiver<Vec<Seen>>,
}

impl FleetWatch {
    /// The watch, and the work that keeps it up to date until shutdown.
    pub(crate) fn new(
        session: Session,
        fleet: &Id,
        shutdown: Shutdown,
    ) -> (Self, impl Future<Output = ()> + Send + 'static) {
        let (sender, seen) = watch::channel(Vec::new());
        (Self { seen }, keep_asking(session, PresenceKey::everyone(fleet), sender, shutdown))
    }

    /// Everyone, for people and programs.
    pub(crate) fn status(&self) -> FleetStatus {
        FleetStatus { members: self.seen.borrow().iter().map(Seen::status).collect() }
    }

    /// The clock of the vehicle's process in that role.
    pub(crate) fn clock(&self, vehicle: &str, role: Role) -> Option<ClockOffset> {
        let seen = self.seen.borrow();
        let found = seen.iter().find(|one| one.key.vehicle.as_str() == vehicle && one.key.role == role);
        found.and_then(|one| one.clock)
    }

    /// The measured clocks, for the recording.
    pub(crate) fn clocks(&self) -> Vec<v1::ClockOffset> {
        self.seen.borrow().iter().filter_map(Seen::to_wire).collect()
    }
}

async fn keep_asking(session: Session, everyone: String, seen: watch::Sender<Vec<Seen>>, shutdown: Shutdown) {
    loop {
        let asked = tokio::select! {
            () = shutdown.requested() => return,
            asked = ask(&session, &everyone) => asked,
        };
        match asked {
            Ok(members) => drop(seen.send_replace(members)),
            Err(error) => tracing::debug!(%error, "the fleet cannot be asked"),
        }
        let pause = if seen.borrow().len() > 1 { EVERY } else { WHILE_ALONE_EVERY };
        tokio::select! {
            () = shutdown.requested() => return,
            () = sleep(pause) => {}
        }
    }
}

async fn ask(session: &Session, everyone: &str) -> zenoh::Result<Vec<Seen>> {
    let members = members(session, everyone).await?;
    let seen = members.into_iter().filter_map(|member| {
        let key: PresenceKey = member.key.parse().ok()?;
        if !key.role.introduces_itself() {
            return None;
        }
        Some(Seen { key, introduction: member.introduction, clock: member.clock })
    });
    Ok(seen.take(MOST_MEMBERS).collect())
}

impl Seen {
    fn status(&self) -> FleetMember {
        let introduction = self.introduction.as_ref();
        FleetMember {
            vehicle: self.key.vehicle.to_string(),
            role: self.key.role.name(),
            instance: self.key.instance.to_string(),
            answers: introduction.is_some(),
            host: introduction.map(|it| it.host.clone()),
            version: introduction.map(|it| it.version.clone()),
            clock: self.clock.map(ClockStatus::from),
        }
    }

    fn to_wire(&self) -> Option<v1::ClockOffset> {
        let clock = self.clock?;
        Some(v1::ClockOffset {
            vehicle: self.key.vehicle.to_string(),
            role: self.key.role.name().to_owned(),
            instance: self.key.instance.to_string(),
            offset_ns: clock.offset_ns,
            round_trip_ns: clock.round_trip_ns,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_that_does_not_answer_is_listed_without_a_clock() {
        let key: PresenceKey = "@waymark/v1/rink/v2/leader/7f".parse().unwrap();
        let clock = Some(ClockOffset { offset_ns: -40_000_000, round_trip_ns: 2_000_000 });
        let known = Seen { key, introduction: None, clock };
        let silent = Seen { clock: None, ..known.clone() };
        let (_sender, seen) = watch::channel(vec![silent.clone()]);
        let fleet = FleetWatch { seen };
        assert_eq!(fleet.status().members[0].clock, None);
        assert!(!fleet.status().members[0].answers);
        assert!(fleet.clocks().is_empty() && fleet.clock("v2", Role::Leader).is_none());

        let (_sender, seen) = watch::channel(vec![known]);
        let fleet = FleetWatch { seen };
        let status = ClockStatus { offset_ms: -40.0, uncertainty_ms: 1.0, in_step: false };
        assert_eq!(fleet.status().members[0].clock, Some(status));
        assert_eq!(fleet.clocks()[0].offset_ns, -40_000_000);
        assert_eq!(fleet.clock("v2", Role::Follower), None);
    }
}
