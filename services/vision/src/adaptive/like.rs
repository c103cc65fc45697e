//! The pixels of a region that may be the landmark's.
//!
//! Of a large region one row of every three is looked at first, [`coarse`](super::coarse)ly; only where one of its
//! pixels matches, and next to such places, every pixel is asked. A connected set of matching pixels is found whole if
//! one of its pixels lies in such a row, which is true of all that are three rows high. Parts of it may be lost only
//! where it runs on for more than 64 columns between two such rows.

use super::likeness::Likeness;
use crate::bitmask::BitMask;
use crate::frame::Frame;
use crate::geometry::RectPx;
use crate::mask::Lanes;

use super::coarse::{Coarse, RUN_PX};

/// Rows of which one is looked at first.
const BAND: u32 = 3;
/// Regions of fewer pixels are looked at row by row.
const LARGE_PX: u64 = 40_000;
/// Columns of a word.
const WORD_PX: u32 = 64;

/// Marks like pixels, with the memory to do so again and again.
#[derive(Debug, Default)]
pub(crate) struct Marker {
    lanes: Lanes,
    coarse: Coarse,
    bits: Vec<u64>,
    /// The words of a band's rows that are asked.
    wanted: Vec<u64>,
    /// For each band and word 1 where a pixel of the band's middle row matches, and 0 elsewhere.
    alive: Vec<u8>,
}

impl Marker {
    /// Makes `mask` the like pixels of `region`.
    pub(crate) fn mark(
        &mut self,
        frame: &Frame,
        region: RectPx,
        likeness: &Likeness<'_>,
        mask: &mut BitMask,
    ) {
        mask.reset(region.width, region.height);
        let words = region.width.div_ceil(WORD_PX) as usize;
        self.bits.clear();
        self.bits.resize(words, 0);
        likeness.enclose_in(&mut self.coarse);
        if u64::from(region.width) * u64::from(region.height) < LARGE_PX {
            for y in 0..region.height {
                self.bits.fill(0);
                self.lanes.like_words(row_of(frame, region, y), &self.coarse, likeness, &mut self.bits);
                self.add_row(y, mask);
            }
            return;
        }
        self.sift(frame, region, likeness);
        let bands = region.height.div_ceil(BAND) as usize;
        for band in 0..bands {
            if !self.choose_words(band, bands, words) {
                continue;
            }
            self.wanted.clone_from(&self.bits);
            for y in BAND * band as u32..(BAND * (band as u32 + 1)).min(region.height) {
                self.bits.copy_from_slice(&self.wanted);
                self.mark_row(frame, region, likeness, y, mask);
            }
        }
    }

    /// Keeps of `mask` what matches `likeness` too.
    pub(crate) fn refine(
        &mut self,
        frame: &Frame,
        region: RectPx,
        likeness: &Likeness<'_>,
        mask: &BitMask,
        refined: &mut BitMask,
    ) {
        refined.reset(region.width, region.height);
        self.bits.resize(region.width.div_ceil(WORD_PX) as usize, 0);
        for y in 0..region.height {
            if mask.is_empty_row(y) {
                continue;
            }
            self.bits.copy_from_slice(mask.row_words(y));
            self.mark_row(frame, region, likeness, y, refined);
        }
    }

    /// Asks the pixels of those words of a row of which `bits` wants any, and marks the wanted ones that match.
    fn mark_row(
        &mut self,
        frame: &Frame,
        region: RectPx,
        likeness: &Likeness<'_>,
        y: u32,
        mask: &mut BitMask,
    ) {
        self.lanes.like_bits(row_of(frame, region, y), likeness, &mut self.bits);
        self.add_row(y, mask);
    }

    fn add_row(&self, y: u32, mask: &mut BitMask) {
        for (word, &bits) in self.bits.iter().enumerate() {
            if bits != 0 {
                mask.or_word(y, word as u32, bits);
            }
        }
    }

    fn sift(&mut self, frame: &Frame, region: RectPx, likeness: &Likeness<'_>) {
        self.alive.clear();
        let mut y = (BAND / 2).min(region.height - 1);
        for _ in 0..region.height.div_ceil(BAND) {
            self.bits.fill(0);
            let row = row_of(frame, region, y.min(region.height - 1));
            self.lanes.like_words(row, &self.coarse, likeness, &mut self.bits);
            self.alive.extend(self.bits.iter().map(|&bits| u8::from(bits != 0)));
            y += BAND;
        }
    }

    /// Makes `bits` all ones for the words of a band in which, or next to which, something is alive. Whether there are any.
    fn choose_words(&mut self, band: usize, bands: usize, words: usize) -> bool {
        let near = band.saturating_sub(1)..(band + 2).min(bands);
        if !self.alive[near.start * words..near.end * words].contains(&1) {
            return false;
        }
        for word in 0..words {
            let columns = word.saturating_sub(1)..(word + 2).min(words);
            let wanted = near.clone().any(|band| self.alive[band * words..][columns.clone()].contains(&1));
            self.bits[word] = if wanted { u64::MAX } else { 0 };
        }
        true
    }
}

fn row_of(frame: &Frame, region: RectPx, y: u32) -> &[u8] {
    &frame.row(region.y + y)[3 * region.x as usize..][..3 * region.width as usize]
}

/// Leaves of the wanted `bits` of a row those whose pixel matches. Words without a wanted bit are not looked at.
#[inline(always)]
pub(crate) fn like_bits(row: &[u8], likeness: &Likeness<'_>, bits: &mut [u64]) {
    for (bits, pixels) in bits.iter_mut().zip(row.chunks(3 * WORD_PX as usize)) {
        if *bits != 0 {
            *bits &= likeness.matching(pixels);
        }
    }
}

/// Sets in `bits` the pixels of a row that match.
#[inline(always)]
pub(crate) fn like_words(row: &[u8], coarse: &Coarse, likeness: &Likeness<'_>, bits: &mut [u64]) {
    for (bits, (at, pixels)) in bits.iter_mut().zip(row.chunks(3 * WORD_PX as usize).enumerate()) {
        let first = 3 * WORD_PX as usize * at;
        let mut any = false;
        for run in (0..pixels.len()).step_by(3 * RUN_PX) {
            any |= coarse.may_match(&row[first + run..]);
        }
        if any {
            *bits = likeness.matching(pixels);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptive::likeness::Light;
    use crate::adaptive::memory::Memory;
    use crate::components::Components;
    use crate::landmark::{ColorStats, Digest, Landmark, ShapeClass, WindowPx};
    use proptest::prelude::*;

    /// A plain landmark, or a sign whose second shade is its whole face.
    fn landmark(mean: [f32; 3], shape: ShapeClass) -> Landmark {
        let plain = ColorStats { mean, variance: [20.0; 3] };
        let face = ColorStats { mean: mean.map(|m| 0.6 * m + 80.0), variance: [3000.0; 3] };
        Landmark {
            id: "test".into(),
            revision: 1,
            window_px: WindowPx::square(8),
            shades: vec![plain, face],
            tolerance: ColorStats::uniform(15.0, 50.0),
            shape,
            size_m: None,
            digest: Digest::default(),
        }
    }

    fn likeness<'m>(memory: &'m Memory, landmark: &Landmark) -> Likeness<'m> {
        Likeness::anywhere(memory, landmark, Light::AS_LEARNED, [4.0; 3])
    }

    /// Noise of all colours with flat discs of the landmark's.
    fn frame(width: u32, height: u32, seed: u64, own: [f32; 3], discs: &[(u32, u32, u32)]) -> Frame {
        let mut state = seed | 1;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as u8
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let rgb = places.flat_map(|(x, y)| {
            let inside =
                |&(cx, cy, r): &(u32, u32, u32)| x.abs_diff(cx).pow(2) + y.abs_diff(cy).pow(2) <= r * r;
            let noise = [next(), next(), next()];
            if discs.iter().any(inside) { own.map(|m| m as u8) } else { noise }
        });
        Frame::from_rgb(width, height, rgb.collect()).unwrap()
    }

    fn slowly(frame: &Frame, region: RectPx, likeness: &Likeness<'_>) -> BitMask {
        let mut mask = BitMask::new(region.width, region.height);
        for (y, x) in (0..region.height).flat_map(|y| (0..region.width).map(move |x| (y, x))) {
            if likeness.matches(frame.pixel(region.x + x, region.y + y)) {
                mask.set(x, y);
            }
        }
        mask
    }

    fn landmarks() -> impl Strategy<Value = Landmark> {
        (any::<[u8; 3]>(), prop_oneof![Just(ShapeClass::Block), Just(ShapeClass::Octagon)])
            .prop_map(|(mean, shape)| landmark(mean.map(f32::from), shape))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn pixels_of_a_gate_are_those_that_match(
            landmark in landmarks(), seed in any::<u64>(), x in 0u32..30, width in 1u32..140,
        ) {
            let memory = Memory::new();
            let likeness = likeness(&memory, &landmark);
            let frame = frame(170, 20, seed, [0.0; 3], &[]);
            let region = RectPx { x, y: 2, width, height: 17 };
            let (mut marker, mut mask) = (Marker::default(), BitMask::default());
            marker.mark(&frame, region, &likeness, &mut mask);
            prop_assert!(mask == slowly(&frame, region, &likeness));
        }

        #[test]
        fn of_a_whole_frame_nothing_that_a_sifted_row_meets_is_lost(
            mean in any::<[u8; 3]>(), seed in any::<u64>(),
            discs in proptest::collection::vec((0u32..320, 0u32..160, 2u32..20), 1..5),
        ) {
            let (memory, own) = (Memory::new(), mean.map(f32::from));
            let likeness = likeness(&memory, &landmark(own, ShapeClass::Block));
            let frame = frame(320, 160, seed, own, &discs);
            let region = RectPx::whole(frame.size());
            let (mut marker, mut mask) = (Marker::default(), BitMask::default());
            marker.mark(&frame, region, &likeness, &mut mask);
            let all = slowly(&frame, region, &likeness);
            let mut components = Components::default();
            components.find(&all);
            for component in components.list() {
                let met = components.runs(component).iter().any(|run| run.y % BAND == BAND / 2);
                for run in components.runs(component).iter().filter(|_| met && component.width() <= WORD_PX) {
                    prop_assert!((run.x_start..run.x_end).all(|x| mask.get(x, run.y)));
                }
            }
        }
    }
}
