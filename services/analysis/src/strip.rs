//! A recording at a glance: a row of small pictures for each camera, evenly over the drive, results drawn in.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use ingest::encoded::EncodedFrame;
use ingest::recorded::{RecordedItem, RecordedItems};
use recording::RecordingError;
use vision::Frame;
use vision::overlay::{Layers, draw};

use crate::chosen_pictures::ChosenPictures;
use crate::recorded::RecordedOutcomes;
use crate::thumbnail::smaller;

/// Pictures in a row.
const PICTURES: u64 = 8;
const PICTURE_WIDTH_PX: u32 = 240;
const BACKGROUND: u8 = 24;

/// The strip of the recording `path`, cameras from top to bottom in the order of their ids; `None` when it holds no
/// picture that can be decoded.
///
/// # Errors
/// When the recording cannot be read.
pub fn strip(path: &Path) -> Result<Option<Frame>, RecordingError> {
    let mut totals: BTreeMap<Arc<str>, u64> = BTreeMap::new();
    for item in RecordedItems::open(path)? {
        if let RecordedItem::Picture { camera, .. } = item? {
            *totals.entry(camera).or_default() += 1;
        }
    }
    let mut rows: BTreeMap<Arc<str>, Vec<Frame>> = BTreeMap::new();
    let mut counts: BTreeMap<Arc<str>, u64> = BTreeMap::new();
    let mut drawing =
        Drawing { outcomes: RecordedOutcomes::open(path, None)?, pictures: ChosenPictures::default() };
    for item in RecordedItems::open(path)? {
        let RecordedItem::Picture { camera, picture, .. } = item? else { continue };
        let count = counts.entry(Arc::clone(&camera)).or_default();
        *count += 1;
        let row = rows.entry(Arc::clone(&camera)).or_default();
        let total = totals.get(&camera).copied().unwrap_or(1);
        let Ok(picture) = picture else { continue };
        // The next picture is due when its place in the row has come; an undecodable one leaves it to its successor.
        if (*count - 1) * PICTURES < row.len() as u64 * total {
            drawing.pictures.pass_over(&camera, &picture);
        } else if let Some(frame) = drawing.drawn(&camera, &picture)? {
            row.push(smaller(&frame, PICTURE_WIDTH_PX));
        }
    }
    Ok(composed(&rows.into_values().collect::<Vec<_>>()))
}

struct Drawing {
    outcomes: RecordedOutcomes,
    pictures: ChosenPictures,
}

impl Drawing {
    fn drawn(&mut self, camera: &Arc<str>, picture: &EncodedFrame) -> Result<Option<Frame>, RecordingError> {
        let outcome = self.outcomes.take(camera, picture.captured_at, picture.sequence)?;
        let mut frame = self.pictures.decode(camera, picture, Vec::new()).ok();
        if let (Some(outcome), Some(frame)) = (outcome, &mut frame) {
            draw(frame, &outcome, Layers::default());
        }
        Ok(frame)
    }
}

/// The rows below each other, each as high as its highest picture.
fn composed(rows: &[Vec<Frame>]) -> Option<Frame> {
    let columns = rows.iter().map(Vec::len).max().filter(|&columns| columns > 0)? as u32;
    let cell_width = rows.iter().flatten().map(Frame::width).max()?;
    let height_of = |row: &[Frame]| row.iter().map(Frame::height).max().unwrap_or(0);
    let (width, height) = (columns * cell_width, rows.iter().map(|row| height_of(row)).sum::<u32>());
    let mut rgb = vec![BACKGROUND; 3 * width as usize * height as usize];
    let mut top = 0;
    for row in rows {
        for (column, picture) in (0..).zip(row) {
            for y in 0..picture.height() {
                let at = 3 * ((top + y) * width + column * cell_width) as usize;
                let line = picture.row(y);
                rgb[at..at + line.len()].copy_from_slice(line);
            }
        }
        top += height_of(row);
    }
    Frame::from_rgb(width, height, rgb).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_below_each_other() {
        let picture = |width, height, level| {
            Frame::from_rgb(width, height, vec![level; 3 * (width * height) as usize]).unwrap()
        };
        let strip =
            composed(&[vec![picture(4, 2, 200), picture(4, 2, 100)], vec![picture(4, 3, 50)]]).unwrap();
        assert_eq!((strip.width(), strip.height()), (8, 5));
        assert_eq!((strip.pixel(1, 1), strip.pixel(5, 1)), ([200; 3], [100; 3]));
        assert_eq!((strip.pixel(0, 4), strip.pixel(7, 4)), ([50; 3], [BACKGROUND; 3]));
        assert!(composed(&[vec![]]).is_none());
    }
}
