//! Few colours that stand for many: leader clustering over a coarse histogram.
//!
//! The fullest histogram bins lead; a bin joins the nearest leader within `radius` levels and becomes a leader
//! itself otherwise. Two rounds of re-assignment then settle the means. The result depends on the colours alone,
//! not on the order of the pixels.

use super::memory::{CollectIn, List, Memory, sorted};

/// Histogram bins a channel: 16 levels each.
const BINS: usize = 16;

/// One colour and how many pixels it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cluster {
    /// Mean colour, levels.
    pub(crate) mean: [f32; 3],
    /// Pixels.
    pub(crate) pixels: u32,
}

/// At most `limit` colours that stand for `pixels`, fullest first, at least about `radius` levels apart.
pub(crate) fn palette<'m>(
    memory: &'m Memory,
    pixels: impl Iterator<Item = [u8; 3]>,
    radius: f32,
    limit: usize,
) -> List<'m, Cluster> {
    let bins = filled_bins(memory, pixels);
    let mut clusters = leaders(memory, &bins, radius, limit);
    for _ in 0..2 {
        settle(memory, &mut clusters, &bins);
    }
    sorted(clusters, |a, b| b.pixels.cmp(&a.pixels)).collect_in(memory)
}

/// Squared Euclidean distance of two colours, levels².
pub(crate) fn distance2(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [dr, dg, db] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dr * dr + dg * dg + db * db
}

/// The index of the mean nearest to `color` and its squared distance; `None` of an empty palette.
pub(crate) fn nearest(clusters: &[Cluster], color: [f32; 3]) -> Option<(usize, f32)> {
    let with_distance = clusters.iter().map(|c| distance2(c.mean, color)).enumerate();
    with_distance.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// From one colour to another.
#[inline(always)]
pub(crate) fn minus(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Scalar product of two colours.
#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A pixel as levels.
pub(crate) fn levels(pixel: [u8; 3]) -> [f32; 3] {
    pixel.map(f32::from)
}

fn filled_bins(memory: &Memory, pixels: impl Iterator<Item = [u8; 3]>) -> List<'_, Cluster> {
    // For each bin the place of its sums plus one; most bins stay empty.
    let mut place = [0_u16; BINS * BINS * BINS];
    let mut sums: List<'_, (usize, [u32; 4])> = List::with_capacity_in(128, memory);
    for [r, g, b] in pixels {
        let bin = [r, g, b].iter().fold(0, |at, &level| at * BINS + usize::from(level >> 4));
        if place[bin] == 0 {
            sums.push((bin, [0; 4]));
            place[bin] = sums.len() as u16;
        }
        let (_, sum) = &mut sums[usize::from(place[bin]) - 1];
        sum[0] += u32::from(r);
        sum[1] += u32::from(g);
        sum[2] += u32::from(b);
        sum[3] += 1;
    }
    // Fullest first; of equally full ones the darker.
    sums.sort_unstable_by_key(|&(bin, sum)| (std::cmp::Reverse(sum[3]), bin));
    let cluster = |(_, [r, g, b, n]): (usize, [u32; 4])| Cluster {
        mean: [r, g, b].map(|s| s as f32 / n as f32),
        pixels: n,
    };
    sums.into_iter().map(cluster).collect_in(memory)
}

fn leaders<'m>(memory: &'m Memory, bins: &[Cluster], radius: f32, limit: usize) -> List<'m, Cluster> {
    let mut clusters: List<'_, Cluster> = List::with_capacity_in(limit, memory);
    for bin in bins {
        let near = nearest(&clusters, bin.mean).is_some_and(|(_, d2)| d2 <= radius * radius);
        if !near && clusters.len() < limit {
            clusters.push(*bin);
        }
    }
    clusters
}

fn settle(memory: &Memory, clusters: &mut [Cluster], bins: &[Cluster]) {
    let sums = memory.alloc_slice_fill_copy(clusters.len(), ([0.0_f64; 3], 0_u32));
    for bin in bins {
        if let Some((at, _)) = nearest(clusters, bin.mean) {
            let (sum, pixels) = &mut sums[at];
            for (total, mean) in sum.iter_mut().zip(bin.mean) {
                *total += f64::from(mean) * f64::from(bin.pixels);
            }
            *pixels += bin.pixels;
        }
    }
    for (cluster, (sum, pixels)) in clusters.iter_mut().zip(sums.iter()) {
        if *pixels > 0 {
            let mean = sum.map(|s| (s / f64::from(*pixels)) as f32);
            *cluster = Cluster { mean, pixels: *pixels };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_colours_make_two_clusters_whatever_their_order() {
        let memory = Memory::new();
        let red = std::iter::repeat_n([200, 30, 20], 300);
        let blue = std::iter::repeat_n([30, 60, 180], 100);
        let one_way = palette(&memory, red.clone().chain(blue.clone()), 24.0, 8);
        let other_way = palette(&memory, blue.chain(red), 24.0, 8);
        assert_eq!(one_way, other_way);
        assert_eq!(one_way.iter().map(|c| c.pixels).collect::<Vec<_>>(), [300, 100]);
        assert_eq!(one_way[0].mean, [200.0, 30.0, 20.0]);
    }

    #[test]
    fn no_pixels_make_no_clusters() {
        assert!(palette(&Memory::new(), std::iter::empty(), 24.0, 8).is_empty());
        assert_eq!(nearest(&[], [0.0; 3]), None);
    }
}
