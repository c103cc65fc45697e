//! Proof, for most of the frame, that no window there can match, from one row of pixels in several.
//!
//! Let a window of n samples have mean μ and variance σ², and let k of its samples have mean μₖ. The variance between
//! those k and the rest is part of σ², so (μₖ − μ)² ≤ σ² (n − k)/k. A window that matches has μ and σ² inside known
//! bounds; hence a sub-block whose mean lies outside bounds that are wider by √(σ²ₘₐₓ (n − k)/k) proves that no window
//! around it matches.
//!
//! Every window of height h covers s = ⌊(h − 1)/2⌋ pixel rows in full, wherever it starts, so one row of every s lies
//! in it; likewise along x for a short run of pixels. The sub-block is that run in that row. Its mean is taken by
//! rounding byte averages of pairs, pairs of pairs … : never too small, and too large by at most 1/2 for each halving.

use std::ops::Range;

use crate::doubled_grid::DoubledGrid;
use crate::frame::Frame;
use crate::landmark::WindowPx;
use crate::statistics::Acceptance;

use super::chunk::fit;
use super::exact::{Area, BLOCK_PX};

/// Bytes of a block's pixels.
const BLOCK_BYTES: usize = 3 * BLOCK_PX as usize;

/// Halvings that give the longest run of pixels: 2³.
const MOST_HALVINGS: u32 = 3;

/// The run of pixels and the step of rows for one window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Mesh {
    halvings: u32,
    row_step: u32,
}

impl Mesh {
    /// `None` for windows so small that they may cover no pixel in full.
    pub(super) fn new(window: WindowPx) -> Option<Self> {
        let run = DoubledGrid::whole_pixels(window.width);
        let row_step = DoubledGrid::whole_pixels(window.height);
        (run > 0 && row_step > 0).then(|| Self { halvings: run.ilog2().min(MOST_HALVINGS), row_step })
    }

    /// Samples of a sub-block, k: each of its pixels is four.
    fn samples(self) -> u32 {
        4 << self.halvings
    }

    /// The band of mask rows that pixel row `band * row_step` decides on.
    fn mask_rows(self, band: u32, mask_height: u32) -> Range<u32> {
        let last = band * self.row_step;
        let first = (last + 1).saturating_sub(self.row_step);
        let rows = DoubledGrid::starts_with_first_whole_pixel(first..last + 1);
        rows.start.min(mask_height)..rows.end.min(mask_height)
    }

    /// Number of bands.
    fn bands(self, region_height: u32) -> u32 {
        region_height.div_ceil(self.row_step)
    }
}

/// Byte averages of a sub-block that may belong to a matching window, repeated for the pixels of a block.
#[derive(Clone, Debug)]
pub(super) struct Levels {
    low: [u8; BLOCK_BYTES],
    reach: [u8; BLOCK_BYTES],
}

impl Levels {
    /// `None` where no sub-block can belong to one.
    pub(super) fn new(accepted: &Acceptance, samples: u32, mesh: Mesh) -> Option<Self> {
        let (n, k) = (f64::from(samples), f64::from(mesh.samples()));
        let mut levels = Self { low: [0; BLOCK_BYTES], reach: [0; BLOCK_BYTES] };
        for channel in 0..3 {
            let largest_variance = accepted.spread[channel].high as f64 / (n * n);
            let wider = (largest_variance * (n - k).max(0.0) / k).sqrt() + ROUNDING;
            let low = (f64::from(accepted.sum[channel].low) / n - wider).ceil().max(0.0);
            let averaging = f64::from(mesh.halvings) / 2.0;
            let high = (f64::from(accepted.sum[channel].high) / n + wider + averaging).floor().min(255.0);
            if low > high {
                return None;
            }
            for at in (channel..BLOCK_BYTES).step_by(3) {
                (levels.low[at], levels.reach[at]) = (low as u8, (high - low) as u8);
            }
        }
        Some(levels)
    }
}

/// More than all rounding in the few operations above.
const ROUNDING: f64 = 1e-6;

/// 1 for the bytes that begin a pixel.
const PIXEL_STARTS: [u8; BLOCK_BYTES] = {
    let mut starts = [0; BLOCK_BYTES];
    let mut at = 0;
    while at < BLOCK_BYTES {
        starts[at] = 1;
        at += 3;
    }
    starts
};

/// Memory of the sieve.
#[derive(Clone, Debug, Default)]
pub(super) struct Sieve {
    averages: Vec<u8>,
    next_averages: Vec<u8>,
    inside: Vec<u8>,
    /// For each band and block, whether a window there may match: 1 or 0.
    alive: Vec<u8>,
    blocks: usize,
}

impl Sieve {
    /// Looks at one row of each band.
    #[inline(always)]
    pub(super) fn sift(&mut self, frame: &Frame, grid: &DoubledGrid, mesh: Mesh, levels: &[Levels]) {
        let region = grid.region();
        let bands = mesh.bands(region.height);
        self.blocks = region.width.div_ceil(BLOCK_PX) as usize;
        let padded = BLOCK_BYTES * (self.blocks + 1);
        fit(&mut self.averages, padded);
        fit(&mut self.next_averages, padded);
        fit(&mut self.inside, padded);
        self.alive.clear();
        for band in 0..bands {
            let start = 3 * region.x as usize;
            let row = &frame.row(region.y + band * mesh.row_step)[start..start + 3 * region.width as usize];
            self.average(row, mesh.halvings);
            let first = self.alive.len();
            self.alive.resize(first + self.blocks, 0);
            for levels in levels {
                compare(&self.averages[..padded], levels, &mut self.inside);
                for (block, alive) in self.alive[first..].iter_mut().enumerate() {
                    *alive |= any_pixel(&self.inside[BLOCK_BYTES * block..][..BLOCK_BYTES + 3]);
                }
            }
        }
    }

    /// The rounded averages of runs of 2^`halvings` pixels from each byte on. Those beyond the row mean nothing; no window
    /// of the region begins there.
    #[inline(always)]
    fn average(&mut self, row: &[u8], halvings: u32) {
        self.averages[..row.len()].copy_from_slice(row);
        for halving in 0..halvings {
            let ahead = 3 << halving;
            let pairs = self.averages.iter().zip(&self.averages[ahead..]);
            for (next, (&left, &right)) in self.next_averages.iter_mut().zip(pairs) {
                *next = ((u16::from(left) + u16::from(right) + 1) >> 1) as u8;
            }
            std::mem::swap(&mut self.averages, &mut self.next_averages);
        }
    }

    /// The part of all blocks that may match, 0..1.
    pub(super) fn alive_share(&self) -> f64 {
        let alive: u64 = self.alive.iter().map(|&alive| u64::from(alive)).sum();
        alive as f64 / self.alive.len().max(1) as f64
    }

    /// What is left to test, neighbouring blocks together; a run of blocks that lives on in the bands below is one area.
    pub(super) fn areas(&mut self, mesh: Mesh, mask_height: u32, areas: &mut Vec<Area>) {
        areas.clear();
        let bands = self.alive.len() / self.blocks.max(1);
        for band in 0..bands {
            let mut block = 0;
            while let Some(blocks) = self.next_run(band, block) {
                block = blocks.end;
                let mut rows = mesh.mask_rows(band as u32, mask_height);
                let mut below = band + 1;
                while below < bands && self.next_run(below, blocks.start) == Some(blocks.clone()) {
                    self.alive[below * self.blocks..][blocks.clone()].fill(0);
                    rows.end = mesh.mask_rows(below as u32, mask_height).end;
                    below += 1;
                }
                if !rows.is_empty() {
                    areas.push(Area { rows, blocks: blocks.start as u32..blocks.end as u32 });
                }
            }
        }
    }

    /// The first run of living blocks of a band from block `from` on.
    fn next_run(&self, band: usize, from: usize) -> Option<Range<usize>> {
        let row = &self.alive[band * self.blocks..][..self.blocks];
        let start = from + row[from..].iter().position(|&alive| alive != 0)?;
        let length = row[start..].iter().position(|&alive| alive == 0).unwrap_or(row.len() - start);
        Some(start..start + length)
    }
}

/// 1 for every byte average within the bounds.
#[inline(always)]
fn compare(averages: &[u8], levels: &Levels, inside: &mut [u8]) {
    let blocks = averages.as_chunks::<BLOCK_BYTES>().0.iter().zip(inside.as_chunks_mut::<BLOCK_BYTES>().0);
    for (averages, inside) in blocks {
        for at in 0..BLOCK_BYTES {
            inside[at] = u8::from(averages[at].wrapping_sub(levels.low[at]) <= levels.reach[at]);
        }
    }
}

/// 1 where some pixel of a block, or the first one after it, is inside in all three channels; else 0. (Windows that start
/// on the second sample of the block's last pixel cover the next one first.)
#[inline(always)]
fn any_pixel(inside: &[u8]) -> u8 {
    let mut any = 0;
    for at in 0..BLOCK_BYTES {
        any |= inside[at] & inside[at + 1] & inside[at + 2] & PIXEL_STARTS[at];
    }
    any | inside[BLOCK_BYTES] & inside[BLOCK_BYTES + 1] & inside[BLOCK_BYTES + 2]
}
