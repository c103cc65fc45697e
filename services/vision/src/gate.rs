//! The part of the frame where a measurement is looked for and believed (thesis 4.0.6).

use crate::geometry::{PointPx, RectPx, SizePx};
use crate::outcome::{Gate, Prediction};

/// Innovations within this many standard deviations are believed.
const INNOVATION_SIGMAS: f32 = 4.5;
/// The search reaches this many object sizes beyond the innovation gate.
const SEARCH_SIZES: f32 = 1.1;
/// No gate is wider than this many object sizes: beyond it the whole frame is searched instead.
const WIDEST_SIZES: f32 = 5.0;
/// The smallest radius, px.
const LEAST_RADIUS_PX: f32 = 3.0;

/// Where a measurement of the predicted object is believed.
#[must_use]
pub fn innovation_gate(prediction: &Prediction) -> Gate {
    let widest_px = (WIDEST_SIZES * prediction.area_px2.sqrt()).max(8.0);
    let radius_px = |variance: f32| (INNOVATION_SIGMAS * variance.sqrt()).clamp(LEAST_RADIUS_PX, widest_px);
    let [xx, _, yy] = prediction.covariance_px2;
    Gate { centre: prediction.centroid, radius_x_px: radius_px(xx), radius_y_px: radius_px(yy) }
}

/// Where the predicted object's pixels may lie: the innovation gate and the object's own extent around it.
#[must_use]
pub fn search_gate(prediction: &Prediction) -> Gate {
    let believed = innovation_gate(prediction);
    let extent_px = SEARCH_SIZES * prediction.area_px2.sqrt() + 4.0;
    Gate {
        radius_x_px: believed.radius_x_px + extent_px,
        radius_y_px: believed.radius_y_px + extent_px,
        ..believed
    }
}

impl Gate {
    /// Whether `point` lies inside or on the ellipse.
    #[must_use]
    pub fn contains(&self, point: PointPx) -> bool {
        let dx = (point.x - self.centre.x) / self.radius_x_px;
        let dy = (point.y - self.centre.y) / self.radius_y_px;
        dx * dx + dy * dy <= 1.0
    }

    /// The whole pixels around the ellipse that lie in a picture of that size; `None` when it lies outside.
    #[must_use]
    pub fn bounds(&self, size: SizePx) -> Option<RectPx> {
        let span = |centre: f32, radius: f32, limit: u32| {
            let start = (centre - radius).floor().clamp(0.0, limit as f32) as u32;
            let end = (centre + radius).ceil().clamp(0.0, limit as f32) as u32;
            (start < end).then_some((start, end - start))
        };
        let (x, width) = span(self.centre.x, self.radius_x_px, size.width)?;
        let (y, height) = span(self.centre.y, self.radius_y_px, size.height)?;
        Some(RectPx { x, y, width, height })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: SizePx = SizePx { width: 100, height: 80 };

    #[test]
    fn bounds_are_clipped_to_the_picture() {
        let gate = Gate { centre: PointPx::new(95.5, 10.0), radius_x_px: 10.0, radius_y_px: 4.0 };
        assert_eq!(gate.bounds(SIZE), Some(RectPx { x: 85, y: 6, width: 15, height: 8 }));
        assert!(gate.contains(PointPx::new(105.0, 10.0)));
        assert!(!gate.contains(PointPx::new(105.0, 13.9)));
    }

    #[test]
    fn a_gate_outside_the_picture_has_no_bounds() {
        let gate = Gate { centre: PointPx::new(-20.0, 10.0), radius_x_px: 10.0, radius_y_px: 4.0 };
        assert_eq!(gate.bounds(SIZE), None);
        let nowhere = Gate { centre: PointPx::new(f32::NAN, 10.0), ..gate };
        assert_eq!(nowhere.bounds(SIZE), None);
    }
}
