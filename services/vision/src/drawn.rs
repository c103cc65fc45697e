//! Filled figures for tests of outlines, lines and shapes.

use std::f64::consts::TAU;

use crate::bitmask::BitMask;
use crate::components::Components;
use crate::outline::Outline;

/// A mask of 240×240 pixels of all points (from its middle, off the grid) for which `inside` holds.
pub(crate) fn figure(inside: impl Fn(f64, f64) -> bool) -> BitMask {
    let mut mask = BitMask::new(240, 240);
    for (x, y) in (0..240).flat_map(|y| (0..240).map(move |x| (x, y))) {
        if inside(f64::from(x) - 119.6, f64::from(y) - 119.3) {
            mask.set(x, y);
        }
    }
    mask
}

/// A regular polygon with this circumradius; the first side's outward normal points along `turn_rad`.
pub(crate) fn polygon(sides: u32, radius: f64, turn_rad: f64) -> BitMask {
    let step = TAU / f64::from(sides);
    figure(|x, y| {
        (0..sides).all(|side| {
            let normal = turn_rad + f64::from(side) * step;
            x * normal.cos() + y * normal.sin() <= radius * (step / 2.0).cos()
        })
    })
}

/// A rectangle of these half sides.
pub(crate) fn rectangle(half_width: f64, half_height: f64, turn_rad: f64) -> BitMask {
    let (sin, cos) = turn_rad.sin_cos();
    figure(|x, y| (x * cos + y * sin).abs() <= half_width && (y * cos - x * sin).abs() <= half_height)
}

/// An ellipse of these half axes.
pub(crate) fn ellipse(half_width: f64, half_height: f64) -> BitMask {
    figure(|x, y| (x / half_width).powi(2) + (y / half_height).powi(2) <= 1.0)
}

/// The outline of the first component.
pub(crate) fn outline(mask: &BitMask) -> Outline {
    let mut components = Components::default();
    components.find(mask);
    let mut outline = Outline::default();
    outline.trace(mask, components.runs(&components.list()[0])[0]);
    outline
}
