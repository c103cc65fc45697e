//! Part of a recording: some topics, some time. Of a finished file only the chunks that matter are read.

use std::{
    collections::{BTreeSet, VecDeque},
    fs::File,
    io::{self, BufReader, Read, Seek, SeekFrom},
    ops::Range,
    path::{Path, PathBuf},
};

use mcap::records::ChunkIndex;

use crate::{
    RecordingError,
    reader::{MessageReader, Strictness},
    scan::Scanner,
    summary::Summary,
    walk::{CutChunk, RecordedMessage, Step, Walk},
};

/// Which messages are wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Selection {
    /// Topics; `None` for all.
    pub topics: Option<BTreeSet<String>>,
    /// Log times, nanoseconds since the Unix epoch.
    pub log_time_ns: Range<u64>,
}

impl Selection {
    fn wants(&self, message: &RecordedMessage) -> bool {
        let topics = self.topics.as_ref();
        self.log_time_ns.contains(&message.log_time_ns)
            && topics.is_none_or(|topics| topics.contains(&message.channel.topic))
    }

    fn may_be_in(&self, chunk: &ChunkIndex, channels: Option<&BTreeSet<u16>>) -> bool {
        // Without message indexes a chunk does not say which channels it has.
        let has = |channels: &BTreeSet<u16>| {
            chunk.message_index_offsets.is_empty()
                || chunk.message_index_offsets.keys().any(|channel| channels.contains(channel))
        };
        chunk.message_start_time < self.log_time_ns.end
            && chunk.message_end_time >= self.log_time_ns.start
            && channels.is_none_or(has)
    }
}

/// An iterator over the selected messages, in file order. Faults end it, except that an unfinished file ends
/// where it ends.
pub struct Excerpt {
    source: Source,
    selection: Selection,
    path: PathBuf,
    ended: bool,
}

enum Source {
    Indexed(Box<Walk<BufReader<Pieces>>>),
    Linear(Box<MessageReader>),
}

impl Excerpt {
    /// Opens `path`.
    pub fn open(path: &Path, selection: Selection) -> Result<Self, RecordingError> {
        let mut file = File::open(path).map_err(RecordingError::io("cannot open", path))?;
        let summary = Summary::read_from(&mut file).map_err(RecordingError::io("cannot read", path))?;
        let source = match summary.filter(Summary::indexes_everything) {
            Some(summary) => Source::Indexed(Box::new(
                indexed(file, path, &summary, &selection).map_err(RecordingError::io("cannot read", path))?,
            )),
            None => Source::Linear(Box::new(MessageReader::open(path, Strictness::Lenient)?)),
        };
        Ok(Self { source, selection, path: path.to_owned(), ended: false })
    }

    fn next_message(&mut self) -> Result<Option<RecordedMessage>, RecordingError> {
        loop {
            let message = match &mut self.source {
                Source::Linear(reader) => reader.next().transpose()?,
                Source::Indexed(walk) => next_in(walk, &self.path)?,
            };
            match message {
                Some(message) if !self.selection.wants(&message) => {}
                found_or_end => return Ok(found_or_end),
            }
        }
    }
}

impl Iterator for Excerpt {
    type Item = Result<RecordedMessage, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.next_message().transpose();
        self.ended = !matches!(next, Some(Ok(_)));
        next
    }
}

/// A walk over the wanted chunks alone, with all channels known beforehand.
fn indexed(
    file: File,
    path: &Path,
    summary: &Summary,
    selection: &Selection,
) -> io::Result<Walk<BufReader<Pieces>>> {
    let of_topics = |topics: &BTreeSet<String>| topics.iter().flat_map(|t| summary.channels_of(t)).collect();
    let channels: Option<BTreeSet<u16>> = selection.topics.as_ref().map(of_topics);
    let wanted = summary.chunks.iter().filter(|chunk| selection.may_be_in(chunk, channels.as_ref()));
    let mut ranges: Vec<Range<u64>> = wanted
        .map(|chunk| chunk.chunk_start_offset..chunk.chunk_start_offset.saturating_add(chunk.chunk_length))
        .collect();
    ranges.sort_by_key(|range| range.start);
    let pieces = Pieces::new(file, ranges)?;
    let length = pieces.length();
    let mut walk = Walk::new(Scanner::new(BufReader::new(pieces), length)?, path, CutChunk::Skip);
    walk.predeclare(&summary.declarations);
    Ok(walk)
}

fn next_in(
    walk: &mut Walk<BufReader<Pieces>>,
    path: &Path,
) -> Result<Option<RecordedMessage>, RecordingError> {
    while let Some((offset, step)) = walk.next_step()? {
        match step {
            Step::Message(message) => return Ok(Some(message)),
            Step::Fault(kind) => {
                let fault = format!("{kind} (counted in the chunks selected)");
                return Err(RecordingError::Damaged { path: path.to_owned(), offset, fault });
            }
            Step::Chunk(_) | Step::Record(_) => {}
        }
    }
    Ok(None)
}

/// Parts of a file as one MCAP stream: magic bytes, the parts, magic bytes.
struct Pieces {
    file: File,
    ranges: VecDeque<Range<u64>>,
    /// What is left of the opening and of the closing magic bytes.
    opening: &'static [u8],
    closing: &'static [u8],
}

impl Pieces {
    fn new(mut file: File, ranges: Vec<Range<u64>>) -> io::Result<Self> {
        if let Some(first) = ranges.first() {
            file.seek(SeekFrom::Start(first.start))?;
        }
        Ok(Self { file, ranges: ranges.into(), opening: mcap::MAGIC, closing: mcap::MAGIC })
    }

    fn length(&self) -> u64 {
        let parts: u64 = self.ranges.iter().map(|range| range.end.saturating_sub(range.start)).sum();
        parts + (self.opening.len() + self.closing.len()) as u64
    }
}

impl Read for Pieces {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if !self.opening.is_empty() {
            return self.opening.read(buffer);
        }
        let Some(range) = self.ranges.front_mut() else { return self.closing.read(buffer) };
        let left = usize::try_from(range.end - range.start).unwrap_or(usize::MAX);
        let most = buffer.len().min(left);
        let read = self.file.read(&mut buffer[..most])?;
        range.start += read as u64;
        if range.start >= range.end {
            self.ranges.pop_front();
            if let Some(next) = self.ranges.front() {
                self.file.seek(SeekFrom::Start(next.start))?;
            }
        }
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{
        START_NS, at_ms, channel, latched, message, names, options, read_strictly, recorder,
    };

    fn finished(directory: &Path) -> PathBuf {
        let mut options = options(directory);
        options.writer.chunk_bytes = 3_000;
        let mut recorder = recorder(options);
        let (image, log, landmark) = (channel("/image"), channel("/log"), channel("/landmark"));
        for n in 0..100 {
            recorder.store(vec![message(&image, n, 1_000)], at_ms(0));
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

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// The fast way finds what reading everything and throwing most away finds.
        #[test]
        fn an_excerpt_is_the_whole_recording_filtered(
            from_ms in 0_u64..110,
            length_ms in 0_u64..110,
            topics in proptest::option::of(proptest::collection::btree_set("/(image|log|landmark|none)", 0..3)),
            cut in proptest::bool::ANY,
        ) {
            let directory = tempfile::tempdir().unwrap();
            let path = finished(directory.path());
            let all = read_strictly(&path);
            if cut {
                let content = std::fs::read(&path).unwrap();
                std::fs::write(&path, &content[..content.len() - 5]).unwrap();
            }
            let from_ns = START_NS + from_ms * 1_000_000;
            let selection = Selection { topics, log_time_ns: from_ns..from_ns + length_ms * 1_000_000 };
            let expected: Vec<_> = all.into_iter().filter(|message| selection.wants(message)).collect();
            let found: Vec<_> = Excerpt::open(&path, selection).unwrap().map(Result::unwrap).collect();
            prop_assert_eq!(found, expected);
        }
    }

    #[test]
    fn the_summary_counts_without_reading_everything() {
        let directory = tempfile::tempdir().unwrap();
        let path = finished(directory.path());
        let summary = Summary::read(&path).unwrap().unwrap();
        let info = crate::info::Info::read(&path).unwrap();
        let counted: Vec<_> =
            info.topics.iter().map(|(topic, info)| (topic.as_str(), info.messages)).collect();
        assert_eq!(summary.messages_by_topic().into_iter().collect::<Vec<_>>(), counted);
        assert_eq!(summary.log_span_ns(), info.log_span_ns());
    }

    #[test]
    fn damage_outside_the_excerpt_does_not_matter_and_inside_it_does() {
        let directory = tempfile::tempdir().unwrap();
        let path = finished(directory.path());
        let mut content = std::fs::read(&path).unwrap();
        content[1_000] ^= 1;
        std::fs::write(&path, &content).unwrap();
        let excerpt = |log_time_ns| Excerpt::open(&path, Selection { topics: None, log_time_ns }).unwrap();
        assert!(excerpt(START_NS + 50_000_000..u64::MAX).all(|message| message.is_ok()));
        assert!(excerpt(0..u64::MAX).any(|message| message.is_err()));
    }
}
