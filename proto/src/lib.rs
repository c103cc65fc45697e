//! The wire: generated messages, key expressions, attachment, and conversion to and from the domain.
//!
//! Everything that two processes must agree on stands here and nowhere else: message layouts ([`v1`], and the
//! Foxglove messages re-exported as [`foxglove`]), key expressions ([`keys`]), what travels beside a payload
//! ([`attachment`]), what a digest covers ([`digest`]), how large a payload may be ([`payload`]) and which values are
//! believed ([`convert`]). It opens no session and touches no file.

pub mod annotations;
#[cfg(test)]
mod arbitrary;
pub mod attachment;
pub mod convert;
pub mod digest;
pub mod documents;
pub mod gaps;
pub mod images;
pub mod json;
pub mod keys;
pub mod payload;

/// The messages of `proto/waymark/v1`, as generated. Field comments give unit and frame.
#[allow(missing_docs, clippy::all, clippy::pedantic)] // generated
pub mod v1 {
    include!(concat!(env!("OUT_DIR"), "/waymark.v1.rs"));
}

/// The Foxglove messages in use, from the published SDK: <https://docs.foxglove.dev/docs/sdk/schemas>.
pub mod foxglove {
    pub use foxglove::messages::{
        CameraCalibration, CircleAnnotation, Color, CompressedImage, CompressedVideo, FrameTransform,
        FrameTransforms, ImageAnnotations, KeyValuePair, Log, Point2, PointsAnnotation, RawImage,
        SceneUpdate, TextAnnotation, Timestamp, log, points_annotation,
    };
}
