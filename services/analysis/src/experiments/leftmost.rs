//! Which component the thesis took: its Appendices B and C show that it was the leftmost one, as MATLAB's labelling of
//! columns from the left gives when the first label is taken.

use vision::doubled_grid::DoubledGrid;
use vision::mask::Masker;
use vision::measure::bwarea;
use vision::{BitMask, Components, Frame, Landmark, NoProbe, PointPx, RectPx};

use crate::score::Claim;

/// Finds the leftmost component; keeps its memory from frame to frame.
#[derive(Default)]
pub(super) struct Leftmost {
    masker: Masker,
    mask: BitMask,
    components: Components,
}

impl Leftmost {
    /// The leftmost component of the landmark's mask, its area that of the mask in frame pixels.
    pub(super) fn find(&mut self, frame: &Frame, landmark: &Landmark) -> Option<Claim> {
        let grid = DoubledGrid::new(RectPx::whole(frame.size()), landmark.window_px)?;
        self.masker.find(frame, &grid, landmark, &mut self.mask, &mut NoProbe);
        self.components.find(&self.mask);
        let first =
            self.components.list().iter().min_by_key(|component| (component.x_start, component.y_start))?;
        let (x, y) = first.mean_pixel();
        let centre: PointPx = grid.frame_from_mask(x, y);
        let area_px2 =
            DoubledGrid::area_px2_from_samples(bwarea(&self.mask, self.components.runs(first))) as f32;
        Some(Claim { centre, area_px2, score: 1.0 })
    }

    /// Pieces in the last mask.
    pub(super) fn pieces(&self) -> usize {
        self.components.list().len()
    }
}
