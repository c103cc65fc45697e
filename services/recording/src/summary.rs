//! The summary section of a finished recording: what it holds, without reading it all.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::Path,
};

use bytes::Bytes;
use mcap::records::{ChunkIndex, Footer, Record, Statistics, op};

use crate::{RecordingError, chunk, scan};

/// Largest summary that is read, bytes: a drive of a day has a few megabytes.
const MAX_SUMMARY_BYTES: u64 = 256 << 20;

/// The footer record: opcode, length, two offsets, CRC.
const FOOTER_BYTES: u64 = 9 + 8 + 8 + 4;

/// A finished recording's own account of its contents.
#[derive(Debug, Default)]
pub struct Summary {
    pub(crate) declarations: Vec<Record<'static>>,
    pub(crate) chunks: Vec<ChunkIndex>,
    statistics: Option<Statistics>,
    topics_by_channel: BTreeMap<u16, String>,
}

impl Summary {
    /// Reads the summary of `path`; `None` when it has none, because it is unfinished, cut or foreign.
    pub fn read(path: &Path) -> Result<Option<Self>, RecordingError> {
        let mut file = File::open(path).map_err(RecordingError::io("cannot open", path))?;
        Self::read_from(&mut file).map_err(RecordingError::io("cannot read", path))
    }

    pub(crate) fn read_from(file: &mut (impl Read + Seek)) -> io::Result<Option<Self>> {
        let length = file.seek(SeekFrom::End(0))?;
        let Some(footer_at) = length.checked_sub(FOOTER_BYTES + mcap::MAGIC.len() as u64) else {
            return Ok(None);
        };
        let Some(footer) = read_footer(file, footer_at)? else { return Ok(None) };
        let summary_bytes = footer_at.saturating_sub(footer.summary_start);
        if footer.summary_start == 0 || summary_bytes == 0 || summary_bytes > MAX_SUMMARY_BYTES {
            return Ok(None);
        }
        file.seek(SeekFrom::Start(footer.summary_start))?;
        let mut section = vec![0; usize::try_from(summary_bytes).map_err(io::Error::other)?];
        file.read_exact(&mut section)?;
        Ok(Some(Self::from_section(section.into())))
    }

    /// Messages on each topic.
    pub fn messages_by_topic(&self) -> BTreeMap<&str, u64> {
        let mut by_topic = BTreeMap::new();
        let counts = self.statistics.iter().flat_map(|statistics| &statistics.channel_message_counts);
        for (channel, messages) in counts {
            if let Some(topic) = self.topics_by_channel.get(channel) {
                *by_topic.entry(topic.as_str()).or_default() += messages;
            }
        }
        by_topic
    }

    /// Earliest and latest log time, nanoseconds since the Unix epoch; `None` without messages.
    pub fn log_span_ns(&self) -> Option<(u64, u64)> {
        let statistics = self.statistics.as_ref().filter(|statistics| statistics.message_count > 0)?;
        Some((statistics.message_start_time, statistics.message_end_time))
    }

    /// Channels of `topic`; usually one.
    pub(crate) fn channels_of<'a>(&'a self, topic: &'a str) -> impl Iterator<Item = u16> + 'a {
        self.topics_by_channel.iter().filter(move |(_, known)| *known == topic).map(|(channel, _)| *channel)
    }

    /// The topic of a channel.
    pub(crate) fn topic_of(&self, channel: u16) -> Option<&str> {
        self.topics_by_channel.get(&channel).map(String::as_str)
    }

    /// Whether every chunk that holds messages says where.
    pub(crate) fn indexes_messages(&self) -> bool {
        let is_empty = |chunk: &ChunkIndex| chunk.message_end_time == 0;
        self.chunks.iter().all(|chunk| is_empty(chunk) || !chunk.message_index_offsets.is_empty())
    }

    /// Whether every message can be found through chunk indexes.
    pub(crate) fn indexes_everything(&self) -> bool {
        let chunks = self.statistics.as_ref().map_or(0, |statistics| statistics.chunk_count as usize);
        chunks > 0 && chunks == self.chunks.len()
    }

    fn from_section(mut section: Bytes) -> Self {
        let mut summary = Self::default();
        while let Some(record) = chunk::take_record(&mut section) {
            // A record that cannot be read is left out, as if the writer had not written it.
            let Ok(parsed) = scan::parse(record.opcode, &record.body) else { continue };
            match parsed.into_owned() {
                Record::ChunkIndex(index) => summary.chunks.push(index),
                Record::Statistics(statistics) => summary.statistics = Some(statistics),
                Record::Channel(channel) => {
                    summary.topics_by_channel.insert(channel.id, channel.topic.clone());
                    summary.declarations.push(Record::Channel(channel));
                }
                schema @ Record::Schema { .. } => summary.declarations.push(schema),
                _ => {}
            }
        }
        summary
    }
}

fn read_footer(file: &mut (impl Read + Seek), at: u64) -> io::Result<Option<Footer>> {
    file.seek(SeekFrom::Start(at))?;
    let mut end = Vec::new();
    file.read_to_end(&mut end)?;
    let mut end = Bytes::from(end);
    let footer = chunk::take_record(&mut end).filter(|record| record.opcode == op::FOOTER);
    let footer = footer.filter(|_| end == mcap::MAGIC);
    Ok(footer.and_then(|record| match scan::parse(record.opcode, &record.body) {
        Ok(Record::Footer(footer)) => Some(footer),
        _ => None,
    }))
}
