//! The decoder of a camera's video, before its mailbox: every picture must be decoded, although only the newest is
//! looked at. It has a thread of its own, since whoever receives must not wait.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use crate::camera_decoder::{CameraDecoder, Undecoded, decoded_picture};
use crate::encoded::EncodedFrame;
use crate::mailbox::Mailbox;

/// Messages that may wait to be decoded: a second of a fast camera.
const WAITING_MESSAGES: usize = 64;

/// What did not get through the decoder, readable while it runs.
#[derive(Debug, Default)]
pub struct VideoCounters {
    undecodable: AtomicU64,
    awaiting_keyframe: AtomicU64,
    overrun: AtomicU64,
}

impl VideoCounters {
    /// Messages that were damaged or of a kind that is not decoded.
    pub fn undecodable(&self) -> u64 {
        self.undecodable.load(Ordering::Relaxed)
    }

    /// Pictures that could not be decoded because one before them was missing.
    pub fn awaiting_keyframe(&self) -> u64 {
        self.awaiting_keyframe.load(Ordering::Relaxed)
    }

    /// Messages that found the decoder too far behind.
    pub fn overrun(&self) -> u64 {
        self.overrun.load(Ordering::Relaxed)
    }
}

/// The way into a camera's decoder.
#[derive(Clone, Debug)]
pub struct VideoQueue {
    messages: SyncSender<Option<EncodedFrame>>,
    counters: Arc<VideoCounters>,
}

impl VideoQueue {
    /// Hands a message to the decoder, or counts it where too many are waiting; never waits.
    pub fn offer(&self, message: EncodedFrame) {
        if self.messages.try_send(Some(message)).is_err() {
            self.counters.overrun.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// A running decoder.
#[derive(Debug)]
pub struct VideoThread {
    queue: VideoQueue,
    thread: JoinHandle<()>,
}

impl VideoThread {
    /// Starts the decoder of camera `id`, whose pictures go into `mailbox`.
    ///
    /// # Errors
    /// When the operating system gives no thread.
    pub fn spawn(id: &str, mailbox: Arc<Mailbox<Arc<EncodedFrame>>>) -> std::io::Result<Self> {
        let (messages, waiting) = sync_channel(WAITING_MESSAGES);
        let counters = Arc::new(VideoCounters::default());
        let camera = id.to_owned();
        let thread = std::thread::Builder::new().name(format!("video {id}")).spawn({
            let counters = Arc::clone(&counters);
            move || decode_all(&camera, &waiting, &mailbox, &counters)
        })?;
        Ok(Self { queue: VideoQueue { messages, counters }, thread })
    }

    /// The way in.
    #[must_use]
    pub fn queue(&self) -> VideoQueue {
        self.queue.clone()
    }

    /// What was lost on the way.
    #[must_use]
    pub fn counters(&self) -> Arc<VideoCounters> {
        Arc::clone(&self.queue.counters)
    }

    /// Decodes what waits, and ends. Returns false when the thread panicked.
    pub fn finish(self) -> bool {
        // A decoder that ended by a panic takes nothing any more, and `join` tells.
        let _ended = self.queue.messages.send(None);
        self.thread.join().is_ok()
    }
}

fn decode_all(
    camera: &str,
    waiting: &Receiver<Option<EncodedFrame>>,
    mailbox: &Mailbox<Arc<EncodedFrame>>,
    counters: &VideoCounters,
) {
    let mut decoder = CameraDecoder::default();
    while let Ok(Some(message)) = waiting.recv() {
        match decoder.decode_into(&message, Vec::new()) {
            Ok(frame) => {
                mailbox.put(Arc::new(decoded_picture(&message, frame)));
            }
            Err(Undecoded::AwaitingKeyframe) => {
                counters.awaiting_keyframe.fetch_add(1, Ordering::Relaxed);
            }
            Err(error) => {
                counters.undecodable.fetch_add(1, Ordering::Relaxed);
                tracing::debug!(camera, %error, "video dropped");
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera_thread;
    use crate::encoded::Encoding;
    use video::{EncoderOptions, Quantizer, StreamEncoder};
    use vision::{Frame, Timestamp};

    #[test]
    fn every_message_is_decoded_and_the_newest_picture_is_kept() {
        let mailbox = Arc::new(Mailbox::default());
        let thread = VideoThread::spawn("front", Arc::clone(&mailbox)).unwrap();
        let options = EncoderOptions { quantizer: Quantizer::default(), keyframe_interval: 30 };
        let mut encoder = StreamEncoder::new(options).unwrap();
        for sequence in 0..10_u8 {
            let frame = Frame::from_rgb(64, 48, vec![60 + 10 * sequence; 64 * 48 * 3]).unwrap();
            let bytes =
                if sequence == 4 { b"damaged".to_vec() } else { encoder.encode(&frame).unwrap().bytes };
            let (sequence, captured_at) = (sequence.into(), Timestamp::from_nanos(sequence.into()));
            thread.queue().offer(EncodedFrame {
                sequence,
                captured_at,
                encoding: Encoding::H264,
                bytes: bytes.into(),
            });
        }
        let counters = thread.counters();
        assert!(thread.finish());
        let newest = mailbox.take().unwrap();
        assert_eq!((newest.sequence, mailbox.replaced()), (3, 3), "nothing after the damage is trusted");
        assert_eq!((counters.undecodable(), counters.awaiting_keyframe(), counters.overrun()), (1, 5, 0));
        let level = camera_thread::decode(&newest).unwrap().pixel(30, 20)[1];
        assert!(level.abs_diff(90) <= 4, "{level}");
    }
}
