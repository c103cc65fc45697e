//! Payloads: their encoding's name, their schema, how large they may be, and how they are decoded.

use std::borrow::Cow;

use foxglove::Encode;
use prost::{Message, Name};

use crate::{foxglove as fox, v1};

/// The largest picture that is accepted, encoded or raw, in bytes.
pub const MAX_IMAGE_BYTES: usize = 16 << 20;

/// The largest message of any other kind that is accepted, in bytes.
pub const MAX_MESSAGE_BYTES: usize = 1 << 20;

/// The largest message that holds a whole landmark set, in bytes: about 100,000 landmarks.
pub const MAX_SET_BYTES: usize = 16 << 20;

/// The MIME type in front of the schema's name in a sample's encoding.
pub const ENCODING_PREFIX: &str = "application/protobuf";

/// The descriptors of all of `waymark.v1`, with imports: a serialised `google.protobuf.FileDescriptorSet`.
pub const WAYMARK_DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/waymark.v1.descriptors"));

/// A message that travels as a payload of its own.
pub trait WireMessage: Message + Default {
    /// Fully qualified name, as in `waymark.v1.Landmark`.
    const SCHEMA: &'static str;
    /// The largest payload of this kind that is accepted, in bytes.
    const MAX_BYTES: usize;

    /// Serialised `FileDescriptorSet`, imports included, that describes this message.
    fn descriptors() -> Cow<'static, [u8]>;

    /// What a sample's encoding says: MIME type and schema.
    #[must_use]
    fn encoding() -> String {
        format!("{ENCODING_PREFIX};{}", Self::SCHEMA)
    }

    /// Decodes a payload; unknown fields are ignored.
    ///
    /// # Errors
    /// When it is larger than [`Self::MAX_BYTES`] (looked at before anything is decoded), or no such message, which
    /// includes nesting deeper than 100 levels.
    fn from_payload(payload: &[u8]) -> Result<Self, RefusedPayload> {
        if payload.len() > Self::MAX_BYTES {
            return Err(RefusedPayload::TooLarge {
                schema: Self::SCHEMA,
                bytes: payload.len(),
                limit: Self::MAX_BYTES,
            });
        }
        Self::decode(payload).map_err(|source| RefusedPayload::Malformed { schema: Self::SCHEMA, source })
    }
}

/// Why a payload was not decoded.
#[derive(Debug, thiserror::Error)]
pub enum RefusedPayload {
    /// Larger than anything that a well-behaved sender sends.
    #[error("a {schema} of {bytes} bytes is refused: at most {limit} bytes are accepted")]
    TooLarge {
        /// The message expected.
        schema: &'static str,
        /// Its size.
        bytes: usize,
        /// What is accepted.
        limit: usize,
    },
    /// Not the protobuf message that was expected.
    #[error("the payload is no {schema}: {source}")]
    Malformed {
        /// The message expected.
        schema: &'static str,
        /// What the decoder met.
        source: prost::DecodeError,
    },
}

macro_rules! waymark_messages {
    ($($message:ident: $max_bytes:expr),* $(,)?) => {$(
        impl WireMessage for v1::$message {
            const SCHEMA: &'static str = concat!("waymark.v1.", stringify!($message));
            const MAX_BYTES: usize = $max_bytes;

            fn descriptors() -> Cow<'static, [u8]> {
                debug_assert_eq!(Self::SCHEMA, <Self as Name>::full_name());
                Cow::Borrowed(WAYMARK_DESCRIPTORS)
            }
        }
    )*};
}

macro_rules! foxglove_messages {
    ($($message:ident: $max_bytes:expr),* $(,)?) => {$(
        impl WireMessage for fox::$message {
            const SCHEMA: &'static str = concat!("foxglove.", stringify!($message));
            const MAX_BYTES: usize = $max_bytes;

            fn descriptors() -> Cow<'static, [u8]> {
                // The SDK describes each of its own messages; an empty answer would show in the test below.
                Self::get_schema().map_or(Cow::Borrowed(&[]), |schema| schema.data)
            }
        }
    )*};
}

waymark_messages!(
    Landmark: MAX_MESSAGE_BYTES,
    LandmarkManifest: MAX_MESSAGE_BYTES,
    LandmarkSet: MAX_SET_BYTES,
    LandmarkEdit: MAX_SET_BYTES,
    LandmarkEditReply: MAX_MESSAGE_BYTES,
    Registration: MAX_MESSAGE_BYTES,
    FollowState: MAX_MESSAGE_BYTES,
    Truth: MAX_MESSAGE_BYTES,
    VehicleStatus: MAX_MESSAGE_BYTES,
);

foxglove_messages!(
    CompressedImage: MAX_IMAGE_BYTES,
    CompressedVideo: MAX_IMAGE_BYTES,
    RawImage: MAX_IMAGE_BYTES,
    CameraCalibration: MAX_MESSAGE_BYTES,
    ImageAnnotations: MAX_MESSAGE_BYTES,
    FrameTransforms: MAX_MESSAGE_BYTES,
    SceneUpdate: MAX_MESSAGE_BYTES,
    Log: MAX_MESSAGE_BYTES,
);

#[cfg(test)]
mod tests {
    use prost_reflect::DescriptorPool;

    use super::*;

    fn describes_itself<M: WireMessage>() {
        let pool = DescriptorPool::decode(M::descriptors().as_ref()).unwrap();
        assert!(pool.get_message_by_name(M::SCHEMA).is_some(), "{} is not described", M::SCHEMA);
        assert_eq!(M::encoding(), format!("application/protobuf;{}", M::SCHEMA));
    }

    #[test]
    fn every_message_is_described_with_its_imports() {
        describes_itself::<v1::Landmark>();
        describes_itself::<v1::LandmarkManifest>();
        describes_itself::<v1::LandmarkSet>();
        describes_itself::<v1::LandmarkEdit>();
        describes_itself::<v1::LandmarkEditReply>();
        describes_itself::<v1::Registration>();
        describes_itself::<v1::FollowState>();
        describes_itself::<v1::Truth>();
        describes_itself::<v1::VehicleStatus>();
        describes_itself::<fox::CompressedImage>();
        describes_itself::<fox::CompressedVideo>();
        describes_itself::<fox::RawImage>();
        describes_itself::<fox::CameraCalibration>();
        describes_itself::<fox::ImageAnnotations>();
        describes_itself::<fox::FrameTransforms>();
        describes_itself::<fox::SceneUpdate>();
        describes_itself::<fox::Log>();
    }

    #[test]
    fn payloads_over_the_limit_are_refused_before_decoding() {
        let oversized = vec![0xFF; 64 << 20];
        let landmark = v1::Landmark::from_payload(&oversized).unwrap_err();
        assert!(matches!(landmark, RefusedPayload::TooLarge { limit: MAX_MESSAGE_BYTES, .. }));
        let image = fox::CompressedImage::from_payload(&oversized).unwrap_err();
        assert!(image.to_string().contains("at most 16777216 bytes"), "{image}");
    }

    #[test]
    fn nesting_101_deep_is_refused() {
        // Unknown groups are the only way to nest in these messages: start-group tags of field 15.
        let mut nested = vec![0x7B; 101];
        nested.extend(vec![0x7C; 101]);
        let refused = v1::Landmark::from_payload(&nested).unwrap_err();
        assert!(refused.to_string().contains("recursion limit"), "{refused}");
    }

    #[test]
    fn unknown_fields_are_ignored() {
        let mut payload = v1::Landmark { id: "red".into(), ..Default::default() }.encode_to_vec();
        payload.extend([0xF8, 0x07, 0x2A]); // field 127, varint 42
        assert_eq!(v1::Landmark::from_payload(&payload).unwrap().id, "red");
    }

    #[test]
    fn a_truncated_payload_is_refused() {
        let payload = v1::Landmark { id: "red".into(), ..Default::default() }.encode_to_vec();
        assert!(matches!(
            v1::Landmark::from_payload(&payload[..3]),
            Err(RefusedPayload::Malformed { schema: "waymark.v1.Landmark", .. })
        ));
    }
}
