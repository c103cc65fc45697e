//! Tells the fleet once a second how this vehicle is, and writes it into the recording.

use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use prost::Message;
use recording::Latch;
use runtime::shutdown::Shutdown;
use tokio::time::{MissedTickBehavior, interval};
use vision::Timestamp;
use waymark_proto::keys::VehicleKeys;
use waymark_proto::v1;
use zenoh::Session;
use zenoh::qos::{Priority, Reliability};

use crate::error::FollowerError;
use crate::outbound::Outbound;
use crate::state_log::StateLog;
use crate::status::{CameraStatus, RecorderStatus, VehicleStatus};
use crate::tap::{self, Entry, now_ns};
use crate::topics::VehicleTopics;
use crate::web::Face;

const EVERY: Duration = Duration::from_secs(1);

/// The 1 Hz status of a follower.
pub(crate) struct StatusBeacon {
    outbound: Outbound,
    face: Arc<Face>,
    log: StateLog,
}

impl StatusBeacon {
    pub(crate) async fn declare(
        session: &Session,
        own: &VehicleKeys,
        face: Arc<Face>,
    ) -> Result<Self, FollowerError> {
        let outbound = Outbound::declare::<v1::VehicleStatus>(
            session,
            own.status(),
            Reliability::BestEffort,
            Priority::Background,
        );
        Ok(Self { outbound: outbound.await?, face, log: StateLog::default() })
    }

    pub(crate) async fn run(mut self, topics: VehicleTopics, shutdown: Shutdown) {
        let mut tick = interval(EVERY);
        tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
        loop {
            tokio::select! {
                () = shutdown.requested() => return,
                _ = tick.tick() => self.send(&topics).await,
            }
        }
    }

    async fn send(&mut self, topics: &VehicleTopics) {
        let version = self.face.landmarks.borrow().version;
        let sent_at_ns = i64::try_from(now_ns()).unwrap_or(i64::MAX);
        let status = self.face.status().await;
        self.log_changes(&status, topics, sent_at_ns);
        let mut message = message(&status, version, sent_at_ns);
        message.instance.clone_from(&self.face.instance);
        message.clocks = self.face.leader.fleet().clocks();
        let message = message.encode_to_vec();
        let data = Bytes::copy_from_slice(&message);
        let sequence = self.outbound.put(message, sent_at_ns).await as u64;
        let channel = &topics.status;
        let entry = Entry { channel, captured_at_ns: sent_at_ns, sequence, data, latch: Latch::None };
        tap::offer(&self.face.journal, entry);
    }

    fn log_changes(&mut self, status: &VehicleStatus, topics: &VehicleTopics, now_ns: i64) {
        for line in self.log.changes(status, Timestamp::from_nanos(now_ns)) {
            let data = Bytes::from(line.encode_to_vec());
            let channel = &topics.log;
            let entry = Entry { channel, captured_at_ns: now_ns, sequence: 0, data, latch: Latch::None };
            tap::offer(&self.face.journal, entry);
        }
    }
}

fn message(status: &VehicleStatus, version: vision::SetVersion, sent_at_ns: i64) -> v1::VehicleStatus {
    v1::VehicleStatus {
        vehicle: status.vehicle.clone(),
        role: status.role.to_owned(),
        version: status.version.to_owned(),
        uptime_s: status.uptime_s,
        sent_at_ns,
        set_epoch: version.epoch,
        set_version: version.version,
        landmark_count: status.landmarks as u32,
        cameras: status.cameras.iter().map(camera).collect(),
        recorder: Some(recorder(&status.recorder)),
        ..Default::default()
    }
}

fn camera(status: &CameraStatus) -> v1::CameraStatus {
    v1::CameraStatus {
        id: status.id.clone(),
        state: status.state.to_owned(),
        sequence: status.sequence.unwrap_or_default(),
        fps: status.fps as f32,
        missed_frames: status.dropped.missed,
        replaced_frames: status.dropped.replaced,
        undecodable_frames: status.dropped.undecodable,
    }
}

fn recorder(status: &RecorderStatus) -> v1::RecorderStatus {
    v1::RecorderStatus {
        state: status.state.to_owned(),
        file: status.file.clone().unwrap_or_default(),
        bytes: status.bytes,
        lost_messages: status.lost,
        free_bytes: status.free_bytes.unwrap_or_default(),
    }
}
