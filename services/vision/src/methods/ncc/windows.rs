//! Means and variances of the windows of a frame, as sums of whole numbers.

use crate::frame::Frame;
use crate::geometry::{RectPx, SizePx};
use crate::methods::plane::luma;

use super::Colours;

/// Σ(f − f̄)² of the windows of a region, row after row.
#[derive(Clone, Debug, Default)]
pub(super) struct WindowSums {
    colours: Colours,
    region: RectPx,
    window: SizePx,
    /// For each channel and column the sums of level and squared level under the window.
    columns: Vec<[Vec<u64>; 2]>,
    variances: Vec<f64>,
}

impl WindowSums {
    /// Prepares for windows of that size, which must fit the region.
    pub(super) fn begin(&mut self, frame: &Frame, region: RectPx, window: SizePx, colours: Colours) {
        (self.colours, self.region, self.window) = (colours, region, window);
        self.columns.clear();
        self.columns.resize_with(colours.channels(), || [0, 1].map(|_| vec![0; region.width as usize]));
        for row in 0..window.height {
            self.add(frame, row, 1);
        }
    }

    /// Σ(f − f̄)², over all channels, of the windows whose first row is `y`; rows must come in order, from 0.
    pub(super) fn row(&mut self, frame: &Frame, y: u32) -> &[f64] {
        if y > 0 {
            self.add(frame, y - 1, -1);
            self.add(frame, y + self.window.height - 1, 1);
        }
        let width = self.window.width as usize;
        let samples = f64::from(self.window.width) * f64::from(self.window.height);
        self.variances.clear();
        self.variances.resize(self.region.width as usize + 1 - width, 0.0);
        for [levels, squares] in &self.columns {
            let (mut sum, mut square): (u64, u64) =
                (levels[..width].iter().sum(), squares[..width].iter().sum());
            for (x, variance) in self.variances.iter_mut().enumerate() {
                if x > 0 {
                    sum = sum + levels[x + width - 1] - levels[x - 1];
                    square = square + squares[x + width - 1] - squares[x - 1];
                }
                *variance += square as f64 - sum as f64 * (sum as f64 / samples);
            }
        }
        &self.variances
    }

    /// Adds a row of the region to the columns, or takes it away (−1).
    fn add(&mut self, frame: &Frame, row: u32, count: i64) {
        let pixels = &frame.row(self.region.y + row)[3 * self.region.x as usize..];
        for (channel, [levels, squares]) in self.columns.iter_mut().enumerate() {
            for ((sum, square), pixel) in levels.iter_mut().zip(squares).zip(pixels.as_chunks::<3>().0) {
                let level = match self.colours {
                    Colours::Grey => luma(*pixel),
                    Colours::Rgb => pixel[channel],
                };
                *sum = sum.wrapping_add_signed(count * i64::from(level));
                *square = square.wrapping_add_signed(count * i64::from(level) * i64::from(level));
            }
        }
    }
}
