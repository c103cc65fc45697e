//! Where an MP4 file's pictures lie and when they are shown, read without the pictures themselves.

use std::io::{Read, Seek, SeekFrom};

use shiguredo_mp4::TrackKind;
use shiguredo_mp4::boxes::{AvccBox, SampleEntry};
use shiguredo_mp4::demux::{Input, Mp4FileDemuxer};

use crate::error::VideoError;

/// The largest index of a film that is read, in bytes: a day at 30 pictures a second takes less.
const MAX_INDEX_BYTES: usize = 64 << 20;

/// The most pictures of a film; an index can claim more than its own size allows.
const MAX_SAMPLES: usize = 16 << 20;

/// The largest picture of a film, in bytes.
const MAX_SAMPLE_BYTES: usize = 16 << 20;

/// One picture of a film.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) offset: u64,
    pub(crate) bytes: usize,
    /// When it is shown, in units of the track; may be negative.
    pub(crate) shown_at: i64,
    /// Whether decoding may begin here.
    pub(crate) keyframe: bool,
}

/// The video track of a film.
#[derive(Debug)]
pub(crate) struct SampleTable {
    /// In the order of decoding.
    pub(crate) samples: Vec<Sample>,
    /// Units of time in a second.
    pub(crate) units_per_second: u32,
    /// The parameter sets that stand beside the pictures.
    pub(crate) parameter_sets: Vec<Vec<u8>>,
    /// Bytes of the length before each NAL unit.
    pub(crate) length_bytes: usize,
}

impl SampleTable {
    /// Reads the index of an MP4 file.
    pub(crate) fn read(file: &mut (impl Read + Seek)) -> Result<Self, VideoError> {
        let mut demuxer = Mp4FileDemuxer::new();
        while let Some(required) = demuxer.required_input() {
            let wanted = required.size.unwrap_or(usize::MAX);
            let data = read_at(file, required.position, wanted.min(MAX_INDEX_BYTES))?;
            if data.is_empty() || wanted > MAX_INDEX_BYTES && data.len() == MAX_INDEX_BYTES {
                return Err(VideoError::Film(
                    "it has no index (moov), or one of more than 64 MiB".to_owned(),
                ));
            }
            demuxer.handle_input(Input { position: required.position, data: &data });
        }
        Self::of_tracks(&mut demuxer)
    }

    fn of_tracks(demuxer: &mut Mp4FileDemuxer) -> Result<Self, VideoError> {
        let film = |error: shiguredo_mp4::demux::DemuxError| VideoError::Film(error.to_string());
        let tracks = demuxer.tracks().map_err(film)?;
        let track = tracks.iter().find(|track| track.kind == TrackKind::Video);
        let track = track.ok_or_else(|| VideoError::Film("it has no video track".to_owned()))?;
        let (id, units_per_second) = (track.track_id, track.timescale.get());
        let mut table =
            Self { samples: Vec::new(), units_per_second, parameter_sets: Vec::new(), length_bytes: 4 };
        while let Some(sample) = demuxer.next_sample().map_err(film)? {
            if sample.track.track_id != id {
                continue;
            }
            if let Some(entry) = sample.sample_entry {
                table.describe(entry)?;
            }
            let shown_at = i64::try_from(sample.timestamp).unwrap_or(i64::MAX);
            let shown_at = shown_at.saturating_add(sample.composition_time_offset.unwrap_or(0));
            let (offset, bytes) = (sample.data_offset, sample.data_size);
            table.samples.push(Sample { offset, bytes, shown_at, keyframe: sample.keyframe });
            if table.samples.len() > MAX_SAMPLES || bytes > MAX_SAMPLE_BYTES {
                return Err(VideoError::Film(format!(
                    "its index claims more than {MAX_SAMPLES} pictures, or one of {bytes} bytes"
                )));
            }
        }
        if table.samples.is_empty() {
            return Err(VideoError::Film(
                "its index names no pictures; fragmented files are not read, copy them with `ffmpeg -c copy`"
                    .to_owned(),
            ));
        }
        Ok(table)
    }

    fn describe(&mut self, entry: &SampleEntry) -> Result<(), VideoError> {
        let SampleEntry::Avc1(entry) = entry else {
            return Err(VideoError::Film("its video is not H.264 (avc1)".to_owned()));
        };
        if !self.parameter_sets.is_empty() {
            return Err(VideoError::Film("its parameter sets change within the track".to_owned()));
        }
        let AvccBox { sps_list, pps_list, length_size_minus_one, .. } = &entry.avcc_box;
        self.parameter_sets = sps_list.iter().chain(pps_list).cloned().collect();
        self.length_bytes = usize::from(length_size_minus_one.get()) + 1;
        Ok(())
    }
}

/// Up to `bytes` bytes from `position` on; fewer at the end of the file.
pub(crate) fn read_at(
    file: &mut (impl Read + Seek),
    position: u64,
    bytes: usize,
) -> Result<Vec<u8>, VideoError> {
    file.seek(SeekFrom::Start(position))?;
    let mut data = Vec::new();
    file.take(bytes as u64).read_to_end(&mut data)?;
    Ok(data)
}
