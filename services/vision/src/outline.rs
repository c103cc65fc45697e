//! The border of a component: what the Hough transform sees instead of the filled mask.

use std::f64::consts::SQRT_2;

use crate::bitmask::{BitMask, Run};

/// The outer border of one component: its border pixels in clockwise order (as seen on the screen), each an
/// 8-neighbour of the next, the last one of the first. Holes have no part in it.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    pixels: Vec<(i32, i32)>,
}

/// Steps to the eight neighbours, clockwise from the right.
const STEPS: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

impl Outline {
    /// Traces the component of `mask` whose first run (topmost, then leftmost) is `first`.
    pub fn trace(&mut self, mask: &BitMask, first: Run) {
        let start = (first.x_start as i32, first.y as i32);
        self.pixels.clear();
        // As if arrived from the upper left, which is outside: nothing of the component lies above the first run.
        let Some(leaving) = next_step(mask, start, 1) else {
            self.pixels.push(start);
            return;
        };
        let (mut at, mut direction) = (start, leaving);
        loop {
            self.pixels.push(at);
            at = (at.0 + STEPS[direction].0, at.1 + STEPS[direction].1);
            match next_step(mask, at, direction) {
                Some(next) if at != start || next != leaving => direction = next,
                _ => return,
            }
        }
    }

    /// Column and row of the border pixels, clockwise.
    #[must_use]
    pub fn pixels(&self) -> &[(i32, i32)] {
        &self.pixels
    }

    /// Length of the closed line through the centres of the border pixels, in mask pixels.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.sides().map(|((ax, ay), (bx, by))| step_length(bx - ax, by - ay)).sum()
    }

    /// Pixels inside the border, border included, holes counted as filled (Pick's theorem on the line through the
    /// centres of the border pixels).
    #[must_use]
    pub fn enclosed_pixels(&self) -> f64 {
        if self.pixels.len() == 1 {
            return 1.0;
        }
        let cross = |((ax, ay), (bx, by)): ((i32, i32), (i32, i32))| {
            i64::from(ax) * i64::from(by) - i64::from(bx) * i64::from(ay)
        };
        let twice_area = self.sides().map(cross).sum::<i64>().abs();
        (twice_area + self.pixels.len() as i64) as f64 / 2.0 + 1.0
    }

    /// The pixel `ahead` places further along the border than the one with number `at`.
    #[must_use]
    pub fn pixel_after(&self, at: usize, ahead: isize) -> (i32, i32) {
        let place = at as isize + ahead;
        let count = self.pixels.len() as isize;
        // Almost always in range, and a division costs as much as the rest of the loop it stands in.
        let place = if (0..count).contains(&place) { place } else { place.rem_euclid(count) };
        self.pixels[place as usize]
    }

    /// The sides of the closed line through the border pixels.
    fn sides(&self) -> impl Iterator<Item = ((i32, i32), (i32, i32))> {
        self.pixels.iter().copied().zip(self.pixels.iter().copied().cycle().skip(1))
    }
}

/// The length of a step to a neighbour, or of none.
fn step_length(dx: i32, dy: i32) -> f64 {
    match (dx, dy) {
        (0, 0) => 0.0,
        (0, _) | (_, 0) => 1.0,
        _ => SQRT_2,
    }
}

/// The direction of the first border pixel clockwise from the outside, after arriving at `at` by `direction`.
fn next_step(mask: &BitMask, at: (i32, i32), direction: usize) -> Option<usize> {
    // What lies left of the way here was found to be outside already.
    let first = if direction.is_multiple_of(2) { direction + 7 } else { direction + 6 };
    (first..first + 8).map(|step| step % 8).find(|&step| {
        let (dx, dy) = STEPS[step];
        mask.get_signed(at.0 + dx, at.1 + dy)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::Components;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn mask_of(rows: &[&str]) -> BitMask {
        let mut mask = BitMask::new(rows[0].len() as u32, rows.len() as u32);
        for (y, row) in rows.iter().enumerate() {
            for (x, _) in row.bytes().enumerate().filter(|&(_, byte)| byte == b'#') {
                mask.set(x as u32, y as u32);
            }
        }
        mask
    }

    fn outlines(mask: &BitMask) -> Vec<Outline> {
        let mut components = Components::default();
        components.find(mask);
        let trace = |component| {
            let mut outline = Outline::default();
            outline.trace(mask, components.runs(component)[0]);
            outline
        };
        components.list().iter().map(trace).collect()
    }

    #[test]
    fn a_rectangle_is_walked_clockwise() {
        let outline = &outlines(&mask_of(&["...", ".##", ".##"]))[0];
        assert_eq!(outline.pixels(), [(1, 1), (2, 1), (2, 2), (1, 2)]);
        assert!((outline.length() - 4.0).abs() < 1e-9 && (outline.enclosed_pixels() - 4.0).abs() < 1e-9);
    }

    #[test]
    fn a_hole_counts_as_filled_and_a_spur_is_walked_twice() {
        let outline = &outlines(&mask_of(&["####..", "#..###", "####.."]))[0];
        assert!((outline.enclosed_pixels() - 14.0).abs() < 1e-9);
        assert_eq!(outlines(&mask_of(&["#"]))[0].pixels(), [(0, 0)]);
        assert!((outlines(&mask_of(&["#"]))[0].enclosed_pixels() - 1.0).abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn the_outline_is_closed_and_touches_all_that_can_be_reached_from_outside(
            (width, pixels) in (1usize..14).prop_flat_map(|width| {
                (Just(width), prop::collection::vec(prop::bool::weighted(0.55), width * 9))
            }),
        ) {
            let rows: Vec<String> =
                pixels.chunks(width).map(|row| row.iter().map(|&set| if set { '#' } else { '.' }).collect()).collect();
            let mask = mask_of(&rows.iter().map(String::as_str).collect::<Vec<_>>());
            let mut components = Components::default();
            components.find(&mask);
            for (component, outline) in components.list().iter().zip(outlines(&mask)) {
                let border: BTreeSet<_> = outline.pixels().iter().copied().collect();
                prop_assert!(border.iter().all(|&(x, y)| mask.get_signed(x, y)));
                prop_assert!(outline.sides().all(|((ax, ay), (bx, by))| (ax - bx).abs() <= 1 && (ay - by).abs() <= 1));
                let runs = components.runs(component);
                for y in component.y_start..component.y_end {
                    let in_row = || runs.iter().filter(move |run| run.y == y);
                    let leftmost = in_row().map(|run| run.x_start).min().unwrap();
                    let rightmost = in_row().map(|run| run.x_end - 1).max().unwrap();
                    prop_assert!(border.contains(&(leftmost as i32, y as i32)));
                    prop_assert!(border.contains(&(rightmost as i32, y as i32)));
                }
            }
        }
    }
}
