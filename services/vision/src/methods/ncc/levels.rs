//! The levels of a region of a frame, channel by channel.

use crate::frame::Frame;
use crate::geometry::{RectPx, SizePx};
use crate::mask::{Lanes, Work};
use crate::methods::plane::luma;

use super::Colours;

/// What sums of levels are counted from, so that the transform's stay small.
const MIDDLE: f32 = 128.0;

/// One byte a pixel and channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Levels {
    lanes: Lanes,
    size: SizePx,
    channels: Vec<Vec<u8>>,
}

impl Levels {
    /// Reads a region that lies inside the frame.
    pub(super) fn read(&mut self, frame: &Frame, region: RectPx, colours: Colours) {
        self.size = SizePx { width: region.width, height: region.height };
        self.channels.resize_with(colours.channels(), Vec::new);
        let (width, height) = (region.width as usize, region.height as usize);
        self.channels.iter_mut().for_each(|channel| channel.resize(width * height, 0));
        for row in 0..height {
            let pixels = &frame.row(region.y + row as u32)[3 * region.x as usize..][..3 * width];
            let pixels = pixels.as_chunks::<3>().0;
            match &mut self.channels[..] {
                [grey] => self.lanes.run(Grey { pixels, grey: &mut grey[row * width..][..width] }),
                channels => {
                    for (number, channel) in channels.iter_mut().enumerate() {
                        let levels = channel[row * width..][..width].iter_mut();
                        levels.zip(pixels).for_each(|(level, pixel)| *level = pixel[number]);
                    }
                }
            }
        }
    }

    pub(super) fn size(&self) -> SizePx {
        self.size
    }

    pub(super) fn channels(&self) -> usize {
        self.channels.len()
    }

    /// One row of a channel.
    pub(super) fn row(&self, channel: usize, y: u32) -> &[u8] {
        let width = self.size.width as usize;
        &self.channels[channel][y as usize * width..][..width]
    }

    /// The same, counted from the middle of the scale.
    pub(super) fn centred(&self, channel: usize, y: u32, values: &mut [f32]) {
        for (value, &level) in values.iter_mut().zip(self.row(channel, y)) {
            *value = f32::from(level) - MIDDLE;
        }
    }
}

struct Grey<'a> {
    pixels: &'a [[u8; 3]],
    grey: &'a mut [u8],
}

impl Work for Grey<'_> {
    #[inline(always)]
    fn run(self) {
        for (grey, &pixel) in self.grey.iter_mut().zip(self.pixels) {
            *grey = luma(pixel);
        }
    }
}
