//! Where exactly a board's sides are, and whether a box is two boards, one behind the other's side.

use super::LEAST_PX;
use super::field::{Area, Field};
use crate::adaptive::memory::{CollectIn, List};

/// A side of a box is moved at most so often, by up to this part of the box, to where the outline is plainer by this.
const MOST_MOVES: usize = 4;
const MOST_MOVED: f32 = 0.6;
const PLAINER: f32 = 0.02;
/// Of two signs, one behind the other, rows begin or end so far apart, as a part of the height of both.
const LEAST_STEP: f32 = 0.12;
/// A pixel that belongs to the sign by this is one of it.
const OWN: f32 = 0.5;

/// From which row to which the sign's pixels reach in a column.
type Reach = (i32, i32);

/// The box near `from` with the plainest outline: that around two signs is full enough, but has a corner that is neither's.
pub(super) fn plainest(field: &Field<'_>, from: Area) -> Area {
    let mut best = settled(field, from);
    for part in parts(field, from).into_iter().flatten() {
        let part = settled(field, part);
        if part.1 > best.1 + PLAINER {
            best = part;
        }
    }
    best.0
}

/// Mixed pixels or a border around a box, px.
pub(super) fn gap_px(area: Area) -> i32 {
    1 + (0.05 * area.height() as f32).round() as i32
}

/// Rows and columns next to a box that leave room for mixed pixels or a border: left, right, above, below.
pub(super) fn beside(area: Area) -> [Area; 4] {
    let gap = gap_px(area);
    let Area { left, top, right, bottom } = area;
    [
        Area { left: left - gap - 1, right: left - gap, ..area },
        Area { left: right + gap, right: right + gap + 1, ..area },
        Area { top: top - gap - 1, bottom: top - gap, ..area },
        Area { top: bottom + gap, bottom: bottom + gap + 1, ..area },
    ]
}

/// Moves sides while that makes the outline plainer; how plain it is then.
fn settled(field: &Field<'_>, from: Area) -> (Area, f32) {
    let mut best = (from, plainness(field, from));
    for _ in 0..MOST_MOVES {
        let (base, before) = best;
        let most = (MOST_MOVED * base.width().max(base.height()) as f32) as i32;
        for area in (-most..=most).flat_map(|by| base.with_sides_moved(by)) {
            let apart = (area.width() - base.width()).abs() as f32 <= MOST_MOVED * base.width() as f32
                && (area.height() - base.height()).abs() as f32 <= MOST_MOVED * base.height() as f32;
            if apart && area.width() >= LEAST_PX.0 && area.height() >= LEAST_PX.1 {
                let plainness = plainness(field, area);
                if plainness > best.1 + PLAINER {
                    best = (area, plainness);
                }
            }
        }
        if best.1 <= before {
            break;
        }
    }
    best
}

/// How much more the pixels just inside a box belong to the sign than those just outside, on average over its outline.
fn plainness(field: &Field<'_>, area: Area) -> f32 {
    let Area { left, top, right, bottom } = area;
    let inside = [
        Area { right: left + 1, ..area },
        Area { left: right - 1, ..area },
        Area { bottom: top + 1, ..area },
        Area { top: bottom - 1, ..area },
    ];
    let sum = |areas: [Area; 4]| areas.into_iter().map(|area| field.sum(area)).sum::<f32>();
    (sum(inside) - sum(beside(area))) / (2 * (area.width() + area.height())) as f32
}

/// The boxes on both sides of the column where the sign's pixels reach another height, if there is one: a sign that stands
/// behind another one's side is lower.
fn parts(field: &Field<'_>, area: Area) -> [Option<Area>; 2] {
    let reaches = (area.left..area.right).map(|x| reach(field, area, x));
    let reaches: List<'_, Reach> = reaches.collect_in(field.memory());
    let mut ends = List::with_capacity_in(reaches.len(), field.memory());
    let least = (LEAST_STEP * area.height() as f32).max(1.0);
    let mut best: Option<(i32, i32, Reach, Reach)> = None;
    for at in LEAST_PX.0..=area.width() - LEAST_PX.0 {
        let (left, right) = reaches.split_at(at as usize);
        let (one, other) = (median(left, &mut ends), median(right, &mut ends));
        // The step explains more, the less the columns on both sides differ among themselves.
        let rest = off(left, one) + off(right, other);
        if off(&[one], other) as f32 >= least && best.is_none_or(|(least, ..)| rest < least) {
            best = Some((rest, area.left + at, one, other));
        }
    }
    let Some((_, x, one, other)) = best else { return [None; 2] };
    let part = |left: i32, right: i32, (top, bottom): Reach| {
        let part = Area { left, top, right, bottom };
        (part.height() >= LEAST_PX.1).then_some(part)
    };
    [part(area.left, x, one), part(x, area.right, other)]
}

/// From where to where the sign's pixels reach in a column of a box, and beyond it where they are connected with it but for
/// lettering.
fn reach(field: &Field<'_>, area: Area, x: i32) -> Reach {
    let gap = 1 + area.height() / 4;
    let middle = (area.top + area.bottom) / 2;
    let (mut top, mut bottom) = (middle, middle);
    for y in (0..middle).rev().take_while(|y| *y >= area.top - area.height()) {
        if field.get(x, y) >= OWN {
            top = y;
        } else if top - y > gap {
            break;
        }
    }
    for y in middle..field.height().min(area.bottom + area.height()) {
        if field.get(x, y) >= OWN {
            bottom = y + 1;
        } else if y - bottom >= gap {
            break;
        }
    }
    (top, bottom)
}

/// The medians of both ends; `ends` is memory to tell them.
fn median(reaches: &[Reach], ends: &mut List<'_, i32>) -> Reach {
    let mut middle = |end: fn(&Reach) -> i32| {
        ends.clear();
        ends.extend(reaches.iter().map(end));
        let half = ends.len() / 2;
        *ends.select_nth_unstable(half).1
    };
    (middle(|reach| reach.0), middle(|reach| reach.1))
}

fn off(reaches: &[Reach], from: Reach) -> i32 {
    reaches.iter().map(|reach| (reach.0 - from.0).abs() + (reach.1 - from.1).abs()).sum()
}
