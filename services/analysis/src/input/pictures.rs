//! Picture files as frames of one camera that nobody knows the clock of.

use ingest::encoded::{EncodedFrame, Encoding};
use ingest::pictures::PictureFiles;
use vision::Timestamp;

use super::InputFrame;

/// Frames a second that plain pictures are taken to have been captured at: a file name carries no time.
pub const NOMINAL_RATE_HZ: i64 = 30;

/// Picture files, numbered from 1.
#[derive(Debug)]
pub struct PictureFrames {
    files: PictureFiles,
    frame: u64,
}

impl PictureFrames {
    pub(super) fn new(files: PictureFiles) -> Self {
        Self { files, frame: 0 }
    }
}

impl Iterator for PictureFrames {
    type Item = InputFrame;

    fn next(&mut self) -> Option<InputFrame> {
        let read = self.files.next()?;
        self.frame += 1;
        let name = match &read {
            Ok(picture) => picture.path.display().to_string(),
            Err(_) => format!("frame {}", self.frame),
        };
        let picture = read.map(|picture| EncodedFrame {
            sequence: self.frame,
            captured_at: nominal_time(self.frame),
            encoding: Encoding::File,
            bytes: picture.bytes.into(),
        });
        let picture = picture.map_err(Into::into);
        Some(InputFrame::plain(self.frame, name, picture))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.files.size_hint()
    }
}

/// When frame number `frame`, counted from 1, was captured if nothing but its number is known: the first at 0.
fn nominal_time(frame: u64) -> Timestamp {
    let nanos = i128::from(frame.saturating_sub(1)) * 1_000_000_000 / i128::from(NOMINAL_RATE_HZ);
    Timestamp::from_nanos(i64::try_from(nanos).unwrap_or(i64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_a_thirtieth_of_a_second_apart() {
        let directory = tempfile::tempdir().unwrap();
        for name in ["2.jpg", "10.jpg"] {
            std::fs::write(directory.path().join(name), name).unwrap();
        }
        let files = PictureFiles::open(directory.path().to_str().unwrap()).unwrap();
        let frames: Vec<InputFrame> = PictureFrames::new(files).collect();
        assert_eq!(frames.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [1, 2]);
        let pictures: Vec<_> = frames.into_iter().map(|frame| frame.picture.unwrap()).collect();
        assert_eq!((pictures[0].captured_at.nanos, pictures[1].captured_at.nanos), (0, 33_333_333));
        assert_eq!((&pictures[1].bytes[..], pictures[1].sequence), (&b"10.jpg"[..], 2));
    }
}
