//! One channel of a strip of the region: the smallest and largest sums of the windows in a row of cells.
//!
//! First every row of pixels is summed over the width of every window, then these are added and taken away on the way down.
//! So each number is read and written a few times, and what the way down needs stays in registers.

use std::ops::Range;

use super::aligned::Aligned;
use super::chunk::{Chunk, WIDTH, chunks, chunks_mut, join, whole_chunks};
use super::mesh::{CELL_ROWS, SubBlock};
use super::planes::read_channel;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

/// Blocks side by side whose windows are summed together, and what the windows are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// Its first column in the region.
    first: u32,
    wide: usize,
    high: usize,
    blocks: usize,
    /// Columns where windows begin: not beyond the region, and one more than the blocks'. (Windows that start on the second
    /// sample of a block's last pixel cover the next one first.)
    columns: usize,
}

impl Strip {
    /// So many blocks from column `first` on, of a region that is so wide.
    #[inline(always)]
    pub(super) fn new(windows: SubBlock, first: u32, blocks: usize, region_width: u32) -> Self {
        let SubBlock { width_px, height_px } = windows;
        let existing = (region_width + 1).saturating_sub(first + width_px) as usize;
        let columns = existing.min(WIDTH * blocks + 1);
        Self { first, wide: width_px as usize, high: height_px as usize, blocks, columns }
    }

    /// Some of its blocks.
    #[inline(always)]
    fn part(self, blocks: &Range<usize>) -> Self {
        let columns = self.columns.saturating_sub(WIDTH * blocks.start).min(WIDTH * blocks.len() + 1);
        let first = self.first + (WIDTH * blocks.start) as u32;
        Self { first, blocks: blocks.len(), columns, ..self }
    }

    /// The rows of pixels under the windows of these bands.
    #[inline(always)]
    pub(super) fn rows(self, bands: &Range<usize>) -> Range<usize> {
        bands.start..bands.end + self.high - 1
    }

    /// The most rows of pixels under the windows of a row of cells.
    #[inline(always)]
    pub(super) fn most_rows(self) -> usize {
        self.high + CELL_ROWS as usize
    }

    /// Columns of pixels that are read, in whole chunks.
    #[inline(always)]
    pub(super) fn pixels(self) -> usize {
        self.paired() + whole_chunks(self.wide)
    }

    /// The first level's columns, in whole chunks.
    #[inline(always)]
    fn paired(self) -> usize {
        whole_chunks(WIDTH * self.blocks + 1 + self.wide)
    }

    /// How far apart the pixels are that are summed first; `None` where windows are odd.
    #[inline(always)]
    fn half(self) -> Option<usize> {
        self.wide.is_multiple_of(2).then_some(self.wide / 2)
    }

    /// Numbers of the first level in a window's width.
    #[inline(always)]
    fn count(self) -> usize {
        self.half().unwrap_or(self.wide)
    }
}

/// Where the pixels are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source<'a> {
    pub(super) frame: &'a Frame,
    pub(super) grid: &'a DoubledGrid,
}

/// Memory of the sums of a channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Channel {
    /// Of the present row.
    pixels: Aligned<u8>,
    /// Of the present row, of two pixels half a window's width apart, or of one where windows are odd; and of 2, 4, 8 … of
    /// these.
    levels: Vec<Aligned<u16>>,
    /// Over the width of every window, of the rows under a row of cells: chunk after chunk, row r of each in place r modulo
    /// their number.
    rows: Aligned<u16>,
    /// Rows that there is room for, in whole rows of cells.
    places: usize,
    /// Over whole windows, those of the last band.
    windows: Aligned<u16>,
    /// That band, and the blocks that were looked at.
    last: Option<(usize, Range<usize>)>,
}

impl Channel {
    /// Prepares for a strip.
    #[inline(always)]
    pub(super) fn fit(&mut self, strip: Strip) {
        self.places = strip.most_rows().next_multiple_of(CELL_ROWS as usize);
        self.pixels.fit(strip.pixels());
        self.rows.fit(self.places * WIDTH * (strip.blocks + 1));
        self.windows.fit(WIDTH * (strip.blocks + 1));
        self.levels.resize_with(1 + strip.count().ilog2() as usize, Aligned::default);
        for level in &mut self.levels {
            level.fit(strip.paired() + whole_chunks(strip.wide));
        }
        self.last = None;
    }

    /// Notes the levels between which the means of the windows of each of these blocks of the strip lie that start in these
    /// bands of rows. They are rounded to the inside:
    /// [`Acceptance::levels_around_means`](crate::statistics::Acceptance) says how to compare.
    #[inline(always)]
    pub(super) fn look(
        &mut self,
        strip: Strip,
        (source, channel): (Source<'_>, usize),
        (bands, blocks): (Range<usize>, Range<usize>),
        levels: [&mut [u8]; 2],
    ) {
        let goes_on = |(band, seen): &(usize, Range<usize>)| {
            *band == bands.start && seen.start <= blocks.start && blocks.end <= seen.end
        };
        let goes_on = self.last.as_ref().is_some_and(goes_on);
        let part = strip.part(&blocks);
        let new_rows = if goes_on { bands.start + strip.high } else { bands.start }..strip.rows(&bands).end;
        for row in new_rows {
            let Source { frame, grid } = source;
            let levels = &mut self.pixels[..part.pixels()];
            read_channel(frame, grid, row as u32, part.first, channel, levels);
            self.sum_row(part, (blocks.start, row));
        }
        if !goes_on {
            self.begin(part, (blocks.start, bands.start));
        }
        self.descend(part, (blocks.start, bands.clone()), levels);
        self.last = Some((bands.end - 1, blocks));
    }

    /// Sums row `row` over each window's width, from block `first` on.
    #[inline(always)]
    fn sum_row(&mut self, strip: Strip, (first, row): (usize, usize)) {
        let (paired, count) = (strip.paired(), strip.count());
        let pixels = &*self.pixels;
        let lowest = chunks_mut(&mut self.levels[0][..paired]).iter_mut().zip(chunks(pixels));
        if let Some(half) = strip.half() {
            for ((sums, left), right) in lowest.zip(chunks(&pixels[half..])) {
                *sums = join(*left, *right, |left, right| u16::from(left) + u16::from(right));
            }
        } else {
            for (sums, pixels) in lowest {
                *sums = join(*pixels, *pixels, |level, _| u16::from(level));
            }
        }
        for level in 1..count.ilog2() as usize {
            let (below, this) = self.levels.split_at_mut(level);
            let (left, right) = (&below[level - 1][..paired], &below[level - 1][1 << (level - 1)..]);
            let sums = chunks_mut(&mut this[0][..paired]).iter_mut();
            for (sums, (left, right)) in sums.zip(chunks(left).iter().zip(chunks(right))) {
                *sums = join(*left, *right, u16::wrapping_add);
            }
        }
        self.add_levels(count, (first, row % self.places));
    }

    /// Puts `count` numbers together from sums of powers of two: the largest, itself two of the one below it, and smaller
    /// ones after it. They are of block `first` and those after it.
    #[inline(always)]
    fn add_levels(&mut self, count: usize, (first, place): (usize, usize)) {
        let Self { rows, levels, places, .. } = self;
        let rows = &mut chunks_mut(rows)[*places * first..];
        let columns = rows.chunks_exact_mut(*places);
        let Some(below) = count.ilog2().checked_sub(1) else {
            for (column, sums) in columns.zip(chunks(&levels[0])) {
                column[place] = *sums;
            }
            return;
        };
        let sums = &levels[below as usize];
        let halves = chunks(sums).iter().zip(chunks(&sums[1 << below..]));
        let mut ahead = 2 << below;
        let mut rest = (0..=below).rev().filter(|level| count & 1 << level != 0).map(|level| {
            let from = ahead;
            ahead += 1 << level;
            chunks(&levels[level as usize][from..])
        });
        if let Some(third) = rest.next() {
            for (column, ((left, right), third)) in columns.zip(halves.zip(third)) {
                column[place] = join(join(*left, *right, u16::wrapping_add), *third, u16::wrapping_add);
            }
        } else {
            for (column, (left, right)) in columns.zip(halves) {
                column[place] = join(*left, *right, u16::wrapping_add);
            }
        }
        for more in rest {
            for (column, more) in rows.chunks_exact_mut(*places).zip(more) {
                column[place] = join(column[place], *more, u16::wrapping_add);
            }
        }
    }

    /// Sums over the windows of a band, of block `first` and those after it.
    #[inline(always)]
    fn begin(&mut self, strip: Strip, (first, band): (usize, usize)) {
        let columns = chunks(&self.rows).chunks_exact(self.places);
        let places = chunks_mut(&mut self.windows).iter_mut().zip(columns);
        for (windows, column) in places.skip(first).take(strip.blocks + 1) {
            *windows = [0; WIDTH];
            for row in band..band + strip.high {
                *windows = join(*windows, column[row % self.places], u16::wrapping_add);
            }
        }
    }

    /// Goes from the first to the last of these bands, and notes the extremes of all, of block `first` and those after it.
    #[inline(always)]
    fn descend(
        &mut self,
        strip: Strip,
        (first, bands): (usize, Range<usize>),
        [lows, highs]: [&mut [u8]; 2],
    ) {
        let Self { rows, windows, places, .. } = self;
        let moves = bands.len() - 1;
        // The rows that are left behind lie together; those that enter may go on from the first place.
        let (leave, enter) = (bands.start % *places, (bands.start + strip.high) % *places);
        let before = moves.min(*places - enter);
        let (of_lowest, of_highest) = levels((strip.wide * strip.high) as u16);
        let mut block_before: Option<[u16; 2]> = None;
        let columns = chunks_mut(windows).iter_mut().zip(chunks(rows).chunks_exact(*places));
        for (block, (windows, column)) in columns.skip(first).take(strip.blocks + 1).enumerate() {
            let [mut low, mut high] = [*windows; 2];
            let (left, last) = column[leave..][..moves].split_at(before);
            slide(windows, &column[enter..], left, [&mut low, &mut high]);
            slide(windows, column, last, [&mut low, &mut high]);
            // Where no window begins it does not matter what is noted.
            let existing = strip.columns.saturating_sub(WIDTH * block).min(WIDTH);
            low[existing..].fill(u16::MAX);
            high[existing..].fill(0);
            if let Some([lowest, highest]) = block_before {
                lows[block - 1] = of_lowest(lowest.min(low[0]));
                highs[block - 1] = of_highest(highest.max(high[0]));
            }
            block_before = Some([least(&low), most(&high)]);
        }
    }
}

/// Adds the rows that enter, takes the sums of those that leave, one after the other, and notes the extremes.
#[inline(always)]
fn slide(
    windows: &mut Chunk<u16>,
    entering: &[Chunk<u16>],
    leaving: &[Chunk<u16>],
    [low, high]: [&mut Chunk<u16>; 2],
) {
    for (enter, leave) in entering.iter().zip(leaving) {
        *windows = join(join(*windows, *enter, u16::wrapping_add), *leave, u16::wrapping_sub);
        *low = join(*low, *windows, u16::min);
        *high = join(*high, *windows, u16::max);
    }
}

#[inline(always)]
fn least(chunk: &Chunk<u16>) -> u16 {
    let mut least = u16::MAX;
    for &value in chunk {
        least = least.min(value);
    }
    least
}

#[inline(always)]
fn most(chunk: &Chunk<u16>) -> u16 {
    let mut most = 0;
    for &value in chunk {
        most = most.max(value);
    }
    most
}

/// For the lowest sum of so many pixels the level that its mean does not exceed, for the highest the one that it reaches. A
/// multiplication does for the division: it is exact, since sums and pixels below 2¹⁷ and 2⁹ leave an error below 2²⁶ of 2³².
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
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn levels_divide(pixels in 1..=257u16, sum: u16) {
            let sum = (u32::from(sum) % (255 * u32::from(pixels) + 1)) as u16;
            let (of_lowest, of_highest) = levels(pixels);
            prop_assert_eq!((of_lowest(sum), of_highest(sum)), (sum.div_ceil(pixels) as u8, (sum / pixels) as u8));
        }
    }
}
