//! What a coarse look leaves to be tested: cells of one band by one block, alive or not.

use std::ops::Range;

use super::exact::Area;

/// A flag for each band and block.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// 1 where a window may match, else 0; band after band.
    alive: Vec<u8>,
    blocks: usize,
}

impl Cells {
    /// Makes this so many cells, all dead.
    #[inline(always)]
    pub(super) fn reset(&mut self, bands: usize, blocks: usize) {
        self.blocks = blocks;
        self.alive.clear();
        self.alive.resize(bands * blocks, 0);
    }

    /// All flags, to be set.
    #[inline(always)]
    pub(super) fn flags(&mut self) -> &mut [u8] {
        &mut self.alive
    }

    /// The flags of one band, to be set.
    #[inline(always)]
    pub(super) fn band(&mut self, band: usize) -> &mut [u8] {
        &mut self.alive[band * self.blocks..][..self.blocks]
    }

    /// Makes this the living cells of `others` that `numbers` has this number for, and these dead there.
    pub(super) fn take_from(&mut self, others: &mut Self, numbers: &[u8], number: u8) {
        self.reset(others.alive.len() / others.blocks.max(1), others.blocks);
        for ((mine, alive), &numbered) in self.alive.iter_mut().zip(&mut others.alive).zip(numbers) {
            *mine = *alive & u8::from(numbered == number);
            *alive ^= *mine;
        }
    }

    /// Whether all are dead.
    pub(super) fn all_dead(&self) -> bool {
        !any(&self.alive)
    }

    /// The part of all cells that is alive, 0..1.
    pub(super) fn alive_share(&self) -> f64 {
        let (eights, rest) = self.alive.as_chunks::<8>();
        let counted: u32 = eights.iter().map(|eight| u64::from_ne_bytes(*eight).count_ones()).sum();
        let alive = counted + rest.iter().map(|&alive| u32::from(alive)).sum::<u32>();
        f64::from(alive) / self.alive.len().max(1) as f64
    }

    /// Adds to `areas` what is left to test: neighbouring blocks together, and with what lives on below them while it
    /// fills half of their width. `mask_rows` are those of a band; blocks count from `first_block`. Leaves all cells dead.
    pub(super) fn take_areas(
        &mut self,
        mask_rows: impl Fn(u32) -> Range<u32>,
        first_block: u32,
        areas: &mut Vec<Area>,
    ) {
        let bands = self.alive.len() / self.blocks.max(1);
        for band in 0..bands {
            if !any(self.band(band)) {
                continue;
            }
            let mut from = 0;
            while let Some(blocks) = self.next_run(band, from) {
                from = blocks.end;
                let mut rows = mask_rows(band as u32);
                let mut below = band + 1;
                while below < bands && self.take_below(below, &blocks) {
                    rows.end = mask_rows(below as u32).end;
                    below += 1;
                }
                if !rows.is_empty() {
                    let blocks = first_block + blocks.start as u32..first_block + blocks.end as u32;
                    areas.push(Area { rows, blocks });
                }
            }
        }
    }

    /// Whether the first run of living cells of `band` that reaches into `blocks` can be tested together with them: then
    /// it is dead from now on.
    fn take_below(&mut self, band: usize, blocks: &Range<usize>) -> bool {
        let fits = |run: &Range<usize>| run.end <= blocks.end && 2 * run.len() >= blocks.len();
        let run = self.next_run(band, blocks.start).filter(fits);
        let begins_before = blocks.start > 0 && self.band(band)[blocks.start - 1] != 0;
        match run {
            Some(run) if !(begins_before && run.start == blocks.start) => {
                self.band(band)[run].fill(0);
                true
            }
            _ => false,
        }
    }

    /// The first run of living blocks of a band from block `from` on.
    pub(super) fn next_run(&self, band: usize, from: usize) -> Option<Range<usize>> {
        let row = &self.alive[band * self.blocks..][..self.blocks];
        let start = from + row[from..].iter().position(|&alive| alive != 0)?;
        let length = row[start..].iter().position(|&alive| alive == 0).unwrap_or(row.len() - start);
        Some(start..start + length)
    }
}

/// Whether any flag is set; by whole chunks, most bands are dead.
fn any(flags: &[u8]) -> bool {
    flags.iter().fold(0, |any, &alive| any | alive) != 0
}

#[cfg(test)]
mod tests {
    use super::super::mesh::Mesh;
    use super::*;
    use crate::landmark::WindowPx;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn areas_cover_every_living_cell(
            (blocks, alive) in (1usize..9).prop_flat_map(|blocks| {
                (Just(blocks), prop::collection::vec(prop::bool::weighted(0.4), blocks * 7))
            }),
        ) {
            let mesh = Mesh::of_single_rows(WindowPx::square(12)).unwrap();
            let mut cells = Cells::default();
            cells.reset(7, blocks);
            cells.flags().iter_mut().zip(&alive).for_each(|(flag, &alive)| *flag = u8::from(alive));
            let (mask_height, mut areas) = (60, Vec::new());
            prop_assert!((cells.alive_share() * alive.len() as f64).round() as usize
                == alive.iter().filter(|&&alive| alive).count());
            cells.take_areas(|band| mesh.mask_rows(band, mask_height), 0, &mut areas);
            for (cell, _) in alive.iter().enumerate().filter(|&(_, &alive)| alive) {
                let block = (cell % blocks) as u32;
                for row in mesh.mask_rows((cell / blocks) as u32, mask_height) {
                    prop_assert!(areas.iter().any(|area| area.rows.contains(&row) && area.blocks.contains(&block)));
                }
            }
        }
    }
}
