//! The exact test of all six parameters at every window position of an area, by running sums on the original grid.
//!
//! Vertically, the sums of a column over the window's rows follow from those one doubled row higher by one pixel that
//! enters and one that leaves: V(Y + 1) = V(Y) + p[⌊(Y + h)/2⌋] − p[⌊Y/2⌋], whatever the parity of Y and h.
//! Horizontally, see [`super::powers`]. Variances are computed only where all means match. Everything runs element by
//! element over chunks of columns, so that the compiler makes vector code of it; [`super::lanes`] chooses which.

use std::ops::Range;

use crate::bitmask::BitMask;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Acceptance;

use super::chunk::{self, Chunk, WIDTH, join, load, store};
use super::lane::{Lane, Precision};
use super::planes::Planes;
use super::powers::Powers;

/// Pixels along x whose two window positions each make one word of the mask.
pub(super) const BLOCK_PX: u32 = WIDTH as u32;

/// Where to test: rows of the mask, and columns in blocks of [`BLOCK_PX`] pixels, each one word of the mask.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) rows: Range<u32>,
    pub(super) blocks: Range<u32>,
}

impl Area {
    /// This area in pieces at most `blocks` wide.
    pub(super) fn strips(&self, blocks: u32) -> impl Iterator<Item = Self> {
        let end = self.blocks.end;
        self.blocks
            .clone()
            .step_by(blocks as usize)
            .map(move |first| Self { rows: self.rows.clone(), blocks: first..end.min(first + blocks) })
    }
}

/// What to test.
#[derive(Clone, Copy)]
pub(super) struct Question<'a> {
    pub(super) frame: &'a Frame,
    pub(super) grid: &'a DoubledGrid,
    pub(super) accepted: &'a [Acceptance],
}

/// Memory of the test, kept from area to area.
pub(super) struct Scratch<P: Precision> {
    /// S and Q of each channel.
    sums: [Powers<P::Sum>; 3],
    squares: [Powers<P::Spread>; 3],
    entering: Planes,
    leaving: Planes,
    /// The mask row whose windows' rows the columns' squares are summed over.
    squares_row: Option<u32>,
    /// Blocks of the present row in which some window's means match.
    pending: Vec<Pending>,
}

impl<P: Precision> Default for Scratch<P> {
    fn default() -> Self {
        Self {
            sums: Default::default(),
            squares: Default::default(),
            entering: Planes::default(),
            leaving: Planes::default(),
            squares_row: None,
            pending: Vec::new(),
        }
    }
}

/// Windows of one block whose means match one shade.
#[derive(Clone, Copy)]
struct Pending {
    block: usize,
    shade: usize,
    matching: Matching,
}

/// 1 where a window matches so far: those on the first, and on the second sample of each column.
type Matching = [Chunk<u8>; 2];

/// Sets in `mask` every pixel of `area` whose window matches one of the accepted shades.
#[inline(always)]
pub(super) fn test<P: Precision>(
    question: &Question<'_>,
    area: &Area,
    scratch: &mut Scratch<P>,
    mask: &mut BitMask,
) {
    scratch.begin(question, area);
    for y in area.rows.clone() {
        if y > area.rows.start {
            scratch.descend(question, y);
        }
        scratch.compare_means(question, area.blocks.len());
        if !scratch.pending.is_empty() {
            scratch.sum_squares(question, y);
            scratch.compare_variances(question, area.blocks.start, y, mask);
        }
    }
}

impl<P: Precision> Scratch<P> {
    /// Sums the columns for the area's first row from nothing.
    #[inline(always)]
    fn begin(&mut self, question: &Question<'_>, area: &Area) {
        let window = question.grid.window();
        let positions = WIDTH * area.blocks.len();
        let first = BLOCK_PX * area.blocks.start;
        for channel in 0..3 {
            self.sums[channel].fit(positions, window.width);
            self.squares[channel].fit(positions, window.width);
            self.sums[channel].columns().fill(P::Sum::default());
        }
        let columns = self.sums[0].columns().len();
        self.entering.fit(first, columns);
        self.leaving.fit(first, columns);
        self.squares_row = None;
        for row in DoubledGrid::pixels_under(area.rows.start, window.height) {
            let samples = DoubledGrid::samples_on(row, area.rows.start, window.height);
            self.entering.read(question.frame, question.grid, row);
            for (sums, plane) in self.sums.iter_mut().zip(self.entering.channels()) {
                accumulate(sums.columns(), plane, P::Sum::from_u32(samples), P::Sum::from_level);
            }
        }
    }

    /// Goes on from mask row `y - 1` to `y`; squares follow only where they were wanted in the row above.
    #[inline(always)]
    fn descend(&mut self, question: &Question<'_>, y: u32) {
        let side = question.grid.window().height;
        self.entering.read(question.frame, question.grid, DoubledGrid::pixels_under(y, side).end - 1);
        self.leaving.read(question.frame, question.grid, DoubledGrid::pixels_under(y - 1, side).start);
        let planes = || self.entering.channels().into_iter().zip(self.leaving.channels());
        for (sums, (enter, leave)) in self.sums.iter_mut().zip(planes()) {
            exchange(sums.columns(), enter, leave, P::Sum::from_level);
        }
        if self.squares_row == Some(y - 1) {
            for (squares, (enter, leave)) in self.squares.iter_mut().zip(planes()) {
                exchange(squares.columns(), enter, leave, square);
            }
            self.squares_row = Some(y);
        }
    }

    /// Notes in `pending` where the windows' sums S match in all three channels.
    #[inline(always)]
    fn compare_means(&mut self, question: &Question<'_>, blocks: usize) {
        self.pending.clear();
        for sums in &mut self.sums {
            sums.build();
        }
        for block in 0..blocks {
            for (shade, accepted) in question.accepted.iter().enumerate() {
                if let Some(matching) = self.matching_means(block, accepted) {
                    self.pending.push(Pending { block, shade, matching });
                }
            }
        }
    }

    #[inline(always)]
    fn matching_means(&self, block: usize, accepted: &Acceptance) -> Option<Matching> {
        let mut matching = [[1; WIDTH]; 2];
        for (sums, bounds) in self.sums.iter().zip(&accepted.sum) {
            let low = P::Sum::from_u32(bounds.low);
            let reach = P::Sum::from_u32(bounds.high - bounds.low);
            let windows = sums.windows(WIDTH * block);
            for (matching, windows) in matching.iter_mut().zip(windows) {
                *matching = join(*matching, windows, |so_far, sum| so_far & u8::from(sum.within(low, reach)));
            }
            if !matching.iter().any(chunk::any_set) {
                return None;
            }
        }
        Some(matching)
    }

    /// Brings the sums of squares Q of mask row `y` up to date.
    #[inline(always)]
    fn sum_squares(&mut self, question: &Question<'_>, y: u32) {
        if self.squares_row != Some(y) {
            for squares in &mut self.squares {
                squares.columns().fill(P::Spread::default());
            }
            let side = question.grid.window().height;
            for row in DoubledGrid::pixels_under(y, side) {
                let samples = P::Spread::from_u32(DoubledGrid::samples_on(row, y, side));
                self.entering.read(question.frame, question.grid, row);
                for (squares, plane) in self.squares.iter_mut().zip(self.entering.channels()) {
                    accumulate(squares.columns(), plane, samples, square);
                }
            }
            self.squares_row = Some(y);
        }
        for squares in &mut self.squares {
            squares.build();
        }
    }

    /// Compares D = nQ − S² of the pending windows and sets those that match.
    #[inline(always)]
    fn compare_variances(&mut self, question: &Question<'_>, first_word: u32, y: u32, mask: &mut BitMask) {
        let samples = P::Spread::from_u32(question.grid.samples());
        for &Pending { block, shade, mut matching } in &self.pending {
            for (channel, bounds) in question.accepted[shade].spread.iter().enumerate() {
                let low = P::Spread::from_u64(bounds.low);
                let reach = P::Spread::from_u64(bounds.high - bounds.low);
                let sums = self.sums[channel].windows(WIDTH * block);
                let squares = self.squares[channel].windows(WIDTH * block);
                for ((matching, sums), squares) in matching.iter_mut().zip(sums).zip(squares) {
                    let spreads = join(sums, squares, |sum, squares| {
                        let sum = P::Spread::from_u64(sum.to_u64());
                        samples.times(squares).minus(sum.times(sum))
                    });
                    *matching = join(*matching, spreads, |so_far, spread| {
                        so_far & u8::from(spread.within(low, reach))
                    });
                }
            }
            set(mask, y, first_word + block as u32, &matching);
        }
    }
}

/// Adds `samples` times what `of` makes of each level.
#[inline(always)]
fn accumulate<T: Lane>(columns: &mut [T], plane: &[u8], samples: T, of: impl Fn(u8) -> T) {
    for x in (0..columns.len()).step_by(WIDTH) {
        let sums = join(load(columns, x), load(plane, x), |sum, level| sum.plus(samples.times(of(level))));
        store(columns, x, sums);
    }
}

/// Adds what `of` makes of each level that enters and subtracts that of those that leave.
#[inline(always)]
fn exchange<T: Lane>(columns: &mut [T], enter: &[u8], leave: &[u8], of: impl Fn(u8) -> T) {
    for x in (0..columns.len()).step_by(WIDTH) {
        let change = join(load(enter, x), load(leave, x), |enter, leave| of(enter).minus(of(leave)));
        store(columns, x, chunk::add(load(columns, x), change));
    }
}

#[inline(always)]
fn square<T: Lane>(level: u8) -> T {
    let level = u16::from(level);
    T::from_u32(u32::from(level * level))
}

/// Sets the matching windows in word `word` of row `y`. Windows beyond the mask's right edge do not lie wholly inside the
/// region and do not count.
#[inline(always)]
fn set(mask: &mut BitMask, y: u32, word: u32, [on_first, on_second]: &Matching) {
    let bits = spread(chunk::pack(on_first)) | spread(chunk::pack(on_second)) << 1;
    let beyond = (64 * (word + 1)).saturating_sub(mask.width());
    if bits != 0 && beyond < 64 {
        mask.or_word(y, word, bits & u64::MAX >> beyond);
    }
}

/// Bit i to bit 2i.
#[inline(always)]
fn spread(bits: u32) -> u64 {
    let mut bits = u64::from(bits);
    bits = (bits | bits << 16) & 0x0000_FFFF_0000_FFFF;
    bits = (bits | bits << 8) & 0x00FF_00FF_00FF_00FF;
    bits = (bits | bits << 4) & 0x0F0F_0F0F_0F0F_0F0F;
    bits = (bits | bits << 2) & 0x3333_3333_3333_3333;
    (bits | bits << 1) & 0x5555_5555_5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn spreading_doubles_every_place(bits: u32) {
            prop_assert!((0..32).all(|at| spread(bits) >> (2 * at) & 1 == u64::from(bits >> at & 1)));
            prop_assert_eq!(spread(bits).count_ones(), bits.count_ones());
        }
    }
}
