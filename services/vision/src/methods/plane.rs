//! A picture of one number a pixel.

use crate::frame::Frame;
use crate::geometry::{RectPx, SizePx};

/// A picture of one real number a pixel, row after row: `values[y * width + x]`. Levels stay levels: 0..255.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plane {
    size: SizePx,
    values: Vec<f32>,
}

/// How the three levels of a pixel become one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Intensity {
    /// Luma of ITU-R BT.601, rounded to a whole level as cameras and OpenCV do: .299 R + .587 G + .114 B.
    #[default]
    Luma,
    /// The magnitude √(R² + G² + B²) of thesis eq. 2.4, 0..441.7.
    Magnitude,
    /// The first channel.
    Red,
    /// The second channel.
    Green,
    /// The third channel.
    Blue,
}

/// Two pictures that must be of one size are not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the pictures are {}×{} and {}×{} pixels; both must have the same size",
    left.width, left.height, right.width, right.height
)]
pub struct SizesDiffer {
    /// Size of the first picture.
    pub left: SizePx,
    /// Size of the second.
    pub right: SizePx,
}

/// Why numbers do not make a [`Plane`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{got} values do not make a plane of {width}×{height} pixels, which needs {want}")]
pub struct ValueCount {
    width: u32,
    height: u32,
    got: usize,
    want: u64,
}

impl Intensity {
    /// The number of a pixel.
    #[inline]
    #[must_use]
    pub fn of(self, [red, green, blue]: [u8; 3]) -> f32 {
        match self {
            Self::Luma => f32::from(luma([red, green, blue])),
            Self::Magnitude => {
                [red, green, blue].into_iter().map(|level| f32::from(level).powi(2)).sum::<f32>().sqrt()
            }
            Self::Red => f32::from(red),
            Self::Green => f32::from(green),
            Self::Blue => f32::from(blue),
        }
    }
}

/// Luma in whole levels; the weights are BT.601's in 15 binary places, as OpenCV has them, and add up to one.
#[inline(always)]
#[must_use]
pub fn luma([red, green, blue]: [u8; 3]) -> u8 {
    ((9798 * u32::from(red) + 19_235 * u32::from(green) + 3735 * u32::from(blue) + (1 << 14)) >> 15) as u8
}

impl Plane {
    /// A plane of these values.
    ///
    /// # Errors
    /// When there are not exactly `width * height` of them.
    pub fn new(width: u32, height: u32, values: Vec<f32>) -> Result<Self, ValueCount> {
        let want = u64::from(width) * u64::from(height);
        if values.len() as u64 != want {
            return Err(ValueCount { width, height, got: values.len(), want });
        }
        Ok(Self { size: SizePx { width, height }, values })
    }

    /// A plane of zeros.
    #[must_use]
    pub fn zeros(size: SizePx) -> Self {
        Self { size, values: vec![0.0; size.width as usize * size.height as usize] }
    }

    /// The value of each pixel (x, y), by its number.
    #[must_use]
    pub fn from_fn(size: SizePx, mut value: impl FnMut(u32, u32) -> f32) -> Self {
        let mut plane = Self::zeros(size);
        for y in 0..size.height {
            for (value_at, x) in plane.row_mut(y).iter_mut().zip(0..) {
                *value_at = value(x, y);
            }
        }
        plane
    }

    /// A frame as one number a pixel (thesis eq. 2.4 is [`Intensity::Magnitude`]).
    #[must_use]
    pub fn of(frame: &Frame, intensity: Intensity) -> Self {
        let mut plane = Self::default();
        plane.set(frame, RectPx::whole(frame.size()), intensity);
        plane
    }

    /// Makes this the part of `frame` under `region`, clipped to the frame, in the memory that is here.
    pub fn set(&mut self, frame: &Frame, region: RectPx, intensity: Intensity) {
        let region = region.clipped_to(frame.size()).unwrap_or_default();
        self.size = SizePx { width: region.width, height: region.height };
        self.values.clear();
        for y in region.y..region.y + region.height {
            let pixels = &frame.row(y)[3 * region.x as usize..][..3 * region.width as usize];
            self.values.extend(pixels.as_chunks::<3>().0.iter().map(|&pixel| intensity.of(pixel)));
        }
    }

    /// The part under `region`, clipped to the plane.
    #[must_use]
    pub fn cropped(&self, region: RectPx) -> Self {
        let RectPx { x, y, width, height } = region.clipped_to(self.size).unwrap_or_default();
        Self::from_fn(SizePx { width, height }, |column, row| self.get(x + column, y + row))
    }

    /// Makes this a plane of zeros of that size, in the memory that is here.
    pub fn reset(&mut self, size: SizePx) {
        self.size = size;
        self.values.clear();
        self.values.resize(size.width as usize * size.height as usize, 0.0);
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> SizePx {
        self.size
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.size.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.size.height
    }

    /// Whether it has no pixel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// All values, rows from the top.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// All values, to be changed.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }

    /// One row.
    ///
    /// # Panics
    /// When `y` is not below the height.
    #[must_use]
    pub fn row(&self, y: u32) -> &[f32] {
        &self.values[y as usize * self.size.width as usize..][..self.size.width as usize]
    }

    /// One row, to be changed.
    ///
    /// # Panics
    /// When `y` is not below the height.
    pub fn row_mut(&mut self, y: u32) -> &mut [f32] {
        &mut self.values[y as usize * self.size.width as usize..][..self.size.width as usize]
    }

    /// The value of one pixel.
    ///
    /// # Panics
    /// When it lies outside.
    #[inline]
    #[must_use]
    pub fn get(&self, x: u32, y: u32) -> f32 {
        self.row(y)[x as usize]
    }

    /// The largest value and its pixel, the first one where there are several; `None` where there is none. NaN is passed over.
    #[must_use]
    pub fn maximum(&self) -> Option<(u32, u32, f32)> {
        // Sixteen maxima side by side; a comparison with NaN is false.
        let mut most = [f32::NEG_INFINITY; 16];
        let (pieces, rest) = self.values.as_chunks::<16>();
        for values in pieces {
            for (most, &value) in most.iter_mut().zip(values) {
                *most = if value > *most { value } else { *most };
            }
        }
        let most = most.iter().chain(rest).copied().fold(f32::NEG_INFINITY, f32::max);
        let at = self.values.iter().position(|&value| value == most)?;
        let width = self.size.width as usize;
        Some(((at % width) as u32, (at / width) as u32, most))
    }

    /// [`SizesDiffer`] unless `other` has the same size.
    ///
    /// # Errors
    /// When it has not.
    pub fn same_size(&self, other: &Self) -> Result<SizePx, SizesDiffer> {
        if self.size == other.size {
            Ok(self.size)
        } else {
            Err(SizesDiffer { left: self.size, right: other.size })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intensities_of_a_pixel() {
        assert_eq!(Intensity::Magnitude.of([2, 3, 6]), 7.0);
        assert_eq!(Intensity::Luma.of([255, 255, 255]), 255.0);
        // .299 · 200 + .587 · 100 + .114 · 50 = 124.2
        assert_eq!(Intensity::Luma.of([200, 100, 50]), 124.0);
        assert_eq!(
            [Intensity::Red, Intensity::Green, Intensity::Blue].map(|i| i.of([1, 2, 3])),
            [1.0, 2.0, 3.0]
        );
    }

    #[test]
    fn a_wrong_count_of_values_is_refused() {
        let error = Plane::new(2, 3, vec![0.0; 5]).unwrap_err();
        assert_eq!(error.to_string(), "5 values do not make a plane of 2×3 pixels, which needs 6");
        assert!(Plane::new(0, 7, Vec::new()).unwrap().is_empty());
    }

    #[test]
    fn the_maximum_is_the_first_and_never_nan() {
        let plane = Plane::new(3, 2, vec![f32::NAN, 1.0, 4.0, 4.0, f32::NAN, 0.0]).unwrap();
        assert_eq!(plane.maximum(), Some((2, 0, 4.0)));
        assert_eq!(Plane::default().maximum(), None);
    }

    #[test]
    fn a_crop_is_clipped() {
        let plane = Plane::from_fn(SizePx { width: 4, height: 3 }, |x, y| (10 * y + x) as f32);
        let part = plane.cropped(RectPx { x: 2, y: 1, width: 9, height: 9 });
        assert_eq!(part.values(), [12.0, 13.0, 22.0, 23.0]);
        assert!(plane.cropped(RectPx { x: 7, y: 0, width: 1, height: 1 }).is_empty());
    }
}
