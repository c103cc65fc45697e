//! A camera's keys: pictures, calibration, and the truth that only a simulator knows.

use ingest::encoded::Encoding;
use prost::Message;
use runtime::reply::{Answer, reply};
use simulator::TrueObject;
use vision::{Pinhole, Timestamp};
use waymark_proto::attachment::{Attachment, Stamper};
use waymark_proto::images::{PictureFormat, calibration_from_pinhole, foxglove_time, picture_message};
use waymark_proto::keys::{CameraStream, Id, PresenceKey, Role, VehicleKeys};
use waymark_proto::payload::WireMessage;
use waymark_proto::{foxglove, v1};
use zenoh::Session;
use zenoh::key_expr::KeyExpr;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Publisher;
use zenoh::qos::{CongestionControl, Priority, Reliability};
use zenoh::query::Queryable;

use crate::coder::Sendable;
use crate::config::CameraConfig;
use crate::error::CameraError;

/// The declared keys of one camera.
pub(crate) struct Publishing {
    camera: String,
    stamper: Stamper,
    images: Publisher<'static>,
    truths: Publisher<'static>,
    _calibration: Option<Queryable<()>>,
    _token: LivelinessToken,
}

impl Publishing {
    pub(crate) async fn declare(
        session: &Session,
        config: &CameraConfig,
        pinhole: Option<Pinhole>,
    ) -> Result<Self, CameraError> {
        let keys = VehicleKeys::new(&config.fleet, &config.vehicle)?;
        let camera = Id::new("camera", &config.camera)?;
        let publisher = |stream, priority| {
            session
                .declare_publisher(keys.camera(&camera, stream))
                .congestion_control(CongestionControl::Drop)
                .priority(priority)
                .reliability(Reliability::BestEffort)
        };
        let declared = CameraError::zenoh("declaring a camera's publishers");
        let images = publisher(CameraStream::Image, Priority::DataLow).await.map_err(declared)?;
        let declared = CameraError::zenoh("declaring a camera's publishers");
        let truths = publisher(CameraStream::Truth, Priority::Data).await.map_err(declared)?;
        let calibration = match pinhole {
            Some(pinhole) => Some(offer_calibration(session, &keys, &camera, &pinhole).await?),
            None => None,
        };
        let gid = uuid::Uuid::new_v4();
        let instance = Id::new("instance", &gid.simple().to_string())?;
        let (fleet, vehicle) = (keys.fleet().clone(), keys.vehicle().clone());
        let token = session
            .liveliness()
            .declare_token(PresenceKey { fleet, vehicle, role: Role::Camera, instance }.to_string())
            .await
            .map_err(CameraError::zenoh("declaring the camera's liveliness token"))?;
        let stamper = Stamper::new(gid.into_bytes());
        Ok(Self {
            camera: config.camera.clone(),
            stamper,
            images,
            truths,
            _calibration: calibration,
            _token: token,
        })
    }

    /// Publishes a picture and what is known of it under one number and time.
    pub(crate) async fn publish(&self, picture: Sendable, captured_at: Timestamp) {
        let attachment = self.stamper.stamp(captured_at.nanos);
        if let Some(objects) = &picture.truth {
            let truth = self.truth(objects, attachment).encode_to_vec();
            send(&self.truths, truth, v1::Truth::encoding(), attachment).await;
        }
        let (payload, encoding) = self.image(picture, captured_at);
        send(&self.images, payload, encoding, attachment).await;
    }

    fn image(&self, picture: Sendable, captured_at: Timestamp) -> (Vec<u8>, String) {
        match picture.encoding {
            Encoding::File => {
                let is_png = picture.bytes.starts_with(b"\x89PNG");
                let format = if is_png { PictureFormat::Png } else { PictureFormat::Jpeg };
                let message = picture_message(format, picture.bytes, captured_at, &self.camera);
                (message.encode_to_vec(), foxglove::CompressedImage::encoding())
            }
            Encoding::H264 => {
                let message = foxglove::CompressedVideo {
                    timestamp: foxglove_time(captured_at),
                    frame_id: self.camera.clone(),
                    data: picture.bytes,
                    format: "h264".to_owned(),
                };
                (message.encode_to_vec(), foxglove::CompressedVideo::encoding())
            }
            Encoding::Raw { width, height, step, order } => {
                let message = foxglove::RawImage {
                    timestamp: foxglove_time(captured_at),
                    frame_id: self.camera.clone(),
                    width,
                    height,
                    encoding: order,
                    step,
                    data: picture.bytes,
                };
                (message.encode_to_vec(), foxglove::RawImage::encoding())
            }
        }
    }

    fn truth(&self, objects: &[TrueObject], attachment: Attachment) -> v1::Truth {
        v1::Truth {
            camera: self.camera.clone(),
            sequence: attachment.sequence as u64,
            captured_at_ns: attachment.source_time_ns,
            objects: objects.iter().map(Into::into).collect(),
        }
    }
}

async fn send(publisher: &Publisher<'_>, payload: Vec<u8>, encoding: String, attachment: Attachment) {
    let sent = publisher.put(payload).encoding(encoding).attachment(attachment.to_bytes().as_slice()).await;
    if let Err(error) = sent {
        tracing::debug!(%error, key = %publisher.key_expr(), "not sent");
    }
}

async fn offer_calibration(
    session: &Session,
    keys: &VehicleKeys,
    camera: &Id,
    pinhole: &Pinhole,
) -> Result<Queryable<()>, CameraError> {
    let key = keys.camera(camera, CameraStream::Calibration);
    let since = Timestamp::from_nanos(runtime::identity::unix_time_ns());
    let payload = calibration_from_pinhole(pinhole, camera.as_str(), since).encode_to_vec();
    let encoding = foxglove::CameraCalibration::encoding();
    let queryable = session
        .declare_queryable(&key)
        .callback({
            let answer = Answer {
                key: KeyExpr::try_from(key.clone()).map_err(CameraError::zenoh("naming the calibration"))?,
                payload: payload.clone().into(),
                encoding: encoding.as_str().into(),
                attachment: None,
            };
            move |query| reply(&query, answer.clone())
        })
        .await
        .map_err(CameraError::zenoh("offering the calibration"))?;
    session
        .put(&key, payload)
        .encoding(encoding)
        .congestion_control(CongestionControl::Drop)
        .await
        .map_err(CameraError::zenoh("publishing the calibration"))?;
    Ok(queryable)
}
