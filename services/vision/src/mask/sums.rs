//! The smallest and largest means of the windows in every cell: a survey by whole windows, for many landmarks.
//!
//! It takes longer than [one by sub-blocks](super::sub_blocks) and needs no wider bounds, which pays where many landmarks
//! share it: some of them always come near the background. Only windows that start on the first samples of pixels are summed;
//! the others are means of those ([`super::mesh`]).
//!
//! One channel often rules out all of them, a surface has its colour in all of its cells. So channels are looked at one after
//! the other where something is left, that one first which left the least in the cells above.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::channel::{Channel, Source, Strip};
use super::exact::BLOCK_PX;
use super::living::Living;
use super::mesh::{Mesh, SubBlock};
use super::ranges::Ranges;

/// Bytes of a strip's pixels and one channel's sums: less than the first-level cache. (Frames of tests are small and have
/// several strips, too.)
const STRIP_BYTES: usize = if cfg!(test) { 1 << 10 } else { 48 << 10 };

/// Pixels of the largest windows: their sums fit into 16 bits.
const MOST_PIXELS: u32 = 257;

/// Memory of the sums.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    channels: [Channel; 3],
}

/// Whether the sums of such windows fit.
pub(super) fn fit(mesh: Mesh) -> bool {
    let SubBlock { width_px, height_px } = mesh.sub_block();
    width_px * height_px <= MOST_PIXELS
}

impl Sums {
    /// Leaves in `living` what may live in the cells of the grid's region. Of those where something does all ranges are noted.
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
        let block_bytes = BLOCK_PX as usize * strip(0, 1).most_rows() * size_of::<u16>();
        let most_blocks = (STRIP_BYTES / block_bytes).max(1);
        let together = blocks.div_ceil(blocks.div_ceil(most_blocks));
        for first in (0..blocks).step_by(together) {
            let together = together.min(blocks - first);
            let strip = strip(first, together);
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
            let first = row * ranges.blocks() + blocks.start;
            let (mut left_by, mut living_blocks) = ([f32::INFINITY; 3], 0..blocks.len());
            for channel in order {
                if living_blocks.is_empty() {
                    break;
                }
                let cells = first + living_blocks.start..first + living_blocks.end;
                let levels = ranges.channel_mut(channel, cells.clone());
                let place = (seen.clone(), living_blocks.clone());
                self.channels[channel].look(strip, (Source { frame, grid }, channel), place, levels);
                let (left, alive) = narrow(living, channel, &cells, ranges);
                left_by[channel] = left;
                living_blocks = living_blocks.start + alive.start..living_blocks.start + alive.end;
            }
            order.sort_by(|&one, &other| left_by[one].total_cmp(&left_by[other]));
        }
    }
}

/// Narrows all of `living` to what one channel leaves in these cells: in which part of them by itself, and from the first to
/// the last of them where anything lives on.
#[inline(always)]
fn narrow(
    living: &mut [Living],
    channel: usize,
    cells: &Range<usize>,
    ranges: &Ranges,
) -> (f32, Range<usize>) {
    let (mut left, mut alive) = (0, cells.len()..0);
    for living in &mut *living {
        left += living.narrow(channel, cells.clone(), ranges);
        let cells = &living.cells()[cells.clone()];
        if let Some(first) = cells.iter().position(|&colours| colours != 0) {
            let last = cells.iter().rposition(|&colours| colours != 0).unwrap_or(first);
            alive = alive.start.min(first)..alive.end.max(last + 1);
        }
    }
    (left as f32 / (living.len() * cells.len()) as f32, alive)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RectPx;
    use crate::landmark::WindowPx;
    use crate::statistics::Bounds;
    use proptest::prelude::*;

    proptest! {
        /// A frame of random tiles, so that colours live in some cells of a row and not in others.
        #[test]
        fn living_cells_hold_the_extremes_of_their_windows(
            (width, height) in (1u32..200, 1u32..60), tiles in prop::collection::vec(any::<[u8; 3]>(), 64),
            tile_px in 1u32..70, noise in 1u8..9, (wide, high) in (1u32..20, 1u32..20), x in 0u32..9, y in 0u32..9,
            low: [u8; 3], reach in prop_oneof![Just(255), 0u8..200],
        ) {
            let level = |x: u32, y: u32, channel: usize| {
                let tile = tiles[((x / tile_px) % 8 + 8 * ((y / tile_px) % 8)) as usize];
                tile[channel].saturating_add((x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) as u8 % noise)
            };
            let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let rgb = pixels.flat_map(|(x, y)| (0..3).map(move |channel| level(x, y, channel))).collect();
            let frame = Frame::from_rgb(width, height, rgb).unwrap();
            let window = WindowPx { width: 2 * wide as u16, height: 2 * high as u16 };
            let (x, y) = (x.min(width - 1), y.min(height - 1));
            let region = RectPx { x, y, width: width - x, height: height - y };
            let Some(grid) = DoubledGrid::new(region, window) else { return Ok(()) };
            let mesh = Mesh::of_windows(window).unwrap();
            prop_assume!(fit(mesh));
            let (mut ranges, mut sums, mut living) = (Ranges::default(), Sums::default(), Living::default());
            ranges.fit_to(&grid, mesh);
            let wanted = low.map(|low| if reach == 255 { Bounds { low: 0, high: 255 } } else { Bounds { low, high: low.saturating_add(reach) } });
            living.index.add(1, &wanted);
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
                if columns.is_empty() {
                    continue;
                }
                let expected = [0, 1, 2].map(|channel| {
                    let sums = tops.clone().flat_map(|top| columns.clone().map(move |left| sum(left, top, channel)));
                    let (lowest, highest) = sums.fold((u32::MAX, 0), |(low, high), sum| (low.min(sum), high.max(sum)));
                    [lowest.div_ceil(wide * high), highest / (wide * high)]
                });
                let touches = expected.iter().zip(&wanted).all(|([low, high], wanted)| {
                    *low <= u32::from(wanted.high) && *high >= u32::from(wanted.low)
                });
                prop_assert_eq!(living.cells()[at] & 1 == 1, touches);
                for (channel, expected) in expected.into_iter().enumerate().filter(|_| touches) {
                    let noted = ranges.channel(channel, at..at + 1).map(|levels| u32::from(levels[0]));
                    prop_assert_eq!(noted, expected);
                }
            }
        }
    }
}
