//! The exact test of all six parameters at every window position of an area, by running sums on the original grid.
//!
//! Vertically, the sums of a column over the window's rows follow from those one doubled row higher by one pixel that
//! enters and one that leaves: V(Y + 1) = V(Y) + p[⌊(Y + h)/2⌋] − p[⌊Y/2⌋], whatever the parity of Y and h.
//! Horizontally, see [`super::boxes`]. Everything runs element by element along a row, so that the compiler makes
//! vector code of it at any width; [`super::lanes`] chooses the width.

use std::ops::Range;

use crate::bitmask::BitMask;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Acceptance;

use super::boxes::{Boxes, fit};
use super::lane::{Lane, Precision};
use super::verdict::Verdict;

/// Pixels along x whose two window positions each make one word of the mask.
pub(super) const BLOCK_PX: u32 = 32;

/// Where to test: rows of the mask, and columns in blocks of [`BLOCK_PX`] pixels, each one word of the mask.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) rows: Range<u32>,
    pub(super) blocks: Range<u32>,
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
    channels: [Channel<P>; 3],
    sum_boxes: Boxes<P::Sum>,
    spread_boxes: Boxes<P::Spread>,
    verdict: Verdict,
    entering_row: Option<u32>,
    leaving_row: Option<u32>,
    /// The mask row whose window rows the columns' squares are summed over.
    squares_row: Option<u32>,
}

impl<P: Precision> Default for Scratch<P> {
    fn default() -> Self {
        Self {
            channels: Default::default(),
            sum_boxes: Boxes::default(),
            spread_boxes: Boxes::default(),
            verdict: Verdict::default(),
            entering_row: None,
            leaving_row: None,
            squares_row: None,
        }
    }
}

/// One colour channel of the area.
struct Channel<P: Precision> {
    entering: Vec<u8>,
    leaving: Vec<u8>,
    /// Sums of the levels, and of their squares, of each column over the window's rows.
    column_sum: Vec<P::Sum>,
    column_squares: Vec<P::Spread>,
    /// S and Q of the windows that start at each column, on its first and on its second sample.
    window_sum: [Vec<P::Sum>; 2],
    window_squares: [Vec<P::Spread>; 2],
}

impl<P: Precision> Default for Channel<P> {
    fn default() -> Self {
        Self {
            entering: Vec::new(),
            leaving: Vec::new(),
            column_sum: Vec::new(),
            column_squares: Vec::new(),
            window_sum: Default::default(),
            window_squares: Default::default(),
        }
    }
}

/// The columns of pixels that an area touches.
#[derive(Clone, Copy)]
struct Columns {
    /// First column, from the left of the region.
    first: u32,
    /// Columns at which windows start.
    positions: usize,
    /// Columns under any of the windows, some of them perhaps beyond the region.
    count: usize,
}

/// Sets in `mask` every pixel of `area` whose window matches one of the accepted shades.
#[inline(always)]
pub(super) fn test<P: Precision>(
    question: &Question<'_>,
    area: &Area,
    scratch: &mut Scratch<P>,
    mask: &mut BitMask,
) {
    let positions = BLOCK_PX as usize * area.blocks.len();
    let window = question.grid.window();
    let columns = Columns {
        first: BLOCK_PX * area.blocks.start,
        positions,
        count: positions + usize::from(window.width) / 2 + 1,
    };
    scratch.begin(question, columns, area.rows.start);
    for y in area.rows.clone() {
        if y > area.rows.start {
            scratch.descend(question, columns, y);
        }
        let mut summed = false;
        for accepted in question.accepted {
            if !scratch.means_match(question, columns, accepted, &mut summed) {
                continue;
            }
            scratch.sum_squares(question, columns, y);
            scratch.test_spreads(question, accepted);
            scratch.verdict.store(y, area.blocks.start, mask);
        }
    }
}

impl<P: Precision> Scratch<P> {
    /// Sums the columns for mask row `y` from nothing.
    #[inline(always)]
    fn begin(&mut self, question: &Question<'_>, columns: Columns, y: u32) {
        (self.entering_row, self.leaving_row, self.squares_row) = (None, None, None);
        for channel in &mut self.channels {
            channel.fit(columns);
            channel.column_sum.fill(P::Sum::default());
        }
        self.verdict.fit(columns.positions);
        let side = question.grid.window().height;
        for row in DoubledGrid::pixels_under(y, side) {
            let weight = P::Sum::from_u32(DoubledGrid::samples_on(row, y, side));
            self.load_entering(question, columns, row);
            for channel in &mut self.channels {
                for (sum, &level) in channel.column_sum.iter_mut().zip(&channel.entering) {
                    *sum = sum.plus(weight.times(P::Sum::from_level(level)));
                }
            }
        }
    }

    /// Goes on from mask row `y - 1` to `y`; squares follow only where they were wanted in the row above.
    #[inline(always)]
    fn descend(&mut self, question: &Question<'_>, columns: Columns, y: u32) {
        let side = question.grid.window().height;
        self.load_entering(question, columns, DoubledGrid::pixels_under(y, side).end - 1);
        self.load_leaving(question, columns, DoubledGrid::pixels_under(y - 1, side).start);
        let squares_follow = self.squares_row == Some(y - 1);
        for channel in &mut self.channels {
            let levels = channel.entering.iter().zip(&channel.leaving);
            for (sum, (&enters, &leaves)) in channel.column_sum.iter_mut().zip(levels.clone()) {
                *sum = sum.plus(P::Sum::from_level(enters)).minus(P::Sum::from_level(leaves));
            }
            if squares_follow {
                for (sum, (&enters, &leaves)) in channel.column_squares.iter_mut().zip(levels) {
                    *sum = sum.plus(square(enters)).minus(square(leaves));
                }
            }
        }
        self.squares_row = squares_follow.then_some(y);
    }

    /// Compares S of all windows of the row; false where none matches in all three channels.
    #[inline(always)]
    fn means_match(
        &mut self,
        question: &Question<'_>,
        columns: Columns,
        accepted: &Acceptance,
        summed: &mut bool,
    ) -> bool {
        self.verdict.accept_all();
        let side = question.grid.window().width;
        if !*summed {
            for channel in &mut self.channels {
                self.sum_boxes.windows(&channel.column_sum, side, columns.positions, &mut channel.window_sum);
            }
            *summed = true;
        }
        self.channels.iter().zip(&accepted.sum).all(|(channel, bounds)| {
            let low = P::Sum::from_u32(bounds.low);
            let reach = P::Sum::from_u32(bounds.high - bounds.low);
            self.verdict.narrow(&channel.window_sum, |sum| sum.within(low, reach))
        })
    }

    /// Brings Q of all windows of mask row `y` up to date.
    #[inline(always)]
    fn sum_squares(&mut self, question: &Question<'_>, columns: Columns, y: u32) {
        if self.squares_row != Some(y) {
            self.sum_column_squares(question, columns, y);
        }
        let side = question.grid.window().width;
        for channel in &mut self.channels {
            self.spread_boxes.windows(
                &channel.column_squares,
                side,
                columns.positions,
                &mut channel.window_squares,
            );
        }
    }

    #[inline(always)]
    fn sum_column_squares(&mut self, question: &Question<'_>, columns: Columns, y: u32) {
        for channel in &mut self.channels {
            channel.column_squares.fill(P::Spread::default());
        }
        let side = question.grid.window().height;
        for row in DoubledGrid::pixels_under(y, side) {
            let weight = P::Spread::from_u32(DoubledGrid::samples_on(row, y, side));
            self.load_entering(question, columns, row);
            for channel in &mut self.channels {
                for (sum, &level) in channel.column_squares.iter_mut().zip(&channel.entering) {
                    *sum = sum.plus(weight.times(square(level)));
                }
            }
        }
        self.squares_row = Some(y);
    }

    /// Compares D = nQ − S² of all windows of the row.
    #[inline(always)]
    fn test_spreads(&mut self, question: &Question<'_>, accepted: &Acceptance) {
        let samples = P::Spread::from_u32(question.grid.samples());
        for (channel, bounds) in self.channels.iter().zip(&accepted.spread) {
            let low = P::Spread::from_u64(bounds.low);
            let reach = P::Spread::from_u64(bounds.high - bounds.low);
            self.verdict.narrow_by_two(&channel.window_sum, &channel.window_squares, |sum, squares| {
                let sum = P::Spread::from_u64(sum.to_u64());
                samples.times(squares).minus(sum.times(sum)).within(low, reach)
            });
        }
    }

    #[inline(always)]
    fn load_entering(&mut self, question: &Question<'_>, columns: Columns, row: u32) {
        if self.entering_row != Some(row) {
            let [red, green, blue] = &mut self.channels;
            load(question, columns, row, [&mut red.entering, &mut green.entering, &mut blue.entering]);
            self.entering_row = Some(row);
        }
    }

    #[inline(always)]
    fn load_leaving(&mut self, question: &Question<'_>, columns: Columns, row: u32) {
        if self.leaving_row != Some(row) {
            let [red, green, blue] = &mut self.channels;
            load(question, columns, row, [&mut red.leaving, &mut green.leaving, &mut blue.leaving]);
            self.leaving_row = Some(row);
        }
    }
}

impl<P: Precision> Channel<P> {
    fn fit(&mut self, columns: Columns) {
        fit(&mut self.entering, columns.count);
        fit(&mut self.leaving, columns.count);
        fit(&mut self.column_sum, columns.count);
        fit(&mut self.column_squares, columns.count);
        for phase in 0..2 {
            fit(&mut self.window_sum[phase], columns.positions);
            fit(&mut self.window_squares[phase], columns.positions);
        }
    }
}

#[inline(always)]
fn square<S: Lane>(level: u8) -> S {
    S::from_u32(u32::from(level) * u32::from(level))
}

/// Splits one row of the region into channels; columns beyond the region are black, no window that counts sees them.
#[inline(always)]
fn load(question: &Question<'_>, columns: Columns, row: u32, into: [&mut [u8]; 3]) {
    let region = question.grid.region();
    let inside = ((region.width - columns.first) as usize).min(columns.count);
    let start = 3 * (region.x + columns.first) as usize;
    let pixels = &question.frame.row(region.y + row)[start..start + 3 * inside];
    let [red, green, blue] = into;
    let (red, red_beyond) = red.split_at_mut(inside);
    let (green, green_beyond) = green.split_at_mut(inside);
    let (blue, blue_beyond) = blue.split_at_mut(inside);
    for (((pixel, red), green), blue) in pixels.chunks_exact(3).zip(red).zip(green).zip(blue) {
        (*red, *green, *blue) = (pixel[0], pixel[1], pixel[2]);
    }
    red_beyond.fill(0);
    green_beyond.fill(0);
    blue_beyond.fill(0);
}
