//! Frames to an MP4 film. The index comes last, so a film that was not finished cannot be played: films are made from
//! recordings, which survive.

use std::io::{Seek, SeekFrom, Write};
use std::num::NonZeroU32;
use std::time::Duration;

use shiguredo_mp4::boxes::{Avc1Box, AvccBox, SampleEntry, VisualSampleEntryFields};
use shiguredo_mp4::mux::{Mp4FileMuxer, MuxError, Sample};
use shiguredo_mp4::{TrackKind, Uint};
use vision::{Frame, SizePx};

use crate::access_unit::{NalKind, nal_units};
use crate::encoder::{EncodedPicture, EncoderOptions, Quantizer, StreamEncoder};
use crate::error::VideoError;
use crate::sequence::Sequence;

/// Units of time in a second: divided by all usual frame rates.
const UNITS_PER_SECOND: NonZeroU32 = NonZeroU32::new(90_000).expect("not zero");

/// How long the last picture is shown, and any whose successor has no later time.
const LAST_SHOWN: Duration = Duration::from_millis(33);

/// A keyframe each second, so that players can jump.
const OPTIONS: EncoderOptions =
    EncoderOptions { quantizer: Quantizer::new(22).expect("within 1 and 51"), keyframe_interval: 30 };

/// Writes one film.
pub struct FilmWriter<F> {
    file: F,
    muxer: Mp4FileMuxer,
    position: u64,
    size: Option<SizePx>,
    encoder: Option<StreamEncoder>,
    /// The last picture and its time: how long it is shown says only the next.
    waiting: Option<(EncodedPicture, Duration)>,
    entry: Option<SampleEntry>,
}

impl<F: Write + Seek> FilmWriter<F> {
    /// Begins a film.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn new(mut file: F) -> Result<Self, VideoError> {
        let muxer = Mp4FileMuxer::new().map_err(mux)?;
        let head = muxer.initial_boxes_bytes();
        file.write_all(head)?;
        let position = head.len() as u64;
        Ok(Self { file, muxer, position, size: None, encoder: None, waiting: None, entry: None })
    }

    /// Adds a frame that is shown `at` after the beginning. All frames of a film have the size of the first.
    ///
    /// # Errors
    /// When it has another size, cannot be encoded, or the file cannot be written.
    pub fn push(&mut self, frame: &Frame, at: Duration) -> Result<(), VideoError> {
        let size = *self.size.get_or_insert(frame.size());
        if size != frame.size() {
            return Err(VideoError::Muxer(format!(
                "a frame has {}×{} pixels, the film {}×{}; make a film of each input",
                frame.width(),
                frame.height(),
                size.width,
                size.height
            )));
        }
        let encoder = match &mut self.encoder {
            Some(encoder) => encoder,
            none => none.insert(StreamEncoder::new(OPTIONS)?),
        };
        let picture = encoder.encode(frame)?;
        if self.entry.is_none() {
            self.entry = Some(sample_entry(&picture.bytes, size)?);
        }
        if let Some((previous, since)) = self.waiting.replace((picture, at)) {
            self.append(&previous, at.checked_sub(since).filter(|shown| !shown.is_zero()))?;
        }
        Ok(())
    }

    /// Writes the index.
    ///
    /// # Errors
    /// When the film has no frame, or the file cannot be written.
    pub fn finish(mut self) -> Result<F, VideoError> {
        if let Some((last, _)) = self.waiting.take() {
            self.append(&last, None)?;
        }
        let boxes = self.muxer.finalize().map_err(mux)?;
        for (offset, bytes) in boxes.offset_and_bytes_pairs() {
            self.file.seek(SeekFrom::Start(offset))?;
            self.file.write_all(bytes)?;
        }
        self.file.flush()?;
        Ok(self.file)
    }

    fn append(&mut self, picture: &EncodedPicture, shown: Option<Duration>) -> Result<(), VideoError> {
        let data = sample_bytes(&picture.bytes);
        self.file.write_all(&data)?;
        let units =
            shown.unwrap_or(LAST_SHOWN).as_nanos() * u128::from(UNITS_PER_SECOND.get()) / 1_000_000_000;
        let sample = Sample {
            track_kind: TrackKind::Video,
            sample_entry: self.entry.clone(),
            keyframe: picture.keyframe,
            timescale: UNITS_PER_SECOND,
            duration: u32::try_from(units).unwrap_or(u32::MAX).max(1),
            composition_time_offset: None,
            data_offset: self.position,
            data_size: data.len(),
        };
        self.muxer.append_sample(&sample).map_err(mux)?;
        self.position += data.len() as u64;
        Ok(())
    }
}

/// The picture as MP4 has it: each unit behind its length, parameter sets in the index instead.
fn sample_bytes(stream: &[u8]) -> Vec<u8> {
    let mut sample = Vec::with_capacity(stream.len());
    for unit in nal_units(stream).filter(|unit| !is_parameter_set(unit)) {
        sample.extend_from_slice(&(unit.len() as u32).to_be_bytes());
        sample.extend_from_slice(unit);
    }
    sample
}

fn is_parameter_set(unit: &[u8]) -> bool {
    matches!(NalKind::of(unit), NalKind::Sequence | NalKind::Picture)
}

fn sample_entry(stream: &[u8], size: SizePx) -> Result<SampleEntry, VideoError> {
    let of_kind = |kind| nal_units(stream).filter(move |unit| NalKind::of(unit) == kind).map(<[u8]>::to_vec);
    let sets: Vec<Vec<u8>> = of_kind(NalKind::Sequence).collect();
    let missing = || VideoError::Muxer("the first picture has no parameter sets".to_owned());
    let first = sets.first().ok_or_else(missing)?;
    let [profile, constraints, level] =
        Sequence::read(first, &vision::frame::decode::DecodeLimits::default())?.profile;
    let high = !matches!(profile, 66 | 77 | 88);
    let side = |pixels: u32| u16::try_from(pixels & !1).unwrap_or(u16::MAX);
    Ok(SampleEntry::Avc1(Avc1Box {
        visual: VisualSampleEntryFields {
            data_reference_index: VisualSampleEntryFields::DEFAULT_DATA_REFERENCE_INDEX,
            width: side(size.width),
            height: side(size.height),
            horizresolution: VisualSampleEntryFields::DEFAULT_HORIZRESOLUTION,
            vertresolution: VisualSampleEntryFields::DEFAULT_VERTRESOLUTION,
            frame_count: VisualSampleEntryFields::DEFAULT_FRAME_COUNT,
            compressorname: VisualSampleEntryFields::NULL_COMPRESSORNAME,
            depth: VisualSampleEntryFields::DEFAULT_DEPTH,
        },
        avcc_box: AvccBox {
            avc_profile_indication: profile,
            profile_compatibility: constraints,
            avc_level_indication: level,
            length_size_minus_one: Uint::new(3),
            sps_list: sets,
            pps_list: of_kind(NalKind::Picture).collect(),
            chroma_format: high.then(|| Uint::new(1)),
            bit_depth_luma_minus8: high.then(|| Uint::new(0)),
            bit_depth_chroma_minus8: high.then(|| Uint::new(0)),
            sps_ext_list: Vec::new(),
        },
        unknown_boxes: Vec::new(),
    }))
}

#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
fn mux(error: MuxError) -> VideoError {
    VideoError::Muxer(error.to_string())
}

impl<F> std::fmt::Debug for FilmWriter<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FilmWriter").field("size", &self.size).finish_non_exhaustive()
    }
}
