//! Which of many colours may match in each cell.

use std::ops::Range;

use super::index::{Colours, Index};
use super::ranges::Ranges;

/// Up to 64 colours, by what a survey may see of them, and for each cell those that may match there.
#[derive(Clone, Debug, Default)]
pub(super) struct Living {
    pub(super) index: Index,
    cells: Vec<Colours>,
}

impl Living {
    /// Begins a survey of so many cells.
    #[inline(always)]
    pub(super) fn begin(&mut self, cells: usize) {
        self.index.finish();
        self.cells.clear();
        self.cells.resize(cells, Colours::MAX);
    }

    /// Takes from cells the colours that the range of one channel there rules out. Gives how many cells this channel alone
    /// would leave.
    #[inline(always)]
    pub(super) fn narrow(&mut self, channel: usize, cells: Range<usize>, ranges: &Ranges) -> usize {
        let [low, high] = ranges.channel(channel, cells.clone());
        let mut left = 0;
        for (living, (&low, &high)) in self.cells[cells].iter_mut().zip(low.iter().zip(high)) {
            let touching = self.index.touching(channel, low, high);
            left += usize::from(touching != 0);
            *living &= touching;
        }
        left
    }

    /// The colours of every cell, row after row.
    #[inline(always)]
    pub(super) fn cells(&self) -> &[Colours] {
        &self.cells
    }

    /// As [`cells`](Self::cells), to take more of them.
    #[inline(always)]
    pub(super) fn cells_mut(&mut self) -> &mut [Colours] {
        &mut self.cells
    }
}
