//! What travels beside a payload: the 33-byte attachment of rmw_zenoh.
//!
//! Layout: `i64` little-endian sequence number, `i64` little-endian source time (ns since the Unix epoch), `0x10` (the
//! length of what follows), 16 bytes naming the publisher. Reference: `ros2/rmw_zenoh`, `attachment_helpers.cpp`.

use std::sync::atomic::{AtomicI64, Ordering};

/// Names one publisher for as long as it lives.
pub type Gid = [u8; 16];

/// Number, time and origin of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Attachment {
    /// Rises by one with every sample of this publisher.
    pub sequence: i64,
    /// When the content came to be (for a picture: its capture), ns since the Unix epoch.
    pub source_time_ns: i64,
    /// The publisher.
    pub gid: Gid,
}

/// Bytes that are no attachment of this layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("an attachment has 33 bytes with 0x10 as the 17th; these are {length} with {marker:?} there")]
pub struct MalformedAttachment {
    length: usize,
    marker: Option<u8>,
}

impl Attachment {
    /// Size on the wire.
    pub const BYTES: usize = 33;
    const GID_LENGTH: u8 = 0x10;

    /// The wire's form.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..8].copy_from_slice(&self.sequence.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.source_time_ns.to_le_bytes());
        bytes[16] = Self::GID_LENGTH;
        bytes[17..].copy_from_slice(&self.gid);
        bytes
    }

    /// Reads the wire's form.
    ///
    /// # Errors
    /// When the length or the marker before the publisher's name differs.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, MalformedAttachment> {
        let malformed = MalformedAttachment { length: bytes.len(), marker: bytes.get(16).copied() };
        let bytes: &[u8; Self::BYTES] = bytes.try_into().map_err(|_| malformed)?;
        let (sequence, rest) = bytes.split_first_chunk::<8>().ok_or(malformed)?;
        let (source_time, rest) = rest.split_first_chunk::<8>().ok_or(malformed)?;
        let (&Self::GID_LENGTH, gid) = rest.split_first().ok_or(malformed)? else {
            return Err(malformed);
        };
        Ok(Self {
            sequence: i64::from_le_bytes(*sequence),
            source_time_ns: i64::from_le_bytes(*source_time),
            gid: gid.try_into().map_err(|_| malformed)?,
        })
    }
}

/// Numbers and signs what one publisher sends.
#[derive(Debug)]
pub struct Stamper {
    gid: Gid,
    last: AtomicI64,
}

impl Stamper {
    /// For a publisher named `gid`, whose first sample has the number 1.
    #[must_use]
    pub const fn new(gid: Gid) -> Self {
        Self { gid, last: AtomicI64::new(0) }
    }

    /// The attachment of the next sample.
    pub fn stamp(&self, source_time_ns: i64) -> Attachment {
        let sequence = self.last.fetch_add(1, Ordering::Relaxed) + 1;
        Attachment { sequence, source_time_ns, gid: self.gid }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_layout_is_that_of_rmw_zenoh() {
        let bytes = Attachment { sequence: 258, source_time_ns: -2, gid: *b"0123456789abcdef" }.to_bytes();
        assert_eq!(bytes[..8], [2, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(bytes[8..16], [0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]);
        assert_eq!(bytes[16], 16);
        assert_eq!(&bytes[17..], b"0123456789abcdef");
    }

    #[test]
    fn other_lengths_and_markers_are_refused() {
        let good = Attachment { sequence: 1, source_time_ns: 2, gid: [3; 16] }.to_bytes();
        assert!(Attachment::from_bytes(&good[..32]).is_err());
        assert!(Attachment::from_bytes(&[]).is_err());
        let mut marked = good;
        marked[16] = 0x11;
        let refused = Attachment::from_bytes(&marked).unwrap_err();
        assert!(refused.to_string().contains("Some(17)"), "{refused}");
    }

    #[test]
    fn samples_are_numbered_from_one() {
        let stamper = Stamper::new([7; 16]);
        assert_eq!(stamper.stamp(5), Attachment { sequence: 1, source_time_ns: 5, gid: [7; 16] });
        assert_eq!(stamper.stamp(6).sequence, 2);
    }

    proptest! {
        #[test]
        fn any_attachment_survives_the_wire(sequence: i64, source_time_ns: i64, gid: [u8; 16]) {
            let attachment = Attachment { sequence, source_time_ns, gid };
            prop_assert_eq!(Attachment::from_bytes(&attachment.to_bytes()), Ok(attachment));
        }
    }
}
