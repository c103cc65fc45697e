//! Optical flow by Horn and Schunck (thesis 2.8, eqs. 2.23–2.37).
//!
//! The brightness of what moves does not change (eq. 2.25), which leaves the flow along the gradient's normal open (the
//! aperture effect, eq. 2.27); the flow's smoothness (eq. 2.28) decides it. Beyond the edge the nearest pixel holds, for
//! brightness and for flow.

mod derivatives;
mod iterate;
mod lines;

use super::plane::{Plane, SizesDiffer};
use crate::geometry::RectPx;
use crate::mask::Lanes;

use derivatives::Derivatives;
use iterate::Rows;

/// How the flow is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HornSchunck {
    /// Weight of smoothness against constant brightness, in levels a pixel (eq. 2.35). It matters where the brightness
    /// gradient is weaker than this.
    pub alpha: f32,
    /// How often eqs. 2.36 and 2.37 are applied. Flow spreads one pixel with each.
    pub iterations: u32,
}

impl Default for HornSchunck {
    /// For 8-bit levels.
    fn default() -> Self {
        Self { alpha: 15.0, iterations: 100 }
    }
}

/// Where what is seen at each pixel moves to, in pixels per frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flow {
    /// To the right.
    pub u: Plane,
    /// Down.
    pub v: Plane,
}

/// The memory of one computation, to be used again for the next.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    lanes: Lanes,
    derivatives: Derivatives,
    rows: Rows,
}

impl HornSchunck {
    /// The flow from `first` to `second`.
    ///
    /// # Errors
    /// When they have different sizes.
    pub fn flow(&self, first: &Plane, second: &Plane) -> Result<Flow, SizesDiffer> {
        let mut flow = Flow::default();
        self.flow_into(first, second, &mut flow, &mut Memory::default())?;
        Ok(flow)
    }

    /// As [`flow`](Self::flow), in memory that is there.
    ///
    /// # Errors
    /// When the pictures have different sizes.
    pub fn flow_into(
        &self,
        first: &Plane,
        second: &Plane,
        flow: &mut Flow,
        memory: &mut Memory,
    ) -> Result<(), SizesDiffer> {
        let size = first.same_size(second)?;
        flow.u.reset(size);
        flow.v.reset(size);
        if size.width > 0 && size.height > 0 {
            memory.derivatives.estimate(first, second, self.alpha, memory.lanes);
            memory.rows.iterate(&memory.derivatives, self.iterations, flow, memory.lanes);
        }
        Ok(())
    }
}

impl Flow {
    /// The mean flow (to the right, down) over the part of `region` that lies inside; `None` where nothing does.
    #[must_use]
    pub fn mean_px(&self, region: RectPx) -> Option<(f32, f32)> {
        let region = region.clipped_to(self.u.size())?;
        let mean = |plane: &Plane| {
            let rows = (region.y..region.y + region.height)
                .flat_map(|y| &plane.row(y)[region.x as usize..][..region.width as usize]);
            let total: f64 = rows.map(|&value| f64::from(value)).sum();
            (total / f64::from(region.width) / f64::from(region.height)) as f32
        };
        Some((mean(&self.u), mean(&self.v)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::SizePx;
    use crate::methods::reference::any_plane;
    use proptest::prelude::*;

    const SIZE: SizePx = SizePx { width: 64, height: 64 };

    /// A soft blob, so that there is a gradient everywhere on it.
    fn blob(cx: f32, cy: f32) -> impl Fn(u32, u32) -> f32 {
        move |x, y| 200.0 * (-((x as f32 - cx).powi(2) + (y as f32 - cy).powi(2)) / 72.0).exp()
    }

    /// Fig 2.9: the block at the upper right moves diagonally down to the right, that at the lower right to the left.
    #[test]
    fn two_blocks_move_in_their_own_directions() {
        let block = |left: u32, top: u32, x: u32, y: u32| {
            (left..left + 16).contains(&x) && (top..top + 16).contains(&y)
        };
        let picture = |upper: (u32, u32), lower: (u32, u32)| {
            Plane::from_fn(SIZE, |x, y| {
                if block(upper.0, upper.1, x, y) || block(lower.0, lower.1, x, y) { 200.0 } else { 20.0 }
            })
        };
        let (first, second) = (picture((36, 8), (40, 40)), picture((37, 9), (39, 40)));
        let flow = HornSchunck::default().flow(&first, &second).unwrap();
        let (u, v) = flow.mean_px(RectPx { x: 36, y: 8, width: 17, height: 17 }).unwrap();
        assert!(u > 0.1 && v > 0.1, "down to the right, not ({u}, {v})");
        let (u, v) = flow.mean_px(RectPx { x: 39, y: 40, width: 17, height: 16 }).unwrap();
        assert!(u < -0.1 && v.abs() < 0.3 * u.abs(), "to the left, not ({u}, {v})");
    }

    /// Fig 2.7: the stripes of a barber's pole move to the right, and are seen to move across themselves: up as well.
    #[test]
    fn of_a_striped_pole_only_the_motion_across_the_stripes_is_seen() {
        let stripes = |turned: f32| {
            Plane::from_fn(SIZE, |x, y| 100.0 + 80.0 * ((x as f32 - turned - y as f32) / 5.0).sin())
        };
        let flow = HornSchunck { alpha: 5.0, iterations: 300 }.flow(&stripes(0.0), &stripes(1.0)).unwrap();
        let (u, v) = flow.mean_px(RectPx { x: 16, y: 16, width: 32, height: 32 }).unwrap();
        // One pixel to the right, of which ½ (1, −1) lies along the gradient (eq. 2.27).
        assert!((u - 0.5).abs() < 0.05 && (v + 0.5).abs() < 0.05, "({u}, {v})");
    }

    #[test]
    fn a_small_motion_is_measured_where_there_is_structure() {
        let (first, second) = (blob(30.0, 30.0), blob(30.5, 29.75));
        let (first, second) = (Plane::from_fn(SIZE, first), Plane::from_fn(SIZE, second));
        let flow = HornSchunck { alpha: 1.0, iterations: 2000 }.flow(&first, &second).unwrap();
        let (u, v) = flow.mean_px(RectPx { x: 24, y: 24, width: 12, height: 12 }).unwrap();
        assert!((u - 0.5).abs() < 0.05 && (v + 0.25).abs() < 0.05, "({u}, {v})");
    }

    #[test]
    fn means_are_those_inside() {
        let flow = Flow { u: Plane::from_fn(SIZE, |x, _| x as f32), v: Plane::zeros(SIZE) };
        assert_eq!(flow.mean_px(RectPx { x: 62, y: 0, width: 9, height: 1 }), Some((62.5, 0.0)));
        assert_eq!(flow.mean_px(RectPx { x: 64, y: 0, width: 9, height: 1 }), None);
    }

    proptest! {
        #[test]
        fn flow_of_any_two_pictures_is_finite(first in any_plane(12), alpha in 0f32..50.0, iterations in 0u32..20) {
            let second = Plane::from_fn(first.size(), |x, y| first.get(y % first.width(), y) + (x % 3) as f32);
            let flow = HornSchunck { alpha, iterations }.flow(&first, &second).unwrap();
            prop_assert_eq!(flow.u.size(), first.size());
            for value in flow.u.values().iter().chain(flow.v.values()) {
                prop_assert!(value.is_finite());
            }
            let odd = Plane::zeros(SizePx { width: first.width() + 1, height: first.height() });
            let refused = HornSchunck { alpha, iterations }.flow(&first, &odd).is_err();
            prop_assert!(refused);
        }
    }
}
