//! Whether pictures come, and how old they are when they do.

use std::time::Duration;

use http_face::STALE_AFTER;
use ingest::picture_message::PictureKind;
use runtime::identity::unix_time_ns;
use tokio::sync::mpsc;
use tokio::time::timeout;
use waymark_proto::keys::{CameraStream, Id};
use zenoh::Session;
use zenoh::sample::Sample;

use super::finding::Finding;
use super::subject::Subject;

/// A slow camera has one picture a second.
const WITHIN: Duration = Duration::from_secs(3);
/// Clocks within one machine do not differ; those of two may by a little.
const MAX_AHEAD_S: f64 = 0.1;

pub(super) async fn examine(session: &Session, subject: &Subject) -> Vec<Finding> {
    if subject.cameras.is_empty() {
        return vec![Finding::not_applicable("cameras", format!("a {} has none", subject.role()))];
    }
    let mut findings = Vec::new();
    for camera in &subject.cameras {
        findings.push(camera_of(session, subject, camera).await);
    }
    findings
}

async fn camera_of(session: &Session, subject: &Subject, camera: &Id) -> Finding {
    let check = format!("camera {camera}");
    let key = subject.keys.camera(camera, CameraStream::Image);
    match first_picture(session, &key).await {
        Ok(Some(sample)) => aged(check, &sample),
        Ok(None) => {
            let remedy = format!(
                "start `waymark camera` with fleet={}, vehicle={}, camera={camera}; where it runs, see that its router \
                 is this one",
                subject.keys.fleet(),
                subject.keys.vehicle()
            );
            Finding::no(check, format!("no picture within {} s", WITHIN.as_secs()), remedy)
        }
        Err(reason) => Finding::no(check, reason.to_string(), "see the router's access control"),
    }
}

async fn first_picture(session: &Session, key: &str) -> zenoh::Result<Option<(Sample, i64)>> {
    let (seen, mut seeing) = mpsc::channel(1);
    let _subscriber = session
        .declare_subscriber(key)
        .callback(move |sample| drop(seen.try_send((sample, unix_time_ns()))))
        .await?;
    Ok(timeout(WITHIN, seeing.recv()).await.ok().flatten())
}

fn aged(check: String, (sample, arrived_at_ns): &(Sample, i64)) -> Finding {
    let encoding = sample.encoding().to_string();
    let schema = encoding.rsplit(';').next().unwrap_or_default();
    let Some(kind) = PictureKind::of_schema(schema) else {
        let found = format!("what comes is {encoding}");
        return Finding::no(check, found, "publish foxglove.CompressedImage or foxglove.RawImage");
    };
    match kind.read(0, &sample.payload().to_bytes()) {
        Ok(picture) => judged(check, (arrived_at_ns.saturating_sub(picture.captured_at.nanos)) as f64 * 1e-9),
        Err(error) => {
            Finding::no(check, error.to_string(), "publish pictures as JPEG or PNG, with their time")
        }
    }
}

fn judged(check: String, age_s: f64) -> Finding {
    if age_s < -MAX_AHEAD_S {
        let found = format!("pictures come from {:.1} s in the future", -age_s);
        return Finding::no(check, found, "synchronise the clocks of this machine and the camera's");
    }
    if age_s > STALE_AFTER.as_secs_f64() {
        let found = format!("pictures come, but {age_s:.1} s after they were captured");
        let remedy = "synchronise the clocks of this machine and the camera's; a camera that replays a recording must \
                      give its pictures new times";
        return Finding::no(check, found, remedy);
    }
    Finding::yes(check, format!("the newest picture is {:.0} ms old", age_s.max(0.0) * 1e3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::doctor::finding::Verdict;

    #[test]
    fn old_pictures_and_those_of_the_future_are_none() {
        let verdict = |age_s| judged("camera".into(), age_s).verdict;
        assert_eq!([0.02, -0.05, 1.9].map(verdict), [Verdict::Yes; 3]);
        assert_eq!([3.0, -1.0].map(verdict), [Verdict::No; 2]);
    }
}
