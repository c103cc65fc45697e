//! State changes in words, for `/log` of the recording: what a person asks first about a drive.

use std::collections::BTreeMap;

use vision::Timestamp;
use waymark_proto::foxglove::{Log, log::Level};
use waymark_proto::images::foxglove_time;

use crate::status::VehicleStatus;

/// Compares each status with the one before.
#[derive(Debug, Default)]
pub(crate) struct StateLog {
    before: BTreeMap<String, String>,
}

impl StateLog {
    /// A line for everything that is different from the last call.
    pub(crate) fn changes(&mut self, status: &VehicleStatus, now: Timestamp) -> Vec<Log> {
        let states = states(status);
        let changed = states.iter().filter(|(what, (_, state))| self.before.get(*what) != Some(state));
        let lines = changed.map(|(what, (level, state))| Log {
            timestamp: foxglove_time(now),
            level: *level as i32,
            message: format!("{what}: {state}"),
            name: status.vehicle.clone(),
            ..Log::default()
        });
        let lines = lines.collect();
        self.before = states.into_iter().map(|(what, (_, state))| (what, state)).collect();
        lines
    }
}

/// Everything that has a state, with how grave that state is.
fn states(status: &VehicleStatus) -> BTreeMap<String, (Level, String)> {
    let good_if = |good: bool| if good { Level::Info } else { Level::Warning };
    let mut states = BTreeMap::from([
        (
            "leader".to_owned(),
            match status.leader.present {
                true => (Level::Info, "present".to_owned()),
                false => (Level::Warning, "gone".to_owned()),
            },
        ),
        (
            "router".to_owned(),
            match status.router.connected {
                true => (Level::Info, "connected".to_owned()),
                false => (Level::Warning, "not connected".to_owned()),
            },
        ),
        ("landmarks".to_owned(), (Level::Info, status.landmarks.to_string())),
        (
            "recorder".to_owned(),
            (
                if status.recorder.state == "failed" { Level::Error } else { Level::Info },
                status.recorder.state.to_owned(),
            ),
        ),
    ]);
    if let Some(clock) = &status.leader.clock {
        let words = if clock.in_step { "in step" } else { "another time than here" };
        states.insert("leader's clock".to_owned(), (good_if(clock.in_step), words.to_owned()));
    }
    for camera in &status.cameras {
        let level = good_if(camera.state == "live");
        states.insert(format!("camera {}", camera.id), (level, camera.state.to_owned()));
        for landmark in &camera.landmarks {
            let what = format!("camera {} landmark {}/{}", camera.id, landmark.id, landmark.instance);
            states.insert(what, (good_if(landmark.result == "measured"), landmark.result.to_owned()));
        }
    }
    states
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::{LeaderStatus, RecorderStatus, RouterStatus};

    #[test]
    fn only_changes_are_logged() {
        let mut status = VehicleStatus {
            vehicle: "car".into(),
            role: "follower",
            version: "1",
            uptime_s: 1.0,
            leader: LeaderStatus {
                vehicle: "lead".into(),
                present: true,
                age_s: None,
                missed: None,
                clock: None,
            },
            router: RouterStatus { connected: true },
            landmarks: 2,
            cameras: Vec::new(),
            recorder: RecorderStatus { state: "recording", ..RecorderStatus::default() },
        };
        let mut log = StateLog::default();
        let now = Timestamp::from_nanos(1);
        assert_eq!(log.changes(&status, now).len(), 4);
        assert!(log.changes(&status, now).is_empty());
        status.leader.present = false;
        let lines = log.changes(&status, now);
        assert_eq!((lines.len(), lines[0].message.as_str()), (1, "leader: gone"));
        assert_eq!(lines[0].level, Level::Warning as i32);
    }
}
