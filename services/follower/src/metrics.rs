//! `/metrics`: counted where things happen, put together when somebody asks. There is no global recorder, so two
//! followers in one process never mix their figures.

use std::sync::Arc;

use crate::pictures_out::Shown;
use http_face::{Cameras, Counters};
use metrics::{counter, describe_counter, gauge};
use metrics_exporter_prometheus::PrometheusBuilder;

use crate::counters::LandmarkCounters;
use crate::station::Station;
use crate::status::{FleetStatus, VehicleStatus};

/// What each figure is.
const HELP: [(&str, &str); 20] = [
    ("waymark_uptime_seconds", "Time since the start."),
    ("waymark_landmarks", "Landmarks in force."),
    ("waymark_leader_present", "1 when the leader is announced and was heard within a lease."),
    ("waymark_leader_missed_manifests_total", "Manifests that the leader sent and that did not arrive."),
    ("waymark_router_connected", "1 when there is a way to the others."),
    ("waymark_recorder_failed", "1 when the recorder has failed."),
    ("waymark_recorder_file_bytes", "Bytes in the file being written."),
    ("waymark_recorder_lost_messages_total", "Messages offered to the recorder and not stored."),
    ("waymark_recorder_free_bytes", "Free bytes on the recorder's disk."),
    ("waymark_clock_offset_seconds", "Another machine's clock minus this one's."),
    ("waymark_clock_offset_uncertainty_seconds", "How far that may be wrong either way."),
    ("waymark_frames_registered_total", "Frames that were looked at."),
    ("waymark_frames_per_second", "Registered frames per second over the last seconds."),
    ("waymark_frame_age_seconds", "Age of the newest frame since its arrival."),
    ("waymark_frame_latency_seconds", "From capture to result, of the newest frame."),
    ("waymark_frames_dropped_total", "Frames that did not make it, by reason."),
    ("waymark_landmarks_measured", "Landmarks measured in the newest frame."),
    (
        "waymark_landmark_messages_ignored_total",
        "Messages about landmarks that were not followed, by reason.",
    ),
    ("waymark_http_encodes_total", "Pictures encoded for viewers."),
    ("waymark_http_refused_total", "Requests and connections turned away or cut off, by reason."),
];

/// Everything in the Prometheus text format.
pub(crate) fn exposition(
    status: &VehicleStatus,
    fleet: &FleetStatus,
    stations: &[Arc<Station>],
    landmarks: &LandmarkCounters,
    cameras: &Cameras<Shown>,
    refusals: &Counters,
) -> String {
    let recorder = PrometheusBuilder::new().build_recorder();
    metrics::with_local_recorder(&recorder, || {
        for (name, help) in HELP {
            describe_counter!(name, help);
        }
        vehicle(status);
        clocks(fleet);
        stations.iter().for_each(|station| camera(station));
        for (reason, count) in landmarks.by_reason() {
            counter!("waymark_landmark_messages_ignored_total", "reason" => reason).absolute(count);
        }
        face(cameras, refusals);
    });
    recorder.handle().render()
}

/// The web face: what it encoded for viewers, and whom it turned away.
fn face(cameras: &Cameras<Shown>, refusals: &Counters) {
    for (camera, encoded) in cameras.encoded() {
        counter!("waymark_http_encodes_total", "camera" => camera.to_owned()).absolute(encoded);
    }
    for (reason, count) in refusals.by_reason() {
        counter!("waymark_http_refused_total", "reason" => reason).absolute(count);
    }
}

fn vehicle(status: &VehicleStatus) {
    let yes = |condition: bool| f64::from(u8::from(condition));
    gauge!("waymark_uptime_seconds").set(status.uptime_s);
    gauge!("waymark_landmarks").set(status.landmarks as f64);
    gauge!("waymark_leader_present").set(yes(status.leader.present));
    counter!("waymark_leader_missed_manifests_total").absolute(status.leader.missed.unwrap_or(0));
    gauge!("waymark_router_connected").set(yes(status.router.connected));
    gauge!("waymark_recorder_failed").set(yes(status.recorder.state == "failed"));
    gauge!("waymark_recorder_file_bytes").set(status.recorder.bytes as f64);
    counter!("waymark_recorder_lost_messages_total").absolute(status.recorder.lost);
    if let Some(free_bytes) = status.recorder.free_bytes {
        gauge!("waymark_recorder_free_bytes").set(free_bytes as f64);
    }
}

fn clocks(fleet: &FleetStatus) {
    for member in &fleet.members {
        let Some(clock) = member.clock else { continue };
        let labels = [("vehicle", member.vehicle.clone()), ("role", member.role.to_owned())];
        gauge!("waymark_clock_offset_seconds", &labels).set(clock.offset_ms * 1e-3);
        gauge!("waymark_clock_offset_uncertainty_seconds", &labels).set(clock.uncertainty_ms * 1e-3);
    }
}

fn camera(station: &Station) {
    let camera = station.id().to_owned();
    let status = station.status();
    counter!("waymark_frames_registered_total", "camera" => camera.clone()).absolute(station.registered());
    gauge!("waymark_frames_per_second", "camera" => camera.clone()).set(status.fps);
    if let Some(age_ms) = status.age_ms {
        gauge!("waymark_frame_age_seconds", "camera" => camera.clone()).set(age_ms * 1e-3);
    }
    if let Some(latency_ms) = status.latency_ms {
        gauge!("waymark_frame_latency_seconds", "camera" => camera.clone()).set(latency_ms * 1e-3);
    }
    for (reason, count) in status.dropped.by_reason() {
        counter!("waymark_frames_dropped_total", "camera" => camera.clone(), "reason" => reason)
            .absolute(count);
    }
    if let Some(not_burned_in) = station.not_burned_in() {
        counter!("waymark_frames_not_burned_in_total", "camera" => camera.clone()).absolute(not_burned_in);
    }
    let measured = status.landmarks.iter().filter(|landmark| landmark.result == "measured").count();
    gauge!("waymark_landmarks_measured", "camera" => camera).set(measured as f64);
}
