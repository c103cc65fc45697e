//! An MP4 film as frames in the order in which they are shown: each picture that goes in comes out, or an error does.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::io::{Read, Seek};
use std::time::Duration;

use vision::Frame;
use vision::frame::decode::DecodeLimits;

use crate::access_unit::length_prefixed;
use crate::error::VideoError;
use crate::picture::{Order, PictureDecoder};
use crate::sample_table::{Sample, SampleTable, read_at};

/// A frame of a film.
#[derive(Debug, PartialEq, Eq)]
pub struct FilmFrame {
    /// When it is shown, from the first frame on.
    pub shown_after: Duration,
    /// The picture.
    pub frame: Frame,
}

/// Reads a film from its beginning to its end.
pub struct FilmReader<F> {
    file: F,
    table: SampleTable,
    limits: DecodeLimits,
    next: usize,
    decoder: Option<PictureDecoder>,
    /// Times of the pictures that went in and did not come out yet, the earliest first.
    expected: BinaryHeap<Reverse<i64>>,
    /// What came out and was not taken yet.
    ready: VecDeque<Result<FilmFrame, VideoError>>,
    first_shown_at: i64,
}

impl<F: Read + Seek> FilmReader<F> {
    /// Opens a film; its index is read, its pictures are not.
    ///
    /// # Errors
    /// When it is no MP4 file with H.264 video.
    pub fn open(mut file: F, limits: DecodeLimits) -> Result<Self, VideoError> {
        let table = SampleTable::read(&mut file)?;
        let first_shown_at = table.samples.iter().map(|sample| sample.shown_at).min().unwrap_or(0);
        Ok(Self {
            file,
            table,
            limits,
            next: 0,
            decoder: None,
            expected: BinaryHeap::new(),
            ready: VecDeque::new(),
            first_shown_at,
        })
    }

    /// How many frames are still to come, damaged ones included.
    #[must_use]
    pub fn remaining(&self) -> usize {
        self.table.samples.len() - self.next + self.expected.len() + self.ready.len()
    }

    /// Puts the next picture in, and what comes out for it among what is ready.
    fn advance(&mut self, sample: Sample) {
        let fed = match self.decoder.take() {
            Some(decoder) => self.feed(decoder, sample),
            None if !sample.keyframe => Err(VideoError::damaged("a picture that it needs is missing")),
            None => PictureDecoder::new(self.limits, Order::Showing)
                .and_then(|decoder| self.feed(decoder, sample)),
        };
        if let Err(error) = fed {
            self.ready.push_back(Err(error));
        }
    }

    fn feed(&mut self, mut decoder: PictureDecoder, sample: Sample) -> Result<(), VideoError> {
        let data = read_at(&mut self.file, sample.offset, sample.bytes)?;
        if data.len() < sample.bytes {
            self.drain(decoder);
            return Err(VideoError::Film("it ends before its last picture".to_owned()));
        }
        let sets = if sample.keyframe { self.table.parameter_sets.as_slice() } else { &[] };
        let units = length_prefixed(&data, self.table.length_bytes);
        let fed =
            units.and_then(|units| decoder.feed(sets.iter().map(Vec::as_slice).chain(units), Vec::new()));
        match fed {
            Ok(frame) => {
                self.expected.push(Reverse(sample.shown_at));
                if let Some(frame) = frame {
                    self.come_out(frame);
                }
                self.decoder = Some(decoder);
                Ok(())
            }
            Err(error) => {
                self.drain(decoder);
                Err(error)
            }
        }
    }

    /// A picture came out: it is the one that is to be shown first of those inside.
    fn come_out(&mut self, frame: Frame) {
        let Some(Reverse(shown_at)) = self.expected.pop() else { return };
        let units = i128::from(shown_at) - i128::from(self.first_shown_at);
        let nanos = units.max(0) * 1_000_000_000 / i128::from(self.table.units_per_second);
        let shown_after = Duration::from_nanos(u64::try_from(nanos).unwrap_or(u64::MAX));
        self.ready.push_back(Ok(FilmFrame { shown_after, frame }));
    }

    /// Takes out what is inside; what does not come out is lost.
    fn drain(&mut self, mut decoder: PictureDecoder) {
        match decoder.drain() {
            Ok(frames) => frames.into_iter().for_each(|frame| self.come_out(frame)),
            Err(error) => self.ready.push_back(Err(error)),
        }
        let lost = self.expected.len();
        self.expected.clear();
        for _ in 0..lost {
            self.ready.push_back(Err(VideoError::damaged("a picture did not come out")));
        }
    }
}

impl<F: Read + Seek> Iterator for FilmReader<F> {
    type Item = Result<FilmFrame, VideoError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(ready) = self.ready.pop_front() {
                return Some(ready);
            }
            match self.table.samples.get(self.next).copied() {
                Some(sample) => {
                    self.next += 1;
                    self.advance(sample);
                }
                None => {
                    let decoder = self.decoder.take()?;
                    self.drain(decoder);
                }
            }
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.remaining(), None)
    }
}

impl<F> std::fmt::Debug for FilmReader<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FilmReader").field("next", &self.next).finish_non_exhaustive()
    }
}
