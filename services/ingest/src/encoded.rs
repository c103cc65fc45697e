//! A picture as it arrived: still encoded, with the stamps of its sample.

use bytes::Bytes;

use vision::Timestamp;

/// How a picture's bytes are to be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// A self-contained file, JPEG or PNG, told apart by its first bytes.
    File,
    /// One picture of an H.264 stream, Annex B; only [`crate::camera_decoder`] reads it, since it may need others.
    H264,
    /// Bare pixels: rows of `step` bytes in the named order (`rgb8`, `bgr8`, `mono8`, …).
    Raw {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// Bytes from the beginning of one row to the next.
        step: u32,
        /// Order and depth of the channels, as ROS and Foxglove name them.
        order: String,
    },
}

/// A picture as it arrived.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EncodedFrame {
    /// The picture's number in its stream.
    pub sequence: u64,
    /// When it was captured, capture clock.
    pub captured_at: Timestamp,
    /// How to read `bytes`.
    pub encoding: Encoding,
    /// The picture itself.
    pub bytes: Bytes,
}

impl EncodedFrame {
    /// Whether the picture can be decoded only after those before it.
    #[must_use]
    pub fn rests_on_earlier(&self) -> bool {
        self.encoding == Encoding::H264 && !video::stream::is_keyframe(&self.bytes)
    }

    /// The picture as it came, where it is a JPEG by its first bytes (ITU-T T.81 B.1.1.3: start of image, then a marker).
    #[must_use]
    pub fn own_jpeg(&self) -> Option<Bytes> {
        let is_jpeg = self.encoding == Encoding::File && self.bytes.starts_with(&[0xFF, 0xD8, 0xFF]);
        is_jpeg.then(|| self.bytes.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_jpeg_file_is_one() {
        let told = |encoding, bytes: &'static [u8]| {
            let bytes = Bytes::from_static(bytes);
            EncodedFrame { sequence: 0, captured_at: Timestamp::from_nanos(0), encoding, bytes }.own_jpeg()
        };
        let jpeg: &[u8] = &[0xFF, 0xD8, 0xFF, 0xE0, 0, 2, 0xFF, 0xD9];
        assert_eq!(told(Encoding::File, jpeg).as_deref(), Some(jpeg));
        assert_eq!(told(Encoding::File, b"\x89PNG\r\n"), None);
        let raw = Encoding::Raw { width: 1, height: 1, step: 8, order: "mono8".to_owned() };
        assert_eq!(told(raw, jpeg), None);
    }
}
