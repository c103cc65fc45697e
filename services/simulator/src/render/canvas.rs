//! The picture while it is being drawn.

use vision::{Frame, SizePx};

use super::coverage::Region;

/// Interleaved 8-bit RGB pixels, rows from the top.
#[derive(Debug)]
pub(crate) struct Canvas {
    size: SizePx,
    rgb: Vec<u8>,
}

impl From<Frame> for Canvas {
    fn from(frame: Frame) -> Self {
        Self { size: frame.size(), rgb: frame.rgb().to_vec() }
    }
}

impl Canvas {
    pub(crate) fn new(size: SizePx) -> Self {
        Self { size, rgb: vec![0; 3 * size.width as usize * size.height as usize] }
    }

    pub(crate) fn size(&self) -> SizePx {
        self.size
    }

    fn stride(&self) -> usize {
        3 * self.size.width as usize
    }

    pub(crate) fn rows_mut(&mut self) -> impl Iterator<Item = &mut [u8]> {
        let stride = self.stride();
        self.rgb.chunks_exact_mut(stride)
    }

    /// The rows of a region, each cut to its columns.
    pub(crate) fn region_rows_mut(&mut self, region: &Region) -> impl Iterator<Item = &mut [[u8; 3]]> {
        let columns = region.columns.clone();
        let rows = region.rows.clone();
        self.rows_mut()
            .skip(rows.start)
            .take(rows.len())
            .map(move |row| &mut row.as_chunks_mut().0[columns.clone()])
    }

    /// The finished picture.
    pub(crate) fn into_frame(self) -> Frame {
        let SizePx { width, height } = self.size;
        Frame::from_rgb(width, height, self.rgb).expect("a canvas holds exactly its pixels")
    }

    pub(crate) fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    pub(crate) fn rgb_mut(&mut self) -> &mut [u8] {
        &mut self.rgb
    }
}
