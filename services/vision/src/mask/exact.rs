//! The exact test of all six parameters at every window position of an area, by running sums on the original grid.
//!
//! [`super::running`] keeps S and nQ of every window of a mask row. Spreads are computed only where all means match.
//! Everything runs element by element over chunks of columns, so that the compiler makes vector code of it;
//! [`super::lanes`] chooses which.

use std::ops::Range;

use crate::bitmask::BitMask;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Acceptance;

use super::chunk::{self, Chunk, WIDTH, join};
use super::lane::{Lane, MIDDLE_LEVEL, Precision};
use super::lanes::Work;
use super::planes::Planes;
use super::running::Running;

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

/// Rows of pixels whose windows are proven to match, or not to, together.
pub(super) const ROWS_TOGETHER: u32 = 8;

impl Area {
    /// The area's rows of pixels where windows begin, and into how many bands of [`ROWS_TOGETHER`] they are divided.
    #[inline(always)]
    pub(super) fn bands(&self) -> (Range<u32>, u32) {
        let pixels = DoubledGrid::pixels_of_starts(&self.rows);
        let bands = (pixels.len() as u32).div_ceil(ROWS_TOGETHER);
        (pixels, bands)
    }

    /// The area's rows of the mask that belong to a band.
    pub(super) fn rows_of_band(&self, band: u32) -> Range<u32> {
        let first = DoubledGrid::pixels_of_starts(&self.rows).start + ROWS_TOGETHER * band;
        let (first, after) = (DoubledGrid::starts_on(first), DoubledGrid::starts_on(first + ROWS_TOGETHER));
        first.start.max(self.rows.start)..after.start.min(self.rows.end)
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
    planes: Planes,
    /// S.
    sums: Running<P::Sum>,
    /// nQ; kept only while some window's means match.
    squares: Running<P::Spread>,
    /// Blocks of the present row in which some window's means match.
    pending: Vec<Pending>,
}

impl<P: Precision> Default for Scratch<P> {
    fn default() -> Self {
        Self {
            planes: Planes::default(),
            sums: Running::default(),
            squares: Running::default(),
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

/// A bit for each column of a block, set where a window matches so far: those on the first samples, and on the second.
type Matching = [u32; 2];

/// The test of one area: sets in `mask` every pixel whose window matches one of the accepted shades.
pub(super) struct Test<'a, P: Precision> {
    pub(super) question: Question<'a>,
    pub(super) area: Area,
    pub(super) scratch: &'a mut Scratch<P>,
    pub(super) mask: &'a mut BitMask,
}

impl<P: Precision> Work for Test<'_, P> {
    const WIDEST: bool = false;

    #[inline(always)]
    fn run(self) {
        let Self { question, area, scratch, mask } = self;
        scratch.fit(&question, &area);
        for y in area.rows.clone() {
            scratch.sum_levels(&question, y);
            scratch.compare_means(&question, area.blocks.len());
            if !scratch.pending.is_empty() {
                scratch.sum_squares(&question, y);
                scratch.compare_spreads(&question, area.blocks.start, y, mask);
            }
        }
    }
}

impl<P: Precision> Scratch<P> {
    #[inline(always)]
    fn fit(&mut self, question: &Question<'_>, area: &Area) {
        let window = question.grid.window();
        let positions = WIDTH * area.blocks.len();
        self.sums.fit(positions, window.width);
        self.squares.fit(positions, window.width);
        let rows = DoubledGrid::most_pixels_under(window.height);
        self.planes.fit(BLOCK_PX * area.blocks.start, self.sums.columns(), rows as usize);
    }

    /// Brings the sums S to mask row `y`.
    #[inline(always)]
    fn sum_levels(&mut self, question: &Question<'_>, y: u32) {
        let side = question.grid.window().height;
        if y > 0 && self.sums.row() == Some(y - 1) {
            let (enter, leave) = (entering(y, side), leaving(y, side));
            self.planes.read(question.frame, question.grid, enter);
            self.planes.read(question.frame, question.grid, leave);
            self.sums.descend(y, &self.planes, (enter, leave), |enter, leave| {
                level::<P::Sum>(enter).minus(level(leave))
            });
        } else {
            for row in DoubledGrid::pixels_under(y, side) {
                self.planes.read(question.frame, question.grid, row);
            }
            self.sums.begin(y, &self.planes, weighted_rows(y, side), level);
        }
    }

    /// Brings the sums nQ to mask row `y`; the rows of pixels were read for the sums.
    #[inline(always)]
    fn sum_squares(&mut self, question: &Question<'_>, y: u32) {
        let side = question.grid.window().height;
        let samples = P::Spread::from_i64(i64::from(question.grid.samples()));
        if y > 0 && self.squares.row() == Some(y - 1) {
            let rows = (entering(y, side), leaving(y, side));
            self.squares.descend(y, &self.planes, rows, |enter, leave| {
                samples.times(square::<P::Spread>(enter).minus(square(leave)))
            });
        } else {
            let of = |level| samples.times(square(level));
            self.squares.begin(y, &self.planes, weighted_rows(y, side), of);
        }
    }

    /// Notes in `pending` where the windows' sums S match in all three channels.
    #[inline(always)]
    fn compare_means(&mut self, question: &Question<'_>, blocks: usize) {
        self.pending.clear();
        for (shade, accepted) in question.accepted.iter().enumerate() {
            let samples = i64::from(question.grid.samples());
            let within = accepted.sum.map(|bounds| {
                let from_middle = |sum: u32| i64::from(sum) - MIDDLE_LEVEL * samples;
                P::sums(from_middle(bounds.low), from_middle(bounds.high))
            });
            let windows = [0, 1, 2].map(|channel| self.sums.windows(channel).map(|sums| &sums[..blocks]));
            for block in 0..blocks {
                let mut matching = [[P::Sum::from_i64(-1); WIDTH]; 2];
                for (windows, within) in windows.iter().zip(&within) {
                    for (matching, sums) in matching.iter_mut().zip(windows) {
                        *matching = join(*matching, sums[block], |so_far, sum| so_far.and(within.holds(sum)));
                    }
                }
                // Most rows have none, and packing costs as much as the rest.
                if matching.iter().any(chunk::any) {
                    let [first, second] = matching;
                    let matching = [chunk::pack(first), chunk::pack(second)];
                    self.pending.push(Pending { block, shade, matching });
                }
            }
        }
    }

    /// Compares D = nQ − S² of the pending windows and sets those that match.
    #[inline(always)]
    fn compare_spreads(&mut self, question: &Question<'_>, first_word: u32, y: u32, mask: &mut BitMask) {
        for &Pending { block, shade, matching: by_means } in &self.pending {
            let mut matching: [Chunk<P::Spread>; 2] = [[P::Spread::from_i64(-1); WIDTH]; 2];
            for (channel, bounds) in question.accepted[shade].spread.iter().enumerate() {
                let within = P::spreads(bounds.low as i64, bounds.high as i64);
                let windows = self.sums.windows(channel).into_iter().zip(self.squares.windows(channel));
                for (matching, (sums, squares)) in matching.iter_mut().zip(windows) {
                    let spreads =
                        join(sums[block], squares[block], |sum, squares| squares.minus(P::square(sum)));
                    *matching = join(*matching, spreads, |so_far, spread| so_far.and(within.holds(spread)));
                }
            }
            let [first, second] = matching;
            let matching = [chunk::pack(first) & by_means[0], chunk::pack(second) & by_means[1]];
            if matching != [0; 2] {
                set(mask, y, first_word + block as u32, matching);
            }
        }
    }
}

/// The row of pixels that comes under the window on the way to mask row `y`.
#[inline(always)]
fn entering(y: u32, side: u16) -> u32 {
    DoubledGrid::pixels_under(y, side).end - 1
}

/// The row of pixels that the window leaves, or leaves in part, on the way to mask row `y`.
#[inline(always)]
fn leaving(y: u32, side: u16) -> u32 {
    DoubledGrid::pixels_under(y - 1, side).start
}

/// The rows of pixels under the windows of mask row `y`, each with its samples.
#[inline(always)]
fn weighted_rows(y: u32, side: u16) -> impl Iterator<Item = (u32, u32)> {
    DoubledGrid::pixels_under(y, side).map(move |row| (row, DoubledGrid::samples_on(row, y, side)))
}

#[inline(always)]
fn level<T: Lane>(level: u8) -> T {
    T::from_i64(i64::from(i16::from(level) - MIDDLE_LEVEL as i16))
}

#[inline(always)]
fn square<T: Lane>(level: u8) -> T {
    let level = i16::from(level) - MIDDLE_LEVEL as i16;
    T::from_i64(i64::from(level * level))
}

/// Sets the matching windows in word `word` of row `y`. Windows beyond the mask's right edge do not lie wholly inside the
/// region and do not count.
#[inline(always)]
pub(super) fn set(mask: &mut BitMask, y: u32, word: u32, [on_first, on_second]: Matching) {
    let bits = spread(on_first) | spread(on_second) << 1;
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
