//! The darkest and lightest sub-blocks of every cell of a region: one pass over the frame for all landmarks of one
//! window.
//!
//! A landmark whose bounds ([`super::mesh`]) miss a cell's range in any channel has no matching window there. The pass
//! reads every pixel a few times; asking it about a landmark then costs a few bytes a cell.

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Bounds;

use super::cells::Cells;
use super::lanes::Work;
use super::mesh::Mesh;
use super::ranges::Ranges;
use super::sub_blocks::SubBlocks;

/// What was seen, and the memory to see it with.
#[derive(Clone, Debug, Default)]
pub(super) struct Survey {
    ranges: Ranges,
    sub_blocks: SubBlocks,
}

/// A pass over the grid's region for a survey.
pub(super) struct Take<'a> {
    pub(super) survey: &'a mut Survey,
    pub(super) frame: &'a Frame,
    pub(super) grid: &'a DoubledGrid,
    pub(super) mesh: Mesh,
}

impl Work for Take<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { survey: Survey { ranges, sub_blocks }, frame, grid, mesh } = self;
        ranges.fit_to(grid, mesh);
        sub_blocks.take(frame, grid, mesh, ranges);
    }
}

/// A question to a survey: sets the cells where a window may match one of the shades.
pub(super) struct Ask<'a> {
    pub(super) survey: &'a mut Survey,
    pub(super) shades: &'a [[Bounds<u8>; 3]],
    pub(super) cells: &'a mut Cells,
}

impl Work for Ask<'_> {
    #[inline(always)]
    fn run(self) {
        self.survey.ranges.ask(self.shades, self.cells);
    }
}

impl Survey {
    pub(super) fn ranges(&self) -> &Ranges {
        &self.ranges
    }
}
