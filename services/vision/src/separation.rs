//! How well a landmark stands out from the rest of a picture: what a person wants to know who has just learned it.

use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::Landmark;
use crate::nearest::nearest_match;
use crate::outcome::NearestMatch;

/// What a descriptor makes of the object it was learned from, and of everything else in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// The window of the object that matches best; `None` where the object is smaller than the window.
    pub inside: Option<NearestMatch>,
    /// The window outside the object that comes nearest to a match; `None` where no window lies outside.
    pub outside: Option<NearestMatch>,
}

impl Separation {
    /// How many tolerances the rest of the picture is off at its nearest: above 1 nothing else matches, and the larger
    /// the better. Infinite where there is nothing else.
    #[must_use]
    pub fn excess(&self) -> f32 {
        self.outside.map_or(f32::INFINITY, |nearest| nearest.excess)
    }
}

/// Compares every window of `frame` that lies wholly inside or wholly outside `object` with `landmark`. Takes some
/// 100 ms for a frame of 640×480.
#[must_use]
pub fn separation(frame: &Frame, landmark: &Landmark, object: RectPx) -> Separation {
    let best = |regions: &[RectPx]| {
        let nearest = regions.iter().filter_map(|&region| nearest_match(frame, landmark, Some(region)));
        nearest.min_by(|one, other| one.excess.total_cmp(&other.excess))
    };
    Separation { inside: best(&[object]), outside: best(&around(frame, object)) }
}

/// Regions of which each window outside `object` lies in at least one: two boxes that do not meet are parted by a
/// horizontal or a vertical line.
fn around(frame: &Frame, object: RectPx) -> [RectPx; 4] {
    let whole = RectPx::whole(frame.size());
    let (right, bottom) = (object.x + object.width, object.y + object.height);
    [
        RectPx { height: object.y, ..whole },
        RectPx { y: bottom, height: whole.height.saturating_sub(bottom), ..whole },
        RectPx { width: object.x, ..whole },
        RectPx { x: right, width: whole.width.saturating_sub(right), ..whole },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::landmark::{ColorStats, Digest, ShapeClass, WindowPx};

    const OBJECT: RectPx = RectPx { x: 20, y: 10, width: 16, height: 16 };

    fn red() -> Landmark {
        Landmark {
            id: "red".into(),
            revision: 1,
            window_px: WindowPx::square(8),
            shades: vec![ColorStats { mean: [200.0, 40.0, 30.0], variance: [0.0; 3] }],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape: ShapeClass::Any,
            size_m: None,
            digest: Digest::default(),
        }
    }

    /// The object, and another one of `colour` whose upper left corner is at `at`.
    fn frame(colour: [u8; 3], at: (usize, usize)) -> Frame {
        let is_in = |x: usize, y: usize, left: usize, top: usize| {
            (left..left + 16).contains(&x) && (top..top + 16).contains(&y)
        };
        let pixel = |x, y| match (is_in(x, y, 20, 10), is_in(x, y, at.0, at.1)) {
            (true, _) => [200, 40, 30],
            (_, true) => colour,
            _ => [90, 120, 160],
        };
        let rgb = (0..60).flat_map(|y| (0..80).flat_map(move |x| pixel(x, y))).collect();
        Frame::from_rgb(80, 60, rgb).unwrap()
    }

    #[test]
    fn what_is_like_it_is_found_on_every_side_and_named_in_tolerances() {
        for at in [(2, 10), (50, 10), (20, 40), (60, 40), (2, 40)] {
            let separation = separation(&frame([200, 70, 30], at), &red(), OBJECT);
            assert!((separation.excess() - 2.0).abs() < 1e-4, "{at:?}: {separation:?}");
            assert!(separation.inside.unwrap().excess < 1e-4);
        }
        assert!(separation(&frame([200, 45, 30], (50, 30)), &red(), OBJECT).excess() < 1.0);
    }

    #[test]
    fn a_picture_of_nothing_but_the_object_has_nothing_outside() {
        let frame = Frame::from_rgb(16, 16, [200, 40, 30].repeat(256)).unwrap();
        let separation = separation(&frame, &red(), RectPx { x: 0, y: 0, ..OBJECT });
        assert_eq!((separation.outside, separation.excess()), (None, f32::INFINITY));
    }
}
