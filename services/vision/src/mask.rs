//! Steps 4–9 of thesis 4.0.3: the mask of all window positions that match in all six parameters.
//!
//! The result equals, bit for bit, what the definition gives: enlarge the picture twofold, take the six statistics of
//! every window that lies wholly inside, compare ([`reference`](crate::reference)). Masks of several shades are
//! united.

mod aligned;
mod cells;
mod channel;
mod chunk;
mod exact;
mod index;
mod lane;
mod lanes;
mod lattice;
mod living;
mod mesh;
mod planes;
mod powers;
mod ranges;
mod refute;
mod running;
mod shared;
mod sieve;
mod sub_blocks;
mod sums;
mod sure;
mod survey;

pub use lanes::Lanes;
pub(crate) use lanes::Work;

use crate::bitmask::BitMask;
use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::landmark::Landmark;
use crate::probe::{Stage, StageProbe};
use crate::statistics::{Acceptance, Bounds};

use cells::Cells;
use exact::{Area, BLOCK_PX, Question, Scratch, Test};
use lane::{MEDIUM_SAMPLES, Medium, NARROW_SAMPLES, Narrow, Precision, Wide};
use mesh::Mesh;
use refute::{Doubt, Refutation, Refute, Refuter};
use shared::{Place, See, Shared};
use sieve::{Levels, Sieve, Sift};
use sure::{Proof, Prove, Sure};
use survey::{Ask, Survey, Take};

/// Above this share of cells that may match by the sieve, a survey, which proves more, is cheaper than testing them.
const SURVEY_SHARE: f64 = 0.08;

/// Above this share of cells that may match, one pass over the whole region is cheaper than many small areas.
const DENSE_SHARE: f64 = 0.7;

/// Areas of at least so many blocks and mask rows are worth a proof that they match altogether, before they are tested.
const PROOF_BLOCKS: u32 = 4;
const PROOF_ROWS: u32 = 32;

/// Blocks tested side by side: the running sums of so many stay in the first-level cache.
const STRIP_BLOCKS: u32 = 16;

/// From so many landmarks of one window on, a survey that they share is cheaper than a sieve for each.
const SHARED_BY: usize = 3;

/// From so many on, one by whole windows pays.
const SHARED_BY_MANY: usize = 16;

/// Finds masks; keeps its memory from one to the next.
#[derive(Default)]
pub struct Masker {
    lanes: Lanes,
    accepted: Vec<Acceptance>,
    averages: Vec<[Bounds<u8>; 3]>,
    levels: Vec<Levels>,
    sieve: Sieve,
    survey: Survey,
    /// What several landmarks share, grid by grid.
    shared: Vec<Shared>,
    /// For each number of a landmark where it has its share: in which of those, and there.
    places: Vec<Option<(usize, Place)>>,
    cells: Cells,
    /// Where windows may match.
    areas: Vec<Area>,
    doubts: Vec<u8>,
    doubted: Cells,
    doubted_areas: Vec<Area>,
    refuter: Refuter,
    sure: Sure,
    /// Where only the exact test tells.
    undecided: Vec<Area>,
    narrow: Scratch<Narrow>,
    medium: Scratch<Medium>,
    wide: Scratch<Wide>,
}

impl Masker {
    /// One that uses these instructions, for comparing them.
    #[must_use]
    pub fn with_lanes(lanes: Lanes) -> Self {
        Self { lanes, ..Self::default() }
    }

    /// Makes `mask` the mask of `landmark` on `grid`. The stage of the statistics finds out where windows may match at
    /// all, that of the mask tests those exactly.
    ///
    /// # Panics
    /// When the grid's region does not lie inside the frame.
    pub fn find<P: StageProbe>(
        &mut self,
        frame: &Frame,
        grid: &DoubledGrid,
        landmark: &Landmark,
        mask: &mut BitMask,
        probe: &mut P,
    ) {
        self.find_by(None, frame, grid, landmark, mask, probe);
    }

    /// Looks over `frame` once for each grid that several landmarks are looked for on. Each landmark comes with a number, by
    /// which [`find_shared`](Self::find_shared) knows it until the next call.
    pub(crate) fn share<'l>(
        &mut self,
        frame: &Frame,
        sought: &(impl Iterator<Item = (usize, DoubledGrid, &'l Landmark)> + Clone),
    ) {
        self.shared.iter_mut().for_each(Shared::forget);
        self.places.clear();
        let mut taken = 0;
        for (_, grid, _) in sought.clone() {
            let alike = || sought.clone().filter(|(_, other, _)| *other == grid);
            let seen = self.shared[..taken].iter().any(|shared| shared.mesh_of(&grid).is_some());
            let Some(mesh) = (!seen).then(|| shared_mesh(&grid, alike().count())).flatten() else { continue };
            if taken == self.shared.len() {
                self.shared.push(Shared::default());
            }
            self.shared[taken].begin(grid, mesh);
            for (number, _, landmark) in alike() {
                self.accept(&grid, landmark);
                self.places.resize(self.places.len().max(number + 1), None);
                self.places[number] = self.shared[taken].add(&self.accepted).map(|place| (taken, place));
            }
            self.lanes.run(See { shared: &mut self.shared[taken], frame });
            taken += 1;
        }
    }

    /// As [`find`](Self::find), for the landmark that [`share`](Self::share) had by that number for this frame and grid.
    pub(crate) fn find_shared<P: StageProbe>(
        &mut self,
        number: usize,
        frame: &Frame,
        grid: &DoubledGrid,
        landmark: &Landmark,
        mask: &mut BitMask,
        probe: &mut P,
    ) {
        let place = self.places.get(number).copied().flatten();
        self.find_by(place, frame, grid, landmark, mask, probe);
    }

    fn find_by<P: StageProbe>(
        &mut self,
        place: Option<(usize, Place)>,
        frame: &Frame,
        grid: &DoubledGrid,
        landmark: &Landmark,
        mask: &mut BitMask,
        probe: &mut P,
    ) {
        probe.begin(Stage::Statistics);
        mask.reset(grid.mask_width(), grid.mask_height());
        self.areas.clear();
        self.undecided.clear();
        if place.is_none_or(|(shared, place)| self.shared[shared].may_match(place)) {
            self.accept(grid, landmark);
            self.find_areas(place, frame, grid);
        }
        probe.end(Stage::Statistics);
        probe.begin(Stage::Mask);
        self.test_areas(frame, grid, mask);
        probe.end(Stage::Mask);
    }

    fn accept(&mut self, grid: &DoubledGrid, landmark: &Landmark) {
        let accepted = |shade| Acceptance::new(shade, &landmark.tolerance, grid.samples());
        self.accepted.clear();
        self.accepted.extend(landmark.shades.iter().filter_map(accepted));
    }

    /// Where windows may match.
    fn find_areas(&mut self, place: Option<(usize, Place)>, frame: &Frame, grid: &DoubledGrid) {
        if self.accepted.is_empty() {
            return;
        }
        if let Some(mesh) = self.look(place, frame, grid)
            && self.cells.alive_share() <= DENSE_SHARE
        {
            let rows = |row| mesh.mask_rows(row, grid.mask_height());
            self.cells.take_areas(rows, 0, &mut self.areas);
            return;
        }
        let blocks = grid.region().width.div_ceil(BLOCK_PX);
        self.areas.push(Area { rows: 0..grid.mask_height(), blocks: 0..blocks });
    }

    /// Sets the cells that may match, by a shared survey, by the sieve, or by a survey where the sieve leaves much;
    /// `None` for windows too small for any of them.
    fn look(&mut self, place: Option<(usize, Place)>, frame: &Frame, grid: &DoubledGrid) -> Option<Mesh> {
        if let Some((shared, place)) = place {
            let mesh = self.shared[shared].mesh_of(grid)?;
            self.shared[shared].tell(place, &mut self.cells);
            self.refute(frame, grid, mesh, Some(shared));
            return Some(mesh);
        }
        let mesh = Mesh::of_single_rows(grid.window())?;
        self.average(mesh, grid);
        self.levels.clear();
        self.levels.extend(self.averages.iter().copied().map(Levels::new));
        let Self { sieve, levels, cells, .. } = self;
        self.lanes.run(Sift { sieve, frame, grid, mesh, levels, cells });
        if self.cells.alive_share() <= SURVEY_SHARE {
            return Some(mesh);
        }
        let mesh = Mesh::of_sub_blocks(grid.window())?;
        self.lanes.run(Take { survey: &mut self.survey, frame, grid, mesh });
        self.average(mesh, grid);
        self.lanes.run(Ask { survey: &mut self.survey, shades: &self.averages, cells: &mut self.cells });
        self.refute(frame, grid, mesh, None);
        Some(mesh)
    }

    /// Takes the cells from those that may match whose colours look as if they did not, and adds to the undecided areas
    /// what is not refuted of them.
    fn refute(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, shared: Option<usize>) {
        let [accepted] = self.accepted.as_slice() else { return };
        if self.cells.all_dead() {
            return;
        }
        let ranges = shared.map_or(self.survey.ranges(), |at| self.shared[at].ranges());
        let numbers = ranges.doubt(&accepted.means(grid.samples()), &self.cells, &mut self.doubts);
        for doubt in Doubt::ALL.into_iter().filter(|doubt| numbers & 1 << doubt.number() != 0) {
            let Some(refutation) = Refutation::new(doubt, accepted, grid) else { continue };
            self.doubted.take_from(&mut self.cells, &self.doubts, doubt.number());
            let rows = |row| mesh.mask_rows(row, grid.mask_height());
            self.doubted.take_areas(rows, 0, &mut self.doubted_areas);
            let question = Question { frame, grid, accepted: &self.accepted };
            for area in self.doubted_areas.drain(..) {
                for area in area.strips(STRIP_BLOCKS) {
                    let (refuter, rest) = (&mut self.refuter, &mut self.undecided);
                    self.lanes.run(Refute { question, refutation, area, refuter, rest });
                }
            }
        }
    }

    /// Averages of sub-blocks that may belong to matching windows, for each shade that has any.
    fn average(&mut self, mesh: Mesh, grid: &DoubledGrid) {
        self.averages.clear();
        let averages = |accepted| mesh.averages(accepted, grid.samples());
        self.averages.extend(self.accepted.iter().filter_map(averages));
    }

    fn test_areas(&mut self, frame: &Frame, grid: &DoubledGrid, mask: &mut BitMask) {
        if self.areas.is_empty() && self.undecided.is_empty() {
            return;
        }
        self.prove_areas(frame, grid, mask);
        self.undecided.append(&mut self.areas);
        let (lanes, areas) = (self.lanes, &self.undecided);
        let question = Question { frame, grid, accepted: &self.accepted };
        if grid.samples() <= NARROW_SAMPLES {
            test(lanes, question, areas, &mut self.narrow, mask);
        } else if grid.samples() <= MEDIUM_SAMPLES {
            test(lanes, question, areas, &mut self.medium, mask);
        } else {
            test(lanes, question, areas, &mut self.wide, mask);
        }
    }

    /// Takes from the large areas what is proven to match.
    fn prove_areas(&mut self, frame: &Frame, grid: &DoubledGrid, mask: &mut BitMask) {
        let [accepted] = self.accepted.as_slice() else { return };
        let Some(proof) = Proof::new(accepted, grid) else { return };
        let question = Question { frame, grid, accepted: &self.accepted };
        for area in self.areas.drain(..) {
            if (area.blocks.len() as u32) < PROOF_BLOCKS || (area.rows.len() as u32) < PROOF_ROWS {
                self.undecided.push(area);
                continue;
            }
            for area in area.strips(STRIP_BLOCKS) {
                let (sure, rest) = (&mut self.sure, &mut self.undecided);
                self.lanes.run(Prove { question, proof, area, sure, mask: &mut *mask, rest });
            }
        }
    }
}

/// How so many landmarks share a survey, if they do.
fn shared_mesh(grid: &DoubledGrid, sharing: usize) -> Option<Mesh> {
    let of_windows = || Mesh::of_windows(grid.window()).filter(|mesh| sums::fit(*mesh));
    match sharing {
        ..SHARED_BY => None,
        SHARED_BY..SHARED_BY_MANY => Mesh::of_sub_blocks(grid.window()),
        SHARED_BY_MANY.. => of_windows().or_else(|| Mesh::of_sub_blocks(grid.window())),
    }
}

fn test<P: Precision>(
    lanes: Lanes,
    question: Question<'_>,
    areas: &[Area],
    scratch: &mut Scratch<P>,
    mask: &mut BitMask,
) {
    for area in areas.iter().flat_map(|area| area.strips(STRIP_BLOCKS)) {
        lanes.run(Test { question, area, scratch: &mut *scratch, mask: &mut *mask });
    }
}

#[cfg(test)]
mod tests;
