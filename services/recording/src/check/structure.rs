//! Records, chunks and CRCs: what the data section holds, and whether the summary says the same.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::{self, Read},
};

use bytes::Bytes;
use crc32fast::Hasher;
use mcap::records::{ChunkHeader, Footer, MessageHeader, MessageIndex, Record, op};

use super::{Aspect, Check, Severity, summary};
use crate::{
    chunk::{self, ChunkFault},
    scan::{self, End, RawRecord, Scanner},
};

/// What is really in the data section, to hold the summary against.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub(super) schemas: BTreeSet<u16>,
    pub(super) channels: BTreeSet<u16>,
    pub(super) messages_by_channel: BTreeMap<u16, u64>,
    pub(super) log_span_ns: Option<(u64, u64)>,
    pub(super) chunks: BTreeMap<u64, ChunkSeen>,
    pub(super) attachments: BTreeMap<u64, NamedSeen>,
    pub(super) metadata: BTreeMap<u64, NamedSeen>,
}

/// A chunk and the message indexes behind it.
#[derive(Debug)]
pub(super) struct ChunkSeen {
    pub(super) header: ChunkHeader,
    pub(super) record_bytes: u64,
    pub(super) index_offsets: BTreeMap<u16, u64>,
    pub(super) index_bytes: u64,
    /// Log time and offset within the chunk of each message, by channel; `None` when it does not unpack.
    messages: Option<BTreeMap<u16, Vec<(u64, u64)>>>,
}

/// An attachment or metadata record.
#[derive(Debug)]
pub(super) struct NamedSeen {
    pub(super) name: String,
    pub(super) record_bytes: u64,
}

/// Where in the file we are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Section {
    Data,
    Summary,
    AfterFooter,
}

pub(super) fn check(scanner: &mut Scanner<impl Read>, check: &mut Check) -> io::Result<()> {
    let mut pass = Pass {
        check,
        tally: Tally::default(),
        section: Section::Data,
        data_crc: Hasher::new_with_initial(crc32fast::hash(mcap::MAGIC)),
        summary_crc: Hasher::new(),
        summary: summary::Summary::default(),
        open_chunk: None,
        records: 0,
    };
    while let Some(record) = scanner.next_record()? {
        pass.record(&record);
    }
    pass.end(scanner.end());
    Ok(())
}

struct Pass<'a> {
    check: &'a mut Check,
    tally: Tally,
    section: Section,
    data_crc: Hasher,
    summary_crc: Hasher,
    summary: summary::Summary,
    /// The chunk whose message indexes are being read.
    open_chunk: Option<u64>,
    records: u64,
}

impl Pass<'_> {
    fn record(&mut self, record: &RawRecord) {
        if self.records == 0 && record.opcode != op::HEADER {
            self.error(Aspect::Structure, record, "the first record is no header".to_owned());
        }
        self.records += 1;
        if record.opcode == op::CHUNK {
            self.chunk(record);
        } else {
            match scan::parse(record.opcode, &record.body) {
                Ok(parsed) => self.parsed(record, parsed),
                Err(error) => {
                    let aspect = match error {
                        mcap::McapError::BadAttachmentCrc { .. } => Aspect::Crc,
                        _ => Aspect::Structure,
                    };
                    let opcode = record.opcode;
                    self.error(aspect, record, format!("record 0x{opcode:02x} cannot be read: {error}"));
                }
            }
        }
        // The data CRC ends before the data end record, the summary's within the footer.
        match self.section {
            Section::Data => hash_record(&mut self.data_crc, record),
            Section::Summary if record.opcode != op::DATA_END => hash_record(&mut self.summary_crc, record),
            Section::Summary | Section::AfterFooter => {}
        }
    }

    fn parsed(&mut self, record: &RawRecord, parsed: Record<'_>) {
        match (self.section, parsed) {
            (Section::AfterFooter, _) => {
                self.error(Aspect::Structure, record, "a record follows the footer".to_owned());
            }
            (Section::Data, Record::DataEnd(end)) => {
                self.section = Section::Summary;
                self.summary.begins_at = record.end();
                let calculated = self.data_crc.clone().finalize();
                self.crc(record, "data section", end.data_section_crc, calculated);
            }
            (_, Record::Footer(footer)) => self.footer(record, &footer),
            (Section::Summary, parsed) => self.summary.note(record, parsed.into_owned()),
            (Section::Data, parsed) => self.data(record, parsed),
        }
    }

    fn data(&mut self, record: &RawRecord, parsed: Record<'_>) {
        let record_bytes = record.end() - record.offset;
        match parsed {
            Record::Schema { header, .. } => drop(self.tally.schemas.insert(header.id)),
            Record::Channel(channel) => drop(self.tally.channels.insert(channel.id)),
            Record::Message { header, .. } => self.tally.message(&header),
            Record::MessageIndex(index) => return self.message_index(record, &index),
            Record::Attachment { header, .. } => {
                let seen = NamedSeen { name: header.name, record_bytes };
                self.tally.attachments.insert(record.offset, seen);
            }
            Record::Metadata(metadata) => {
                let seen = NamedSeen { name: metadata.name, record_bytes };
                self.tally.metadata.insert(record.offset, seen);
            }
            _ => {}
        }
        self.open_chunk = None;
    }

    fn chunk(&mut self, record: &RawRecord) {
        self.open_chunk = None;
        let unpacked = chunk::split(record.body.clone()).and_then(|(header, data)| {
            let (plain, fault) = chunk::unpack(&header, &data);
            fault.map_or(Ok((header, plain)), Err)
        });
        match unpacked {
            Ok((header, plain)) => self.unpacked(record, header, plain),
            Err(fault) => {
                let aspect =
                    if matches!(fault, ChunkFault::Crc { .. }) { Aspect::Crc } else { Aspect::Structure };
                self.error(aspect, record, fault.to_string());
                self.tally.chunks.extend(
                    chunk::split(record.body.clone())
                        .ok()
                        .map(|(header, _)| (record.offset, ChunkSeen::new(header, record, None))),
                );
            }
        }
        self.open_chunk = Some(record.offset);
    }

    fn unpacked(&mut self, record: &RawRecord, header: ChunkHeader, mut plain: Bytes) {
        let uncompressed_bytes = plain.len();
        let mut messages: BTreeMap<u16, Vec<(u64, u64)>> = BTreeMap::new();
        loop {
            let offset = (uncompressed_bytes - plain.len()) as u64;
            let Some(inner) = chunk::take_record(&mut plain) else { break };
            match scan::parse(inner.opcode, &inner.body) {
                Ok(Record::Schema { header, .. }) => drop(self.tally.schemas.insert(header.id)),
                Ok(Record::Channel(channel)) => drop(self.tally.channels.insert(channel.id)),
                Ok(Record::Message { header, .. }) => {
                    self.tally.message(&header);
                    messages.entry(header.channel_id).or_default().push((header.log_time, offset));
                }
                Ok(Record::Unknown { .. }) => {}
                Ok(_) => {
                    let message = format!("record 0x{:02x} may not stand in a chunk", inner.opcode);
                    self.error(Aspect::Structure, record, message);
                }
                Err(error) => self.error(Aspect::Structure, record, format!("record in chunk: {error}")),
            }
        }
        if !plain.is_empty() {
            let message = format!("{} bytes at the end of the chunk are no record", plain.len());
            self.error(Aspect::Structure, record, message);
        }
        self.chunk_times(record, &header, &messages);
        self.tally.chunks.insert(record.offset, ChunkSeen::new(header, record, Some(messages)));
    }

    fn chunk_times(
        &mut self,
        record: &RawRecord,
        header: &ChunkHeader,
        messages: &BTreeMap<u16, Vec<(u64, u64)>>,
    ) {
        let times = || messages.values().flatten().map(|(log_time_ns, _)| *log_time_ns);
        let found = times().min().zip(times().max()).unwrap_or((0, 0));
        let claimed = (header.message_start_time, header.message_end_time);
        if claimed != found {
            let message = format!("chunk header says log times {claimed:?}, its messages have {found:?}");
            self.error(Aspect::Time, record, message);
        }
    }

    fn message_index(&mut self, record: &RawRecord, index: &MessageIndex) {
        let chunk = self.open_chunk.and_then(|offset| self.tally.chunks.get_mut(&offset));
        let Some(chunk) = chunk else {
            return self.error(Aspect::Summary, record, "a message index follows no chunk".to_owned());
        };
        chunk.index_offsets.insert(index.channel_id, record.offset);
        chunk.index_bytes += record.end() - record.offset;
        let Some(messages) = &chunk.messages else { return };
        let mut found = messages.get(&index.channel_id).cloned().unwrap_or_default();
        let mut claimed: Vec<_> = index.records.iter().map(|entry| (entry.log_time, entry.offset)).collect();
        found.sort_unstable();
        claimed.sort_unstable();
        if found != claimed {
            let message = format!("the message index of channel {} does not fit its chunk", index.channel_id);
            self.error(Aspect::Summary, record, message);
        }
    }

    fn footer(&mut self, record: &RawRecord, footer: &Footer) {
        if self.section == Section::Data {
            self.error(Aspect::Structure, record, "the footer follows no data end record".to_owned());
        }
        // Up to and including `summary_offset_start` (MCAP specification, Footer).
        let mut crc = self.summary_crc.clone();
        crc.update(&prefix(record));
        crc.update(&record.body[..16]);
        self.crc(record, "summary section", footer.summary_crc, crc.finalize());
        self.summary.check(record, footer, &self.tally, self.check);
        self.section = Section::AfterFooter;
    }

    fn end(&mut self, end: Option<&End>) {
        match end {
            Some(End::Complete) if self.section == Section::AfterFooter => {}
            Some(End::Complete) | None => {
                self.check.add(Severity::Error, Aspect::Structure, None, "there is no footer".to_owned());
            }
            Some(End::Cut { offset, .. }) => {
                let message = "file ends here, without footer: it was cut, or is still being written; \
                               `waymark recording recover` makes a valid file of it";
                self.check.add(Severity::Error, Aspect::Structure, *offset, message.to_owned());
            }
        }
    }

    /// Zero means "not calculated" throughout MCAP.
    fn crc(&mut self, record: &RawRecord, what: &str, stored: u32, calculated: u32) {
        if stored != 0 && stored != calculated {
            let message = format!("{what} CRC failed: stored {stored:08x}, calculated {calculated:08x}");
            self.error(Aspect::Crc, record, message);
        }
    }

    fn error(&mut self, aspect: Aspect, record: &RawRecord, message: String) {
        self.check.add(Severity::Error, aspect, record.offset, message);
    }
}

impl Tally {
    fn message(&mut self, header: &MessageHeader) {
        *self.messages_by_channel.entry(header.channel_id).or_default() += 1;
        let (first, last) = self.log_span_ns.unwrap_or((header.log_time, header.log_time));
        self.log_span_ns = Some((first.min(header.log_time), last.max(header.log_time)));
    }
}

impl ChunkSeen {
    fn new(
        header: ChunkHeader,
        record: &RawRecord,
        messages: Option<BTreeMap<u16, Vec<(u64, u64)>>>,
    ) -> Self {
        let record_bytes = record.end() - record.offset;
        Self { header, record_bytes, index_offsets: BTreeMap::new(), index_bytes: 0, messages }
    }
}

/// Opcode and length as they stand before the body.
fn prefix(record: &RawRecord) -> [u8; 9] {
    let mut prefix = [record.opcode; 9];
    prefix[1..].copy_from_slice(&(record.body.len() as u64).to_le_bytes());
    prefix
}

fn hash_record(crc: &mut Hasher, record: &RawRecord) {
    crc.update(&prefix(record));
    crc.update(&record.body);
}
