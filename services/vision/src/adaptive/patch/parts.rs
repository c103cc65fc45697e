//! Connected parts and holes of a patch, by runs.

use std::ops::Range;

use super::Patch;
use crate::adaptive::memory::{CollectIn, List};
use crate::bitmask::Run;

/// 4-connected sets of runs.
struct Sets<'m> {
    runs: List<'m, Run>,
    /// Union-find: a root is its own parent.
    parent: List<'m, u32>,
}

impl<'m> Sets<'m> {
    fn of(patch: &Patch<'m>) -> Self {
        let runs = patch.runs();
        let mut sets = Self { parent: (0..runs.len() as u32).collect_in(patch.memory), runs };
        let mut above: Range<usize> = 0..0;
        let mut at = 0;
        while at < sets.runs.len() {
            let y = sets.runs[at].y;
            let end = at + sets.runs[at..].iter().take_while(|run| run.y == y).count();
            if above.start < above.end && sets.runs[above.start].y + 1 == y {
                sets.join(above, at..end);
            }
            above = at..end;
            at = end;
        }
        sets
    }

    fn join(&mut self, above: Range<usize>, row: Range<usize>) {
        let mut first = above.start;
        for run in row {
            let Run { x_start, x_end, .. } = self.runs[run];
            while first < above.end && self.runs[first].x_end <= x_start {
                first += 1;
            }
            for other in first..above.end {
                if self.runs[other].x_start >= x_end {
                    break;
                }
                let (a, b) = (self.root(run), self.root(other));
                self.parent[a.max(b)] = a.min(b) as u32;
            }
        }
    }

    fn root(&self, run: usize) -> usize {
        let mut at = run;
        while self.parent[at] as usize != at {
            at = self.parent[at] as usize;
        }
        at
    }
}

impl Patch<'_> {
    /// The 4-connected part that overlaps `seed` most, with every other whose overlap is at least `least` of that.
    pub(crate) fn parts_overlapping(&self, seed: &Patch<'_>, least: f32) -> Option<Self> {
        let sets = Sets::of(self);
        let overlap = self.memory.alloc_slice_fill_copy(sets.runs.len(), 0_u32);
        for (at, run) in sets.runs.iter().enumerate() {
            overlap[sets.root(at)] += seed.count_in(run);
        }
        let most = overlap.iter().copied().max().filter(|&most| most > 0)?;
        // Of several with the same overlap the first stands for all when only one is wanted.
        let first = overlap.iter().position(|&o| o == most)?;
        let mut union = Self::empty(self.memory, self.rect);
        for (at, run) in sets.runs.iter().enumerate() {
            let root = sets.root(at);
            if root == first || (least < 1.0 && overlap[root] as f32 >= least * most as f32) {
                union.set_run(run.y, run.x_start, run.x_end);
            }
        }
        Some(union)
    }

    fn count_in(&self, run: &Run) -> u32 {
        let spans = (run.x_start..run.x_end).step_by(64);
        spans
            .map(|x| {
                let columns = (run.x_end - x).min(64);
                (self.bits_from(x as i32, run.y as i32) & (u64::MAX >> (64 - columns))).count_ones()
            })
            .sum()
    }

    /// With its holes filled: unset pixels that are not 4-connected with the patch's edge.
    pub(crate) fn filled(&self) -> Self {
        let outside = Sets::of(&self.inverted());
        let open = self.memory.alloc_slice_fill_copy(outside.runs.len(), false);
        for (at, run) in outside.runs.iter().enumerate() {
            let (last_x, last_y) = (self.rect.width, self.rect.height - 1);
            if run.x_start == 0 || run.x_end == last_x || run.y == 0 || run.y == last_y {
                open[outside.root(at)] = true;
            }
        }
        let mut filled = self.copy();
        for (at, run) in outside.runs.iter().enumerate() {
            if !open[outside.root(at)] {
                filled.set_run(run.y, run.x_start, run.x_end);
            }
        }
        filled
    }
}
