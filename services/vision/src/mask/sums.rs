//! The smallest and largest means of the windows in every cell: a survey by whole windows, for many landmarks.
//!
//! It takes longer than [one by sub-blocks](super::sub_blocks) and needs no wider bounds, which pays where many landmarks
//! share it: some of them always come near the background. Only windows that start on the first samples of pixels are summed;
//! the others are means of those ([`super::mesh`]).
//!
//! One channel often rules out all of them, a surface has its colour in all of its cells. So channels are looked at one after
//! the other while something is left, that one first which left the least in the cells above.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::channel::{Channel, Strip};
use super::exact::BLOCK_PX;
use super::living::Living;
use super::mesh::{Mesh, SubBlock};
use super::planes::Planes;
use super::ranges::Ranges;

/// Bytes of a strip's pixels and one channel's sums: less than the first-level cache. (Frames of tests are small and have
/// several strips, too.)
const STRIP_BYTES: usize = if cfg!(test) { 1 << 10 } else { 64 << 10 };

/// Pixels of the largest windows: their sums fit into 16 bits.
const MOST_PIXELS: u32 = 257;

/// Memory of the sums.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    planes: Planes,
    channels: [Channel; 3],
}

/// Whether the sums of such windows fit.
pub(super) fn fit(mesh: Mesh) -> bool {
    let SubBlock { width_px, height_px } = mesh.sub_block();
    width_px * height_px <= MOST_PIXELS
}

impl Sums {
    /// Leaves in `living` what may live in the cells of the grid's region. Where something does, all ranges are noted.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        mesh: Mesh,
        ranges: &mut Ranges,
        living: &mut [Living],
    ) {
        let (region_width, blocks) = (grid.region().width, ranges.blocks());
        let strip = |first: usize, blocks| {
            Strip::new(mesh.sub_block(), BLOCK_PX * first as u32, blocks, region_width)
        };
        let block_bytes = BLOCK_PX as usize * strip(0, 1).most_rows() * (3 + size_of::<u16>());
        let most_blocks = (STRIP_BYTES / block_bytes).max(1);
        let together = blocks.div_ceil(blocks.div_ceil(most_blocks));
        for first in (0..blocks).step_by(together) {
            let together = together.min(blocks - first);
            let strip = strip(first, together);
            self.planes.fit(BLOCK_PX * first as u32, strip.pixels(), strip.most_rows() - 1);
            for channel in &mut self.channels {
                channel.fit(strip);
            }
            self.take_strip(frame, grid, mesh, (strip, first..first + together), ranges, living);
        }
    }

    #[inline(always)]
    fn take_strip(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        mesh: Mesh,
        (strip, blocks): (Strip, Range<usize>),
        ranges: &mut Ranges,
        living: &mut [Living],
    ) {
        let bands = mesh.bands(grid.region().height);
        let mut order = [0, 1, 2];
        for row in 0..ranges.rows() {
            let seen = mesh.bands_seen(row as u32);
            let seen = seen.start as usize..seen.end.min(bands) as usize;
            for row in strip.rows(&seen) {
                self.planes.read(frame, grid, row as u32);
            }
            let cells = row * ranges.blocks() + blocks.start..row * ranges.blocks() + blocks.end;
            let mut left_by = [usize::MAX; 3];
            for channel in order {
                let levels = ranges.channel_mut(channel, cells.clone());
                self.channels[channel].look(strip, (&self.planes, channel), seen.clone(), levels);
                let (left, lives) = narrow(living, channel, &cells, ranges);
                left_by[channel] = left;
                if !lives {
                    break;
                }
            }
            order.sort_by_key(|&channel| left_by[channel]);
        }
    }
}

/// Narrows all of `living` to what one channel leaves in these cells: in how many of them by itself, and whether in any.
#[inline(always)]
fn narrow(living: &mut [Living], channel: usize, cells: &Range<usize>, ranges: &Ranges) -> (usize, bool) {
    let (mut left, mut lives) = (0, false);
    for living in living {
        let (alone, any) = living.narrow(channel, cells.clone(), ranges);
        left += alone;
        lives |= any;
    }
    (left, lives)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RectPx;
    use crate::landmark::WindowPx;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn cells_hold_the_extremes_of_their_windows(
            (width, height, rgb) in (1u32..150, 1u32..50).prop_flat_map(|(width, height)| {
                (Just(width), Just(height), prop::collection::vec(any::<u8>(), (3 * width * height) as usize))
            }),
            (wide, high) in (1u32..20, 1u32..20), x in 0u32..9, y in 0u32..9,
        ) {
            let frame = Frame::from_rgb(width, height, rgb).unwrap();
            let window = WindowPx { width: 2 * wide as u16, height: 2 * high as u16 };
            let (x, y) = (x.min(width - 1), y.min(height - 1));
            let region = RectPx { x, y, width: width - x, height: height - y };
            let Some(grid) = DoubledGrid::new(region, window) else { return Ok(()) };
            let mesh = Mesh::of_windows(window).unwrap();
            prop_assume!(fit(mesh));
            let (mut ranges, mut sums, mut living) = (Ranges::default(), Sums::default(), Living::default());
            ranges.fit_to(&grid, mesh);
            // A colour that lives everywhere: so all channels are looked at.
            living.index.add(1, &[crate::statistics::Bounds { low: 0, high: 255 }; 3]);
            living.begin(ranges.rows() * ranges.blocks());
            sums.take(&frame, &grid, mesh, &mut ranges, std::slice::from_mut(&mut living));
            let sum = |left: u32, top: u32, channel: usize| -> u32 {
                let pixels =
                    (y + top..y + top + high).flat_map(|y| (x + left..x + left + wide).map(move |x| (x, y)));
                pixels.map(|(x, y)| u32::from(frame.pixel(x, y)[channel])).sum()
            };
            for at in 0..ranges.rows() * ranges.blocks() {
                let (row, block) = ((at / ranges.blocks()) as u32, (at % ranges.blocks()) as u32);
                let columns = BLOCK_PX * block..(BLOCK_PX * (block + 1) + 1).min(region.width + 1 - wide);
                let bands = mesh.bands_seen(row);
                let tops = bands.start..bands.end.min(mesh.bands(region.height));
                for channel in (0..3).filter(|_| !columns.is_empty()) {
                    let sums = tops.clone().flat_map(|top| columns.clone().map(move |left| sum(left, top, channel)));
                    let (lowest, highest) = sums.fold((u32::MAX, 0), |(low, high), sum| (low.min(sum), high.max(sum)));
                    let expected = [lowest.div_ceil(wide * high), highest / (wide * high)];
                    prop_assert_eq!(ranges.channel(channel, at..at + 1).map(|levels| u32::from(levels[0])), expected);
                }
            }
        }
    }
}
