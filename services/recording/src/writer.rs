//! One MCAP file being written: chunked, never seeking, every chunk whole on disk before it counts.
//!
//! The library's own chunk rollover is off: this file closes chunks itself, so that it knows after each one
//! whether the disk took it. A message counts as stored when its chunk has been synced; after a failed
//! write the file is cut back to the last whole chunk, so that what is in it equals what was counted.

use std::{collections::BTreeMap, io, sync::Arc};

use bytes::Bytes;
use mcap::records::MessageHeader;

use crate::{
    Attachment, ChannelSpec, Ledger, Message, RecordingError, RecordingFile, WriterOptions,
    account::TopicAccount,
};
use growing_end::{GrowingEnd, Written};

mod growing_end;

/// Name of the metadata record with the file's accounts: topic → JSON of [`TopicAccount`].
pub(crate) const ACCOUNTS_RECORD: &str = "waymark.accounts";

/// A channel of this file and how far its messages have got.
struct OpenChannel {
    spec: Arc<ChannelSpec>,
    id: u16,
    in_chunk: Counts,
    unsynced: Counts,
}

#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    messages: u64,
    repeats: u64,
}

/// Why a message is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// It arrived.
    Event,
    /// It repeats state at the head of the file; not counted as stored.
    Head,
}

/// One MCAP file being written.
pub struct FileWriter<F: RecordingFile> {
    mcap: mcap::Writer<GrowingEnd<F>>,
    written: Arc<Written<F>>,
    options: WriterOptions,
    channels: Vec<OpenChannel>,
    chunk_bytes: usize,
    whole_bytes: u64,
    synced_bytes: u64,
    stored: Ledger,
    unplaced: Ledger,
}

impl<F: RecordingFile> FileWriter<F> {
    /// Begins an MCAP file in the empty `file`.
    pub fn begin(file: F, options: &WriterOptions) -> Result<Self, RecordingError> {
        let written = Arc::new(Written::new(file));
        let mcap = mcap::WriteOptions::new()
            .profile("")
            .library(&options.library)
            .compression(options.compression.as_mcap())
            .compression_threads(0)
            .chunk_size(None)
            .create(GrowingEnd::new(Arc::clone(&written)))?;
        Ok(Self {
            mcap,
            written,
            options: options.clone(),
            channels: Vec::new(),
            chunk_bytes: 0,
            whole_bytes: 0,
            synced_bytes: 0,
            stored: Ledger::default(),
            unplaced: Ledger::default(),
        })
    }

    /// Adds a message to the open chunk, and closes the chunk when it is full. `log_time_ns` stands in for
    /// the message's own where state is repeated.
    pub fn write(
        &mut self,
        message: &Message,
        log_time_ns: u64,
        purpose: Purpose,
    ) -> Result<(), RecordingError> {
        let index = match self.channel(&message.channel) {
            Ok(index) => index,
            Err(error) => {
                self.unplaced.topic(&message.channel.topic).lost_on_disk +=
                    u64::from(purpose == Purpose::Event);
                return Err(error);
            }
        };
        let channel = &mut self.channels[index];
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: message.sequence,
            log_time: log_time_ns,
            publish_time: message.publish_time_ns,
        };
        match purpose {
            Purpose::Event => channel.in_chunk.messages += 1,
            Purpose::Head => channel.in_chunk.repeats += 1,
        }
        self.mcap.write_to_known_channel(&header, &message.data)?;
        self.chunk_bytes += message.data.len();
        if self.chunk_bytes >= self.options.chunk_bytes { self.close_chunk() } else { Ok(()) }
    }

    /// Writes a metadata record, closing the open chunk.
    pub fn write_metadata(
        &mut self,
        name: &str,
        entries: BTreeMap<String, String>,
    ) -> Result<(), RecordingError> {
        self.close_chunk()?;
        self.mcap.write_metadata(&mcap::records::Metadata { name: name.to_owned(), metadata: entries })?;
        self.close_chunk()
    }

    /// Writes an attachment, closing the open chunk.
    pub fn attach(&mut self, attachment: &Attachment) -> Result<(), RecordingError> {
        self.close_chunk()?;
        self.mcap.attach(&mcap::Attachment {
            log_time: attachment.log_time_ns,
            create_time: attachment.log_time_ns,
            name: attachment.name.clone(),
            media_type: attachment.media_type.clone(),
            data: attachment.data.as_ref().into(),
        })?;
        self.close_chunk()
    }

    /// Closes the open chunk and makes the file durable up to here.
    pub fn sync(&mut self) -> Result<(), RecordingError> {
        self.close_chunk()?;
        self.sync_whole().map_err(RecordingError::Write)
    }

    /// Length of the file, bytes, the open chunk counted uncompressed.
    pub fn bytes(&self) -> u64 {
        self.whole_bytes + self.chunk_bytes as u64
    }

    /// What is stored for certain so far.
    pub fn stored(&self) -> &Ledger {
        &self.stored
    }

    /// Closes the file: the accounts record (this file's stored messages and `lost` ones), the summary and
    /// the footer, all synced. After an error call [`FileWriter::abandon`].
    pub fn finish(&mut self, lost: &Ledger) -> Result<(), RecordingError> {
        self.sync()?;
        let mut accounts = self.stored.clone();
        accounts.add(lost);
        self.write_metadata(ACCOUNTS_RECORD, accounts.to_metadata())?;
        self.mcap.finish()?;
        self.whole_bytes = self.written.bytes();
        self.sync_whole().map_err(RecordingError::Write)
    }

    /// Gives up after an error: cuts the file back to its last whole chunk and says what is not in it.
    pub fn abandon(mut self) -> Abandoned {
        // Dropped as it is, the library's writer would finish the file.
        drop(self.mcap.into_inner());
        let kept_to =
            match self.written.file.truncate(self.whole_bytes).and_then(|()| self.written.file.sync()) {
                Ok(()) => self.whole_bytes,
                Err(_) => self.synced_bytes,
            };
        let keeps_unsynced = kept_to == self.whole_bytes;
        if !keeps_unsynced {
            // The disk may refuse this too; recovery then finds a little more than was promised.
            let _ = self.written.file.truncate(kept_to);
        }
        let mut lost = self.unplaced;
        for channel in &mut self.channels {
            let topic = &channel.spec.topic;
            if keeps_unsynced {
                count_stored(self.stored.topic(topic), std::mem::take(&mut channel.unsynced));
            }
            let gone = channel.in_chunk.messages + channel.unsynced.messages;
            lost.topic(topic).lost_on_disk += gone;
        }
        Abandoned { stored: self.stored, lost }
    }

    fn channel(&mut self, spec: &Arc<ChannelSpec>) -> Result<usize, RecordingError> {
        // Callers keep one `Arc` per channel; comparing schemas is the slow way out for those who do not.
        let known = self.channels.iter().position(|c| Arc::ptr_eq(&c.spec, spec));
        if let Some(index) = known.or_else(|| self.channels.iter().position(|c| c.spec == *spec)) {
            return Ok(index);
        }
        let schema: &Bytes = &spec.schema.file_descriptor_set;
        let schema_id = self.mcap.add_schema(&spec.schema.name, "protobuf", schema)?;
        let metadata = spec.metadata();
        let id = self.mcap.add_channel(schema_id, &spec.topic, "protobuf", &metadata)?;
        self.chunk_bytes += schema.len();
        let nothing = Counts::default();
        self.channels.push(OpenChannel { spec: Arc::clone(spec), id, in_chunk: nothing, unsynced: nothing });
        Ok(self.channels.len() - 1)
    }

    fn close_chunk(&mut self) -> Result<(), RecordingError> {
        self.mcap.flush()?;
        self.whole_bytes = self.written.bytes();
        self.chunk_bytes = 0;
        for channel in &mut self.channels {
            let closed = std::mem::take(&mut channel.in_chunk);
            channel.unsynced.messages += closed.messages;
            channel.unsynced.repeats += closed.repeats;
        }
        Ok(())
    }

    fn sync_whole(&mut self) -> io::Result<()> {
        if self.synced_bytes == self.whole_bytes {
            return Ok(());
        }
        self.written.file.sync()?;
        self.synced_bytes = self.whole_bytes;
        for channel in &mut self.channels {
            let synced = std::mem::take(&mut channel.unsynced);
            count_stored(self.stored.topic(&channel.spec.topic), synced);
        }
        Ok(())
    }
}

/// What became of a file that had to be given up.
#[derive(Debug)]
pub struct Abandoned {
    /// Messages in the file, by topic.
    pub stored: Ledger,
    /// Messages that were written to it and are not in it.
    pub lost: Ledger,
}

fn count_stored(account: &mut TopicAccount, counts: Counts) {
    account.stored += counts.messages;
    account.repeated += counts.repeats;
}
