//! Pictures with what was seen drawn into them, recorded beside the ones that arrived: for viewers that cannot lay
//! annotations over a picture.
//!
//! Each takes a decoding and an encoding, so this has a thread of its own behind one slot: where the machine has no time
//! for it, pictures of this topic are left out and counted, and registration goes on as before.

use std::sync::Arc;
use std::thread::JoinHandle;

use ingest::camera_thread::{self, Registered};
use ingest::mailbox::Mailbox;
use prost::Message;
use recording::{ChannelSpec, Journal, Latch};
use vision::frame::encode::{Quality, encode_jpeg};
use vision::overlay::{self, Layers};
use waymark_proto::images::{PictureFormat, picture_message};

use crate::tap::{Entry, offer};

/// Where a camera's registered pictures are put to be drawn and recorded.
pub(crate) type Slot = Arc<Mailbox<Arc<Registered>>>;

/// A thread that draws and records.
#[derive(Debug)]
pub(crate) struct BurnedIn {
    slot: Slot,
    thread: JoinHandle<()>,
}

impl BurnedIn {
    /// Starts the thread of `camera`, whose pictures go to `channel`.
    pub(crate) fn spawn(
        camera: &str,
        channel: Arc<ChannelSpec>,
        journal: Arc<Journal>,
    ) -> std::io::Result<Self> {
        let slot = Slot::default();
        let camera = camera.to_owned();
        let thread = std::thread::Builder::new().name(format!("burn in {camera}")).spawn({
            let slot = Arc::clone(&slot);
            move || {
                while let Some(registered) = slot.take() {
                    match burned_in(&registered) {
                        Ok(jpeg) => record(&journal, &channel, &camera, &registered, jpeg),
                        Err(error) => tracing::debug!(camera, error, "not drawn"),
                    }
                }
            }
        })?;
        Ok(Self { slot, thread })
    }

    pub(crate) fn slot(&self) -> Slot {
        Arc::clone(&self.slot)
    }

    /// Draws the picture that is waiting, and ends. Returns false when the thread panicked.
    pub(crate) fn finish(self) -> bool {
        self.slot.close();
        self.thread.join().is_ok()
    }
}

fn burned_in(registered: &Registered) -> Result<Vec<u8>, String> {
    let mut frame = camera_thread::decode(&registered.picture).map_err(|error| error.to_string())?;
    overlay::draw(&mut frame, &registered.outcome, Layers::ALL);
    encode_jpeg(&frame, Quality::default()).map_err(|error| error.to_string())
}

fn record(journal: &Journal, channel: &Arc<ChannelSpec>, camera: &str, of: &Registered, jpeg: Vec<u8>) {
    let captured_at = of.outcome.captured_at;
    let message = picture_message(PictureFormat::Jpeg, jpeg.into(), captured_at, camera);
    let entry = Entry {
        channel,
        captured_at_ns: captured_at.nanos,
        sequence: of.outcome.sequence,
        data: message.encode_to_vec().into(),
        latch: Latch::None,
    };
    offer(journal, entry);
}
