//! The smallest and largest sum S of the windows in every cell: a [survey](super::survey) by whole windows.
//!
//! It takes longer than one by sub-blocks and needs no wider bounds, which pays where many landmarks share it:
//! some of them always come near the background. Only windows that start on the first samples of pixels are summed; the
//! others are means of those ([`super::mesh`]). Channels stay interleaved, as they lie in the frame.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::aligned::Aligned;
use super::chunk::{Chunk, WIDTH, chunks, chunks_mut, join};
use super::exact::BLOCK_PX;
use super::mesh::{CELL_ROWS, Mesh, SubBlock};
use super::ranges::Ranges;
use super::sieve::{BLOCK_BYTES, STEP_BYTES};

/// Bytes of a strip's sums: less than the first-level cache. (Frames of tests are small and have several strips, too.)
const STRIP_BYTES: usize = if cfg!(test) { 1 << 10 } else { 32 << 10 };

/// Pixels of the largest windows: their sums fit into 16 bits.
const MOST_PIXELS: u32 = 257;

/// Memory of the sums.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    /// Of the rows of pixels under the windows of a row of cells, over the width of every window: chunk after chunk, row r
    /// of each in place r modulo their number.
    rows: Aligned<u16>,
    /// Of the pixels of the present row, where a window is even of those that lie half its width apart; and of 2, 4, 8 … of
    /// these.
    levels: Vec<Aligned<u16>>,
    /// Numbers of the first level that make up a window's width.
    count: usize,
    /// The present row, where the frame ends too early to read whole vectors.
    padded: Vec<u8>,
    /// Over whole windows, those of the last band.
    windows: Aligned<u16>,
    lowest: Aligned<u16>,
    highest: Aligned<u16>,
    /// Memory to join the extremes.
    joined: [Vec<u16>; 2],
    /// Numbers of a row, in whole chunks.
    length: usize,
    /// Rows that `rows` has room for, in whole rows of cells.
    places: usize,
    /// Width and height of a window in pixels.
    wide: usize,
    high: usize,
}

/// Whether the sums of such windows fit.
pub(super) fn fit(mesh: Mesh) -> bool {
    let SubBlock { width_px, height_px } = mesh.sub_block();
    width_px * height_px <= MOST_PIXELS
}

impl Sums {
    /// Notes the extremes over all cells of the grid's region.
    #[inline(always)]
    pub(super) fn take(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, ranges: &mut Ranges) {
        let SubBlock { width_px, height_px } = mesh.sub_block();
        (self.wide, self.high) = (width_px as usize, height_px as usize);
        self.places = (self.high + CELL_ROWS as usize).next_multiple_of(CELL_ROWS as usize);
        let most_blocks = (STRIP_BYTES / (size_of::<u16>() * BLOCK_BYTES * self.places)).max(1);
        let blocks = ranges.blocks();
        let strip = blocks.div_ceil(blocks.div_ceil(most_blocks));
        for first in (0..blocks).step_by(strip) {
            self.take_strip(frame, grid, mesh, first..blocks.min(first + strip), ranges);
        }
    }

    #[inline(always)]
    fn take_strip(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        mesh: Mesh,
        blocks: Range<usize>,
        ranges: &mut Ranges,
    ) {
        let region = grid.region();
        self.prepare(blocks.len());
        let first_px = BLOCK_PX * blocks.start as u32;
        let end_px = (BLOCK_PX * blocks.end as u32 + self.wide as u32).min(region.width);
        let pixels = |row: usize| frame.pixels_from(region.x + first_px, region.y + row as u32);
        let (bands, area) = (mesh.bands(region.height), (self.wide * self.high) as u16);
        // In the last block perhaps no window begins: then it does not matter what is noted.
        let valid = 3 * ((end_px - first_px + 1) as usize).saturating_sub(self.wide).max(1);
        let mut summed = 0;
        for cell_row in 0..ranges.rows() {
            let seen = mesh.bands_seen(cell_row as u32);
            let seen = seen.start as usize..seen.end.min(bands) as usize;
            for row in summed..seen.end + self.high - 1 {
                self.sum_row(pixels(row), row);
            }
            summed = seen.end + self.high - 1;
            if cell_row == 0 {
                self.begin();
            }
            self.descend(seen);
            let (extremes, levels) = ([&mut self.lowest[..], &mut self.highest[..]], levels(area));
            ranges.note(cell_row, blocks.clone(), valid, extremes, &mut self.joined, levels);
        }
    }

    #[inline(always)]
    fn prepare(&mut self, blocks: usize) {
        self.length = (BLOCK_BYTES * blocks + 3).next_multiple_of(STEP_BYTES);
        self.rows.fit(self.places * self.length);
        for buffer in [&mut self.windows, &mut self.lowest, &mut self.highest] {
            buffer.fit(self.length);
        }
        self.count = half_of_even(self.wide).unwrap_or(self.wide);
        self.levels.resize_with(1 + self.count.ilog2() as usize, Aligned::default);
        let (read, beyond) = (self.read(), 3 * self.wide);
        self.levels.iter_mut().for_each(|level| level.fit(read + beyond));
    }

    /// So many numbers of the levels may matter for a row.
    #[inline(always)]
    fn read(&self) -> usize {
        self.length + (3 * self.wide).next_multiple_of(STEP_BYTES)
    }

    /// Sums over the pixels of row `row` of the region under each window's width. What is read beyond the strip does not
    /// matter.
    #[inline(always)]
    fn sum_row(&mut self, pixels: &[u8], row: usize) {
        let (read, needed) = (self.read(), self.read() + 3 * self.wide);
        let pixels = pixels.get(..needed).unwrap_or_else(|| {
            self.padded.clear();
            self.padded.extend_from_slice(pixels);
            self.padded.resize(needed, 0);
            &self.padded
        });
        let levels = chunks_mut(&mut self.levels[0][..read]).iter_mut().zip(chunks(pixels));
        if let Some(half) = half_of_even(self.wide) {
            for ((sums, left), right) in levels.zip(chunks(&pixels[3 * half..])) {
                *sums = join(*left, *right, |left, right| u16::from(left) + u16::from(right));
            }
        } else {
            for (sums, pixels) in levels {
                *sums = join(*pixels, *pixels, |level, _| u16::from(level));
            }
        }
        for level in 1..self.count.ilog2() as usize {
            let (below, this) = self.levels.split_at_mut(level);
            let (left, right) = (&below[level - 1][..read], &below[level - 1][3 << (level - 1)..]);
            let sums = chunks_mut(&mut this[0][..read]).iter_mut();
            for (sums, (left, right)) in sums.zip(chunks(left).iter().zip(chunks(right))) {
                *sums = join(*left, *right, u16::wrapping_add);
            }
        }
        self.add_levels(row % self.places);
    }

    /// Puts the sums together from those of powers of two: the largest, itself two of the one below it, and smaller ones
    /// after it.
    #[inline(always)]
    fn add_levels(&mut self, place: usize) {
        let Self { rows, levels, count, places, .. } = self;
        let columns = chunks_mut(rows).chunks_exact_mut(*places);
        let Some(below) = count.ilog2().checked_sub(1) else {
            for (column, sums) in columns.zip(chunks(&levels[0])) {
                column[place] = *sums;
            }
            return;
        };
        let sums = &levels[below as usize];
        let halves = chunks(sums).iter().zip(chunks(&sums[3 << below..]));
        let lower = (0..=below).rev().filter(|level| *count & 1 << level != 0);
        let mut ahead = 6 << below;
        let mut rest = lower.map(|level| {
            let from = ahead;
            ahead += 3 << level;
            chunks(&levels[level as usize][from..])
        });
        match rest.next() {
            None => {
                for (column, (left, right)) in columns.zip(halves) {
                    column[place] = join(*left, *right, u16::wrapping_add);
                }
            }
            Some(third) => {
                for (column, ((left, right), third)) in columns.zip(halves.zip(third)) {
                    column[place] = join(join(*left, *right, u16::wrapping_add), *third, u16::wrapping_add);
                }
            }
        }
        for more in rest {
            for (column, more) in chunks_mut(rows).chunks_exact_mut(*places).zip(more) {
                column[place] = join(column[place], *more, u16::wrapping_add);
            }
        }
    }

    /// Sums over the windows of the first band.
    #[inline(always)]
    fn begin(&mut self) {
        let columns = chunks(&self.rows).chunks_exact(self.places);
        for (windows, column) in chunks_mut(&mut self.windows).iter_mut().zip(columns) {
            *windows = [0; WIDTH];
            for row in &column[..self.high] {
                *windows = join(*windows, *row, u16::wrapping_add);
            }
        }
    }

    /// Goes from the first to the last of these bands, and notes the extremes of all.
    #[inline(always)]
    fn descend(&mut self, bands: Range<usize>) {
        let Self { rows, windows, lowest, highest, high, places, .. } = self;
        let moves = bands.len() - 1;
        // The rows that are left behind lie together; those that enter may go on from the first place.
        let (leave, enter) = (bands.start % *places, (bands.start + *high) % *places);
        let before = moves.min(*places - enter);
        let columns = chunks(rows).chunks_exact(*places);
        let extremes = chunks_mut(lowest).iter_mut().zip(chunks_mut(highest));
        for ((windows, column), (lowest, highest)) in
            chunks_mut(windows).iter_mut().zip(columns).zip(extremes)
        {
            let mut extremes = [*windows; 2];
            let (left, last) = column[leave..][..moves].split_at(before);
            slide(windows, &column[enter..], left, &mut extremes);
            slide(windows, column, last, &mut extremes);
            [*lowest, *highest] = extremes;
        }
    }
}

#[inline(always)]
fn half_of_even(side: usize) -> Option<usize> {
    side.is_multiple_of(2).then_some(side / 2)
}

/// Adds the rows that enter, takes the sums of those that leave, one after the other, and notes the extremes.
#[inline(always)]
fn slide(
    windows: &mut Chunk<u16>,
    entering: &[Chunk<u16>],
    leaving: &[Chunk<u16>],
    [low, high]: &mut [Chunk<u16>; 2],
) {
    for (enter, leave) in entering.iter().zip(leaving) {
        *windows = join(join(*windows, *enter, u16::wrapping_add), *leave, u16::wrapping_sub);
        *low = join(*low, *windows, u16::min);
        *high = join(*high, *windows, u16::max);
    }
}

/// For the lowest sum of so many pixels the level that its mean does not exceed, for the highest the one that it reaches:
/// whole bounds ([`Acceptance::levels_around_means`](crate::statistics::Acceptance)) then decide exactly. A multiplication does for the
/// division: it is exact, since sums and pixels below 2¹⁷ and 2⁹ leave an error below 2²⁶ of 2³².
#[inline(always)]
fn levels(pixels: u16) -> (impl Fn(u16) -> u8, impl Fn(u16) -> u8) {
    let inverse = (1_u64 << 32).div_ceil(u64::from(pixels));
    let quotient = move |sum: u64| ((sum * inverse) >> 32) as u8;
    let above = move |sum: u16| quotient(u64::from(sum) + u64::from(pixels) - 1);
    (above, move |sum: u16| quotient(u64::from(sum)))
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
            let (mut ranges, mut sums) = (Ranges::default(), Sums::default());
            ranges.fit(mesh.cell_rows(region.height) as usize, region.width.div_ceil(BLOCK_PX) as usize);
            sums.take(&frame, &grid, mesh, &mut ranges);
            let sum = |left: u32, top: u32, channel: usize| -> u32 {
                let pixels = (y + top..y + top + high).flat_map(|y| (x + left..x + left + wide).map(move |x| (x, y)));
                pixels.map(|(x, y)| u32::from(frame.pixel(x, y)[channel])).sum()
            };
            for (at, (lowest, highest)) in ranges.cells().enumerate() {
                let (row, block) = ((at / ranges.blocks()) as u32, (at % ranges.blocks()) as u32);
                let columns = BLOCK_PX * block..(BLOCK_PX * (block + 1) + 1).min(region.width + 1 - wide);
                let bands = mesh.bands_seen(row);
                let tops = bands.start..bands.end.min(mesh.bands(region.height));
                for channel in (0..3).filter(|_| !columns.is_empty()) {
                    let sums = tops.clone().flat_map(|top| columns.clone().map(move |left| sum(left, top, channel)));
                    let (low, high_sum) = sums.fold((u32::MAX, 0), |(low, high), sum| (low.min(sum), high.max(sum)));
                    let expected = (low.div_ceil(wide * high), high_sum / (wide * high));
                    prop_assert_eq!((u32::from(lowest[channel]), u32::from(highest[channel])), expected);
                }
            }
        }

        #[test]
        fn levels_divide(pixels in 1..=MOST_PIXELS as u16, sum: u16) {
            let sum = (u32::from(sum) % (255 * u32::from(pixels) + 1)) as u16;
            let (of_lowest, of_highest) = levels(pixels);
            prop_assert_eq!((of_lowest(sum), of_highest(sum)), (sum.div_ceil(pixels) as u8, (sum / pixels) as u8));
        }
    }
}
