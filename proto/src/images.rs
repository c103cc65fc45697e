//! Pictures and camera calibrations as Foxglove messages.

use foxglove::bytes::Bytes;
use vision::{Pinhole, SizePx, Timestamp};

use crate::foxglove as fox;

/// How the picture in a `foxglove.CompressedImage` is compressed; only what a follower can decode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PictureFormat {
    /// Baseline or progressive JPEG.
    Jpeg,
    /// PNG.
    Png,
}

impl PictureFormat {
    /// The value of the message's `format` field.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Jpeg => "jpeg",
            Self::Png => "png",
        }
    }
}

/// Why a picture's description cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnusablePicture {
    /// A compression that is not decoded here.
    #[error("format is {0:?}; allowed: \"jpeg\" or \"png\"")]
    Format(String),
    /// Without a time there is nothing to predict from.
    #[error("timestamp is absent; allowed: the capture time")]
    NoTimestamp,
}

/// A compressed picture as it is published.
#[must_use]
pub fn picture_message(
    format: PictureFormat,
    encoded: Bytes,
    captured_at: Timestamp,
    camera: &str,
) -> fox::CompressedImage {
    fox::CompressedImage {
        timestamp: foxglove_time(captured_at),
        frame_id: camera.to_owned(),
        data: encoded,
        format: format.name().to_owned(),
    }
}

/// How the picture is compressed.
///
/// # Errors
/// When this version does not decode that.
pub fn picture_format(image: &fox::CompressedImage) -> Result<PictureFormat, UnusablePicture> {
    match image.format.as_str() {
        "jpeg" | "jpg" => Ok(PictureFormat::Jpeg),
        "png" => Ok(PictureFormat::Png),
        other => Err(UnusablePicture::Format(other.chars().take(32).collect())),
    }
}

/// When the picture was captured.
///
/// # Errors
/// When the message does not say.
pub fn picture_captured_at(image: &fox::CompressedImage) -> Result<Timestamp, UnusablePicture> {
    image.timestamp.as_ref().map(domain_time).ok_or(UnusablePicture::NoTimestamp)
}

/// The camera that a calibration describes, distortion left aside; `None` without size or focal length.
#[must_use]
pub fn pinhole_from_calibration(calibration: &fox::CameraCalibration) -> Option<Pinhole> {
    let &[focal_px, _, centre_x_px, _, _, centre_y_px, ..] = calibration.k.as_slice() else {
        return None;
    };
    let size = SizePx { width: calibration.width, height: calibration.height };
    let usable = focal_px.is_finite() && focal_px > 0.0 && size.width > 0 && size.height > 0;
    let centred = centre_x_px.is_finite() && centre_y_px.is_finite();
    (usable && centred).then_some(Pinhole { size, focal_px, centre_x_px, centre_y_px })
}

/// The calibration of a camera: K, R and P as `sensor_msgs/CameraInfo` defines them.
#[must_use]
pub fn calibration_from_pinhole(pinhole: &Pinhole, camera: &str, since: Timestamp) -> fox::CameraCalibration {
    let (focal, x, y) = (pinhole.focal_px, pinhole.centre_x_px, pinhole.centre_y_px);
    fox::CameraCalibration {
        timestamp: foxglove_time(since),
        frame_id: camera.to_owned(),
        width: pinhole.size.width,
        height: pinhole.size.height,
        distortion_model: "plumb_bob".to_owned(),
        d: vec![0.0; 5],
        k: vec![focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0],
        r: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p: vec![focal, 0.0, x, 0.0, 0.0, focal, y, 0.0, 0.0, 0.0, 1.0, 0.0],
    }
}

/// The Foxglove form of an instant; absent before 1970 and after 2106, which its seconds cannot express.
#[must_use]
pub fn foxglove_time(instant: Timestamp) -> Option<fox::Timestamp> {
    let seconds = u32::try_from(instant.nanos.div_euclid(NANOS_PER_SECOND)).ok()?;
    let nanos = u32::try_from(instant.nanos.rem_euclid(NANOS_PER_SECOND)).ok()?;
    fox::Timestamp::new_checked(seconds, nanos)
}

/// The instant that a Foxglove message names.
#[must_use]
pub fn domain_time(timestamp: &fox::Timestamp) -> Timestamp {
    let nanos = i64::from(timestamp.sec()) * NANOS_PER_SECOND + i64::from(timestamp.nsec());
    Timestamp::from_nanos(nanos)
}

const NANOS_PER_SECOND: i64 = 1_000_000_000;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use prost::Message;

    use super::*;
    use crate::payload::WireMessage;

    proptest! {
        #[test]
        fn times_survive_to_the_nanosecond(nanos in 0..=i64::from(u32::MAX) * NANOS_PER_SECOND) {
            let instant = Timestamp::from_nanos(nanos);
            prop_assert_eq!(foxglove_time(instant).as_ref().map(domain_time), Some(instant));
        }
    }

    #[test]
    fn times_that_the_message_cannot_express_are_absent() {
        assert!(foxglove_time(Timestamp::from_nanos(-1)).is_none());
        assert!(foxglove_time(Timestamp::from_nanos(i64::MAX)).is_none());
    }

    #[test]
    fn a_picture_survives_the_wire() {
        let captured_at = Timestamp::from_nanos(1_700_000_000_123_456_789);
        let sent =
            picture_message(PictureFormat::Jpeg, Bytes::from_static(b"\xFF\xD8"), captured_at, "front");
        let received = fox::CompressedImage::from_payload(&sent.encode_to_vec()).unwrap();
        assert_eq!(picture_format(&received), Ok(PictureFormat::Jpeg));
        assert_eq!(picture_captured_at(&received), Ok(captured_at));
        assert_eq!(received.data.as_ref(), b"\xFF\xD8");
        assert_eq!(received.frame_id, "front");
    }

    #[test]
    fn unusable_pictures_say_why() {
        let webp = fox::CompressedImage { format: "webp".into(), ..Default::default() };
        assert_eq!(
            picture_format(&webp).unwrap_err().to_string(),
            "format is \"webp\"; allowed: \"jpeg\" or \"png\""
        );
        assert_eq!(picture_captured_at(&webp), Err(UnusablePicture::NoTimestamp));
    }

    #[test]
    fn a_calibration_gives_back_its_camera() {
        let size = SizePx { width: 640, height: 480 };
        let camera = Pinhole { size, focal_px: 554.0, centre_x_px: 320.0, centre_y_px: 240.0 };
        let calibration = calibration_from_pinhole(&camera, "front", Timestamp::from_nanos(1));
        assert_eq!(pinhole_from_calibration(&calibration), Some(camera));
        assert_eq!(pinhole_from_calibration(&fox::CameraCalibration::default()), None);
    }
}
