//! Framing of MCAP records, straight from the file: opcode, length, body, and where each begins.
//!
//! Unlike the library's readers it survives what a crash leaves behind, and never allocates more than the
//! file is long. (MCAP specification, "Records": opcode `u8`, length `u64`, content.)

use std::{
    fs::File,
    io::{self, BufReader, Read},
    path::Path,
};

use bytes::Bytes;
use mcap::{
    McapError,
    records::{Record, op},
};

use crate::RecordingError;

/// Opcode and length.
const PREFIX_BYTES: u64 = 9;

/// An attachment's fixed fields: two times, two empty strings, data length, CRC.
const ATTACHMENT_LEAST_BYTES: usize = 8 + 8 + 4 + 4 + 8 + 4;

/// One record as it lies in the file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RawRecord {
    /// Where it begins in the file, bytes.
    pub offset: u64,
    /// What it is; see the MCAP specification.
    pub opcode: u8,
    /// Its content.
    pub body: Bytes,
}

impl RawRecord {
    /// Where the next record begins, bytes.
    pub fn end(&self) -> u64 {
        self.offset + PREFIX_BYTES + self.body.len() as u64
    }
}

/// Parses a record's fields. Attachment CRCs are checked, chunk CRCs are not.
pub fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, McapError> {
    // The library subtracts the attachment's CRC from the length without looking.
    if opcode == op::ATTACHMENT && body.len() < ATTACHMENT_LEAST_BYTES {
        return Err(McapError::UnexpectedEof);
    }
    mcap::parse_record(opcode, body)
}

/// How a file ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// With the closing magic bytes.
    Complete,
    /// Anywhere else: cut, or still being written.
    Cut {
        /// First byte that belongs to no whole record.
        offset: u64,
        /// What there is of the record cut, its body shorter than it should be.
        partial: Option<RawRecord>,
    },
}

/// Reads records one after the other.
#[derive(Debug)]
pub struct Scanner<R> {
    source: R,
    offset: u64,
    length: u64,
    end: Option<End>,
}

impl Scanner<BufReader<File>> {
    /// Opens `path` and checks that it begins as MCAP does.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let file = File::open(path).map_err(RecordingError::io("cannot open", path))?;
        let length = file.metadata().map_err(RecordingError::io("cannot read the size of", path))?.len();
        Self::new(BufReader::with_capacity(64 << 10, file), length).map_err(|error| match error.kind() {
            io::ErrorKind::InvalidData => RecordingError::NotMcap(path.to_owned()),
            _ => RecordingError::io("cannot read", path)(error),
        })
    }
}

impl<R: Read> Scanner<R> {
    /// Scans `source`, which holds `length` bytes. A source cut within the opening magic bytes is cut, not
    /// foreign.
    pub fn new(mut source: R, length: u64) -> io::Result<Self> {
        let mut magic = [0; 8];
        let read = read_up_to(&mut source, &mut magic)?;
        if magic[..read] != mcap::MAGIC[..read] {
            return Err(io::ErrorKind::InvalidData.into());
        }
        let end = (read < magic.len()).then_some(End::Cut { offset: 0, partial: None });
        Ok(Self { source, offset: mcap::MAGIC.len() as u64, length, end })
    }

    /// The next whole record; `None` at the end, which [`Scanner::end`] then describes.
    pub fn next_record(&mut self) -> io::Result<Option<RawRecord>> {
        if self.end.is_some() {
            return Ok(None);
        }
        let mut prefix = [0; PREFIX_BYTES as usize];
        let read = read_up_to(&mut self.source, &mut prefix)?;
        if read < prefix.len() {
            let complete = prefix[..read] == *mcap::MAGIC;
            let cut = End::Cut { offset: self.offset, partial: None };
            self.end = Some(if complete { End::Complete } else { cut });
            return Ok(None);
        }
        let [opcode, length @ ..] = prefix;
        let claimed_bytes = u64::from_le_bytes(length);
        let available_bytes = claimed_bytes.min(self.length.saturating_sub(self.offset + PREFIX_BYTES));
        let mut body = vec![0; usize::try_from(available_bytes).map_err(io::Error::other)?];
        let read = read_up_to(&mut self.source, &mut body)?;
        body.truncate(read);
        let record = RawRecord { offset: self.offset, opcode, body: body.into() };
        if (record.body.len() as u64) < claimed_bytes {
            self.end = Some(End::Cut { offset: self.offset, partial: Some(record) });
            return Ok(None);
        }
        self.offset = record.end();
        Ok(Some(record))
    }

    /// Length of the source, bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// How the file ended, once [`Scanner::next_record`] has returned `None`.
    pub fn end(&self) -> Option<&End> {
        self.end.as_ref()
    }
}

/// Reads until `buffer` is full or the source ends.
fn read_up_to(source: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        match source.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(read) => filled += read,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}
