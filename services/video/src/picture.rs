//! The codec's decoder behind what must be looked at before it: sizes, kinds of unit, colours.

use openh264::OpenH264API;
use openh264::decoder::{DecodedYUV, Decoder, DecoderConfig, Flush};
use openh264::formats::YUVSource;
use vision::Frame;
use vision::frame::decode::DecodeLimits;

use crate::access_unit::{NalKind, append_nal};
use crate::colour::{Planes, write_rgb};
use crate::error::VideoError;
use crate::sequence::{ColourCoding, Sequence};

/// In which order pictures come out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Each as soon as it is decoded: right where no picture is bidirectional.
    Decoding,
    /// As they are shown, some later than they went in.
    Showing,
}

/// A decoder with the parameter sets it has seen.
pub(crate) struct PictureDecoder {
    decoder: Decoder,
    limits: DecodeLimits,
    colour: Option<ColourCoding>,
    units: Vec<u8>,
}

impl PictureDecoder {
    pub(crate) fn new(limits: DecodeLimits, order: Order) -> Result<Self, VideoError> {
        let flush = match order {
            Order::Decoding => Flush::Flush,
            Order::Showing => Flush::NoFlush,
        };
        let config = DecoderConfig::new().flush_after_decode(flush);
        let decoder = Decoder::with_api_config(OpenH264API::from_source(), config)
            .map_err(|error| VideoError::Codec(error.to_string()))?;
        Ok(Self { decoder, limits, colour: None, units: Vec::new() })
    }

    /// Decodes the units of one picture. Parameter sets are judged first; units of extensions are left out.
    pub(crate) fn feed<'u>(
        &mut self,
        units: impl IntoIterator<Item = &'u [u8]>,
        storage: Vec<u8>,
    ) -> Result<Option<Frame>, VideoError> {
        self.units.clear();
        for unit in units {
            match NalKind::of(unit) {
                NalKind::Sequence => self.colour = Some(Sequence::read(unit, &self.limits)?.colour),
                NalKind::Slice | NalKind::IdrSlice | NalKind::Picture => {}
                NalKind::Other => continue,
            }
            append_nal(&mut self.units, unit);
        }
        let colour =
            self.colour.ok_or_else(|| VideoError::damaged("no sequence parameter set before a picture"))?;
        match self.decoder.decode(&self.units) {
            Ok(Some(picture)) => frame_of(&picture, colour, storage).map(Some),
            Ok(None) => Ok(None),
            Err(error) => Err(VideoError::Damaged(in_words(error.native_code()))),
        }
    }

    /// The pictures that are still inside.
    pub(crate) fn drain(&mut self) -> Result<Vec<Frame>, VideoError> {
        let Some(colour) = self.colour else { return Ok(Vec::new()) };
        let pictures = self
            .decoder
            .flush_remaining()
            .map_err(|error| VideoError::Damaged(in_words(error.native_code())))?;
        pictures.iter().map(|picture| frame_of(picture, colour, Vec::new())).collect()
    }
}

fn frame_of(
    picture: &DecodedYUV<'_>,
    colour: ColourCoding,
    mut storage: Vec<u8>,
) -> Result<Frame, VideoError> {
    let (width, height) = picture.dimensions();
    let (luma_stride, chroma_stride, _) = picture.strides();
    storage.resize(3 * width * height, 0);
    let planes =
        Planes { luma: picture.y(), blue: picture.u(), red: picture.v(), luma_stride, chroma_stride };
    write_rgb(planes, colour, (width, height), &mut storage);
    Frame::from_rgb(width as u32, height as u32, storage).map_err(VideoError::damaged)
}

/// `DECODING_STATE` of the codec.
fn in_words(state: i64) -> String {
    const FLAGS: [(i64, &str); 6] = [
        (0x02, "a picture that others need is missing"),
        (0x04, "the bit stream contradicts itself"),
        (0x08, "a layer is missing"),
        (0x10, "parameter sets are missing"),
        (0x20, "a part could not be decoded"),
        (0x4000, "the codec ran out of memory"),
    ];
    let words: Vec<&str> =
        FLAGS.iter().filter(|(flag, _)| state & flag != 0).map(|(_, words)| *words).collect();
    if words.is_empty() { format!("codec state {state:#x}") } else { words.join(", ") }
}
