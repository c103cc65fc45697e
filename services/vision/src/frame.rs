//! A decoded picture.

pub mod decode;
pub mod encode;

use std::fmt;

use crate::geometry::SizePx;

/// A picture of 8-bit RGB pixels, interleaved, row after row without padding: `rgb[3 * (y * width + x) + channel]`.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Frame {
    size: SizePx,
    rgb: Vec<u8>,
}

/// Why bytes do not make a [`Frame`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{got} bytes do not make a picture of {width}×{height} RGB pixels, which needs {want}")]
pub struct SizeMismatch {
    width: u32,
    height: u32,
    got: usize,
    want: u64,
}

impl Frame {
    /// A frame of these pixels.
    ///
    /// # Errors
    /// When `rgb` is not exactly `3 * width * height` bytes long.
    pub fn from_rgb(width: u32, height: u32, rgb: Vec<u8>) -> Result<Self, SizeMismatch> {
        let want = 3 * u64::from(width) * u64::from(height);
        if rgb.len() as u64 != want {
            return Err(SizeMismatch { width, height, got: rgb.len(), want });
        }
        Ok(Self { size: SizePx { width, height }, rgb })
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

    /// All pixels, interleaved, rows from the top.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// All pixels, for drawing.
    pub fn rgb_mut(&mut self) -> &mut [u8] {
        &mut self.rgb
    }

    /// One row: `3 * width` bytes.
    ///
    /// # Panics
    /// When `y` is not below the height.
    #[must_use]
    pub fn row(&self, y: u32) -> &[u8] {
        let stride = 3 * self.size.width as usize;
        &self.rgb[y as usize * stride..][..stride]
    }

    /// R, G and B of one pixel.
    ///
    /// # Panics
    /// When the pixel lies outside the frame.
    #[must_use]
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        let at = 3 * x as usize;
        let row = self.row(y);
        [row[at], row[at + 1], row[at + 2]]
    }

    /// The pixel storage, to be used again for the next frame.
    #[must_use]
    pub fn into_rgb(self) -> Vec<u8> {
        self.rgb
    }
}

impl fmt::Debug for Frame {
    /// The size only: a megabyte of levels helps nobody.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Frame({}×{})", self.size.width, self.size.height)
    }
}
