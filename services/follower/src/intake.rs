//! A camera's pictures as they arrive from Zenoh: checked, counted, offered to the journal, put into the mailbox.
//! Runs on Zenoh's receiving thread, so nothing here waits.

use std::sync::Arc;

use bytes::Bytes;
use ingest::encoded::EncodedFrame;
use ingest::mailbox::Mailbox;
use ingest::picture_message::{NoPicture, PictureKind};
use ingest::video_thread::VideoQueue;
use recording::{Journal, Latch};
use waymark_proto::attachment::Attachment;
use waymark_proto::gaps::GapCounter;
use zenoh::sample::Sample;

use crate::counters::IntakeCounters;
use crate::tap::{self, Entry};
use crate::topics::CameraTopics;

/// Why a sample is no picture.
#[derive(Debug, thiserror::Error)]
enum Refused {
    /// Its message cannot be used.
    #[error(transparent)]
    Picture(#[from] NoPicture),
    /// Another kind of message.
    #[error(
        "encoding is {0:?}; allowed: application/protobuf;foxglove.CompressedImage, …;foxglove.CompressedVideo or …;foxglove.RawImage"
    )]
    Encoding(String),
}

/// One camera's way in.
pub(crate) struct Intake {
    topics: CameraTopics,
    journal: Arc<Journal>,
    mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
    video: VideoQueue,
    counters: Arc<IntakeCounters>,
    gaps: GapCounter,
    arrivals: u64,
}

impl Intake {
    /// A way in that has seen nothing yet.
    pub(crate) fn new(
        topics: CameraTopics,
        journal: Arc<Journal>,
        mailbox: Arc<Mailbox<Arc<EncodedFrame>>>,
        video: VideoQueue,
        counters: Arc<IntakeCounters>,
    ) -> Self {
        Self { topics, journal, mailbox, video, counters, gaps: GapCounter::default(), arrivals: 0 }
    }

    /// Takes one sample.
    pub(crate) fn accept(&mut self, sample: &Sample) {
        let attachment = sample.attachment().and_then(|bytes| Attachment::from_bytes(&bytes.to_bytes()).ok());
        self.gaps.observe(attachment.as_ref());
        self.counters.set_missed(self.gaps.missed().unwrap_or(0));
        self.arrivals += 1;
        let sequence = attachment.map_or(self.arrivals, |attachment| attachment.sequence as u64);
        if let Err(refused) = self.take(sample, sequence) {
            self.counters.refused();
            tracing::debug!(%refused, key = %sample.key_expr(), "picture refused");
        }
    }

    fn take(&self, sample: &Sample, sequence: u64) -> Result<(), Refused> {
        let encoding = sample.encoding().to_string();
        let schema = encoding.rsplit(';').next().unwrap_or_default();
        let kind = PictureKind::of_schema(schema).ok_or_else(|| Refused::Encoding(encoding.clone()))?;
        let payload = sample.payload().to_bytes();
        let picture = kind.read(sequence, &payload)?;
        let channel = match kind {
            PictureKind::Compressed => &self.topics.compressed_image,
            PictureKind::Video => &self.topics.compressed_video,
            PictureKind::Raw => &self.topics.raw_image,
        };
        let captured_at_ns = picture.captured_at.nanos;
        let data = Bytes::copy_from_slice(&payload);
        let latch = if picture.rests_on_earlier() { Latch::Continues } else { Latch::None };
        tap::offer(&self.journal, Entry { channel, captured_at_ns, sequence, data, latch });
        match kind {
            PictureKind::Video => self.video.offer(picture),
            PictureKind::Compressed | PictureKind::Raw => {
                self.mailbox.put(Arc::new(picture));
            }
        }
        Ok(())
    }
}
