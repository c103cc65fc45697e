//! The window whose six statistics stand for an object.

use super::candidate::Search;
use super::choose::variance_excess;
use super::patch::Patch;
use crate::landmark::ColorStats;

/// The largest window, samples of the doubled grid.
const LARGEST_WINDOW_2X: i32 = 48;

/// A window on an object.
struct Window {
    side_px: i32,
    stats: ColorStats,
    /// How far its means are off, and its variances, in tolerances beyond what is allowed.
    off: (f32, f32),
}

/// The window on the object that is nearest to the descriptor, and its statistics. Its side follows the object's, and
/// is halved where nothing that large shows one of the shades: the landmark's colour may be but a frame around lettering.
pub(super) fn best(search: &Search<'_>, object: &Patch<'_>, area_px2: f32) -> Option<(u16, ColorStats)> {
    let mut side_px = ((0.42 * area_px2.sqrt()) as i32).clamp(1, LARGEST_WINDOW_2X / 2);
    let least_px = (i32::from(search.landmark.window_px.width) / 4).max(2);
    let mut best = window_of_side(search, object, side_px);
    while best.as_ref().is_none_or(|best| best.off.0 > 1.0 || best.off.1 > 0.0) && side_px / 2 >= least_px {
        side_px /= 2;
        let smaller = window_of_side(search, object, side_px);
        best = [best, smaller].into_iter().flatten().min_by(|a, b| a.cost().total_cmp(&b.cost()));
    }
    best.map(|best| (2 * best.side_px as u16, best.stats))
}

/// The best window of that side.
fn window_of_side(search: &Search<'_>, object: &Patch<'_>, side_px: i32) -> Option<Window> {
    let step = (side_px / 2).max(1);
    let mut best: Option<(f32, ColorStats)> = None;
    let bounds = object.bounds()?;
    let (left, top) = ((bounds.x - object.rect.x) as i32, (bounds.y - object.rect.y) as i32);
    let last = side_px - 1;
    for y in (top..top + bounds.height as i32).step_by(step as usize) {
        for x in (left..left + bounds.width as i32).step_by(step as usize) {
            let corners = [(0, 0), (last, 0), (0, last), (last, last)];
            if !corners.iter().all(|(u, v)| object.get(x + u, y + v)) {
                continue;
            }
            let stats = window_stats(search, object, (x, y), side_px);
            let cost = search.likeness.nearest(stats.mean).excess + 0.01 * stats.variance[0].sqrt();
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, stats));
            }
        }
    }
    best.map(|(_, stats)| {
        let off = (search.likeness.nearest(stats.mean).excess, variance_excess(search, &stats));
        Window { side_px, stats, off }
    })
}

impl Window {
    fn cost(&self) -> f32 {
        self.off.0 + self.off.1
    }
}

fn window_stats(search: &Search<'_>, object: &Patch<'_>, (x, y): (i32, i32), side: i32) -> ColorStats {
    stats(search, object, (y..y + side).flat_map(|v| (x..x + side).map(move |u| (u, v))))
}

/// Mean and population variance of these places of the object's patch.
fn stats(search: &Search<'_>, object: &Patch<'_>, places: impl Iterator<Item = (i32, i32)>) -> ColorStats {
    let (mut n, mut sum, mut squares) = (0.0_f32, [0.0_f32; 3], [0.0_f32; 3]);
    for (x, y) in places {
        let pixel = search.frame.pixel(object.rect.x + x as u32, object.rect.y + y as u32);
        for c in 0..3 {
            let level = f32::from(pixel[c]);
            sum[c] += level;
            squares[c] += level * level;
        }
        n += 1.0;
    }
    let mean = sum.map(|s| s / n.max(1.0));
    let variance = std::array::from_fn(|c| (squares[c] / n.max(1.0) - mean[c] * mean[c]).max(0.0));
    ColorStats { mean, variance }
}
