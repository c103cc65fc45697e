//! The channels of a follower's recording (contract section 7): topic, schema and key expression of each.

use std::borrow::Cow;
use std::sync::Arc;

use bytes::Bytes;
use ingest::recorded::BURNED_IN;
use recording::{ChannelSpec, Schema};
use waymark_proto::keys::{CameraStream, Id, VehicleKeys};
use waymark_proto::payload::WireMessage;
use waymark_proto::{foxglove, v1};

/// The channels of one camera.
#[derive(Clone, Debug)]
pub(crate) struct CameraTopics {
    /// JPEG or PNG pictures as they arrived.
    pub(crate) compressed_image: Arc<ChannelSpec>,
    /// H.264 video as it arrived.
    pub(crate) compressed_video: Arc<ChannelSpec>,
    /// Bare pixels as they arrived.
    pub(crate) raw_image: Arc<ChannelSpec>,
    /// The camera's calibration.
    pub(crate) calibration: Arc<ChannelSpec>,
    /// One outcome for each registered picture.
    pub(crate) registration: Arc<ChannelSpec>,
    /// The same, for viewers.
    pub(crate) annotations: Arc<ChannelSpec>,
    /// What the next outcome depends on; in recordings only.
    pub(crate) follow_state: Arc<ChannelSpec>,
    /// Pictures with what was seen drawn into them; in recordings only, where asked for.
    pub(crate) burned_in: Arc<ChannelSpec>,
}

/// The channels that belong to no camera.
#[derive(Clone, Debug)]
pub(crate) struct VehicleTopics {
    /// The leader's landmarks.
    pub(crate) landmark: Arc<ChannelSpec>,
    /// The leader's manifest.
    pub(crate) manifest: Arc<ChannelSpec>,
    /// What this vehicle says of itself.
    pub(crate) status: Arc<ChannelSpec>,
    /// State changes in words.
    pub(crate) log: Arc<ChannelSpec>,
}

impl CameraTopics {
    /// The channels of `camera` on the vehicle of `keys`.
    #[must_use]
    pub(crate) fn new(keys: &VehicleKeys, camera: &Id) -> Self {
        let topic = |stream: CameraStream| format!("/{}/camera/{camera}/{}", keys.vehicle(), stream.name());
        let key = |stream| keys.camera(camera, stream);
        Self {
            compressed_image: channel::<foxglove::CompressedImage>(
                topic(CameraStream::Image),
                key(CameraStream::Image),
            ),
            compressed_video: channel::<foxglove::CompressedVideo>(
                topic(CameraStream::Image),
                key(CameraStream::Image),
            ),
            raw_image: channel::<foxglove::RawImage>(topic(CameraStream::Image), key(CameraStream::Image)),
            calibration: channel::<foxglove::CameraCalibration>(
                topic(CameraStream::Calibration),
                key(CameraStream::Calibration),
            ),
            registration: channel::<v1::Registration>(
                topic(CameraStream::Registration),
                key(CameraStream::Registration),
            ),
            annotations: channel::<foxglove::ImageAnnotations>(
                topic(CameraStream::Annotations),
                key(CameraStream::Annotations),
            ),
            follow_state: channel::<v1::FollowState>(
                format!("/{}/camera/{camera}/follow", keys.vehicle()),
                String::new(),
            ),
            burned_in: channel::<foxglove::CompressedImage>(
                format!("/{}/camera/{camera}/{BURNED_IN}", keys.vehicle()),
                String::new(),
            ),
        }
    }
}

impl VehicleTopics {
    /// The channels of the vehicle of `own`, which follows the vehicle of `leader`.
    #[must_use]
    pub(crate) fn new(own: &VehicleKeys, leader: &VehicleKeys) -> Self {
        let leads = leader.vehicle();
        Self {
            landmark: channel::<v1::Landmark>(format!("/{leads}/landmark"), leader.landmarks()),
            manifest: channel::<v1::LandmarkManifest>(format!("/{leads}/manifest"), leader.manifest()),
            status: channel::<v1::VehicleStatus>(format!("/{}/status", own.vehicle()), own.status()),
            log: channel::<foxglove::Log>("/log".to_owned(), String::new()),
        }
    }
}

fn channel<M: WireMessage>(topic: String, key_expression: String) -> Arc<ChannelSpec> {
    let file_descriptor_set = match M::descriptors() {
        Cow::Borrowed(bytes) => Bytes::from_static(bytes),
        Cow::Owned(bytes) => Bytes::from(bytes),
    };
    let schema = Schema { name: M::SCHEMA.to_owned(), file_descriptor_set };
    Arc::new(ChannelSpec { topic, key_expression, schema })
}
