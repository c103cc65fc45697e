//! A closer look at cells where several landmarks may match: which of them does each sub-block of a lattice leave?
//!
//! A [survey](super::survey) keeps the extremes over a cell, and between a dark and a light surface these hold every colour
//! there is. Here each sub-block is asked by itself, about all landmarks at once ([`Index`]). What lies across a border is
//! left out: where the halves of a sub-block differ too much, no window around it varies as little as a landmark wants
//! ([`super::mesh`]).

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;

use super::aligned::Aligned;
use super::exact::BLOCK_PX;
use super::index::{Colours, Index};
use super::mesh::{Lattice, SubBlock};
use super::sieve::{average, average_runs, row_bytes};
use super::sub_blocks::average_rows;

/// What is asked of every sub-block.
#[derive(Clone, Copy)]
pub(super) struct Closer<'a> {
    pub(super) frame: &'a Frame,
    pub(super) grid: &'a DoubledGrid,
    pub(super) lattice: Lattice,
    pub(super) index: &'a Index,
    /// Sub-blocks whose halves differ more, in any channel, belong to no window that matches.
    pub(super) most_between_halves: u8,
}

/// Memory of the look.
#[derive(Clone, Debug, Default)]
pub(super) struct Quarters {
    /// Averages of the upper and the lower quarters of sub-blocks, from each pixel on.
    upper: Aligned<u8>,
    lower: Aligned<u8>,
    memory: Aligned<u8>,
    averaged: Averaged,
    /// What the sub-blocks of each cell leave.
    left: Vec<Colours>,
}

/// Sub-blocks put together from their quarters, from each pixel on.
#[derive(Clone, Debug, Default)]
struct Averaged {
    averages: Aligned<u8>,
    /// Not 0 where halves differ too much.
    unlike: Aligned<u8>,
}

impl Averaged {
    /// The colours that sub-blocks of the lattice in those columns accept.
    #[inline(always)]
    fn accepted(&self, closer: Closer<'_>, columns: Range<u32>) -> Colours {
        let columns = columns.start as usize..columns.end as usize;
        let every = closer.lattice.column_step() as usize;
        let averages = self.averages.as_chunks::<3>().0[columns.clone()].iter().step_by(every);
        let unlike = self.unlike.as_chunks::<3>().0[columns].iter().step_by(every);
        let mut accepted = 0;
        for (&average, [red, green, blue]) in averages.zip(unlike) {
            if red | green | blue == 0 {
                accepted |= closer.index.accepting(average);
            }
        }
        accepted
    }
}

impl Quarters {
    /// Takes from `living`, the colours that may match in a run of cells, those that no sub-block there accepts. The
    /// cells' windows begin in rows `starts` of pixels and in blocks `blocks`.
    #[inline(always)]
    pub(super) fn look(
        &mut self,
        closer: Closer<'_>,
        starts: Range<u32>,
        blocks: Range<usize>,
        living: &mut [Colours],
    ) {
        let SubBlock { width_px, height_px } = closer.lattice.sub_block();
        let region = closer.grid.region();
        let first_px = BLOCK_PX * blocks.start as u32;
        let end_px = (BLOCK_PX * blocks.end as u32 + closer.lattice.reach_px()).min(region.width);
        self.fit((end_px - first_px).div_ceil(BLOCK_PX) as usize, blocks.len());
        for top in closer.lattice.rows(&starts).take_while(|top| top + height_px <= region.height) {
            self.average(closer, top, first_px..end_px);
            self.join(closer);
            for (block, left) in (blocks.start as u32..).zip(&mut self.left) {
                let columns = closer.lattice.columns(&(BLOCK_PX * block..BLOCK_PX * (block + 1)));
                let end = columns.end.min(region.width + 1 - width_px).max(columns.start);
                *left |= self.averaged.accepted(closer, columns.start - first_px..end - first_px);
            }
        }
        living.iter_mut().zip(&self.left).for_each(|(living, left)| *living &= left);
    }

    #[inline(always)]
    fn fit(&mut self, blocks_read: usize, cells: usize) {
        let Self { upper, lower, memory, averaged: Averaged { averages, unlike }, left } = self;
        for buffer in [upper, lower, memory, averages, unlike] {
            buffer.fit(row_bytes(blocks_read));
        }
        left.clear();
        left.resize(cells, 0);
    }

    /// Averages the quarters of the sub-blocks that begin in row `top` of the region's pixels.
    #[inline(always)]
    fn average(&mut self, closer: Closer<'_>, top: u32, columns: Range<u32>) {
        let SubBlock { width_px, height_px } = closer.lattice.sub_block();
        let region = closer.grid.region();
        let bytes = 3 * (region.x + columns.start) as usize..3 * (region.x + columns.end) as usize;
        let row = |row: u32| &closer.frame.row(region.y + row)[bytes.clone()];
        let half_px = (height_px / 2).max(1);
        // A single row is both of its halves.
        let lower = top + height_px - half_px;
        average_rows(|ahead| row(top + ahead), half_px, &mut self.upper);
        average_rows(|ahead| row(lower + ahead), half_px, &mut self.lower);
        let halvings = width_px.ilog2().saturating_sub(1);
        average_runs(&mut self.upper, &mut self.memory, halvings);
        average_runs(&mut self.lower, &mut self.memory, halvings);
    }

    /// Joins the quarters: to the averages of sub-blocks, and to what their halves say.
    #[inline(always)]
    fn join(&mut self, closer: Closer<'_>) {
        let ahead = 3 * (closer.lattice.sub_block().width_px / 2) as usize;
        let Averaged { averages, unlike } = &mut self.averaged;
        let count = averages.len() - ahead;
        let (upper, lower) = (&self.upper[..count + ahead], &self.lower[..count + ahead]);
        let quarters = upper.iter().zip(&upper[ahead..]).zip(lower.iter().zip(&lower[ahead..]));
        let targets = averages.iter_mut().zip(unlike.iter_mut());
        for ((target, unlike), ((&upper_left, &upper_right), (&lower_left, &lower_right))) in
            targets.zip(quarters)
        {
            let (upper, lower) = (average(upper_left, upper_right), average(lower_left, lower_right));
            let (left, right) = (average(upper_left, lower_left), average(upper_right, lower_right));
            *target = average(upper, lower);
            let most = upper.abs_diff(lower).max(left.abs_diff(right));
            *unlike = most.saturating_sub(closer.most_between_halves);
        }
    }
}
