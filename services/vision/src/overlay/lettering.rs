//! Labels on dark plates that do not cover each other.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::pen::Ink;
use crate::frame::Frame;
use crate::geometry::{RectPx, SizePx};

const LINE_PX: u32 = RasterHeight::Size16.val() as u32;
/// Space around the letters on a plate, px.
const MARGIN_PX: u32 = 3;
/// Space between a label and what it names, px.
const GAP_PX: u32 = 4;
/// Part of the picture that shines through a plate, of 256.
const PLATE_SHINE: u16 = 70;

/// Labels, placed first and written last, so that no line runs over them.
pub(super) struct Lettering {
    frame: SizePx,
    keep_clear: Vec<RectPx>,
    placed: Vec<(RectPx, String, Ink)>,
}

impl Lettering {
    /// Labels for a frame of that size that stay away from `keep_clear` where they can.
    pub(super) fn new(frame: SizePx, keep_clear: Vec<RectPx>) -> Self {
        Self { frame, keep_clear, placed: Vec::new() }
    }

    /// Gives `text` a free place beside `about`: right, left, below or above; or in the top-left corner.
    pub(super) fn place(&mut self, text: String, about: Option<RectPx>, ink: Ink) {
        let letter_px = get_raster_width(FontWeight::Regular, RasterHeight::Size16) as u32;
        let width = letter_px * text.chars().count() as u32 + 2 * MARGIN_PX;
        let height = LINE_PX + 2 * MARGIN_PX;
        let plate = match about {
            None => self.moved_down(RectPx { x: GAP_PX, y: GAP_PX, width, height }),
            Some(about) => {
                let places = beside(about, SizePx { width, height }, self.frame);
                let free = places.iter().flatten().copied().find(|plate| self.is_free(*plate));
                free.unwrap_or_else(|| self.moved_down(self.inside(about, SizePx { width, height })))
            }
        };
        self.placed.push((plate, text, ink));
    }

    fn is_free(&self, plate: RectPx) -> bool {
        let inside = plate.x + plate.width <= self.frame.width && plate.y + plate.height <= self.frame.height;
        let labels = self.placed.iter().map(|(other, ..)| *other);
        inside && labels.chain(self.keep_clear.iter().copied()).all(|other| !overlap(other, plate))
    }

    /// A plate right of `about`, moved into the frame.
    fn inside(&self, about: RectPx, plate: SizePx) -> RectPx {
        RectPx {
            x: (about.x + about.width + GAP_PX).min(self.frame.width.saturating_sub(plate.width)),
            y: about.y.min(self.frame.height.saturating_sub(plate.height)),
            width: plate.width,
            height: plate.height,
        }
    }

    /// Each label in the way moves the plate below itself; past the bottom it starts again at the top.
    fn moved_down(&self, mut plate: RectPx) -> RectPx {
        for _ in 0..2 * self.placed.len() {
            let Some((in_way, ..)) = self.placed.iter().find(|(other, ..)| overlap(*other, plate)) else {
                break;
            };
            plate.y = in_way.y + in_way.height + 1;
            if plate.y + plate.height > self.frame.height {
                plate.y = 0;
            }
        }
        plate
    }

    pub(super) fn write_to(&self, frame: &mut Frame) {
        for (plate, text, ink) in &self.placed {
            darken(frame, *plate);
            write(frame, *plate, text, *ink);
        }
    }
}

/// Right, left, below, above, and a line further below and above, moved along that side into the frame; `None` where
/// the frame ends before.
fn beside(about: RectPx, SizePx { width, height }: SizePx, frame: SizePx) -> [Option<RectPx>; 6] {
    let y = (about.y + about.height / 2).saturating_sub(height / 2).min(frame.height.saturating_sub(height));
    let x = (about.x + about.width / 2).saturating_sub(width / 2).min(frame.width.saturating_sub(width));
    let at = |x: u32, y: u32| RectPx { x, y, width, height };
    [
        Some(at(about.x + about.width + GAP_PX, y)),
        about.x.checked_sub(width + GAP_PX).map(|x| at(x, y)),
        Some(at(x, about.y + about.height + GAP_PX)),
        about.y.checked_sub(height + GAP_PX).map(|y| at(x, y)),
        Some(at(x, about.y + about.height + height + 2 * GAP_PX)),
        about.y.checked_sub(2 * (height + GAP_PX)).map(|y| at(x, y)),
    ]
}

fn overlap(a: RectPx, b: RectPx) -> bool {
    a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height
}

fn darken(frame: &mut Frame, plate: RectPx) {
    let Some(plate) = plate.clipped_to(frame.size()) else { return };
    let stride = 3 * frame.width() as usize;
    let columns = 3 * plate.x as usize..3 * (plate.x + plate.width) as usize;
    for row in frame.rgb_mut().chunks_exact_mut(stride).skip(plate.y as usize).take(plate.height as usize) {
        for level in &mut row[columns.clone()] {
            *level = (u16::from(*level) * PLATE_SHINE / 256) as u8;
        }
    }
}

fn write(frame: &mut Frame, plate: RectPx, text: &str, Ink(color): Ink) {
    let mut left = plate.x + MARGIN_PX;
    for letter in text.chars() {
        let raster = get_raster(letter, FontWeight::Regular, RasterHeight::Size16)
            .or_else(|| get_raster('?', FontWeight::Regular, RasterHeight::Size16));
        let Some(raster) = raster else { continue };
        for (y, row) in (plate.y + MARGIN_PX..).zip(raster.rows()) {
            for (x, &opacity) in (left..).zip(row) {
                blend(frame, x, y, color, opacity);
            }
        }
        left += raster.width() as u32;
    }
}

fn blend(frame: &mut Frame, x: u32, y: u32, color: [u8; 3], opacity: u8) {
    let SizePx { width, height } = frame.size();
    if opacity == 0 || x >= width || y >= height {
        return;
    }
    let at = 3 * (y as usize * width as usize + x as usize);
    for (level, ink) in frame.rgb_mut()[at..at + 3].iter_mut().zip(color) {
        let (under, over, opacity) = (u16::from(*level), u16::from(ink), u16::from(opacity));
        *level = ((under * (255 - opacity) + over * opacity + 127) / 255) as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_at_one_place_do_not_cover_each_other() {
        let object = RectPx { x: 290, y: 180, width: 20, height: 20 };
        let mut lettering = Lettering::new(SizePx { width: 320, height: 200 }, vec![object]);
        for number in 0..7 {
            lettering.place(format!("label {number}"), Some(object), Ink([255; 3]));
        }
        let plates: Vec<RectPx> = lettering.placed.iter().map(|(plate, ..)| *plate).collect();
        assert!(!overlap(plates[0], object));
        for (i, &plate) in plates.iter().enumerate() {
            assert!(plate.x + plate.width <= 320 && plate.y + plate.height <= 200);
            assert!(plates[..i].iter().all(|&other| !overlap(plate, other)));
        }
    }
}
