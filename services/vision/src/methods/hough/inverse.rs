//! From a line's parameters back into the picture.

use super::Line;
use crate::bitmask::BitMask;
use crate::geometry::{PointPx, Segment, SizePx};

/// A line's normal and its distance, for computing along it.
struct Course {
    normal: (f64, f64),
    rho_px: f64,
}

impl Course {
    fn of(line: &Line) -> Self {
        let (sin, cos) = f64::from(line.theta_rad).sin_cos();
        Self { normal: (cos, sin), rho_px: f64::from(line.rho_px) }
    }

    /// The point `along_px` from the foot of the normal.
    fn point(&self, along_px: f64) -> (f64, f64) {
        let (cos, sin) = self.normal;
        (self.rho_px * cos - along_px * sin, self.rho_px * sin + along_px * cos)
    }

    /// From where to where the line crosses a picture of that size.
    fn range(&self, size: SizePx) -> Option<(f64, f64)> {
        let (cos, sin) = self.normal;
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        let sides = [(self.rho_px * cos, -sin, size.width), (self.rho_px * sin, cos, size.height)];
        for (start, slope, side) in sides {
            let side = f64::from(side);
            if slope.abs() < 1e-12 {
                if !(0.0..=side).contains(&start) {
                    return None;
                }
                continue;
            }
            let (one, other) = (-start / slope, (side - start) / slope);
            (from, to) = (from.max(one.min(other)), to.min(one.max(other)));
        }
        (from < to && from.is_finite() && to.is_finite()).then_some((from, to))
    }

    fn segment(&self, (from, to): (f64, f64)) -> Segment {
        let [from, to] = [from, to].map(|along| self.point(along));
        Segment {
            from: PointPx::new(from.0 as f32, from.1 as f32),
            to: PointPx::new(to.0 as f32, to.1 as f32),
        }
    }
}

pub(super) fn across(line: &Line, size: SizePx) -> Option<Segment> {
    let course = Course::of(line);
    course.range(size).map(|range| course.segment(range))
}

pub(super) fn segments(line: &Line, mask: &BitMask, longest_gap_px: u32, shortest_px: u32) -> Vec<Segment> {
    let course = Course::of(line);
    let Some((from, to)) = course.range(SizePx { width: mask.width(), height: mask.height() }) else {
        return Vec::new();
    };
    let (gap, shortest) = (f64::from(longest_gap_px) + 1.0, f64::from(shortest_px));
    let mut pieces: Vec<(f64, f64)> = Vec::new();
    let mut along = from;
    while along <= to {
        if is_set_near(mask, course.point(along), course.normal) {
            match pieces.last_mut() {
                Some((_, end)) if along - *end <= gap => *end = along,
                _ => pieces.push((along, along)),
            }
        }
        along += 1.0;
    }
    let long_enough = pieces.into_iter().filter(|(from, to)| to - from >= shortest.max(f64::MIN_POSITIVE));
    long_enough.map(|piece| course.segment(piece)).collect()
}

/// Whether the pixel here, or a pixel further to either side, is set.
fn is_set_near(mask: &BitMask, (x, y): (f64, f64), (cos, sin): (f64, f64)) -> bool {
    [0.0, 1.0, -1.0]
        .into_iter()
        .any(|beside| mask.get_signed((x + beside * cos).floor() as i32, (y + beside * sin).floor() as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_picture() {
        let size = SizePx { width: 10, height: 6 };
        let upright = Line { rho_px: 4.0, theta_rad: 0.0, votes: 1 };
        let segment = upright.across(size).unwrap();
        assert_eq!((segment.from.x, segment.to.x, segment.length_px()), (4.0, 4.0, 6.0));
        assert_eq!(Line { rho_px: 11.0, ..upright }.across(size), None);
        assert_eq!(upright.across(SizePx::default()), None);
        let diagonal = Line { rho_px: 0.0, theta_rad: 3.0 * std::f32::consts::FRAC_PI_4, votes: 1 };
        assert!((diagonal.across(size).unwrap().length_px() - 6.0 * 2.0_f32.sqrt()).abs() < 1e-3);
    }

    #[test]
    fn gaps_part_pieces_and_short_ones_fall_out() {
        let mut mask = BitMask::new(60, 9);
        mask.set_run(4, 5, 20);
        mask.set_run(4, 22, 30);
        mask.set_run(4, 40, 42);
        let line = Line { rho_px: 4.5, theta_rad: std::f32::consts::FRAC_PI_2, votes: 25 };
        assert_eq!(line.segments(&mask, 2, 5).len(), 1);
        assert_eq!(line.segments(&mask, 1, 5).len(), 2);
        assert_eq!(line.segments(&mask, 1, 1).len(), 3);
        assert_eq!(line.segments(&BitMask::default(), 1, 1), []);
    }
}
