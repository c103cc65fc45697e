//! The window whose six statistics stand for an object.

use super::candidate::Search;
use super::choose::variance_excess;
use super::memory::Memory;
use super::patch::Patch;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::ColorStats;

/// The largest window, samples of the doubled grid.
const LARGEST_WINDOW_2X: i32 = 48;

/// Whole numbers up to this one are all numbers of 32 bits.
const MOST_EXACT: f32 = (1 << f32::MANTISSA_DIGITS) as f32;

/// A window on an object.
struct Window {
    side_px: i32,
    stats: ColorStats,
    /// How far its means are off, and its variances, in tolerances beyond what is allowed.
    off: (f32, f32),
}

/// The window on the object that is nearest to the descriptor, and its statistics. Its side follows the object's, and
/// is halved where nothing that large shows one of the shades: the landmark's colour may be but a frame around lettering.
pub(super) fn best(search: &Search<'_>, object: &Patch<'_>, area_px2: f32) -> Option<(u16, ColorStats)> {
    let mut side_px = ((0.42 * area_px2.sqrt()) as i32).clamp(1, LARGEST_WINDOW_2X / 2);
    let least_px = (i32::from(search.landmark.window_px.width) / 4).max(2);
    let mut best = window_of_side(search, object, side_px);
    while best.as_ref().is_none_or(|best| best.off.0 > 1.0 || best.off.1 > 0.0) && side_px / 2 >= least_px {
        side_px /= 2;
        let smaller = window_of_side(search, object, side_px);
        best = [best, smaller].into_iter().flatten().min_by(|a, b| a.cost().total_cmp(&b.cost()));
    }
    best.map(|best| (2 * best.side_px as u16, best.stats))
}

/// The best window of that side.
fn window_of_side(search: &Search<'_>, object: &Patch<'_>, side_px: i32) -> Option<Window> {
    let step = (side_px / 2).max(1);
    let mut best: Option<(f32, (i32, i32))> = None;
    let bounds = object.bounds()?;
    let mut sums = Sums::new(search.frame, bounds, side_px as usize, object.memory());
    let (left, top) = ((bounds.x - object.rect.x) as i32, (bounds.y - object.rect.y) as i32);
    let last = side_px - 1;
    for y in (top..top + bounds.height as i32).step_by(step as usize) {
        sums.reach((y - top) as usize + side_px as usize);
        for x in (left..left + bounds.width as i32).step_by(step as usize) {
            let corners = [(0, 0), (last, 0), (0, last), (last, last)];
            if !corners.iter().all(|(u, v)| object.get(x + u, y + v)) {
                continue;
            }
            let window = Square { x: (x - left) as usize, y: (y - top) as usize, side: side_px as usize };
            let mean = sums.mean(window);
            let cost =
                search.likeness.nearest(mean).excess + 0.01 * sums.red_variance(window, mean[0]).sqrt();
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, (x, y)));
            }
        }
    }
    best.map(|(_, place)| {
        let first = (object.rect.x + place.0 as u32, object.rect.y + place.1 as u32);
        let stats = window_stats(search.frame, first, side_px as u32);
        let off = (search.likeness.nearest(stats.mean).excess, variance_excess(search, &stats));
        Window { side_px, stats, off }
    })
}

/// A window, counted from the corner of the object's bounds.
#[derive(Clone, Copy)]
struct Square {
    x: usize,
    y: usize,
    side: usize,
}

/// Sums over stretches of as many rows as a window has, by which windows that overlap cost what one costs.
struct Sums<'a> {
    frame: &'a Frame,
    bounds: RectPx,
    /// For each column's left end the sum of R, G, B and R² of the pixels before it; row r in place r modulo the rows.
    before: &'a mut [[u32; 4]],
    rows: usize,
    /// The row after the last one that was read.
    end: usize,
}

impl<'a> Sums<'a> {
    /// For windows of so many rows in these bounds.
    fn new(frame: &'a Frame, bounds: RectPx, rows: usize, memory: &'a Memory) -> Self {
        let before = memory.alloc_slice_fill_copy((bounds.width as usize + 1) * rows, [0; 4]);
        Self { frame, bounds, before, rows, end: 0 }
    }

    /// Goes on to the windows above row `end` of the bounds.
    fn reach(&mut self, end: usize) {
        for row in self.end..end.min(self.bounds.height as usize) {
            let columns = self.bounds.width as usize + 1;
            let before = &mut self.before[row % self.rows * columns..][..columns];
            let pixels = &self.frame.row(self.bounds.y + row as u32)[3 * self.bounds.x as usize..];
            let mut sum = [0; 4];
            for (before, pixel) in before[1..].iter_mut().zip(pixels.as_chunks::<3>().0) {
                let [r, g, b] = pixel.map(u32::from);
                sum = added(sum, [r, g, b, r * r]);
                *before = sum;
            }
        }
        self.end = self.end.max(end);
    }

    /// The sums over one row of a window.
    fn of_row(&self, Square { x, y, side }: Square, row: usize) -> [u32; 4] {
        let before = &self.before[(y + row) % self.rows * (self.bounds.width as usize + 1) + x..];
        let (start, end) = (before[0], before[side]);
        std::array::from_fn(|at| end[at] - start[at])
    }

    fn mean(&self, window: Square) -> [f32; 3] {
        let sums = (0..window.side).fold([0; 4], |sums, row| added(sums, self.of_row(window, row)));
        let pixels = (window.side * window.side) as f32;
        std::array::from_fn(|c| sums[c] as f32 / pixels)
    }

    /// Population variance of R, whose mean is that; to the last bit what [`window_stats`] says.
    fn red_variance(&self, window: Square, mean: f32) -> f32 {
        let Square { x, y, side } = window;
        let mut squares = 0.0_f32;
        for row in 0..side {
            // Up to there sums of whole numbers are exact, in whatever order.
            let whole = squares + self.of_row(window, row)[3] as f32;
            if whole < MOST_EXACT {
                squares = whole;
                continue;
            }
            let pixels = self.frame.row(self.bounds.y + (y + row) as u32);
            let pixels = &pixels[3 * (self.bounds.x as usize + x)..][..3 * side];
            for [red, ..] in pixels.as_chunks::<3>().0 {
                squares += f32::from(*red) * f32::from(*red);
            }
        }
        (squares / (side * side) as f32 - mean * mean).max(0.0)
    }
}

fn added(a: [u32; 4], b: [u32; 4]) -> [u32; 4] {
    std::array::from_fn(|at| a[at] + b[at])
}

impl Window {
    fn cost(&self) -> f32 {
        self.off.0 + self.off.1
    }
}

/// Mean and population variance of a window whose first pixel of the frame is that.
fn window_stats(frame: &Frame, (x, y): (u32, u32), side: u32) -> ColorStats {
    let (mut sum, mut squares) = ([0.0_f32; 3], [0.0_f32; 3]);
    for pixel in (y..y + side).flat_map(|v| (x..x + side).map(move |u| frame.pixel(u, v))) {
        for (c, level) in pixel.map(f32::from).into_iter().enumerate() {
            sum[c] += level;
            squares[c] += level * level;
        }
    }
    let pixels = (side * side) as f32;
    let mean = sum.map(|sum| sum / pixels);
    let variance = std::array::from_fn(|c| (squares[c] / pixels - mean[c] * mean[c]).max(0.0));
    ColorStats { mean, variance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn windows_by_sums_are_to_the_last_bit_those_by_pixels(
            darkest in prop_oneof![Just(0u8), 180u8..], side in 1usize..25, seed: u32,
        ) {
            let noise = |at: u32| (at.wrapping_mul(2_654_435_761) ^ seed).wrapping_mul(0x85EB_CA77) >> 13;
            let level = |at: u32| darkest + (noise(at) % (256 - u32::from(darkest))) as u8;
            let frame = Frame::from_rgb(40, 36, (0..3 * 40 * 36).map(level).collect()).unwrap();
            let (memory, bounds) = (Memory::new(), RectPx { x: 4, y: 3, width: 33, height: 31 });
            let mut sums = Sums::new(&frame, bounds, side, &memory);
            for (x, y) in [(0, 0), (3, 1.min(31 - side)), (33 - side, 31 - side)] {
                let x = x.min(33 - side);
                sums.reach(y + side);
                let window = Square { x, y, side };
                let stats = window_stats(&frame, (4 + x as u32, 3 + y as u32), side as u32);
                prop_assert_eq!(sums.mean(window), stats.mean);
                prop_assert_eq!(sums.red_variance(window, stats.mean[0]), stats.variance[0]);
            }
        }
    }
}
