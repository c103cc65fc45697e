//! The thesis's synthetic pictures, from its descriptions.

use vision::methods::Plane;
use vision::{Frame, RectPx, SizePx};

use super::ExperimentError;

/// Colour of the thesis's synthetic red block (Table 4.1).
pub(super) const RED: [u8; 3] = [219, 60, 54];
const GREEN: [u8; 3] = [40, 150, 70];
const BLUE: [u8; 3] = [51, 60, 160];
const WHITE: [u8; 3] = [255; 3];

/// The picture of Figures 3.1 and 4.2: a red block of 6×6 pixels at the lower left, a red line of its colour, a green
/// block and a blue rectangle on white.
pub(super) struct Synthetic {
    pub(super) frame: Frame,
    /// The red block.
    pub(super) block: RectPx,
    /// The larger ones.
    pub(super) others: [RectPx; 2],
}

/// That picture.
pub(super) fn synthetic() -> Result<Synthetic, ExperimentError> {
    let block = RectPx { x: 18, y: 96, width: 6, height: 6 };
    let line = RectPx { x: 126, y: 14, width: 2, height: 92 };
    let others =
        [RectPx { x: 28, y: 18, width: 34, height: 34 }, RectPx { x: 74, y: 62, width: 40, height: 24 }];
    let mut canvas = Canvas::new(SizePx { width: 160, height: 120 }, WHITE);
    for (rect, colour) in [(block, RED), (line, RED), (others[0], GREEN), (others[1], BLUE)] {
        canvas.fill(rect, colour);
    }
    Ok(Synthetic { frame: canvas.frame()?, block, others })
}

/// Three overlapping shades of rectangles on white, after Figures 2.2 and 2.5.
pub(super) fn rectangles() -> Result<(Frame, [RectPx; 3]), ExperimentError> {
    let rects = [
        RectPx { x: 14, y: 16, width: 60, height: 36 },
        RectPx { x: 92, y: 24, width: 44, height: 66 },
        RectPx { x: 26, y: 70, width: 48, height: 34 },
    ];
    let mut canvas = Canvas::new(SizePx { width: 160, height: 120 }, WHITE);
    for (rect, colour) in rects.into_iter().zip([[60; 3], [110; 3], [20; 3]]) {
        canvas.fill(rect, colour);
    }
    Ok((canvas.frame()?, rects))
}

/// Dark letters on light grey, after Figure 2.1: E, F, H, I, L, T, whose strokes are rectangles.
pub(super) fn letters() -> Plane {
    const STROKES: [&[[u32; 4]]; 6] = [
        &[[0, 0, 6, 40], [0, 0, 24, 6], [0, 17, 20, 6], [0, 34, 24, 6]],
        &[[0, 0, 6, 40], [0, 0, 24, 6], [0, 17, 20, 6]],
        &[[0, 0, 6, 40], [18, 0, 6, 40], [0, 17, 24, 6]],
        &[[9, 0, 6, 40]],
        &[[0, 0, 6, 40], [0, 34, 24, 6]],
        &[[0, 0, 24, 6], [9, 0, 6, 40]],
    ];
    let is_ink = |x: u32, y: u32| {
        STROKES.iter().zip(0..).any(|(strokes, number)| {
            let (left, top) = (14 + 48 * (number % 3), 14 + 56 * (number / 3));
            strokes.iter().any(|[dx, dy, width, height]| {
                (left + dx..left + dx + width).contains(&x) && (top + dy..top + dy + height).contains(&y)
            })
        })
    };
    Plane::from_fn(SizePx { width: 160, height: 120 }, |x, y| if is_ink(x, y) { 50.0 } else { 200.0 })
}

/// Pixels that rectangles are painted on.
pub(super) struct Canvas {
    size: SizePx,
    rgb: Vec<u8>,
}

impl Canvas {
    pub(super) fn new(size: SizePx, colour: [u8; 3]) -> Self {
        Self { size, rgb: colour.repeat((size.width * size.height) as usize) }
    }

    pub(super) fn fill(&mut self, rect: RectPx, colour: [u8; 3]) {
        let RectPx { x, y, width, height } = rect.clipped_to(self.size).unwrap_or_default();
        for row in y..y + height {
            for column in x..x + width {
                let at = 3 * (row * self.size.width + column) as usize;
                self.rgb[at..at + 3].copy_from_slice(&colour);
            }
        }
    }

    pub(super) fn frame(self) -> Result<Frame, ExperimentError> {
        Ok(Frame::from_rgb(self.size.width, self.size.height, self.rgb)?)
    }
}
