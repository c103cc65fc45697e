//! The summary section against what the data section holds.

use std::collections::BTreeMap;

use mcap::records::{AttachmentIndex, ChunkIndex, Footer, MetadataIndex, Record, Statistics, SummaryOffset};

use super::{
    Aspect, Check, Severity,
    structure::{ChunkSeen, NamedSeen, Tally},
};
use crate::scan::RawRecord;

/// The summary section's records.
#[derive(Debug, Default)]
pub(super) struct Summary {
    /// Where the section begins, bytes.
    pub(super) begins_at: u64,
    statistics: Option<Statistics>,
    chunk_indexes: Vec<ChunkIndex>,
    attachment_indexes: Vec<AttachmentIndex>,
    metadata_indexes: Vec<MetadataIndex>,
    offsets: Vec<SummaryOffset>,
    offsets_begin_at: Option<u64>,
    /// Where the records of each opcode lie, from and to.
    groups: BTreeMap<u8, (u64, u64)>,
}

impl Summary {
    pub(super) fn note(&mut self, record: &RawRecord, parsed: Record<'static>) {
        if !matches!(parsed, Record::SummaryOffset(_)) {
            let group = self.groups.entry(record.opcode).or_insert((record.offset, record.offset));
            group.1 = record.end();
        }
        match parsed {
            Record::Statistics(statistics) => self.statistics = Some(statistics),
            Record::ChunkIndex(index) => self.chunk_indexes.push(index),
            Record::AttachmentIndex(index) => self.attachment_indexes.push(index),
            Record::MetadataIndex(index) => self.metadata_indexes.push(index),
            Record::SummaryOffset(offset) => {
                self.offsets_begin_at.get_or_insert(record.offset);
                self.offsets.push(offset);
            }
            _ => {}
        }
    }

    pub(super) fn check(&self, footer_record: &RawRecord, footer: &Footer, tally: &Tally, check: &mut Check) {
        let mut wrong =
            |message: String| check.add(Severity::Error, Aspect::Summary, footer_record.offset, message);
        let expected_start = if self.groups.is_empty() { 0 } else { self.begins_at };
        if footer.summary_start != expected_start {
            wrong(format!(
                "the footer says the summary begins at {}, it does at {expected_start}",
                footer.summary_start
            ));
        }
        if footer.summary_offset_start != 0
            && self.offsets_begin_at.is_some_and(|at| at != footer.summary_offset_start)
        {
            wrong(format!("the footer's summary offsets do not begin at {}", footer.summary_offset_start));
        }
        if let Some(statistics) = &self.statistics {
            compare_statistics(statistics, tally, &mut wrong);
        }
        self.check_chunk_indexes(tally, &mut wrong);
        let attachments =
            self.attachment_indexes.iter().map(|index| (index.offset, index.length, &index.name));
        compare_named("attachment", attachments, &tally.attachments, &mut wrong);
        let metadata = self.metadata_indexes.iter().map(|index| (index.offset, index.length, &index.name));
        compare_named("metadata", metadata, &tally.metadata, &mut wrong);
        for offset in &self.offsets {
            let claimed = (offset.group_start, offset.group_start.saturating_add(offset.group_length));
            if self.groups.get(&offset.group_opcode) != Some(&claimed) {
                wrong(format!("the summary offset of records 0x{:02x} is wrong", offset.group_opcode));
            }
        }
    }

    fn check_chunk_indexes(&self, tally: &Tally, wrong: &mut impl FnMut(String)) {
        if !self.chunk_indexes.is_empty() && self.chunk_indexes.len() != tally.chunks.len() {
            wrong(format!("{} chunks, but {} chunk indexes", tally.chunks.len(), self.chunk_indexes.len()));
        }
        for index in &self.chunk_indexes {
            match tally.chunks.get(&index.chunk_start_offset) {
                None => wrong(format!(
                    "a chunk index points to byte {}, where no chunk is",
                    index.chunk_start_offset
                )),
                Some(chunk) if !describes(index, chunk) => {
                    wrong(format!(
                        "the index of the chunk at byte {} does not describe it",
                        index.chunk_start_offset
                    ));
                }
                Some(_) => {}
            }
        }
    }
}

fn compare_statistics(statistics: &Statistics, tally: &Tally, wrong: &mut impl FnMut(String)) {
    let (start_ns, end_ns) = tally.log_span_ns.unwrap_or((0, 0));
    let pairs = [
        ("messages", statistics.message_count, tally.messages_by_channel.values().sum()),
        ("schemas", statistics.schema_count.into(), tally.schemas.len() as u64),
        ("channels", statistics.channel_count.into(), tally.channels.len() as u64),
        ("attachments", statistics.attachment_count.into(), tally.attachments.len() as u64),
        ("metadata records", statistics.metadata_count.into(), tally.metadata.len() as u64),
        ("chunks", statistics.chunk_count.into(), tally.chunks.len() as u64),
        ("first log time", statistics.message_start_time, start_ns),
        ("last log time", statistics.message_end_time, end_ns),
    ];
    for (what, claimed, found) in pairs {
        if claimed != found {
            wrong(format!("statistics say {what} {claimed}, the file has {found}"));
        }
    }
    for (channel, claimed) in &statistics.channel_message_counts {
        let found = tally.messages_by_channel.get(channel).copied().unwrap_or(0);
        if *claimed != found {
            wrong(format!("statistics say {claimed} messages on channel {channel}, the file has {found}"));
        }
    }
}

fn describes(index: &ChunkIndex, chunk: &ChunkSeen) -> bool {
    let header = &chunk.header;
    let offsets_fit =
        index.message_index_offsets.is_empty() || index.message_index_offsets == chunk.index_offsets;
    offsets_fit
        && index.chunk_length == chunk.record_bytes
        && (index.message_index_length == 0 || index.message_index_length == chunk.index_bytes)
        && index.compression == header.compression
        && index.compressed_size == header.compressed_size
        && index.uncompressed_size == header.uncompressed_size
        && (index.message_start_time, index.message_end_time)
            == (header.message_start_time, header.message_end_time)
}

fn compare_named<'a>(
    what: &str,
    indexes: impl Iterator<Item = (u64, u64, &'a String)>,
    found: &BTreeMap<u64, NamedSeen>,
    wrong: &mut impl FnMut(String),
) {
    for (offset, length, name) in indexes {
        if !found.get(&offset).is_some_and(|seen| seen.name == *name && seen.record_bytes == length) {
            wrong(format!("the {what} index {name:?} points to byte {offset}, where it is not"));
        }
    }
}
