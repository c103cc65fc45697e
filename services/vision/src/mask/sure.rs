//! Proof, where a landmark's colour covers much of a frame, that all windows of a stretch match.
//!
//! For any level c, n samples of mean μ and variance σ² have Σ(x − c)² = n σ² + n (μ − c)². A pixel gives a window at
//! most four samples, so with Q = Σ(x − c)² over all pixels under the windows that begin on one pixel, neither σ² nor
//! (μ − c)² exceeds 4Q/n for any of the four. With c in the middle of the accepted means, a small Q proves that all four
//! match; Q costs a few additions of narrow numbers a pixel. Sums that do not fit saturate, which proves nothing.

use crate::bitmask::BitMask;
use crate::doubled_grid::DoubledGrid;
use crate::statistics::Acceptance;

use super::cells::Cells;
use super::chunk::{self, WIDTH, chunks, chunks_mut, fit, join};
use super::exact::{Area, BLOCK_PX, Question, ROWS_TOGETHER, set};
use super::lane::Lane;
use super::lanes::Work;
use super::planes::Planes;
use super::powers::{Powers, columns_under};

/// The middle level c and the largest Q that proves a match, for each channel; Q in units of 2^`shift`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Proof {
    middle: [u8; 3],
    most: [u16; 3],
    shift: [u32; 3],
}

impl Proof {
    /// `None` where nothing can be proven: where a variance may be too small as well as too large, which Q cannot tell.
    pub(super) fn new(accepted: &Acceptance, grid: &DoubledGrid) -> Option<Self> {
        let n = u64::from(grid.samples());
        let pixels = u64::from(pixels_wide(grid).max(pixels_high(grid)));
        let mut proof = Self { middle: [0; 3], most: [0; 3], shift: [0; 3] };
        for channel in 0..3 {
            let (sum, spread) = (accepted.sum[channel], accepted.spread[channel]);
            let (low, high) = (u64::from(sum.low), u64::from(sum.high));
            let middle = ((low + high + n) / (2 * n)).min(255);
            let reach = high.checked_sub(n * middle)?.min((n * middle).checked_sub(low)?);
            if spread.low > 0 {
                return None;
            }
            // n² σ² ≤ 4nQ ≤ the largest D, and n² (μ − c)² ≤ 4nQ ≤ reach².
            let most = spread.high.min(reach.pow(2)) / (4 * n);
            // So that no sum of clipped squares overflows.
            let shift = (0..=8).find(|shift| ((most >> shift) + 1) * pixels <= i16::MAX as u64)?;
            (proof.middle[channel], proof.shift[channel]) = (middle as u8, shift);
            proof.most[channel] = (most >> shift) as u16;
        }
        Some(proof)
    }

    /// What a level adds to Q: rounded up, and clipped where it alone is too much.
    #[inline(always)]
    fn square(self, channel: usize) -> impl Fn(u8) -> i16 + Copy {
        let (middle, shift) = (self.middle[channel], self.shift[channel]);
        let (too_much, round) = (self.most[channel] + 1, (1 << shift) - 1);
        move |level| {
            let off = u16::from(level.abs_diff(middle));
            // 255² + 2⁸ − 1 fits into 16 bits.
            ((off * off + round) >> shift).min(too_much) as i16
        }
    }
}

/// Pixels under the windows that begin on one pixel, along x and y.
fn pixels_wide(grid: &DoubledGrid) -> u32 {
    DoubledGrid::most_pixels_under(grid.window().width)
}

fn pixels_high(grid: &DoubledGrid) -> u32 {
    DoubledGrid::most_pixels_under(grid.window().height)
}

/// Memory of the proof.
#[derive(Clone, Debug, Default)]
pub(super) struct Sure {
    planes: Planes,
    /// Q of the columns over the rows under the windows.
    columns: [Vec<i16>; 3],
    powers: Powers<i16>,
    /// For each block, a bit for each pixel whose windows are proven to match.
    proven: Vec<u32>,
    row: Option<u32>,
    /// Blocks of several rows in which something is not.
    unproven: Cells,
}

/// The proof for an area: sets in `mask` what is proven, and adds what it leaves to `rest`.
pub(super) struct Prove<'a> {
    pub(super) question: Question<'a>,
    pub(super) proof: Proof,
    pub(super) area: Area,
    pub(super) sure: &'a mut Sure,
    pub(super) mask: &'a mut BitMask,
    pub(super) rest: &'a mut Vec<Area>,
}

impl Work for Prove<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { question, proof, area, sure, mask, rest } = self;
        sure.fit(&question, &area);
        let (pixels, bands) = area.bands();
        sure.unproven.reset(bands as usize, area.blocks.len());
        for row in pixels.clone() {
            let starts = DoubledGrid::starts_on(row);
            let inside = area.rows.start <= starts.start && starts.end <= area.rows.end;
            if inside && row + pixels_high(question.grid) <= question.grid.region().height {
                sure.sum_rows(&question, proof, row);
                sure.compare(proof, area.blocks.len());
            } else {
                sure.proven.clear();
                sure.proven.resize(area.blocks.len(), 0);
            }
            sure.note(&area, row, (row - pixels.start) / ROWS_TOGETHER, mask);
        }
        sure.unproven.take_areas(|band| area.rows_of_band(band), area.blocks.start, rest);
    }
}

impl Sure {
    #[inline(always)]
    fn fit(&mut self, question: &Question<'_>, area: &Area) {
        let positions = WIDTH * area.blocks.len();
        let side = 2 * pixels_wide(question.grid) as u16;
        self.powers.fit(columns_under(positions, side), side);
        let columns = self.powers.columns().len();
        for sums in &mut self.columns {
            fit(sums, columns);
        }
        self.planes.fit(BLOCK_PX * area.blocks.start, columns, pixels_high(question.grid) as usize);
        self.row = None;
    }

    /// Brings the columns' sums to the windows that begin on row `row` of pixels.
    #[inline(always)]
    fn sum_rows(&mut self, question: &Question<'_>, proof: Proof, row: u32) {
        let (rows, columns) = (row..row + pixels_high(question.grid), self.powers.columns().len());
        for row in rows.clone() {
            self.planes.read(question.frame, question.grid, row);
        }
        for (channel, sums) in self.columns.iter_mut().enumerate() {
            let of = proof.square(channel);
            self.planes.sum_rows(&mut sums[..columns], self.row, rows.clone(), channel, of);
        }
        self.row = Some(row);
    }

    /// Sums over the columns under the windows, and compares.
    #[inline(always)]
    fn compare(&mut self, proof: Proof, blocks: usize) {
        self.proven.clear();
        self.proven.resize(blocks, u32::MAX);
        for (channel, sums) in self.columns.iter().enumerate() {
            let most = proof.most[channel] as i16;
            let columns = self.powers.columns();
            for (clipped, sums) in chunks_mut(columns).iter_mut().zip(chunks(sums)) {
                *clipped = join(*sums, *sums, |sum, _| sum.min(most + 1));
            }
            self.powers.build();
            for (proven, sums) in self.proven.iter_mut().zip(chunks(self.powers.lesser_sums())) {
                *proven &= chunk::pack(join(*sums, *sums, |sum, _| sum.at_most(most)));
            }
        }
    }

    /// Sets what is proven for the windows that begin on row `row` of pixels, and notes in which blocks some are not.
    #[inline(always)]
    fn note(&mut self, area: &Area, row: u32, band: u32, mask: &mut BitMask) {
        let pixels = DoubledGrid::pixels_of_starts(&(0..mask.width())).end;
        let unproven = self.unproven.band(band as usize);
        for ((block, &proven), unproven) in (area.blocks.start..).zip(&self.proven).zip(unproven) {
            for y in DoubledGrid::starts_on(row).filter(|_| proven != 0) {
                set(mask, y, block, [proven; 2]);
            }
            // Windows beyond the mask's right edge do not exist.
            let existing = pixels.saturating_sub(BLOCK_PX * block).min(BLOCK_PX);
            *unproven |= u8::from(proven.trailing_ones() < existing);
        }
    }
}
