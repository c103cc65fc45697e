//! Numbers on the pixels of a rectangle, and their sums over boxes.

use crate::adaptive::memory::{List, Memory};

/// Rows of the grid on which boxes are looked for first.
const GRID_ROWS: usize = 28;

/// Columns `left..right` and rows `top..bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Area {
    pub(super) left: i32,
    pub(super) top: i32,
    pub(super) right: i32,
    pub(super) bottom: i32,
}

impl Area {
    pub(super) fn width(self) -> i32 {
        self.right - self.left
    }

    pub(super) fn height(self) -> i32 {
        self.bottom - self.top
    }

    pub(super) fn pixels(self) -> f32 {
        (self.width() * self.height()) as f32
    }

    /// The part of it in a picture of that size; of no width or height where there is none.
    pub(super) fn clipped(self, width: i32, height: i32) -> Self {
        let (left, top) = (self.left.clamp(0, width), self.top.clamp(0, height));
        Self { left, top, right: self.right.clamp(left, width), bottom: self.bottom.clamp(top, height) }
    }

    /// Its pixels, row by row.
    pub(super) fn places(self) -> impl Iterator<Item = (i32, i32)> {
        (self.top..self.bottom).flat_map(move |y| (self.left..self.right).map(move |x| (x, y)))
    }

    /// The same with each side moved by `by`, one after the other.
    pub(super) fn with_sides_moved(self, by: i32) -> [Self; 4] {
        [
            Self { left: self.left + by, ..self },
            Self { right: self.right + by, ..self },
            Self { top: self.top + by, ..self },
            Self { bottom: self.bottom + by, ..self },
        ]
    }
}

/// Numbers row by row, and for each corner of a pixel the sum of all above and left of it.
pub(super) struct Field<'s> {
    width: usize,
    height: usize,
    values: List<'s, f32>,
    sums: &'s [f64],
}

impl<'s> Field<'s> {
    pub(super) fn new(width: usize, values: List<'s, f32>) -> Self {
        let height = values.len() / width.max(1);
        let stride = width + 1;
        let sums = values.bump().alloc_slice_fill_copy(stride * (height + 1), 0.0_f64);
        for (y, row) in values.chunks_exact(width.max(1)).enumerate() {
            let mut total = 0.0_f64;
            for (x, value) in row.iter().enumerate() {
                total += f64::from(*value);
                sums[(y + 1) * stride + x + 1] = sums[y * stride + x + 1] + total;
            }
        }
        Self { width, height, values, sums }
    }

    pub(super) fn get(&self, x: i32, y: i32) -> f32 {
        self.values[y as usize * self.width + x as usize]
    }

    /// Where it lies.
    pub(super) fn memory(&self) -> &'s Memory {
        self.values.bump()
    }

    pub(super) fn height(&self) -> i32 {
        self.height as i32
    }

    /// The sum over a box; what lies outside counts as 0.
    pub(super) fn sum(&self, area: Area) -> f32 {
        let Area { left, top, right, bottom } = area.clipped(self.width as i32, self.height as i32);
        let at = |x: i32, y: i32| self.sums[y as usize * (self.width + 1) + x as usize];
        (at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top)) as f32
    }

    /// The box over which the numbers, each less `threshold`, have the greatest sum, and that sum. On a grid every pair of
    /// rows is tried with the best run of columns between them (Bentley 1984, who names Kadane); then the sides move by
    /// pixels. `None` where no sum is greater than 0.
    pub(super) fn fullest_box(&self, threshold: f32) -> Option<(Area, f32)> {
        let step = self.height.div_ceil(GRID_ROWS).max(1);
        let mut best = self.fullest_on_grid(threshold, step)?;
        let sum = |area: Area| self.sum(area) - threshold * area.pixels();
        let mut most = sum(best);
        loop {
            let (before, base, reach) = (most, best, step as i32);
            for area in (-reach..=reach).flat_map(|by| base.with_sides_moved(by)) {
                let is_box = area.left < area.right && area.top < area.bottom;
                let inside = area.clipped(self.width as i32, self.height as i32) == area;
                if is_box && inside && sum(area) > most + 1e-4 {
                    (best, most) = (area, sum(area));
                }
            }
            if most <= before {
                return Some((best, most));
            }
        }
    }

    fn fullest_on_grid(&self, threshold: f32, step: usize) -> Option<Area> {
        let (columns, rows) = (self.width.div_ceil(step), self.height.div_ceil(step));
        let cells = self.memory().alloc_slice_fill_copy(columns * rows, 0.0_f32);
        for (y, row) in self.values.chunks_exact(self.width).enumerate() {
            for (x, value) in row.iter().enumerate() {
                cells[y / step * columns + x / step] += value - threshold;
            }
        }
        let edge = |at: usize, limit: usize| (at * step).min(limit) as i32;
        let (mut best, mut most) = (None, 0.0);
        let sums = self.memory().alloc_slice_fill_copy(columns, 0.0_f32);
        for top in 0..rows {
            sums.fill(0.0);
            for (bottom, row) in cells.chunks_exact(columns).enumerate().skip(top) {
                sums.iter_mut().zip(row).for_each(|(total, cell)| *total += cell);
                let (sum, left, right) = best_run(sums);
                if sum > most {
                    let (left, right) = (edge(left, self.width), edge(right, self.width));
                    let (top, bottom) = (edge(top, self.height), edge(bottom + 1, self.height));
                    (best, most) = (Some(Area { left, top, right, bottom }), sum);
                }
            }
        }
        best
    }
}

/// The run of columns of the greatest sum: that sum, the first and the end. An empty one where no number is above 0.
fn best_run(values: &[f32]) -> (f32, usize, usize) {
    let mut best = (0.0, 0, 0);
    let (mut sum, mut start) = (0.0_f32, 0);
    for (x, value) in values.iter().enumerate() {
        if sum <= 0.0 {
            (sum, start) = (0.0, x);
        }
        sum += value;
        if sum > best.0 {
            best = (sum, start, x + 1);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptive::memory::CollectIn;
    use proptest::prelude::*;

    fn boxes(width: i32, height: i32) -> impl Iterator<Item = Area> {
        let sides =
            |length: i32| (0..length).flat_map(move |from| (from + 1..=length).map(move |to| (from, to)));
        sides(width).flat_map(move |(left, right)| {
            sides(height).map(move |(top, bottom)| Area { left, top, right, bottom })
        })
    }

    proptest! {
        #[test]
        fn on_a_grid_of_single_pixels_no_box_holds_more(
            width in 1_usize..10, values in proptest::collection::vec(-8_i8..8, 10..100),
        ) {
            let rows = (values.len() / width).min(GRID_ROWS);
            let values: Vec<f32> = values.into_iter().take(rows * width).map(f32::from).collect();
            let slowly = |area: Area| area.places().map(|(x, y)| values[y as usize * width + x as usize]).sum::<f32>();
            let most = boxes(width as i32, rows as i32).map(slowly).fold(0.0, f32::max);
            let memory = Memory::new();
            let field = Field::new(width, values.iter().copied().collect_in(&memory));
            let found = field.fullest_box(0.0);
            prop_assert_eq!(found.map_or(0.0, |(_, sum)| sum), most);
            prop_assert_eq!(found.map_or(0.0, |(area, _)| slowly(area)), most);
        }
    }

    #[test]
    fn a_large_box_is_found_to_the_pixel() {
        let inside = Area { left: 31, top: 17, right: 95, bottom: 54 };
        let is_inside = |x: i32, y: i32| inside.places().any(|place| place == (x, y));
        let values = (0..90).flat_map(|y| (0..130).map(move |x| (x, y)));
        let memory = Memory::new();
        let values = values.map(|(x, y)| if is_inside(x, y) { 1.0 } else { 0.0 }).collect_in(&memory);
        assert_eq!(Field::new(130, values).fullest_box(0.6).unwrap().0, inside);
    }
}
