//! The MCAP project's conformance files: our walk must yield the records their JSON lists, our check must
//! find nothing wrong.

#![allow(clippy::unwrap_used, reason = "a test ends where its preparation fails")]

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
};

use mcap::records::Record;
use recording::{
    check::{Verdict, check},
    walk::{CutChunk, Step, Walk},
};
use serde_json::{Value, json};

/// The shared reference folder, unless it is missing.
fn archive() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let shared = std::env::var_os("WAYMARK_SHARED").map_or(beside, PathBuf::from);
    let archive = shared.join("data/mcap_conformance.tar.gz");
    archive.exists().then_some(archive)
}

fn unpack(archive: &Path, directory: &Path) -> Vec<PathBuf> {
    let status = Command::new("tar").arg("xzf").arg(archive).arg("-C").arg(directory).status().unwrap();
    assert!(status.success());
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in std::fs::read_dir(directory.join("mcap_conformance")).unwrap() {
        let entries = std::fs::read_dir(folder.unwrap().path()).unwrap().map(|entry| entry.unwrap().path());
        files.extend(entries.filter(|path| path.extension().is_some_and(|extension| extension == "mcap")));
    }
    files.sort();
    files
}

#[test]
fn all_conformance_files_read_as_expected_and_pass_the_check() {
    let Some(archive) = archive() else {
        eprintln!(
            "SKIPPED: the MCAP conformance files are missing; set WAYMARK_SHARED to the folder that has data/"
        );
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let files = unpack(&archive, directory.path());
    assert_eq!(files.len(), 416);
    for path in &files {
        let expected: Value =
            serde_json::from_slice(&std::fs::read(path.with_extension("json")).unwrap()).unwrap();
        let found: Vec<Value> =
            Walk::open(path, CutChunk::Skip).unwrap().filter_map(|step| as_json(step.unwrap().1)).collect();
        assert_eq!(Value::Array(found), expected["records"], "{}", path.display());
        let check = check(path).unwrap();
        // Ten of the files have log times that go backwards, which is legal and worth a warning.
        assert_eq!(check.verdict(), Verdict::Fine, "{}: {:?}", path.display(), check.findings);
    }
}

/// A step as the conformance files write records; `None` for those that they leave out.
fn as_json(step: Step) -> Option<Value> {
    let record = match step {
        Step::Message(message) => {
            let fields = json!([
                ["channel_id", message.channel.id.to_string()],
                ["data", bytes(&message.data)],
                ["log_time", message.log_time_ns.to_string()],
                ["publish_time", message.publish_time_ns.to_string()],
                ["sequence", message.sequence.to_string()],
            ]);
            return Some(json!({"type": "Message", "fields": fields}));
        }
        Step::Record(record) => record,
        Step::Chunk(_) => return None,
        Step::Fault(fault) => panic!("{fault}"),
    };
    let (name, fields) = declaration(&record).or_else(|| summary(&record))?;
    Some(json!({"type": name, "fields": fields}))
}

fn declaration(record: &Record<'_>) -> Option<(&'static str, Value)> {
    Some(match record {
        Record::Header(header) => {
            ("Header", json!([["library", header.library], ["profile", header.profile]]))
        }
        Record::Schema { header, data } => (
            "Schema",
            json!([
                ["data", bytes(data)],
                ["encoding", header.encoding],
                ["id", header.id.to_string()],
                ["name", header.name],
            ]),
        ),
        Record::Channel(channel) => (
            "Channel",
            json!([
                ["id", channel.id.to_string()],
                ["message_encoding", channel.message_encoding],
                ["metadata", channel.metadata],
                ["schema_id", channel.schema_id.to_string()],
                ["topic", channel.topic],
            ]),
        ),
        Record::Attachment { header, data, .. } => (
            "Attachment",
            json!([
                ["create_time", header.create_time.to_string()],
                ["data", bytes(data)],
                ["log_time", header.log_time.to_string()],
                ["media_type", header.media_type],
                ["name", header.name],
            ]),
        ),
        Record::Metadata(metadata) => {
            ("Metadata", json!([["metadata", metadata.metadata], ["name", metadata.name]]))
        }
        Record::DataEnd(end) => ("DataEnd", json!([["data_section_crc", end.data_section_crc.to_string()]])),
        _ => return None,
    })
}

fn summary(record: &Record<'_>) -> Option<(&'static str, Value)> {
    Some(match record {
        Record::Statistics(statistics) => (
            "Statistics",
            json!([
                ["attachment_count", statistics.attachment_count.to_string()],
                ["channel_count", statistics.channel_count.to_string()],
                ["channel_message_counts", numbers(&statistics.channel_message_counts)],
                ["chunk_count", statistics.chunk_count.to_string()],
                ["message_count", statistics.message_count.to_string()],
                ["message_end_time", statistics.message_end_time.to_string()],
                ["message_start_time", statistics.message_start_time.to_string()],
                ["metadata_count", statistics.metadata_count.to_string()],
                ["schema_count", statistics.schema_count.to_string()],
            ]),
        ),
        Record::ChunkIndex(index) => (
            "ChunkIndex",
            json!([
                ["chunk_length", index.chunk_length.to_string()],
                ["chunk_start_offset", index.chunk_start_offset.to_string()],
                ["compressed_size", index.compressed_size.to_string()],
                ["compression", index.compression],
                ["message_end_time", index.message_end_time.to_string()],
                ["message_index_length", index.message_index_length.to_string()],
                ["message_index_offsets", numbers(&index.message_index_offsets)],
                ["message_start_time", index.message_start_time.to_string()],
                ["uncompressed_size", index.uncompressed_size.to_string()],
            ]),
        ),
        Record::AttachmentIndex(index) => (
            "AttachmentIndex",
            json!([
                ["create_time", index.create_time.to_string()],
                ["data_size", index.data_size.to_string()],
                ["length", index.length.to_string()],
                ["log_time", index.log_time.to_string()],
                ["media_type", index.media_type],
                ["name", index.name],
                ["offset", index.offset.to_string()],
            ]),
        ),
        Record::MetadataIndex(index) => (
            "MetadataIndex",
            json!([
                ["length", index.length.to_string()],
                ["name", index.name],
                ["offset", index.offset.to_string()],
            ]),
        ),
        Record::SummaryOffset(offset) => (
            "SummaryOffset",
            json!([
                ["group_length", offset.group_length.to_string()],
                ["group_opcode", offset.group_opcode.to_string()],
                ["group_start", offset.group_start.to_string()],
            ]),
        ),
        Record::Footer(footer) => (
            "Footer",
            json!([
                ["summary_crc", footer.summary_crc.to_string()],
                ["summary_offset_start", footer.summary_offset_start.to_string()],
                ["summary_start", footer.summary_start.to_string()],
            ]),
        ),
        _ => return None,
    })
}

fn bytes(data: &[u8]) -> Value {
    data.iter().map(u8::to_string).collect()
}

fn numbers(map: &BTreeMap<u16, u64>) -> Value {
    map.iter().map(|(key, value)| (key.to_string(), Value::from(value.to_string()))).collect()
}
