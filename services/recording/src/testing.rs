//! What this crate's tests share.

use std::{path::Path, sync::Arc, time::Duration};

use bytes::Bytes;

use crate::{
    ChannelSpec, Command, Disk, JournalOptions, Latch, LatchKey, Message, Now, Recorder, Schema,
    reader::{MessageReader, Strictness},
    walk::RecordedMessage,
};

/// The wall clock all tests start at: 2024-03-01T00:00:00Z.
pub(crate) const START_NS: u64 = 1_709_251_200_000_000_000;

/// `package test; message Message {}` as a `FileDescriptorSet`.
const FILE_DESCRIPTOR_SET: &[u8] = b"\x0a\x1c\x0a\x01t\x12\x04test\x22\x09\x0a\x07Message\x62\x06proto3";

pub(crate) fn channel(topic: &str) -> Arc<ChannelSpec> {
    Arc::new(ChannelSpec {
        topic: topic.to_owned(),
        key_expression: format!("waymark/v1/test{topic}"),
        schema: Schema {
            name: "test.Message".to_owned(),
            file_descriptor_set: Bytes::from_static(FILE_DESCRIPTOR_SET),
        },
    })
}

/// Message `sequence` on `channel`: a protobuf field of `bytes` bytes that tell it from every other.
pub(crate) fn message(channel: &Arc<ChannelSpec>, sequence: u32, bytes: usize) -> Message {
    let mut random = u64::from(sequence).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let noise = std::iter::repeat_with(|| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        random as u8
    });
    // Field 1, length-delimited, its length a varint of three bytes.
    let length = |shift: usize, more: u8| (bytes >> shift & 0x7f) as u8 | more;
    let field_prefix = [0x0a, length(0, 0x80), length(7, 0x80), length(14, 0)];
    let log_time_ns = START_NS + u64::from(sequence) * 1_000_000;
    Message {
        channel: Arc::clone(channel),
        log_time_ns,
        publish_time_ns: log_time_ns - 500_000,
        sequence,
        data: field_prefix.into_iter().chain(noise.take(bytes)).collect(),
        latch: Latch::None,
    }
}

pub(crate) fn latched(channel: &Arc<ChannelSpec>, sequence: u32, key: &str) -> Message {
    Message { latch: Latch::Repeat(LatchKey(key.to_owned())), ..message(channel, sequence, 40) }
}

/// State that includes the message `sequence` of `of`.
pub(crate) fn snapshot(channel: &Arc<ChannelSpec>, sequence: u32, of: &Arc<ChannelSpec>) -> Message {
    let latch = Latch::Snapshot { key: LatchKey(channel.topic.clone()), of: of.topic.as_str().into() };
    Message { latch, ..message(channel, sequence, 40) }
}

/// Time `ms` milliseconds into a test.
pub(crate) fn at_ms(ms: u64) -> Now {
    Now { elapsed: Duration::from_millis(ms), unix_ns: START_NS + ms * 1_000_000 }
}

/// Options without a free-space floor, so that tests do not depend on the machine's disk.
pub(crate) fn options(directory: &Path) -> JournalOptions {
    JournalOptions { free_floor_bytes: 0, ..JournalOptions::new(directory, "car") }
}

pub(crate) fn recorder(options: JournalOptions) -> Recorder<Disk> {
    let disk = Disk::new(&options.directory);
    let mut recorder = Recorder::new(options, disk).unwrap();
    recorder.command(Command::Start, at_ms(0));
    recorder
}

pub(crate) fn read_strictly(path: &Path) -> Vec<RecordedMessage> {
    MessageReader::open(path, Strictness::Strict).unwrap().map(Result::unwrap).collect()
}

/// Names in `directory`, sorted.
pub(crate) fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

pub(crate) fn sequences_on(messages: &[RecordedMessage], topic: &str) -> Vec<u32> {
    messages.iter().filter(|m| m.channel.topic == topic).map(|m| m.sequence).collect()
}
