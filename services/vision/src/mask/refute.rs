//! Proof, where a frame's colour comes near a landmark's, that no window of a stretch matches: by one channel.
//!
//! Sub-blocks prove nothing where colours differ by little more than the tolerance. But there one channel is usually
//! too dark, or too light, in every window; and S of a window in one channel takes a sixth of the work of the exact
//! test: one channel of three, and only windows that start on the first samples of pixels, since the others are means of
//! those ([`super::mesh`]).

use crate::doubled_grid::DoubledGrid;
use crate::statistics::Acceptance;

use super::cells::Cells;
use super::chunk::{WIDTH, chunks, chunks_mut, join};
use super::exact::{Area, BLOCK_PX, Question, ROWS_TOGETHER};
use super::lanes::Work;
use super::planes::Planes;
use super::powers::{Powers, columns_under};

/// The level that counts as 0.
const MIDDLE: i16 = 128;

/// What may be wrong with all windows of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Doubt {
    pub(super) channel: usize,
    pub(super) side: Side,
}

/// To which side of what is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    TooDark,
    TooLight,
}

impl Doubt {
    /// Each of them; the first one's [number](Self::number) is 1.
    pub(super) const ALL: [Self; 6] = [
        Self { channel: 0, side: Side::TooDark },
        Self { channel: 0, side: Side::TooLight },
        Self { channel: 1, side: Side::TooDark },
        Self { channel: 1, side: Side::TooLight },
        Self { channel: 2, side: Side::TooDark },
        Self { channel: 2, side: Side::TooLight },
    ];

    /// A number from 1 on.
    pub(super) fn number(self) -> u8 {
        1 + 2 * self.channel as u8 + u8::from(self.side == Side::TooLight)
    }
}

/// How a doubt is settled: windows may match where S, of levels from the middle and with that sign, is at least `least`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Refutation {
    channel: usize,
    sign: i16,
    least: i16,
}

impl Refutation {
    /// `None` for windows that are odd, or too large for narrow sums.
    pub(super) fn new(doubt: Doubt, accepted: &Acceptance, grid: &DoubledGrid) -> Option<Self> {
        let window = grid.window();
        let (wide, high) = (pixels(window.width)?, pixels(window.height)?);
        let pixels = i64::from(wide * high);
        let samples_per_px = i64::from(grid.samples()) / pixels;
        let bounds = accepted.sum[doubt.channel];
        let middle = i64::from(MIDDLE) * pixels;
        let (sign, least) = match doubt.side {
            Side::TooDark => (1, (i64::from(bounds.low) + samples_per_px - 1) / samples_per_px - middle),
            Side::TooLight => (-1, middle - i64::from(bounds.high) / samples_per_px),
        };
        // |S| ≤ 128 for each pixel.
        let fits = middle <= i64::from(i16::MAX);
        Some(Self { channel: doubt.channel, sign, least: i16::try_from(least).ok().filter(|_| fits)? })
    }

    #[inline(always)]
    fn level(self, level: u8) -> i16 {
        self.sign * (i16::from(level) - MIDDLE)
    }
}

/// Pixels under a window side that starts on the first sample of one; `None` where that covers some in part.
fn pixels(side: u16) -> Option<u32> {
    side.is_multiple_of(2).then(|| DoubledGrid::aligned_pixels(side))
}

/// Memory of refutation.
#[derive(Clone, Debug, Default)]
pub(super) struct Refuter {
    planes: Planes,
    /// Of the columns' sums over the rows under the windows.
    powers: Powers<i16>,
    /// The row of pixels on which the windows begin that the columns' sums are of.
    row: Option<u32>,
    /// The largest S of each column over the rows so far.
    largest: Vec<i16>,
    left: Cells,
}

/// Adds to `rest` the parts of an area that one channel does not refute.
pub(super) struct Refute<'a> {
    pub(super) question: Question<'a>,
    pub(super) refutation: Refutation,
    pub(super) area: Area,
    pub(super) refuter: &'a mut Refuter,
    pub(super) rest: &'a mut Vec<Area>,
}

impl Work for Refute<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { question, refutation, area, refuter, rest } = self;
        let (rows, bands) = area.bands();
        refuter.fit(&question, &area, bands);
        let high = DoubledGrid::aligned_pixels(question.grid.window().height);
        let last = rows.end.min(question.grid.region().height - high);
        // A window that starts on the second sample of a row is the mean of this row's and the next one's.
        for row in rows.start..=last {
            refuter.sum_rows(&question, refutation, row);
            let (ahead, band) = (row - rows.start, (row - rows.start) / ROWS_TOGETHER);
            let first = ahead.is_multiple_of(ROWS_TOGETHER);
            if first && band > 0 {
                refuter.extend_largest();
                refuter.note(refutation, band - 1);
            }
            if first {
                refuter.largest.fill(i16::MIN);
            }
            refuter.extend_largest();
            if row == last && band < bands {
                refuter.note(refutation, band);
            }
        }
        refuter.left.take_areas(|band| area.rows_of_band(band), area.blocks.start, rest);
    }
}

impl Refuter {
    #[inline(always)]
    fn fit(&mut self, question: &Question<'_>, area: &Area, bands: u32) {
        let window = question.grid.window();
        // And one more column, for the means.
        let positions = WIDTH * area.blocks.len() + 1;
        self.powers.fit(columns_under(positions, window.width), window.width);
        let columns = self.powers.columns().len();
        self.largest.resize(columns, i16::MIN);
        let rows = DoubledGrid::aligned_pixels(window.height);
        self.planes.fit(BLOCK_PX * area.blocks.start, columns, rows as usize);
        self.left.reset(bands as usize, area.blocks.len());
        self.row = None;
    }

    /// Brings the columns' sums to the windows that start on row `row` of pixels.
    #[inline(always)]
    fn sum_rows(&mut self, question: &Question<'_>, refutation: Refutation, row: u32) {
        let rows = row..row + DoubledGrid::aligned_pixels(question.grid.window().height);
        for row in rows.clone() {
            self.planes.read(question.frame, question.grid, row);
        }
        let columns = self.powers.columns();
        let of = |level| refutation.level(level);
        self.planes.sum_rows(columns, self.row, rows, refutation.channel, of);
        self.row = Some(row);
        self.powers.build();
    }

    /// Extends the largest sums to the present row.
    #[inline(always)]
    fn extend_largest(&mut self) {
        let sums = chunks(self.powers.lesser_sums());
        for (largest, sums) in chunks_mut(&mut self.largest).iter_mut().zip(sums) {
            *largest = join(*largest, *sums, i16::max);
        }
    }

    /// Notes in which blocks of a band a window may match: those where it does by its own columns, or by the first one
    /// after them.
    #[inline(always)]
    fn note(&mut self, refutation: Refutation, band: u32) {
        let (blocks, least) = (self.largest.as_chunks::<WIDTH>().0, refutation.least);
        for (block, left) in self.left.band(band as usize).iter_mut().enumerate() {
            let largest = blocks[block].iter().copied().fold(blocks[block + 1][0], i16::max);
            *left = u8::from(largest >= least);
        }
    }
}
