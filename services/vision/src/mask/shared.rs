//! What landmarks with one window share: a survey of the frame, and by it, for every cell, the set of those that may match
//! there.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::statistics::Acceptance;

use super::cells::Cells;
use super::index::{Colours, Index, MOST_COLOURS};
use super::lanes::Work;
use super::lattice::{Closer, Quarters};
use super::living::Living;
use super::mesh::{Lattice, Mesh};
use super::ranges::Ranges;
use super::sub_blocks::SubBlocks;
use super::sums::Sums;

/// What was seen for the landmarks of one grid, and the memory to see it with.
#[derive(Clone, Debug, Default)]
pub(super) struct Shared {
    of: Option<(DoubledGrid, Mesh)>,
    ranges: Ranges,
    sub_blocks: SubBlocks,
    sums: Sums,
    quarters: Quarters,
    groups: Vec<Group>,
    /// For each group, what the survey leaves of its colours.
    living: Vec<Living>,
    /// Groups in use.
    used: usize,
}

/// Colours that fit into one index.
#[derive(Clone, Debug, Default)]
struct Group {
    colours: u32,
    /// By averages of the lattice's.
    of_lattice: Index,
    /// The most that one of them allows between the halves of the lattice's sub-blocks.
    most_between_halves: u8,
    /// Those that may match anywhere.
    anywhere: Colours,
}

/// Where a landmark's colours are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    group: usize,
    colours: Colours,
}

impl Shared {
    /// Forgets what was seen.
    pub(super) fn forget(&mut self) {
        self.of = None;
    }

    /// How this grid was surveyed, if it was.
    pub(super) fn mesh_of(&self, grid: &DoubledGrid) -> Option<Mesh> {
        self.of.filter(|(seen, _)| seen == grid).map(|(_, mesh)| mesh)
    }

    /// Begins anew, for landmarks on that grid.
    pub(super) fn begin(&mut self, grid: DoubledGrid, mesh: Mesh) {
        (self.of, self.used) = (Some((grid, mesh)), 0);
    }

    /// Adds a landmark by what its shades accept; `None` for more shades than fit together.
    pub(super) fn add(&mut self, accepted: &[Acceptance]) -> Option<Place> {
        let (grid, mesh) = self.of?;
        let shades = u32::try_from(accepted.len()).ok().filter(|&shades| shades <= MOST_COLOURS)?;
        let full = |group: &Group| group.colours + shades > MOST_COLOURS;
        if self.groups[..self.used].last().is_none_or(full) {
            if self.used == self.groups.len() {
                self.groups.push(Group::default());
                self.living.push(Living::default());
            }
            self.groups[self.used].clear();
            self.living[self.used].index.clear();
            self.used += 1;
        }
        let group = self.used - 1;
        let Self { groups, living, .. } = self;
        let add = |accepted| groups[group].add(accepted, &grid, mesh, &mut living[group].index);
        Some(Place { group, colours: accepted.iter().map(add).fold(0, |all, one| all | one) })
    }

    /// Whether a landmark may match anywhere.
    pub(super) fn may_match(&self, place: Place) -> bool {
        self.groups[place.group].anywhere & place.colours != 0
    }

    /// Sets the cells where a landmark may match.
    pub(super) fn tell(&self, place: Place, cells: &mut Cells) {
        cells.reset(self.ranges.rows(), self.ranges.blocks());
        for (flag, living) in cells.flags().iter_mut().zip(self.living[place.group].cells()) {
            *flag = u8::from(living & place.colours != 0);
        }
    }

    pub(super) fn ranges(&self) -> &Ranges {
        &self.ranges
    }
}

impl Group {
    fn clear(&mut self) {
        self.colours = 0;
        self.most_between_halves = 0;
        self.of_lattice.clear();
    }

    /// Adds a shade; what its sub-blocks may look like nowhere, it accepts nowhere.
    fn add(
        &mut self,
        accepted: &Acceptance,
        grid: &DoubledGrid,
        mesh: Mesh,
        of_survey: &mut Index,
    ) -> Colours {
        let colour = 1 << self.colours;
        self.colours += 1;
        let samples = grid.samples();
        if let Some(averages) = mesh.averages(accepted, samples) {
            of_survey.add(colour, &averages);
        }
        if let Some(sub_block) = Lattice::of(grid.window()).map(Lattice::sub_block) {
            let most = sub_block.most_between_halves(accepted, samples);
            self.most_between_halves = self.most_between_halves.max(most);
            if let Some(averages) = sub_block.averages(accepted, samples) {
                self.of_lattice.add(colour, &averages);
            }
        }
        colour
    }

    /// Looks closer at the cells that are worth it, of so many blocks a row.
    #[inline(always)]
    fn sort(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        mesh: Mesh,
        blocks: usize,
        cells: &mut [Colours],
        quarters: &mut Quarters,
    ) {
        self.of_lattice.finish();
        if let Some(lattice) = Lattice::of(grid.window()) {
            let (index, most_between_halves) = (&self.of_lattice, self.most_between_halves);
            let closer = Closer { frame, grid, lattice, index, most_between_halves };
            let worth_it = least_worth_a_look(mesh);
            for (row, living) in cells.chunks_mut(blocks).enumerate() {
                look_closer(closer, mesh.start_pixels(row as u32), worth_it, living, quarters);
            }
        }
        self.anywhere = 0;
        for living in cells {
            self.anywhere |= *living;
        }
    }
}

/// Looks closer at those cells of a row where so many colours live: neighbouring ones together.
#[inline(always)]
fn look_closer(
    closer: Closer<'_>,
    starts: Range<u32>,
    worth_it: u32,
    row: &mut [Colours],
    quarters: &mut Quarters,
) {
    let is_worth_it = |living: &Colours| living.count_ones() >= worth_it;
    let mut from = 0;
    while let Some(ahead) = row[from..].iter().position(is_worth_it) {
        let start = from + ahead;
        let length = row[start..].iter().take_while(|living| is_worth_it(living)).count();
        from = start + length;
        quarters.look(closer, starts.clone(), start..from, &mut row[start..from]);
    }
}

/// So many colours must live in a cell for a closer look. Means of whole windows leave hardly more than borders between
/// surfaces, which it rules out; sub-blocks leave whole surfaces of nearly a colour, and of a single one these are refuted at
/// less cost.
#[inline(always)]
fn least_worth_a_look(mesh: Mesh) -> u32 {
    if mesh.is_of_windows() { 1 } else { 2 }
}

/// The pass over the frame for all landmarks that were added.
pub(super) struct See<'a> {
    pub(super) shared: &'a mut Shared,
    pub(super) frame: &'a Frame,
}

impl Work for See<'_> {
    #[inline(always)]
    fn run(self) {
        let Self { shared: Shared { of, ranges, sub_blocks, sums, quarters, groups, living, used }, frame } =
            self;
        let Some((grid, mesh)) = of else { return };
        let (mesh, groups, living) = (*mesh, &mut groups[..*used], &mut living[..*used]);
        ranges.fit_to(grid, mesh);
        let cells = ranges.rows() * ranges.blocks();
        for living in &mut *living {
            living.begin(cells);
        }
        if mesh.is_of_windows() {
            sums.take(frame, grid, mesh, ranges, living);
        } else {
            sub_blocks.take(frame, grid, mesh, ranges);
            for living in &mut *living {
                for channel in 0..3 {
                    living.narrow(channel, 0..cells, ranges);
                }
            }
        }
        for (group, living) in groups.iter_mut().zip(living) {
            group.sort(frame, grid, mesh, ranges.blocks(), living.cells_mut(), quarters);
        }
    }
}
