//! A camera's calibration: asked for at the start, taken whenever it changes; for the places of what is seen, and for
//! the recording, which repeats it in each file.

use std::sync::Arc;

use bytes::Bytes;
use recording::{Journal, Latch, LatchKey};
use tokio::sync::watch;
use vision::Pinhole;
use waymark_proto::foxglove::CameraCalibration;
use waymark_proto::images::pinhole_from_calibration;
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use waymark_proto::payload::WireMessage;
use zenoh::Session;
use zenoh::pubsub::Subscriber;
use zenoh::qos::CongestionControl;
use zenoh::sample::Sample;

use crate::error::FollowerError;
use crate::tap::{self, Entry, now_ns};
use crate::topics::CameraTopics;

/// Records every calibration that the camera publishes, and the one it answers with now, and passes them on.
pub(crate) async fn record(
    session: &Session,
    own: &VehicleKeys,
    camera: &Id,
    topics: CameraTopics,
    journal: Arc<Journal>,
    pinhole: watch::Sender<Option<Pinhole>>,
) -> Result<Subscriber<()>, FollowerError> {
    let key = own.camera(camera, CameraStream::Calibration);
    let log = Arc::new(move |sample: &Sample| {
        if let Some(calibration) = log(sample, &topics, &journal) {
            pinhole.send_replace(pinhole_from_calibration(&calibration));
        }
    });
    let subscriber = session
        .declare_subscriber(&key)
        .callback({
            let log = Arc::clone(&log);
            move |sample| log(&sample)
        })
        .await
        .map_err(FollowerError::zenoh("subscribing to a camera's calibration"))?;
    session
        .get(&key)
        .congestion_control(CongestionControl::Drop)
        .callback(move |reply| {
            if let Ok(sample) = reply.result() {
                log(sample);
            }
        })
        .await
        .map_err(FollowerError::zenoh("asking for a camera's calibration"))?;
    Ok(subscriber)
}

fn log(sample: &Sample, topics: &CameraTopics, journal: &Journal) -> Option<CameraCalibration> {
    let payload = sample.payload().to_bytes();
    let calibration = CameraCalibration::from_payload(&payload)
        .inspect_err(|refused| tracing::warn!(%refused, key = %sample.key_expr(), "calibration refused"))
        .ok()?;
    let channel = &topics.calibration;
    let captured_at_ns = i64::try_from(now_ns()).unwrap_or(i64::MAX);
    let data = Bytes::copy_from_slice(&payload);
    let latch = Latch::Repeat(LatchKey(channel.topic.clone()));
    tap::offer(journal, Entry { channel, captured_at_ns, sequence: 0, data, latch });
    Some(calibration)
}
