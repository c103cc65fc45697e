//! Chunks: header, decompression and CRC, and the records inside.
//!
//! Done here rather than by the library's reader, which does not expect sizes that lie: nothing is allocated
//! before it was checked or read.

use std::io::Read;

use bytes::{Buf, Bytes};
use mcap::records::ChunkHeader;

/// Largest uncompressed chunk that is unpacked, bytes. Writers of the field use about 1 MiB.
pub(crate) const MAX_UNCOMPRESSED_BYTES: u64 = 256 << 20;

/// What is wrong with a chunk.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ChunkFault {
    /// The chunk's header is not whole.
    #[error("chunk header is cut")]
    CutHeader,
    /// The chunk claims more than is sensible.
    #[error("chunk claims {claimed_bytes} bytes uncompressed, at most {MAX_UNCOMPRESSED_BYTES} are read")]
    TooLarge {
        /// What it claims.
        claimed_bytes: u64,
    },
    /// The chunk's compression is none that we know.
    #[error("chunk compression {0:?} is unknown: this build reads none, lz4 and zstd")]
    UnknownCompression(String),
    /// The compressed data is damaged or cut.
    #[error("chunk does not decompress: {0}")]
    Undecompressable(String),
    /// The data is not as long as the header says.
    #[error("chunk holds {found_bytes} bytes, its header says {claimed_bytes}")]
    WrongLength {
        /// What the header says.
        claimed_bytes: u64,
        /// What there is.
        found_bytes: u64,
    },
    /// A bit has changed.
    #[error("chunk CRC failed: stored {stored:08x}, calculated {calculated:08x}")]
    Crc {
        /// In the chunk's header.
        stored: u32,
        /// Of the data.
        calculated: u32,
    },
}

/// Splits a chunk record into its header and its data, which may be cut.
pub(crate) fn split(mut body: Bytes) -> Result<(ChunkHeader, Bytes), ChunkFault> {
    let fixed_bytes = 8 + 8 + 8 + 4 + 4;
    if body.remaining() < fixed_bytes {
        return Err(ChunkFault::CutHeader);
    }
    let message_start_time = body.get_u64_le();
    let message_end_time = body.get_u64_le();
    let uncompressed_size = body.get_u64_le();
    let uncompressed_crc = body.get_u32_le();
    let name_bytes = body.get_u32_le() as usize;
    if body.remaining() < name_bytes.saturating_add(8) {
        return Err(ChunkFault::CutHeader);
    }
    let compression = String::from_utf8_lossy(&body.split_to(name_bytes)).into_owned();
    let compressed_size = body.get_u64_le();
    let data_bytes = usize::try_from(compressed_size).map_or(body.len(), |size| size.min(body.len()));
    let data = body.split_to(data_bytes);
    let header = ChunkHeader {
        message_start_time,
        message_end_time,
        uncompressed_size,
        uncompressed_crc,
        compression,
        compressed_size,
    };
    Ok((header, data))
}

/// Decompresses a chunk. With a fault, what could be had is returned beside it; only after
/// [`ChunkFault::WrongLength`] and [`ChunkFault::Undecompressable`] of a cut chunk is that worth anything.
pub(crate) fn unpack(header: &ChunkHeader, data: &Bytes) -> (Bytes, Option<ChunkFault>) {
    let claimed_bytes = header.uncompressed_size;
    if claimed_bytes > MAX_UNCOMPRESSED_BYTES {
        return (Bytes::new(), Some(ChunkFault::TooLarge { claimed_bytes }));
    }
    let (plain, fault) = match header.compression.as_str() {
        "" => (data.clone(), None),
        "zstd" => match zstd::Decoder::new(data.as_ref()) {
            Ok(decoder) => read_all(decoder.single_frame(), claimed_bytes),
            Err(error) => (Bytes::new(), Some(ChunkFault::Undecompressable(error.to_string()))),
        },
        "lz4" => match lz4::Decoder::new(data.as_ref()) {
            Ok(decoder) => read_all(decoder, claimed_bytes),
            Err(error) => (Bytes::new(), Some(ChunkFault::Undecompressable(error.to_string()))),
        },
        other => (Bytes::new(), Some(ChunkFault::UnknownCompression(other.to_owned()))),
    };
    let fault = fault.or_else(|| verify(header, &plain));
    (plain, fault)
}

fn read_all(decoder: impl Read, claimed_bytes: u64) -> (Bytes, Option<ChunkFault>) {
    let mut plain = Vec::new();
    // One more than claimed, so that too much shows as a wrong length.
    let outcome = decoder.take(claimed_bytes + 1).read_to_end(&mut plain);
    (plain.into(), outcome.err().map(|error| ChunkFault::Undecompressable(error.to_string())))
}

fn verify(header: &ChunkHeader, plain: &[u8]) -> Option<ChunkFault> {
    let (claimed_bytes, found_bytes) = (header.uncompressed_size, plain.len() as u64);
    if claimed_bytes != found_bytes {
        return Some(ChunkFault::WrongLength { claimed_bytes, found_bytes });
    }
    let stored = header.uncompressed_crc;
    // Zero means "not calculated" (MCAP specification, Chunk).
    let calculated = if stored == 0 { 0 } else { crc32fast::hash(plain) };
    (stored != calculated).then_some(ChunkFault::Crc { stored, calculated })
}

/// A record within a chunk.
#[derive(Debug, Clone)]
pub(crate) struct InnerRecord {
    pub(crate) opcode: u8,
    pub(crate) body: Bytes,
}

/// Takes the next whole record off the front of `plain`; `None` when there is none, with the rest left.
pub(crate) fn take_record(plain: &mut Bytes) -> Option<InnerRecord> {
    let mut rest = plain.clone();
    if rest.remaining() < 9 {
        return None;
    }
    let opcode = rest.get_u8();
    let body_bytes = usize::try_from(rest.get_u64_le()).ok().filter(|&bytes| bytes <= rest.len())?;
    let body = rest.split_to(body_bytes);
    *plain = rest;
    Some(InnerRecord { opcode, body })
}
