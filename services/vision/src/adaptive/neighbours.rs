//! Mean colours around pixels, of the object there and of the background there.

use std::ops::Range;

use super::memory::{List, Memory};
use super::patch::Patch;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::mask::{Lanes, Work};

/// How far a neighbour may be, px.
const REACH: usize = 4;
const SPAN: usize = 2 * REACH + 1;

/// What a neighbour at a distance of (dx, dy) weighs: near ones tell more of the light on a pixel than far ones.
const NEARNESS: [[f32; SPAN]; SPAN] = {
    let mut nearness = [[0.0; SPAN]; SPAN];
    let mut at = 0;
    while at < SPAN * SPAN {
        let (dx, dy) = ((at % SPAN) as i32 - REACH as i32, (at / SPAN) as i32 - REACH as i32);
        nearness[at / SPAN][at % SPAN] = 1.0 / (1 + dx * dx + dy * dy) as f32;
        at += 1;
    }
    nearness
};

/// Of the object and of the background: red, green and blue, levels, and how much they count.
type Sides = [f32; 8];
/// Rows of pixels whose neighbours lie in memory at a time.
const BAND_ROWS: i32 = 64;
/// Pixels side by side whose neighbours are added up together.
const BLOCK_PX: usize = 4;
/// Those of a block, one after the other.
type Block = [f32; 8 * BLOCK_PX];

/// Mean colours of the object and of the background around a pixel, where there are any.
#[derive(Clone, Copy)]
pub(super) struct Around {
    pub(super) own: Option<[f32; 3]>,
    pub(super) other: Option<[f32; 3]>,
}

/// What lies around each of `pixels`, in the order of their places: the object shows purely in `inside`, and the background
/// in `background`.
pub(super) fn around<'s>(
    frame: &Frame,
    pixels: &Patch<'s>,
    inside: &Patch<'_>,
    background: &Patch<'_>,
) -> List<'s, Around> {
    let memory = pixels.memory();
    let mut found = List::with_capacity_in(pixels.count(), memory);
    let Some(bounds) = pixels.bounds() else { return found };
    let near = pixels.dilated(REACH as i32);
    let (inside, background) = (inside.within(&near), background.within(&near));
    let mut halo = Halo::new(memory, bounds, pixels.rect);
    let top = (bounds.y - pixels.rect.y) as i32;
    let bottom = top + bounds.height as i32;
    for first in (top..bottom).step_by(BAND_ROWS as usize) {
        let rows = first..bottom.min(first + BAND_ROWS);
        halo.clear(first);
        halo.add(frame, &inside, &rows, 0);
        halo.add(frame, &background, &rows, 4);
        Lanes::default().run(Sums { halo: &halo, pixels, rows, found: &mut found });
    }
    found
}

/// Colours of pure pixels in a band of rows and as far around as neighbours may be; all others are 0 and do not count.
struct Halo<'s> {
    colours: &'s mut [Sides],
    columns: usize,
    /// The patch's place of the first, less than 0 where that lies outside.
    left: i32,
    top: i32,
}

impl<'s> Halo<'s> {
    /// For pixels within `bounds`, of a patch that covers `rect`.
    fn new(memory: &'s Memory, bounds: RectPx, rect: RectPx) -> Self {
        // The last block of a row may reach beyond its last pixel.
        let columns = bounds.width as usize + 2 * REACH + BLOCK_PX - 1;
        let rows = bounds.height.min(BAND_ROWS as u32) as usize + 2 * REACH;
        // Zeros one by one, which is quicker than eight by eight.
        let zeros = memory.alloc_slice_fill_copy(8 * columns * rows, 0.0);
        let left = (bounds.x - rect.x) as i32 - REACH as i32;
        Self { colours: zeros.as_chunks_mut().0, columns, left, top: i32::MIN }
    }

    /// Begins with the neighbours of the pixels from row `first` of the patch on.
    fn clear(&mut self, first: i32) {
        if self.top != i32::MIN {
            self.colours.as_flattened_mut().fill(0.0);
        }
        self.top = first - REACH as i32;
    }

    /// Adds the colours of `pure` around these rows as those of one side.
    fn add(&mut self, frame: &Frame, pure: &Patch<'_>, rows: &Range<i32>, side: usize) {
        let rect = pure.rect;
        let rows = (rows.start - REACH as i32).max(0)..(rows.end + REACH as i32).min(pure.height());
        pure.each_run_of(rows.start as u32..rows.end as u32, |run| {
            let row = &frame.row(rect.y + run.y)[3 * (rect.x + run.x_start) as usize..];
            let start = self.place(run.x_start as i32, run.y as i32);
            let colours = &mut self.colours[start..start + run.length() as usize];
            for (color, &[r, g, b]) in colours.iter_mut().zip(row.as_chunks::<3>().0) {
                color[side..side + 4].copy_from_slice(&[f32::from(r), f32::from(g), f32::from(b), 1.0]);
            }
        });
    }

    fn place(&self, x: i32, y: i32) -> usize {
        (y - self.top) as usize * self.columns + (x - self.left) as usize
    }

    /// The weighted sums around the pixels of a block, which begins at a place of the patch.
    #[inline(always)]
    fn sums(&self, x: i32, y: i32) -> Block {
        let first = self.place(x, y) - REACH * self.columns - REACH;
        let mut sums = [0.0; 8 * BLOCK_PX];
        for (dy, nearness) in NEARNESS.iter().enumerate() {
            let row = &self.colours[first + dy * self.columns..][..SPAN + BLOCK_PX - 1];
            let levels: &[f32; 8 * (SPAN + BLOCK_PX - 1)] =
                row.as_flattened().first_chunk().expect("that many");
            sums = with_row(sums, nearness, levels);
        }
        sums
    }
}

/// The sums with one more row of neighbours; each number is added to in the same order.
#[inline(always)]
fn with_row(mut sums: Block, nearness: &[f32; SPAN], levels: &[f32; 8 * (SPAN + BLOCK_PX - 1)]) -> Block {
    // The inner loop is short and unrolled, the outer one is what becomes vectors.
    for at in 0..8 * BLOCK_PX {
        let mut sum = sums[at];
        for dx in 0..SPAN {
            sum += nearness[dx] * levels[8 * dx + at];
        }
        sums[at] = sum;
    }
    sums
}

/// Adds up what lies around each of the pixels.
struct Sums<'a, 's> {
    halo: &'a Halo<'s>,
    pixels: &'a Patch<'s>,
    rows: Range<i32>,
    found: &'a mut List<'s, Around>,
}

impl Work for Sums<'_, '_> {
    #[inline(always)]
    fn run(self) {
        for y in self.rows {
            for word in 0..self.pixels.words_in_row() {
                let mut bits = self.pixels.word(y, word);
                while bits != 0 {
                    let first = bits.trailing_zeros();
                    let sums = self.halo.sums((64 * word) as i32 + first as i32, y);
                    for at in 0..BLOCK_PX {
                        if bits >> first >> at & 1 == 1 {
                            self.found.push(Around::of(&sums, 8 * at));
                        }
                    }
                    bits &= !(((1 << BLOCK_PX) - 1) << first);
                }
            }
        }
    }
}

impl Around {
    #[inline(always)]
    fn of(sums: &Block, at: usize) -> Self {
        let mean = |at: usize| {
            let count = sums[at + 3];
            (count > 0.0).then(|| [sums[at] / count, sums[at + 1] / count, sums[at + 2] / count])
        };
        Self { own: mean(at), other: mean(at + 4) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The obvious way, neighbour by neighbour.
    fn slowly(frame: &Frame, pure: &Patch<'_>, (x, y): (i32, i32)) -> Option<[f32; 3]> {
        let (mut sum, mut n) = ([0.0_f32; 3], 0.0_f32);
        for (row, v) in (y - REACH as i32..).take(SPAN).enumerate() {
            for (column, u) in (x - REACH as i32..).take(SPAN).enumerate().filter(|(_, u)| pure.get(*u, v)) {
                let pixel = frame.pixel(pure.rect.x + u as u32, pure.rect.y + v as u32);
                let nearness = NEARNESS[row][column];
                sum.iter_mut().zip(pixel).for_each(|(sum, level)| *sum += nearness * f32::from(level));
                n += nearness;
            }
        }
        (n > 0.0).then(|| sum.map(|sum| sum / n))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn means_are_to_the_last_bit_those_of_the_obvious_way(
            (width, height) in prop_oneof![(1u32..140, 1u32..12), (1u32..12, 1u32..140)],
            kinds in prop::collection::vec(0u8..6, 1680), seed: u32,
        ) {
            let noise = |at: u32| (at.wrapping_mul(2_654_435_761) ^ seed).wrapping_mul(0x85EB_CA77) as u8;
            let rgb = (0..3 * (width + 5) * (height + 4)).map(noise).collect();
            let frame = Frame::from_rgb(width + 5, height + 4, rgb).unwrap();
            let (memory, rect) = (Memory::new(), RectPx { x: 3, y: 2, width, height });
            let of_kind = |kind: u8| {
                Patch::from_fn(&memory, rect, |x, y| kinds[(y * width as i32 + x) as usize] == kind)
            };
            let (pixels, inside, background) = (of_kind(0), of_kind(1), of_kind(2));
            let found = around(&frame, &pixels, &inside, &background);
            prop_assert_eq!(found.len(), pixels.count());
            for (around, place) in found.iter().zip(pixels.set_places()) {
                prop_assert_eq!(around.own, slowly(&frame, &inside, place));
                prop_assert_eq!(around.other, slowly(&frame, &background, place));
            }
        }
    }
}
