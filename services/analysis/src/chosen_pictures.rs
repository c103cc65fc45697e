//! Some of a recording's pictures decoded, whichever way its cameras compress them.

use std::collections::BTreeMap;
use std::sync::Arc;

use ingest::camera_decoder::{CameraDecoder, Undecoded};
use ingest::encoded::{EncodedFrame, Encoding};
use vision::Frame;

/// One decoder for each camera. Every picture goes through one of the methods, in order.
#[derive(Debug, Default)]
pub(crate) struct ChosenPictures {
    decoders: BTreeMap<Arc<str>, CameraDecoder>,
}

impl ChosenPictures {
    /// Decodes a picture that is wanted into the storage of an earlier frame.
    pub(crate) fn decode(
        &mut self,
        camera: &Arc<str>,
        picture: &EncodedFrame,
        pixels: Vec<u8>,
    ) -> Result<Frame, Undecoded> {
        self.decoders.entry(Arc::clone(camera)).or_default().decode_into(picture, pixels)
    }

    /// Takes note of one that is not: those after it in its stream may need it.
    pub(crate) fn pass_over(&mut self, camera: &Arc<str>, picture: &EncodedFrame) {
        if picture.encoding == Encoding::H264 {
            // What is damaged here shows in the first picture that is wanted.
            let _ = self.decode(camera, picture, Vec::new());
        }
    }
}
