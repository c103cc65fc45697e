//! The window that fits the object, and the six statistics of the windows that lie on it.

use super::MAX_SHADES;
use super::object::same_shading;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::landmark::{ColorStats, WindowPx};

/// The largest fitted window, samples of the doubled grid.
const MAX_FITTED_SIDE: usize = 12;
/// Never below the red block of Table D.1.
const LEAST_TOLERANCE: ColorStats = ColorStats::uniform(15.0, 50.0);
/// Shades whose means lie closer than this in every channel become one, levels.
const SAME_SHADE: f32 = 8.0;

/// The pixels of a region, each with the shade it shows (`None`: background or lettering).
pub(super) struct Sample {
    width: usize,
    height: usize,
    pixels: Vec<[f64; 3]>,
    labels: Vec<Option<usize>>,
}

/// Shades and the tolerances that cover their spread.
pub(super) struct Fitted {
    pub(super) shades: Vec<ColorStats>,
    pub(super) tolerance: ColorStats,
}

impl Sample {
    /// A region whose pixels are labelled, row by row.
    pub(super) fn new(frame: &Frame, region: RectPx, labels: Vec<Option<usize>>) -> Self {
        let rows = region.y..region.y + region.height;
        let pixels = rows
            .flat_map(|y| (region.x..region.x + region.width).map(move |x| frame.pixel(x, y).map(f64::from)))
            .collect();
        Self { width: region.width as usize, height: region.height as usize, pixels, labels }
    }

    /// A region that is the template itself: all its pixels are the object's.
    pub(super) fn exact(frame: &Frame, region: RectPx) -> Self {
        let count = region.width as usize * region.height as usize;
        Self::new(frame, region, vec![Some(0); count])
    }

    /// Side in pixels of the largest square of object pixels (any shade).
    fn core_side(&self) -> usize {
        let mut above = vec![0_usize; self.width];
        let mut largest = 0;
        for y in 0..self.height {
            let (mut left, mut above_left) = (0, 0);
            for (x, above_here) in above.iter_mut().enumerate() {
                let side = if self.labels[y * self.width + x].is_some() {
                    left.min(*above_here).min(above_left) + 1
                } else {
                    0
                };
                above_left = *above_here;
                *above_here = side;
                left = side;
                largest = largest.max(side);
            }
        }
        largest
    }

    /// The statistics of every `width`×`height` window that shows nothing but the object, with its commonest shade.
    fn windows(&self, width: usize, height: usize) -> Vec<(usize, ColorStats)> {
        let mut found = Vec::new();
        for y in 0..(self.height + 1).saturating_sub(height) {
            for x in 0..(self.width + 1).saturating_sub(width) {
                let inside =
                    || (y..y + height).flat_map(move |v| (x..x + width).map(move |u| v * self.width + u));
                if let Some(shade) = self.commonest_shade(inside()) {
                    found.push((shade, stats(inside().map(|at| self.pixels[at]))));
                }
            }
        }
        found
    }

    /// The commonest shade of these pixels when all of them are the object's.
    fn commonest_shade(&self, inside: impl Iterator<Item = usize>) -> Option<usize> {
        let mut counts = [0_u32; 32];
        for at in inside {
            counts[self.labels[at]?.min(31)] += 1;
        }
        (0..32).max_by_key(|&shade| counts[shade])
    }
}

/// The largest even square up to 12 samples of the doubled grid that fits every sample's core.
pub(super) fn fitted(samples: &[Sample]) -> WindowPx {
    let core = samples.iter().map(Sample::core_side).min().unwrap_or(1).max(1);
    WindowPx::square((2 * core).min(MAX_FITTED_SIDE) as u16)
}

/// Statistics of all pixels of each sample, as the thesis takes them of its templates.
pub(super) fn whole(samples: &[Sample]) -> Fitted {
    let shades = samples.iter().map(|sample| stats(sample.pixels.iter().copied())).take(MAX_SHADES).collect();
    Fitted { shades, tolerance: LEAST_TOLERANCE }
}

/// Shades and tolerances from the windows that lie wholly on the object.
pub(super) fn statistics(samples: &[Sample], window: WindowPx) -> Fitted {
    let (width, height) = (usize::from(window.width).div_ceil(2), usize::from(window.height).div_ceil(2));
    let mut groups: Vec<Vec<ColorStats>> = Vec::new();
    for sample in samples {
        let mut windows = sample.windows(width, height);
        if windows.is_empty() {
            let core = sample.core_side().max(1);
            windows = sample.windows(core.min(width), core.min(height));
        }
        let mut by_shade: Vec<Vec<ColorStats>> = Vec::new();
        for (shade, window) in windows {
            by_shade.resize_with(by_shade.len().max(shade + 1), Vec::new);
            by_shade[shade].push(window);
        }
        groups.extend(by_shade.into_iter().filter(|group| !group.is_empty()));
    }
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    discard_mixtures(&mut groups);
    let groups = merged(groups);
    Fitted { shades: groups.iter().map(|group| average(group)).collect(), tolerance: spread(&groups) }
}

/// Small far views show mostly mixtures of object, lettering and background: beside a clear view only those of their
/// shades stay that the clear view's commonest shade explains by more or less light.
fn discard_mixtures(groups: &mut Vec<Vec<ColorStats>>) {
    let Some(clearest) = groups.first() else { return };
    let (main, most) = (average(clearest).mean, clearest.len());
    groups.retain(|group| 10 * group.len() >= most || same_shading(main, average(group).mean));
}

/// Groups with nearly the same mean become one; the largest stay when there are too many.
fn merged(groups: Vec<Vec<ColorStats>>) -> Vec<Vec<ColorStats>> {
    let mut kept: Vec<Vec<ColorStats>> = Vec::new();
    for group in groups {
        let mean = average(&group).mean;
        let near = |other: &&mut Vec<ColorStats>| {
            average(other).mean.iter().zip(mean).all(|(a, b)| (a - b).abs() <= SAME_SHADE)
        };
        if let Some(same) = kept.iter_mut().find(near) {
            same.extend(group);
        } else if kept.len() < MAX_SHADES {
            kept.push(group);
        }
    }
    kept
}

fn average(group: &[ColorStats]) -> ColorStats {
    let mean_of = |value: fn(&ColorStats, usize) -> f32, channel: usize| {
        (group.iter().map(|s| f64::from(value(s, channel))).sum::<f64>() / group.len().max(1) as f64) as f32
    };
    ColorStats {
        mean: std::array::from_fn(|c| mean_of(|s, c| s.mean[c], c)),
        variance: std::array::from_fn(|c| mean_of(|s, c| s.variance[c], c)),
    }
}

/// The tolerances within which nineteen in twenty windows lie about their own shade.
fn spread(groups: &[Vec<ColorStats>]) -> ColorStats {
    let deviations = |value: fn(&ColorStats, usize) -> f32, channel: usize| {
        let mut off: Vec<f32> = groups
            .iter()
            .flat_map(|group| {
                let centre = value(&average(group), channel);
                group.iter().map(move |s| (value(s, channel) - centre).abs())
            })
            .collect();
        off.sort_by(f32::total_cmp);
        off.get(off.len() * 19 / 20).copied().unwrap_or(0.0)
    };
    ColorStats {
        mean: std::array::from_fn(|c| deviations(|s, c| s.mean[c], c).max(LEAST_TOLERANCE.mean[c])),
        variance: std::array::from_fn(|c| {
            deviations(|s, c| s.variance[c], c).max(LEAST_TOLERANCE.variance[c])
        }),
    }
}

/// Mean and population variance of R, G and B.
pub(super) fn stats(pixels: impl Iterator<Item = [f64; 3]>) -> ColorStats {
    let (mut n, mut sum, mut squares) = (0.0_f64, [0.0_f64; 3], [0.0_f64; 3]);
    for pixel in pixels {
        n += 1.0;
        for c in 0..3 {
            sum[c] += pixel[c];
            squares[c] += pixel[c] * pixel[c];
        }
    }
    let mean = sum.map(|s| s / n.max(1.0));
    let variance = std::array::from_fn(|c| (squares[c] / n.max(1.0) - mean[c] * mean[c]).max(0.0) as f32);
    ColorStats { mean: mean.map(|m| m as f32), variance }
}
