//! When each message was logged, topic by topic in file order: what a cursor or a scrubber needs, without the messages.

use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    ops::Range,
    path::Path,
};

use mcap::records::{ChunkIndex, Record};

use crate::{
    RecordingError,
    excerpt::{Excerpt, Selection},
    reader::{MessageReader, Strictness},
    scan,
    summary::Summary,
    walk::RecordedMessage,
};

/// Opcode and length of a record.
const PREFIX_BYTES: usize = 9;

/// Log times of a recording, nanoseconds since the Unix epoch.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Timeline {
    by_topic: BTreeMap<String, Vec<u64>>,
}

impl Timeline {
    /// Reads it from the message indexes of a finished recording, and from all of its messages where there are none.
    ///
    /// # Errors
    /// When the file cannot be read or is no MCAP file.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let unreadable = |error| RecordingError::io("cannot read", path)(error);
        let mut file = File::open(path).map_err(RecordingError::io("cannot open", path))?;
        let summary = Summary::read_from(&mut file).map_err(unreadable)?;
        match summary.filter(|summary| summary.indexes_everything() && summary.indexes_messages()) {
            Some(summary) => Self::from_indexes(&mut file, &summary).map_err(unreadable),
            None => Self::from_messages(path),
        }
    }

    /// Topics that have messages.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.by_topic.keys().map(String::as_str)
    }

    /// Log times of the messages of `topic`, in file order.
    #[must_use]
    pub fn of(&self, topic: &str) -> &[u64] {
        self.by_topic.get(topic).map_or(&[], Vec::as_slice)
    }

    /// The messages of `topic` with these places in file order, read from the file at `path` this was read from.
    ///
    /// # Errors
    /// When the file cannot be opened.
    pub fn messages(
        &self,
        path: &Path,
        topic: &str,
        wanted: Range<usize>,
    ) -> Result<impl Iterator<Item = Result<RecordedMessage, RecordingError>> + use<>, RecordingError> {
        let times = self.of(topic);
        let wanted = wanted.start.min(times.len())..wanted.end.min(times.len());
        let (first, last) = times[wanted.clone()]
            .iter()
            .fold((u64::MAX, 0), |(first, last), &time| (first.min(time), last.max(time)));
        let log_time_ns = first..last.saturating_add(1);
        // The clock may have been set back, so that earlier messages have these times too.
        let skipped = times[..wanted.start].iter().filter(|time| log_time_ns.contains(time)).count();
        let selection = Selection { topics: Some([topic.to_owned()].into()), log_time_ns };
        Ok(Excerpt::open(path, selection)?.skip(skipped).take(wanted.len()))
    }

    fn from_messages(path: &Path) -> Result<Self, RecordingError> {
        let mut timeline = Self::default();
        for message in MessageReader::open(path, Strictness::Lenient)? {
            let message = message?;
            timeline.add(&message.channel.topic, message.log_time_ns);
        }
        Ok(timeline)
    }

    fn from_indexes(file: &mut File, summary: &Summary) -> io::Result<Self> {
        let mut timeline = Self::default();
        let mut chunks: Vec<&ChunkIndex> = summary.chunks.iter().collect();
        chunks.sort_by_key(|chunk| chunk.chunk_start_offset);
        for chunk in chunks {
            let mut messages = Vec::new();
            for (channel, &offset) in &chunk.message_index_offsets {
                let Some(topic) = summary.topic_of(*channel) else { continue };
                let entries = read_index(file, offset)?;
                messages.extend(entries.into_iter().map(|(offset, time)| (offset, time, topic)));
            }
            messages.sort_unstable();
            for (_, time, topic) in messages {
                timeline.add(topic, time);
            }
        }
        Ok(timeline)
    }

    fn add(&mut self, topic: &str, log_time_ns: u64) {
        match self.by_topic.get_mut(topic) {
            Some(times) => times.push(log_time_ns),
            None => drop(self.by_topic.insert(topic.to_owned(), vec![log_time_ns])),
        }
    }
}

/// Offset within the chunk and log time of each message of one channel.
fn read_index(file: &mut File, offset: u64) -> io::Result<Vec<(u64, u64)>> {
    let left_bytes = file.metadata()?.len().saturating_sub(offset);
    file.seek(SeekFrom::Start(offset))?;
    let mut prefix = [0; PREFIX_BYTES];
    file.read_exact(&mut prefix)?;
    let [opcode, length @ ..] = prefix;
    let length = u64::from_le_bytes(length);
    if length > left_bytes {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    let mut body = vec![0; usize::try_from(length).map_err(io::Error::other)?];
    file.read_exact(&mut body)?;
    match scan::parse(opcode, &body) {
        Ok(Record::MessageIndex(index)) => {
            Ok(index.records.into_iter().map(|entry| (entry.offset, entry.log_time)).collect())
        }
        _ => Err(io::Error::new(
            io::ErrorKind::InvalidData,
            "there is no message index where the summary says",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{at_ms, channel, latched, message, names, options, read_strictly, recorder};

    fn finished(directory: &Path) -> std::path::PathBuf {
        let mut options = options(directory);
        options.writer.chunk_bytes = 3_000;
        let mut recorder = recorder(options);
        let (image, log, landmark) = (channel("/image"), channel("/log"), channel("/landmark"));
        for n in 0..100 {
            // Every tenth message is from before the clock was set back.
            let moved = if n % 10 == 3 { n + 40 } else { n };
            recorder.store(vec![message(&image, moved, 700)], at_ms(0));
            if n % 7 == 0 {
                recorder.store(vec![message(&log, n, 20)], at_ms(0));
            }
            if n % 40 == 0 {
                recorder.store(vec![latched(&landmark, n, "red")], at_ms(0));
            }
        }
        recorder.finish(at_ms(1));
        directory.join(names(directory).pop().unwrap())
    }

    #[test]
    fn indexes_say_what_the_messages_say_also_of_a_cut_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = finished(directory.path());
        let timeline = Timeline::read(&path).unwrap();
        assert_eq!(timeline, Timeline::from_messages(&path).unwrap());
        assert_eq!(timeline.of("/image").len(), 100);
        assert_eq!(timeline.of("/none"), [0_u64; 0]);
        let content = std::fs::read(&path).unwrap();
        std::fs::write(&path, &content[..content.len() - 5]).unwrap();
        assert_eq!(Timeline::read(&path).unwrap(), timeline);
    }

    #[test]
    fn every_range_of_places_gives_the_messages_that_stand_there() {
        let directory = tempfile::tempdir().unwrap();
        let path = finished(directory.path());
        let timeline = Timeline::read(&path).unwrap();
        for topic in ["/image", "/log"] {
            let all: Vec<_> =
                read_strictly(&path).into_iter().filter(|message| message.channel.topic == topic).collect();
            for start in [0, 1, 6, 13, 14, 43, 99, 200] {
                for length in [0, 1, 12, 300] {
                    let found: Vec<_> = timeline
                        .messages(&path, topic, start..start + length)
                        .unwrap()
                        .map(Result::unwrap)
                        .collect();
                    let expected: Vec<_> = all.iter().skip(start).take(length).cloned().collect();
                    assert_eq!(found, expected, "{topic} {start} {length}");
                }
            }
        }
    }
}
